//! A trace as a film: where the free end is and how the rope runs, moment by moment.

use glam::DVec2;

use super::{Dragged, Drawing};
use crate::rope::{EventKind, Moment, Side};

/// A corner of the rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) at: DVec2,
    pub(super) left: bool,
    /// Whether the rope turns there; else it passes straight.
    pub(super) turns: bool,
}

/// The rope at one moment. Up to the next one the free end goes straight on and the rope keeps its corners.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// In steps: at k, point k has been reached.
    pub(super) time: f64,
    pub(super) at: DVec2,
    /// Which of the film's ropes it is.
    pub(super) rope: usize,
    /// The taut rope's length.
    pub(super) length: f64,
}

/// A film of one trace.
#[derive(Debug, Default)]
pub(super) struct Film {
    pub(super) states: Vec<State>,
    pub(super) ropes: Vec<Vec<Corner>>,
}

impl Drawing<'_> {
    /// The film of a trace, of about `most` moments: those of all events and of every so many steps, or, where events
    /// are too many, of every so many steps alone.
    pub(super) fn film(&self, dragged: &Dragged<'_>, most: usize) -> Film {
        let every = dragged.points.len().div_ceil(most);
        let events_too = dragged.record.events.len() <= most;
        let last = dragged.points.len() - 1;
        let mut film = Film::default();
        let y_down = self.scene.y_down();
        // The rope lies in the anchor before it is dragged to the first point.
        let anchor = self.anchor.unwrap_or_default();
        if dragged.points[0] != anchor {
            film.take(-1.0, &Moment::start(anchor), y_down);
        }
        self.moments(dragged, &dragged.points, |m| {
            let wanted = match m.event {
                Some(_) => events_too,
                None => m.step % every == 0 || m.step == last,
            };
            if wanted {
                film.take(m.step as f64 - 1.0 + m.share, m, y_down);
            }
        });
        film
    }
}

impl Film {
    fn take(&mut self, time: f64, moment: &Moment, y_down: bool) {
        let turns = moment.turns();
        let mut rest = turns.as_slice();
        let mut corners = Vec::new();
        for c in moment.rope.contacts() {
            let turns = rest.first() == Some(c);
            rest = &rest[usize::from(turns)..];
            corners.push(Corner { vertex: c.vertex, at: c.at, left: c.side.shown(y_down) == Side::Left, turns });
        }
        if self.ropes.last() != Some(&corners) {
            self.ropes.push(corners);
        }
        let length = moment.rope.length(moment.at);
        self.states.push(State { time, at: moment.at, rope: self.ropes.len() - 1, length });
    }

    /// When it begins and ends.
    pub(super) fn span(&self) -> (f64, f64) {
        let first = self.states.first().map_or(0.0, |s| s.time);
        (first, self.states.last().map_or(0.0, |s| s.time).max(first + 1.0))
    }
}

/// The most contacts that the rope ever has.
pub(super) fn most_contacts(dragged: &Dragged<'_>) -> usize {
    let depth = dragged.record.events.iter().scan(0usize, |depth, e| {
        match e.kind {
            EventKind::Wrap => *depth += 1,
            EventKind::Unwrap => *depth -= 1,
        }
        Some(*depth)
    });
    depth.max().unwrap_or(0)
}
