// Products and sums and nothing else: what a device can do at the most.
//
// A lane keeps sixteen numbers that do not depend on each other, as many as hide how long a product and a sum take, and
// multiplies and adds to each of them. `src/gpu/peak.rs` counts them.

// How many products, and as many sums, a round has.
const PRODUCTS: u32 = 64u;

struct Work {
    rounds: u32,
    factor: f32,
    addend: f32,
    unused: u32,
}

@group(0) @binding(0) var<storage, read> work: array<Work>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;

@compute @workgroup_size(64)
fn peak(@builtin(global_invocation_id) id: vec3<u32>) {
    let lane = id.x;
    if lane >= arrayLength(&results) {
        return;
    }
    let rounds = work[0].rounds;
    let factor = work[0].factor;
    let addend = work[0].addend;
    var a = vec4(f32(lane), 1.0, 2.0, 3.0);
    var b = a + vec4(4.0);
    var c = a + vec4(8.0);
    var d = a + vec4(12.0);
    for (var round = 0u; round < rounds; round++) {
        a = a * factor + addend;
        b = b * factor + addend;
        c = c * factor + addend;
        d = d * factor + addend;
        a = a * factor + addend;
        b = b * factor + addend;
        c = c * factor + addend;
        d = d * factor + addend;
        a = a * factor + addend;
        b = b * factor + addend;
        c = c * factor + addend;
        d = d * factor + addend;
        a = a * factor + addend;
        b = b * factor + addend;
        c = c * factor + addend;
        d = d * factor + addend;
    }
    let all = (a + b) + (c + d);
    results[lane] = (all.x + all.y) + (all.z + all.w);
}
