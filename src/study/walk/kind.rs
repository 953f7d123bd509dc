//! What there is to know of a kind of walk.

use glam::DVec2;

use super::at_walls::AtWalls;
use super::room::Room;
use super::start::{From, Start};
use super::tether::{AtTether, Tether};
use crate::geometry::{COORDINATE_MAX, COORDINATE_MIN, check_point, number};
use crate::study::plan_error::PlanError;
use crate::study::random::{Purpose, Random};
use crate::trace::HeldBack;

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
    /// How long its tether is, if it has one.
    pub(super) tether: Option<f64>,
    /// What becomes of a step that the tether holds back.
    pub(super) at_tether: Option<AtTether>,
}

impl Basics {
    /// Those of a walk without a tether.
    pub(super) fn free(step: f64, steps: u32, start: Start, at_walls: Option<AtWalls>) -> Self {
        Basics { step, steps, start, at_walls, tether: None, at_tether: None }
    }

    /// The tether, if it has one.
    pub(super) fn tether(&self) -> Option<Tether> {
        self.tether.map(|length| Tether { length, at: self.at_tether.unwrap_or_default() })
    }
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
        let Basics { step, steps, tether, at_tether, .. } = self.basics();
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
        match (tether, at_tether) {
            (Some(length), _) if !(length > 0.0 && check_point(DVec2::new(length, 0.0)).is_ok()) => {
                return Err(PlanError::new(format!(
                    "walk.tether: {} is no length of a tether; give a number above 0 (from {COORDINATE_MIN:.2e} to \
                     {COORDINATE_MAX:.2e}), in the scene's unit, or leave it out",
                    number(length)
                )));
            }
            (None, Some(_)) => {
                return Err(PlanError::new(
                    "walk.at_tether: there is no tether; give its length as walk.tether, or leave this out",
                ));
            }
            _ => {}
        }
        self.check()
    }
}

/// A trace as it was drawn.
pub(crate) struct Drawn {
    /// Its points, in memory with room for one more.
    pub(super) points: Vec<DVec2>,
    /// How many of its steps met a wall or the border as they were drawn first.
    pub(super) met: usize,
    /// Which the tether held back, if there is one.
    pub(super) held_back: Option<HeldBack>,
}

/// What draws the traces of one plan.
pub(crate) trait Draw: Send + Sync {
    /// A trace that starts there.
    fn draw(&self, room: &Room, start: From, dice: Dice) -> Drawn;

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
