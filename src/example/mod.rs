//! The built-in example: a floor plan, and traces walked in it.

mod floor_plan;
mod walker;

pub use floor_plan::floor_plan;
pub use walker::{Walker, some_walks, walks};
