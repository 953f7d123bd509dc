//! The engine of the product: the candidate pass in a compute shader, pushes and pops on the CPU.

use super::{Engine, EngineError, Job, WINDOW, batch};
use crate::gpu::{AdapterSummary, Device, GpuError, GpuPass};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many traces share a round unless told otherwise. Enough lanes to hide a dispatch's fixed cost of 60 to 250 us,
/// few enough that queries and readback (112 bytes a trace) stay in the cache.
const SLOTS: usize = 8192;

/// Evaluates traces on a GPU, for one model.
pub struct Gpu<'m> {
    pass: GpuPass<'m>,
    window: usize,
}

impl<'m> Gpu<'m> {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of.
    pub fn new(device: Device, model: &'m Model) -> Result<Self, GpuError> {
        Ok(Self::with_pass(GpuPass::new(device, model, SLOTS)?))
    }

    /// An engine on a pass of one's own making, with another number of slots, say.
    pub fn with_pass(pass: GpuPass<'m>) -> Self {
        Gpu { pass, window: WINDOW }
    }

    /// The same engine with windows of at most `legs` legs, at least 1.
    #[must_use]
    pub fn window(mut self, legs: usize) -> Self {
        self.window = legs.max(1);
        self
    }

    /// The adapter on which it runs.
    pub fn adapter(&self) -> &AdapterSummary {
        self.pass.device().summary()
    }
}

impl Engine for Gpu<'_> {
    fn name(&self) -> &'static str {
        "gpu"
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        batch::evaluate(&mut self.pass, self.window, traces, job)
    }
}
