//! A triangulation of the vertices, wide enough that no trace leaves it.

use glam::DVec2;
use spade::handles::{DirectedEdgeHandle, FaceHandle, InnerTag};
use spade::{DelaunayTriangulation, InsertionError, Point2, Triangulation};

use super::triangle::{Door, NEXT, Triangle};
use crate::geometry::{TracePoint, higher, left_of, lower};
use crate::scene::Model;
use crate::trace::{self, SettledTrace};

/// A box: its lowest and highest x and y.
type Bounds = (DVec2, DVec2);

/// Why vertices cannot be triangulated.
#[derive(Debug, thiserror::Error)]
pub(super) enum MeshError {
    /// One is too small or too large beside the largest.
    #[error("its triangulation takes no vertex like these: {0}")]
    Vertex(#[from] InsertionError),
    /// Two become one.
    #[error("its triangulation cannot tell all vertices apart")]
    Alike,
}

/// The triangulation. Its vertices are the model's and, numbered behind them, the four corners of a frame far outside,
/// which no taut rope reaches.
pub(super) struct Mesh {
    triangles: Vec<Triangle>,
    /// The vertices of each triangle, in the order of its corners.
    names: Vec<[u32; 3]>,
    /// The triangles that the anchor stands in or touches: in one of them every trace starts.
    starts: Vec<u32>,
    frame: Bounds,
}

impl Mesh {
    /// A mesh for `model` whose frame lies well outside of `bounds`, which hold all its vertices and its anchor.
    pub(super) fn new(model: &Model, bounds: Bounds) -> Result<Mesh, MeshError> {
        let frame = frame(bounds);
        let (low, high) = frame;
        let mut vertices = model.vertices().to_vec();
        vertices.extend([low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]);
        let delaunay = triangulate(&vertices)?;
        let mut mesh = Mesh { triangles: vec![], names: vec![], starts: vec![], frame };
        for face in delaunay.inner_faces() {
            let edges = face.adjacent_edges();
            let names = edges.map(|e| e.from().index() as u32);
            mesh.names.push(names);
            let beyond = edges.map(|e| e.rev().face().as_inner().map_or(Door::NONE, |f| door(f, e.rev())));
            mesh.triangles.push(Triangle { corners: names.map(|v| vertices[v as usize]), beyond });
        }
        let touches = |&t: &u32| mesh.triangles[t as usize].touches(model.anchor());
        mesh.starts = (0..mesh.triangles.len() as u32).filter(touches).collect();
        Ok(mesh)
    }

    /// Whether all of `bounds` lies inside the frame.
    pub(super) fn covers(&self, (low, high): Bounds) -> bool {
        low.cmpgt(self.frame.0).all() && high.cmplt(self.frame.1).all()
    }

    #[inline]
    pub(super) fn triangle(&self, triangle: u32) -> &Triangle {
        &self.triangles[triangle as usize]
    }

    /// The vertex at one of a triangle's corners: its number and where it stands.
    #[inline]
    pub(super) fn corner(&self, triangle: u32, corner: usize) -> (u32, DVec2) {
        (self.names[triangle as usize][corner], self.triangles[triangle as usize].corners[corner])
    }

    /// The edges of a triangle behind which `a` lies, edge i as bit i. A point on an edge belongs to the triangle left
    /// of the edge as seen from its lower vertex to its higher, so every point that is no vertex is in one triangle
    /// only.
    #[cold]
    pub(super) fn behind(&self, triangle: u32, a: TracePoint) -> usize {
        let is_inside = |edge| {
            let ((u, p), (v, q)) = (self.corner(triangle, edge), self.corner(triangle, NEXT[edge]));
            if u < v { left_of(p, q, a) } else { !left_of(q, p, a) }
        };
        (0..3).map(|edge| usize::from(!is_inside(edge)) << edge).sum()
    }

    /// The triangle that holds `a`, a hair off the anchor or on it.
    pub(super) fn start(&self, a: TracePoint) -> u32 {
        let holds = |&&t: &&u32| self.behind(t, a) == 0;
        *self.starts.iter().find(holds).expect("the frame holds all points")
    }
}

/// The bounds of the model and all traces.
pub(super) fn bounds(model: &Model, traces: &[SettledTrace]) -> Bounds {
    let (low, high) = model.bounds();
    trace::bounds(traces).map_or((low, high), |(l, h)| (lower(l, low), higher(h, high)))
}

/// A frame so far outside of `bounds` that most other traces in the scene fit into it as well.
fn frame((low, high): Bounds) -> Bounds {
    let centre = low / 2.0 + high / 2.0;
    let mut half = (high - low).max_element();
    if half == 0.0 {
        half = centre.abs().max_element().max(1.0);
    }
    (centre - 2.0 * half, centre + 2.0 * half)
}

fn triangulate(vertices: &[DVec2]) -> Result<DelaunayTriangulation<Point2<f64>>, MeshError> {
    // The library takes magnitudes from 2^-142 to 2^201: scaled by a power of two, which is exact.
    let size = vertices.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let scale = 2f64.powi(-(size.log2().floor() as i32));
    let scaled = vertices.iter().map(|p| Point2::new(p.x * scale, p.y * scale)).collect();
    let delaunay = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(scaled)?;
    if delaunay.num_vertices() != vertices.len() {
        return Err(MeshError::Alike);
    }
    Ok(delaunay)
}

/// The door through `edge` of `face`.
fn door(
    face: FaceHandle<'_, InnerTag, Point2<f64>, (), (), ()>,
    edge: DirectedEdgeHandle<'_, Point2<f64>, (), (), ()>,
) -> Door {
    let place = face.adjacent_edges().iter().position(|e| *e == edge).expect("an edge of the face");
    // The library numbers faces from the outer one, 0.
    Door::new(face.index() as u32 - 1, place)
}
