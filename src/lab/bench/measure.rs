//! The measuring itself: interleaved repeats, then one more run with the clock on in every phase.

use std::time::Duration;

use schemars::JsonSchema;
use serde::Serialize;

use super::agreement::Agreement;
use super::contender::{CPU, Contender, GPU_RAYS, Gear};
use super::runner::Runner;
use super::setting::Work;
use super::{BenchError, Setting};
use crate::engine::{Cpu, Engine, EngineError, Job, Phase};
use crate::gpu::{Device, TryingAll};
use crate::lab::Spread;
use crate::trace::SettledTrace;

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// How often every contender runs, at least 1.
    pub repeats: usize,
    /// About how long one run may take. Contenders too slow for all traces run on fewer; those that evaluate many at
    /// once run on the first steps of them.
    pub run: Duration,
}

/// How far a bench is.
pub struct Progress {
    /// Runs done, sizing and warming up included.
    pub done: usize,
    /// Runs in all.
    pub total: usize,
    /// What runs next.
    pub contender: Contender,
}

/// What a bench is at.
pub enum Stage<'a> {
    /// Walks in this setting's scene are about to be made.
    Walking(&'a Setting),
    /// A contender is about to run.
    Runs(Progress),
}

/// What one contender came to on one setting.
#[derive(Clone)]
pub struct Row {
    /// Which contender.
    pub contender: Contender,
    /// On what; its numbers of traces and steps are those of the whole work.
    pub setting: Setting,
    /// The number of vertices.
    pub n: usize,
    /// How many of them the engine tries; see [`Engine::remaining`].
    pub remaining: Option<usize>,
    /// On how many of the traces it ran.
    pub traces: usize,
    /// How many steps of each: all, or the first.
    pub steps: usize,
    /// The time a step of a trace, in nanoseconds, over the repeats.
    pub ns_per_step: Spread,
    /// How many vertices were tried a step; 0 for engines that try none.
    pub tests_per_step: f64,
    /// How many products and sums of f32 the device does a second in a kernel of nothing else; known for `gpu-rays`, of
    /// which the tests are counted against that.
    pub peak: Option<f64>,
    /// The note's n + 1 tests a step less those done; below 0 for engines that do more. `None` for engines that try no
    /// vertices.
    pub tests_avoided_per_step: Option<f64>,
    /// Wraps and unwraps a step.
    pub events_per_step: f64,
    /// Of engines that take traces along on a device, which share of the steps the CPU decided; `None` for others.
    pub doubts_per_step: Option<f64>,
    /// The time a step in every phase, in nanoseconds, summed over threads, from a run of its own: reading the clock
    /// slows engines down. Zero for phases that the engine has not or does not time.
    pub phases: [f64; Phase::ALL.len()],
    /// How much faster it is than the baseline, if that was measured.
    pub relative: Option<Relative>,
    /// On how many of its traces the rope at the end is wrong; only for contenders that promise no right ones.
    pub wrong_ropes: Option<usize>,
}

/// How much faster than the baseline a contender is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Relative {
    /// The ratio of the medians: above 1 where the contender is faster.
    pub ratio: f64,
    /// The spread of the ratios in every repeat.
    pub paired: Spread,
}

/// A contender that could not be measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Skipped {
    /// Its name.
    #[serde(rename = "engine")]
    pub contender: String,
    /// Why.
    pub why: String,
}

/// What came of one setting.
#[derive(Default)]
pub struct Measured {
    /// A row a contender, in the order in which they were given.
    pub rows: Vec<Row>,
    /// Those that could not be measured.
    pub skipped: Vec<Skipped>,
}

impl Row {
    /// Steps of traces a second, by the median.
    pub fn steps_per_second(&self) -> f64 {
        1e9 / self.ns_per_step.median
    }

    /// Vertices tried a second, by the median; `None` for engines that try none.
    pub fn tests_per_second(&self) -> Option<f64> {
        self.tests_avoided_per_step.map(|_| self.tests_per_step * self.steps_per_second())
    }

    /// Which share of the [`peak`](Self::peak) the tests are, by the median.
    pub fn share_of_peak(&self) -> Option<f64> {
        Some(self.tests_per_second()? * f64::from(TryingAll::OPERATIONS) / self.peak?)
    }

    /// Wraps and unwraps a second, by the median.
    pub fn events_per_second(&self) -> f64 {
        self.events_per_step * self.steps_per_second()
    }
}

/// A contender with its runs so far.
struct Lane<'w> {
    runner: Runner<'w>,
    /// What is known of its traces, if they are shorter than those of others.
    own: Option<Agreement>,
    ns: Vec<f64>,
    tests: u64,
    events: u64,
    doubts: u64,
    wrong: Option<usize>,
    phases: [f64; Phase::ALL.len()],
}

/// Measures `contenders` on `work`. Calls `watch` before every run.
///
/// Every repeat runs all of them once, in changing order. Takes about `contenders * (repeats + 2)` runs' time.
///
/// # Errors
///
/// An engine that fails, and engines that give different results. One that cannot take the scene, or needs a GPU where
/// the gear has none, is [`Skipped`].
pub fn measure(
    work: &Work,
    contenders: &[Contender],
    gear: &Gear,
    plan: &Plan,
    watch: &mut dyn FnMut(Progress),
) -> Result<Measured, BenchError> {
    let (mut lanes, mut skipped) = (Vec::new(), Vec::new());
    let (mut done, total) = (0, contenders.len() * (plan.repeats + 2));
    let mut next = |contender| {
        watch(Progress { done, total, contender });
        done += 1;
    };
    for &contender in contenders {
        next(contender);
        match ready(contender, work, gear, plan) {
            Ok(Some(runner)) => lanes.push(Lane::new(runner, work)?),
            Ok(None) => skipped.push((contender, "there is no GPU".to_owned())),
            Err(EngineError::Unfit { why, .. }) => skipped.push((contender, why.to_string())),
            Err(other) => return Err(other.into()),
        }
    }
    let whole = lanes.iter().filter(|lane| lane.own.is_none()).map(|lane| lane.runner.traces().len()).max();
    let mut agreement = known(work, &work.traces[..whole.unwrap_or(0)])?;
    for repeat in 0..plan.repeats {
        for i in order(lanes.len(), repeat) {
            next(lanes[i].runner.contender);
            lanes[i].repeat(&mut agreement)?;
        }
    }
    for lane in &mut lanes {
        next(lane.runner.contender);
        lane.time_phases()?;
    }
    let baseline = lanes.iter().find(|lane| lane.runner.contender.is_baseline()).map(|lane| lane.ns.clone());
    let mut rows: Vec<Row> = lanes.iter().filter_map(|lane| lane.row(work, baseline.as_deref())).collect();
    if let Some(row) = rows.iter_mut().find(|row| row.contender.engine == GPU_RAYS.engine)
        && let Some(device) = &gear.device
    {
        row.peak = Some(device.peak().map_err(EngineError::from)?);
    }
    Ok(Measured { rows, skipped: skipped.into_iter().map(|(c, why)| Skipped { contender: c.name(), why }).collect() })
}

/// Measures `contenders` on each of `settings`, one after the other. `watch` hears of each setting before its walks are
/// made, and of every run before it; runs are counted over all settings.
///
/// # Errors
///
/// Those of [`measure`], and a scene or a walk that is at fault, which should not happen.
pub fn measure_all(
    settings: &[Setting],
    contenders: &[Contender],
    device: Option<&Device>,
    plan: &Plan,
    watch: &mut dyn FnMut(Stage<'_>),
) -> Result<Measured, BenchError> {
    let mut all = Measured::default();
    for (i, setting) in settings.iter().enumerate() {
        watch(Stage::Walking(setting));
        let gear = Gear { device: device.cloned(), window: setting.window };
        let measured =
            measure(&setting.work()?, contenders, &gear, plan, &mut |Progress { done, total, contender }| {
                watch(Stage::Runs(Progress { done: i * total + done, total: settings.len() * total, contender }));
            })?;
        all.rows.extend(measured.rows);
        let new: Vec<_> = measured.skipped.into_iter().filter(|s| !all.skipped.contains(s)).collect();
        all.skipped.extend(new);
    }
    Ok(all)
}

/// What the engine `cpu` makes of `traces`, with which all runs on them are compared. Whether it is right itself, the
/// other contenders show.
fn known(work: &Work, traces: &[SettledTrace]) -> Result<Agreement, BenchError> {
    let mut agreement = Agreement::new(traces.len());
    agreement.check(CPU, &Cpu::new(work.model.clone()).evaluate(traces, &Job::new())?)?;
    Ok(agreement)
}

fn ready<'w>(
    contender: Contender,
    work: &'w Work,
    gear: &Gear,
    plan: &Plan,
) -> Result<Option<Runner<'w>>, EngineError> {
    let mut runner = Runner::open(contender, work, gear)?;
    if let Some(runner) = &mut runner {
        runner.calibrate(plan.run)?;
    }
    Ok(runner)
}

/// The order in which a repeat runs `count` contenders: another one first each time, and backwards every other time, so
/// that none always follows the same one.
pub(in crate::lab) fn order(count: usize, repeat: usize) -> impl Iterator<Item = usize> {
    (0..count).map(move |i| if repeat.is_multiple_of(2) { i } else { count - 1 - i }).map(move |i| (i + repeat) % count)
}

impl<'w> Lane<'w> {
    fn new(runner: Runner<'w>, work: &Work) -> Result<Self, BenchError> {
        let own = if runner.is_short() { Some(known(work, runner.traces())?) } else { None };
        Ok(Lane {
            runner,
            own,
            ns: Vec::new(),
            tests: 0,
            events: 0,
            doubts: 0,
            wrong: None,
            phases: Default::default(),
        })
    }

    /// Runs once more, and compares what comes out with what others gave.
    fn repeat(&mut self, agreement: &mut Agreement) -> Result<(), BenchError> {
        let job = Job::new();
        let run = self.runner.run(&job)?;
        self.ns.push(run.ns_per_step);
        (self.tests, self.doubts) = (job.tests(), job.doubts());
        self.events = run.records.iter().map(|r| r.events.len() as u64).sum();
        self.wrong = self.own.as_mut().unwrap_or(agreement).check(self.runner.contender, &run.records)?;
        Ok(())
    }

    fn time_phases(&mut self) -> Result<(), EngineError> {
        let job = Job::timed();
        self.runner.run(&job)?;
        let steps = self.runner.steps() as f64;
        self.phases = Phase::ALL.map(|phase| job.phase(phase).as_nanos() as f64 / steps);
        Ok(())
    }

    fn row(&self, work: &Work, baseline: Option<&[f64]>) -> Option<Row> {
        let contender = self.runner.contender;
        let n = work.model.vertices().len();
        let ns_per_step = Spread::of(self.ns.iter().copied())?;
        let tests_per_step = self.tests as f64 / self.runner.steps() as f64;
        let relative = baseline.and_then(|theirs| {
            let paired = Spread::of(theirs.iter().zip(&self.ns).map(|(theirs, ours)| theirs / ours))?;
            Some(Relative { ratio: Spread::of(theirs.iter().copied())?.median / ns_per_step.median, paired })
        });
        Some(Row {
            contender,
            setting: work.setting.clone(),
            n,
            remaining: self.runner.remaining(),
            traces: self.runner.traces().len(),
            steps: self.runner.steps_a_trace(),
            ns_per_step,
            tests_per_step,
            peak: None,
            tests_avoided_per_step: (self.tests > 0).then(|| (n + 1) as f64 - tests_per_step),
            events_per_step: self.events as f64 / self.runner.steps_once() as f64,
            doubts_per_step: contender.asks_cpu().then(|| self.doubts as f64 / self.runner.steps() as f64),
            phases: self.phases,
            relative,
            wrong_ropes: self.wrong,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_repeat_runs_all_in_another_order() {
        let orders: Vec<Vec<usize>> = (0..4).map(|repeat| order(4, repeat).collect()).collect();
        assert_eq!(orders, [[0, 1, 2, 3], [0, 3, 2, 1], [2, 3, 0, 1], [2, 1, 0, 3]]);
        assert_eq!(order(0, 3).count(), 0);
    }
}
