//! Progress on stderr, for work over a second; silent where stderr is no terminal.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use tautline::engine::Job;

/// Runs `work` while a bar shows how much of `steps` the job has done, the rate, and the time left.
pub(crate) fn with_progress<T>(job: &Job, steps: u64, work: impl FnOnce() -> T) -> T {
    thread::scope(|scope| {
        let (done, waiting) = sync_channel::<()>(1);
        scope.spawn(move || {
            // `done` is dropped when the work ends, which disconnects.
            if waiting.recv_timeout(Duration::from_secs(1)) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let bar = ProgressBar::new(steps).with_elapsed(Duration::from_secs(1));
            let style = "{wide_bar} {human_pos}/{human_len} steps, {per_sec}, {eta} left";
            bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
            while waiting.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
                bar.set_position(job.steps());
            }
            bar.finish_and_clear();
        });
        let result = work();
        drop(done);
        result
    })
}
