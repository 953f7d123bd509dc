// Deciding in f32: which event does the rope's last leg meet first?
//
// One lane takes one question: a window of legs about one pivot. It looks through the vertices of the pivot's list for
// those in the wedge that the legs span. These it tries leg by leg, by the rules of the exact update
// (`src/rope/update.rs`) with rounded cross products in the place of exact signs. Nobody confirms its answer.
//
// The twin on the CPU is `src/fast/decide.rs`. All is compared as cross products, so nothing is divided; coordinates
// are bounded, so nothing is infinite.
//
// `shared/lists.wgsl` stands before this.

// The leg of no event, and the place of the pivot's unwrap.
const NOTHING: u32 = 0xffffffffu;
const UNWRAP: u32 = 0xffffffffu;

// By how much the wedge is grown, in the frame's unit: 2^-18.
const MARGIN: f32 = 0.000003814697265625;

// A window of legs about one pivot; `src/fast/question.rs` says what everything is.
struct Question {
    right: vec2<f32>,
    left: vec2<f32>,
    ahead: vec2<f32>,
    origin: vec2<f32>,
    start: vec2<f32>,
    way: vec2<f32>,
    reach: f32,
    dir: f32,
    back: f32,
    wrapped: u32,
    first: u32,
    count: u32,
    points: u32,
    legs: u32,
    barred: u32,
    unused_x: u32,
    unused_y: u32,
    unused_z: u32,
}

// The first event of the window.
struct Answer {
    leg: u32,
    place: u32,
    dir: f32,
    unused: u32,
    at: vec2<f32>,
}

@group(0) @binding(1) var<storage, read> questions: array<Question>;
@group(0) @binding(2) var<storage, read_write> answers: array<Answer>;
@group(0) @binding(3) var<storage, read> points: array<vec2<f32>>;

// How many vertices a lane keeps before it tries them. Lanes that try what they keep at the same time wait less for
// each other, and each point is read once for all of them.
const KEPT: u32 = 8u;

var<private> kept: array<vec2<f32>, KEPT>;
var<private> numbers: array<u32, KEPT>;

fn cross_of(u: vec2<f32>, v: vec2<f32>) -> f32 {
    return u.x * v.y - u.y * v.x;
}

fn dot_of(u: vec2<f32>, v: vec2<f32>) -> f32 {
    return u.x * v.x + u.y * v.y;
}

fn in_wedge(question: Question, p: vec2<f32>) -> bool {
    let sides = min(dot_of(question.right, p), dot_of(question.left, p));
    return min(sides, question.reach - dot_of(question.ahead, p)) >= -MARGIN;
}

fn is_left(way: vec2<f32>, a: vec2<f32>) -> bool {
    return cross_of(way, a) >= 0.0;
}

fn wraps(p: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let after = is_left(p, b);
    if is_left(p, a) == after {
        return 0.0;
    }
    let dir = select(-1.0, 1.0, after);
    return select(0.0, dir, cross_of(a - p, b - p) * dir >= 0.0);
}

fn wraps_further(question: Question, number: u32, p: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let dir = question.dir;
    let turn = cross_of(question.start, p) * dir;
    let goes_on = turn == 0.0 && question.wrapped == 1u && dot_of(question.start, p) > 0.0;
    let comes_after = turn > 0.0 || goes_on;
    let is_past = is_left(p, b) == (dir > 0.0) && cross_of(a - p, b - p) * dir >= 0.0;
    return select(0.0, dir, number != question.barred && comes_after && is_past);
}

fn meets_before(p: vec2<f32>, q: vec2<f32>, dir: f32) -> bool {
    let order = cross_of(p, q) * dir;
    return order > 0.0 || (order == 0.0 && dot_of(p, q - p) > 0.0);
}

fn unwraps(question: Question, a: vec2<f32>, b: vec2<f32>) -> bool {
    let is_past = is_left(question.way, b) == (question.back > 0.0);
    let was_past = is_left(question.way, a) == (question.back > 0.0);
    let crosses = cross_of(a, b) * question.back >= 0.0;
    return is_past && select(crosses, dot_of(question.way, b) > 0.0, was_past);
}

fn unwraps_further(question: Question, a: vec2<f32>, b: vec2<f32>) -> bool {
    let is_past = is_left(question.way, b) == (question.back > 0.0) && cross_of(a, b) * question.back >= 0.0;
    let is_ahead = cross_of(question.start, question.way) * question.back > 0.0
        || dot_of(question.start, question.way) > 0.0;
    return question.dir == question.back && is_past && is_ahead;
}

// Whether the unwrapping ray lies in the wedge.
fn is_pivot_in_wedge(question: Question) -> bool {
    let sides = min(dot_of(question.right, question.way), dot_of(question.left, question.way));
    return question.back != 0.0 && sides >= -MARGIN;
}

// The first event of the first `count` of the vertices kept and, if asked for, of the pivot, if it comes before `met`:
// else that.
fn try_legs(question: Question, count: u32, with_pivot: bool, met_before: Answer) -> Answer {
    var met = met_before;
    if count == 0u && !with_pivot {
        return met;
    }
    var a = points[question.points];
    for (var leg = 0u; leg < question.legs && leg <= met.leg; leg++) {
        let b = points[question.points + leg + 1u];
        let has_turned = leg == 0u && question.dir != 0.0;
        for (var i = 0u; i < count; i++) {
            let p = kept[i];
            var dir = 0.0;
            if has_turned {
                dir = wraps_further(question, numbers[i], p, a, b);
            } else {
                dir = wraps(p, a, b);
            }
            if dir != 0.0 && (leg < met.leg || meets_before(p, met.at, dir)) {
                met = Answer(leg, question.first + numbers[i], dir, 0u, p);
            }
        }
        if with_pivot {
            var turns_back = false;
            if has_turned {
                turns_back = unwraps_further(question, a, b);
            } else {
                turns_back = unwraps(question, a, b);
            }
            // On the same leg, the wrap is first where both lie on one line.
            if turns_back && (leg < met.leg || cross_of(question.way, met.at) * question.back > 0.0) {
                return Answer(leg, UNWRAP, question.back, 0u, vec2<f32>(0.0, 0.0));
            }
        }
        a = b;
    }
    return met;
}

@compute @workgroup_size(WORKGROUP)
fn decide(@builtin(global_invocation_id) id: vec3<u32>) {
    let lane = span.first + id.x;
    if lane >= span.end {
        return;
    }
    let question = questions[lane];
    // A list that began in an earlier page goes on here.
    var met = Answer(NOTHING, 0u, 0.0, 0u, vec2<f32>(0.0, 0.0));
    if question.first < page.first {
        met = answers[lane];
    }
    let last = question.first + question.count;
    let end = min(last, page.first + PAGE);
    var count = 0u;
    for (var place = max(question.first, page.first); place < end; place += 2u) {
        let pair = page.pairs[(place - page.first) / 2u];
        let p = pair.xy - question.origin;
        if in_wedge(question, p) {
            kept[count] = p;
            numbers[count] = place - question.first;
            count++;
        }
        let q = pair.zw - question.origin;
        // An odd number of vertices ends with half a pair.
        if place + 1u < end && in_wedge(question, q) {
            kept[count] = q;
            numbers[count] = place + 1u - question.first;
            count++;
        }
        if count > KEPT - 2u {
            met = try_legs(question, count, false, met);
            count = 0u;
        }
    }
    // The pivot goes with the last page of its list.
    answers[lane] = try_legs(question, count, last <= page.first + PAGE && is_pivot_in_wedge(question), met);
}
