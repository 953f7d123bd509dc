//! What is measured of engines, side by side.

pub mod bench;
mod environment;
pub mod extremes;
mod spread;

pub use environment::{Environment, processor};
pub use spread::Spread;
