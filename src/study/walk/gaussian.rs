//! Steps that are normally distributed in x and y.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::at_walls::AtWalls;
use super::kind::{Dice, Draw, Kind};
use super::room::Room;
use super::start::{From, Start};
use super::stride::Stride;
use crate::study::plan_error::PlanError;
use crate::study::random::{Purpose, Random};

/// A random walk whose steps are normally distributed in x and y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GaussianWalk {
    /// The standard deviation of a step in x and in y.
    pub step: f64,
    /// How many steps a trace has.
    pub steps: u32,
    /// Where traces start.
    #[serde(default)]
    pub start: Start,
    /// What becomes of a step that meets a wall.
    #[serde(default)]
    pub at_walls: AtWalls,
}

impl Kind for GaussianWalk {
    fn step(&self) -> f64 {
        self.step
    }

    fn steps(&self) -> u32 {
        self.steps
    }

    fn start(&self) -> Start {
        self.start
    }

    fn at_walls(&self) -> Option<AtWalls> {
        Some(self.at_walls)
    }

    fn drawer(&self, _: &Room) -> Result<Box<dyn Draw>, PlanError> {
        Ok(Box::new(self.clone()))
    }
}

impl Draw for GaussianWalk {
    fn draw(&self, room: &Room, start: From, dice: Dice) -> (Vec<DVec2>, usize) {
        let mut random = dice.of(Purpose::Walk);
        let stride = Gaussian { step: self.step };
        room.walk(self.at_walls, start.at(&room.model), self.steps, stride, &mut random)
    }
}

struct Gaussian {
    /// The standard deviation in x and in y.
    step: f64,
}

impl Stride for Gaussian {
    fn length(&self) -> f64 {
        self.step
    }

    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        self.step * random.normal()
    }
}
