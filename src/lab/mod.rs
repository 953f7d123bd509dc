//! What measures the program itself: engines side by side, what speed costs in accuracy, and extreme cases. Who only
//! wants ropes needs nothing of it.

pub mod astray;
pub mod bench;
pub mod extremes;
pub mod filter;
mod note;
mod spread;
mod surroundings;
pub mod tradeoff;

pub use note::{NoteErrors, note_errors};
pub use spread::Spread;
pub use surroundings::Surroundings;
