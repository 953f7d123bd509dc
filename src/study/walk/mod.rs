//! Random traces, each found by its number alone.

mod at_walls;
mod gaussian;
mod links;
mod paths;
mod persistent;
mod room;
mod start;
mod stride;
mod uniform;
mod waypoints;

use std::sync::Arc;

pub(in crate::study) use self::room::point;

use self::gaussian::Gaussian;
use self::persistent::Persistent;
use self::room::Room;
use self::start::Starts;
use self::uniform::Uniform;
use self::waypoints::Waypoints;
use super::random::{Purpose, Random};
use super::{AtWalls, PlanError, WalkPlan};
use crate::geometry::number;
use crate::scene::Model;
use crate::trace::{SettledTrace, Trace, Walked, settle_clear, settle_owned};

/// Random traces in a model's scene. Trace n of a seed is the same on every machine, whatever else is drawn.
///
/// No step leaves the scene's bounding box, the smallest that holds all walls and the anchor, and none breaks the rules of
/// ropes: [`SettledTrace::violation`] is `None`. No step of a walk touches a wall; a drive along waypoints passes wall ends.
///
/// ```
/// use std::sync::Arc;
/// use tautline::example::BuiltIn;
/// use tautline::scene::Model;
/// use tautline::study::{AtWalls, Start, WalkPlan, Walks};
///
/// let model = Arc::new(Model::new(BuiltIn::Rooms.scene(1), None)?);
/// let plan = WalkPlan::Uniform { step: 0.25, steps: 100, start: Start::Anchor, at_walls: AtWalls::Redraw };
/// let walks = Walks::new(model, &plan, 1)?;
/// let trace = walks.trace(7);
/// assert_eq!((trace.id(), trace.steps(), trace.violation()), (7, 100, None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Walks {
    room: Room,
    kind: Kind,
    starts: Starts,
    steps: u32,
    seed: u64,
}

/// What steps are like.
enum Kind {
    Uniform { step: f64, at_walls: AtWalls },
    Gaussian { step: f64, at_walls: AtWalls },
    Persistent { step: f64, turn: f64, at_walls: AtWalls },
    Waypoints(Box<Waypoints>),
}

impl Walks {
    /// Makes ready to draw the traces of `plan`. O(walls); O(walls log walls) where starts are drawn or paths are searched
    /// for.
    ///
    /// # Errors
    ///
    /// A step that is not finite and above 0 or is wider than the scene, steps that are none or more than a trace can have, a turn outside of 0 to pi, a
    /// scene without room, coordinates that cannot be triangulated where that is needed; and given traces, which are not
    /// drawn.
    pub fn new(model: Arc<Model>, plan: &WalkPlan, seed: u64) -> Result<Walks, PlanError> {
        plan.check()?;
        let (steps, start) = match *plan {
            WalkPlan::Uniform { steps, start, .. }
            | WalkPlan::Gaussian { steps, start, .. }
            | WalkPlan::Persistent { steps, start, .. }
            | WalkPlan::Waypoints { steps, start, .. } => (steps, start),
            WalkPlan::Given { .. } => {
                return Err(PlanError::new(
                    "walk.kind: given traces are read, not drawn; give another kind to draw some",
                ));
            }
        };
        let room = Room::new(model);
        if !(room.high - room.low).cmpgt(glam::DVec2::ZERO).all() {
            return Err(PlanError::new(
                "scene: the box around all walls and the anchor has no area, so there is no room to walk in; add walls, or \
                 move the anchor off the line on which they lie",
            ));
        }
        let size = room.high - room.low;
        if let Some(step) = plan.step().filter(|&step| step > size.max_element()) {
            return Err(PlanError::new(format!(
                "walk.step: a step of {} is wider than the scene, which is {} by {}; give a shorter one, in the scene's unit",
                number(step),
                number(size.x),
                number(size.y)
            )));
        }
        let kind = match *plan {
            WalkPlan::Uniform { step, at_walls, .. } => Kind::Uniform { step, at_walls },
            WalkPlan::Gaussian { step, at_walls, .. } => Kind::Gaussian { step, at_walls },
            WalkPlan::Persistent { step, turn, at_walls, .. } => Kind::Persistent { step, turn, at_walls },
            WalkPlan::Waypoints { step, .. } => Kind::Waypoints(Box::new(Waypoints::new(&room.model, step)?)),
            WalkPlan::Given { .. } => unreachable!("given traces were refused above"),
        };
        let starts = Starts::new(&room.model, start)?;
        Ok(Walks { room, kind, starts, steps, seed })
    }

    /// Trace `number`, ready to be evaluated. O(steps) where walls are far, and what [`Model::is_clear`] costs near them.
    pub fn trace(&self, number: u64) -> SettledTrace {
        let (walk, met) = self.walk(number);
        let settled = match self.kind {
            Kind::Waypoints(_) => settle_owned(&self.room.model, walk),
            _ => settle_clear(&self.room.model, walk),
        };
        let still = settled.still();
        settled.with_walked(Walked { still, met })
    }

    /// The same, as it is drawn, and how many of its steps met a wall or the border as they were drawn first.
    fn walk(&self, number: u64) -> (Trace, usize) {
        let model = &self.room.model;
        let start = self.starts.draw(model, &mut Random::new(self.seed, Purpose::Start, number));
        let mut random = Random::new(self.seed, Purpose::Walk, number);
        let (points, met) = match self.kind {
            Kind::Uniform { step, at_walls } => {
                self.room.walk(at_walls, start.at(model), self.steps, Uniform { step }, &mut random)
            }
            Kind::Gaussian { step, at_walls } => {
                self.room.walk(at_walls, start.at(model), self.steps, Gaussian { step }, &mut random)
            }
            Kind::Persistent { step, turn, at_walls } => {
                let stride = Persistent::new(step, turn, &mut random);
                self.room.walk(at_walls, start.at(model), self.steps, stride, &mut random)
            }
            Kind::Waypoints(ref waypoints) => {
                let mut goals = Random::new(self.seed, Purpose::Goal, number);
                (waypoints.drive(model, start, self.steps, &mut goals), 0)
            }
        };
        (Trace { id: number, points }, met)
    }
}

#[cfg(test)]
mod tests;
