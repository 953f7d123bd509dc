//! One contender at work: how many traces it can do in the time of a run, and runs over these.

use std::time::{Duration, Instant};

use super::contender::{Contender, Gear};
use super::setting::Work;
use crate::engine::{Engine, EngineError, Job};
use crate::rope::TraceRecord;

/// By how much a sample grows at most while the right size is looked for: costs a step change with the batch.
const GROWTH: f64 = 8.0;

/// What part of a run's time a run should last at least. Where all traces take less, they are evaluated several times.
const SHORTEST: f64 = 0.1;

/// How often all traces are evaluated in one run at most.
const MOST_TIMES: usize = 10_000;

/// A contender with its engine open.
pub(super) struct Runner<'w> {
    pub contender: Contender,
    work: &'w Work,
    engine: Box<dyn Engine + 'w>,
    /// How many of the traces it runs on, from the first.
    pub traces: usize,
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
        let engine = contender.open(&work.model, gear)?;
        Ok(engine.map(|engine| Runner { contender, work, engine, traces: 1.min(work.traces.len()), times: 1 }))
    }

    /// Finds out how many traces take about as long as `run`, at least one, and warms up by that.
    pub(super) fn calibrate(&mut self, run: Duration) -> Result<(), EngineError> {
        let (wanted, all) = (run.as_secs_f64(), self.work.traces.len());
        let mut took = self.evaluate(&Job::new())?.0.as_secs_f64();
        while self.traces < all && took < wanted / 2.0 {
            let growth = (wanted / took.max(1e-9)).min(GROWTH);
            self.traces = ((self.traces as f64 * growth).ceil() as usize).min(all);
            took = self.evaluate(&Job::new())?.0.as_secs_f64();
        }
        self.traces = ((self.traces as f64 * (wanted / took.max(1e-9)).min(2.0)) as usize).clamp(1.min(all), all);
        if self.traces == all {
            self.times = ((SHORTEST * wanted / took.max(1e-9)).ceil() as usize).clamp(1, MOST_TIMES);
        }
        Ok(())
    }

    /// The steps of the traces that it runs on.
    pub(super) fn steps_once(&self) -> u64 {
        self.work.traces[..self.traces].iter().map(|trace| trace.steps() as u64).sum()
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

    /// Evaluates the sample. Freeing old records is no part of the time.
    fn evaluate(&mut self, job: &Job) -> Result<(Duration, Vec<TraceRecord>), EngineError> {
        let start = Instant::now();
        let records = self.engine.evaluate(&self.work.traces[..self.traces], job)?;
        Ok((start.elapsed(), records))
    }
}
