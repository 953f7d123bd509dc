// The candidate pass: which vertices can the rope's last leg meet while it sweeps a triangle?
//
// One lane takes one query and tries the vertices of its pivot's list. The test is conservative: it may name a vertex
// too many, never one too few (the margin is in the query; `src/candidates/query.rs` derives it). The CPU decides
// exactly.
//
// The twin on the CPU is `Simd::sweep` in `src/candidates/simd.rs`.
//
// `shared/lists.wgsl` and `shared/query.wgsl` stand before this.

// How many vertices are inside, and the places of the first 15 of them. A count above 15 is an overflow.
struct Found {
    count: u32,
    places: array<u32, 15>,
}

@group(0) @binding(2) var<storage, read_write> found: array<Found>;

fn inside(query: Query, p: vec2<f32>) -> bool {
    let right = query.right.x * p.x + query.right.y * p.y + query.right.z;
    let left = query.left.x * p.x + query.left.y * p.y + query.left.z;
    let far = query.far.x * p.x + query.far.y * p.y + query.far.z;
    return min(min(right, left), far) >= 0.0;
}

fn name_place(lane: u32, count: u32, place: u32) {
    if count < 15u {
        found[lane].places[count] = place;
    }
}

@compute @workgroup_size(WORKGROUP)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>) {
    let lane = span.first + id.x;
    if lane >= span.end {
        return;
    }
    let query = queries[lane];
    // A list that began in an earlier page goes on here.
    var count = 0u;
    if query.first < page.first {
        count = found[lane].count;
    }
    // Lists begin at even places, and so do pages. A query that tries less of its list than its neighbours do may have
    // ended before this page.
    let end = min(query.first + query.count, page.first + PAGE);
    for (var place = max(query.first, page.first); place < end; place += 2u) {
        let pair = page.pairs[(place - page.first) / 2u];
        if inside(query, pair.xy) {
            name_place(lane, count, place);
            count++;
        }
        // An odd number of vertices ends with half a pair.
        if inside(query, pair.zw) && place + 1u < end {
            name_place(lane, count, place + 1u);
            count++;
        }
    }
    found[lane].count = count;
}
