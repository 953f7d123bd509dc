// Lists of vertices on the device, which every kernel goes through: this stands before each kernel's own source.
//
// Lists lie in pages, each a uniform buffer; places are counted through all of them. Queries come sorted by list, so
// that neighbouring lanes read the same vertices at the same time. A dispatch answers the queries whose lists lie in
// one page; a list that goes on in the next page is gone on with in the next dispatch.

// How many vertices a page holds, two to a vec4.
const PAGE: u32 = 8190u;

struct Page {
    // The place of its first vertex; even.
    first: u32,
    unused_x: u32,
    unused_y: u32,
    unused_z: u32,
    pairs: array<vec4<f32>, 4095>,
}

// The queries that this dispatch answers.
struct Span {
    first: u32,
    end: u32,
    unused_x: u32,
    unused_y: u32,
}

@group(0) @binding(0) var<uniform> span: Span;
@group(1) @binding(0) var<uniform> page: Page;

override WORKGROUP: u32 = 64u;

