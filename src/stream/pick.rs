//! Some traces of a source, by their numbers.

use super::{EndsSource, Source, StreamError};
use crate::example::some_walks;
use crate::read_error::ReadError;
use crate::scene::Model;
use crate::trace::{EndsTrace, Trace};

/// How many traces, and points of them, are read at a time.
pub(super) const TRACES: usize = 8192;
const POINTS: usize = 1 << 22;

/// Why traces cannot be picked.
#[derive(Debug, thiserror::Error)]
pub enum PickError {
    /// They cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// They cannot be read with the paths of their anchors.
    #[error(transparent)]
    Ends(#[from] StreamError),
    /// The source has none.
    #[error("there are no traces in it")]
    Empty,
    /// It has none of this number.
    #[error("there is no trace {trace}; its traces have numbers from {first} to {last}")]
    Missing {
        /// The number that was asked for.
        trace: u64,
        /// The first trace's number.
        first: u64,
        /// The last one's.
        last: u64,
    },
}

impl Source {
    /// The traces with the numbers in `wanted`, in the order of the source; without any, the first. A file is read up
    /// to the last of them, walks are drawn in `model`.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and a number that no trace has.
    ///
    /// ```
    /// use tautline::example::{Walker, floor_plan};
    /// use tautline::scene::Model;
    /// use tautline::stream::Source;
    ///
    /// let model = Model::new(floor_plan(), None)?;
    /// let walks = || Source::Walks(Walker { step: 0.3, steps: 9, seed: 1 }, 0..20);
    /// assert_eq!(walks().pick(&[7, 3], &model)?.len(), 2);
    /// assert!(walks().pick(&[20], &model).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pick(self, wanted: &[u64], model: &Model) -> Result<Vec<Trace>, PickError> {
        let wanted = each_once(wanted);
        match self {
            Source::File(mut reader) => find(|| reader.next_batch(TRACES, POINTS), |trace| trace.id, &wanted),
            Source::Walks(walker, numbers) => {
                if numbers.is_empty() {
                    return Err(PickError::Empty);
                }
                if let Some(&trace) = wanted.iter().find(|id| !numbers.contains(id)) {
                    return Err(PickError::Missing { trace, first: numbers.start, last: numbers.end - 1 });
                }
                let wanted = if wanted.is_empty() { vec![numbers.start] } else { wanted };
                Ok(wanted.into_iter().flat_map(|id| some_walks(model, walker, id..id + 1)).collect())
            }
        }
    }
}

impl EndsSource {
    /// The same where both ends move: each trace with the points of its anchor.
    ///
    /// # Errors
    ///
    /// Files that cannot be read, and a number that no trace has.
    pub fn pick(mut self, wanted: &[u64]) -> Result<Vec<EndsTrace>, PickError> {
        find(|| self.next(TRACES), |both| both.free.id, &each_once(wanted))
    }
}

/// The numbers in order, each once.
fn each_once(wanted: &[u64]) -> Vec<u64> {
    let mut wanted = wanted.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

/// Those of the traces that come in batches whose numbers are `wanted`.
fn find<T, E>(
    mut next: impl FnMut() -> Result<Option<Vec<T>>, E>,
    number: impl Fn(&T) -> u64,
    wanted: &[u64],
) -> Result<Vec<T>, PickError>
where
    PickError: From<E>,
{
    let mut found: Vec<T> = Vec::new();
    let mut range: Option<(u64, u64)> = None;
    while found.len() < wanted.len().max(1) {
        let Some(batch) = next()? else { break };
        for trace in batch {
            let id = number(&trace);
            range = Some((range.map_or(id, |r| r.0), id));
            if wanted.contains(&id) || (wanted.is_empty() && found.is_empty()) {
                found.push(trace);
            }
        }
    }
    match (range, wanted.iter().find(|&&id| found.iter().all(|t| number(t) != id))) {
        (None, _) => Err(PickError::Empty),
        (Some((first, last)), Some(&trace)) => Err(PickError::Missing { trace, first, last }),
        _ => Ok(found),
    }
}
