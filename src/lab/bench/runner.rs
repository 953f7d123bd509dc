//! One contender at work: on how much of the work it can run in the time of a run, and runs over that.

use std::time::{Duration, Instant};

use super::contender::{Contender, Gear};
use super::setting::Work;
use crate::engine::{Engine, EngineError, Job};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// By how much a sample grows at most while the right size is looked for: costs a step change with the batch.
const GROWTH: f64 = 8.0;

/// How many traces make a fair round. Engines that evaluate in rounds would be misjudged on fewer, since a round has
/// costs of its own; where all steps of so many take too long, they run on their first steps instead.
const FAIR_ROUND: usize = 1024;

/// The fewest first steps on which such engines run: windows must have room to grow, and ropes something to wrap. Where
/// these take too long, there are fewer traces after all.
const FEWEST_STEPS: usize = 64;

/// What part of a run's time a run should last at least. Where all traces take less, they are evaluated several times.
const SHORTEST: f64 = 0.1;

/// How often all traces are evaluated in one run at most.
const MOST_TIMES: usize = 10_000;

/// A contender with its engine open, and the sample of the work on which it runs: the first traces, and all their steps
/// or the first.
pub(super) struct Runner<'w> {
    pub contender: Contender,
    work: &'w Work,
    engine: Box<dyn Engine>,
    /// How many of the traces it runs on.
    traces: usize,
    /// Walks that are shorter than those of the work, in place of these.
    short: Option<Vec<SettledTrace>>,
    /// How often it evaluates them in one run.
    times: usize,
}

/// One run: how long it took, and what came out the last time.
pub(super) struct Run {
    pub ns_per_step: f64,
    pub records: Vec<TraceRecord>,
}

impl<'w> Runner<'w> {
    /// Opens the contender's engine; `None` if it needs a GPU and there is none.
    pub(super) fn open(contender: Contender, work: &'w Work, gear: &Gear) -> Result<Option<Self>, EngineError> {
        let Some(engine) = contender.open(work.model.clone(), gear)? else { return Ok(None) };
        let steps = if contender.engine.takes_many() { FEWEST_STEPS } else { work.setting.steps };
        let mut runner = Runner { contender, work, engine, traces: 1, short: None, times: 1 };
        runner.shorten(steps);
        Ok(Some(runner))
    }

    /// Finds out how much takes about as long as `run`, and warms up by that.
    pub(super) fn calibrate(&mut self, run: Duration) -> Result<(), EngineError> {
        let (wanted, all) = (run.as_secs_f64(), self.work.traces.len());
        let mut took = self.sample()?;
        while self.traces < all || self.short.is_some() {
            if took >= wanted / 2.0 {
                // Enough, unless something else got in the way.
                took = took.min(self.sample()?);
            }
            if took >= wanted / 2.0 {
                break;
            }
            self.grow((wanted / took).min(GROWTH));
            took = self.sample()?;
        }
        if took > wanted {
            self.traces = ((self.traces as f64 * wanted / took) as usize).max(1);
        } else if self.traces == all && self.short.is_none() {
            self.times = ((SHORTEST * wanted / took).ceil() as usize).clamp(1, MOST_TIMES);
        }
        Ok(())
    }

    /// Makes the sample `growth` times as large: first as many traces as make a fair round, then all their steps, then
    /// all traces.
    fn grow(&mut self, growth: f64) {
        let larger = |size: usize| (size as f64 * growth).ceil() as usize;
        let (all, steps) = (self.work.traces.len(), self.steps_a_trace());
        let fair = FAIR_ROUND.min(all);
        if self.short.is_some() && self.traces < fair {
            self.traces = larger(self.traces).min(fair);
            self.shorten(steps);
        } else if self.short.is_some() {
            self.shorten(larger(steps));
        } else {
            self.traces = larger(self.traces).min(all);
        }
    }

    /// Makes it run on the first `steps` steps of its traces, if they have more.
    fn shorten(&mut self, steps: usize) {
        self.short = (steps < self.work.setting.steps).then(|| self.work.first_steps(steps, self.traces as u64));
    }

    /// The traces that it runs on.
    pub(super) fn traces(&self) -> &[SettledTrace] {
        &self.short.as_ref().unwrap_or(&self.work.traces)[..self.traces]
    }

    /// How many steps each of them has.
    pub(super) fn steps_a_trace(&self) -> usize {
        self.traces().first().map_or(0, SettledTrace::steps)
    }

    /// Whether these are the first steps of the work's traces only.
    pub(super) fn is_short(&self) -> bool {
        self.short.is_some()
    }

    /// How many of the scene's vertices its engine tries.
    pub(super) fn remaining(&self) -> Option<usize> {
        self.engine.remaining()
    }

    /// How long the sample takes, in seconds; never 0.
    fn sample(&mut self) -> Result<f64, EngineError> {
        Ok(self.evaluate(&Job::new())?.0.as_secs_f64().max(1e-9))
    }

    /// The steps of the traces that it runs on.
    pub(super) fn steps_once(&self) -> u64 {
        self.traces().iter().map(|trace| trace.steps() as u64).sum()
    }

    /// The steps of one run.
    pub(super) fn steps(&self) -> u64 {
        self.steps_once() * self.times as u64
    }

    /// Runs once; `job` counts over the whole run.
    pub(super) fn run(&mut self, job: &Job) -> Result<Run, EngineError> {
        let (mut took, mut records) = self.evaluate(job)?;
        for _ in 1..self.times {
            let (more, again) = self.evaluate(job)?;
            took += more;
            records = again;
        }
        Ok(Run { ns_per_step: took.as_nanos() as f64 / self.steps() as f64, records })
    }

    /// Evaluates the sample, the making of all that the engine makes of the scene included. Freeing old records is no
    /// part of the time.
    fn evaluate(&mut self, job: &Job) -> Result<(Duration, Vec<TraceRecord>), EngineError> {
        let traces = &self.short.as_ref().unwrap_or(&self.work.traces)[..self.traces];
        self.engine.forget();
        let start = Instant::now();
        let records = self.engine.evaluate(traces, job)?;
        Ok((start.elapsed(), records))
    }
}
