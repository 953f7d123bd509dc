//! Deciding in f32: which event does the rope's last leg meet first?
//!
//! This is what `--precision fast` asks in the place of the [candidate pass](crate::candidates). The answer is the
//! event itself, found by the rules of the [exact update](crate::rope::Sweep) with f32 cross products in the place of
//! exact signs. Nothing confirms it, so it can be wrong wherever rounding turns a sign: close to a ray, where walls lie
//! on one line, and far from the scene.

mod decide;
mod question;

pub use decide::decide;
pub use question::{Answer, NOBODY, NOTHING, Question, UNWRAP, rounded};

/// The most legs that one question covers: its points are 8 bytes each, and the lane that answers it looks at them one
/// by one.
pub const MOST_LEGS: usize = 64;
