//! The engine of the product in a hurry: the compute shader decides in f32, and nothing confirms it.

use std::sync::Arc;

use super::deciding::Hasty;
use super::resident::NAME;
use super::rounds;
use crate::candidates::Lists;
use crate::engine::{Engine, EngineError, Job, Precision, WINDOW};
use crate::gpu::{AdapterSummary, DECIDE_WGSL, Deciding, Device, GpuError, GpuPass, HALVES, Tuning};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// Evaluates traces on a GPU that decides alone, in f32, for one model. See [`fast`](crate::fast) for what that is
/// worth.
///
/// A trace's record depends on the device and the scene, but not on the other traces nor on how many are on the device
/// at a time.
pub struct FastGpu {
    lists: Lists,
    pass: GpuPass<Deciding>,
    window: usize,
}

impl FastGpu {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of.
    pub fn new(device: Device, model: Arc<Model>) -> Result<Self, GpuError> {
        let tuning = device.tuning();
        Self::with(device, model, tuning, DECIDE_WGSL)
    }

    /// The same with `tuning` instead of what suits the adapter and `wgsl` instead of `decide.wgsl`.
    ///
    /// # Errors
    ///
    /// What the device complains of, be it the shader or the memory.
    pub fn with(device: Device, model: Arc<Model>, tuning: Tuning, wgsl: &str) -> Result<Self, GpuError> {
        // A list is made on first use, since no CPU answers in the device's place. `cover` is never called, so that a
        // record does not depend on how far the other traces of its batch go.
        let n = model.vertices().len();
        let lists = Lists::new(model).after(0);
        let budget = device.memory();
        let pass = GpuPass::new(device, lists.keys(), n, budget, tuning, wgsl)?;
        Ok(FastGpu { lists, pass, window: WINDOW })
    }

    /// The same engine with windows of at most `legs` legs, at least 1.
    #[must_use]
    pub fn window(mut self, legs: usize) -> Self {
        self.window = legs.max(1);
        self
    }

    /// The same engine, trying all vertices in every query, not only those that the pivot sees and at which ropes can
    /// turn.
    #[must_use]
    pub fn keep_all(mut self) -> Self {
        self.lists = self.lists.keep_all();
        self.pass.forget();
        self
    }

    /// The adapter on which it runs.
    pub fn adapter(&self) -> &AdapterSummary {
        self.pass.device().summary()
    }
}

impl Engine for FastGpu {
    fn name(&self) -> &'static str {
        NAME
    }

    fn precision(&self) -> Option<Precision> {
        Some(Precision::Fast)
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        rounds::evaluate::<Hasty>(&mut self.pass, &self.lists, self.window, traces, job)
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
