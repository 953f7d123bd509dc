//! What a trace's evaluation reports.

use std::collections::VecDeque;

use glam::DVec2;

use super::{Rope, Side};
use crate::trace::End;

/// What happened to the rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EventKind {
    /// A contact was pushed.
    Wrap,
    /// The last contact was popped.
    Unwrap,
}

impl EventKind {
    /// `wrap` or `unwrap`, as the event log names it.
    pub fn name(self) -> &'static str {
        match self {
            EventKind::Wrap => "wrap",
            EventKind::Unwrap => "unwrap",
        }
    }
}

/// One push or pop. A trace's events, in order, give its rope at every step ([`replay`](super::replay())).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Event {
    /// The step in which it happened: the move from point `step - 1` to point `step`; 0 is the move from the anchor
    /// to the first point.
    pub step: u32,
    /// Push or pop.
    pub kind: EventKind,
    /// Which vertex of the scene.
    pub vertex: u32,
    /// The side on which the vertex lies, as if y pointed up: [`Side::shown`] is what a picture shows.
    pub side: Side,
}

/// Whether a trace kept to the rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// Every step kept clear of the walls.
    Ok,
    /// Some step crossed a wall or stood in one. From there on the rope is what the update makes of the steps as if the
    /// walls let them through; it can be wrong once it turns more than half way round a wall's end.
    Violation,
}

impl Status {
    /// `ok` or `violation`, as results name it.
    pub fn name(self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::Violation => "violation",
        }
    }
}

/// The result of one trace. Lengths are in the scene's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceRecord {
    /// The trace's number.
    pub trace: u64,
    /// Whether it kept to the rules.
    pub status: Status,
    /// How many steps it has: its points less one.
    pub steps: u64,
    /// The taut rope's length at the end.
    pub length: f64,
    /// The largest of its lengths after every step.
    pub max_length: f64,
    /// The number of turns of the taut rope at the end.
    pub depth: u32,
    /// The largest of its depths after every step.
    pub max_depth: u32,
    /// The taut rope at the end: its turns from the anchor, each with its vertex's position and the side on which that
    /// lies, as if y pointed up.
    pub wraps: Vec<(DVec2, Side)>,
    /// The unit vector along which the rope pulls the free end at the end; `None` for a rope of no length.
    pub pull: Option<DVec2>,
    /// Every push and pop, in order.
    pub events: Vec<Event>,
}

/// The result of one trace of a rope whose ends both move.
#[derive(Debug, Clone, PartialEq)]
pub struct EndsRecord {
    /// What is said of every trace: lengths and depths after every step of both ends, the rope from where the anchor is
    /// at last, the pull of the free end, and the events. These come and go at either end.
    pub record: TraceRecord,
    /// At which end each of the events happened.
    pub ends: Vec<End>,
}

impl EndsRecord {
    /// Every event with the end at which it happened, in order.
    pub fn events(&self) -> impl Iterator<Item = (&Event, End)> {
        self.record.events.iter().zip(self.ends.iter().copied())
    }

    /// The rope after a step, when the anchor is at `anchor`: the same contacts on a rope that is tied there.
    /// `vertices` are the scene's. O(events).
    ///
    /// # Panics
    ///
    /// If the events are not a rope's: a vertex that is not there, or an unwrap of an empty rope.
    pub fn rope_after(&self, vertices: &[DVec2], anchor: DVec2, step: usize) -> Rope {
        let mut contacts = VecDeque::new();
        for (event, end) in self.events().take_while(|(event, _)| event.step as usize <= step) {
            match (event.kind, end) {
                (EventKind::Wrap, End::Free) => contacts.push_back(event),
                (EventKind::Wrap, End::Anchor) => contacts.push_front(event),
                (EventKind::Unwrap, end) => {
                    let gone = if end == End::Free { contacts.pop_back() } else { contacts.pop_front() };
                    assert_eq!(gone.map(|e| e.vertex), Some(event.vertex), "an unwrap follows its wrap");
                }
            }
        }
        let mut rope = Rope::new(anchor);
        contacts.iter().for_each(|e| rope.push(e.vertex, vertices[e.vertex as usize], e.side));
        rope
    }
}
