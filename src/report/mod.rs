//! What is measured of engines, side by side.

pub mod bench;
mod environment;
pub mod extremes;
pub mod filter;
mod note;
mod spread;
pub mod tradeoff;

pub use environment::{Environment, processor};
pub use note::{NoteErrors, note_errors};
pub use spread::Spread;
