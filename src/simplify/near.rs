//! What stands in a triangle.

use glam::DVec2;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use crate::geometry::{higher, lower, opposite, orient};

type Place = GeomWithData<[f64; 2], u32>;

/// The vertices that are left, and the anchors, by place.
pub(super) struct Near {
    tree: RTree<Place>,
}

impl Near {
    /// With these points, numbered from 0. O(n log n).
    pub(super) fn new(points: impl Iterator<Item = DVec2>) -> Self {
        let places = points.zip(0..).map(|(p, number)| Place::new(p.to_array(), number));
        Near { tree: RTree::bulk_load(places.collect()) }
    }

    pub(super) fn remove(&mut self, number: u32, at: DVec2) {
        self.tree.remove(&Place::new(at.to_array(), number));
    }

    /// A point in the closed triangle, or segment, between three of them, other than these. Exact. O(log n + points in
    /// its bounding box).
    pub(super) fn inside(&self, corners: [(u32, DVec2); 3]) -> Option<u32> {
        let [p, q, r] = corners.map(|corner| corner.1);
        let turn = orient(p, q, r);
        let is_inside = |at: DVec2| {
            let signs = [orient(p, q, at), orient(q, r, at), orient(r, p, at)];
            // Of three points on one line, those of their line that lie in their box.
            if turn == 0.0 { signs == [0.0; 3] } else { signs.iter().all(|&sign| !opposite(sign, turn)) }
        };
        let (low, high) = (lower(lower(p, q), r), higher(higher(p, q), r));
        let near = self.tree.locate_in_envelope(AABB::from_corners(low.to_array(), high.to_array()));
        let mut others = near.filter(|place| corners.iter().all(|corner| corner.0 != place.data));
        others.find(|place| is_inside(DVec2::from(*place.geom()))).map(|place| place.data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_closed_and_hold_none_of_their_own_corners() {
        let points = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [2.0, 2.0], [2.0, 2.0 + 1e-15], [9.0, 0.0]].map(DVec2::from);
        let mut near = Near::new(points.into_iter());
        let corner = |i: usize| (i as u32, points[i]);
        for corners in [[0, 1, 2], [2, 1, 0]] {
            assert_eq!(near.inside(corners.map(corner)), Some(3));
        }
        near.remove(3, points[3]);
        assert_eq!(near.inside([0, 1, 2].map(corner)), None);
        // In one line.
        assert_eq!(near.inside([0, 1, 5].map(corner)), None);
        assert_eq!(near.inside([0, 5, 5].map(corner)), Some(1));
        let near = Near::new(points.into_iter().take(4));
        assert_eq!(near.inside([1, 2, 1].map(corner)), Some(3));
    }
}
