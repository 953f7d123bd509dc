//! What lengths are measured in.

use crate::scene::Scene;

/// What a unit of the scene is called on axes.
pub(super) fn unit(scene: &Scene) -> &str {
    scene.unit().unwrap_or("scene units")
}
