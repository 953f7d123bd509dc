//! One method at one setting.

use schemars::JsonSchema;
use serde::Serialize;

use super::setting::Setting;
use super::truth::Answer;
use crate::lab::Spread;

/// One method at one setting: what it costs and what it gets wrong. A [`Document`](super::Document) has it so.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Point {
    /// The method's name.
    pub method: &'static str,
    /// The engine's, as the command line knows it.
    pub engine: &'static str,
    /// What was traded besides.
    #[serde(flatten)]
    pub setting: Setting,
    /// The number of vertices of the scene as it was used.
    pub n: usize,
    /// On how many traces it ran: all, or the first.
    pub traces: usize,
    /// How many steps these have, before any are left out.
    pub steps: u64,
    /// The time of each of these steps, in nanoseconds, over the repeats: of the engine alone.
    pub ns_per_step: Spread,
    /// How many of the coarser steps would have jumped a wall, and were walked point by point.
    pub jumps: usize,
    /// How many of the traces cross a simplified wall.
    pub crossing_traces: usize,
    /// On how many traces the list of events differs; `None` for a method that keeps none.
    pub event_mismatch: Option<usize>,
    /// On how many the taut rope at the end does.
    pub final_mismatch: usize,
    /// The error of the length at the end as a share of it, over the traces.
    pub length_error: LengthError,
    /// The mean length at the end.
    #[serde(rename = "mean_length")]
    pub length: Answer,
    /// The mean number of wraps a trace; `None` for a method that keeps no events.
    #[serde(rename = "mean_wraps")]
    pub wraps: Option<Answer>,
    /// Whether no other point is faster and as right, or as fast and more right: by the median time, the shares of
    /// traces whose events and whose rope at the end differ, and the mean error of the length. A method that keeps no
    /// events has none right.
    pub pareto: bool,
}

impl Point {
    /// The share of the traces of which that many are.
    pub fn share(&self, traces: usize) -> f64 {
        traces as f64 / self.traces as f64
    }
}

/// The error of a length, as a share of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LengthError {
    /// Over the traces.
    pub mean: f64,
    /// Of the worst.
    pub max: f64,
}
