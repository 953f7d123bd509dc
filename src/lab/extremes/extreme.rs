//! One extreme case.

use std::sync::Arc;

use glam::DVec2;

use crate::scene::{Model, Scene};
use crate::trace::Trace;

/// A scene and traces in it.
#[derive(Debug, Clone)]
pub struct Extreme {
    /// What is extreme here, among the others of its family.
    pub name: String,
    /// The ends of the walls; some may have no length.
    pub walls: Vec<[DVec2; 2]>,
    /// Where the ropes are tied.
    pub anchor: DVec2,
    /// What the free ends are dragged along; all keep to the rules.
    pub traces: Vec<Trace>,
}

impl Extreme {
    /// The scene, ready to be evaluated. O(walls log walls).
    pub fn model(&self) -> Arc<Model> {
        let scene = Scene::new(self.walls.iter().copied()).expect("all coordinates can be computed with");
        Arc::new(Model::new(scene, Some(self.anchor)).expect("the anchor stands off the walls or at an end"))
    }
}
