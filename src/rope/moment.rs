//! The rope on its way: after each step, and in the middle of a step where something happens to it.

use glam::DVec2;

use super::{Contact, Rope};

/// The rope at one moment of a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The step that is under way or has just ended; 0 is the move from the anchor to the trace's first point.
    pub step: usize,
    /// How much of the step has been made, from 0 to 1.
    pub share: f64,
    /// Where the free end is, in the scene's frame and unit. At the end of a step it is the trace's point; within one
    /// it is a constructed point and so rounded.
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

    /// The corners that the rope has as the free end moves on: [`Rope::taut`], but with the pivot even where a rope
    /// that has just been wrapped does not bend yet, or stands on it. O(contacts).
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
