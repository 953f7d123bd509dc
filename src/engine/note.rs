//! The seed note's listing 1, as written: the baseline that is measured against. Plain f64, at most one event a step,
//! the first crossing in list order. It is wrong on collinear walls, on several wraps in one step, and on rounding; it is
//! kept to be measured, not to be used.

use glam::DVec2;

use super::walk::Walk;
use super::{Engine, EngineError, Job, Precision};
use crate::rope::{EventKind, Side, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The listing multiplies by `Inf`; an infinite factor makes NaN of a difference of zero, so it must be read as a number
/// that is large enough.
const INF: f64 = 1e9;

/// Listing 1 of the note. O(obstacle points) a step, on one thread.
#[derive(Clone, Copy)]
pub struct Note<'m> {
    model: &'m Model,
}

impl<'m> Note<'m> {
    /// An engine for `model`.
    pub fn new(model: &'m Model) -> Self {
        Note { model }
    }
}

/// A ray as the listing has it: a segment to a far point.
type Ray = (DVec2, DVec2);

impl Engine for Note<'_> {
    fn name(&self) -> &'static str {
        "note"
    }

    fn precision(&self) -> Option<Precision> {
        None
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        let model = self.model;
        // The flattened list of the obstacle segments' ends: a shared end stands in it once a segment.
        let obstacle_points: Vec<(u32, DVec2)> =
            model.scene().walls().iter().flatten().map(|&v| (v, model.vertices()[v as usize])).collect();
        let mut walk = Walk::new();
        let mut records = Vec::with_capacity(traces.len());
        for trace in traces {
            walk.start(model, trace);
            let mut unwrapping_ray = (DVec2::ZERO, DVec2::ZERO);
            while !walk.is_done(trace) {
                job.go_on()?;
                let (a0, a) = (trace.points()[walk.at], trace.points()[walk.at + 1]);
                step(&mut walk, trace, model.anchor(), &obstacle_points, &mut unwrapping_ray, a0, a);
                let before = trace.step(walk.at);
                walk.arrive(trace);
                job.count(trace.step(walk.at) - before);
                job.count_tests(obstacle_points.len() as u64);
            }
            records.push(walk.record(trace));
        }
        Ok(records)
    }
}

/// One turn of the listing's outer loop.
fn step(
    walk: &mut Walk,
    trace: &SettledTrace,
    anchor: DVec2,
    obstacle_points: &[(u32, DVec2)],
    unwrapping_ray: &mut Ray,
    a0: DVec2,
    a: DVec2,
) {
    for &(vertex, point) in obstacle_points {
        let last = walk.rope.pivot();
        if point == last {
            continue;
        }
        let ray = ray(last, point);
        if intersect(a0, a, ray) {
            *unwrapping_ray = ray;
            // The listing keeps no sides: the side is the way in which the trace passes the ray.
            let side = Side::of(ccw(last, point, a));
            walk.rope.push(vertex, point, side);
            walk.note(trace, EventKind::Wrap, vertex, side);
            return;
        }
        if !walk.rope.contacts().is_empty() && intersect(a0, a, *unwrapping_ray) {
            if let Some(c) = walk.rope.pop() {
                walk.note(trace, EventKind::Unwrap, c.vertex, c.side);
            }
            *unwrapping_ray = match walk.rope.contacts() {
                [] => (DVec2::ZERO, DVec2::ZERO),
                [only] => self::ray(anchor, only.at),
                [.., prior, last] => self::ray(prior.at, last.at),
            };
            return;
        }
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
