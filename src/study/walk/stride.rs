//! One step after the other, whatever they are like.

use glam::DVec2;

use super::at_walls;
use super::room::{Clearing, Room, point};
use crate::study::AtWalls;
use crate::study::random::Random;

/// How the steps of one kind of walk are drawn.
pub(super) trait Stride {
    /// How long steps are, about.
    fn length(&self) -> f64;

    /// The next step.
    fn draw(&mut self, random: &mut Random) -> DVec2;

    /// The next step, drawn again because the one drawn last could not be taken.
    fn draw_again(&mut self, random: &mut Random) -> DVec2 {
        self.draw(random)
    }

    /// The step drawn last was taken, or its heading is to be kept though it was not.
    #[inline]
    fn take(&mut self) {}

    /// The step drawn last goes on mirrored at a line; `across` is one long and at right angles to it.
    fn mirror(&mut self, _across: DVec2) {}
}

impl Room {
    /// The points of a walk of `steps` steps from `start`, in memory with room for one more, and how many of the steps met a
    /// wall or the border as they were drawn first.
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
                    here = at_walls::meet(self, at_walls, here, next, &mut stride, random);
                }
                clearing.move_to(self, here, stride.length());
            }
            points.push(here);
        }
        (points, met)
    }
}
