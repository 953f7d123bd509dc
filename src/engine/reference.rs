//! The arbiter: scalar, one trace and one step after the other, every vertex tried at every step, exact predicates.

use super::walk::Walk;
use super::{Engine, EngineError, Job};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The engine that all others are checked against. O(vertices) for each step and each event, on one thread.
#[derive(Debug, Default, Clone, Copy)]
pub struct Reference;

impl Engine for Reference {
    fn name(&self) -> &'static str {
        "reference"
    }

    fn evaluate(&mut self, model: &Model, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        let all = 0..model.vertices().len() as u32;
        let mut walk = Walk::new();
        let mut records = Vec::with_capacity(traces.len());
        for trace in traces {
            walk.start(model, trace);
            while !walk.is_done(trace) {
                job.go_on()?;
                if walk.next(model, trace, all.clone()).is_none() {
                    job.count(1);
                }
            }
            records.push(walk.record(trace));
        }
        Ok(records)
    }
}
