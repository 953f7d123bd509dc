//! Progress on stderr, for work over a second; silent where stderr is no terminal.

use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use indicatif::{HumanCount, ProgressBar, ProgressStyle};
use tautline::engine::Job;

/// How finely the bar is divided.
const PARTS: u64 = 1000;

/// How much of a source of traces has been evaluated.
pub(crate) struct Progress {
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
    pub(crate) fn new(size: u64) -> Self {
        Progress { size, batch: Mutex::default() }
    }

    /// Begins a batch of `steps` with which the source is read up to `end`.
    pub(crate) fn begin(&self, end: u64, steps: u64) {
        if let Ok(mut batch) = self.batch.lock() {
            *batch = Span { start: batch.end, end, before: batch.before + batch.steps, steps };
        }
    }

    /// How many thousandths are done once `done` steps are.
    fn parts(&self, done: u64) -> u64 {
        let batch = self.batch.lock().map_or_else(|_| Span::default(), |batch| *batch);
        let share = done.saturating_sub(batch.before) as f64 / batch.steps.max(1) as f64;
        let read = batch.start as f64 + (batch.end - batch.start) as f64 * share.min(1.0);
        (PARTS as f64 * read / self.size.max(1) as f64) as u64
    }
}

/// Runs `work` while a bar shows how far it is, the rate, and the time left.
pub(crate) fn with_progress<T>(progress: &Progress, job: &Job, work: impl FnOnce() -> T) -> T {
    thread::scope(|scope| {
        let (done, waiting) = sync_channel::<()>(1);
        scope.spawn(move || {
            // `done` is dropped when the work ends, which disconnects.
            if waiting.recv_timeout(Duration::from_secs(1)) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let (bar, style) = match progress.size {
                0 => (ProgressBar::no_length(), "{spinner} {msg}"),
                _ => (ProgressBar::new(PARTS), "{wide_bar} {percent} %, {msg}, {eta} left"),
            };
            let bar = bar.with_elapsed(Duration::from_secs(1));
            bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
            while waiting.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
                let steps = job.steps();
                let rate = (steps as f64 / bar.elapsed().as_secs_f64()) as u64;
                bar.set_message(format!("{} steps, {}/s", HumanCount(steps), HumanCount(rate)));
                bar.set_position(progress.parts(steps).min(PARTS));
            }
            bar.finish_and_clear();
        });
        let result = work();
        drop(done);
        result
    })
}

/// A bar that counts runs of a measurement.
pub(crate) fn runs(total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {elapsed}, {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_counts_as_far_as_its_steps_are_done() {
        let progress = Progress::new(200);
        assert_eq!(progress.parts(0), 0);
        progress.begin(100, 50);
        assert_eq!([0, 25, 50, 60].map(|steps| progress.parts(steps)), [0, 250, 500, 500]);
        progress.begin(200, 0);
        assert_eq!(progress.parts(50), 500);
        let unknown = Progress::new(0);
        unknown.begin(7, 3);
        assert!(unknown.parts(3) >= PARTS);
    }
}
