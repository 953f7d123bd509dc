//! The batch pipeline for machines without a GPU: the candidate pass on threads.

use super::{Engine, EngineError, Job, WINDOW, batch};
use crate::candidates::CpuPass;
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many traces share a round: enough to keep all cores busy between the round's barriers.
const SLOTS: usize = 4096;

/// Evaluates traces on all cores, for one model.
pub struct Cpu<'m> {
    pass: CpuPass<'m>,
    window: usize,
}

impl<'m> Cpu<'m> {
    /// An engine for `model`.
    pub fn new(model: &'m Model) -> Self {
        Self::with_slots(model, SLOTS)
    }

    /// An engine that evaluates at most `slots` traces at a time, at least 1.
    pub fn with_slots(model: &'m Model, slots: usize) -> Self {
        Cpu { pass: CpuPass::new(model, slots), window: WINDOW }
    }

    /// The same engine with windows of at most `legs` legs, at least 1.
    #[must_use]
    pub fn window(mut self, legs: usize) -> Self {
        self.window = legs.max(1);
        self
    }
}

impl Engine for Cpu<'_> {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        batch::evaluate(&mut self.pass, self.window, traces, job)
    }
}
