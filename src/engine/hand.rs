//! One trace after the other on a thread of the CPU.

use std::sync::Arc;

use super::job::TELL;
use super::windows::Windows;
use super::{EngineError, Job, Phase};
use crate::candidates::{List, Lists, ROOM, Simd, Slopes};
use crate::rope::TraceRecord;
use crate::scene::Pivot;
use crate::trace::SettledTrace;
use crate::visibility::Scratch;

/// How many lists each thread keeps at hand.
const RECENT: usize = 256;

/// What takes traces on, with the memory that it works with.
pub(super) struct Hand<'l> {
    lists: &'l Lists,
    window: usize,
    simd: Simd,
    slopes: Slopes,
    scratch: Scratch,
    /// The candidates of the current window.
    found: Vec<u32>,
    recent: Recent,
}

impl<'l> Hand<'l> {
    pub(super) fn new(lists: &'l Lists, window: usize, simd: Simd) -> Self {
        Hand {
            lists,
            window,
            simd,
            slopes: Slopes::default(),
            scratch: Scratch::default(),
            found: Vec::new(),
            recent: Recent(std::array::from_fn(|_| None)),
        }
    }

    /// Evaluates a trace from its start to its end.
    pub(super) fn evaluate(
        &mut self,
        windows: &mut Windows,
        trace: &SettledTrace,
        job: &Job,
    ) -> Result<TraceRecord, EngineError> {
        windows.start(self.lists.model(), trace);
        let (mut told, mut tests) = (0, 0);
        loop {
            if let Some(record) = windows.finished(trace) {
                job.count(trace.step(windows.at()) - told);
                job.count_tests(tests as u64);
                return Ok(record);
            }
            job.go_on()?;
            let step = trace.step(windows.at());
            if step - told >= TELL {
                job.count(step - told);
                told = step;
            }
            tests += self.go_on(windows, trace, self.window, job);
        }
    }

    /// Takes a trace that is not done on by a window of at most `most` legs, or to its first event, and returns how
    /// many vertices were tried.
    pub(super) fn go_on(&mut self, windows: &mut Windows, trace: &SettledTrace, most: usize, job: &Job) -> usize {
        let lists = self.lists;
        let model = lists.model();
        let query = job.time(Phase::Queries, || windows.ask(lists.frame(), trace, most, self.simd, &mut self.slopes));
        if trace.breaks_rules() {
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
            let before = windows.at();
            windows.try_all(model, trace);
            return (windows.at() - before) * model.vertices().len();
        }
        let pivot = windows.pivot(model);
        let squared = windows.squared(trace);
        let Hand { simd, slopes, scratch, found, recent, .. } = self;
        let list = recent.list(lists, pivot, squared, job);
        found.clear();
        let tests = job.time(Phase::Kernel, || match list {
            Some(list) => {
                let count = list.within(squared);
                simd.sweep(list, &query, count, found);
                count
            }
            None => lists.look_into(pivot, &query, *simd, scratch, found),
        });
        if found.len() > ROOM && windows.narrow() {
            return tests;
        }
        job.time(Phase::Update, || windows.go_on(model, trace, found, *simd, slopes));
        tests
    }

    /// The list of a pivot that serves queries no further from it than the square root of `squared`, once it is worth
    /// making.
    pub(super) fn list(&mut self, pivot: Pivot, squared: f64, job: &Job) -> Option<&List> {
        self.recent.list(self.lists, pivot, squared, job)
    }
}

/// The lists used last, by pivot: ropes come back to the pivots from which they came, and what a thread has at hand it
/// need not ask the others for.
struct Recent([Option<(Pivot, Arc<List>)>; RECENT]);

impl Recent {
    /// As [`Hand::list`], of `lists`.
    fn list(&mut self, lists: &Lists, pivot: Pivot, squared: f64, job: &Job) -> Option<&List> {
        let serves = |(of, list): &&(Pivot, Arc<List>)| *of == pivot && list.reaches(squared);
        let slot = &mut self.0[pivot.index() % RECENT];
        if slot.as_ref().filter(serves).is_none()
            && let Some(own) = job.time(Phase::Queries, || lists.of(pivot, squared))
        {
            *slot = Some((pivot, own));
        }
        slot.as_ref().filter(serves).map(|(_, list)| &**list)
    }
}
