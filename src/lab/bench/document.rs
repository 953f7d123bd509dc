//! A bench as a document.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::contender::Contender;
use super::measure::{Relative, Row, Skipped};
use super::report::Report;
use crate::engine::Phase;
use crate::lab::{Spread, Surroundings};

/// A bench as its JSON has it.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document {
    /// Where it was measured.
    pub environment: Surroundings,
    /// What every contender came to on every setting.
    pub results: Vec<Line>,
    /// Those that could not be measured.
    pub skipped: Vec<Skipped>,
}

/// What one contender came to on one setting.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Line {
    /// The engine.
    pub engine: &'static str,
    /// How it is used.
    pub variant: &'static str,
    /// `certified`, `fast` or `f64`.
    pub precision: &'static str,
    /// The scene.
    pub scene: String,
    /// The number of its vertices.
    pub n: usize,
    /// How many of them the engine tries; null for engines that do not ask.
    pub remaining: Option<usize>,
    /// The length of a step, about.
    pub step: f64,
    /// On how many traces it ran.
    pub traces: usize,
    /// How many traces there are.
    pub batch: u64,
    /// How many steps of each it ran.
    pub steps: usize,
    /// The most steps that one query covers; null where that changes nothing.
    pub window: Option<usize>,
    /// On how many threads.
    pub threads: usize,
    /// The time a step of a trace, in nanoseconds.
    pub ns_per_step: Spread,
    /// Steps a second, by the median.
    pub steps_per_second: f64,
    /// How many vertices were tried a step.
    pub tests_per_step: f64,
    /// How many tests fewer that is than the note's; null for engines that try no vertices.
    pub tests_avoided_per_step: Option<f64>,
    /// How many vertices were tried a second, by the median; null for engines that try none.
    pub tests_per_second: Option<f64>,
    /// Of `gpu-rays`, which share the products and sums of its tests are of those that the device does in a kernel of
    /// nothing else; null for others.
    pub share_of_peak: Option<f64>,
    /// Wraps and unwraps a step.
    pub events_per_step: f64,
    /// Wraps and unwraps a second, by the median.
    pub events_per_second: f64,
    /// Of engines that take traces along on a device, which share of the steps the CPU decided; null for others.
    pub doubts_per_step: Option<f64>,
    /// The time a step in each phase, in nanoseconds, summed over threads.
    pub phases: BTreeMap<&'static str, f64>,
    /// How many ropes are wrong at the end; null for engines that promise right ones.
    pub wrong_ropes: Option<usize>,
    /// How much faster it is than the baseline; null where that was not measured.
    pub relative: Option<Ratio>,
}

/// How much faster a contender is than another.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Ratio {
    /// Than which engine.
    pub to: &'static str,
    /// See [`Relative`].
    #[serde(flatten)]
    pub relative: Relative,
}

impl Document {
    /// The JSON Schema of such documents.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Document).to_value()
    }
}

impl From<&Report> for Document {
    fn from(report: &Report) -> Self {
        Document {
            environment: Surroundings::new(&report.environment, report.base.seed),
            results: report.measured.rows.iter().map(Line::from).collect(),
            skipped: report.measured.skipped.clone(),
        }
    }
}

impl From<&Row> for Line {
    fn from(row: &Row) -> Self {
        let (contender, setting) = (row.contender, &row.setting);
        Line {
            engine: contender.engine.name,
            variant: contender.variant,
            precision: contender.precision(),
            scene: setting.scene.name(),
            n: row.n,
            remaining: row.remaining,
            step: setting.step,
            traces: row.traces,
            batch: setting.traces,
            steps: row.steps,
            window: contender.window(setting.window),
            threads: contender.engine.threads(),
            ns_per_step: row.ns_per_step,
            steps_per_second: row.steps_per_second(),
            tests_per_step: row.tests_per_step,
            tests_avoided_per_step: row.tests_avoided_per_step,
            tests_per_second: row.tests_per_second(),
            share_of_peak: row.share_of_peak(),
            events_per_step: row.events_per_step,
            events_per_second: row.events_per_second(),
            doubts_per_step: row.doubts_per_step,
            phases: Phase::ALL.map(Phase::name).into_iter().zip(row.phases).collect(),
            wrong_ropes: row.wrong_ropes,
            relative: row.relative.map(|relative| Ratio { to: Contender::BASELINE.engine.name, relative }),
        }
    }
}
