//! The rope on its way: after each step, and in the middle of a step where something happens to it.

use glam::DVec2;

use super::{Contact, Event, EventKind, Rope};

/// The rope at one moment of a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The step that is under way or has just ended; 0 is the move from the anchor to the trace's first point.
    pub step: usize,
    /// How much of the step has been made, from 0 to 1.
    pub share: f64,
    /// Where the free end is, in the scene's frame and unit. At the end of a step it is the trace's point; within one it
    /// is a constructed point and so rounded.
    pub at: DVec2,
    /// The number of the event that has just happened; `None` at the end of a step.
    pub event: Option<usize>,
    /// The rope, with that event applied.
    pub rope: Rope,
}

impl Moment {
    /// Before the first step: the free end is where the rope is tied.
    pub(crate) fn start(anchor: DVec2) -> Self {
        Moment { step: 0, share: 0.0, at: anchor, event: None, rope: Rope::new(anchor) }
    }

    /// The corners that the rope has as the free end moves on: [`Rope::taut`], but with the pivot even where a rope that
    /// has just been wrapped does not bend yet, or stands on it. O(contacts).
    pub fn turns(&self) -> Vec<Contact> {
        let mut rope = self.rope.clone();
        match rope.pop() {
            None => Vec::new(),
            Some(pivot) => {
                let mut turns = rope.taut(pivot.at);
                turns.push(pivot);
                turns
            }
        }
    }
}

/// Calls `each` with every moment of a trace in order: each event, then the end of its step. `vertices` are the scene's,
/// `points` the trace's, `events` those of its record. O(points + events).
///
/// # Panics
///
/// If the events are not a rope's: a vertex that is not there, or an unwrap of an empty rope.
///
/// ```
/// use glam::DVec2;
/// use tautline::rope::{Event, EventKind, Side, moments};
/// let vertices = [DVec2::new(1.0, 0.0)];
/// let points = [DVec2::new(2.0, -1.0), DVec2::new(2.0, 1.0)];
/// let wrap = Event { step: 1, kind: EventKind::Wrap, vertex: 0, side: Side::Left };
/// let mut places = vec![];
/// moments(DVec2::ZERO, &vertices, &points, &[wrap], |m| places.push((m.step, m.at.y, m.rope.contacts().len())));
/// assert_eq!(places, [(0, -1.0, 0), (1, 0.0, 1), (1, 1.0, 1)]);
/// ```
pub fn moments(anchor: DVec2, vertices: &[DVec2], points: &[DVec2], events: &[Event], mut each: impl FnMut(&Moment)) {
    let mut moment = Moment::start(anchor);
    let mut events = events.iter().enumerate().peekable();
    let mut from = anchor;
    for (k, &to) in points.iter().enumerate() {
        moment.step = k;
        moment.share = 0.0;
        while let Some((i, event)) = events.next_if(|(_, e)| e.step as usize <= k) {
            let rope = &moment.rope;
            let line = match event.kind {
                EventKind::Wrap => [rope.pivot(), vertices[event.vertex as usize]],
                EventKind::Unwrap => [rope.prior(), rope.pivot()],
            };
            // Rounding must not turn the order round.
            moment.share = crossing(line, [from, to]).unwrap_or(moment.share).clamp(moment.share, 1.0);
            moment.at = from.lerp(to, moment.share);
            moment.event = Some(i);
            event.apply(&mut moment.rope, vertices);
            each(&moment);
        }
        (moment.share, moment.at, moment.event) = (1.0, to, None);
        each(&moment);
        from = to;
    }
}

/// Which share of the way from `a` to `b` has been made where it meets the line through `o` and `p`, if it meets it once.
fn crossing([o, p]: [DVec2; 2], [a, b]: [DVec2; 2]) -> Option<f64> {
    let [before, after] = [a, b].map(|q| (p - o).perp_dot(q - o));
    Some(before / (before - after)).filter(|share| share.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Engine, Job, Reference};
    use crate::example::{Walker, floor_plan, walks};
    use crate::scene::Model;
    use crate::trace::{Trace, settle};

    #[test]
    fn every_step_has_the_rope_of_the_trace_that_ends_there() {
        let model = std::sync::Arc::new(Model::new(floor_plan(), None).unwrap());
        let mut reference = Reference::new(model.clone());
        let mut all_events = 0;
        // Long steps, so that one has several events.
        for trace in walks(&model, Walker { step: 2.0, steps: 60, seed: 5 }, 12) {
            let mut record = |n: usize| {
                let cut = settle(&model, &Trace { id: 0, points: trace.points[..n].to_vec() });
                reference.evaluate(&[cut], &Job::new()).unwrap().remove(0)
            };
            let whole = record(trace.points.len());
            let (mut steps, mut events) = (0, 0);
            let mut last = (0.0, model.anchor());
            moments(model.anchor(), model.vertices(), &trace.points, &whole.events, |m| {
                // The rope gives and takes no more than the free end moves: events happen where both ropes are one.
                let length = m.rope.length(m.at);
                assert!((length - last.0).abs() <= m.at.distance(last.1) + 1e-9, "step {}", m.step);
                last = (length, m.at);
                if m.event.is_some() {
                    assert_eq!(m.event, Some(events));
                    events += 1;
                    return;
                }
                assert_eq!((m.step, m.at), (steps, trace.points[steps]));
                steps += 1;
                let cut = record(steps);
                let taut: Vec<_> = m.rope.taut(m.at).iter().map(|c| (c.at, c.side)).collect();
                assert_eq!((taut, length), (cut.wraps, cut.length), "step {}", m.step);
            });
            assert_eq!((steps, events), (trace.points.len(), whole.events.len()));
            all_events += events;
        }
        assert!(all_events > 50, "{all_events}");
    }
}
