//! What is measured of engines, side by side.

pub mod bench;
mod environment;
mod spread;

pub use environment::{Environment, processor};
pub use spread::Spread;
