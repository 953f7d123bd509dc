//! The rope of a walk while it is drawn, and how far a tether lets its free end go.

use glam::DVec2;

use super::room::Room;
use crate::candidates::Lists;
use crate::engine::{follow, leaves};
use crate::geometry::{TracePoint, point};
use crate::rope::{Leg, Rope};

/// How often a slide is drawn in further, where roundings leave the rope too long.
pub(super) const DRAWN_IN: u32 = 16;

/// A rope that follows the free end of a walk as far as the tether is long.
pub(super) struct Leash<'a> {
    lists: &'a Lists,
    /// How long the tether is.
    most: f64,
    here: DVec2,
    rope: Rope,
    /// The rope as it would be after the step refused last.
    refused: Rope,
}

impl<'a> Leash<'a> {
    /// The rope of a walk that starts at `start`, which is visible from the anchor and no further away than the tether
    /// is long.
    pub(super) fn new(lists: &'a Lists, most: f64, start: DVec2) -> Self {
        let anchor = lists.model().anchor();
        let rope = Rope::new(anchor);
        let mut leash = Leash { lists, most, here: anchor, refused: rope.clone(), rope };
        leash.follow(start);
        leash.here = start;
        leash
    }

    /// Where the free end is.
    pub(super) fn here(&self) -> DVec2 {
        self.here
    }

    /// Goes straight to `to`, which is an open step, if the rope is not longer than the tether there, as results round
    /// its length. Tells whether it did.
    ///
    /// Along a straight step the rope's length is convex, so that it is not longer on the way either.
    pub(super) fn goes(&mut self, to: DVec2) -> bool {
        let before = if self.surely_reaches(to) { None } else { Some(self.rope.clone()) };
        self.follow(to);
        match before {
            Some(before) if self.rope.length(to) > self.most => {
                self.refused = std::mem::replace(&mut self.rope, before);
                false
            }
            _ => {
                self.here = to;
                true
            }
        }
    }

    /// Whether a step to `to` surely leaves the rope within the tether: it grows by no more than the step is long. Each
    /// of its legs, of which there are no more than contacts now and vertices, is rounded by far less than what is
    /// taken off.
    fn surely_reaches(&self, to: DVec2) -> bool {
        let legs = (self.rope.contacts().len() + self.lists.model().vertices().len() + 8) as f64;
        let least = self.most * (1.0 - legs * 4.0 * f64::EPSILON);
        self.rope.length(self.here) + self.here.distance(to) <= least
    }

    fn follow(&mut self, to: DVec2) {
        if to != self.here {
            let leg = Leg { a0: leaves(self.lists.model(), self.here, to), a1: TracePoint::from(to) };
            follow(self.lists, &mut self.rope, &leg, |_, _, _| ());
        }
    }

    /// Slides along the border of what the tether lets the free end reach, as far as the refused step to `to` leads: to
    /// where the rope there is as long as the tether. Measured along ropes, that is the nearest place within reach.
    /// Stays if the straight way is not open, or the rope that it makes is too long.
    pub(super) fn slide(&mut self, room: &Room, to: DVec2) {
        let ([from, next], left) = self.leg_beyond(to);
        let whole = from.distance(next);
        let grain = f64::EPSILON * from.abs().max_element().max(next.abs().max_element()).max(self.most);
        // The place is rounded, and so is the length: the free end is drawn in by a little, then by more and more.
        for times in 0..=DRAWN_IN {
            let less = if times == 0 { 0.0 } else { grain * f64::from(1 << (times - 1)) };
            let end = point(from + (next - from) * ((left - less).max(0.0) / whole));
            if !room.is_open(self.here, end) || self.goes(end) {
                return;
            }
        }
    }

    /// The leg on which the rope refused last, which goes to `to`, becomes longer than the tether, and how much of it
    /// the tether leaves.
    fn leg_beyond(&self, to: DVec2) -> ([DVec2; 2], f64) {
        let (mut from, mut length) = (self.lists.model().anchor(), 0.0);
        for turn in self.refused.taut(to) {
            let next = length + from.distance(turn.at);
            if next > self.most {
                return ([from, turn.at], self.most - length);
            }
            (from, length) = (turn.at, next);
        }
        ([from, to], self.most - length)
    }
}
