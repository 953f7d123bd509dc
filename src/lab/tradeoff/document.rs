//! What was measured, as a document.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Answer, Failed, LengthError, Point, Report, Setting};
use crate::lab::{Spread, Surroundings};

/// What was measured, as its JSON has it.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document {
    /// Where it was measured.
    pub environment: Surroundings,
    /// The scene.
    pub scene: String,
    /// The number of its vertices.
    pub n: usize,
    /// How many traces there are.
    pub traces: usize,
    /// How many steps they have.
    pub steps: u64,
    /// For how many traces, from the first on, the scalar reference itself vouched for the truth.
    pub vouched_by_reference: usize,
    /// Every method at every setting.
    pub points: Vec<Line>,
    /// What failed.
    pub failed: Vec<Failure>,
}

/// One method at one setting.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Line {
    /// The method.
    pub method: &'static str,
    /// Its engine.
    pub engine: &'static str,
    /// The setting, in words.
    pub setting: String,
    /// Every so many points of a trace were used.
    pub stride: usize,
    /// By how much walls were simplified at most; null for not at all.
    pub simplify: Option<f64>,
    /// The number of vertices of the scene as it was used.
    pub n: usize,
    /// On how many traces it ran.
    pub traces: usize,
    /// How many steps these have, before any are left out.
    pub steps: u64,
    /// The time of each of these, in nanoseconds.
    pub ns_per_step: Spread,
    /// How many longer steps would have jumped a wall, and were walked point by point.
    pub jumps: usize,
    /// How many traces cross a simplified wall.
    pub crossing_traces: usize,
    /// On how many traces the events differ; null for a method that keeps none.
    pub event_mismatch: Option<usize>,
    /// On how many the taut rope at the end does.
    pub final_mismatch: usize,
    /// The error of the length at the end, as a share of it.
    pub length_error: LengthError,
    /// The mean length at the end.
    pub mean_length: Answer,
    /// The mean number of wraps a trace; null for a method that keeps no events.
    pub mean_wraps: Option<Answer>,
    /// Whether no other point is faster and as right.
    pub pareto: bool,
}

/// What could not be measured.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Failure {
    /// The method, or `all`.
    pub method: &'static str,
    /// At which setting, in words; null for all.
    pub setting: Option<String>,
    /// Why.
    pub why: String,
}

impl Document {
    /// The JSON Schema of such documents.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Document).to_value()
    }
}

impl From<&Report> for Document {
    fn from(report: &Report) -> Self {
        let measured = &report.measured;
        Document {
            environment: Surroundings::new(&report.environment, report.seed),
            scene: measured.scene.clone(),
            n: measured.n,
            traces: measured.traces,
            steps: measured.steps,
            vouched_by_reference: measured.vouched,
            points: measured.points.iter().map(Line::from).collect(),
            failed: measured.failed.iter().map(Failure::from).collect(),
        }
    }
}

impl From<&Point> for Line {
    fn from(point: &Point) -> Self {
        Line {
            method: point.method,
            engine: point.engine,
            setting: point.setting.to_string(),
            stride: point.setting.stride(),
            simplify: if let Setting::Simplify(tolerance) = point.setting { Some(tolerance) } else { None },
            n: point.n,
            traces: point.traces,
            steps: point.steps,
            ns_per_step: point.ns_per_step,
            jumps: point.jumps,
            crossing_traces: point.crossing_traces,
            event_mismatch: point.event_mismatch,
            final_mismatch: point.final_mismatch,
            length_error: point.length_error,
            mean_length: point.length,
            mean_wraps: point.wraps,
            pareto: point.pareto,
        }
    }
}

impl From<&Failed> for Failure {
    fn from(failed: &Failed) -> Self {
        let setting = failed.setting.map(|setting| setting.to_string());
        Failure { method: failed.method, setting, why: failed.why.clone() }
    }
}
