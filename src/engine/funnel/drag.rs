//! One trace on its way.

use super::chains::Chains;
use super::log::Log;
use super::mesh::Mesh;
use super::word::Word;
use crate::engine::{EngineError, Job};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many legs are followed between two looks at the job.
const LEGS_PER_LOOK: usize = 4096;

/// The state of one trace's evaluation; made once a thread, or a few times, and reset for each trace.
#[derive(Debug, Default)]
pub(super) struct Drag {
    word: Word,
    chains: Chains,
    log: Log,
}

impl Drag {
    /// The record of `trace`; of its final rope only, if `final_only`.
    pub(super) fn evaluate(
        &mut self,
        model: &Model,
        mesh: &Mesh,
        trace: &SettledTrace,
        final_only: bool,
        job: &Job,
    ) -> Result<TraceRecord, EngineError> {
        self.word.start(mesh, trace.point(0));
        self.chains.start(model.anchor());
        self.log.start(&self.chains);
        let last = trace.points().len() - 1;
        let mut from = 0;
        job.go_on()?;
        while from < last {
            let to = last.min(from + LEGS_PER_LOOK);
            if final_only {
                for i in from + 1..=to {
                    self.word.follow(mesh, trace, i);
                }
            } else {
                self.follow(mesh, trace, from, to);
            }
            job.count(trace.step(to) - trace.step(from));
            job.go_on()?;
            from = to;
        }
        if final_only {
            self.tighten(mesh);
            self.see(trace, last, trace.steps());
        }
        Ok(self.log.record(model, trace))
    }

    /// Follows the legs from point `from` to point `to` and sees the taut rope after every step.
    fn follow(&mut self, mesh: &Mesh, trace: &SettledTrace, from: usize, to: usize) {
        // Most traces touch nothing: then the only point added, if any, is the anchor, at the start.
        let anchor = usize::from(!trace.ends_step(0));
        let is_usual = !trace.is_thinned() && trace.points().len() - 1 - trace.steps() == anchor;
        for i in from + 1..=to {
            if self.word.follow(mesh, trace, i) {
                self.tighten(mesh);
            }
            if is_usual {
                self.see(trace, i, i - anchor);
            } else if trace.ends_step(i) {
                self.see(trace, i, trace.step(i));
            }
        }
    }

    /// Brings the funnel up to the word.
    fn tighten(&mut self, mesh: &Mesh) {
        let kept = self.word.take_kept();
        self.chains.follow(mesh, self.word.doors(), kept);
    }

    #[inline]
    fn see(&mut self, trace: &SettledTrace, i: usize, step: usize) {
        let a = trace.points()[i];
        let tip = self.chains.tip(a);
        self.log.see(&self.chains, tip, a, step);
    }
}
