//! What tallies count: traces with their ropes, in blocks.

use std::borrow::Cow;

use glam::DVec2;

use super::setting::Setting;
use crate::rope::{Lasting, TraceRecord, spans};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// A trace and what became of it.
pub(crate) struct Traced<'a> {
    pub trace: &'a SettledTrace,
    pub record: &'a TraceRecord,
    /// The scene with the trace's anchor, and the anchor's number.
    pub model: &'a Model,
    pub anchor: usize,
    /// Where the free end is after each step.
    pub ends: Cow<'a, [DVec2]>,
}

impl<'a> Traced<'a> {
    pub(crate) fn new(setting: &'a Setting, trace: &'a SettledTrace, record: &'a TraceRecord) -> Self {
        let anchor = setting.anchor(record.trace);
        Traced { trace, record, model: &setting.models[anchor], anchor, ends: trace.ends() }
    }

    /// Calls `each` with what lasts over some steps: the rope between events, and its contacts. O(events).
    pub(super) fn spans(&self, each: impl FnMut(Lasting<'_>)) {
        spans(self.model.anchor(), self.model.vertices(), self.record.steps, &self.record.events, each);
    }
}

/// How large a block is that is whole.
pub(crate) struct Size {
    pub number: u64,
    pub traces: u64,
    /// The number of steps after which a rope was looked at: one more for each trace than it has steps.
    pub looks: u64,
}
