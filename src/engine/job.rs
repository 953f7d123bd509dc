//! A running evaluation as seen from outside: how far it is, what it did, and the wish that it stop.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::error::EngineError;

/// A part of an evaluation's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Folding windows of steps into queries, the making of the pivots' lists included.
    Queries,
    /// Handing queries to the device.
    Upload,
    /// The candidate pass.
    Kernel,
    /// Waiting for what the device found and copying it.
    Readback,
    /// Exact updates.
    Update,
}

impl Phase {
    /// All phases, in the order of a round.
    pub const ALL: [Phase; 5] = [Phase::Queries, Phase::Upload, Phase::Kernel, Phase::Readback, Phase::Update];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Queries => "queries",
            Phase::Upload => "upload",
            Phase::Kernel => "kernel",
            Phase::Readback => "readback",
            Phase::Update => "update",
        }
    }
}

/// After how many steps of a trace the job is told of them, so that the threads do not fight for its counter.
pub(super) const TELL: usize = 1 << 12;

/// A running evaluation as seen from outside.
#[derive(Debug, Default)]
pub struct Job {
    steps: AtomicU64,
    tests: AtomicU64,
    doubts: AtomicU64,
    stop: AtomicBool,
    timed: bool,
    nanoseconds: [AtomicU64; Phase::ALL.len()],
}

impl Job {
    /// A job that nothing has been done of.
    pub fn new() -> Self {
        Job::default()
    }

    /// A job whose phases are timed. Reading the clock slows engines down, so it is off unless asked for.
    pub fn timed() -> Self {
        Job { timed: true, ..Job::default() }
    }

    /// How many steps of traces are done.
    pub fn steps(&self) -> u64 {
        self.steps.load(Ordering::Relaxed)
    }

    /// How many vertices have been tried in all, by the candidate pass or, in engines without one, by the update; a
    /// look through a triangle of the scene's triangulation tries one. Engines that try no vertices report 0.
    pub fn tests(&self) -> u64 {
        self.tests.load(Ordering::Relaxed)
    }

    /// How many steps the CPU has decided for a device that was not certain of them.
    pub fn doubts(&self) -> u64 {
        self.doubts.load(Ordering::Relaxed)
    }

    /// The time spent in a phase, summed over threads; zero unless the job is [timed](Self::timed) and the engine has
    /// the phase.
    pub fn phase(&self, phase: Phase) -> Duration {
        Duration::from_nanos(self.nanoseconds[phase as usize].load(Ordering::Relaxed))
    }

    /// Asks the engine to end with [`EngineError::Stopped`] as soon as it can.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(crate) fn count(&self, steps: usize) {
        self.steps.fetch_add(steps as u64, Ordering::Relaxed);
    }

    pub(crate) fn count_tests(&self, tests: u64) {
        self.tests.fetch_add(tests, Ordering::Relaxed);
    }

    pub(crate) fn count_doubts(&self, steps: usize) {
        self.doubts.fetch_add(steps as u64, Ordering::Relaxed);
    }

    pub(crate) fn is_timed(&self) -> bool {
        self.timed
    }

    pub(crate) fn go_on(&self) -> Result<(), EngineError> {
        if self.stop.load(Ordering::Relaxed) { Err(EngineError::Stopped) } else { Ok(()) }
    }

    /// Does `work` and adds the time it takes to `phase`, if the job is timed.
    #[inline]
    pub(crate) fn time<T>(&self, phase: Phase, work: impl FnOnce() -> T) -> T {
        if !self.timed {
            return work();
        }
        let start = Instant::now();
        let done = work();
        self.nanoseconds[phase as usize].fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }
}
