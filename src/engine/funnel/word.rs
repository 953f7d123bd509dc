//! The crossing word of a trace: the edges of the triangulation that it crosses, reduced.

use super::mesh::Mesh;
use crate::geometry::{TracePoint, orient_step};

/// An edge that the trace crosses, by its vertices left and right of the crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Portal {
    pub left: u32,
    pub right: u32,
}

/// The reduced word from the anchor to the free end, and the triangle in which the free end is.
#[derive(Debug, Default)]
pub(super) struct Word {
    portals: Vec<Portal>,
    triangle: u32,
}

impl Word {
    /// The empty word of a trace that starts at `a`.
    pub(super) fn start(&mut self, mesh: &Mesh, a: TracePoint) {
        self.portals.clear();
        if !mesh.holds(self.triangle, a) {
            self.triangle = mesh.locate(a);
        }
    }

    pub(super) fn portals(&self) -> &[Portal] {
        &self.portals
    }

    /// Follows the free end from `a0`, which is in the current triangle, to `a1`.
    pub(super) fn go(&mut self, mesh: &Mesh, a0: TracePoint, a1: TracePoint) {
        while !mesh.holds(self.triangle, a1) {
            let triangle = &mesh.triangles[self.triangle as usize];
            let is_left = triangle.corners.map(|c| orient_step(a0, a1, mesh.at(c)) >= 0.0);
            // The leg leaves through the one edge that it has on its right where the edge starts, and on its left where
            // it ends.
            let out = (0..3).find(|&i| !is_left[i] && is_left[(i + 1) % 3]).expect("a leg leaves through an edge");
            let portal = Portal { left: triangle.corners[(out + 1) % 3], right: triangle.corners[out] };
            self.triangle = triangle.neighbours[out].expect("the frame holds all points");
            let back = Portal { left: portal.right, right: portal.left };
            if self.portals.last() == Some(&back) {
                self.portals.pop();
            } else {
                self.portals.push(portal);
            }
        }
    }
}
