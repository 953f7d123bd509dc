//! What a run came to, in numbers: counted batch by batch as it goes on.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::time::Duration;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::Times;
use super::statistics::{Counts, Lengths, Statistics};
use crate::engine::{Engine, Job};
use crate::rope::{EndsRecord, EventKind, TraceRecord};
use crate::trace::{SettledEnds, SettledTrace};
use crate::trade::{Terms, Trade, Traded};

/// A run in numbers. Traces that break the rules are counted in `traces`, `steps` and `still` only: their ropes may be
/// wrong.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The scene.
    pub scene: SceneReport,
    /// What computed the ropes.
    pub engine: &'static str,
    /// How much they can be trusted: `certified`, `fast`, or `f64` where they are wrong by design.
    pub precision: &'static str,
    /// What the engine ran on, in words.
    pub on: String,
    /// The version of tautline.
    pub version: &'static str,
    /// The commit that it was built from.
    pub commit: &'static str,
    /// What was given for speed, and what that came to; null for nothing.
    pub traded: Option<TradedReport>,
    /// How many traces there are.
    pub traces: u64,
    /// How many steps they have.
    pub steps: u64,
    /// How many steps leave the free end where it is.
    pub still: u64,
    /// How many traces break the rules.
    pub violations: u64,
    /// How many do not.
    pub counted: u64,
    /// How many steps those have.
    #[serde(skip)]
    pub counted_steps: u64,
    /// How many wraps there were.
    pub wraps: u64,
    /// How many unwraps.
    pub unwraps: u64,
    /// The rope's length at the end; null, as the next three, where no trace counts.
    pub length: Option<Statistics>,
    /// Its greatest length.
    pub max_length: Option<Statistics>,
    /// The number of its turns at the end.
    pub depth: Option<Statistics>,
    /// Its greatest number of turns.
    pub max_depth: Option<Statistics>,
    /// How many ropes touch something that is called so at the end, the most first.
    pub touched: Vec<Touched>,
    /// How long the parts of the run took.
    pub seconds: Seconds,
    /// Steps a second from start to end.
    pub steps_per_second: f64,
    /// How many wall ends were tried in all; 0 for engines that try none.
    pub tests: u64,
    /// How many of them a second while traces were evaluated.
    pub tests_per_second: f64,
}

/// The scene of a run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SceneReport {
    /// Its name.
    pub name: String,
    /// How many walls it has.
    pub walls: usize,
    /// How many wall ends.
    pub vertices: usize,
    /// How many of them the engine tries; null for engines that do not ask.
    pub remaining: Option<usize>,
    /// How many walls of zero length were dropped.
    pub dropped: usize,
    /// Where the rope is tied.
    pub anchor: [f64; 2],
}

/// What was given for speed, and what that came to.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TradedReport {
    /// What was given.
    #[serde(flatten)]
    pub trade: Trade,
    /// How many wall ends the scene has.
    #[serde(skip)]
    pub vertices: u64,
    /// How many of them were left.
    pub vertices_left: u64,
    /// How many longer steps would have touched a wall, and were walked point by point.
    pub jumps: u64,
    /// How many traces cross a simplified wall.
    pub crossing_traces: u64,
    /// How many steps do.
    pub crossing_steps: u64,
}

/// How many ropes touch something that is called so at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Touched {
    /// The label.
    pub label: String,
    /// How many.
    pub traces: u64,
}

/// How long the parts of a run took, in seconds. They go on at the same time, so their sum may be more than the whole.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Seconds {
    /// Reading and checking traces.
    pub prepare: f64,
    /// The engine.
    pub evaluate: f64,
    /// Writing results and events.
    pub write: f64,
    /// From start to end.
    pub total: f64,
}

/// Counts a run batch by batch. Its memory is bounded, however many traces there are.
pub struct Account {
    terms: Terms,
    report: Report,
    traded: Traded,
    length: Lengths,
    max_length: Lengths,
    depth: Counts,
    max_depth: Counts,
    /// The label of each wall end; empty if there are none.
    labels: Vec<Option<String>>,
    touched: BTreeMap<String, u64>,
}

impl Account {
    /// No traces so far, in the scene called `name`, to be evaluated by `engine`, which runs `on` that.
    pub fn new(name: &str, terms: &Terms, engine: &dyn Engine, on: String) -> Self {
        let given = &terms.given;
        let scene = SceneReport {
            name: name.to_owned(),
            walls: given.scene().walls().len(),
            vertices: given.vertices().len(),
            remaining: None,
            dropped: given.scene().dropped(),
            anchor: given.anchor().to_array(),
        };
        let report = Report {
            scene,
            engine: engine.name(),
            precision: engine.precision_name(),
            on,
            version: env!("CARGO_PKG_VERSION"),
            commit: env!("TAUTLINE_COMMIT"),
            traded: None,
            traces: 0,
            steps: 0,
            still: 0,
            violations: 0,
            counted: 0,
            counted_steps: 0,
            wraps: 0,
            unwraps: 0,
            length: None,
            max_length: None,
            depth: None,
            max_depth: None,
            touched: Vec::new(),
            seconds: Seconds { prepare: 0.0, evaluate: 0.0, write: 0.0, total: 0.0 },
            steps_per_second: 0.0,
            tests: 0,
            tests_per_second: 0.0,
        };
        Account {
            labels: terms.used.scene().labels().into_iter().map(|label| label.map(str::to_owned)).collect(),
            terms: terms.clone(),
            report,
            traded: Traded::default(),
            length: Lengths::default(),
            max_length: Lengths::default(),
            depth: Counts::default(),
            max_depth: Counts::default(),
            touched: BTreeMap::new(),
        }
    }

    /// Counts the next traces and their records in. O(steps + events).
    pub fn add(&mut self, settled: &[SettledTrace], records: &[TraceRecord]) {
        for (trace, record) in settled.iter().zip(records) {
            self.traded.add(trace);
            self.count(trace.still(), trace.violation().is_some(), record);
        }
    }

    /// The same for ropes whose ends both move: a step stands still where neither end moves. O(steps + events).
    pub fn add_ends(&mut self, settled: &[SettledEnds], records: &[EndsRecord]) {
        for (trace, record) in settled.iter().zip(records) {
            self.count(trace.still(), trace.violation().is_some(), &record.record);
        }
    }

    /// Counts a trace in, so many of whose steps stand still.
    fn count(&mut self, still: usize, breaks_rules: bool, record: &TraceRecord) {
        let report = &mut self.report;
        report.traces += 1;
        report.steps += record.steps;
        report.still += still as u64;
        if breaks_rules {
            report.violations += 1;
            return;
        }
        let wraps = record.events.iter().filter(|e| e.kind == EventKind::Wrap).count();
        report.counted += 1;
        report.counted_steps += record.steps;
        report.wraps += wraps as u64;
        report.unwraps += (record.events.len() - wraps) as u64;
        self.length.add(record.length);
        self.max_length.add(record.max_length);
        self.depth.add(record.depth);
        self.max_depth.add(record.max_depth);
        if !self.labels.is_empty() {
            self.touch(record);
        }
    }

    /// Counts the labels of what a rope touches at the end, each once.
    fn touch(&mut self, record: &TraceRecord) {
        let label = |at: &DVec2| self.labels.get(self.terms.used.vertex_at(*at)? as usize)?.as_deref();
        let touched: BTreeSet<&str> = record.wraps.iter().filter_map(|(at, _)| label(at)).collect();
        for label in touched {
            match self.touched.get_mut(label) {
                Some(count) => *count += 1,
                None => drop(self.touched.insert(label.to_owned(), 1)),
            }
        }
    }

    /// What the run came to: after the last traces, with how long it took, and the engine and the job that did it.
    pub fn report(self, engine: &dyn Engine, job: &Job, times: &Times, total: Duration) -> Report {
        let Traded { jumps, crossing_traces, crossing_steps, .. } = self.traded;
        let [vertices, vertices_left] = [&self.terms.given, &self.terms.used].map(|m| m.vertices().len() as u64);
        let trade = self.terms.trade;
        let traded = TradedReport { trade, vertices, vertices_left, jumps, crossing_traces, crossing_steps };
        let touched = self.touched.into_iter().map(|(label, traces)| Touched { label, traces });
        let mut touched: Vec<Touched> = touched.collect();
        touched.sort_by_key(|touched| std::cmp::Reverse(touched.traces));
        let [prepare, evaluate, write, total] =
            [times.prepared, times.evaluated, times.written, total].map(|time| time.as_secs_f64());
        Report {
            scene: SceneReport { remaining: engine.remaining(), ..self.report.scene },
            traded: trade.is_any().then_some(traded),
            length: self.length.statistics(),
            max_length: self.max_length.statistics(),
            depth: self.depth.statistics(),
            max_depth: self.max_depth.statistics(),
            touched,
            seconds: Seconds { prepare, evaluate, write, total },
            steps_per_second: self.report.steps as f64 / total.max(1e-9),
            tests: job.tests(),
            tests_per_second: job.tests() as f64 / evaluate.max(1e-9),
            ..self.report
        }
    }
}

impl Report {
    /// The JSON Schema of such reports.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Report).to_value()
    }
}

impl fmt::Display for TradedReport {
    /// As [`Trade::words`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TradedReport { trade, vertices, vertices_left, jumps, crossing_traces, crossing_steps } = *self;
        f.write_str(&trade.words(&Traded { vertices, vertices_left, jumps, crossing_traces, crossing_steps }))
    }
}
