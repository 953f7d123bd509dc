//! A rope as seen from the end that moves: all that the update asks of it.

use glam::DVec2;

use super::{Rope, Side};
use crate::geometry::Resting;

/// A stack of contacts whose top is the contact next to the end that moves.
pub trait Strand {
    /// What its last leg turns about, and what comes before that.
    type Pivot: Resting;

    /// The contact next to the end that moves, or the other end: `O`.
    fn pivot(&self) -> Self::Pivot;

    /// What comes before the pivot: `X`; the other end where nothing does.
    fn prior(&self) -> Self::Pivot;

    /// The side on which the pivot lies, looking towards the end that moves; `None` if it is no contact.
    fn side(&self) -> Option<Side>;

    /// Wraps the rope round `vertex`, which stands at `at`; it becomes the pivot.
    fn push(&mut self, vertex: u32, at: DVec2, side: Side);

    /// Unwraps the rope from its pivot and returns its number and its side; `None` if it touches nothing.
    fn pop(&mut self) -> Option<(u32, Side)>;
}

impl Strand for Rope {
    type Pivot = DVec2;

    #[inline(always)]
    fn pivot(&self) -> DVec2 {
        Rope::pivot(self)
    }

    #[inline(always)]
    fn prior(&self) -> DVec2 {
        Rope::prior(self)
    }

    #[inline(always)]
    fn side(&self) -> Option<Side> {
        self.contacts().last().map(|contact| contact.side)
    }

    #[inline(always)]
    fn push(&mut self, vertex: u32, at: DVec2, side: Side) {
        Rope::push(self, vertex, at, side);
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, Side)> {
        Rope::pop(self).map(|contact| (contact.vertex, contact.side))
    }
}
