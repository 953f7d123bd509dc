//! The candidate pass in a compute shader, window by window; pushes and pops on the CPU.

use std::sync::Arc;

use super::rounds;
use crate::candidates::Lists;
use crate::engine::table::Open;
use crate::engine::windows::Windows;
use crate::engine::{Engine, EngineError, EngineKind, Job, Precision, Promise, WINDOW};
use crate::gpu::{AdapterSummary, Device, GpuError, GpuPass, HALVES, SWEEP_WGSL, Tuning};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::{SettledTrace, bounds};

/// The candidate pass in a compute shader, window by window.
pub static GPU_WINDOWS: EngineKind = EngineKind {
    name: "gpu-windows",
    about: "A compute shader finds candidates, window by window, the CPU decides all events",
    precisions: &[Precision::Certified],
    asks: true,
    both_ends: false,
    promise: Promise::Events,
    open: Open::Device(|device, model, options| Ok(Box::new(GpuWindows::new(device, model)?.window(options.window)))),
};

/// Evaluates traces on a GPU that finds candidates, for one model.
pub struct GpuWindows {
    lists: Lists,
    pass: GpuPass,
    window: usize,
}

impl GpuWindows {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of, or what of its f32 exact ropes cannot rely on.
    pub fn new(device: Device, model: Arc<Model>) -> Result<Self, GpuError> {
        let tuning = device.tuning();
        let budget = device.memory();
        Self::with(device, Lists::new(model), budget, tuning, SWEEP_WGSL)
    }

    /// An engine that tries the vertices of `lists` and keeps up to `budget` bytes of them on the device. `tuning`
    /// takes the place of what suits the adapter, `wgsl` that of `sweep.wgsl`.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), be it the shader or the memory.
    pub fn with(device: Device, lists: Lists, budget: usize, tuning: Tuning, wgsl: &str) -> Result<Self, GpuError> {
        device.certify()?;
        let n = lists.model().vertices().len();
        let pass = GpuPass::new(device, lists.keys(), n, budget, tuning, wgsl)?;
        Ok(GpuWindows { lists, pass, window: WINDOW })
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

    /// The pass that it runs.
    pub fn pass(&self) -> &GpuPass {
        &self.pass
    }

    /// The lists that it has made so far.
    pub fn lists(&self) -> &Lists {
        &self.lists
    }
}

impl Engine for GpuWindows {
    fn name(&self) -> &'static str {
        GPU_WINDOWS.name
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        if bounds(traces).is_some_and(|bounds| self.lists.cover(bounds)) {
            self.pass.forget();
        }
        rounds::evaluate::<Windows>(&mut self.pass, &self.lists, self.window, traces, job)
    }

    fn batch(&self) -> usize {
        HALVES * self.pass.capacity()
    }

    fn remaining(&self) -> Option<usize> {
        self.lists.remaining_count()
    }

    fn forget(&mut self) {
        self.lists.forget();
        self.pass.forget();
    }
}
