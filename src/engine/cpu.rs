//! The window pipeline for machines without a GPU: one trace after the other on each thread.

use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use super::ends;
use super::hand::Hand;
use super::table::Open;
use super::windows::Windows;
use super::{Engine, EngineError, EngineKind, Job, Precision, Promise, WINDOW};
use crate::candidates::{Lists, Simd};
use crate::rope::{EndsRecord, TraceRecord};
use crate::scene::Model;
use crate::trace::{SettledEnds, SettledTrace, bounds};

/// The engine for machines without a GPU.
pub static CPU: EngineKind = EngineKind {
    name: "cpu",
    about: "The same on threads",
    precisions: &[Precision::Certified],
    asks: true,
    both_ends: true,
    promise: Promise::Events,
    open: Open::Threads(|model, options| Box::new(Cpu::new(model).window(options.window))),
};

/// Evaluates traces on all cores, for one model.
pub struct Cpu {
    lists: Lists,
    /// For ropes whose ends both move, wherever they start; made when there is one.
    anywhere: OnceLock<Lists>,
    window: usize,
    simd: Simd,
}

impl Cpu {
    /// An engine for `model`.
    pub fn new(model: Arc<Model>) -> Self {
        Self::with_lists(Lists::new(model))
    }

    /// An engine that tries the vertices of `lists`.
    pub fn with_lists(lists: Lists) -> Self {
        Cpu { lists, anywhere: OnceLock::new(), window: WINDOW, simd: Simd::detected() }
    }

    /// The same engine with windows of at most `legs` legs, at least 1.
    #[must_use]
    pub fn window(mut self, legs: usize) -> Self {
        self.window = legs.max(1);
        self
    }

    /// The same engine with another instruction set.
    #[must_use]
    pub fn simd(mut self, simd: Simd) -> Self {
        self.simd = simd;
        self
    }

    /// The same engine, trying all vertices in every query, not only those that the pivot sees and at which ropes can
    /// turn.
    #[must_use]
    pub fn keep_all(mut self) -> Self {
        self.lists = self.lists.keep_all();
        self
    }

    /// The lists that it has made so far.
    pub fn lists(&self) -> &Lists {
        &self.lists
    }
}

impl Engine for Cpu {
    fn name(&self) -> &'static str {
        CPU.name
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        if let Some(bounds) = bounds(traces) {
            self.lists.cover(bounds);
        }
        let this = &*self;
        let hand = || (Hand::new(&this.lists, this.window, this.simd), Windows::new());
        traces.par_iter().map_init(hand, |(hand, windows), trace| hand.evaluate(windows, trace, job)).collect()
    }

    fn evaluate_ends(&mut self, traces: &[SettledEnds], job: &Job) -> Result<Vec<EndsRecord>, EngineError> {
        let lists = self.anywhere.get_or_init(|| self.lists.anywhere());
        let find = |about: ends::About, leg: [DVec2; 2], tried: &mut Vec<u32>| ends::listed(lists, about, leg, tried);
        traces.par_iter().map(|trace| ends::evaluate(lists.model(), trace, job, find)).collect()
    }

    fn remaining(&self) -> Option<usize> {
        self.lists.remaining_count()
    }

    fn forget(&mut self) {
        self.lists.forget();
        self.anywhere.take();
    }
}
