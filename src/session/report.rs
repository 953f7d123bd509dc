//! What a run cost and where it ran: what `run.json` holds.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::engine::{Engine, Precision};
use crate::environment::Environment;
use crate::study::Study;

/// What computed a study's ropes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Computed {
    /// The engine's name.
    pub engine: &'static str,
    /// How much its ropes can be trusted: `f64` where they are wrong by design.
    pub precision: &'static str,
    /// What it ran on, in words.
    pub on: String,
}

impl Computed {
    /// By `engine`, which ran `on` that.
    pub fn by(engine: &dyn Engine, on: &str) -> Self {
        Computed { engine: engine.name(), precision: engine.precision_name(), on: on.to_owned() }
    }
}

/// What a run cost and where it ran.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum RunReport {
    /// Ropes were evaluated.
    Run(Box<RunCost>),
    /// Shards were put together.
    Merge(MergeCost),
}

/// A run that evaluated ropes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunCost {
    /// The version of tautline.
    pub version: String,
    /// The commit that it was built from.
    pub commit: String,
    /// What evaluated.
    pub engine: String,
    /// What decided: `certified`, `fast` or `f64`.
    pub precision: String,
    /// What it ran on.
    pub on: String,
    /// The processor.
    pub processor: String,
    /// The operating system and the kind of processor.
    pub os: String,
    /// How many threads engines on threads used.
    pub threads: usize,
    /// Which part of the study it is, as K/N.
    pub shard: String,
    /// How many traces this run did.
    pub traces: u64,
    /// How many steps.
    pub steps: u64,
    /// How long it took.
    pub seconds: f64,
    /// Steps a second.
    pub steps_per_second: f64,
    /// How many wall ends were tried in all; 0 for engines that try none.
    pub tests: u64,
    /// How many of them a second while traces were evaluated.
    pub tests_per_second: f64,
    /// How long it took together with the runs before.
    pub seconds_of_all_runs: f64,
    /// What the time went into.
    pub spent: SpentSeconds,
    /// What is known of the scene.
    pub scene: Tried,
}

/// What a run's time went into, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpentSeconds {
    /// Drawing traces, beside all else.
    pub drawing_beside: f64,
    /// Waiting for them.
    pub waiting_for_traces: f64,
    /// Evaluating ropes.
    pub evaluating: f64,
    /// Counting.
    pub tallying: f64,
}

/// How many wall ends there are, and how many are tried.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Tried {
    /// How many there are.
    pub vertices: usize,
    /// Of each anchor: how many its engine tries. Null for engines that do not ask.
    pub remaining: Option<Vec<usize>>,
}

/// A study that was put together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MergeCost {
    /// The version of tautline.
    pub version: String,
    /// The commit that it was built from.
    pub commit: String,
    /// The shards' folders.
    pub merged: Vec<PathBuf>,
    /// What decided: `certified` or `fast`.
    pub precision: String,
    /// How long all runs took together.
    pub seconds_of_all_runs: f64,
}

impl RunReport {
    /// The JSON Schema of `run.json`.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(RunReport).to_value()
    }

    /// The run, if ropes were evaluated.
    pub fn run(&self) -> Option<&RunCost> {
        match self {
            RunReport::Run(cost) => Some(cost),
            RunReport::Merge(_) => None,
        }
    }

    pub(super) fn merged(shards: &[PathBuf], precision: Precision, seconds: f64) -> Self {
        let here = Environment::here(None);
        RunReport::Merge(MergeCost {
            version: here.version.to_owned(),
            commit: here.commit.to_owned(),
            merged: shards.to_vec(),
            precision: precision.name().to_owned(),
            seconds_of_all_runs: seconds,
        })
    }
}

/// A report as it is written: JSON with its keys in order, and a line end.
pub(super) fn pretty(report: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(format!("{:#}\n", serde_json::to_value(report)?))
}

/// What each file of rows says of where it comes from.
pub(super) fn provenance(study: &Study, computed: &Computed) -> Vec<(&'static str, String)> {
    let mut notes = origin(study);
    notes.extend([
        ("tautline.engine", computed.engine.to_owned()),
        ("tautline.precision", computed.precision.to_owned()),
        ("tautline.on", computed.on.clone()),
    ]);
    notes.extend(study.plan().run.trade().notes());
    notes
}

/// The same but for what computed it.
pub(super) fn origin(study: &Study) -> Vec<(&'static str, String)> {
    let here = Environment::here(None);
    vec![
        ("tautline.version", here.version.to_owned()),
        ("tautline.commit", here.commit.to_owned()),
        ("tautline.study", study.identity().to_owned()),
        ("tautline.seed", study.plan().run.seed.to_string()),
    ]
}
