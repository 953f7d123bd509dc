//! What every trace really comes to, and how far from that a method is.

use schemars::JsonSchema;
use serde::Serialize;

use crate::engine::{Cpu, Engine, Job, REFERENCE, Reference};
use crate::lab::bench::Disagreement;
use crate::rope::{Event, EventKind, Side, TraceRecord};
use crate::scene::Model;
use crate::study::Moments;
use crate::trace::SettledTrace;

use super::setting::Variant;
use super::{Method, TradeoffError};

/// How many vertices the reference may try to vouch for the truth, about: a second's work.
const TESTS: u64 = 1 << 27;

/// The records of the exact reference for all traces.
pub(super) struct Truth<'v> {
    model: &'v Model,
    records: Vec<TraceRecord>,
    /// For how many of them, from the first on, the scalar reference itself was asked.
    pub vouched: usize,
}

/// An event, so that those of scenes with other vertex numbers can be compared: step, kind, place, side.
type Happened = (u32, EventKind, [u64; 2], Side);

impl<'v> Truth<'v> {
    /// By the engine `cpu`, which gives the reference's records; and for the first traces by the reference, as many as
    /// take about a second.
    ///
    /// # Errors
    ///
    /// Engines that fail, and two exact ones that differ.
    pub(super) fn of(exact: &'v Variant) -> Result<Self, TradeoffError> {
        let model = &exact.model;
        let records = Cpu::new(model.clone()).evaluate(&exact.traces, &Job::new())?;
        let mut tests = 0;
        let affordable = |trace: &&SettledTrace| {
            tests += trace.steps() as u64 * model.vertices().len() as u64;
            tests <= TESTS
        };
        let vouched = exact.traces.iter().take_while(affordable).count().max(1).min(exact.traces.len());
        let asked = Reference::new(model.clone()).evaluate(&exact.traces[..vouched], &Job::new())?;
        let truth = Truth { model, records, vouched };
        match asked.iter().zip(&truth.records).find(|(one, other)| one != other) {
            Some((record, _)) => Err(truth.disagreement(REFERENCE.name, record.trace).into()),
            None => Ok(truth),
        }
    }

    /// Compares the records of the first traces as `variant` has them.
    pub(super) fn score(&self, variant: &Variant, records: &[TraceRecord]) -> Score {
        let mut score = Score::default();
        for ((record, truth), trace) in records.iter().zip(&self.records).zip(&variant.traces) {
            let right = truth.events.iter().map(|e| happened(self.model, e, next_used(trace, e.step)));
            let given = record.events.iter().map(|e| happened(&variant.model, e, e.step));
            score.event_mismatch += usize::from(!right.eq(given));
            score.final_mismatch += usize::from(!same_rope(record, truth));
            score.length_error.add(length_error(record, truth));
            score.length.add(record.length, truth.length);
            score.wraps.add(wraps(record), wraps(truth));
        }
        score
    }

    /// The first of these records, of traces as they are, that breaks what its method promises.
    pub(super) fn broken(&self, method: &Method, records: &[TraceRecord]) -> Option<Disagreement> {
        let breaks = |(record, truth): &(&TraceRecord, &TraceRecord)| {
            if method.promises_events() { record != truth } else { !same_rope(record, truth) }
        };
        let first = records.iter().zip(&self.records).find(breaks).filter(|_| method.promises_ropes());
        first.map(|(record, _)| self.disagreement(method.name, record.trace))
    }

    fn disagreement(&self, other: &str, trace: u64) -> Disagreement {
        let what = "their ropes or events are different ones".to_owned();
        Disagreement { one: "cpu certified".to_owned(), other: other.to_owned(), trace, what }
    }
}

fn happened(model: &Model, event: &Event, step: u32) -> Happened {
    let place = model.vertices()[event.vertex as usize].to_array().map(f64::to_bits);
    (step, event.kind, place, event.side)
}

/// The first step of the trace that is used and is not before `step`: what happens in between is known there.
fn next_used(trace: &SettledTrace, step: u32) -> u32 {
    let (mut low, mut high) = (0, trace.points().len() - 1);
    while low < high {
        let middle = (low + high) / 2;
        if (trace.step(middle) as u32) < step { low = middle + 1 } else { high = middle }
    }
    trace.step(low) as u32
}

fn same_rope(one: &TraceRecord, other: &TraceRecord) -> bool {
    one.wraps == other.wraps
}

/// The error of the length at the end as a share of that length; of the greatest length where the end is at the anchor.
fn length_error(record: &TraceRecord, truth: &TraceRecord) -> f64 {
    let error = (record.length - truth.length).abs();
    let length = if truth.length > 0.0 { truth.length } else { truth.max_length };
    if error == 0.0 { 0.0 } else { error / length }
}

fn wraps(record: &TraceRecord) -> f64 {
    record.events.iter().filter(|e| e.kind == EventKind::Wrap).count() as f64
}

/// How far from the truth a method is on the traces on which it ran.
#[derive(Default)]
pub(super) struct Score {
    pub event_mismatch: usize,
    pub final_mismatch: usize,
    pub length_error: Moments,
    pub length: Paired,
    pub wraps: Paired,
}

/// A number of every trace, as a method has it and as it is.
#[derive(Default)]
pub(super) struct Paired {
    given: Moments,
    right: Moments,
}

impl Paired {
    fn add(&mut self, given: f64, right: f64) {
        self.given.add(given);
        self.right.add(right);
    }

    pub(super) fn answer(&self) -> Answer {
        let error = self.right.variance().map(|v| (v / self.right.count as f64).sqrt());
        Answer { value: self.given.mean, truth: self.right.mean, sampling: error }
    }
}

/// What a study would say: a mean over the traces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Answer {
    /// By the method.
    pub value: f64,
    /// By the exact reference, over the same traces.
    pub truth: f64,
    /// The standard error of the exact mean because the traces are a sample; `None` for fewer than two.
    #[serde(rename = "sampling_error")]
    pub sampling: Option<f64>,
}

impl Answer {
    /// The method's error as a share of the truth; infinite where that is 0 and the method's is not.
    pub fn error(&self) -> f64 {
        share(self.value - self.truth, self.truth)
    }

    /// The sample's error as such a share.
    pub fn noise(&self) -> Option<f64> {
        self.sampling.map(|error| share(error, self.truth))
    }
}

fn share(part: f64, whole: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / whole.abs() }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::setting::{Setting, Work};
    use super::*;
    use crate::scene::Scene;
    use crate::trace::Trace;

    /// One wall east of the anchor, and a trace that goes up past its end and comes back, twice as far.
    fn variant() -> Variant {
        let wall = [[1.0, -1.0], [1.0, 0.5]].map(DVec2::from);
        let model = Model::new(Scene::new([wall]).unwrap(), Some(DVec2::ZERO)).unwrap();
        let up = [[0.0, 0.0], [0.5, 1.0], [1.5, 1.0], [2.0, 0.5], [2.0, 0.0], [2.0, -0.5]];
        let points: Vec<DVec2> = up.map(DVec2::from).into();
        let traces = vec![Trace { id: 0, points: points.clone() }, Trace { id: 1, points: points[..3].into() }];
        let work = Work { scene: "one wall".to_owned(), model: model.into(), traces };
        Variant::exact(&work).unwrap()
    }

    #[test]
    fn errors_are_counted() {
        let exact = variant();
        let truth = Truth::of(&exact).unwrap();
        assert_eq!(truth.vouched, 2);
        let right = truth.records.clone();
        assert_eq!((right[0].events.len(), right[0].depth, right[1].events.len()), (1, 1, 0));
        let score = truth.score(&exact, &right);
        assert_eq!((score.event_mismatch, score.final_mismatch, score.length_error.max), (0, 0, 0.0));

        let mut late = right.clone();
        late[0].events[0].step += 1;
        let score = truth.score(&exact, &late);
        assert_eq!((score.event_mismatch, score.final_mismatch), (1, 0));

        let mut wrong = right.clone();
        wrong[0].wraps[0].1 = Side::Left;
        wrong[1].length = 1.5 * right[1].length;
        let score = truth.score(&exact, &wrong);
        assert_eq!((score.event_mismatch, score.final_mismatch), (0, 1));
        assert!((score.length_error.max - 0.5).abs() < 1e-12 && (score.length_error.mean - 0.25).abs() < 1e-12);
        let answer = score.length.answer();
        assert_eq!(answer.truth, (right[0].length + right[1].length) / 2.0);
        assert!((answer.error() - 0.5 * right[1].length / (right[0].length + right[1].length)).abs() < 1e-12);
        assert!(answer.noise().unwrap() > 0.0);
        assert_eq!(score.wraps.answer().truth, 0.5);
    }

    #[test]
    fn a_broken_promise_is_found() {
        let exact = variant();
        let truth = Truth::of(&exact).unwrap();
        let method = |name: &str| Method::ALL.into_iter().find(|m| m.name == name).unwrap();
        let mut late = truth.records.clone();
        late[0].events[0].step += 1;
        let found = truth.broken(&method("gpu certified"), &late).unwrap();
        assert_eq!((found.trace, found.other.as_str()), (0, "gpu certified"));
        // The funnel promises ropes, and fast nothing.
        assert_eq!(truth.broken(&method("funnel, every step"), &late), None);
        late[0].wraps.clear();
        assert_eq!(truth.broken(&method("funnel, every step"), &late).unwrap().trace, 0);
        assert_eq!(truth.broken(&method("gpu fast"), &late), None);
    }

    #[test]
    fn what_happens_between_used_points_is_known_at_the_next() {
        let exact = variant();
        let trace = &exact.traces[0];
        assert_eq!([0, 1, 3, 5].map(|step| next_used(trace, step)), [0, 1, 3, 5]);
        // A shorter length than none is a share of the greatest.
        let mut home = Truth::of(&exact).unwrap().records[0].clone();
        (home.length, home.max_length) = (0.0, 4.0);
        assert_eq!(length_error(&TraceRecord { length: 1.0, ..home.clone() }, &home), 0.25);
        assert_eq!(length_error(&home, &home), 0.0);
        assert_eq!(Setting::EXACT.stride(), 1);
    }
}
