//! The exact rope update: all events of a leg of the trace, in the order in which the rope's last leg meets them.
//!
//! Every decision is the sign of input points, so with exact predicates the whole update is exact. The vertices to be
//! tried are the caller's: all of them, or any set that surely holds those that can be met.

use glam::DVec2;

use super::{EventKind, Side, Strand};
use crate::geometry::{Resting, TracePoint, orient_step};

/// A straight move of the free end, from `a0` to `a1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Where the free end comes from.
    pub a0: TracePoint,
    /// Where it goes.
    pub a1: TracePoint,
}

/// How far the rope's last leg has turned while the free end moves along one [`Leg`]. Where both ends move, it is the
/// leg of the end that does, and `P` says what it turns about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Sweep<P = DVec2> {
    /// It still points at `a0`.
    #[default]
    Start,
    /// It has met an event: it lies on the line `x -> y` through the new pivot.
    After {
        /// The way in which it turns during this leg: +1 counter-clockwise, -1 clockwise.
        dir: f64,
        /// Where the start line comes from.
        x: P,
        /// The point through which it goes on: the vertex wrapped or unwrapped.
        y: DVec2,
        /// Whether the event was a wrap, so that `y` is the pivot; else `x` is.
        wrapped: bool,
    },
}

/// A vertex whose ray is crossed, and the way in which the rope turns across it.
#[derive(Clone, Copy)]
struct Crossing {
    vertex: u32,
    at: DVec2,
    dir: f64,
}

impl<P: Resting> Sweep<P> {
    /// Applies the next event of `leg` to `rope` and returns it, or `None` when the leg has no more.
    ///
    /// `candidates` are the indices into `vertices` that are tried; they must hold every vertex of the closed triangle
    /// of the pivot and the leg. Repeats do no harm. One pass over the candidates; no allocation unless the rope grows.
    ///
    /// ```
    /// use tautline::geometry::TracePoint;
    /// use tautline::rope::{EventKind, Leg, Rope, Side, Sweep};
    /// let (mut rope, mut sweep) = (Rope::new([0.0, 0.0].into()), Sweep::default());
    /// let at = |x: f64, y: f64| TracePoint::from(glam::DVec2::new(x, y));
    /// let leg = Leg { a0: at(2.0, -1.0), a1: at(2.0, 1.0) };
    /// let event = sweep.next(&mut rope, &leg, &[[1.0, 0.0].into()], [0]);
    /// assert_eq!(event, Some((EventKind::Wrap, 0, Side::Left)));
    /// assert_eq!(sweep.next(&mut rope, &leg, &[[1.0, 0.0].into()], [0]), None);
    /// ```
    pub fn next<S: Strand<Pivot = P>>(
        &mut self,
        rope: &mut S,
        leg: &Leg,
        vertices: &[DVec2],
        candidates: impl IntoIterator<Item = u32>,
    ) -> Option<(EventKind, u32, Side)> {
        let o = rope.pivot();
        let mut first: Option<Crossing> = None;
        for vertex in candidates {
            let at = vertices[vertex as usize];
            if let Some(dir) = self.wraps(o, at, leg)
                && first.is_none_or(|f| meets_before(o, at, f.at, dir))
            {
                first = Some(Crossing { vertex, at, dir });
            }
        }
        let x = rope.prior();
        let unwrap = rope.side().and_then(|side| self.unwraps(x, o.at(), side, leg));
        match (first, unwrap) {
            (None, None) => None,
            (Some(c), unwrap) if unwrap.is_none_or(|dir| x.orient(o.at(), c.at) * dir <= 0.0) => {
                Some((EventKind::Wrap, c.vertex, self.wrap(rope, c.vertex, c.at, c.dir)))
            }
            (_, Some(dir)) => {
                let (vertex, side) = self.unwrap(rope, dir)?;
                Some((EventKind::Unwrap, vertex, side))
            }
            (Some(_), None) => unreachable!("a crossing without an unwrap is a wrap"),
        }
    }

    /// Wraps `rope` round the vertex at `at`, in which it turns by `dir`, and returns on which side that lies.
    #[inline]
    pub(crate) fn wrap<S: Strand<Pivot = P>>(&mut self, rope: &mut S, vertex: u32, at: DVec2, dir: f64) -> Side {
        let side = Side::of(dir);
        *self = Sweep::After { dir, x: rope.pivot(), y: at, wrapped: true };
        rope.push(vertex, at, side);
        side
    }

    /// Unwraps `rope` from its pivot, in which it turns by `dir`, and returns that and its side; `None` if it has none.
    #[inline]
    pub(crate) fn unwrap<S: Strand<Pivot = P>>(&mut self, rope: &mut S, dir: f64) -> Option<(u32, Side)> {
        let (x, y) = (rope.prior(), rope.pivot().at());
        let left = rope.pop()?;
        *self = Sweep::After { dir, x, y, wrapped: false };
        Some(left)
    }

    /// The way in which the rope turns across the ray of the vertex at `p` from pivot `o`, if it still will.
    #[inline]
    fn wraps(&self, o: P, p: DVec2, leg: &Leg) -> Option<f64> {
        match *self {
            Sweep::Start => crosses(o, p, leg),
            Sweep::After { dir, x, y, wrapped } => {
                let start = x.orient(y, p) * dir;
                let comes_after = start > 0.0 || (start == 0.0 && wrapped && x.forwards(y, p));
                (comes_after && is_past(o, p, leg, dir)).then_some(dir)
            }
        }
    }

    /// The way in which the rope turns back across the ray of its pivot `o` from the prior `x`, if it still will.
    #[inline]
    fn unwraps(&self, x: P, o: DVec2, side: Side, leg: &Leg) -> Option<f64> {
        let back = -side.sign();
        match *self {
            Sweep::Start => crosses(x, o, leg).filter(|&dir| dir == back),
            // After an unwrap the last leg may double back from the pivot along the rope itself (round the end of a
            // wall along which it lies). The unwrapping ray is then a half turn away, which no leg reaches; but a goal
            // on that very line would count as past it.
            Sweep::After { dir, x: pivot, y, .. } => {
                let doubles_back = || x.orient(pivot.at(), y) == 0.0 && !x.forwards(pivot.at(), y);
                (dir == back && is_past(x, o, leg, dir) && !doubles_back()).then_some(dir)
            }
        }
    }
}

/// Whether the leg crosses the ray that starts at `p` and goes away from `o`, and which way.
#[inline]
fn crosses<P: Resting>(o: P, p: DVec2, leg: &Leg) -> Option<f64> {
    let after = o.left_of(p, leg.a1);
    if o.left_of(p, leg.a0) == after {
        return None;
    }
    let dir = if after { 1.0 } else { -1.0 };
    (orient_step(leg.a0, leg.a1, p) * dir >= 0.0).then_some(dir)
}

/// Whether the free end's goal lies past the ray of `p` from `o` when turning by `dir`, and gets there beyond `p`.
#[inline]
fn is_past<P: Resting>(o: P, p: DVec2, leg: &Leg, dir: f64) -> bool {
    o.left_of(p, leg.a1) == (dir > 0.0) && orient_step(leg.a0, leg.a1, p) * dir >= 0.0
}

/// Whether the rope's last leg, turning about `o` by `dir`, meets the vertex at `p` before that at `q`: the nearer
/// first where both lie on one line.
#[inline]
fn meets_before<P: Resting>(o: P, p: DVec2, q: DVec2, dir: f64) -> bool {
    let order = o.orient(p, q) * dir;
    order > 0.0 || (order == 0.0 && o.forwards(p, q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rope::Rope;

    #[test]
    fn vertices_on_one_line_are_pushed_nearest_first() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let vertices = [p(2.0, 0.0), p(3.0, 0.0), p(1.0, 0.0)];
        let mut rope = Rope::new(DVec2::ZERO);
        let leg = Leg { a0: p(5.0, -1.0).into(), a1: p(5.0, 1.0).into() };
        let mut sweep = Sweep::default();
        let mut wraps = || sweep.next(&mut rope, &leg, &vertices, 0..3);
        for vertex in [2, 0, 1] {
            assert_eq!(wraps(), Some((EventKind::Wrap, vertex, Side::Left)));
        }
        assert_eq!(wraps(), None);
        // Only the last is a corner of the taut rope.
        assert_eq!(rope.taut(leg.a1.at).iter().map(|c| c.vertex).collect::<Vec<_>>(), [1]);
    }

    /// The rope is wound round a wall and lies along it, so its last leg doubles back at the wall's end. Unwrapping the
    /// other end with the free end exactly on the wall's line must not unwrap both.
    #[test]
    fn a_rope_that_doubles_back_is_unwrapped_once() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let vertices = [p(0.0, 1.0), p(0.0, 0.0)];
        let mut rope = Rope::new(p(0.013, 0.017));
        for vertex in [1, 0, 1] {
            rope.push(vertex, vertices[vertex as usize], Side::Right);
        }
        let leg = Leg { a0: p(-3.5, 0.0).into(), a1: p(0.0, -0.5).into() };
        let mut sweep = Sweep::default();
        assert_eq!(sweep.next(&mut rope, &leg, &vertices, [0, 1]), Some((EventKind::Unwrap, 1, Side::Right)));
        assert_eq!(sweep.next(&mut rope, &leg, &vertices, [0, 1]), None);
    }

    #[test]
    fn left_is_half_open_in_both_directions() {
        // A trace point exactly on the ray belongs to the left: coming from the right wraps at once, and going back to
        // the right unwraps.
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let vertices = [p(1.0, 0.0)];
        let (below, on) = (TracePoint::from(p(2.0, -1.0)), TracePoint::from(p(2.0, 0.0)));
        let mut rope = Rope::new(DVec2::ZERO);
        let mut step = |a0, a1| Sweep::default().next(&mut rope, &Leg { a0, a1 }, &vertices, [0]);
        assert_eq!(step(below, on), Some((EventKind::Wrap, 0, Side::Left)));
        assert_eq!(step(on, below), Some((EventKind::Unwrap, 0, Side::Left)));
    }
}
