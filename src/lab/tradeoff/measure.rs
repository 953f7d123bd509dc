//! The measuring itself: every method at every setting, interleaved and repeated.

use std::time::{Duration, Instant};

use super::method::Method;
use super::pareto::mark;
use super::point::{LengthError, Point};
use super::setting::{Setting, Variant, Work};
use super::truth::{Score, Truth};
use super::{TradeoffError, Wanted};
use crate::engine::{EngineError, Job};
use crate::lab::Spread;
use crate::lab::bench::{Gear, Plan, order};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// How many traces engines that evaluate many at once are first given, to see how long they take.
const FIRST: usize = 64;

/// By how much a sample grows at most while the right size is looked for.
const GROWTH: f64 = 8.0;

/// What part of a run's time a run should last at least; shorter ones are done several times over.
const SHORTEST: f64 = 0.1;

/// How often a sample is evaluated in one run at most.
const MOST_TIMES: usize = 10_000;

/// How far a measurement is.
pub struct Progress {
    /// Runs done.
    pub done: usize,
    /// Runs in all, as far as that is known; 0 while it is not.
    pub total: usize,
    /// What runs next; `None` while the work is being made ready.
    pub next: Option<(Method, Setting)>,
}

/// What could not be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// The method's name, or `all`.
    pub method: &'static str,
    /// At which setting; `None` for all.
    pub setting: Option<Setting>,
    /// Why.
    pub why: String,
}

/// What came of it.
pub struct Tradeoff {
    /// What reports call the scene.
    pub scene: String,
    /// The number of its vertices.
    pub n: usize,
    /// How many traces there are, and how many steps they have.
    pub traces: usize,
    /// See [`traces`](Self::traces).
    pub steps: u64,
    /// For how many traces, from the first on, the scalar reference itself vouched for the truth; for the others the
    /// engine `cpu` did, which gave the same records for these.
    pub vouched: usize,
    /// By method, then by setting.
    pub points: Vec<Point>,
    /// What failed.
    pub failed: Vec<Failed>,
}

/// A method at a setting, and its runs so far.
struct Lane<'v> {
    method: Method,
    variant: &'v Variant,
    /// On how many of the traces it runs.
    traces: usize,
    /// How often it evaluates them in one run.
    times: usize,
    ns: Vec<f64>,
    score: Option<Score>,
}

/// Runs the wanted methods at the wanted settings on `work`. Calls `watch` before every run.
///
/// Every repeat runs all of them once, in changing order, each with an engine made anew and warmed up. Takes about
/// `methods * settings * (repeats + 1)` runs' time, and holds the traces once for every setting.
///
/// # Errors
///
/// A trace that crosses a wall, an engine that fails, and exact methods that differ. What a method or a setting cannot
/// take is listed in [`Tradeoff::failed`].
pub fn tradeoff(
    work: &Work,
    wanted: &Wanted,
    gear: &Gear,
    plan: &Plan,
    watch: &mut dyn FnMut(Progress),
) -> Result<Tradeoff, TradeoffError> {
    watch(Progress { done: 0, total: 0, next: None });
    let mut failed = Vec::new();
    let variants = variants(work, &wanted.settings, &mut failed)?;
    let truth = Truth::of(&variants[0])?;
    let asked: Vec<Lane> = wanted.methods.iter().flat_map(|&method| lanes(method, &variants)).collect();
    // One to find out how much can be done in one, then the repeats.
    let (mut done, mut total) = (0, asked.len() * (1 + plan.repeats));
    let mut next = |lane: &Lane, total: usize| {
        watch(Progress { done, total, next: Some((lane.method, lane.variant.setting)) });
        done += 1;
    };
    let mut lanes = Vec::new();
    for mut lane in asked {
        next(&lane, total);
        let why = match lane.calibrate(gear, plan.run) {
            Ok(true) => {
                lanes.push(lane);
                continue;
            }
            Ok(false) => "there is no GPU".to_owned(),
            Err(EngineError::Unfit { why, .. }) => why.to_string(),
            Err(other) => return Err(other.into()),
        };
        failed.push(lane.failed(why));
        total -= plan.repeats;
    }
    for repeat in 0..plan.repeats {
        for i in order(lanes.len(), repeat) {
            next(&lanes[i], total);
            lanes[i].repeat(gear, &truth)?;
        }
    }
    let mut points: Vec<Point> = lanes.iter().filter_map(Lane::point).collect();
    mark(&mut points);
    let exact = &variants[0];
    Ok(Tradeoff {
        scene: work.scene.clone(),
        n: work.model.vertices().len(),
        traces: exact.traces.len(),
        steps: steps(&exact.traces),
        vouched: truth.vouched,
        points,
        failed,
    })
}

/// A method at each setting; what is the truth itself, at that which trades nothing.
fn lanes<'v>(method: Method, variants: &'v [Variant]) -> impl Iterator<Item = Lane<'v>> {
    let is_wanted = move |v: &&Variant| !method.is_truth() || v.setting == Setting::EXACT;
    variants.iter().filter(is_wanted).map(move |variant| Lane::new(method, variant))
}

/// The work as it is, then as each setting has it.
fn variants(work: &Work, settings: &[Setting], failed: &mut Vec<Failed>) -> Result<Vec<Variant>, TradeoffError> {
    let mut variants = vec![Variant::exact(work)?];
    for &setting in settings.iter().filter(|&&s| s != Setting::EXACT) {
        match variants[0].at(setting) {
            Ok(variant) if matches!(setting, Setting::Simplify(_)) && variant.is_like(&variants[0]) => {
                let why = "it leaves no wall end out in this scene".to_owned();
                failed.push(Failed { method: "all", setting: Some(setting), why });
            }
            Ok(variant) => variants.push(variant),
            Err(error) => failed.push(Failed { method: "all", setting: Some(setting), why: error.to_string() }),
        }
    }
    Ok(variants)
}

/// How many steps traces have, those that were left out counted in.
fn steps(traces: &[SettledTrace]) -> u64 {
    traces.iter().map(|trace| trace.steps() as u64).sum()
}

/// One run: how long it took, and what came out.
struct Run {
    took: Duration,
    records: Vec<TraceRecord>,
}

impl<'v> Lane<'v> {
    fn new(method: Method, variant: &'v Variant) -> Self {
        let first = if method.takes_many() { FIRST } else { 1 };
        let traces = first.min(variant.traces.len());
        Lane { method, variant, traces, times: 1, ns: Vec::new(), score: None }
    }

    fn failed(&self, why: String) -> Failed {
        Failed { method: self.method.name, setting: Some(self.variant.setting), why }
    }

    /// Finds out how many traces take about as long as `run`; false if there is no GPU for it.
    fn calibrate(&mut self, gear: &Gear, run: Duration) -> Result<bool, EngineError> {
        let (wanted, all) = (run.as_secs_f64(), self.variant.traces.len());
        loop {
            let Some(Run { took, .. }) = self.run(gear)? else { return Ok(false) };
            let took = took.as_secs_f64().max(1e-9);
            if self.traces == all || took >= wanted / 2.0 {
                if took > wanted {
                    self.traces = ((self.traces as f64 * wanted / took) as usize).max(1);
                } else {
                    self.times = ((SHORTEST * wanted / took).ceil() as usize).clamp(1, MOST_TIMES);
                }
                return Ok(true);
            }
            self.traces = ((self.traces as f64 * (wanted / took).clamp(2.0, GROWTH)) as usize).min(all);
        }
    }

    /// Evaluates the sample once, on an engine that is made and warmed up before the clock starts.
    fn run(&self, gear: &Gear) -> Result<Option<Run>, EngineError> {
        let traces = self.sample();
        let Some(mut engine) = self.method.open(self.variant.model.clone(), gear)? else { return Ok(None) };
        if self.method.takes_many() {
            engine.evaluate(&traces[..FIRST.min(traces.len())], &Job::new())?;
        }
        let (mut took, mut records) = (Duration::ZERO, Vec::new());
        for _ in 0..self.times {
            engine.forget();
            let start = Instant::now();
            let given = engine.evaluate(traces, &Job::new())?;
            took += start.elapsed();
            // Freeing the ones before is no part of the time.
            records = given;
        }
        Ok(Some(Run { took, records }))
    }

    /// Runs once more, and the first time looks at what comes out.
    fn repeat(&mut self, gear: &Gear, truth: &Truth) -> Result<(), TradeoffError> {
        let Some(Run { took, records }) = self.run(gear)? else { return Ok(()) };
        self.ns.push(took.as_nanos() as f64 / (self.steps() * self.times as u64).max(1) as f64);
        if self.score.is_none() {
            let broken = (self.variant.setting == Setting::EXACT).then(|| truth.broken(&self.method, &records));
            if let Some(disagreement) = broken.flatten() {
                return Err(disagreement.into());
            }
            self.score = Some(truth.score(self.variant, &records));
        }
        Ok(())
    }

    /// The traces on which it runs.
    fn sample(&self) -> &'v [SettledTrace] {
        &self.variant.traces[..self.traces]
    }

    /// How many steps its traces have before any are left out.
    fn steps(&self) -> u64 {
        steps(self.sample())
    }

    fn point(&self) -> Option<Point> {
        let (score, has_events) = (self.score.as_ref()?, self.method.has_events());
        Some(Point {
            method: self.method.name,
            engine: self.method.engine().name,
            setting: self.variant.setting,
            n: self.variant.model.vertices().len(),
            traces: self.traces,
            steps: self.steps(),
            ns_per_step: Spread::of(self.ns.iter().copied())?,
            jumps: self.sample().iter().map(SettledTrace::jumps).sum(),
            crossing_traces: self.sample().iter().filter(|trace| trace.crossings() > 0).count(),
            event_mismatch: has_events.then_some(score.event_mismatch),
            final_mismatch: score.final_mismatch,
            length_error: LengthError { mean: score.length_error.mean, max: score.length_error.max },
            length: score.length.answer(),
            wraps: has_events.then(|| score.wraps.answer()),
            pareto: false,
        })
    }
}
