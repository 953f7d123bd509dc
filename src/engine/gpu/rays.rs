//! The note's method as it is written, for many ropes at once: each round, the device tries the rays of all vertices on
//! one leg of every rope, and the CPU pushes and pops.

use std::sync::Arc;

use super::rounds::{self, Asked, Astray, Player, Shared, Tools};
use crate::candidates::{Blocks, List, Lists, Query};
use crate::engine::table::Open;
use crate::engine::windows::Windows;
use crate::engine::{Engine, EngineError, EngineKind, Job, Phase, Precision, Promise};
use crate::gpu::{
    AdapterKind, AdapterSummary, Device, GpuError, GpuPass, HALVES, Kernel, RAYS_WGSL, TryingAll, Tuning,
};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The note's method as it is written, for many ropes at once: n + 1 tests a step.
pub static GPU_RAYS: EngineKind = EngineKind {
    name: "gpu-rays",
    about: "A compute shader tries every wall end in every step, the CPU pushes and pops: a measure of throughput",
    precisions: &[Precision::Certified],
    asks: false,
    both_ends: false,
    promise: Promise::Events,
    open: Open::Device(|device, model, _| Ok(Box::new(GpuRays::new(device, model)?))),
};

/// Evaluates traces on a GPU that tries all vertices in every step, for one model.
pub struct GpuRays {
    lists: Lists,
    pass: GpuPass<TryingAll>,
}

impl GpuRays {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of, or what of its f32 exact ropes cannot rely on.
    pub fn new(device: Device, model: Arc<Model>) -> Result<Self, GpuError> {
        let Tuning { queries, workgroup } = device.tuning();
        // A lane takes several queries. A software adapter shares workgroups out over its threads, so smaller ones keep
        // all of them busy; a GPU wants whole waves.
        let tuning = match device.summary().kind {
            AdapterKind::Software => Tuning { queries, workgroup: (workgroup / TryingAll::QUERIES).max(1) },
            _ => Tuning { queries, workgroup },
        };
        Self::with(device, model, tuning, RAYS_WGSL)
    }

    /// The same with `tuning` instead of what suits the adapter and `wgsl` instead of `rays.wgsl`.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), be it the shader or the memory.
    pub fn with(device: Device, model: Arc<Model>, tuning: Tuning, wgsl: &str) -> Result<Self, GpuError> {
        device.certify()?;
        let n = model.vertices().len();
        let lists = Lists::new(model).keep_all();
        let budget = device.memory();
        let pass = GpuPass::new(device, lists.keys(), n, budget, tuning, wgsl)?;
        Ok(GpuRays { lists, pass })
    }

    /// The adapter on which it runs.
    pub fn adapter(&self) -> &AdapterSummary {
        self.pass.device().summary()
    }
}

impl Engine for GpuRays {
    fn name(&self) -> &'static str {
        GPU_RAYS.name
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        rounds::evaluate::<OneLeg>(&mut self.pass, &self.lists, 1, traces, job)
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

/// A trace of which each leg is asked about by itself, and what is left of it again after each of its events.
struct OneLeg(Windows);

impl Player for OneLeg {
    type Kernel = TryingAll;

    fn new() -> Self {
        OneLeg(Windows::new())
    }

    fn start(&mut self, model: &Model, trace: &SettledTrace) {
        self.0.start(model, trace);
    }

    fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        self.0.finished(trace)
    }

    fn at(&self) -> usize {
        self.0.at()
    }

    fn ask(&mut self, shared: &Shared<'_>, trace: &SettledTrace, tools: &mut Tools) -> Option<Asked<TryingAll>> {
        let (lists, job) = (shared.lists, shared.job);
        let (model, list) = (lists.model(), lists.all());
        let query = job
            .time(Phase::Queries, || self.0.ask(lists.frame(), trace, shared.window, shared.simd, &mut tools.slopes));
        if trace.breaks_rules() {
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
            self.0.try_all(model, trace);
            job.count_tests(list.len() as u64);
            return None;
        }
        let pivot = self.0.pivot(model);
        let query = Query { count: list.len() as u32, ..query };
        Some(Asked { pivot, key: lists.key(pivot, list), list: Arc::clone(list), query })
    }

    fn answered(
        &mut self,
        shared: &Shared<'_>,
        trace: &SettledTrace,
        (list, query): (&List, &Query),
        blocks: &Blocks,
        tools: &mut Tools,
    ) -> Result<(), Astray> {
        let Tools { slopes, found, .. } = tools;
        found.clear();
        for ranks in blocks.ranks(list.len()) {
            shared.simd.sweep_some(list, query, ranks, found);
        }
        if found.is_empty() && self.0.is_quiet() {
            self.0.pass_by(trace);
        } else {
            self.0.recall(trace, shared.simd, slopes);
            self.0.go_on(shared.lists.model(), trace, found, shared.simd, slopes);
        }
        Ok(())
    }
}
