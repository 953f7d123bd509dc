//! What is measured of engines, side by side.

pub mod bench;
pub mod extremes;
pub mod filter;
mod note;
mod spread;
pub mod tradeoff;

pub use note::{NoteErrors, note_errors};
pub use spread::Spread;
