// What kernels that find candidates are asked.

// A swept triangle, as three half-planes in the frame's unit (xy: the normal, pointing inwards; z: the offset): p is
// inside where dot(normal, p) + offset >= 0. And the places, counted over all pages, of the vertices to be tried.
struct Query {
    right: vec3<f32>,
    first: u32,
    left: vec3<f32>,
    count: u32,
    far: vec3<f32>,
    unused: u32,
}

@group(0) @binding(1) var<storage, read> queries: array<Query>;

