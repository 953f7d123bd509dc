//! Whether engines that promise the same results have given them.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::contender::Contender;
use crate::engine::Promise;
use crate::rope::{Side, TraceRecord};
use crate::words::plainly;

/// Two engines that promise the same results and gave different ones.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{one} and {other} disagree on trace {trace}: {what}. One of them is wrong, so nothing is reported")]
pub struct Disagreement {
    /// The contender that came first.
    pub one: String,
    /// The one that differs from it.
    pub other: String,
    /// The trace's number.
    pub trace: u64,
    /// What differs, in words: the first contender's, then the other's.
    pub what: String,
}

/// What every trace came to, from the first contender that promises it.
pub(super) struct Agreement {
    ropes: Vec<Option<Known<Rope>>>,
    events: Vec<Option<Known<Events>>>,
}

/// A taut rope: vertex positions by their bits, and sides.
type Rope = Vec<([u64; 2], Side)>;

/// The number of events, and a hash of them in order.
type Events = (usize, u64);

/// A result and the contender that gave it.
struct Known<T> {
    by: Contender,
    result: T,
}

impl Agreement {
    /// Nothing is known yet of `traces` traces.
    pub(super) fn new(traces: usize) -> Self {
        Agreement { ropes: (0..traces).map(|_| None).collect(), events: (0..traces).map(|_| None).collect() }
    }

    /// Compares the records of the first traces with what is known and learns from them, if `by` promises anything.
    /// Returns how many ropes at the end are wrong, for a contender that promises nothing.
    pub(super) fn check(&mut self, by: Contender, records: &[TraceRecord]) -> Result<Option<usize>, Disagreement> {
        if by.promise() == Promise::Nothing {
            let wrong = |(record, known): (_, &Option<Known<Rope>>)| Some(rope(record) != known.as_ref()?.result);
            let judged: Option<Vec<bool>> = records.iter().zip(&self.ropes).map(wrong).collect();
            return Ok(judged.map(|judged| judged.into_iter().filter(|wrong| *wrong).count()));
        }
        for (i, record) in records.iter().enumerate() {
            agree(&mut self.ropes[i], by, record, rope(record), |ours, theirs| match (ours.len(), theirs.len()) {
                (ours, theirs) if ours == theirs => format!("its {ours} turns at the end are different ones"),
                (ours, theirs) => format!("depths {ours} and {theirs} at the end"),
            })?;
            if by.promise() == Promise::Events {
                agree(&mut self.events[i], by, record, events(record), |ours, theirs| match (ours.0, theirs.0) {
                    (ours, theirs) if ours == theirs => format!("its {ours} events are different ones"),
                    (ours, theirs) => format!("{ours} and {}", plainly(theirs as u64, "event", "events")),
                })?;
            }
        }
        Ok(None)
    }
}

/// Compares `result` with what is known, or makes it known.
fn agree<T: PartialEq>(
    known: &mut Option<Known<T>>,
    by: Contender,
    record: &TraceRecord,
    result: T,
    what: impl Fn(&T, &T) -> String,
) -> Result<(), Disagreement> {
    match known {
        None => *known = Some(Known { by, result }),
        Some(known) if known.result == result => {}
        Some(known) => {
            let (one, other) = (known.by.name(), by.name());
            return Err(Disagreement { one, other, trace: record.trace, what: what(&known.result, &result) });
        }
    }
    Ok(())
}

fn rope(record: &TraceRecord) -> Rope {
    record.wraps.iter().map(|(at, side)| (at.to_array().map(f64::to_bits), *side)).collect()
}

fn events(record: &TraceRecord) -> Events {
    let mut hasher = DefaultHasher::new();
    record.events.hash(&mut hasher);
    (record.events.len(), hasher.finish())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::engine::{Engine, Job, Reference};
    use crate::example::{BuiltIn, Walker, settled_walks};
    use crate::lab::bench::{CPU, FUNNEL, GPU, NOTE, REFERENCE};
    use crate::scene::Model;

    fn records() -> Vec<TraceRecord> {
        let model = Arc::new(Model::new(BuiltIn::Random(50).scene(1), None).unwrap());
        let traces = settled_walks(&model, Walker { step: 0.03, steps: 200, seed: 1 }, 5);
        let records = Reference::new(model.clone()).evaluate(&traces, &Job::new()).unwrap();
        assert!(records.iter().all(|r| r.events.len() > 1 && !r.wraps.is_empty()));
        records
    }

    #[test]
    fn a_wrong_event_is_found_and_named() {
        let right = records();
        let mut agreement = Agreement::new(right.len());
        // The slow ones run on a few traces only.
        agreement.check(REFERENCE, &right[..2]).unwrap();
        agreement.check(CPU, &right).unwrap();
        let mut wrong = right.clone();
        wrong[4].events.pop();
        let count = right[4].events.len();
        let error = agreement.check(GPU, &wrong).unwrap_err();
        assert_eq!((error.one.as_str(), error.other.as_str(), error.trace), ("cpu (windows)", "gpu (resident)", 4));
        assert_eq!(error.what, format!("{count} and {} events", count - 1));
        let mut wrong = right.clone();
        wrong[1].events.swap(0, 1);
        let error = agreement.check(GPU, &wrong).unwrap_err();
        assert_eq!((error.one.as_str(), error.trace), ("reference (one by one)", 1));
        // Events may differ for an engine that promises ropes only.
        agreement.check(FUNNEL, &wrong).unwrap();
    }

    #[test]
    fn a_wrong_rope_is_found_or_counted() {
        let right = records();
        let mut agreement = Agreement::new(right.len());
        assert_eq!(agreement.check(NOTE, &right), Ok(None));
        agreement.check(FUNNEL, &right).unwrap();
        let mut wrong = right.clone();
        let depth = wrong[3].wraps.len();
        wrong[3].wraps[0].0.x += 1e-9;
        assert_eq!(agreement.check(NOTE, &wrong), Ok(Some(1)));
        let error = agreement.check(GPU, &wrong).unwrap_err();
        assert_eq!(error.what, format!("its {depth} turns at the end are different ones"));
        assert!(error.to_string().starts_with("funnel (every step) and gpu (resident) disagree on trace 3: its "));
    }
}
