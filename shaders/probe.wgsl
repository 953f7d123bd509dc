// What a device makes of f32: sums and products, alone and put together as the kernels put them together.
//
// One lane takes one sample. `src/gpu/arithmetic.rs` compares the results with exact ones.

struct Sample {
    // The normal of a half-plane.
    normal: vec2<f32>,
    p: vec2<f32>,
    // Its offset.
    offset: f32,
    unused_x: f32,
    unused_y: f32,
    unused_z: f32,
}

struct Result {
    product: f32,
    sum: f32,
    // A product and a sum, which may be fused.
    both: f32,
    // What is left of the offset once something was added to it and taken away again.
    rest: f32,
    // The half-plane's value at p, as `sweep.wgsl` computes it.
    value: f32,
    least: f32,
    // 1 if the least is 0 or above.
    holds: u32,
    unused: f32,
}

@group(0) @binding(0) var<storage, read> samples: array<Sample>;
@group(0) @binding(1) var<storage, read_write> results: array<Result>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&samples) {
        return;
    }
    let sample = samples[id.x];
    let product = sample.normal.x * sample.p.x;
    let sum = sample.normal.x + sample.offset;
    let both = sample.normal.x * sample.p.x + sample.offset;
    let rest = (sample.normal.x + sample.offset) - sample.normal.x;
    let value = sample.normal.x * sample.p.x + sample.normal.y * sample.p.y + sample.offset;
    let least = min(min(sample.normal.x, sample.p.x), sample.offset);
    let holds = select(0u, 1u, least >= 0.0);
    results[id.x] = Result(product, sum, both, rest, value, least, holds, 0.0);
}
