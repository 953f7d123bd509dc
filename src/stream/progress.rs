//! How far a run is.

use std::sync::Mutex;

/// How much of a source of traces has been evaluated: the part that was read, but for the batch under way, of which as
/// much as its steps are done. May be asked from another thread.
pub struct Progress {
    /// Of the source, in its own unit; 0 if nobody knows.
    size: u64,
    batch: Mutex<Span>,
}

/// A batch under way: which part of the source it is, and how many steps were done before it and are in it.
#[derive(Debug, Clone, Copy, Default)]
struct Span {
    start: u64,
    end: u64,
    before: u64,
    steps: u64,
}

impl Progress {
    /// Nothing of `size` has been evaluated.
    pub fn new(size: u64) -> Self {
        Progress { size, batch: Mutex::default() }
    }

    /// Begins a batch of `steps` with which the source is read up to `end`.
    pub fn begin(&self, end: u64, steps: u64) {
        if let Ok(mut batch) = self.batch.lock() {
            *batch = Span { start: batch.end, end, before: batch.before + batch.steps, steps };
        }
    }

    /// The size of the source, in its own unit; 0 if nobody knows.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// How many of `all` parts are done once `done` steps are. More than all, perhaps, where nobody knows the size.
    pub fn parts(&self, done: u64, all: u64) -> u64 {
        let batch = self.batch.lock().map_or_else(|_| Span::default(), |batch| *batch);
        let share = done.saturating_sub(batch.before) as f64 / batch.steps.max(1) as f64;
        let read = batch.start as f64 + (batch.end - batch.start) as f64 * share.min(1.0);
        (all as f64 * read / self.size.max(1) as f64) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_counts_as_far_as_its_steps_are_done() {
        let progress = Progress::new(200);
        assert_eq!(progress.parts(0, 1000), 0);
        progress.begin(100, 50);
        assert_eq!([0, 25, 50, 60].map(|steps| progress.parts(steps, 1000)), [0, 250, 500, 500]);
        progress.begin(200, 0);
        assert_eq!(progress.parts(50, 1000), 500);
        let unknown = Progress::new(0);
        unknown.begin(7, 3);
        assert!(unknown.parts(3, 1000) >= 1000);
    }
}
