//! The constrained triangulation of a scene's walls, laid out for walking through it.

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::crossings::crossings;
use crate::geometry::{between, orient};
use crate::scene::Model;

/// Into how many pieces walls may be cut by vertices that lie on them, on average, before the rest stays out, which is safe:
/// thousands of walls that lie on each other would be cut into millions.
const PIECES: usize = 16;

/// Marks an edge through which one cannot see: a wall, or the mesh's outer border.
pub(super) const CLOSED: u32 = u32::MAX;

/// An edge of a triangle as seen from inside it. Half-edges 3t, 3t + 1 and 3t + 2 are those of triangle t,
/// counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfEdge {
    /// The vertex at which it starts.
    pub origin: u32,
    /// The same edge as seen from the triangle on its other side, or [`CLOSED`].
    pub twin: u32,
}

/// The triangulation. Its first vertices are the model's; then come the anchor (unless it is one of them), crossings of
/// walls, and four corners far outside.
pub(super) struct Mesh {
    vertices: Vec<DVec2>,
    /// How many of the vertices are the model's.
    real: u32,
    anchor: u32,
    edges: Vec<HalfEdge>,
    /// The half-edges that start at each vertex, and where each vertex's begin.
    fans: Vec<u32>,
    first_fan: Vec<u32>,
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

impl Mesh {
    /// `None` where the triangulation cannot take the coordinates.
    pub(super) fn new(model: &Model) -> Option<Mesh> {
        let mut vertices = model.vertices().to_vec();
        let real = vertices.len() as u32;
        let anchor = model.vertex_at(model.anchor()).unwrap_or(real);
        if anchor == real {
            vertices.push(model.anchor());
        }
        vertices.extend(crossings(model));
        vertices.extend(corners(model));
        let mut cdt = triangulate(&vertices)?;
        let walls = model.scene().walls();
        let (mut added, mut room) = (0, PIECES * walls.len());
        while added < walls.len() && room > 0 {
            // A wall that crosses another where no vertex is stays out: it then hides nothing, which is safe.
            let [u, v] = walls[added].map(handle);
            room = room.saturating_sub(cdt.try_add_constraint(u, v).len());
            added += 1;
        }
        let mut mesh = Mesh::from_cdt(&cdt, vertices, real, anchor);
        mesh.close(&cdt, &walls[..added]);
        Some(mesh)
    }

    fn from_cdt(cdt: &Cdt, vertices: Vec<DVec2>, real: u32, anchor: u32) -> Mesh {
        let mut edges = Vec::with_capacity(3 * cdt.num_inner_faces());
        // The number here of each of the library's edges that has a triangle on its left.
        let mut numbers = vec![CLOSED; cdt.num_directed_edges()];
        for face in cdt.inner_faces() {
            for edge in face.adjacent_edges() {
                numbers[edge.fix().index()] = edges.len() as u32;
                edges.push(HalfEdge { origin: edge.from().fix().index() as u32, twin: CLOSED });
            }
        }
        for edge in cdt.directed_edges() {
            if let Some(half) = edges.get_mut(numbers[edge.fix().index()] as usize) {
                half.twin = numbers[edge.rev().fix().index()];
            }
        }
        let mut first_fan = vec![0; vertices.len() + 1];
        for edge in &edges {
            first_fan[edge.origin as usize + 1] += 1;
        }
        for v in 0..vertices.len() {
            first_fan[v + 1] += first_fan[v];
        }
        let mut fans = vec![0; edges.len()];
        let mut next = first_fan.clone();
        for (number, edge) in (0..).zip(&edges) {
            let slot = &mut next[edge.origin as usize];
            fans[*slot as usize] = number;
            *slot += 1;
        }
        Mesh { vertices, real, anchor, edges, fans, first_fan }
    }

    /// Closes the edges that lie on walls. Only those that are found by following a wall from vertex to vertex are closed,
    /// so whatever else the triangulation holds as constraints hides nothing.
    fn close(&mut self, cdt: &Cdt, walls: &[[u32; 2]]) {
        for &[u, v] in walls {
            let (mut here, end) = (u, self.at(v));
            while here != v {
                let at = self.at(here);
                let along = cdt.vertex(handle(here)).out_edges().find(|edge| {
                    let to = edge.to().fix().index() as u32;
                    let p = self.at(to);
                    edge.is_constraint_edge() && (to == v || orient(at, end, p) == 0.0 && between(at, end, p))
                });
                let Some(edge) = along else { break };
                let next = edge.to().fix().index() as u32;
                self.close_edge(here, next);
                here = next;
            }
        }
    }

    fn close_edge(&mut self, u: u32, v: u32) {
        for (from, to) in [(u, v), (v, u)] {
            let fan = self.first_fan[from as usize] as usize..self.first_fan[from as usize + 1] as usize;
            for &edge in &self.fans[fan] {
                if self.edges[next(edge) as usize].origin == to {
                    self.edges[edge as usize].twin = CLOSED;
                }
            }
        }
    }

    pub(super) fn at(&self, vertex: u32) -> DVec2 {
        self.vertices[vertex as usize]
    }

    /// The mesh's number for a pivot: a vertex of the model, or their number for the anchor.
    pub(super) fn pivot(&self, pivot: u32) -> u32 {
        assert!(pivot <= self.real, "a pivot is a vertex or the anchor");
        if pivot == self.real { self.anchor } else { pivot }
    }

    /// How many of the vertices, the first, are the model's.
    pub(super) fn real(&self) -> u32 {
        self.real
    }

    #[inline]
    pub(super) fn edge(&self, edge: u32) -> HalfEdge {
        self.edges[edge as usize]
    }

    /// The half-edges that start at `vertex`, one in each triangle round it.
    pub(super) fn fan(&self, vertex: u32) -> &[u32] {
        &self.fans[self.first_fan[vertex as usize] as usize..self.first_fan[vertex as usize + 1] as usize]
    }
}

/// The next half-edge of the same triangle.
#[inline]
pub(super) fn next(edge: u32) -> u32 {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

fn handle(vertex: u32) -> spade::handles::FixedVertexHandle {
    spade::handles::FixedVertexHandle::from_index(vertex as usize)
}

/// The corners of a square far outside, so that every vertex has triangles all round it.
fn corners(model: &Model) -> [DVec2; 4] {
    let (low, high) = model.bounds();
    let centre = low / 2.0 + high / 2.0;
    let mut half = (high - low).max_element();
    if half == 0.0 {
        half = centre.abs().max_element().max(1.0);
    }
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| centre + 2.0 * half * DVec2::from(c))
}

fn triangulate(vertices: &[DVec2]) -> Option<Cdt> {
    // The library takes magnitudes from 2^-142 to 2^201: scaled by a power of two, which is exact.
    let size = vertices.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let scale = 2f64.powi(-(size.log2().floor() as i32));
    let scaled = vertices.iter().map(|p| Point2::new(p.x * scale, p.y * scale)).collect();
    let cdt = Cdt::bulk_load_cdt(scaled, Vec::new()).ok()?;
    (cdt.num_vertices() == vertices.len()).then_some(cdt)
}
