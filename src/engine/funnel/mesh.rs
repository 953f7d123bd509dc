//! A triangulation of the vertices, wide enough that no trace leaves it.

use glam::DVec2;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::engine::EngineError;
use crate::geometry::{TracePoint, left_of};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// A triangle: its corners counter-clockwise, and behind the edge from corner i to corner i + 1 its neighbour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    pub neighbours: [Option<u32>; 3],
}

/// The triangulation. Its first vertices are the model's, the last four the corners of a frame far outside, which no
/// taut rope reaches.
pub(super) struct Mesh {
    pub vertices: Vec<DVec2>,
    pub triangles: Vec<Triangle>,
}

impl Mesh {
    pub(super) fn new(model: &Model, traces: &[SettledTrace]) -> Result<Mesh, EngineError> {
        let mut vertices = model.vertices().to_vec();
        let points = traces.iter().flat_map(|t| t.points());
        let (low, high) = points.fold(model.bounds(), |(l, h), &p| (l.min(p), h.max(p)));
        let centre = low / 2.0 + high / 2.0;
        let mut half = (high - low).max_element();
        if half == 0.0 {
            half = centre.abs().max_element().max(1.0);
        }
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        vertices.extend(corners.map(|c| centre + 2.0 * half * DVec2::from(c)));
        // The library takes magnitudes from 2^-142 to 2^201: scaled by a power of two, which is exact.
        let size = vertices.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        let scale = 2f64.powi(-(size.log2().floor() as i32));
        let scaled = vertices.iter().map(|p| Point2::new(p.x * scale, p.y * scale)).collect();
        let unfit = |why: String| EngineError::Unfit { engine: "funnel", why };
        let delaunay = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(scaled)
            .map_err(|e| unfit(format!("its triangulation takes no vertex like these: {e}")))?;
        if delaunay.num_vertices() != vertices.len() {
            return Err(unfit("its triangulation cannot tell all vertices apart".to_owned()));
        }
        // The library numbers faces from the outer one, 0.
        let triangles = delaunay
            .inner_faces()
            .map(|face| {
                let edges = face.adjacent_edges();
                Triangle {
                    corners: edges.map(|e| e.from().index() as u32),
                    neighbours: edges.map(|e| e.rev().face().as_inner().map(|f| f.index() as u32 - 1)),
                }
            })
            .collect();
        Ok(Mesh { vertices, triangles })
    }

    pub(super) fn at(&self, vertex: u32) -> DVec2 {
        self.vertices[vertex as usize]
    }

    /// Whether the triangle holds `a`. A point on an edge belongs to the triangle left of the edge as seen from its lower
    /// vertex to its higher, so every point that is no vertex is in one triangle only.
    pub(super) fn holds(&self, triangle: u32, a: TracePoint) -> bool {
        let [p, q, r] = self.triangles[triangle as usize].corners;
        [(p, q), (q, r), (r, p)]
            .into_iter()
            .all(|(u, v)| if u < v { left_of(self.at(u), self.at(v), a) } else { !left_of(self.at(v), self.at(u), a) })
    }

    /// The triangle that holds `a`, by trying them all.
    pub(super) fn locate(&self, a: TracePoint) -> u32 {
        let held = (0..self.triangles.len() as u32).find(|&t| self.holds(t, a));
        held.expect("the frame holds all points")
    }
}
