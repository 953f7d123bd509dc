//! What friction makes of a rope on its way: its turns, tension, and the work of the end that moves.

use glam::DVec2;

use super::friction::{Sum, between};
use super::replay::Replay;
use super::stack::{is_straight, pull};
use super::{EventKind, Friction, Rope, Slip, turn};

/// A rope under tension after a step, where friction is asked for. Tensions are in that of the anchor, lengths in the
/// scene's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strain {
    /// The unit vector along which the rope pulls the anchor; `None` for a rope of no length.
    pub anchor_pull: Option<DVec2>,
    /// By which angle the rope turns in all, in radians: the sum of [`turn`] over its corners. For n corners within
    /// n 2^-49 and a rounding.
    pub turned: f64,
    /// The tension at the free end when it is hauled, `exp(mu turned)`; as it gives way, one over that. Infinite where
    /// f64 has no number as great.
    pub tension: f64,
    /// The work that the free end has done since the trace began: the integral of its tension over the rope's length,
    /// where it is hauled while the rope gets longer, and gives way while it gets shorter. Without friction it is the
    /// length; what is beyond that has become heat.
    pub work: f64,
}

/// The last leg of a rope, which turns about its pivot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pivoted {
    /// What comes before the pivot; `None` where that is the other end, which the rope does not bend round.
    pub prior: Option<DVec2>,
    pub pivot: DVec2,
    /// The turns before the pivot.
    pub before: Sum,
}

/// Gauss and Legendre's nodes between 0 and 1, of which those below are the mirror image, and their weights: exact for
/// polynomials of degree 15.
const NODES: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_27],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

impl Pivoted {
    /// All turns of the rope to the free end `a`.
    pub(super) fn turned(&self, a: DVec2) -> f64 {
        let last = self.prior.map_or(0.0, |prior| turn(prior, self.pivot, a));
        self.before.and(last).value()
    }

    /// The work of the free end on the straight way from `a` to `b`, on which the rope keeps its contacts. Within some
    /// 1e-12 of it.
    pub(super) fn work(&self, friction: Friction, a: DVec2, b: DVec2) -> f64 {
        let (way, from) = (b - a, a - self.pivot);
        // The ends' places along the way, counted from that nearest to the pivot, and how far that is.
        let long = way.length();
        if long == 0.0 {
            return 0.0;
        }
        let [start, end] = [from, b - self.pivot].map(|p| p.dot(way) / long);
        let aside = from.perp_dot(way).abs() / long;
        let along = Along { of: self, friction, from, start, unit: way / long, aside };
        match (start < 0.0, end > 0.0) {
            (true, true) => along.part(Slip::ToAnchor, 0.0, -start) + along.part(Slip::ToFreeEnd, 0.0, end),
            (true, false) => along.part(Slip::ToAnchor, -end, -start),
            (false, _) => along.part(Slip::ToFreeEnd, start, end),
        }
    }
}

/// A straight way of the free end.
struct Along<'a> {
    of: &'a Pivoted,
    friction: Friction,
    /// Where it starts, seen from the pivot, and how far that is from the place nearest to the pivot.
    from: DVec2,
    start: f64,
    unit: DVec2,
    /// How far the way passes from the pivot.
    aside: f64,
}

impl Along<'_> {
    /// The work between two places that are so far from the nearest one, with the rope slipping that way.
    ///
    /// With t the distance from there, the length grows by t / r dt. That and the angle at the pivot are analytic but
    /// at t = +-i aside, which is as far away as the pivot. Over half as much the nodes are good for all digits.
    fn part(&self, slip: Slip, near: f64, far: f64) -> f64 {
        let sign = if slip == Slip::ToFreeEnd { 1.0 } else { -1.0 };
        let bends = self.of.prior.filter(|_| self.friction.coefficient() > 0.0);
        let (Some(prior), true) = (bends, self.aside > 0.0) else {
            let grown = (far - near) * (far + near) / (self.distance(far) + self.distance(near));
            let place = self.place(sign * far) + self.of.pivot;
            // Nothing times an infinite tension would be no number.
            return if grown > 0.0 { sign * self.friction.tension(self.of.turned(place), slip) * grown } else { 0.0 };
        };
        let incoming = self.of.pivot - prior;
        let tension = |t: f64| {
            let angle = between(incoming, self.place(sign * t));
            self.friction.tension(self.of.before.and(angle).value(), slip)
        };
        let share = 0.5 / self.friction.coefficient().max(1.0);
        let (mut sum, mut at) = (Sum::default(), near);
        while at < far {
            let next = (at + share * self.distance(at)).min(far);
            let (middle, half) = (at + (next - at) / 2.0, (next - at) / 2.0);
            for [node, weight] in NODES {
                for t in [middle - node * half, middle + node * half] {
                    sum = sum.and(weight * half * (tension(t) * (t / self.distance(t))));
                }
            }
            at = next;
        }
        sign * sum.value()
    }

    fn distance(&self, t: f64) -> f64 {
        DVec2::new(self.aside, t).length()
    }

    /// The place so far beyond the nearest one, seen from the pivot.
    fn place(&self, t: f64) -> DVec2 {
        self.from + self.unit * (t - self.start)
    }
}

/// What is kept of a rope's contacts for its strain.
pub(super) struct Straining {
    friction: Friction,
    /// For each contact, the turns before it.
    before: Vec<Sum>,
    work: Sum,
    /// The first corner of which the free end makes no difference, if there is one.
    first: Option<DVec2>,
}

impl Straining {
    pub(super) fn new(friction: Friction) -> Self {
        Straining { friction, before: Vec::new(), work: Sum::default(), first: None }
    }

    /// Goes from `from` to `to` in a step, with all that happens to the rope on the way; whether anything does.
    pub(super) fn walk(&mut self, replay: &mut Replay<'_>, rope: &mut Rope, step: usize, ends: [DVec2; 2]) -> bool {
        let (mut at, mut share, mut happened) = (ends[0], 0.0, false);
        while let Some(event) = replay.due(step) {
            share = replay.share(rope, event, ends, share);
            let place = ends[0].lerp(ends[1], share);
            self.work = self.work.and(self.pivoted(rope).work(self.friction, at, place));
            (at, happened) = (place, true);
            match event.kind {
                EventKind::Wrap => {
                    let before = self.before.last().map_or_else(Sum::default, |before| {
                        before.and(turn(rope.prior(), rope.pivot(), replay.place(event)))
                    });
                    self.before.push(before);
                }
                EventKind::Unwrap => drop(self.before.pop()),
            }
            replay.play(rope);
        }
        self.work = self.work.and(self.pivoted(rope).work(self.friction, at, ends[1]));
        if happened {
            let at = |i: usize| rope.contacts()[i].at;
            let bends = |i: usize| {
                let prior = if i == 0 { rope.anchor() } else { at(i - 1) };
                !is_straight(prior, at(i), at(i + 1))
            };
            self.first = (0..rope.contacts().len().saturating_sub(1)).find(|&i| bends(i)).map(at);
        }
        happened
    }

    fn pivoted(&self, rope: &Rope) -> Pivoted {
        let before = self.before.last().copied();
        Pivoted { prior: before.map(|_| rope.prior()), pivot: rope.pivot(), before: before.unwrap_or_default() }
    }

    /// With the free end at `a`. O(1).
    pub(super) fn look(&self, rope: &Rope, a: DVec2) -> Strain {
        let turned = self.pivoted(rope).turned(a);
        let bends = || !rope.contacts().is_empty() && a != rope.pivot() && !is_straight(rope.prior(), rope.pivot(), a);
        let first = self.first.unwrap_or_else(|| if bends() { rope.pivot() } else { a });
        let tension = self.friction.tension(turned, Slip::ToFreeEnd);
        Strain { anchor_pull: pull(first, rope.anchor()), turned, tension, work: self.work.value() }
    }
}
