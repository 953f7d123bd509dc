//! What a study would cost, going by its first traces.

use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use tautline::engine::Job;
use tautline::study::{RunError, Shard, State, Study, Summary, Sweep, run};

use super::engines::Engines;
use crate::cli::engine::EngineArgs;
use crate::cli::failure::Failure;
use crate::cli::input::note;

/// What the first traces came to.
pub(super) struct Measured {
    /// The engine, how much it can be trusted, and what it runs on.
    pub(super) engine: String,
    /// How many traces, and how long they took; `None` if there are none.
    pub(super) first: Option<(usize, Duration)>,
    /// What they say.
    pub(super) summary: Summary,
}

impl Measured {
    /// How long the whole part would take; `None` if it has no traces.
    pub(super) fn all(&self, study: &Study, part: Shard) -> Option<Duration> {
        let (traces, took) = self.first.filter(|&(traces, _)| traces > 0)?;
        let share = study.places(part) as f64 / traces as f64;
        Some(Duration::try_from_secs_f64(took.as_secs_f64() * share).unwrap_or(Duration::MAX))
    }
}

/// Of how many studies of a sweep, evenly among all, the time is measured that all would take.
const MEASURED: usize = 8;

/// Checks all studies of a sweep, with their scenes; and, where there is an engine and a part, tells about how long
/// that part of all would take.
pub(super) fn check_sweep(sweep: &Sweep, base: &Path, with: Option<(&EngineArgs, Shard)>) -> Result<Duration, Failure> {
    let all = sweep.points().len();
    let every = all.div_ceil(MEASURED);
    let mut measured = Duration::ZERO;
    for (i, point) in sweep.points().iter().enumerate() {
        let study = Study::open(point.plan.clone(), base).map_err(|e| sweep.located(e, i))?;
        study.check_moves().map_err(|e| sweep.located(e, i))?;
        if i == 0 {
            study.plan().scene.file.iter().for_each(|file| note(file, study.models()[0].scene()));
        }
        if let Some((engine, part)) = with.filter(|_| i % every == 0) {
            measured += measure(&study, engine, part)?.all(&study, part).unwrap_or_default();
        }
    }
    Ok(measured.mul_f64(all as f64 / all.div_ceil(every) as f64))
}

/// For how long the first traces are done, by which all are judged; or as many as it takes, if one takes longer.
const LONG_ENOUGH: Duration = Duration::from_secs(1);

/// Does the first traces of a part of a study.
pub(super) fn measure(study: &Study, engine: &EngineArgs, part: Shard) -> Result<Measured, Failure> {
    let Engines { mut engines, on } = Engines::open(engine, study)?;
    let engine = format!("engine {} ({}) on {on}", engines[0].name(), engines[0].precision_name());
    let state = Mutex::new(State::new(study, part));
    let clock = Instant::now();
    let mut first: Option<(usize, Duration)> = None;
    let outcome = run(study, &mut engines, &state, &Job::new(), |_, _, traces| {
        let (all, took) = (first.map_or(0, |(before, _)| before) + traces, clock.elapsed());
        first = Some((all, took));
        if took < LONG_ENOUGH { Ok(()) } else { Err(()) }
    });
    match outcome {
        Ok(_) | Err(RunError::Caller(())) => {}
        Err(RunError::Engine(error)) => return Err(error.into()),
        Err(RunError::Plan(error)) => return Err(error.into()),
    }
    let summary = state.lock().unwrap_or_else(PoisonError::into_inner).summary(study);
    Ok(Measured { engine, first, summary })
}
