//! The crossing word of a trace: the edges of the triangulation that it crosses, reduced.

use super::mesh::Mesh;
use super::triangle::{DOUBT, Door, NEXT};
use crate::geometry::{TracePoint, orient_step};
use crate::trace::SettledTrace;

/// By the set of edges behind which a leg's goal lies: a corner, and the edge through which the leg leaves when it
/// passes that corner on its left, and the edge else. Behind one edge, it leaves through that. Behind two, it passes
/// the corner between them, and leaves through the edge that ends at it or the one that starts there.
const EXITS: [(usize, [usize; 2]); 7] =
    [(0, [0, 0]), (0, [0, 0]), (0, [1, 1]), (1, [1, 0]), (0, [2, 2]), (0, [0, 2]), (2, [2, 1])];

/// The reduced word from the anchor to the free end, and the triangle in which the free end is.
#[derive(Debug, Default)]
pub(super) struct Word {
    /// Each edge crossed, as seen from the triangle into which it leads; the last one's is the free end's. Before the
    /// first comes one that is none, behind the last what is left over.
    doors: Vec<Door>,
    length: usize,
    triangle: u32,
    kept: usize,
}

impl Word {
    /// The empty word of a trace that starts at `a`.
    pub(super) fn start(&mut self, mesh: &Mesh, a: TracePoint) {
        if self.doors.is_empty() {
            self.doors.resize(64, Door::NONE);
        }
        (self.length, self.kept, self.triangle) = (0, 0, mesh.start(a));
    }

    /// The edges crossed, as seen from the triangles into which they lead.
    pub(super) fn doors(&self) -> &[Door] {
        &self.doors[1..=self.length]
    }

    /// How many of the first doors have stayed since this was asked last.
    pub(super) fn take_kept(&mut self) -> usize {
        std::mem::replace(&mut self.kept, self.length)
    }

    /// Follows the free end from point `i - 1` of `trace`, where it is, to point `i`. Says whether it has left its
    /// triangle.
    #[inline(always)]
    pub(super) fn follow(&mut self, mesh: &Mesh, trace: &SettledTrace, i: usize) -> bool {
        // Where the point lies strictly on one side of an edge its hair does not matter.
        let behind = mesh.triangle(self.triangle).behind(trace.points()[i]);
        behind != 0 && self.leave(mesh, behind, trace.point(i - 1), trace.point(i))
    }

    /// Follows the leg from `a0`, in the current triangle, to `a1`, which lies behind these edges or close to them.
    fn leave(&mut self, mesh: &Mesh, behind: usize, a0: TracePoint, a1: TracePoint) -> bool {
        let behind = self.undoubted(mesh, behind, a1);
        if behind == 0 {
            return false;
        }
        let is_left = |triangle, corner: usize| orient_step(a0, a1, mesh.triangle(triangle).corners[corner]) >= 0.0;
        let (corner, exits) = EXITS[behind];
        let mut entry = self.pass(mesh, exits[usize::from(is_left(self.triangle, corner))]);
        loop {
            // The leg's line leaves a triangle through one of the two edges by which it did not come: the one that ends
            // at the corner between them when that lies on its left, else the one that starts there. Asked before it is
            // known whether the leg goes so far, since a processor finds out both at the same time.
            let ends = NEXT[entry];
            let starts = NEXT[ends];
            let exit = [starts, ends][usize::from(is_left(self.triangle, starts))];
            let behind = mesh.triangle(self.triangle).behind(a1.at);
            if self.undoubted(mesh, behind, a1) == 0 {
                return true;
            }
            entry = self.pass(mesh, exit);
        }
    }

    /// The edges of the current triangle behind which `a` lies, exactly, given what rounded numbers say.
    #[inline(always)]
    fn undoubted(&self, mesh: &Mesh, behind: usize, a: TracePoint) -> usize {
        if behind & DOUBT == 0 { behind } else { mesh.behind(self.triangle, a) }
    }

    /// Goes through an edge of the current triangle. Returns which edge of the next it is.
    #[inline(always)]
    fn pass(&mut self, mesh: &Mesh, exit: usize) -> usize {
        let beyond = mesh.triangle(self.triangle).beyond[exit];
        assert!(beyond != Door::NONE, "the frame holds all points");
        let is_back = self.doors[self.length] == Door::new(self.triangle, exit);
        if self.length + 1 == self.doors.len() {
            self.doors.resize(2 * self.doors.len(), Door::NONE);
        }
        // Written down in either case: whether the leg goes back is another thing that cannot be guessed.
        self.doors[self.length + 1] = beyond;
        self.length = if is_back { self.length - 1 } else { self.length + 1 };
        self.kept = self.kept.min(self.length);
        self.triangle = beyond.triangle();
        beyond.edge()
    }
}
