// What a device makes of f32: sums and products, alone and put together in every shape in which the kernels put them
// together.
//
// One lane takes one sample, and for each shape a sample of its own, so that nothing is computed for two of them at
// once. `src/gpu/arithmetic.rs` compares the results with exact ones. `src/gpu/shapes` names the shapes in the order in
// which they come here, and holds them against the kernels' source.

struct Sample {
    // The normal of a half-plane, and its offset.
    normal: vec2<f32>,
    // Vertices.
    p: vec2<f32>,
    q: vec2<f32>,
    // The ends of a leg.
    a: vec2<f32>,
    b: vec2<f32>,
    // What is taken from vertices.
    origin: vec2<f32>,
    offset: f32,
    // 1 or -1.
    dir: f32,
}

struct Result {
    product: f32,
    sum: f32,
    least: f32,
    // 1 if the least is 0 or above.
    holds: u32,
    shapes: array<f32, 18>,
}

@group(0) @binding(0) var<storage, read> samples: array<Sample>;
@group(0) @binding(1) var<storage, read_write> results: array<Result>;

fn cross_of(u: vec2<f32>, v: vec2<f32>) -> f32 {
    return u.x * v.y - u.y * v.x;
}

fn dot_of(u: vec2<f32>, v: vec2<f32>) -> f32 {
    return u.x * v.x + u.y * v.y;
}

// The sample of a lane for a shape.
fn at(lane: u32, shape: u32) -> Sample {
    return samples[(lane + shape) % arrayLength(&samples)];
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let lane = id.x;
    if lane >= arrayLength(&samples) {
        return;
    }
    // Of a half-plane, as `sweep.wgsl` computes it.
    let s0 = at(lane, 0u);
    let value = s0.normal.x * s0.p.x + s0.normal.y * s0.p.y + s0.offset;
    // Usual ones that the kernels do not have.
    let s1 = at(lane, 1u);
    let both = s1.normal.x * s1.p.x + s1.offset;
    let s2 = at(lane, 2u);
    let there_and_back = (s2.normal.x + s2.offset) - s2.normal.x;
    let s3 = at(lane, 3u);
    let back_and_there = (s3.normal.x - s3.offset) + s3.offset;
    // Those of `decide.wgsl`.
    let s4 = at(lane, 4u);
    let way = s4.p.x - s4.origin.x;
    let s5 = at(lane, 5u);
    let dot = dot_of(s5.a, s5.b);
    let s6 = at(lane, 6u);
    let cross = cross_of(s6.a, s6.b);
    let s7 = at(lane, 7u);
    let turn = cross_of(s7.a, s7.b) * s7.dir;
    let s8 = at(lane, 8u);
    let dot_of_way = dot_of(s8.normal, s8.p - s8.origin);
    let s9 = at(lane, 9u);
    let reach = s9.offset - dot_of(s9.normal, s9.p - s9.origin);
    let s10 = at(lane, 10u);
    let turn_to_way = cross_of(s10.normal, s10.p - s10.origin) * s10.dir;
    let s11 = at(lane, 11u);
    let cross_from_way = cross_of(s11.p - s11.origin, s11.a);
    let s12 = at(lane, 12u);
    let turn_from_way = cross_of(s12.p - s12.origin, s12.a) * s12.dir;
    let s13 = at(lane, 13u);
    let passes = cross_of(s13.a - s13.p, s13.b - s13.p) * s13.dir;
    let s14 = at(lane, 14u);
    let way14 = s14.p - s14.origin;
    let passes_way = cross_of(s14.a - way14, s14.b - way14) * s14.dir;
    let s15 = at(lane, 15u);
    let further = dot_of(s15.a, s15.b - s15.a);
    let s16 = at(lane, 16u);
    let way16 = s16.p - s16.origin;
    let further_than_way = dot_of(way16, s16.q - way16);
    let s17 = at(lane, 17u);
    let way17 = s17.p - s17.origin;
    let further_way = dot_of(way17, (s17.q - s17.origin) - way17);

    let product = s0.normal.x * s0.p.x;
    let sum = s0.normal.x + s0.offset;
    let least = min(min(s0.normal.x, s0.p.x), s0.offset);
    let holds = select(0u, 1u, least >= 0.0);
    results[lane] = Result(product, sum, least, holds, array<f32, 18>(
        value, both, there_and_back, back_and_there, way, dot, cross, turn, dot_of_way, reach, turn_to_way,
        cross_from_way, turn_from_way, passes, passes_way, further, further_than_way, further_way,
    ));
}
