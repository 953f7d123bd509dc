//! The seed note's listing 1, as written: the baseline that is measured against. Plain f64, at most one event a step,
//! the first crossing in list order. It is wrong on collinear walls, on several wraps in one step, and on rounding; it
//! is kept to be measured, not to be used. So is the note's remedy for walls on one line.

use std::sync::Arc;

use glam::DVec2;

use super::progress::Progress;
use super::table::Open;
use super::{Engine, EngineError, EngineKind, Job, Precision, Promise};
use crate::rope::{EventKind, Side, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The baseline.
pub static NOTE: EngineKind = EngineKind {
    name: "note",
    about: "The seed note's listing 1, as written: wrong on purpose, for comparison",
    precisions: &[],
    asks: false,
    both_ends: false,
    promise: Promise::Nothing,
    open: Open::Thread(|model| Box::new(Note::new(model))),
};

/// The listing multiplies by `Inf`; an infinite factor makes NaN of a difference of zero, so it must be read as a
/// number that is large enough.
const INF: f64 = 1e9;

/// Listing 1 of the note. O(obstacle points) a step, on one thread.
#[derive(Clone)]
pub struct Note {
    model: Arc<Model>,
    furthest: bool,
}

impl Note {
    /// An engine for `model`.
    pub fn new(model: Arc<Model>) -> Self {
        Note { model, furthest: false }
    }

    /// The same with what the note says of walls on one line: of all the rays that a step crosses, the one whose source
    /// is furthest from the pivot is taken, not the first in the list.
    #[must_use]
    pub fn furthest(mut self) -> Self {
        self.furthest = true;
        self
    }
}

/// A ray as the listing has it: a segment to a far point.
type Ray = (DVec2, DVec2);

impl Engine for Note {
    fn name(&self) -> &'static str {
        NOTE.name
    }

    fn precision(&self) -> Option<Precision> {
        None
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        let model = &*self.model;
        // The flattened list of the obstacle segments' ends: a shared end stands in it once a segment.
        let obstacle_points: Vec<(u32, DVec2)> =
            model.scene().walls().iter().flatten().map(|&v| (v, model.vertices()[v as usize])).collect();
        let listing = Listing { anchor: model.anchor(), obstacle_points: &obstacle_points, furthest: self.furthest };
        let mut progress = Progress::new();
        let mut records = Vec::with_capacity(traces.len());
        for trace in traces {
            progress.start(model, trace);
            let mut unwrapping_ray = (DVec2::ZERO, DVec2::ZERO);
            while !progress.is_done(trace) {
                job.go_on()?;
                listing.step(&mut progress, trace, &mut unwrapping_ray);
                let before = trace.step(progress.at);
                progress.arrive(trace);
                job.count(trace.step(progress.at) - before);
                job.count_tests(obstacle_points.len() as u64);
            }
            records.push(progress.record(trace));
        }
        Ok(records)
    }
}

/// What the listing goes by.
struct Listing<'a> {
    anchor: DVec2,
    obstacle_points: &'a [(u32, DVec2)],
    furthest: bool,
}

impl Listing<'_> {
    /// One turn of the listing's outer loop.
    fn step(&self, progress: &mut Progress, trace: &SettledTrace, unwrapping_ray: &mut Ray) {
        let [a0, a] = [progress.at, progress.at + 1].map(|i| trace.points()[i]);
        let last = progress.rope.pivot();
        for (i, &(vertex, point)) in self.obstacle_points.iter().enumerate() {
            if point == last {
                continue;
            }
            if intersect(a0, a, ray(last, point)) {
                let (vertex, point) =
                    if self.furthest { self.furthest_crossed(i, last, [a0, a]) } else { (vertex, point) };
                *unwrapping_ray = ray(last, point);
                // The listing keeps no sides: the side is the way in which the trace passes the ray.
                let side = Side::of(ccw(last, point, a));
                progress.rope.push(vertex, point, side);
                progress.note(trace, EventKind::Wrap, vertex, side);
                return;
            }
            if !progress.rope.contacts().is_empty() && intersect(a0, a, *unwrapping_ray) {
                if let Some(c) = progress.rope.pop() {
                    progress.note(trace, EventKind::Unwrap, c.vertex, c.side);
                }
                *unwrapping_ray = match progress.rope.contacts() {
                    [] => (DVec2::ZERO, DVec2::ZERO),
                    [only] => ray(self.anchor, only.at),
                    [.., prior, last] => ray(prior.at, last.at),
                };
                return;
            }
        }
    }

    /// Of the points from number `first` on, whose ray is crossed, the one furthest from the pivot whose ray is.
    fn furthest_crossed(&self, first: usize, last: DVec2, [a0, a]: [DVec2; 2]) -> (u32, DVec2) {
        let later = self.obstacle_points[first + 1..].iter().filter(|p| p.1 != last);
        let crossed = later.filter(|p| intersect(a0, a, ray(last, p.1)));
        crossed.fold(self.obstacle_points[first], |found, &p| {
            if p.1.distance_squared(last) > found.1.distance_squared(last) { p } else { found }
        })
    }
}

fn ray(observer: DVec2, point: DVec2) -> Ray {
    (point, point + INF * (point - observer))
}

/// The usual test of two segments by four orientations, in plain f64.
fn intersect(a0: DVec2, a: DVec2, (r0, r1): Ray) -> bool {
    ccw(a0, a, r0) * ccw(a0, a, r1) < 0.0 && ccw(r0, r1, a0) * ccw(r0, r1, a) < 0.0
}

fn ccw(p: DVec2, q: DVec2, r: DVec2) -> f64 {
    (q - p).perp_dot(r - p)
}
