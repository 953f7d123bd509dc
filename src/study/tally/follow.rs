//! A trace's rope from event to event.

use std::ops::Range;

use glam::DVec2;

use crate::rope::{Event, EventKind};

/// A contact of the rope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub vertex: u32,
    at: DVec2,
    /// The rope's length up to it.
    length: f64,
    /// After which step it was wrapped.
    since: u64,
    /// Whether the rope bent round the same wall end before, and still does.
    again: bool,
}

/// Steps between which the rope bends round the same wall ends.
pub(super) struct Span {
    /// The numbers of the steps after which that is so.
    pub steps: Range<u64>,
    /// The last contact, or the anchor.
    pub pivot: DVec2,
    /// The rope's length up to there.
    pub length: f64,
}

/// Calls `span` for each run of steps without an event, in order, and `left` for each contact with how many steps it
/// lasted, when it goes or at the end; 0 steps for a contact with a wall end that the rope had a contact with all the while.
/// O(events), and contacts for those with another wall end than before.
///
/// `steps` is the number of the last step; `vertices` are the scene's.
pub(super) fn follow(
    anchor: DVec2,
    vertices: &[DVec2],
    steps: u64,
    events: &[Event],
    mut span: impl FnMut(Span),
    mut left: impl FnMut(Held, u64),
) {
    let mut held: Vec<Held> = Vec::new();
    let mut start = 0;
    for event in events {
        let step = u64::from(event.step);
        let (pivot, length) = held.last().map_or((anchor, 0.0), |h| (h.at, h.length));
        if step > start {
            span(Span { steps: start..step, pivot, length });
            start = step;
        }
        match event.kind {
            EventKind::Wrap => {
                let at = vertices[event.vertex as usize];
                let length = length + pivot.distance(at);
                // Those of a winding rope come again soon.
                let again = held.iter().rev().any(|h| h.vertex == event.vertex);
                held.push(Held { vertex: event.vertex, at, length, since: step, again });
            }
            EventKind::Unwrap => {
                if let Some(gone) = held.pop() {
                    left(gone, if gone.again { 0 } else { step - gone.since });
                }
            }
        }
    }
    let (pivot, length) = held.last().map_or((anchor, 0.0), |h| (h.at, h.length));
    span(Span { steps: start..steps + 1, pivot, length });
    for gone in held {
        left(gone, if gone.again { 0 } else { steps + 1 - gone.since });
    }
}
