//! What there is without files: scenes by name, and traces walked in them.

mod built_in;
mod draws;
mod floor_plan;
mod lattice_walls;
mod random_walls;
mod walker;

pub(crate) use draws::Draws;

pub use built_in::{BuiltIn, NameError};
pub use floor_plan::floor_plan;
pub use lattice_walls::lattice_walls;
pub use random_walls::random_walls;
pub use walker::{Walker, settled_walks, some_walks, walks};
