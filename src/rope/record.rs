//! What a trace's evaluation reports.

use glam::DVec2;

use super::Side;

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
