//! Triangles as places in the plane: which can be reached, which are seen, and what is seen from a point in one.

use glam::DVec2;

use super::mesh::ABSENT;
use super::{Scratch, Visibility};

impl Visibility {
    /// The triangles that can be reached from `pivot` without crossing a wall, in no particular order; none if it lies out of
    /// reach. Where walls cross at a point that no f64 names, some that cannot be reached may be among them. O(triangles).
    pub(crate) fn reached(&self, pivot: u32) -> Vec<u32> {
        let Some(o) = self.mesh.pivot(pivot) else { return Vec::new() };
        let mut is_reached = vec![false; self.mesh.triangles()];
        let mut triangles: Vec<u32> = self.mesh.fan(o).iter().map(|edge| edge / 4).collect();
        for &triangle in &triangles {
            is_reached[triangle as usize] = true;
        }
        let mut done = 0;
        while done < triangles.len() {
            for beyond in self.mesh.neighbours(triangles[done]).into_iter().flatten() {
                if !std::mem::replace(&mut is_reached[beyond as usize], true) {
                    triangles.push(beyond);
                }
            }
            done += 1;
        }
        triangles
    }

    /// The triangles that meet what is visible from `pivot`, each once, ascending; none if it lies out of reach.
    pub(crate) fn seen(&self, pivot: u32) -> Vec<u32> {
        let o = self.mesh.pivot(pivot);
        o.map_or(Vec::new(), |o| self.mesh.triangles_seen(o, &mut Scratch::default()))
    }

    /// The corners of a triangle, counter-clockwise.
    pub(crate) fn triangle(&self, triangle: u32) -> [DVec2; 3] {
        [0, 1, 2].map(|i| self.mesh.at(self.mesh.edge(4 * triangle + i).origin))
    }

    /// What [`look`](Self::look) writes for a pivot, from a point inside a triangle or on its border, but not on a corner and
    /// on no wall.
    pub(crate) fn look_from(&self, at: DVec2, triangle: u32, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        seen.clear();
        self.mesh.expand_from(at, triangle, scratch, seen);
        seen.retain_mut(|v| {
            let name = self.mesh.name(*v);
            name != ABSENT && self.is_tangent(at, std::mem::replace(v, name))
        });
    }
}
