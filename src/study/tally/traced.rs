//! What tallies count: traces with their ropes, in blocks.

use std::borrow::Cow;

use glam::DVec2;

use super::setting::Setting;
use crate::rope::{Lasting, TraceRecord, lasting};
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
    /// The rope between events, and its contacts.
    pub lasting: Lasting,
}

impl<'a> Traced<'a> {
    /// O(events), and O(steps) if points were added to the trace.
    pub(crate) fn new(setting: &'a Setting, trace: &'a SettledTrace, record: &'a TraceRecord) -> Self {
        let anchor = setting.anchor(record.trace);
        let model = &setting.models[anchor];
        let lasting = lasting(model.anchor(), model.vertices(), record.steps, &record.events);
        Traced { trace, record, model, anchor, ends: trace.ends(), lasting }
    }
}

/// How large a block is that is whole.
pub(crate) struct Size {
    pub number: u64,
    pub traces: u64,
    /// The number of steps after which a rope was looked at: one more for each trace than it has steps.
    pub looks: u64,
}
