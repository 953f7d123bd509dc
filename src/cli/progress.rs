//! Progress on stderr: a bar for work over a second, or a line now and then where stderr is no terminal.

use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressStyle};
use tautline::engine::Job;
pub(crate) use tautline::stream::Progress;

/// How finely the bar is divided.
const PARTS: u64 = 1000;

/// What a line says once `steps` steps are done.
fn line(progress: &Progress, steps: u64, elapsed: Duration) -> String {
    let rate = (steps as f64 / elapsed.as_secs_f64().max(1e-9)) as u64;
    let done = format!("{} steps, {}/s", HumanCount(steps), HumanCount(rate));
    match progress.parts(steps, PARTS).min(PARTS) {
        _ if progress.size() == 0 => format!("progress: {done}"),
        0 => format!("progress: 0 %, {done}"),
        parts => {
            let left = elapsed.mul_f64((PARTS - parts) as f64 / parts as f64);
            format!("progress: {} %, {done}, about {} left", parts / 10, HumanDuration(left))
        }
    }
}

/// Runs `work` while a bar shows how far it is, the rate, and the time left; where stderr is no terminal, lines say so
/// now and then.
pub(crate) fn with_progress<T>(progress: &Progress, job: &Job, work: impl FnOnce() -> T) -> T {
    thread::scope(|scope| {
        let (done, waiting) = sync_channel::<()>(1);
        scope.spawn(move || {
            // `done` is dropped when the work ends, which disconnects.
            if stderr().is_terminal() {
                show_bar(progress, job, &waiting);
            } else {
                write_lines(progress, job, &waiting, gaps(), &mut stderr());
            }
        });
        let result = work();
        drop(done);
        result
    })
}

fn show_bar(progress: &Progress, job: &Job, waiting: &Receiver<()>) {
    if waiting.recv_timeout(Duration::from_secs(1)) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let (bar, style) = match progress.size() {
        0 => (ProgressBar::no_length(), "{spinner} {msg}"),
        _ => (ProgressBar::new(PARTS), "{wide_bar} {percent} %, {msg}, {eta} left"),
    };
    let bar = bar.with_elapsed(Duration::from_secs(1));
    bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
    while waiting.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
        let steps = job.steps();
        let rate = (steps as f64 / bar.elapsed().as_secs_f64()) as u64;
        bar.set_message(format!("{} steps, {}/s", HumanCount(steps), HumanCount(rate)));
        bar.set_position(progress.parts(steps, PARTS).min(PARTS));
    }
    bar.finish_and_clear();
}

/// How long it is from one line to the next: the first comes after ten seconds, each next one after twice as long, up
/// to two minutes. So a log of a night has some hundreds of lines, and a run of half a minute has two.
fn gaps() -> impl Iterator<Item = Duration> {
    (0..).map(|i: u32| Duration::from_secs((10 << i.min(4)).min(120)))
}

/// Writes a line after each gap until the work ends or there are no more gaps.
fn write_lines(
    progress: &Progress,
    job: &Job,
    waiting: &Receiver<()>,
    gaps: impl Iterator<Item = Duration>,
    out: &mut impl Write,
) {
    let start = Instant::now();
    for gap in gaps {
        if waiting.recv_timeout(gap) != Err(RecvTimeoutError::Timeout) {
            return;
        }
        // Nobody may be listening any more; the work is done all the same.
        let _ = writeln!(out, "{}", line(progress, job.steps(), start.elapsed()));
    }
}

/// The progress of a measurement, in runs: a bar, or lines where stderr is no terminal.
pub(crate) struct Runs {
    bar: ProgressBar,
    start: Instant,
    /// After what time the next line is due, and the gaps that follow; nothing where a bar is seen.
    lines: Option<(Duration, Box<dyn Iterator<Item = Duration>>)>,
}

impl Runs {
    /// No run is done, and nobody knows of how many.
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(1);
        let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {elapsed}, {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(Duration::from_millis(200));
        let mut gaps = gaps();
        let lines = gaps.next().filter(|_| !stderr().is_terminal()).map(|first| (first, Box::new(gaps) as Box<_>));
        Runs { bar, start: Instant::now(), lines }
    }

    /// Says what is being done.
    pub(crate) fn say(&self, what: String) {
        self.bar.set_message(what);
    }

    /// So many of all runs are done, and what is being done next.
    pub(crate) fn reach(&mut self, done: u64, all: u64, next: String) {
        let elapsed = self.start.elapsed();
        if let Some((due, gaps)) = &mut self.lines
            && elapsed >= *due
        {
            say!("progress: {done} of {all} runs in {}, now {next}", HumanDuration(elapsed));
            *due = elapsed + gaps.next().unwrap_or(elapsed);
        }
        self.bar.set_length(all);
        self.bar.set_position(done);
        self.bar.set_message(next);
    }

    /// There is nothing left to do.
    pub(crate) fn finish(self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_at_growing_intervals_and_say_how_far_it_is() {
        let seconds: Vec<u64> = gaps().take(7).map(|gap| gap.as_secs()).collect();
        assert_eq!(seconds, [10, 20, 40, 80, 120, 120, 120]);
        let progress = Progress::new(200);
        progress.begin(100, 50);
        let said = |steps, seconds| line(&progress, steps, Duration::from_secs(seconds));
        assert_eq!(said(0, 10), "progress: 0 %, 0 steps, 0/s");
        assert_eq!(said(25, 10), "progress: 25 %, 25 steps, 2/s, about 30 seconds left");
        assert_eq!(line(&Progress::new(0), 6000, Duration::from_secs(3)), "progress: 6,000 steps, 2,000/s");
    }

    #[test]
    fn lines_end_with_the_work() {
        let (progress, job) = (Progress::new(0), Job::new());
        let (done, waiting) = sync_channel::<()>(1);
        let mut written = Vec::new();
        write_lines(&progress, &job, &waiting, [Duration::ZERO; 3].into_iter(), &mut written);
        assert_eq!(String::from_utf8(written).unwrap().lines().count(), 3);
        drop(done);
        let mut written = Vec::new();
        write_lines(&progress, &job, &waiting, gaps(), &mut written);
        assert!(written.is_empty());
    }
}
