//! A trace's rope played again from its events: step by step, moment by moment, and span by span.

use std::ops::Range;

use glam::DVec2;

use super::stack::LastLeg;
use super::{Contact, Event, EventKind, Moment, Rope};

/// A trace's rope on its way through the events.
pub(super) struct Replay<'a> {
    /// The scene's.
    vertices: &'a [DVec2],
    events: &'a [Event],
    /// How many of the events have happened.
    happened: usize,
}

impl<'a> Replay<'a> {
    pub(super) fn new(vertices: &'a [DVec2], events: &'a [Event]) -> Self {
        Replay { vertices, events, happened: 0 }
    }

    /// The event that happens next.
    fn next(&self) -> Option<&'a Event> {
        self.events.get(self.happened)
    }

    /// The event that happens next, if that is so up to the end of `step`.
    pub(super) fn due(&self, step: usize) -> Option<&'a Event> {
        self.next().filter(|event| event.step as usize <= step)
    }

    /// Where the vertex of an event stands.
    pub(super) fn place(&self, event: &Event) -> DVec2 {
        self.vertices[event.vertex as usize]
    }

    /// Which share of a step from one of `ends` to the other has been made when `event` happens to the rope, of which
    /// `before` had been made when the one before it did.
    pub(super) fn share(&self, rope: &Rope, event: &Event, ends: [DVec2; 2], before: f64) -> f64 {
        let line = match event.kind {
            EventKind::Wrap => [rope.pivot(), self.place(event)],
            EventKind::Unwrap => [rope.prior(), rope.pivot()],
        };
        share_at(line, ends, before)
    }

    /// Makes the next event happen to the rope.
    pub(super) fn play(&mut self, rope: &mut Rope) {
        let event = &self.events[self.happened];
        match event.kind {
            EventKind::Wrap => rope.push(event.vertex, self.vertices[event.vertex as usize], event.side),
            EventKind::Unwrap => {
                let popped = rope.pop().expect("an unwrap follows a wrap");
                assert_eq!(popped.vertex, event.vertex, "the unwrap of a contact that is not the pivot");
            }
        }
        self.happened += 1;
    }
}

/// Calls `each` with every point's number and the rope after the move to it, given a trace's `events`.
///
/// `vertices` are the scene's; `points` is the number of the trace's points. O(points + events).
///
/// # Panics
///
/// If the events are not a rope's: a vertex that is not there, or an unwrap of an empty rope.
pub fn replay(anchor: DVec2, vertices: &[DVec2], points: usize, events: &[Event], mut each: impl FnMut(usize, &Rope)) {
    let (mut rope, mut replay) = (Rope::new(anchor), Replay::new(vertices, events));
    for k in 0..points {
        while replay.due(k).is_some() {
            replay.play(&mut rope);
        }
        each(k, &rope);
    }
}

/// Calls `each` with every moment of a trace in order: each event, then the end of its step. `vertices` are the
/// scene's, `points` the trace's, `events` those of its record. O(points + events).
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
    let (mut moment, mut replay) = (Moment::start(anchor), Replay::new(vertices, events));
    let mut from = anchor;
    for (k, &to) in points.iter().enumerate() {
        moment.step = k;
        moment.share = 0.0;
        while let Some(event) = replay.due(k) {
            moment.share = replay.share(&moment.rope, event, [from, to], moment.share);
            moment.at = from.lerp(to, moment.share);
            moment.event = Some(replay.happened);
            replay.play(&mut moment.rope);
            each(&moment);
        }
        (moment.share, moment.at, moment.event) = (1.0, to, None);
        each(&moment);
        from = to;
    }
}

/// Which share of a step between `ends` has been made where something happens to the rope that lies along a line, at
/// the second of its points, after `before` of it: where the step meets the line.
///
/// A step along the line, but for roundings, meets it nowhere or anywhere. What happens does so beyond that second
/// point, where the rope is as long with that contact as without it.
pub(super) fn share_at(line: [DVec2; 2], ends: [DVec2; 2], before: f64) -> f64 {
    let size = line.iter().chain(&ends).map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let along = line[1] - line[0];
    let is_on_it = |end: &DVec2| along.perp_dot(*end - line[0]).abs() <= ROUNDED * size * along.length();
    let share = if ends.iter().all(is_on_it) { passing(line, ends) } else { crossing(line, ends) };
    // Rounding must not turn the order round.
    share.unwrap_or(before).clamp(before, 1.0)
}

/// By how much of the greatest coordinate roundings can put a point off a line: some units in the last place.
const ROUNDED: f64 = 16.0 * f64::EPSILON;

/// Which share of the way from `a` to `b`, along the line from `o` through `p`, has been made where it comes beyond
/// `p`; `None` where it goes the other way.
fn passing([o, p]: [DVec2; 2], [a, b]: [DVec2; 2]) -> Option<f64> {
    let (along, way) = (p - o, b - a);
    (way.dot(along) > 0.0).then(|| (p - a).dot(along) / way.dot(along))
}

/// Which share of the way from `a` to `b` has been made where it meets the line through `o` and `p`, if it meets it
/// once.
fn crossing([o, p]: [DVec2; 2], [a, b]: [DVec2; 2]) -> Option<f64> {
    let [before, after] = [a, b].map(|q| (p - o).perp_dot(q - o));
    Some(before / (before - after)).filter(|share| share.is_finite())
}

/// What lasts over some steps of a trace.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Lasting {
    /// The runs of steps after which the rope has the same contacts, in order: all steps.
    pub spans: Vec<Span>,
    /// The contacts, in the order in which they went, and after them those that are there at the end.
    pub held: Vec<Held>,
}

/// Steps after each of which the rope has the same contacts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Span {
    pub steps: Range<usize>,
    pub leg: LastLeg,
}

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Held {
    /// The number of its wall end.
    pub vertex: u32,
    /// After how many steps it is there: 0 where the rope bent round the same wall end before it came, and still does.
    pub steps: u64,
}

/// What lasts in a trace. `last` is the number of the last step, `vertices` are the scene's. O(events), and contacts
/// for those with another wall end than before.
///
/// # Panics
///
/// If the events are not a rope's: a vertex that is not there, or an unwrap of an empty rope.
pub(crate) fn lasting(anchor: DVec2, vertices: &[DVec2], last: u64, events: &[Event]) -> Lasting {
    let (mut rope, mut replay) = (Rope::new(anchor), Replay::new(vertices, events));
    let mut all = Lasting::default();
    // After which step each contact came; none for one whose wall end the rope had a contact with already.
    let mut since: Vec<Option<u64>> = Vec::new();
    let steps = |since: Option<u64>, until: u64| since.map_or(0, |since| until - since);
    let mut start = 0;
    while let Some(event) = replay.next() {
        let step = event.step as usize;
        if step > start {
            all.spans.push(Span { steps: start..step, leg: rope.last_leg() });
            start = step;
        }
        match event.kind {
            EventKind::Wrap => {
                // Those of a winding rope come again soon.
                let again = rope.contacts().iter().rev().any(|contact| contact.vertex == event.vertex);
                since.push((!again).then_some(step as u64));
            }
            EventKind::Unwrap => {
                let since = since.pop().expect("an unwrap follows a wrap");
                all.held.push(Held { vertex: event.vertex, steps: steps(since, step as u64) });
            }
        }
        replay.play(&mut rope);
    }
    all.spans.push(Span { steps: start..last as usize + 1, leg: rope.last_leg() });
    let held = |(contact, since): (&Contact, _)| Held { vertex: contact.vertex, steps: steps(since, last + 1) };
    all.held.extend(rope.contacts().iter().zip(since).map(held));
    all
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

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

    /// Steps along the line of a leg, but for roundings, which put the ends on this side of it or that.
    #[test]
    fn a_step_along_a_leg_meets_its_end_where_the_rope_has_one_length() {
        let mut apart = 0;
        for i in 1..2000 {
            let along = DVec2::from_angle(f64::from(i));
            let origin = DVec2::new(f64::from(i % 7) / 3.0, f64::from(i % 5) / 7.0);
            let on = |far: f64| origin + along * far;
            let (line, [near, far]) = ([on(0.0), on(1.0)], [on(0.3), on(1.9)]);
            for (ends, least, most) in [([near, far], 0.7 / 1.6, 0.7 / 1.6), ([far, near], 0.0, 0.9 / 1.6)] {
                let share = share_at(line, ends, 0.0);
                assert!(share > least - 1e-9 && share < most + 1e-9, "{i}: {share}");
                apart += u32::from(crossing(line, ends).is_some_and(|s| s < least - 0.1 || s > most + 0.1));
            }
        }
        assert!(apart > 100, "{apart}");
    }

    #[test]
    fn spans_say_in_one_what_steps_say_one_by_one() {
        let model = std::sync::Arc::new(Model::new(floor_plan(), None).unwrap());
        let mut reference = Reference::new(model.clone());
        for trace in walks(&model, Walker { step: 2.0, steps: 200, seed: 6 }, 12) {
            let record = reference.evaluate(&[settle(&model, &trace)], &Job::new()).unwrap().remove(0);
            let lasting = lasting(model.anchor(), model.vertices(), record.steps, &record.events);
            let spans = lasting.spans.into_iter();
            let legs: Vec<_> = spans.flat_map(|span| span.steps.map(move |step| (step, span.leg))).collect();
            let mut held = BTreeMap::new();
            lasting.held.iter().for_each(|contact| *held.entry(contact.vertex).or_insert(0) += contact.steps);
            let (mut all, mut seen) = (Vec::new(), BTreeMap::new());
            replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |step, rope| {
                all.push((step, rope.last_leg()));
                let mut vertices: Vec<u32> = rope.contacts().iter().map(|c| c.vertex).collect();
                vertices.sort_unstable();
                vertices.dedup();
                vertices.into_iter().for_each(|vertex| *seen.entry(vertex).or_insert(0) += 1);
            });
            assert_eq!(legs, all);
            // Contacts that come and go within a step last for none.
            held.retain(|_, steps| *steps > 0);
            assert_eq!(held, seen);
        }
    }
}
