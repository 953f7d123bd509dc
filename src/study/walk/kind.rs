//! What there is to know of a kind of walk.

use glam::DVec2;

use super::at_walls::AtWalls;
use super::room::Room;
use super::start::{From, Start};
use crate::geometry::{check_point, number};
use crate::study::plan_error::PlanError;
use crate::study::random::{Purpose, Random};

/// The most steps of a trace: its points are numbered in 31 bits.
const MOST_STEPS: u32 = (1 << 31) - 2;

/// What plans of all kinds of walks have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Basics {
    /// The length of a step, or the standard deviation of one in x and in y.
    pub(super) step: f64,
    /// How many steps a trace has.
    pub(super) steps: u32,
    /// Where traces start.
    pub(super) start: Start,
    /// What becomes of a step that meets a wall; `None` for a walk none of whose steps is drawn so.
    pub(super) at_walls: Option<AtWalls>,
}

/// A kind of walk, as a plan has it.
pub(crate) trait Kind {
    /// What its plan has in common with those of other kinds.
    fn basics(&self) -> Basics;

    /// Whether the numbers that only this kind has can be walked with.
    fn check(&self) -> Result<(), PlanError> {
        Ok(())
    }

    /// What draws its traces in a room.
    ///
    /// # Errors
    ///
    /// A scene in which they cannot be drawn.
    fn drawer(&self, room: &Room) -> Result<Box<dyn Draw>, PlanError>;
}

impl dyn Kind + '_ {
    /// Whether its numbers can be walked with.
    pub(super) fn check_all(&self) -> Result<(), PlanError> {
        let Basics { step, steps, .. } = self.basics();
        if !(step > 0.0 && check_point(DVec2::new(step, 0.0)).is_ok()) {
            return Err(PlanError::new(format!(
                "walk.step: {} is no length of a step; give a number above 0, in the scene's unit",
                number(step)
            )));
        }
        if !(1..=MOST_STEPS).contains(&steps) {
            return Err(PlanError::new(format!(
                "walk.steps: a trace cannot have {steps} steps; give a whole number from 1 to {MOST_STEPS}"
            )));
        }
        self.check()
    }
}

/// What draws the traces of one plan.
pub(crate) trait Draw: Send + Sync {
    /// The points of a trace that starts there, in memory with room for one more, and how many of its steps met a wall
    /// or the border as they were drawn first.
    fn draw(&self, room: &Room, start: From, dice: Dice) -> (Vec<DVec2>, usize);

    /// Whether steps keep clear of the walls: they may touch none, not even as they pass its end.
    fn keeps_clear(&self) -> bool {
        true
    }
}

/// The random numbers of one trace.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dice {
    pub(super) seed: u64,
    pub(super) trace: u64,
}

impl Dice {
    /// Those for one purpose.
    pub(super) fn of(self, purpose: Purpose) -> Random {
        Random::new(self.seed, purpose, self.trace)
    }
}
