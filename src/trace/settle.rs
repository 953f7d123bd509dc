//! Settling a trace: checking its steps against the walls, and deciding on which side it passes the wall ends that it
//! touches.
//!
//! A trace may stand anywhere on a wall, pass exactly through a vertex, or slide along walls. It then counts as passing
//! a hair off the walls, on the side that it comes from and goes on to; from an anchor on a solid's border, on the free
//! side; where both sides would do, on the left. Settled traces need no further thought: their points carry their
//! [`Hair`](crate::geometry::Hair).

use std::ops::ControlFlow::Continue;

use glam::DVec2;

use super::pluck::pluck;
use super::settled::{Broken, violation};
use super::{SettledTrace, Trace, Violation, ViolationKind};
use crate::geometry::{between, check_points, higher, lower, opposite, orient, same_side};
use crate::scene::Model;

/// How many steps share one look at the walls. Most looks find none; one that does is followed by a look for each step.
const STEPS_PER_LOOK: usize = 16;

/// Checks `trace` against the model's walls and settles on which side it passes the walls that it touches.
///
/// O(points + walls near them), through the model's index.
///
/// # Panics
///
/// If the trace has no point or more than 2^31, or one that [`check_point`] refuses. What [`read_traces`] gives is
/// sound.
///
/// [`check_point`]: crate::geometry::check_point
/// [`read_traces`]: super::read_traces
pub fn settle(model: &Model, trace: &Trace) -> SettledTrace {
    let layout = Layout::new(model, trace, model.anchor());
    let points = layout.points(&trace.points);
    layout.settle(model, trace.id, points)
}

/// [`settle`] for a trace that is not needed any more: its points are taken over rather than copied.
///
/// # Panics
///
/// Where [`settle`] does.
pub fn settle_owned(model: &Model, mut trace: Trace) -> SettledTrace {
    let layout = Layout::new(model, &trace, model.anchor());
    let points = match layout.inserted.as_slice() {
        [] => std::mem::take(&mut trace.points),
        _ => layout.points(&trace.points),
    };
    layout.settle(model, trace.id, points)
}

/// [`settle_owned`] for a trace of which it is known that neither a step nor the straight way from the anchor to the
/// first point touches a wall, unless it leaves the wall's end at which the anchor stands: the walls are not looked at.
///
/// # Panics
///
/// If the trace has no point.
pub(crate) fn settle_clear(model: &Model, mut trace: Trace) -> SettledTrace {
    if model.border().is_some() {
        // The points at the anchor need hairs.
        return settle_owned(model, trace);
    }
    let layout = Layout::start(model, model.anchor(), trace.points[0]);
    for &(i, p) in &layout.inserted {
        trace.points.insert(i as usize, p);
    }
    layout.settle(model, trace.id, trace.points)
}

/// The first step that breaks the rules of a way that starts at its first point, wherever the anchor is.
///
/// # Panics
///
/// Where [`settle`] does.
pub(crate) fn first_violation(model: &Model, way: Trace) -> Option<Violation> {
    let layout = Layout::new(model, &way, way.points[0]);
    let points = layout.points(&way.points);
    layout.settle(model, way.id, points).broken.first
}

/// What is to be added to a trace's points, and what they touch.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Layout {
    /// Points that are not the trace's own, with their indices among the settled points; ascending.
    pub(super) inserted: Vec<(u32, DVec2)>,
    /// Indices of the settled points that stand on walls, ascending.
    pub(super) touching: Vec<u32>,
    pub(super) broken: Broken,
}

impl Layout {
    /// Looks at every step of a trace of a rope that is tied at `anchor`.
    fn new(model: &Model, trace: &Trace, anchor: DVec2) -> Self {
        let points = trace.points.as_slice();
        assert!(!points.is_empty() && points.len() < 1 << 31, "a trace has 1 to 2^31 points");
        if let Err((_, fault)) = check_points(points) {
            panic!("trace {}: {fault}", trace.id);
        }
        let mut layout = Layout::start(model, anchor, points[0]);
        let mut from = anchor;
        for (block, first) in points.chunks(STEPS_PER_LOOK).zip((0..).step_by(STEPS_PER_LOOK)) {
            let (low, high) = block.iter().fold((from, from), |(low, high), &p| (lower(low, p), higher(high, p)));
            if !model.index().is_free(low, high) {
                for (&to, step) in block.iter().zip(first..) {
                    layout.step(model, trace, step, [from, to]);
                    from = to;
                }
            }
            from = block[block.len() - 1];
        }
        layout
    }

    /// Adds the anchor to a trace that does not start there.
    fn start(model: &Model, anchor: DVec2, first: DVec2) -> Self {
        let mut layout = Layout::default();
        if first != anchor {
            layout.inserted.push((0, anchor));
            if model.is_on_wall(anchor) {
                layout.touching.push(0);
            }
        }
        layout
    }

    /// Looks at one step.
    fn step(&mut self, model: &Model, trace: &Trace, step: usize, [a, b]: [DVec2; 2]) {
        // The vertices that the step passes on its way.
        let mut passed: Vec<DVec2> = Vec::new();
        let mut touches = false;
        let _ = model.index().visit::<()>(lower(a, b), higher(a, b), |wall, [u, v]| {
            let (from_a, from_b) = (orient(u, v, a), orient(u, v, b));
            touches |= b == u || b == v || from_b == 0.0 && between(u, v, b);
            if a == b || same_side(from_a, from_b) {
                return Continue(());
            }
            let (to_u, to_v) = (orient(a, b, u), orient(a, b, v));
            if opposite(from_a, from_b) && opposite(to_u, to_v) {
                self.broken.note(violation(model, trace.id, step, ViolationKind::Crosses, wall, [a, b]));
            }
            passed
                .extend([(to_u, u), (to_v, v)].into_iter().filter(|&(s, w)| s == 0.0 && between(a, b, w)).map(|p| p.1));
            Continue(())
        });
        passed.sort_by(|p, q| {
            let ahead = |p: DVec2| if a.x < b.x || (a.x == b.x && a.y < b.y) { p } else { -p };
            let (p, q) = (ahead(*p), ahead(*q));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
        });
        passed.dedup();
        let next = |layout: &Layout| (step + layout.inserted.len()) as u32;
        for p in passed {
            self.touching.push(next(self));
            self.inserted.push((next(self), p));
        }
        if touches {
            self.touching.push(next(self));
        }
    }

    /// The settled points, given the trace's own.
    fn points(&self, own: &[DVec2]) -> Vec<DVec2> {
        let mut points = Vec::with_capacity(own.len() + self.inserted.len());
        let mut rest = own;
        for &(i, p) in &self.inserted {
            let (before, after) = rest.split_at(i as usize - points.len());
            points.extend_from_slice(before);
            points.push(p);
            rest = after;
        }
        points.extend_from_slice(rest);
        points
    }

    fn settle(self, model: &Model, id: u64, points: Vec<DVec2>) -> SettledTrace {
        let added = self.inserted.iter().map(|p| p.0).collect();
        let mut settled = SettledTrace::new(id, points, added, self.broken);
        if !self.touching.is_empty() {
            pluck(model, &mut settled, &self.touching);
        }
        settled
    }
}
