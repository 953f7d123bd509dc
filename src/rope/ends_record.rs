//! What the evaluation of a trace reports whose ends both move.

use glam::DVec2;

use super::{Event, FreeRope, Rope, TraceRecord};
use crate::trace::End;

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
        let mut contacts = FreeRope::new(anchor.into());
        for (event, end) in self.events().take_while(|(event, _)| event.step as usize <= step) {
            contacts.play(end, event, vertices[event.vertex as usize]);
        }
        let mut rope = Rope::new(anchor);
        contacts.contacts().for_each(|c| rope.push(c.vertex, c.at, c.side));
        rope
    }
}
