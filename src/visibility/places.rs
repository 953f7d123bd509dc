//! Triangles as places in the plane: which can be reached, which are seen, and what is seen from a point in one.

use glam::DVec2;

use rstar::{AABB, RTree, primitives::Rectangle};

use super::mesh::{CLOSED, next};
use super::{Scratch, Visibility};
use crate::geometry::{higher, lower, orient};
use crate::scene::Pivot;

/// Which triangles can be reached from a point without crossing a wall, by their numbers.
pub(crate) struct Reach {
    /// Those that can; where walls cross at a point that no f64 names, some may be missing.
    pub(crate) surely: Vec<bool>,
    /// None of those that cannot is missing here; where walls cross at such a point, some that cannot may be among
    /// them.
    pub(crate) perhaps: Vec<bool>,
}

impl Visibility {
    /// The triangles that can be reached from `pivot` without crossing a wall, in no particular order; none if it lies
    /// out of reach. Where walls cross at a point that no f64 names, some that cannot be reached may be among them.
    /// O(triangles).
    pub(crate) fn reached(&self, pivot: Pivot) -> Vec<u32> {
        self.reached_through(pivot, |_| true)
    }

    /// The triangles that can be reached from `pivot` through those edges alone for whose numbers `is_passed` holds.
    pub(super) fn reached_through(&self, pivot: Pivot, is_passed: impl Fn(u32) -> bool) -> Vec<u32> {
        let Some(o) = self.mesh.vertex(pivot) else { return Vec::new() };
        self.flood(self.mesh.fan(o).iter().map(|edge| edge / 4).collect(), is_passed)
    }

    /// What can be reached from `at`, which lies in no wall, between its ends; from a wall's end, that is all round it.
    /// The looks of this kind need the whole mesh. O(triangles log loose walls).
    pub(crate) fn reach(&self, at: DVec2) -> Reach {
        let is_around = |&triangle: &u32| {
            let [p, q, r] = self.triangle(triangle);
            orient(p, q, at) >= 0.0 && orient(q, r, at) >= 0.0 && orient(r, p, at) >= 0.0
        };
        let around: Vec<u32> = (0..self.mesh.triangles() as u32).filter(is_around).collect();
        // Whoever keeps out of all triangles near a loose wall has crossed none.
        let boxes = self.mesh.loose().map(|ends| Rectangle::from_corners(ends[0].to_array(), ends[1].to_array()));
        let loose = RTree::bulk_load(boxes.collect());
        let is_sure = |triangle| {
            let [p, q, r] = self.triangle(triangle);
            let (low, high) = (lower(lower(p, q), r), higher(higher(p, q), r));
            let near = AABB::from_corners(low.to_array(), high.to_array());
            loose.locate_in_envelope_intersecting(near).next().is_none()
        };
        let marked = |triangles: Vec<u32>| {
            let mut marks = vec![false; self.mesh.triangles()];
            triangles.into_iter().for_each(|triangle| marks[triangle as usize] = true);
            marks
        };
        let sure = around.iter().copied().filter(|&triangle| is_sure(triangle)).collect();
        let surely = self.flood(sure, |edge| is_sure(self.mesh.edge(edge).twin / 4));
        Reach { surely: marked(surely), perhaps: marked(self.flood(around, |_| true)) }
    }

    /// `triangles`, and all that are reached from them without crossing a wall, through edges only for whose number
    /// `is_passed` holds.
    fn flood(&self, mut triangles: Vec<u32>, is_passed: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut is_reached = vec![false; self.mesh.triangles()];
        for &triangle in &triangles {
            is_reached[triangle as usize] = true;
        }
        let mut done = 0;
        while done < triangles.len() {
            for edge in 4 * triangles[done]..4 * triangles[done] + 3 {
                let twin = self.mesh.edge(edge).twin;
                if twin != CLOSED && !is_reached[twin as usize / 4] && is_passed(edge) {
                    is_reached[twin as usize / 4] = true;
                    triangles.push(twin / 4);
                }
            }
            done += 1;
        }
        triangles
    }

    /// The triangles left and right of the wall from vertex `from` to vertex `to`; `None` if it is not one edge of the
    /// mesh, or not closed. O(triangles round `from`).
    pub(crate) fn beside(&self, from: u32, to: u32) -> Option<[u32; 2]> {
        let [from, to] = [from, to].map(|v| self.mesh.vertex(Pivot::at_vertex(v)));
        let (from, to) = (from?, to?);
        let fan = self.mesh.fan(from).iter().copied();
        let left = fan.clone().find(|&edge| self.mesh.edge(next(edge)).origin == to)?;
        let right = fan.clone().find(|&edge| self.mesh.edge(next(next(edge))).origin == to)?;
        (self.mesh.edge(left).twin == CLOSED).then_some([left / 4, right / 4])
    }

    /// The triangles that meet what is visible from `pivot`, each once, ascending; none if it lies out of reach.
    pub(crate) fn seen(&self, pivot: Pivot) -> Vec<u32> {
        let o = self.mesh.vertex(pivot);
        o.map_or(Vec::new(), |o| self.mesh.triangles_seen(o, &mut Scratch::default()))
    }

    /// The corners of a triangle, counter-clockwise.
    pub(crate) fn triangle(&self, triangle: u32) -> [DVec2; 3] {
        [0, 1, 2].map(|i| self.mesh.at(self.mesh.edge(4 * triangle + i).origin))
    }

    /// What [`look`](Self::look) writes for a pivot, from a point inside a triangle or on its border, but not on a
    /// corner and on no wall.
    pub(crate) fn look_from(&self, at: DVec2, triangle: u32, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        seen.clear();
        let listed = self.mesh.expand_from(at, triangle, scratch);
        self.name_tangent(at, scratch.seen(listed), seen);
    }
}
