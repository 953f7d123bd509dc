// Dragging the free end: each lane takes one trace along, through as many legs and events as it can be certain of.
//
// The rope's last leg turns about its pivot, whose fan has the rays of all vertices that it can meet, counter-clockwise
// (`src/candidates/fan.rs`). Between two neighbouring rays nothing happens. A leg that leaves these two meets one ray
// after the other: it passes before the ray's vertex, or beyond it, and then the rope is wrapped there; and if it meets
// the line along which the rope came to its pivot, it unwraps.
//
// Points are whole numbers, so their differences are exact; `turn_of` bounds what f32 makes of their products. A sign
// within its bound is not certain. There the lane stops, and the CPU decides the leg exactly. So what a lane decides is
// what the exact update decides, on any device whose products and sums are one of the two nearest f32.

// How many contacts a lane knows at most, the last ones.
const STACK: u32 = 32u;
// How many events a lane notes in a dispatch at most.
const LOG: u32 = 32u;

// What a lane does.
const RUNS: u32 = 0u;
const DONE: u32 = 1u;
const STOPPED: u32 = 2u;

// The event of an unwrap; of a wrap it is the vertex.
const UNWRAP: u32 = 0xffffffffu;
// What stands for a number that is not known.
const UNKNOWN: u32 = 0xffffffffu;

// By what share of its two products a turn can be off: 2^-20. Rounded factors are good to 2^-24 and 2^-23, each
// product and their difference to 2^-23: 3.5 x 2^-23 in all, and the bound itself is rounded.
const SHARE: f32 = 0.00000095367431640625;
// By how much a difference of two points can be off in each coordinate, which are rounded to whole numbers: 1, and a
// quarter for what f64 rounds and for the rounding of the bound.
const OFF: f32 = 1.25;
// Ways longer than this belong to no vertex: 2^36, beyond all points.
const ENDLESS: f32 = 68719476736.0;

struct Job {
    // How many lanes there are in this dispatch.
    lanes: u32,
    // How often events are seen to at most, and how many looks a lane takes between: lanes that have met an event wait
    // for the others.
    turns: u32,
    looks: u32,
    // The pivot that is the anchor.
    anchor: u32,
}

// What is known of a lane between dispatches; it then stands at a point.
struct Lane {
    // Where the point at which it stands lies, and the last one to which it goes.
    point: u32,
    last: u32,
    // What its rope turns about, and the last ray of its fan clockwise of where it points.
    pivot: u32,
    low: u32,
    // How many of its contacts are in its stack, and how many more it has.
    depth: u32,
    deeper: u32,
    does: u32,
    events: u32,
    // The way to the pivot from the contact before, and which way the rope turns when it leaves the pivot: 0 for the
    // anchor.
    way: vec2<f32>,
    back: f32,
    // The square of the greatest distance from the pivot since the last event.
    farthest: f32,
    // Whose stack is its.
    number: u32,
    // The ray after which the leg meets the line of `way` when it turns back, or UNKNOWN.
    way_low: u32,
    unused_x: u32,
    unused_y: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
// Fans and points. Of a fan, the ways to its vertices as f32; of a point, its place in whole numbers.
@group(0) @binding(1) var<storage, read> data: array<vec2<u32>>;
// Of each ray in `data`: its vertex, and where it goes on in the fan of that, or UNKNOWN: twice the last ray that does
// not lie counter-clockwise of it, and one more if it lies on that. The CPU found these by exact signs.
@group(0) @binding(2) var<storage, read> rays: array<vec2<u32>>;
// Of each pivot: where its fan begins, how many rays it has, 0 if it is not there; and its place.
@group(0) @binding(3) var<storage, read> pivots: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> lanes: array<Lane>;
// A trace's contacts: the vertex and the side, the ray of the prior's fan on which it lies, the way there.
@group(0) @binding(5) var<storage, read_write> stacks: array<vec4<u32>>;
// A lane's events: the point from which the leg goes, the vertex or UNWRAP, the square of the greatest distance from
// the pivot before, whether the rope turned clockwise.
@group(0) @binding(6) var<storage, read_write> notes: array<vec4<u32>>;

override WORKGROUP: u32 = 64u;

fn sum_of(v: vec2<f32>) -> f32 {
    return abs(v.x) + abs(v.y);
}

// The turn from `u` to `v` if it is certain, else 0: each coordinate of `u` is off by a share of 2^-24, of `v` by that
// and by OFF, and the whole by `more` besides.
fn turn_of(u: vec2<f32>, v: vec2<f32>, more: f32) -> f32 {
    let left = u.x * v.y;
    let right = u.y * v.x;
    let turn = left - right;
    let bound = (abs(left) + abs(right)) * SHARE + more;
    return select(0.0, turn, abs(turn) > bound);
}

fn ray_at(place: u32) -> vec2<f32> {
    return bitcast<vec2<f32>>(data[place]);
}

// After which ray a leg goes on that comes along a ray which `goes_on` there, and turns by `dir`: it meets what lies on
// its own line at once. Back there, it meets the line last.
fn low_after(goes_on: u32, dir: f32, count: u32) -> u32 {
    let last = goes_on >> 1u;
    let is_before = (goes_on & 1u) == 1u && dir > 0.0;
    return select(last, select(last, count, last == 0u) - 1u, is_before);
}

fn point_at(place: u32) -> vec2<i32> {
    return bitcast<vec2<i32>>(data[place]);
}

@compute @workgroup_size(WORKGROUP)
fn drag(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.lanes {
        return;
    }
    let began = lanes[id.x];
    let number = began.number;
    var point = began.point;
    let last = began.last;
    var pivot = began.pivot;
    var depth = began.depth;
    let deeper = began.deeper;
    var does = began.does;
    var events = began.events;
    var way = began.way;
    var back = began.back;
    var farthest = began.farthest;
    var way_low = began.way_low;
    var fan = pivots[pivot].x;
    var count = pivots[pivot].y;
    var origin = bitcast<vec2<i32>>(pivots[pivot].zw);
    var low_number = began.low;
    var low = ray_at(fan + low_number);
    var high = ray_at(fan + select(low_number + 1u, 0u, low_number + 1u >= count));
    var wa = vec2<f32>(point_at(point) - origin);
    var wb = vec2<f32>(point_at(min(point + 1u, last)) - origin);
    // Which way the rope has turned on this leg, once it has met a ray.
    var dir = 0.0;

    for (var turn_taken = 0u; turn_taken < job.turns; turn_taken++) {
        if does != RUNS || (events + 8u > LOG && dir == 0.0) {
            break;
        }
        var event = 0u;
        for (var look = 0u; look < job.looks; look++) {
            if event != 0u || does != RUNS {
                break;
            }
            let turn_low = turn_of(low, wb, OFF * sum_of(low));
            let turn_high = turn_of(high, wb, OFF * sum_of(high));
            let turn_way = turn_of(way, wb, OFF * sum_of(way)) * back;
            let inside = dir == 0.0 && turn_low > 0.0 && turn_high < 0.0 && (back == 0.0 || turn_way < 0.0);
            let sums = OFF * (sum_of(wa) + sum_of(wb)) + 4.0;
            let turn = turn_of(wa, wb, sums);
            let to = select(dir, sign(turn), dir == 0.0);
            let ray = select(low, high, to > 0.0);
            let past_ray = select(-turn_low, turn_high, to > 0.0);
            let past_way = select(-1.0, turn_way, back == to);
            let both = past_ray > 0.0 && past_way > 0.0;
            let is_known = !both || way_low != UNKNOWN;
            let certain = to != 0.0 && past_ray != 0.0 && past_way != 0.0 && is_known;
            let goes_on = inside || (certain && past_ray < 0.0 && past_way < 0.0);
            let ray_first = past_ray > 0.0 && (past_way < 0.0 || low_number != way_low);
            // On which side of the leg the ray's vertex lies: the sum of three turns about the pivot.
            let a_b = wa.x * wb.y - wa.y * wb.x;
            let b_ray = wb.x * ray.y - wb.y * ray.x;
            let ray_a = ray.x * wa.y - ray.y * wa.x;
            let beyond = (a_b + b_ray + ray_a) * to;
            let products = sum_of(wa) * sum_of(wb) + sum_of(ray) * (sum_of(wa) + sum_of(wb));
            let bound = products * (2.0 * SHARE) + 2.0 * OFF * sum_of(ray) + 2.0 * sums;
            let passes = sum_of(ray) > ENDLESS || beyond < -bound;
            let wraps = !passes && beyond > bound;
            let asks = !goes_on && (!certain || (ray_first && !passes && !wraps));
            let passed = !goes_on && !asks && ray_first && passes;
            let to_left = to > 0.0;
            let before = select(low_number, count, low_number == 0u) - 1u;
            let after = select(low_number + 1u, 0u, low_number + 1u >= count);
            let after_that = select(after + 1u, 0u, after + 1u >= count);
            point += select(0u, 1u, goes_on);
            // What comes next: the next point, or the next ray.
            let place = select(min(point + 1u, last), fan + select(before, after_that, to_left), passed);
            let next = data[place];
            let new_ray = bitcast<vec2<f32>>(next);
            let new_way = vec2<f32>(bitcast<vec2<i32>>(next) - origin);
            farthest = select(farthest, max(farthest, wb.x * wb.x + wb.y * wb.y), goes_on);
            wa = select(wa, wb, goes_on);
            wb = select(wb, new_way, goes_on);
            dir = select(to, 0.0, goes_on);
            low_number = select(low_number, select(before, after, to_left), passed);
            let new_low = select(low, select(new_ray, high, to_left), passed);
            high = select(high, select(low, new_ray, to_left), passed);
            low = new_low;
            if asks {
                does = STOPPED;
                dir = 0.0;
            } else if goes_on {
                does = select(RUNS, DONE, point >= last);
            } else if !passed {
                event = select(2u, 1u, ray_first);
            }
        }
        if event != 0u && does == RUNS {
            let is_wrap = event == 1u;
            let top = number * STACK + depth;
            let high_number = select(low_number + 1u, 0u, low_number + 1u >= count);
            var met = select(low_number, high_number, dir > 0.0);
            let met_ray = rays[fan + met];
            var vertex = met_ray.x;
            var next_way = select(low, high, dir > 0.0);
            var next_back = -dir;
            var next = vertex;
            var goes_on = met_ray.y;
            let room = events < LOG && select(depth > 1u || deeper == 0u, depth < STACK, is_wrap);
            if room && !is_wrap {
                let left = stacks[top - 1u];
                met = left.y;
                vertex = UNWRAP;
                next = job.anchor;
                next_back = 0.0;
                goes_on = UNKNOWN;
                if depth > 1u {
                    let under = stacks[top - 2u];
                    next = under.x & 0x7fffffffu;
                    next_way = bitcast<vec2<f32>>(under.zw);
                    next_back = select(-1.0, 1.0, (under.x >> 31u) == 1u);
                    // The ray on which the rope came there lies in the fan of the contact before, or of the anchor.
                    if depth > 2u || deeper == 0u {
                        var before = job.anchor;
                        if depth > 2u {
                            before = stacks[top - 3u].x & 0x7fffffffu;
                        }
                        if pivots[before].y > 0u {
                            goes_on = rays[pivots[before].x + under.y].y;
                        }
                    }
                }
            }
            let head = pivots[next];
            let next_way_low = select(low_after(goes_on, -next_back, head.y), UNKNOWN, goes_on == UNKNOWN);
            var found = next_way_low;
            if !is_wrap {
                found = select(met, select(met, head.y, met == 0u) - 1u, dir < 0.0);
            }
            if !room || head.y == 0u || found == UNKNOWN {
                does = STOPPED;
            } else {
                let clockwise = select(0u, 1u, dir < 0.0);
                notes[id.x * LOG + events] = vec4<u32>(point, vertex, bitcast<u32>(farthest), clockwise);
                events++;
                farthest = 0.0;
                if is_wrap {
                    let side = select(0u, 0x80000000u, dir < 0.0);
                    stacks[top] = vec4<u32>(vertex | side, met, bitcast<u32>(next_way.x), bitcast<u32>(next_way.y));
                }
                depth = select(depth - 1u, depth + 1u, is_wrap);
                pivot = next;
                fan = head.x;
                count = head.y;
                let moved = bitcast<vec2<i32>>(head.zw);
                wa = vec2<f32>(point_at(point) - moved);
                wb = vec2<f32>(point_at(min(point + 1u, last)) - moved);
                origin = moved;
                low_number = found;
                low = ray_at(head.x + low_number);
                high = ray_at(head.x + select(found + 1u, 0u, found + 1u >= head.y));
                way = next_way;
                back = next_back;
                way_low = next_way_low;
            }
        }
    }
    // A leg that was met halfway is the CPU's.
    if does == RUNS && dir != 0.0 {
        does = STOPPED;
    }
    lanes[id.x] = Lane(
        point, last, pivot, low_number, depth, deeper, does, events, way, back, farthest, number, way_low, 0u, 0u,
    );
}
