//! Ropes whose ends both move: one trace, step by step, first the free end and then the anchor.

use glam::DVec2;

use super::job::TELL;
use super::progress::Progress;
use super::{EngineError, Job};
use crate::candidates::Lists;
use crate::geometry::{TracePoint, higher, lower};
use crate::rope::{EndsRecord, Event, EventKind, FreeRope, Side, Status, Sweep, TraceRecord};
use crate::scene::{Model, Pivot};
use crate::trace::{End, SettledEnds};

/// What the leg of an end turns about: a vertex, or no vertex but the other end, and where that is.
pub(super) type About = (Option<u32>, DVec2);

/// Finds the vertices to be tried in the triangle of a pivot and a leg, and writes them into a list.
pub(super) trait Candidates: FnMut(About, [DVec2; 2], &mut Vec<u32>) {}

impl<F: FnMut(About, [DVec2; 2], &mut Vec<u32>)> Candidates for F {}

/// All vertices.
pub(super) fn all(model: &Model) -> impl Candidates {
    let all = 0..model.vertices().len() as u32;
    move |_, _, tried| tried.extend(all.clone())
}

/// The vertices in the box of the triangle of `about` and a leg, perhaps more than once and with some outside: what
/// there is to try where no list of vertices is made, about an end that moves itself. O(log walls + walls near the
/// box).
pub(super) fn near(model: &Model, (_, at): About, [a0, a1]: [DVec2; 2], tried: &mut Vec<u32>) {
    let (low, high) = (lower(lower(at, a0), a1), higher(higher(at, a0), a1));
    let _ = model.index().visit::<()>(low, high, |wall, _| {
        tried.extend(model.scene().walls()[wall as usize]);
        std::ops::ControlFlow::Continue(())
    });
}

/// The vertices that the pivot sees within reach of a leg, as `lists` have them; those [`near`] about an end, and as
/// long as there is no list.
pub(super) fn listed(lists: &Lists, about: About, leg: [DVec2; 2], tried: &mut Vec<u32>) {
    let squared = leg.map(|a| a.distance_squared(about.1)).into_iter().fold(0.0, f64::max);
    match about.0.and_then(|vertex| lists.of(Pivot::at_vertex(vertex), squared)) {
        Some(list) => tried.extend(list.numbers().take(list.within(squared))),
        None => near(lists.model(), about, leg, tried),
    }
}

/// Moves `end` of `rope` straight to `to`, and tells `each` what happens on the way. Returns how many vertices were
/// tried.
///
/// A leg that keeps to the rules wraps no vertex twice. One that goes through walls may find no end, and is broken off.
pub(super) fn drag(
    rope: &mut FreeRope,
    end: End,
    to: TracePoint,
    vertices: &[DVec2],
    tried: &mut Vec<u32>,
    candidates: &mut impl Candidates,
    mut each: impl FnMut(EventKind, u32, Side),
) -> usize {
    let leg = rope.leg(end, to);
    if leg.a0 == leg.a1 {
        return 0;
    }
    let (mut sweep, mut wraps, mut tests) = (Sweep::Start, 0, 0);
    while wraps <= vertices.len() {
        tried.clear();
        candidates(rope.pivot(end), [leg.a0.at, leg.a1.at], tried);
        tests += tried.len();
        let Some((kind, vertex, side)) = rope.next(end, &mut sweep, &leg, vertices, tried.iter().copied()) else {
            break;
        };
        wraps += usize::from(kind == EventKind::Wrap);
        each(kind, vertex, side);
    }
    rope.arrive(end, &leg);
    tests
}

/// Evaluates one trace among the walls of `model`, with the vertices that `candidates` find, or all where it breaks the
/// rules.
pub(super) fn evaluate(
    model: &Model,
    trace: &SettledEnds,
    job: &Job,
    mut candidates: impl Candidates,
) -> Result<EndsRecord, EngineError> {
    let breaks = trace.breaks_rules();
    let mut every = all(model);
    let mut candidates = |about: About, leg: [DVec2; 2], tried: &mut Vec<u32>| match breaks {
        true => every(about, leg, tried),
        false => candidates(about, leg, tried),
    };
    if trace.is_tied() { tied(model, trace, job, &mut candidates) } else { free(model, trace, job, &mut candidates) }
}

/// An anchor that stays where it is: the rope, and every event of it, is that of a trace with a fixed anchor.
fn tied(
    model: &Model,
    trace: &SettledEnds,
    job: &Job,
    candidates: &mut impl Candidates,
) -> Result<EndsRecord, EngineError> {
    let model = model.tied(trace.start()).expect("the start of a settled trace is sound");
    let (path, mut progress, mut tried) = (trace.path(End::Free), Progress::new(), Vec::new());
    progress.start(&model, path);
    let (mut told, mut tests) = (0, 0);
    while !progress.is_done(path) {
        job.go_on()?;
        let at = progress.at;
        tried.clear();
        let pivot = progress.rope.contacts().last().map(|contact| contact.vertex);
        candidates((pivot, progress.rope.pivot()), [path.points()[at], path.points()[at + 1]], &mut tried);
        progress.next(&model, path, tried.iter().copied());
        tests += tried.len();
        let step = path.step(progress.at);
        if step - told >= TELL || progress.is_done(path) {
            job.count(step - told);
            job.count_tests(tests as u64);
            (told, tests) = (step, 0);
        }
    }
    let record = progress.record(path);
    let ends = vec![End::Free; record.events.len()];
    Ok(EndsRecord { record, ends })
}

fn free(
    model: &Model,
    trace: &SettledEnds,
    job: &Job,
    candidates: &mut impl Candidates,
) -> Result<EndsRecord, EngineError> {
    let mut rope = FreeRope::new(trace.start().into());
    let (mut at, mut tried) = ([0, 0], Vec::new());
    let (mut events, mut ends) = (Vec::new(), Vec::new());
    let (mut max_length, mut max_depth) = (0f64, 0);
    let steps = trace.steps();
    let (mut told, mut tests) = (0, 0);
    for step in 0..=steps {
        job.go_on()?;
        for (end, at) in [End::Free, End::Anchor].into_iter().zip(&mut at) {
            let path = trace.path(end);
            while *at + 1 < path.points().len() && path.step(*at + 1) <= step {
                *at += 1;
                let each = |kind, vertex, side| {
                    events.push(Event { step: step as u32, kind, vertex, side });
                    ends.push(end);
                };
                tests += drag(&mut rope, end, path.point(*at), model.vertices(), &mut tried, candidates, each);
            }
        }
        let (length, depth) = rope.measure();
        (max_length, max_depth) = (max_length.max(length), max_depth.max(depth));
        if step % TELL == 0 || step == steps {
            job.count(step - told);
            job.count_tests(tests as u64);
            (told, tests) = (step, 0);
        }
    }
    let (length, depth) = rope.measure();
    let record = TraceRecord {
        trace: trace.path(End::Free).id(),
        status: if trace.breaks_rules() { Status::Violation } else { Status::Ok },
        steps: steps as u64,
        length,
        max_length,
        depth,
        max_depth,
        wraps: rope.taut().iter().map(|contact| (contact.at, contact.side)).collect(),
        pull: rope.pull(End::Free),
        events,
    };
    Ok(EndsRecord { record, ends })
}
