//! A point of a trace, which may stand a hair off the wall end that it touches.
//!
//! A trace may stand on a vertex or pass through one. It then counts as passing a hair off the walls that meet there.
//! The hair is symbolic (simulation of simplicity: Edelsbrunner and Muecke, ACM Trans. Graph. 9, 1990): the point is
//! `at + e d` with e infinitely small, where `d` points at (or straight away from) some input point, turned by an
//! infinitely smaller angle. Signs of such points reduce to signs of input points, so they stay exact. Along one
//! trace, each later hair is infinitely longer than all before it.

use glam::DVec2;

use super::predicates::orient;

/// The way in which a [`Hair`] is turned by an infinitely small angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Counter-clockwise.
    Left,
    /// Clockwise.
    Right,
}

impl Turn {
    fn sign(self) -> f64 {
        match self {
            Turn::Left => 1.0,
            Turn::Right => -1.0,
        }
    }

    /// The other way.
    #[must_use]
    pub fn reversed(self) -> Turn {
        match self {
            Turn::Left => Turn::Right,
            Turn::Right => Turn::Left,
        }
    }
}

/// The direction in which a trace point is displaced from the vertex on which it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hair {
    /// An input point that gives the direction; not the vertex itself.
    pub witness: DVec2,
    /// Displaced straight away from the witness instead of towards it.
    pub away: bool,
    /// The turn on top of that, so that a hair is never parallel to a line through input points.
    pub turn: Turn,
}

impl Hair {
    fn sense(self) -> f64 {
        if self.away { -1.0 } else { 1.0 }
    }

    /// The sign of cross(u, d), where `d` is this hair's direction from `at` and `u = to - from` is parallel to a
    /// line through `at`: `from`, `to` and `at` lie on one line and `from` differs from `to`. Never 0.
    fn across(self, at: DVec2, from: DVec2, to: DVec2) -> f64 {
        let side = orient(from, to, self.witness) * self.sense();
        if side != 0.0 {
            return side;
        }
        // The hair lies along u: forwards it leans to the side of its turn, backwards to the other.
        let along = if parallel(at, self.witness, from, to) { 1.0 } else { -1.0 };
        along * self.sense() * self.turn.sign()
    }

    /// The sign of cross(d, e) for two hairs at one vertex; 0 only when they are the same direction.
    fn cross(self, at: DVec2, other: Hair) -> f64 {
        let side = orient(at, self.witness, other.witness) * self.sense() * other.sense();
        if side != 0.0 {
            return side;
        }
        let turned = other.turn.sign() - self.turn.sign();
        if self.goes_with(at, other) { turned } else { -turned }
    }

    /// The same sign where `other` is a hair of the rope's other end, and turned by an infinitely larger angle; never
    /// 0.
    pub(super) fn cross_end(self, at: DVec2, other: Hair) -> f64 {
        let side = self.cross(at, other);
        if side != 0.0 {
            return side;
        }
        if self.goes_with(at, other) { other.turn.sign() } else { -other.turn.sign() }
    }

    /// For hairs at one vertex along one line: whether they go the same way.
    fn goes_with(self, at: DVec2, other: Hair) -> bool {
        parallel(at, self.witness, at, other.witness) == (self.away == other.away)
    }
}

/// For parallel ways a -> b and c -> d, neither of them empty: whether they go the same way.
fn parallel(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    if a.x != b.x { (a.x < b.x) == (c.x < d.x) } else { (a.y < b.y) == (c.y < d.y) }
}

/// A point of a settled trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// Where it stands, in the scene's frame and unit.
    pub at: DVec2,
    /// How it is displaced; set exactly for points that stand on a vertex.
    pub hair: Option<Hair>,
}

impl TracePoint {
    /// Where it stands if its hair, if it has one, has this real length and is turned by about two degrees: for those
    /// who compute with rounded numbers.
    pub fn plucked(self, length: f64) -> DVec2 {
        let Some(hair) = self.hair else { return self.at };
        let way = (hair.witness - self.at) * hair.sense();
        let along = way / way.length();
        self.at + length * (along + along.perp() * hair.turn.sign() / 32.0)
    }
}

impl From<DVec2> for TracePoint {
    fn from(at: DVec2) -> Self {
        TracePoint { at, hair: None }
    }
}

/// Whether trace point `a` lies left of `o -> p`, on the line counting as left.
#[inline]
pub fn left_of(o: DVec2, p: DVec2, a: TracePoint) -> bool {
    let side = orient(o, p, a.at);
    if side != 0.0 {
        return side > 0.0;
    }
    match a.hair {
        Some(hair) if o != p => hair.across(a.at, o, p) >= 0.0,
        _ => true,
    }
}

/// A number with the sign of orient(`a0`, `a1`, `p`): above 0 when `p` lies left of the step `a0 -> a1`.
#[inline]
pub fn orient_step(a0: TracePoint, a1: TracePoint, p: DVec2) -> f64 {
    let side = orient(a0.at, a1.at, p);
    if side != 0.0 || (a0.hair.is_none() && a1.hair.is_none()) {
        return side;
    }
    orient_hairs(a0, a1, p)
}

/// The first term that is not zero of the expansion of
/// cross(a0 + e0 d0 - p, a1 + e1 d1 - p) for e1 >> e0, given that `a0`, `a1` and `p` lie on one line.
#[cold]
fn orient_hairs(a0: TracePoint, a1: TracePoint, p: DVec2) -> f64 {
    if let Some(d1) = a1.hair
        && a0.at != p
    {
        // cross(a0 - p, d1)
        return d1.across(a1.at, p, a0.at);
    }
    if let Some(d0) = a0.hair
        && a1.at != p
    {
        // cross(d0, a1 - p) = -cross(a1 - p, d0)
        return -d0.across(a0.at, p, a1.at);
    }
    match (a0.hair, a1.hair) {
        (Some(d0), Some(d1)) if a0.at == a1.at => d0.cross(p, d1),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    /// The same point with a hair of real length and a real turn, short enough for these lattices and exact in f64.
    fn plucked(a: TracePoint, length: f64) -> DVec2 {
        let Some(h) = a.hair else { return a.at };
        let d = (h.witness - a.at) * h.sense();
        a.at + length * (d + d.perp() * h.turn.sign() * 2f64.powi(-10))
    }

    /// Every sign agrees with that of a hair that is really there, on a small lattice where most tests are ties.
    #[test]
    fn symbolic_hairs_agree_with_short_real_ones() {
        let lattice: Vec<DVec2> = (0..9).map(|i| p(f64::from(i % 3), f64::from(i / 3))).collect();
        let mut hairs = vec![];
        for &at in &lattice {
            for &witness in lattice.iter().filter(|&&w| w != at) {
                for away in [false, true] {
                    for turn in [Turn::Left, Turn::Right] {
                        hairs.push(TracePoint { at, hair: Some(Hair { witness, away, turn }) });
                    }
                }
            }
        }
        for &a in &hairs {
            for &o in &lattice {
                for &q in lattice.iter().filter(|&&q| q != o) {
                    let real = orient(o, q, plucked(a, 2f64.powi(-12)));
                    assert_eq!(left_of(o, q, a), real >= 0.0, "{o} {q} {a:?}");
                }
            }
        }
        for (i, &a0) in hairs.iter().enumerate().step_by(5) {
            for &a1 in hairs.iter().skip(i % 7).step_by(7) {
                for &q in &lattice {
                    let real = orient(plucked(a0, 2f64.powi(-30)), plucked(a1, 2f64.powi(-12)), q);
                    let ours = orient_step(a0, a1, q);
                    assert_eq!(ours.partial_cmp(&0.0), real.partial_cmp(&0.0), "{a0:?} {a1:?} {q}");
                }
            }
        }
    }
}
