//! The window pipeline for machines without a GPU: one trace after the other on each thread.

use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use super::ends;
use super::table::Open;
use super::windows::Windows;
use super::{Engine, EngineError, EngineKind, Job, Phase, Precision, Promise, WINDOW};
use crate::candidates::{List, Lists, ROOM, Simd, Slopes};
use crate::rope::{EndsRecord, TraceRecord};
use crate::scene::{Model, Pivot};
use crate::trace::{SettledEnds, SettledTrace, bounds};
use crate::visibility::Scratch;

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

/// After how many steps of a trace the job is told of them, so that the threads do not fight for its counter.
const TELL: usize = 1 << 12;

/// How many lists each thread keeps at hand.
const RECENT: usize = 256;

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
        let lane = || Lane {
            engine: this,
            windows: Windows::new(),
            slopes: Slopes::default(),
            scratch: Scratch::default(),
            found: Vec::new(),
            recent: std::array::from_fn(|_| None),
        };
        traces.par_iter().map_init(lane, |lane, trace| lane.evaluate(trace, job)).collect()
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

/// What evaluates one trace after the other.
struct Lane<'e> {
    engine: &'e Cpu,
    windows: Windows,
    slopes: Slopes,
    scratch: Scratch,
    /// The candidates of the current window.
    found: Vec<u32>,
    /// The lists used last, by pivot: ropes come back to the pivots from which they came, and what a thread has at hand
    /// it need not ask the others for.
    recent: [Option<(Pivot, Arc<List>)>; RECENT],
}

impl Lane<'_> {
    fn evaluate(&mut self, trace: &SettledTrace, job: &Job) -> Result<TraceRecord, EngineError> {
        let Cpu { lists, window, simd, .. } = self.engine;
        let model = lists.model();
        self.windows.start(model, trace);
        let (mut told, mut tests) = (0, 0);
        loop {
            if let Some(record) = self.windows.finished(trace) {
                job.count(trace.step(self.windows.at()) - told);
                job.count_tests(tests as u64);
                return Ok(record);
            }
            job.go_on()?;
            let step = trace.step(self.windows.at());
            if step - told >= TELL {
                job.count(step - told);
                told = step;
            }
            let query =
                job.time(Phase::Queries, || self.windows.ask(lists.frame(), trace, *window, *simd, &mut self.slopes));
            if trace.breaks_rules() {
                // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
                let before = self.windows.at();
                self.windows.try_all(model, trace);
                tests += (self.windows.at() - before) * model.vertices().len();
                continue;
            }
            let pivot = self.windows.pivot(model);
            let squared = self.windows.squared(trace);
            let serves = |(of, list): &&(Pivot, Arc<List>)| *of == pivot && list.reaches(squared);
            let list = &mut self.recent[pivot.index() % RECENT];
            if list.as_ref().filter(serves).is_none()
                && let Some(own) = job.time(Phase::Queries, || lists.of(pivot, squared))
            {
                *list = Some((pivot, own));
            }
            self.found.clear();
            tests += job.time(Phase::Kernel, || match list.as_ref().filter(serves) {
                Some((_, list)) => {
                    let count = list.within(squared);
                    simd.sweep(list, &query, count, &mut self.found);
                    count
                }
                None => lists.look_into(pivot, &query, *simd, &mut self.scratch, &mut self.found),
            });
            if self.found.len() > ROOM && self.windows.narrow() {
                continue;
            }
            job.time(Phase::Update, || self.windows.go_on(model, trace, &self.found, *simd, &self.slopes));
        }
    }
}
