//! Steps of one length whose heading turns by a uniform angle in each.

use std::f64::consts::PI;

use glam::DVec2;
use pulp::{Arch, Simd, WithSimd};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::at_walls::AtWalls;
use super::kind::{Basics, Draw, Kind};
use super::room::Room;
use super::start::Start;
use super::steps::StepByStep;
use super::stride::Stride;
use super::tether::AtTether;
use crate::geometry::number;
use crate::study::plan_error::PlanError;
use crate::study::random::Random;

/// The least by which the heading may turn, in radians, once a step was drawn in vain: one that never turns would stand
/// before a wall for good.
pub(super) const LEAST: f64 = 0.1;

/// How many turns are drawn at once, so that several are made in one instruction. What a step that meets a wall draws
/// depends on it, and so do all traces.
pub(super) const AHEAD: usize = 16;

/// By what the turn widens with each step drawn in vain.
pub(super) const WIDENS: f64 = 1.5;

/// A walk that keeps its heading but for noise: the heading turns by a uniform angle in each step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PersistentWalk {
    /// The length of a step.
    pub step: f64,
    /// How many steps a trace has.
    pub steps: u32,
    /// By how much the heading turns at most in one step, in radians.
    #[serde(default = "default_turn")]
    pub turn: f64,
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

fn default_turn() -> f64 {
    0.4
}

impl Kind for PersistentWalk {
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

    fn check(&self) -> Result<(), PlanError> {
        if (0.0..=PI).contains(&self.turn) {
            return Ok(());
        }
        Err(PlanError::new(format!(
            "walk.turn: a heading cannot turn by {}; give radians, from 0 to pi ({PI})",
            number(self.turn)
        )))
    }

    fn drawer(&self, room: &Room) -> Result<Box<dyn Draw>, PlanError> {
        let (step, turn) = (self.step, self.turn);
        Ok(StepByStep::boxed(room, self.basics(), move |random| Persistent::new(step, turn, random)))
    }
}

struct Persistent {
    step: f64,
    /// By how much the heading turns at most, in radians.
    turn: f64,
    /// One long, but for roundings.
    heading: DVec2,
    /// The square of the length that the heading had before the last step.
    before: f64,
    /// The heading of the step drawn last.
    turned: DVec2,
    /// By how much that one could turn.
    spread: f64,
    /// Turns drawn ahead, as the coordinates of vectors one long, and the first that was not taken yet.
    turns: [[f64; AHEAD]; 2],
    next: usize,
}

impl Persistent {
    fn new(step: f64, turn: f64, random: &mut Random) -> Self {
        let heading = random.direction();
        Persistent {
            step,
            turn,
            heading,
            before: 1.0,
            turned: heading,
            spread: turn,
            turns: [[0.0; AHEAD]; 2],
            next: AHEAD,
        }
    }

    /// The step along the heading turned by `turn`, a vector one long.
    #[inline]
    fn along(&mut self, turn: DVec2) -> DVec2 {
        // Half a step of Newton's method for the length of 1, so that roundings do not add up; by the length that the
        // heading had before, since that of the heading itself would have to be waited for.
        self.turned = turn.rotate(self.heading) * (1.25 - 0.25 * self.before);
        self.step * self.turned
    }

    /// Draws the next turns.
    #[inline(never)]
    fn refill(&mut self, random: &mut Random) {
        let angles: [f64; AHEAD] = std::array::from_fn(|_| self.turn * random.either_way());
        // With the widest vectors that the processor has.
        self.turns = Arch::new().dispatch(Directions(angles));
        self.next = 0;
    }
}

/// The directions at these angles. Not a closure, which would be compiled for the narrowest vectors.
struct Directions([f64; AHEAD]);

impl WithSimd for Directions {
    type Output = [[f64; AHEAD]; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [[f64; AHEAD]; 2] {
        let [mut cos, mut sin] = [[0.0; AHEAD]; 2];
        for i in 0..AHEAD {
            DVec2 { x: cos[i], y: sin[i] } = direction(self.0[i]);
        }
        [cos, sin]
    }
}

/// The direction at that angle, from -pi to pi, to ten digits or so, as a vector one long: the angle itself is as
/// coarse. Made of products and sums alone, in a fixed order, so it is the same on every machine; the standard
/// library's sines are not.
#[inline(always)]
fn direction(angle: f64) -> DVec2 {
    let x = 0.25 * angle;
    let s = x * x;
    // The Taylor series of the cosine and the sine of a quarter of the angle; their next terms are below 2e-9.
    let cos =
        1.0 + s * (-1.0 / 2.0 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40320.0 + s * (-1.0 / 3628800.0)))));
    let sin = x + x * s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * (1.0 / 362880.0))));
    // Twice the angle of a vector is that of its square as a complex number.
    let (cos, sin) = (cos * cos - sin * sin, 2.0 * cos * sin);
    let (cos, sin) = (cos * cos - sin * sin, 2.0 * cos * sin);
    let one = 1.5 - 0.5 * (cos * cos + sin * sin);
    DVec2::new(cos * one, sin * one)
}

impl Stride for Persistent {
    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        if self.next == AHEAD {
            self.refill(random);
        }
        self.spread = self.turn;
        let turn = DVec2::new(self.turns[0][self.next], self.turns[1][self.next]);
        self.next += 1;
        self.along(turn)
    }

    fn draw_again(&mut self, random: &mut Random) -> DVec2 {
        self.spread = (self.spread.max(LEAST) * WIDENS).min(PI);
        self.along(direction(self.spread * random.either_way()))
    }

    #[inline]
    fn take(&mut self) {
        self.before = self.heading.length_squared();
        self.heading = self.turned;
    }

    fn mirror(&mut self, across: DVec2) {
        self.turned -= 2.0 * self.turned.dot(across) * across;
    }
}
