//! Traces in batches, read and checked in a thread of their own while the batch before is evaluated.

use std::ops::{Range, RangeInclusive};
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::StreamError;
use crate::example::{Walker, some_walks};
use crate::scene::Model;
use crate::trace::{SettledTrace, Trace, TraceReader};
use crate::trade::Terms;

/// How many points the traces of a batch have together at most. A batch of long traces has fewer of them, so that
/// memory stays bounded: 16 MB of points for each of the two batches under way: one that is read and checked, one that
/// is evaluated. Engines that can make use of more traces at once than others get up to 32 times as much.
const POINTS: RangeInclusive<usize> = 1 << 20..=1 << 25;

/// How many traces a batch has at least, if there are so many and not too many points: what lists are made for is the
/// reach of the first batch, and one that goes further has them made anew.
const TRACES: usize = 1 << 12;

/// Where traces come from.
pub enum Source {
    /// A file.
    File(TraceReader),
    /// Walks in the scene that is given, and the numbers of those that are left.
    Walks(Walker, Range<u64>),
}

impl Source {
    /// The next traces, drawn in `model` if they are not in a file.
    pub(super) fn next(&mut self, model: &Model, traces: usize) -> Result<Option<Vec<Trace>>, StreamError> {
        let points = (512 * traces).clamp(*POINTS.start(), *POINTS.end());
        match self {
            Source::File(reader) => Ok(reader.next_batch(traces, points)?),
            Source::Walks(walker, left) => {
                let count = traces.min(points / (walker.steps + 1)).max(1) as u64;
                let numbers = left.start..left.end.min(left.start + count);
                left.start = numbers.end;
                Ok((!numbers.is_empty()).then(|| some_walks(model, *walker, numbers)))
            }
        }
    }

    /// How much there is, in rows, bytes or traces; 0 if nobody knows.
    fn size(&self) -> u64 {
        match self {
            Source::File(reader) => reader.size(),
            Source::Walks(_, left) => left.end - left.start,
        }
    }

    /// How much of that has been read.
    fn position(&self) -> u64 {
        match self {
            Source::File(reader) => reader.position(),
            Source::Walks(_, left) => left.start,
        }
    }
}

/// Traces that are ready to be evaluated.
pub struct Batch {
    /// The traces, in the order of the source.
    pub settled: Vec<SettledTrace>,
    /// How much of the source has been read with them, in the unit of [`Batches::size`].
    pub position: u64,
    /// How long reading and checking them took.
    pub prepared: Duration,
}

/// Batches to come: while one is evaluated, the next is read and checked in a thread of its own.
pub struct Batches {
    waiting: Receiver<Result<Batch, StreamError>>,
    thread: Option<JoinHandle<()>>,
    size: u64,
}

impl Batches {
    /// Begins to read batches of about `traces` traces, or a few thousand, and of a bounded number of points. The
    /// thread ends with the source, with the first error, or when nobody waits any more; it is not waited for then,
    /// since reading from a pipe may take for ever.
    pub fn start(source: Source, terms: Terms, traces: usize) -> Self {
        let (size, traces) = (source.size(), traces.max(TRACES));
        // Without room in between: a batch that is ready waits in the thread, and the one after it is not read yet.
        let (ready, waiting) = sync_channel(0);
        let thread = spawn(move || prepare(source, &terms, traces, &ready));
        Batches { waiting, thread: Some(thread), size }
    }

    /// How large the source is, in rows, bytes or traces; 0 if nobody knows.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// The next batch; `None` after the last.
    ///
    /// # Errors
    ///
    /// A source that cannot be read.
    #[allow(clippy::should_implement_trait)] // an error ends it
    pub fn next(&mut self) -> Result<Option<Batch>, StreamError> {
        match self.waiting.recv() {
            Ok(batch) => batch.map(Some),
            Err(_) => {
                if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
                    resume_unwind(panic);
                }
                Ok(None)
            }
        }
    }
}

fn prepare(mut source: Source, terms: &Terms, traces: usize, ready: &SyncSender<Result<Batch, StreamError>>) {
    loop {
        let start = Instant::now();
        let batch = match source.next(&terms.given, traces) {
            Ok(Some(traces)) => {
                let settled = traces.into_par_iter().map(|trace| terms.settle(trace)).collect();
                Ok(Batch { settled, position: source.position(), prepared: start.elapsed() })
            }
            Ok(None) => return,
            Err(failure) => Err(failure),
        };
        let failed = batch.is_err();
        if ready.send(batch).is_err() || failed {
            return;
        }
    }
}
