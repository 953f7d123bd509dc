//! Steps that are normally distributed in x and y.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::at_walls::AtWalls;
use super::kind::{Basics, Draw, Kind};
use super::room::Room;
use super::start::Start;
use super::steps::StepByStep;
use super::stride::Stride;
use super::tether::AtTether;
use crate::study::plan_error::PlanError;
use crate::study::random::Random;

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
    /// How long the tether is that holds the walk back: its rope is never longer. None without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tether: Option<f64>,
    /// What becomes of a step at whose end the rope would be longer than the tether; `stay` without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_tether: Option<AtTether>,
}

impl Kind for GaussianWalk {
    fn basics(&self) -> Basics {
        Basics {
            step: self.step,
            steps: self.steps,
            start: self.start,
            at_walls: Some(self.at_walls),
            tether: self.tether,
            at_tether: self.at_tether,
        }
    }

    fn drawer(&self, room: &Room) -> Result<Box<dyn Draw>, PlanError> {
        let step = self.step;
        Ok(StepByStep::boxed(room, self.basics(), move |_| Gaussian { step }))
    }
}

struct Gaussian {
    /// The standard deviation in x and in y.
    step: f64,
}

impl Stride for Gaussian {
    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        self.step * random.normal()
    }
}
