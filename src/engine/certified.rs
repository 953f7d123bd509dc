//! A trace on a device that finds candidates: the exact update goes on among those that an answer names.

use super::Phase;
use super::batch::{Asked, Astray, Player, Shared, Tools};
use super::course::Course;
use crate::candidates::{Found, List, Query, ROOM};
use crate::gpu::Sweeping;
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

impl Player for Course {
    type Kernel = Sweeping;

    fn new() -> Self {
        Course::new()
    }

    fn start(&mut self, model: &Model, trace: &SettledTrace) {
        Course::start(self, model, trace);
    }

    fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        Course::finished(self, trace)
    }

    fn at(&self) -> usize {
        Course::at(self)
    }

    fn ask(&mut self, shared: &Shared<'_, '_>, trace: &SettledTrace, tools: &mut Tools) -> Option<Asked<Sweeping>> {
        let (lists, job) = (shared.lists, shared.job);
        let model = lists.model();
        let query = job.time(Phase::Queries, || {
            Course::ask(self, lists.frame(), trace, shared.window, shared.simd, &mut tools.slopes)
        });
        if trace.breaks_rules() {
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
            let before = Course::at(self);
            self.try_all(model, trace);
            job.count_tests(((Course::at(self) - before) * model.vertices().len()) as u64);
            return None;
        }
        let pivot = self.pivot(model);
        let Some(list) = job.time(Phase::Queries, || lists.of(pivot, f64::INFINITY)) else {
            look(self, shared, trace, pivot, &query, tools);
            return None;
        };
        let query = Query { count: list.within(self.squared(trace)) as u32, ..query };
        Some(Asked { pivot: lists.key(pivot, &list), list, query })
    }

    fn answered(
        &mut self,
        shared: &Shared<'_, '_>,
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
                    *candidate = list.number(place.wrapping_sub(query.first) as usize).ok_or(Astray)?;
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
    course: &mut Course,
    shared: &Shared<'_, '_>,
    trace: &SettledTrace,
    pivot: u32,
    query: &Query,
    tools: &mut Tools,
) {
    let Tools { slopes, scratch, found } = tools;
    let job = shared.job;
    let tried = job.time(Phase::Kernel, || shared.lists.look_into(pivot, query, shared.simd, scratch, found));
    if found.len() <= ROOM || !course.narrow() {
        let model = shared.lists.model();
        job.time(Phase::Update, || course.go_on(model, trace, found, shared.simd, slopes));
    }
    job.count_tests(tried as u64);
}
