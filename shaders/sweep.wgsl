// The candidate pass: which vertices can the rope's last leg meet while it sweeps a triangle?
//
// One lane takes one query and tries every vertex of one chunk. The vertices lie in a uniform buffer and every lane
// reads the same one at the same time. The test is conservative: it may name a vertex too many, never one too few (the
// margin is in the query; `src/candidates/query.rs` derives it). The CPU decides exactly.
//
// The twin on the CPU is `src/candidates/cpu.rs`.

// A swept triangle, as three half-planes in the frame's unit: p is inside where dot(normal, p) + offset >= 0.
// x, y: the unit normal, pointing inwards; z: the offset; w: unused.
struct Query {
    right: vec4<f32>,
    left: vec4<f32>,
    far: vec4<f32>,
}

// How many vertices are inside, and the numbers of the first 15 of them. A count above 15 is an overflow.
struct Found {
    count: u32,
    vertices: array<u32, 15>,
}

// Up to 8190 vertices, two to a vec4.
struct Chunk {
    // The number of the first vertex, in the scene.
    first: u32,
    // How many vertices there are in this chunk.
    count: u32,
    unused: vec2<u32>,
    pairs: array<vec4<f32>, 4095>,
}

struct Round {
    // How many queries there are this time.
    queries: u32,
    unused_x: u32,
    unused_y: u32,
    unused_z: u32,
}

@group(0) @binding(0) var<uniform> round: Round;
@group(0) @binding(1) var<uniform> chunk: Chunk;
@group(0) @binding(2) var<storage, read> queries: array<Query>;
@group(0) @binding(3) var<storage, read_write> found: array<Found>;

fn inside(query: Query, p: vec2<f32>) -> bool {
    let right = query.right.x * p.x + query.right.y * p.y + query.right.z;
    let left = query.left.x * p.x + query.left.y * p.y + query.left.z;
    let far = query.far.x * p.x + query.far.y * p.y + query.far.z;
    return min(min(right, left), far) >= 0.0;
}

fn name_vertex(lane: u32, count: u32, vertex: u32) {
    if count < 15u {
        found[lane].vertices[count] = vertex;
    }
}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>) {
    let lane = id.x;
    if lane >= round.queries {
        return;
    }
    let query = queries[lane];
    // Chunks come one dispatch after the other; the first starts the list.
    var count = 0u;
    if chunk.first > 0u {
        count = found[lane].count;
    }
    let pairs = (chunk.count + 1u) / 2u;
    for (var i = 0u; i < pairs; i++) {
        let pair = chunk.pairs[i];
        if inside(query, pair.xy) {
            name_vertex(lane, count, chunk.first + 2u * i);
            count++;
        }
        // The last pair of an odd chunk holds one vertex only.
        if inside(query, pair.zw) && 2u * i + 1u < chunk.count {
            name_vertex(lane, count, chunk.first + 2u * i + 1u);
            count++;
        }
    }
    found[lane].count = count;
}
