//! Where the free end may go: within the scene's bounding box, off the walls.

use std::sync::Arc;

use glam::DVec2;

use crate::scene::Model;

pub(super) struct Room {
    pub(super) model: Arc<Model>,
    /// The corners of the scene's bounding box.
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Room {
    pub(super) fn new(model: Arc<Model>) -> Self {
        let (low, high) = model.bounds();
        Room { model, low, high }
    }

    /// Whether `p` lies in the box, its border included.
    #[inline]
    pub(super) fn holds(&self, p: DVec2) -> bool {
        (p.x >= self.low.x) & (p.x <= self.high.x) & (p.y >= self.low.y) & (p.y <= self.high.y)
    }

    /// Whether the free end can be dragged from `a`, a point of the room, straight to `b` without touching a wall or
    /// leaving the box.
    #[inline]
    pub(super) fn is_open(&self, a: DVec2, b: DVec2) -> bool {
        self.holds(b) && self.model.is_clear(a, b)
    }
}
