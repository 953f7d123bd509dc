//! Which walls are near a box: an R-tree over the walls, built once.

use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

use super::Scene;

struct Entry {
    wall: u32,
    low: DVec2,
    high: DVec2,
}

impl RTreeObject for Entry {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

/// An index of a scene's walls by their bounding boxes.
pub struct WallIndex {
    tree: RTree<Entry>,
}

impl WallIndex {
    /// Builds the index; O(n log n).
    pub fn new(scene: &Scene) -> Self {
        let entries = (0..scene.walls().len())
            .map(|wall| {
                let [u, v] = scene.ends(wall);
                Entry { wall: wall as u32, low: u.min(v), high: u.max(v) }
            })
            .collect();
        WallIndex { tree: RTree::bulk_load(entries) }
    }

    /// The walls whose bounding box meets the closed box from `low` to `high`, in no particular order.
    pub fn near(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = u32> {
        self.tree.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array())).map(|e| e.wall)
    }
}
