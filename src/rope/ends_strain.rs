//! What friction makes of a rope whose ends both move.

use glam::DVec2;

use super::friction::Sum;
use super::replay::share_at;
use super::strain::Pivoted;
use super::{EventKind, FreeRope, Friction, Slip, Strain, turn};
use crate::trace::End;

/// What is kept for the strain of a rope whose ends both move.
pub(super) struct EndsStraining {
    friction: Friction,
    work: Sum,
}

/// A move of the free end that is under way.
pub(super) struct Move {
    ends: [DVec2; 2],
    /// Where it is, and which share has been made.
    at: DVec2,
    share: f64,
}

impl EndsStraining {
    pub(super) fn new(friction: Friction) -> Self {
        EndsStraining { friction, work: Sum::default() }
    }

    /// Begins to move the free end to `to`.
    pub(super) fn begin(&self, rope: &FreeRope, to: DVec2) -> Move {
        let from = rope.end(End::Free).at;
        Move { ends: [from, to], at: from, share: 0.0 }
    }

    /// Goes on to where an event is about to happen to the vertex that stands at `vertex`.
    pub(super) fn go_on(&mut self, rope: &FreeRope, part: &mut Move, kind: EventKind, vertex: DVec2) {
        let pivoted = pivoted(rope);
        let line = match kind {
            EventKind::Wrap => [pivoted.pivot, vertex],
            EventKind::Unwrap => [pivoted.prior.unwrap_or(pivoted.pivot), pivoted.pivot],
        };
        part.share = share_at(line, part.ends, part.share);
        let place = part.ends[0].lerp(part.ends[1], part.share);
        self.work = self.work.and(pivoted.work(self.friction, part.at, place));
        part.at = place;
    }

    /// Goes to the end of the move.
    pub(super) fn end(&mut self, rope: &FreeRope, part: &Move) {
        self.work = self.work.and(pivoted(rope).work(self.friction, part.at, part.ends[1]));
    }

    /// With both ends where they are. O(contacts).
    pub(super) fn look(&self, rope: &FreeRope) -> Strain {
        let turned = pivoted(rope).turned(rope.end(End::Free).at);
        let tension = self.friction.tension(turned, Slip::ToFreeEnd);
        Strain { anchor_pull: rope.pull(End::Anchor), turned, tension, work: self.work.value() }
    }
}

/// The rope up to its last contact. O(contacts).
fn pivoted(rope: &FreeRope) -> Pivoted {
    let anchor = rope.end(End::Anchor).at;
    let mut rest = Pivoted { prior: None, pivot: anchor, before: Sum::default() };
    for contact in rope.contacts() {
        let turned = rest.prior.map_or(0.0, |prior| turn(prior, rest.pivot, contact.at));
        rest = Pivoted { prior: Some(rest.pivot), pivot: contact.at, before: rest.before.and(turned) };
    }
    rest
}
