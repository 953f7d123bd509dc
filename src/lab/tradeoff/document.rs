//! What was measured, as a document.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Failed, Point, Report};
use crate::lab::Surroundings;

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
    pub points: Vec<Point>,
    /// What failed.
    pub failed: Vec<Failure>,
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
            points: measured.points.clone(),
            failed: measured.failed.iter().map(Failure::from).collect(),
        }
    }
}

impl From<&Failed> for Failure {
    fn from(failed: &Failed) -> Self {
        let setting = failed.setting.map(|setting| setting.to_string());
        Failure { method: failed.method, setting, why: failed.why.clone() }
    }
}
