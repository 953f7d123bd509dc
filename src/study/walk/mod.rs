//! Random traces, each found by its number alone.

mod at_walls;
mod clearings;
mod gaussian;
mod kind;
mod leash;
mod links;
mod paths;
mod persistent;
mod room;
mod start;
mod steps;
mod stride;
mod tether;
mod tethered;
mod uniform;
mod waypoints;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use self::at_walls::AtWalls;
pub use self::gaussian::GaussianWalk;
pub use self::persistent::PersistentWalk;
pub use self::start::Start;
pub use self::tether::{AtTether, Tether};
pub use self::uniform::UniformWalk;
pub use self::waypoints::WaypointDrive;

use self::kind::{Dice, Draw, Drawn, Kind};
use self::room::Room;
use self::start::Starts;
use super::plan_error::PlanError;
use super::random::Purpose;
use crate::geometry::number;
use crate::scene::Model;
use crate::trace::{SettledTrace, Trace, Walked, settle_clear, settle_owned};

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $Plan:ty;)*) => {
        /// How the free end is dragged. No step ever touches a wall.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
        pub enum WalkPlan {
            $($(#[$doc])* $name($Plan),)*
            /// The traces of a file, in the order of their numbers.
            Given {
                /// A .csv or .parquet of points, relative to the study's own folder.
                file: PathBuf,
            },
        }

        impl WalkPlan {
            /// The kind of walk; `None` for given traces.
            fn kind(&self) -> Option<&dyn Kind> {
                match self {
                    $(WalkPlan::$name(plan) => Some(plan),)*
                    WalkPlan::Given { .. } => None,
                }
            }
        }
    };
}

// The kinds of walks that are drawn, each in a file of its own.
kinds! {
    /// A random walk whose steps all have the same length and any direction.
    Uniform: UniformWalk;
    /// A random walk whose steps are normally distributed in x and y.
    Gaussian: GaussianWalk;
    /// A walk that keeps its heading but for noise: the heading turns by a uniform angle in each step.
    Persistent: PersistentWalk;
    /// Drives along shortest collision-free paths from one random goal to the next.
    Waypoints: WaypointDrive;
}

impl WalkPlan {
    /// The file of given traces; `None` for drawn ones.
    pub fn given(&self) -> Option<&Path> {
        match self {
            WalkPlan::Given { file } => Some(file),
            _ => None,
        }
    }

    /// The length of a step, or the standard deviation of one in x and in y; `None` for given traces.
    pub fn step(&self) -> Option<f64> {
        self.kind().map(|kind| kind.basics().step)
    }

    /// What becomes of a step that meets a wall; `None` for traces none of whose steps is drawn so.
    pub fn at_walls(&self) -> Option<AtWalls> {
        self.kind().and_then(|kind| kind.basics().at_walls)
    }

    /// The tether that holds the free end back; `None` without one.
    pub fn tether(&self) -> Option<Tether> {
        self.kind().and_then(|kind| kind.basics().tether())
    }

    /// How many steps each trace has; `None` for given traces.
    pub fn steps(&self) -> Option<u32> {
        self.kind().map(|kind| kind.basics().steps)
    }

    /// Whether its numbers can be walked with.
    pub(super) fn check(&self) -> Result<(), PlanError> {
        self.kind().map_or(Ok(()), |kind| kind.check_all())
    }
}

/// Random traces in a model's scene. Trace n of a seed is the same on every machine, whatever else is drawn.
///
/// No step leaves the scene's bounding box, the smallest that holds all walls and the anchor, and none breaks the rules
/// of ropes: [`SettledTrace::violation`] is `None`. No step of a walk touches a wall; a drive along waypoints passes
/// wall ends. Where a [`Tether`] holds the free end back, the rope after a step is never longer: neither the exact one
/// nor the length of it that results have.
///
/// ```
/// use std::sync::Arc;
/// use tautline::example::BuiltIn;
/// use tautline::scene::Model;
/// use tautline::study::{AtWalls, Start, UniformWalk, WalkPlan, Walks};
///
/// let model = Arc::new(Model::new(BuiltIn::Rooms.scene(1), None)?);
/// let (start, at_walls) = (Start::Anchor, AtWalls::Redraw);
/// let uniform = UniformWalk { step: 0.25, steps: 100, start, at_walls, tether: None, at_tether: None };
/// let walks = Walks::new(model, &WalkPlan::Uniform(uniform), 1)?;
/// let trace = walks.trace(7);
/// assert_eq!((trace.id(), trace.steps(), trace.violation()), (7, 100, None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Walks {
    room: Room,
    drawer: Box<dyn Draw>,
    starts: Starts,
    seed: u64,
}

impl Walks {
    /// Makes ready to draw the traces of `plan`. O(walls); O(walls log walls) where starts are drawn or paths are
    /// searched for.
    ///
    /// # Errors
    ///
    /// A step that is not finite and above 0 or is wider than the scene, steps that are none or more than a trace can
    /// have, a turn outside of 0 to pi, a scene without room, coordinates that cannot be triangulated where that is
    /// needed; and given traces, which are not drawn.
    pub fn new(model: Arc<Model>, plan: &WalkPlan, seed: u64) -> Result<Walks, PlanError> {
        let Some(kind) = plan.kind() else {
            return Err(PlanError::new("walk.kind: given traces are read, not drawn; give another kind to draw some"));
        };
        kind.check_all()?;
        let room = Room::new(model);
        if !(room.high - room.low).cmpgt(glam::DVec2::ZERO).all() {
            return Err(PlanError::new(
                "scene: the box around all walls and the anchor has no area, so there is no room to walk in; add \
                 walls, or move the anchor off the line on which they lie",
            ));
        }
        let size = room.high - room.low;
        let step = kind.basics().step;
        if step > size.max_element() {
            return Err(PlanError::new(format!(
                "walk.step: a step of {} is wider than the scene, which is {} by {}; give a shorter one, in the \
                 scene's unit",
                number(step),
                number(size.x),
                number(size.y)
            )));
        }
        let drawer = kind.drawer(&room)?;
        let starts = Starts::new(&room.model, kind.basics().start, kind.basics().tether)?;
        Ok(Walks { room, drawer, starts, seed })
    }

    /// Trace `number`, ready to be evaluated. O(steps) where walls are far, and what [`Model::is_clear`] costs near
    /// them.
    pub fn trace(&self, number: u64) -> SettledTrace {
        let (model, dice) = (&self.room.model, Dice { seed: self.seed, trace: number });
        let start = self.starts.draw(model, &mut dice.of(Purpose::Start));
        let Drawn { points, met, held_back } = self.drawer.draw(&self.room, start, dice);
        let walk = Trace { id: number, points };
        let settled = match self.drawer.keeps_clear() {
            true => settle_clear(model, walk),
            false => settle_owned(model, walk),
        };
        let still = settled.still();
        settled.with_walked(Walked { still, met, held_back })
    }
}

#[cfg(test)]
mod tests;
