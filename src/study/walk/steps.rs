//! One step after the other, whatever they are like.

use super::at_walls::{AtWalls, meet};
use super::clearings::{Clearing, Clearings};
use super::kind::{Basics, Dice, Draw, Drawn};
use super::room::Room;
use super::start::From;
use super::stride::Stride;
use super::tethered::Tethered;
use crate::geometry::point;
use crate::study::random::{Purpose, Random};

/// Draws walks whose steps are drawn one after the other.
pub(super) struct StepByStep<F> {
    basics: Basics,
    at_walls: AtWalls,
    clearings: Clearings,
    /// Makes what draws the steps of a trace.
    stride: F,
}

impl<S: Stride, F: Fn(&mut Random) -> S + Send + Sync + 'static> StepByStep<F> {
    /// For walks in a room; those of another kind where a tether holds them back.
    pub(super) fn boxed(room: &Room, basics: Basics, stride: F) -> Box<dyn Draw> {
        if let Some(tether) = basics.tether() {
            return Box::new(Tethered::new(room, basics, tether, stride));
        }
        let at_walls = basics.at_walls.unwrap_or_default();
        Box::new(StepByStep { clearings: Clearings::new(room, basics.step), basics, at_walls, stride })
    }
}

impl<S: Stride, F: Fn(&mut Random) -> S + Send + Sync> Draw for StepByStep<F> {
    fn draw(&self, room: &Room, start: From, dice: Dice) -> Drawn {
        let mut random = dice.of(Purpose::Walk);
        let mut stride = (self.stride)(&mut random);
        let mut points = Vec::with_capacity(self.basics.steps as usize + 2);
        let mut here = start.at(&room.model);
        points.push(here);
        let (mut met, mut clearing) = (0, Clearing::NONE);
        for _ in 0..self.basics.steps {
            let next = point(here + stride.draw(&mut random));
            if clearing.holds(next) {
                stride.take();
                here = next;
            } else {
                // It may hold this step as well.
                let ahead = self.clearings.around(next);
                if (ahead.holds(here) && ahead.holds(next)) || room.is_open(here, next) {
                    stride.take();
                    (here, clearing) = (next, ahead);
                } else {
                    met += 1;
                    here = meet(room, self.at_walls, here, next, &mut stride, &mut random);
                    clearing = self.clearings.around(here);
                }
                // A step starts where the one before ended: only a clearing that holds that is of use.
                if !clearing.holds(here) {
                    clearing = Clearing::NONE;
                }
            }
            points.push(here);
        }
        Drawn { points, met, held_back: None }
    }
}
