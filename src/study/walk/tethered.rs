//! Walks that a tether holds back.

use super::at_walls::{AtWalls, TRIES, meet};
use super::kind::{Basics, Dice, Draw, Drawn};
use super::leash::Leash;
use super::room::Room;
use super::start::From;
use super::stride::Stride;
use super::tether::{AtTether, Tether};
use crate::candidates::Lists;
use crate::geometry::point;
use crate::study::random::{Purpose, Random};
use crate::trace::HeldBack;

/// Draws walks whose steps are drawn one after the other and end where the rope is no longer than a tether.
pub(super) struct Tethered<F> {
    basics: Basics,
    at_walls: AtWalls,
    tether: Tether,
    /// What each pivot sees.
    lists: Lists,
    /// Makes what draws the steps of a trace.
    stride: F,
}

impl<S: Stride, F: Fn(&mut Random) -> S + Send + Sync> Tethered<F> {
    /// For walks in a room.
    pub(super) fn new(room: &Room, basics: Basics, tether: Tether, stride: F) -> Self {
        let lists = Lists::new(room.model.clone()).after(0);
        Tethered { at_walls: basics.at_walls.unwrap_or_default(), basics, tether, lists, stride }
    }
}

impl<S: Stride, F: Fn(&mut Random) -> S + Send + Sync> Draw for Tethered<F> {
    fn draw(&self, room: &Room, start: From, dice: Dice) -> Drawn {
        let mut random = dice.of(Purpose::Walk);
        let mut stride = (self.stride)(&mut random);
        let mut points = Vec::with_capacity(self.basics.steps as usize + 2);
        let mut leash = Leash::new(&self.lists, self.tether.length, start.at(&room.model));
        points.push(leash.here());
        let (mut met, mut held_back) = (0, HeldBack::default());
        for step in 1..=self.basics.steps as usize {
            let here = leash.here();
            let drawn = point(here + stride.draw(&mut random));
            let is_open = room.is_open(here, drawn);
            // What the walls make of the step, and then the tether of that.
            let next = match is_open {
                true => drawn,
                false => {
                    met += 1;
                    meet(room, self.at_walls, here, drawn, &mut stride, &mut random)
                }
            };
            let is_held_back = !leash.goes(next);
            if is_open && (!is_held_back || self.tether.at == AtTether::Slide) {
                stride.take();
            }
            if is_held_back {
                held_back.note(step);
                match self.tether.at {
                    AtTether::Stay => {
                        // The heading turns, whatever it does otherwise, so that the free end gets away in time.
                        stride.draw_again(&mut random);
                        stride.take();
                    }
                    AtTether::Turn => {
                        for _ in 0..TRIES {
                            let next = point(here + stride.draw_again(&mut random));
                            if room.is_open(here, next) && leash.goes(next) {
                                stride.take();
                                break;
                            }
                        }
                    }
                    AtTether::Slide => leash.slide(room, next),
                }
            }
            points.push(leash.here());
        }
        Drawn { points, met, held_back: Some(held_back) }
    }
}

#[cfg(test)]
mod tests;
