//! skeleton
pub mod geometry;
pub mod output;
mod read_error;
pub mod rope;
pub mod scene;
pub mod trace;

pub use read_error::{Place, ReadError};
