// The ray method as it is written: every query tries all vertices. It measures throughput.
//
// All queries try the same list, so all lanes read the same vertices at the same time, and a lane takes eight queries,
// so that each read serves eight tests. A test is six products, six sums and what puts three signs together. It says no
// more than which blocks of the list hold a vertex that is inside: few do, and naming vertices here would take longer
// than trying them. The CPU tries a block that is named again, by the twin, `Simd::sweep` in `src/candidates/simd.rs`.
//
// The test is conservative: it may name a block too many, never one too few (the margin is in the query;
// `src/candidates/query.rs` derives it). The CPU decides exactly.
//
// `shared/lists.wgsl` and `shared/query.wgsl` stand before this.

// How many queries a lane takes.
const QUERIES: u32 = 8u;

// How many vertices a block has, or a multiple of that in lists of more than BLOCK * BLOCKS vertices.
const BLOCK: u32 = 16u;

// How many blocks a list has at most: the bits of an answer.
const BLOCKS: u32 = 512u;

// How many bits a word has.
const BITS: u32 = 32u;

// Which blocks hold a vertex that is inside: bit i of word j stands for block 32 j + i. Words without blocks mean
// nothing.
struct Blocks {
    words: array<u32, 16>,
}

@group(0) @binding(2) var<storage, read_write> blocks: array<Blocks>;

// The triangles of four queries, side by side.
struct Four {
    right_x: vec4<f32>,
    right_y: vec4<f32>,
    right: vec4<f32>,
    left_x: vec4<f32>,
    left_y: vec4<f32>,
    left: vec4<f32>,
    far_x: vec4<f32>,
    far_y: vec4<f32>,
    far: vec4<f32>,
}

// The queries from number `first` on. Those beyond the last are whatever is there; nothing is written for them.
fn four(first: u32) -> Four {
    let a = queries[first];
    let b = queries[first + 1u];
    let c = queries[first + 2u];
    let d = queries[first + 3u];
    return Four(
        vec4(a.right.x, b.right.x, c.right.x, d.right.x),
        vec4(a.right.y, b.right.y, c.right.y, d.right.y),
        vec4(a.right.z, b.right.z, c.right.z, d.right.z),
        vec4(a.left.x, b.left.x, c.left.x, d.left.x),
        vec4(a.left.y, b.left.y, c.left.y, d.left.y),
        vec4(a.left.z, b.left.z, c.left.z, d.left.z),
        vec4(a.far.x, b.far.x, c.far.x, d.far.x),
        vec4(a.far.y, b.far.y, c.far.y, d.far.y),
        vec4(a.far.z, b.far.z, c.far.z, d.far.z),
    );
}

// For each query a number whose highest bit is 0 if p is inside. A value of -0 counts as outside here: what must be
// found lies further inside than that, by the margin.
fn outside(four: Four, p: vec2<f32>) -> vec4<u32> {
    let right = four.right_x * p.x + four.right_y * p.y + four.right;
    let left = four.left_x * p.x + four.left_y * p.y + four.left;
    let far = four.far_x * p.x + four.far_y * p.y + four.far;
    return bitcast<vec4<u32>>(right) | bitcast<vec4<u32>>(left) | bitcast<vec4<u32>>(far);
}

// Writes a word of the blocks of a query; that which its first blocks had in an earlier page stays if it is gone on
// with.
fn write(query: u32, word: u32, bits: u32, goes_on: bool) {
    if query < span.end {
        blocks[query].words[word] = select(0u, blocks[query].words[word], goes_on) | bits;
    }
}

@compute @workgroup_size(WORKGROUP)
fn rays(@builtin(global_invocation_id) id: vec3<u32>) {
    let query = span.first + QUERIES * id.x;
    if query >= span.end {
        return;
    }
    // The list of all queries, and what of it lies in this page.
    let list = queries[span.first].first;
    let count = queries[span.first].count;
    let block = BLOCK * ((count + BLOCK * BLOCKS - 1u) / (BLOCK * BLOCKS));
    var place = max(list, page.first);
    let end = min(list + count, page.first + PAGE);
    let a = four(query);
    let b = four(query + 4u);
    while place < end {
        let word = (place - list) / (BITS * block);
        let goes_on = place - list > word * BITS * block;
        let word_end = min(list + (word + 1u) * BITS * block, end);
        var inside_a = vec4(0u);
        var inside_b = vec4(0u);
        while place < word_end {
            let block_end = min(place + block - (place - list) % block, word_end);
            var outside_a = vec4(0xffffffffu);
            var outside_b = vec4(0xffffffffu);
            let past = (block_end - page.first + 1u) / 2u;
            for (var i = (place - page.first) / 2u; i < past; i++) {
                // An odd number of vertices ends with half a pair; its other half does no harm.
                let pair = page.pairs[i];
                outside_a &= outside(a, pair.xy) & outside(a, pair.zw);
                outside_b &= outside(b, pair.xy) & outside(b, pair.zw);
            }
            inside_a = (inside_a >> vec4(1u)) | (~outside_a & vec4(0x80000000u));
            inside_b = (inside_b >> vec4(1u)) | (~outside_b & vec4(0x80000000u));
            place = block_end;
        }
        // The last block's bit is the highest so far.
        let unused = vec4(BITS - 1u - ((place - 1u - list) / block) % BITS);
        inside_a = inside_a >> unused;
        inside_b = inside_b >> unused;
        write(query, word, inside_a.x, goes_on);
        write(query + 1u, word, inside_a.y, goes_on);
        write(query + 2u, word, inside_a.z, goes_on);
        write(query + 3u, word, inside_a.w, goes_on);
        write(query + 4u, word, inside_b.x, goes_on);
        write(query + 5u, word, inside_b.y, goes_on);
        write(query + 6u, word, inside_b.z, goes_on);
        write(query + 7u, word, inside_b.w, goes_on);
    }
}
