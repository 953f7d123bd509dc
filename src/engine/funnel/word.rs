//! The crossing word of a trace: the edges of the triangulation that it crosses, reduced.

use super::mesh::Mesh;
use super::triangle::{Door, NEXT};
use crate::geometry::{TracePoint, orient_step};
use crate::trace::SettledTrace;

/// The reduced word from the anchor to the free end, and the triangle in which the free end is.
#[derive(Debug, Default)]
pub(super) struct Word {
    /// Each edge crossed, as seen from the triangle into which it leads; the last one's is the free end's.
    doors: Vec<Door>,
    triangle: u32,
    kept: usize,
}

impl Word {
    /// The empty word of a trace that starts at `a`.
    pub(super) fn start(&mut self, mesh: &Mesh, a: TracePoint) {
        self.doors.clear();
        self.kept = 0;
        self.triangle = mesh.start(a);
    }

    /// The edges crossed, as seen from the triangles into which they lead.
    pub(super) fn doors(&self) -> &[Door] {
        &self.doors
    }

    /// How many of the first doors have stayed since this was asked last.
    pub(super) fn take_kept(&mut self) -> usize {
        std::mem::replace(&mut self.kept, self.doors.len())
    }

    /// Follows the free end from point `i - 1` of `trace`, where it is, to point `i`. Says whether the word may have
    /// changed.
    #[inline]
    pub(super) fn follow(&mut self, mesh: &Mesh, trace: &SettledTrace, i: usize) -> bool {
        // Where the point lies strictly inside a triangle its hair does not matter.
        let stays = mesh.triangle(self.triangle).surely_holds(trace.points()[i]);
        if !stays {
            self.leave(mesh, trace.point(i - 1), trace.point(i));
        }
        !stays
    }

    /// Follows the leg from `a0`, in the current triangle, to `a1`.
    fn leave(&mut self, mesh: &Mesh, a0: TracePoint, a1: TracePoint) {
        // A leg that goes on leaves through the edge behind which its goal lies. Behind two edges, it passes the corner
        // between them on one side or the other.
        let first = |corner: usize, before: usize| {
            let at = mesh.corner(self.triangle, corner).1;
            if orient_step(a0, a1, at) >= 0.0 { before } else { corner }
        };
        let exit = match [0, 1, 2].map(|edge| mesh.is_inside(self.triangle, edge, a1)) {
            [true, true, true] => return,
            [false, true, true] => 0,
            [true, false, true] => 1,
            [true, true, false] => 2,
            [false, false, _] => first(1, 0),
            [true, false, false] => first(2, 1),
            [false, true, false] => first(0, 2),
        };
        let mut exit = exit;
        while let Some(next) = self.pass(mesh, exit, a0, a1) {
            exit = next;
        }
    }

    /// Goes through an edge of the current triangle, and finds the edge of the next one through which the leg leaves it
    /// again, if it does. It never leaves through the edge by which it came.
    #[inline]
    fn pass(&mut self, mesh: &Mesh, exit: usize, a0: TracePoint, a1: TracePoint) -> Option<usize> {
        let beyond = mesh.triangle(self.triangle).beyond[exit];
        assert!(beyond != Door::NONE, "the frame holds all points");
        if self.doors.last() == Some(&Door::new(self.triangle, exit)) {
            self.doors.pop();
            self.kept = self.kept.min(self.doors.len());
        } else {
            self.doors.push(beyond);
        }
        self.triangle = beyond.triangle();
        let right = NEXT[beyond.edge()];
        let left = NEXT[right];
        match (mesh.is_inside(self.triangle, right, a1), mesh.is_inside(self.triangle, left, a1)) {
            (true, true) => None,
            (false, true) => Some(right),
            (true, false) => Some(left),
            // The corner between the two has the number of the edge that starts there.
            (false, false) => {
                let apex = mesh.triangle(self.triangle).corners[left];
                Some(if orient_step(a0, a1, apex) >= 0.0 { right } else { left })
            }
        }
    }
}
