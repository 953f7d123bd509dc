//! Evaluates batch after batch.

use std::time::{Duration, Instant};

use super::{Batch, Batches, Files, StreamError};
use crate::engine::{Engine, Job};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// What to do with a trace that breaks the small update condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnViolation {
    /// End with the first.
    Error,
    /// Mark such traces in the results and go on.
    Flag,
}

/// How long the parts of a run took. They go on at the same time, so their sum may be more than the whole.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    /// Reading and checking traces.
    pub prepared: Duration,
    /// The engine.
    pub evaluated: Duration,
    /// Writing results and events.
    pub written: Duration,
}

/// How far a stream is: said twice of each batch. It is one of settled traces `T`, of which records `R` come.
pub enum Stage<'a, T = SettledTrace, R = TraceRecord> {
    /// The batch is about to be evaluated.
    Read {
        /// Its traces.
        settled: &'a [T],
        /// How much of the source has been read with it, in the unit of its size.
        position: u64,
    },
    /// It is evaluated, and about to be written.
    Evaluated {
        /// Its traces.
        settled: &'a [T],
        /// What became of them, in the same order.
        records: &'a [R],
    },
}

impl<T, R> Stage<'_, T, R> {
    /// What became of the batch's traces; nothing before they are evaluated.
    pub fn records(&self) -> &[R] {
        match self {
            Stage::Read { .. } => &[],
            Stage::Evaluated { records, .. } => records,
        }
    }
}

/// Evaluates all `batches` and has their ropes written to `files`, which appear at the end, all or none. `watch` is
/// told of each batch when it is read and when it is evaluated. The job may be stopped from another thread. Memory is
/// bounded by two batches, and by a third where the files want every step.
///
/// # Errors
///
/// What can go wrong with the traces, the engine or the files; the first trace that breaks the rules, if it is to end
/// the run; [`EngineError::Stopped`](crate::engine::EngineError::Stopped) when the job was stopped.
pub fn evaluate(
    mut batches: Batches,
    engine: &mut dyn Engine,
    mut files: Files,
    on_violation: OnViolation,
    job: &Job,
    mut watch: impl FnMut(Stage<'_>),
) -> Result<Times, StreamError> {
    let mut times = Times::default();
    while let Some(Batch { settled, position, prepared }) = batches.next()? {
        if let (OnViolation::Error, Some(first)) = (on_violation, settled.iter().find_map(|t| t.violation())) {
            return Err(StreamError::Violation(Box::new(*first)));
        }
        watch(Stage::Read { settled: &settled, position });
        times.prepared += prepared;
        let start = Instant::now();
        let records = engine.evaluate(&settled, job)?;
        times.evaluated += start.elapsed();
        watch(Stage::Evaluated { settled: &settled, records: &records });
        files.write(settled, records)?;
    }
    times.written = files.finish()?;
    Ok(times)
}
