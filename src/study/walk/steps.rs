//! One step after the other, whatever they are like.

use glam::DVec2;

use super::at_walls::{AtWalls, meet};
use super::room::{Clearing, Room};
use super::stride::Stride;
use crate::geometry::point;
use crate::study::random::Random;

impl Room {
    /// The points of a walk of `steps` steps from `start`, in memory with room for one more, and how many of the steps
    /// met a wall or the border as they were drawn first.
    pub(super) fn walk(
        &self,
        at_walls: AtWalls,
        start: DVec2,
        steps: u32,
        mut stride: impl Stride,
        random: &mut Random,
    ) -> (Vec<DVec2>, usize) {
        let mut points = Vec::with_capacity(steps as usize + 2);
        points.push(start);
        let mut met = 0;
        let (mut here, mut clearing) = (start, Clearing::default());
        for _ in 0..steps {
            let next = point(here + stride.draw(random));
            if clearing.holds(next) {
                stride.take();
                here = next;
            } else {
                if self.is_open(here, next) {
                    stride.take();
                    here = next;
                } else {
                    met += 1;
                    here = meet(self, at_walls, here, next, &mut stride, random);
                }
                clearing.move_to(self, here, stride.length());
            }
            points.push(here);
        }
        (points, met)
    }
}
