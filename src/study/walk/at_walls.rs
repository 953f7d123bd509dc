//! What becomes of a step that meets a wall or leaves the scene's bounding box.

use std::ops::ControlFlow::Continue;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::room::Room;
use super::stride::Stride;
use crate::geometry::{higher, lower, opposite, orient, point, same_side};
use crate::study::random::Random;

/// What becomes of a step that meets a wall or leaves the scene's bounding box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AtWalls {
    /// It is drawn again.
    #[default]
    Redraw,
    /// The free end stays where it is for that step.
    Reject,
    /// It is thrown back by the wall as light by a mirror.
    Reflect,
}

/// How often a step is drawn again before the free end stays where it is.
pub(super) const TRIES: u32 = 32;

/// How often a step is thrown back, as in a corner, before the free end stays where it is.
pub(super) const MIRRORS: u32 = 8;

/// Where the free end is after a step from `here` that could not be taken to `next`, as it was drawn.
#[cold]
pub(super) fn meet(
    room: &Room,
    at_walls: AtWalls,
    here: DVec2,
    next: DVec2,
    stride: &mut impl Stride,
    random: &mut Random,
) -> DVec2 {
    match at_walls {
        AtWalls::Redraw => {
            for _ in 0..TRIES {
                let next = point(here + stride.draw_again(random));
                if room.is_open(here, next) {
                    stride.take();
                    return next;
                }
            }
            here
        }
        AtWalls::Reject => {
            // The heading turns, whatever it does otherwise, so that the free end gets away in time.
            stride.draw_again(random);
            stride.take();
            here
        }
        AtWalls::Reflect => {
            let thrown = reflect(room, here, next, stride);
            stride.take();
            thrown.unwrap_or(here)
        }
    }
}

/// Where a step from `here` to `next` ends that is thrown back by whatever it meets. `None` if no straight way leads
/// there: one could go the whole way back as well, so staying leaves a walk on the plane as uniform as it is.
fn reflect(room: &Room, here: DVec2, next: DVec2, stride: &mut impl Stride) -> Option<DVec2> {
    let (mut from, mut to, mut last) = (here, next, None);
    for _ in 0..MIRRORS {
        let Some(met) = first_met(room, from, to, last) else {
            let to = point(to);
            return room.is_open(here, to).then_some(to);
        };
        stride.mirror(met.across);
        // The way there is rounded: what counts is that the step as a whole is open.
        from = from.lerp(to, met.share);
        to -= 2.0 * (to - from).dot(met.across) * met.across;
        last = Some(met.mirror);
    }
    None
}

/// What throws a step back.
struct Met {
    /// After which share of the step.
    share: f64,
    /// At right angles to it, one long.
    across: DVec2,
    mirror: Mirror,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mirror {
    Wall(u32),
    /// The box's sides along x and along y.
    Lowest(usize),
    Highest(usize),
}

/// The first wall or side of the box that the way from `from` to `to` meets, but for the `last` met, at which it
/// starts.
fn first_met(room: &Room, from: DVec2, to: DVec2, last: Option<Mirror>) -> Option<Met> {
    let mut first: Option<Met> = None;
    let mut keep = |met: Met| {
        if Some(met.mirror) != last && first.as_ref().is_none_or(|first| met.share < first.share) {
            first = Some(met);
        }
    };
    for axis in [0, 1] {
        let share = |side: f64| ((side - from[axis]) / (to[axis] - from[axis])).clamp(0.0, 1.0);
        let across = if axis == 0 { DVec2::X } else { DVec2::Y };
        if to[axis] < room.low[axis] {
            keep(Met { share: share(room.low[axis]), across, mirror: Mirror::Lowest(axis) });
        }
        if to[axis] > room.high[axis] {
            keep(Met { share: share(room.high[axis]), across, mirror: Mirror::Highest(axis) });
        }
    }
    let _ = room.model.index().visit::<()>(lower(from, to), higher(from, to), |wall, [u, v]| {
        let (before, after) = (orient(u, v, from), orient(u, v, to));
        // A step along a wall, or one from its end, is not thrown back by it.
        if before != 0.0 && !same_side(before, after) && !same_side(orient(from, to, u), orient(from, to, v)) {
            // The areas are used as sizes, since only the point's place depends on them.
            let share = if opposite(before, after) { before / (before - after) } else { 1.0 };
            if let Some(across) = (v - u).perp().try_normalize() {
                keep(Met { share, across, mirror: Mirror::Wall(wall) });
            }
        }
        Continue(())
    });
    first
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::{Model, Scene};

    /// Notes how steps are mirrored.
    #[derive(Default)]
    struct Heading(DVec2);

    impl Stride for Heading {
        fn draw(&mut self, _: &mut Random) -> DVec2 {
            self.0
        }

        fn mirror(&mut self, across: DVec2) {
            self.0 -= 2.0 * self.0.dot(across) * across;
        }
    }

    /// Where a step ends, and what became of its heading.
    fn thrown(room: &Room, from: [f64; 2], to: [f64; 2]) -> (Option<[f64; 2]>, [f64; 2]) {
        let (from, to) = (DVec2::from(from), DVec2::from(to));
        let mut heading = Heading(to - from);
        let end = reflect(room, from, to, &mut heading);
        (end.map(|p| p.to_array()), heading.0.to_array())
    }

    #[test]
    fn steps_are_thrown_back_by_walls_and_by_the_box() {
        // A wall across the middle of the box, another below it that leaves a passage, and a slanted one.
        let walls = [
            [[-4.0, 0.0], [4.0, 0.0]],
            [[0.0, -1.0], [0.0, -3.0]],
            [[1.0, 1.0], [3.0, 3.0]],
            [[-4.0, -4.0], [-4.0, 4.0]],
        ];
        let scene = Scene::new(walls.map(|wall| wall.map(DVec2::from))).unwrap();
        let room = Room::new(Arc::new(Model::new(scene, Some([-1.0, 1.0].into())).unwrap()));
        assert_eq!((room.low, room.high), (DVec2::splat(-4.0), DVec2::splat(4.0)));
        // By one wall, by a slanted one, by the box, and by both in its corner.
        assert_eq!(thrown(&room, [-2.0, 0.5], [-1.0, -0.5]), (Some([-1.0, 0.5]), [1.0, 1.0]));
        let (end, heading) = thrown(&room, [2.5, 1.5], [1.5, 2.0]);
        let near = |p: [f64; 2], q: [f64; 2]| DVec2::from(p).distance(q.into()) < 1e-12;
        assert!(near(end.unwrap(), [2.0, 1.5]) && near(heading, [0.5, -1.0]), "{end:?} {heading:?}");
        assert_eq!(thrown(&room, [3.5, 0.25], [4.5, 0.75]), (Some([3.5, 0.75]), [-1.0, 0.5]));
        assert_eq!(thrown(&room, [3.5, 0.25], [4.5, -0.5]), (Some([3.5, 0.5]), [-1.0, 0.75]));
        // Below the wall, then by the other: the way back is open, the straight one is as well.
        assert_eq!(thrown(&room, [-1.0, -0.5], [1.0, 1.0]), (Some([1.0, -1.0]), [2.0, -1.5]));
        // The straight way to where it would end leads through a wall.
        assert_eq!(thrown(&room, [-0.5, -1.5], [0.75, 1.5]).0, None);
    }
}
