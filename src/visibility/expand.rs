//! Triangular expansion: looking through the triangles of the mesh from one of its vertices.

use super::mesh::{CLOSED, Mesh, next};
use crate::geometry::orient;

/// Memory that looks share, one after the other.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The look in which each vertex was seen last.
    seen_in: Vec<u32>,
    look: u32,
    views: Vec<View>,
}

impl Scratch {
    /// Starts a look at a mesh of `vertices` vertices.
    fn start(&mut self, vertices: usize) {
        self.views.clear();
        if self.look == u32::MAX || self.seen_in.len() != vertices {
            self.seen_in.clear();
            self.seen_in.resize(vertices, 0);
            self.look = 0;
        }
        self.look += 1;
    }
}

/// What is still to be looked at: the triangle behind an edge, between two rays.
#[derive(Debug, Clone, Copy)]
struct View {
    /// The edge as seen from inside the triangle to be looked at.
    edge: u32,
    /// The vertices that bound the view.
    right: u32,
    left: u32,
}

impl Mesh {
    /// Adds all vertices of the model that are visible from mesh vertex `o`, in the closed sense, to `seen`, each once.
    ///
    /// A view is an open cone between two vertices seen before; what lies in it or on its bounding rays is listed. So a
    /// vertex that a line of sight grazes is listed, and what can be left out lies exactly behind another.
    pub(super) fn expand(&self, o: u32, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        scratch.start(self.real() as usize);
        let at = self.at(o);
        for &spoke in self.fan(o) {
            let across = next(spoke);
            let (right, left) = (self.edge(across).origin, self.edge(next(across)).origin);
            self.see(right, scratch, seen);
            self.see(left, scratch, seen);
            let beyond = self.edge(across).twin;
            if beyond != CLOSED {
                scratch.views.push(View { edge: beyond, right, left });
            }
        }
        while let Some(View { edge, right, left }) = scratch.views.pop() {
            // The triangle behind the edge: from the edge's right end to the apex, and from the apex to its left end.
            let (to_apex, from_apex) = (next(edge), next(next(edge)));
            let apex = self.edge(from_apex).origin;
            let p = self.at(apex);
            let (from_right, from_left) = (orient(at, self.at(right), p), orient(at, self.at(left), p));
            if from_right >= 0.0 && from_left <= 0.0 {
                self.see(apex, scratch, seen);
            }
            let beyond = self.edge(to_apex).twin;
            if beyond != CLOSED && from_right > 0.0 {
                scratch.views.push(View { edge: beyond, right, left: if from_left < 0.0 { apex } else { left } });
            }
            let beyond = self.edge(from_apex).twin;
            if beyond != CLOSED && from_left < 0.0 {
                scratch.views.push(View { edge: beyond, right: if from_right > 0.0 { apex } else { right }, left });
            }
        }
    }

    #[inline]
    fn see(&self, vertex: u32, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        if vertex < self.real() && scratch.seen_in[vertex as usize] != scratch.look {
            scratch.seen_in[vertex as usize] = scratch.look;
            seen.push(vertex);
        }
    }
}
