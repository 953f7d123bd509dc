//! The engine of the product: the candidate pass in a compute shader, pushes and pops on the CPU.

use super::{Engine, EngineError, Job, WINDOW, batch};
use crate::candidates::Frame;
use crate::gpu::{AdapterSummary, Gpu as Adapter, GpuError, GpuPass};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many traces share a round unless told otherwise. Enough lanes to hide a dispatch's fixed cost of 60 to 250 us,
/// few enough that queries and readback (112 bytes a trace) stay in the cache.
const SLOTS: usize = 8192;

/// Evaluates traces on a GPU, for one model.
pub struct Gpu {
    pass: GpuPass,
    frame: Frame,
    window: usize,
}

impl Gpu {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of.
    pub fn new(adapter: Adapter, model: &Model) -> Result<Self, GpuError> {
        let frame = Frame::new(model);
        Ok(Gpu { pass: GpuPass::new(adapter, model, &frame, SLOTS)?, frame, window: WINDOW })
    }

    /// An engine on a pass of one's own making, for the same model: with another number of slots, say.
    pub fn with_pass(pass: GpuPass, frame: Frame) -> Self {
        Gpu { pass, frame, window: WINDOW }
    }

    /// The same engine with windows of at most `legs` legs, at least 1.
    #[must_use]
    pub fn window(mut self, legs: usize) -> Self {
        self.window = legs.max(1);
        self
    }

    /// The adapter on which it runs.
    pub fn adapter(&self) -> &AdapterSummary {
        self.pass.gpu().summary()
    }
}

impl Engine for Gpu {
    fn name(&self) -> &'static str {
        "gpu"
    }

    fn evaluate(&mut self, model: &Model, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        batch::evaluate(&mut self.pass, &self.frame, self.window, model, traces, job)
    }
}
