//! The arbiter: scalar, one trace and one step after the other, every vertex tried at every step, exact predicates.

use std::sync::Arc;

use super::ends;
use super::progress::Progress;
use super::table::Open;
use super::{Engine, EngineError, EngineKind, Job, Precision, Promise};
use crate::rope::{EndsRecord, TraceRecord};
use crate::scene::Model;
use crate::trace::{SettledEnds, SettledTrace};

/// The arbiter.
pub static REFERENCE: EngineKind = EngineKind {
    name: "reference",
    about: "One trace and one step after the other, every vertex tried: the arbiter",
    precisions: &[Precision::Certified],
    asks: false,
    both_ends: true,
    promise: Promise::Events,
    open: Open::Thread(|model| Box::new(Reference::new(model))),
};

/// The engine that all others are checked against. O(vertices) for each step and each event, on one thread.
#[derive(Clone)]
pub struct Reference {
    model: Arc<Model>,
}

impl Reference {
    /// An engine for `model`.
    pub fn new(model: Arc<Model>) -> Self {
        Reference { model }
    }
}

impl Engine for Reference {
    fn name(&self) -> &'static str {
        REFERENCE.name
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        let model = &*self.model;
        let all = 0..model.vertices().len() as u32;
        let mut progress = Progress::new();
        let mut records = Vec::with_capacity(traces.len());
        for trace in traces {
            progress.start(model, trace);
            while !progress.is_done(trace) {
                job.go_on()?;
                let before = trace.step(progress.at);
                progress.next(model, trace, all.clone());
                job.count(trace.step(progress.at) - before);
                job.count_tests(all.len() as u64);
            }
            records.push(progress.record(trace));
        }
        Ok(records)
    }

    fn evaluate_ends(&mut self, traces: &[SettledEnds], job: &Job) -> Result<Vec<EndsRecord>, EngineError> {
        traces.iter().map(|trace| ends::evaluate(&self.model, trace, job, ends::all(&self.model))).collect()
    }
}
