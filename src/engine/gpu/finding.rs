//! A trace on a device that finds candidates: the exact update goes on among those that an answer names.

use super::rounds::{Asked, Astray, Player, Shared, Tools};
use crate::candidates::{Found, List, Query, ROOM};
use crate::engine::Phase;
use crate::engine::windows::Windows;
use crate::gpu::Sweeping;
use crate::rope::TraceRecord;
use crate::scene::{Model, Pivot};
use crate::trace::SettledTrace;

impl Player for Windows {
    type Kernel = Sweeping;

    fn new() -> Self {
        Windows::new()
    }

    fn start(&mut self, model: &Model, trace: &SettledTrace) {
        Windows::start(self, model, trace);
    }

    fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        Windows::finished(self, trace)
    }

    fn at(&self) -> usize {
        Windows::at(self)
    }

    fn ask(&mut self, shared: &Shared<'_>, trace: &SettledTrace, tools: &mut Tools) -> Option<Asked<Sweeping>> {
        let (lists, job) = (shared.lists, shared.job);
        let model = lists.model();
        let query = job.time(Phase::Queries, || {
            Windows::ask(self, lists.frame(), trace, shared.window, shared.simd, &mut tools.slopes)
        });
        if trace.breaks_rules() {
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
            let before = Windows::at(self);
            self.try_all(model, trace);
            job.count_tests(((Windows::at(self) - before) * model.vertices().len()) as u64);
            return None;
        }
        let pivot = self.pivot(model);
        let Some(list) = job.time(Phase::Queries, || lists.of(pivot, f64::INFINITY)) else {
            look(self, shared, trace, pivot, &query, tools);
            return None;
        };
        let query = Query { count: list.within(self.squared(trace)) as u32, ..query };
        Some(Asked { pivot, key: lists.key(pivot, &list), list, query })
    }

    fn answered(
        &mut self,
        shared: &Shared<'_>,
        trace: &SettledTrace,
        (list, query): (&List, &Query),
        found: &Found,
        tools: &mut Tools,
    ) -> Result<(), Astray> {
        let (model, simd, slopes) = (shared.lists.model(), shared.simd, &mut tools.slopes);
        let mut candidates = [0; ROOM];
        match found.places() {
            Some([]) if self.is_quiet() => self.pass_by(trace),
            Some(places) => {
                let candidates = &mut candidates[..places.len()];
                for (candidate, place) in candidates.iter_mut().zip(places) {
                    *candidate = list.vertex(place.rank(query.first)).ok_or(Astray)?;
                }
                self.recall(trace, simd, slopes);
                self.go_on(model, trace, candidates, simd, slopes);
            }
            None if self.narrow() => {}
            // Too many for one leg.
            None => {
                let mut candidates = Vec::new();
                simd.sweep(list, query, query.count as usize, &mut candidates);
                self.recall(trace, simd, slopes);
                self.go_on(model, trace, &candidates, simd, slopes);
            }
        }
        Ok(())
    }
}

/// Goes on through the window that was asked for last, whose pivot is not worth a list: it is answered here and now.
fn look(
    windows: &mut Windows,
    shared: &Shared<'_>,
    trace: &SettledTrace,
    pivot: Pivot,
    query: &Query,
    tools: &mut Tools,
) {
    let Tools { slopes, scratch, found } = tools;
    let job = shared.job;
    let tried = job.time(Phase::Kernel, || shared.lists.look_into(pivot, query, shared.simd, scratch, found));
    if found.len() <= ROOM || !windows.narrow() {
        let model = shared.lists.model();
        job.time(Phase::Update, || windows.go_on(model, trace, found, shared.simd, slopes));
    }
    job.count_tests(tried as u64);
}
