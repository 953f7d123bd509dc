//! What stays where it is while an end of the rope moves: a vertex, or the rope's other end.

use glam::DVec2;

use super::predicates::{forwards, orient};
use super::trace_point::{Hair, TracePoint, Turn, left_of, orient_step};

/// A point about which the rope's last leg turns, or that comes before that point on the rope.
pub trait Resting: Copy {
    /// Where it stands.
    fn at(self) -> DVec2;

    /// A number with the sign of the area of the triangle of this point, `p` and `q`, as [`orient`] has it.
    fn orient(self, p: DVec2, q: DVec2) -> f64;

    /// Whether `a`, where the end that moves is, lies left of the line from here to `p`; on the line counts as left.
    fn left_of(self, p: DVec2, a: TracePoint) -> bool;

    /// For `p` and `q` on a line with this point: whether the way from here over `p` to `q` goes on
    /// [forwards](forwards()).
    #[inline(always)]
    fn forwards(self, p: DVec2, q: DVec2) -> bool {
        forwards(self.at(), p, q)
    }
}

impl Resting for DVec2 {
    #[inline(always)]
    fn at(self) -> DVec2 {
        self
    }

    #[inline(always)]
    fn orient(self, p: DVec2, q: DVec2) -> f64 {
        orient(self, p, q)
    }

    #[inline(always)]
    fn left_of(self, p: DVec2, a: TracePoint) -> bool {
        left_of(self, p, a)
    }
}

/// What one end of a rope turns about where both ends move.
///
/// An end that stands on a line through two vertices, or on a vertex, counts as a [`Hair`] off it: every end has one,
/// and those of the one end are infinitely shorter than those of the other, and turned by infinitely smaller angles,
/// whenever each came there. So all signs are those of places that both ends could really have at once, and none is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stand {
    /// A vertex.
    Vertex(DVec2),
    /// The end whose hairs are infinitely shorter than those of the end that moves.
    Shorter(TracePoint),
    /// The end whose hairs are infinitely longer than those of the end that moves.
    Longer(TracePoint),
}

impl Resting for Stand {
    fn at(self) -> DVec2 {
        match self {
            Stand::Vertex(at) => at,
            Stand::Shorter(end) | Stand::Longer(end) => end.at,
        }
    }

    fn orient(self, p: DVec2, q: DVec2) -> f64 {
        match self {
            Stand::Vertex(at) => orient(at, p, q),
            // The points in another order, but the same way round.
            Stand::Shorter(end) | Stand::Longer(end) => orient_step(q.into(), end, p),
        }
    }

    fn left_of(self, p: DVec2, a: TracePoint) -> bool {
        match self {
            Stand::Vertex(at) => left_of(at, p, a),
            Stand::Shorter(end) => orient_ends(end, a, p) <= 0.0,
            Stand::Longer(end) => orient_ends(a, end, p) >= 0.0,
        }
    }
}

/// A number with the sign of the area of the triangle of two ends and `p`, where the hairs of the first are the shorter
/// ones.
fn orient_ends(shorter: TracePoint, longer: TracePoint, p: DVec2) -> f64 {
    // Of two hairs it takes the second for the longer one.
    let side = orient_step(shorter, longer, p);
    match (shorter.hair, longer.hair) {
        // Both ends stand on `p`, with hairs along one line.
        (Some(d), Some(e)) if side == 0.0 && shorter.at == p && longer.at == p => d.cross_end(p, e),
        _ => side,
    }
}

impl TracePoint {
    /// The same point with a hair: its own, or one in a direction that no line through this point and another point has
    /// to which coordinates can be given.
    ///
    /// ```
    /// use tautline::geometry::{TracePoint, left_of};
    /// let a = TracePoint::from(glam::DVec2::new(2.0, 0.0)).off_all_lines();
    /// // It lies on the one side of the line through it, whichever way that is drawn.
    /// let [o, p] = [[0.0, 0.0], [1.0, 0.0]].map(glam::DVec2::from);
    /// assert_ne!(left_of(o, p, a), left_of(p, o, a));
    /// ```
    #[must_use]
    pub fn off_all_lines(self) -> TracePoint {
        let DVec2 { x, y } = self.at;
        // Mirrored, so that it stays within the limits.
        let witness = DVec2::new(if x == 0.0 { 1.0 } else { -x }, y);
        let hair = self.hair.unwrap_or(Hair { witness, away: false, turn: Turn::Left });
        TracePoint { hair: Some(hair), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a small lattice, where most signs are ties: all are those of hairs that are really there.
    #[test]
    fn signs_with_two_ends_agree_with_short_real_hairs() {
        let lattice: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i % 3), f64::from(i / 3))).collect();
        let mut ends = vec![];
        for &at in &lattice {
            ends.push(TracePoint::from(at).off_all_lines());
            for &witness in lattice.iter().filter(|&&w| w != at).step_by(3) {
                for (away, turn) in [(false, Turn::Left), (false, Turn::Right), (true, Turn::Left)] {
                    ends.push(TracePoint { at, hair: Some(Hair { witness, away, turn }) });
                }
            }
        }
        let plucked = |a: TracePoint, [length, angle]: [f64; 2]| {
            let hair = a.hair.unwrap();
            let d = (hair.witness - a.at) * if hair.away { -1.0 } else { 1.0 };
            let turn = if hair.turn == Turn::Left { angle } else { -angle };
            a.at + length * (d + d.perp() * turn)
        };
        let [short, long] = [[2f64.powi(-32), 2f64.powi(-10)], [2f64.powi(-16), 2f64.powi(-5)]];
        for (i, &rests) in ends.iter().enumerate() {
            for &p in &lattice {
                for &moves in ends.iter().skip(i % 5).step_by(5) {
                    let real = orient(plucked(rests, short), p, plucked(moves, long));
                    assert_ne!(real, 0.0);
                    assert_eq!(Stand::Shorter(rests).left_of(p, moves), real > 0.0, "{rests:?} {p} {moves:?}");
                    let real = orient(plucked(rests, long), p, plucked(moves, short));
                    assert_eq!(Stand::Longer(rests).left_of(p, moves), real > 0.0, "{rests:?} {p} {moves:?}");
                }
                for &q in lattice.iter().filter(|&&q| q != p) {
                    let real = orient(plucked(rests, long), p, q);
                    let ours = Stand::Longer(rests).orient(p, q);
                    assert!(ours * real > 0.0, "{rests:?} {p} {q}");
                }
            }
        }
    }
}
