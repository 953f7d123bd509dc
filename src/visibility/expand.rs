//! Triangular expansion: looking through the triangles of the mesh from one of its vertices.

use glam::DVec2;

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

    /// Adds what lies behind `edge`, unless nothing is to be seen there.
    #[inline]
    fn look_behind(&mut self, edge: u32, view: View) {
        let is_outside = view.ends[0] & view.ends[1] != 0 || view.right.outside & view.left.outside != 0;
        if edge != CLOSED && !is_outside {
            self.views.push(View { edge, ..view });
        }
    }
}

/// A vertex seen.
#[derive(Debug, Clone, Copy)]
struct Seen {
    vertex: u32,
    /// Outside which of the lines that bound the look it lies, as bits.
    outside: u8,
}

/// What is still to be looked at: the triangle behind an edge, between two rays.
#[derive(Debug, Clone, Copy)]
struct View {
    /// The edge as seen from inside the triangle to be looked at.
    edge: u32,
    /// Outside which lines its right and its left end lie.
    ends: [u8; 2],
    /// The vertices that bound the view.
    right: Seen,
    left: Seen,
}

impl Mesh {
    /// Adds all vertices of the model that are visible from mesh vertex `o`, in the closed sense, to `seen`, each once, and
    /// returns how many triangles were looked at; `None` if it gave up because they were more than `most`.
    ///
    /// A view is an open cone between two vertices seen before; what lies in it or on its bounding rays is listed. So a
    /// vertex that a line of sight grazes is listed, and what can be left out lies exactly behind another.
    ///
    /// Only vertices are listed that lie inside all lines of some kind: `outside` has a bit for each line outside which a
    /// point lies. `o` must lie inside all. Then what lies outside a line stays there when it is moved straight away from
    /// `o`, and so does all that lies between two such points: no view is followed whose two bounding vertices, or whose
    /// edge's two ends, lie outside one line.
    #[inline]
    pub(super) fn expand(
        &self,
        o: u32,
        scratch: &mut Scratch,
        seen: &mut Vec<u32>,
        outside: impl Fn(DVec2) -> u8,
        most: usize,
    ) -> Option<usize> {
        scratch.start(self.real() as usize);
        let at = self.at(o);
        let look = |vertex| Seen { vertex, outside: outside(self.at(vertex)) };
        for &spoke in self.fan(o) {
            let across = next(spoke);
            let (right, left) = (look(self.edge(across).origin), look(self.edge(next(across)).origin));
            self.see(right, scratch, seen);
            self.see(left, scratch, seen);
            let edge = self.edge(across).twin;
            scratch.look_behind(edge, View { edge, ends: [right.outside, left.outside], right, left });
        }
        let mut triangles = self.fan(o).len();
        while let Some(View { edge, ends, right, left }) = scratch.views.pop() {
            triangles += 1;
            if triangles > most {
                return None;
            }
            // The triangle behind the edge: from the edge's right end to the apex, and from the apex to its left end.
            let to_apex = self.edge(next(edge));
            let from_apex = self.edge(next(next(edge)));
            let apex = look(from_apex.origin);
            let p = self.at(apex.vertex);
            let from_right = orient(at, self.at(right.vertex), p);
            let from_left = orient(at, self.at(left.vertex), p);
            if from_right >= 0.0 && from_left <= 0.0 {
                self.see(apex, scratch, seen);
            }
            if from_right > 0.0 {
                let left = if from_left < 0.0 { apex } else { left };
                scratch.look_behind(to_apex.twin, View { edge, ends: [ends[0], apex.outside], right, left });
            }
            if from_left < 0.0 {
                let right = if from_right > 0.0 { apex } else { right };
                scratch.look_behind(from_apex.twin, View { edge, ends: [apex.outside, ends[1]], right, left });
            }
        }
        Some(triangles)
    }

    #[inline]
    fn see(&self, Seen { vertex, outside }: Seen, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        if outside == 0 && vertex < self.real() && scratch.seen_in[vertex as usize] != scratch.look {
            scratch.seen_in[vertex as usize] = scratch.look;
            seen.push(vertex);
        }
    }
}
