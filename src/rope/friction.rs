//! Friction: how the tension grows along a rope that slips over what it bends round, and how it presses on that.

use std::fmt;

use glam::DVec2;

use super::stack::{is_straight, pull};

/// A coefficient of Coulomb friction between a rope and all that it touches: 0 to [`Friction::MOST`].
///
/// Where a rope bends by the angle `t` and slips, the tension beyond the bend is `exp(mu t)` times that before it,
/// however sharp the bend (the capstan equation, of Euler and Eytelwein). So along a rope the tensions at its ends
/// depend on the sum of its turns alone.
///
/// ```
/// use std::f64::consts::PI;
/// use tautline::rope::{Friction, Slip};
///
/// let friction = Friction::new(0.5)?;
/// // Half a turn. Whoever hauls at the free end pulls 4.8 times as hard as the anchor, who holds it 4.8 times less.
/// assert!((friction.tension(PI, Slip::ToFreeEnd) - 4.8105).abs() < 1e-4);
/// assert!((friction.tension(PI, Slip::ToAnchor) - 1.0 / 4.8105).abs() < 1e-4);
/// # Ok::<(), tautline::rope::FrictionFault>(())
/// ```
/// The default is none: 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction(f64);

/// Which way a rope slips over all that it touches: who is just about to lose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slip {
    /// Towards the free end: it is hauled, against the friction. The tension grows from the anchor on.
    ToFreeEnd,
    /// Towards the anchor: the free end gives way and the friction helps to hold it. The tension falls from the anchor
    /// on.
    ToAnchor,
}

/// A number that is no coefficient of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionFault(f64);

impl fmt::Display for FrictionFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = crate::geometry::number(self.0);
        write!(f, "{shown} is no coefficient of friction; give a number from 0 to {}", Friction::MOST)
    }
}

impl std::error::Error for FrictionFault {}

impl Friction {
    /// The greatest coefficient. Those of ropes are 0.1 to 1.
    pub const MOST: f64 = 10.0;

    /// Checks a coefficient.
    ///
    /// # Errors
    ///
    /// One that is not from 0 to [`MOST`](Self::MOST).
    pub fn new(coefficient: f64) -> Result<Self, FrictionFault> {
        let fits = (0.0..=Self::MOST).contains(&coefficient);
        // A negative zero would be told as such.
        if fits { Ok(Friction(coefficient + 0.0)) } else { Err(FrictionFault(coefficient)) }
    }

    /// The coefficient.
    pub fn coefficient(self) -> f64 {
        self.0
    }

    /// The tension at the free end of a rope that turns by so many radians in all, for a tension of 1 at the anchor,
    /// when it slips that way. Infinite where f64 has no number as great. O(1).
    pub fn tension(self, turned: f64, slip: Slip) -> f64 {
        match slip {
            Slip::ToFreeEnd => libm::exp(self.0 * turned),
            Slip::ToAnchor => libm::exp(-self.0 * turned),
        }
    }
}

/// By which angle a rope turns at `here` that comes from `prior` and goes on to `next`: in radians, from 0, straight
/// on, to pi, back. It is 0 exactly where the rope passes `here` straight, and where two of the points are one. Within
/// 2^-49 (2e-15). O(1).
///
/// ```
/// use tautline::rope::turn;
/// assert_eq!(turn([0.0, 0.0].into(), [1.0, 0.0].into(), [1.0, 1.0].into()), std::f64::consts::FRAC_PI_2);
/// ```
pub fn turn(prior: DVec2, here: DVec2, next: DVec2) -> f64 {
    if prior == here || here == next || is_straight(prior, here, next) {
        return 0.0;
    }
    between(here - prior, next - here)
}

/// The angle between two directions, 0 to pi.
pub(super) fn between(from: DVec2, to: DVec2) -> f64 {
    libm::atan2(from.perp_dot(to).abs(), from.dot(to))
}

/// A sum that keeps what rounding takes from it (Neumaier's): the roundings of many terms come to no more than that of
/// one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    pub(super) fn and(self, term: f64) -> Sum {
        let sum = self.sum + term;
        let lost = if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        // Of an infinite sum nothing is left over.
        Sum { sum, rest: if sum.is_finite() { self.rest + lost } else { 0.0 } }
    }

    pub(super) fn value(self) -> f64 {
        self.sum + self.rest
    }
}

/// What a rope does to a point that it bends round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Where that is.
    pub at: DVec2,
    /// By which angle the rope turns there, in radians: [`turn`].
    pub angle: f64,
    /// The rope's tension on the side of the anchor, where that at the anchor is 1.
    pub before: f64,
    /// And on the side of the free end.
    pub beyond: f64,
    /// The force on the point: the sum of both tensions along the rope. Without friction it halves the angle, and has
    /// the size 2 sin(angle / 2).
    pub force: DVec2,
}

/// The forces of a rope on what it bends round, from the anchor on, for a tension of 1 at the anchor. `corners` are the
/// anchor, the points at which the rope bends, and the free end; `slip` says which way the rope is about to slip, which
/// without friction makes no difference. A corner that the rope passes straight feels nothing. O(corners).
///
/// ```
/// use tautline::rope::{Friction, Slip, forces};
///
/// let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(glam::DVec2::from);
/// let force = forces(&corners, Friction::new(0.0)?, Slip::ToFreeEnd)[0];
/// assert_eq!(force.force, glam::DVec2::new(-1.0, 1.0));
/// # Ok::<(), tautline::rope::FrictionFault>(())
/// ```
pub fn forces(corners: &[DVec2], friction: Friction, slip: Slip) -> Vec<Force> {
    let mut turned = Sum::default();
    let mut force = |three: &[DVec2]| {
        let (prior, at, next) = (three[0], three[1], three[2]);
        let angle = turn(prior, at, next);
        let before = friction.tension(turned.value(), slip);
        turned = turned.and(angle);
        let beyond = friction.tension(turned.value(), slip);
        let unit = |to: DVec2| pull(to, at).unwrap_or_default();
        let (to_prior, to_next) = (unit(prior), unit(next));
        let force = if angle == 0.0 {
            DVec2::ZERO
        } else if before.is_finite() && beyond.is_finite() {
            to_prior * before + to_next * beyond
        } else {
            // The tensions' ratio is finite, and tells the way.
            let way = to_prior + to_next * friction.tension(angle, slip);
            let infinite = |c: f64| if c == 0.0 { 0.0 } else { c * f64::INFINITY };
            DVec2::new(infinite(way.x), infinite(way.y))
        };
        Force { at, angle, before, beyond, force }
    };
    corners.windows(3).map(&mut force).collect()
}
