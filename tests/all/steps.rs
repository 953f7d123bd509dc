//! The rope after every step, against the rope of the trace that ends there, and against sums of angles.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Cpu, Engine, Job, Reference};
use tautline::geometry::{TracePoint, Turn};
use tautline::rope::{EventKind, RopeStep, Steps, TraceRecord, replay};
use tautline::scene::{Centre, Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};
use tautline::trade::Trade;

use crate::scenes::{KINDS, Kind, on_lawful};

/// Where all traces touch walls, sooner or later, and points lie far apart.
const LATTICES: [Kind; 3] = [Kind::Lattice, Kind::Grid, Kind::Boxes];

/// Runs `test` on random scenes of one kind, with traces that keep to the rules.
fn check(kind: Kind, touching: bool, test: impl Fn(&Arc<Model>, &Trace)) {
    on_lawful(kind, touching, 32, |model, trace, _| test(model, trace));
}

fn record(model: &Arc<Model>, trace: &SettledTrace) -> TraceRecord {
    Reference::new(model.clone()).evaluate(std::slice::from_ref(trace), &Job::new()).unwrap().remove(0)
}

fn all_centres(model: &Model) -> Vec<Centre> {
    (0..model.vertices().len() as u32).map(|vertex| Centre { name: vertex.to_string(), vertex }).collect()
}

/// All steps, each with the windings about `centres`.
fn told(model: &Model, trace: &SettledTrace, record: &TraceRecord, centres: &[Centre]) -> Vec<(RopeStep, Vec<i64>)> {
    let mut steps = Steps::new(model, trace, record, centres);
    let mut all = vec![];
    while let Some(step) = steps.next() {
        all.push((step, steps.windings().collect()));
    }
    assert_eq!(steps.next(), None, "it goes on after its end");
    all
}

/// The rope after each step is that of the trace that ends there.
fn steps_are_those_of_cut_traces(model: &Arc<Model>, trace: &Trace) {
    let settled = settle(model, trace);
    let whole = record(model, &settled);
    let all = told(model, &settled, &whole, &[]);
    assert_eq!(all.len(), trace.points.len());
    for (k, (step, _)) in all.iter().enumerate() {
        let cut = record(model, &settle(model, &Trace { id: 0, points: trace.points[..=k].to_vec() }));
        let count = |kind: EventKind| cut.events.iter().filter(|event| event.kind == kind).count();
        let contacts = (count(EventKind::Wrap) - count(EventKind::Unwrap)) as u32;
        let expected = RopeStep {
            step: k as u64,
            at: trace.points[k],
            length: cut.length,
            contacts,
            turns: cut.depth,
            pull: cut.pull,
        };
        assert_eq!(*step, expected, "step {k}");
    }
    assert_eq!(all.iter().map(|(step, _)| step.length).fold(0.0, f64::max), whole.max_length);
    assert_eq!(all.iter().map(|(step, _)| step.turns).max(), Some(whole.max_depth));
}

/// What is told is what the rope's corners come to. (On which side a trace touches a wall's end depends on where it
/// goes on, so that a cut one may have another rope there.)
fn steps_are_sums_over_corners(model: &Arc<Model>, trace: &Trace) {
    let settled = settle(model, trace);
    let whole = record(model, &settled);
    let all = told(model, &settled, &whole, &[]);
    assert_eq!(all.len(), trace.points.len());
    replay(model.anchor(), model.vertices(), trace.points.len(), &whole.events, |k, rope| {
        let (at, taut) = (trace.points[k], rope.taut(trace.points[k]));
        let (mut from, mut length) = (model.anchor(), 0.0);
        for corner in &taut {
            length += from.distance(corner.at);
            from = corner.at;
        }
        length += from.distance(at);
        let (contacts, turns) = (rope.contacts().len() as u32, taut.len() as u32);
        let step = all[k].0;
        assert_eq!(step, RopeStep { step: k as u64, at, length, contacts, turns, pull: step.pull });
        match step.pull {
            None => assert_eq!((from, length), (at, 0.0)),
            Some(pull) => assert!((pull - (from - at).normalize()).length() < 1e-15, "step {k}"),
        }
    });
    let last = &all[all.len() - 1].0;
    assert_eq!((last.length, last.turns, last.pull), (whole.length, whole.depth, whole.pull));
}

#[test]
fn every_step_has_the_rope_of_the_trace_that_ends_there() {
    for kind in KINDS.into_iter().filter(|kind| !LATTICES.contains(kind)) {
        check(kind, false, steps_are_those_of_cut_traces);
    }
}

#[test]
fn every_step_has_its_rope_where_traces_touch() {
    for kind in KINDS {
        check(kind, true, steps_are_sums_over_corners);
    }
}

/// By how much hairs are turned.
const TILT: f64 = 1.0 / 1048576.0;

/// How a point is displaced, by a length of 1 or so.
fn displaced(point: TracePoint) -> DVec2 {
    let Some(hair) = point.hair else { return DVec2::ZERO };
    let way = if hair.away { point.at - hair.witness } else { hair.witness - point.at }.normalize();
    way + way.perp() * if hair.turn == Turn::Left { TILT } else { -TILT }
}

/// Turns about all wall ends, against the sum of the angles under which each sees the steps; `pluck` is how far the
/// points are that stand on wall ends, the first and, after each point, by how much farther the next.
fn turns_are_sums_of_angles(model: &Arc<Model>, trace: &Trace, pluck: f64, farther: f64) {
    let settled = settle(model, trace);
    let all = told(model, &settled, &record(model, &settled), &all_centres(model));
    let hair = |i: usize| displaced(settled.point(i)) * pluck * farther.powi(i as i32);
    let hairs: Vec<DVec2> = (0..settled.points().len()).map(hair).collect();
    // As near to a whole number of turns only exact signs know whether they are complete: hairs
    // are turned by a real angle here.
    let near = 2.0 * TILT;
    for (v, &centre) in model.vertices().iter().enumerate() {
        if pluck == 0.0 && settled.points().contains(&centre) {
            continue;
        }
        let Some(first) = settled.points().iter().position(|&p| p != centre) else { continue };
        // Kahan's sum, in turns.
        let (mut sum, mut rest) = (0.0f64, 0.0f64);
        let mut step = 0;
        for i in 0..settled.points().len() {
            if i > first {
                let [a, b] = [i - 1, i].map(|i| (settled.points()[i] - centre) + hairs[i]);
                // Of vectors near 1, so that no product underflows.
                let (a, b) = (a / a.abs().max_element(), b / b.abs().max_element());
                let angle = a.perp_dot(b).atan2(a.dot(b)) / TAU - rest;
                let next = sum + angle;
                rest = (next - sum) - angle;
                sum = next;
            }
            if settled.ends_step(i) {
                let whole = all[step].1[v] as f64;
                let nearest = sum.round();
                let is_right = match (sum - nearest).abs() < near {
                    true => whole == nearest || whole == nearest - nearest.signum(),
                    false => whole == sum.trunc(),
                };
                assert!(is_right, "{whole} for {sum} turns about {centre} after step {step}");
                step += 1;
            }
        }
    }
}

#[test]
fn turns_are_those_that_angles_sum_up_to() {
    for kind in KINDS.into_iter().filter(|kind| !LATTICES.contains(kind)) {
        check(kind, false, |model, trace| turns_are_sums_of_angles(model, trace, 0.0, 1.0));
    }
}

/// Elsewhere points that are plucked really may change sides.
#[test]
fn turns_are_those_that_angles_sum_up_to_where_traces_touch() {
    for kind in LATTICES {
        check(kind, true, |model, trace| turns_are_sums_of_angles(model, trace, 2f64.powi(-40), 1.2));
    }
}

/// A wall, and a way round its first end and back, some of it on the wall itself.
#[test]
fn turns_are_complete_exactly_where_they_began() {
    let scene = |y_down: bool| {
        let scene = Scene::new([[DVec2::ZERO, DVec2::new(4.0, 0.0)]]).unwrap();
        if y_down { scene.with_y_down() } else { scene }
    };
    let round = [[2.0, -1.0], [5.0, -1.0], [5.0, 1.0], [2.0, 0.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -0.5], [2.0, -1.0]];
    let back: Vec<[f64; 2]> = round.iter().rev().copied().collect();
    let counted = |y_down: bool, points: &[[f64; 2]]| -> Vec<i64> {
        let model = Arc::new(Model::new(scene(y_down), Some([2.0, -1.0].into())).unwrap());
        let settled = settle(&model, &Trace { id: 0, points: points.iter().map(|&p| p.into()).collect() });
        assert_eq!(settled.violation(), None);
        let centre = Centre { name: "wall".into(), vertex: 0 };
        let all = told(&model, &settled, &record(&model, &settled), &[centre]);
        all.into_iter().map(|(_, windings)| windings[0]).collect()
    };
    // (1, -0.5) is on the ray already.
    assert_eq!(counted(false, &round), [0, 0, 0, 0, 0, 0, 1, 1]);
    assert_eq!(counted(true, &round), [0, 0, 0, 0, 0, 0, -1, -1]);
    assert_eq!(counted(false, &back), [0, 0, 0, 0, 0, 0, 0, -1]);
    let there_and_back: Vec<[f64; 2]> = round.iter().chain(&back).copied().collect();
    assert_eq!(counted(false, &there_and_back)[7..], [1, 1, 1, 0, 0, 0, 0, 0, 0]);
    let twice: Vec<[f64; 2]> = round.iter().chain(&round).copied().collect();
    assert_eq!(counted(false, &twice).last(), Some(&2));
}

#[test]
fn steps_that_were_left_out_have_the_rope_of_the_one_before() {
    let model = Arc::new(Model::new(tautline::example::floor_plan(), None).unwrap());
    let walker = tautline::example::Walker { step: 0.25, steps: 203, seed: 3 };
    let mut seen = 0;
    for trace in tautline::example::walks(&model, walker, 20) {
        let thinned = Trade { stride: 8, simplify: None }.coarsened(settle(&model, &trace), &model);
        let record = Cpu::new(model.clone()).evaluate(std::slice::from_ref(&thinned), &Job::new()).unwrap().remove(0);
        let all = told(&model, &thinned, &record, &[]);
        let ends = thinned.ends();
        assert_eq!(all.len(), 204);
        for (k, (step, _)) in all.iter().enumerate() {
            assert_eq!((step.step, step.at), (k as u64, ends[k]));
            if k > 0 && ends[k] == ends[k - 1] {
                assert_eq!((step.length, step.turns), (all[k - 1].0.length, all[k - 1].0.turns));
                seen += 1;
            }
        }
        assert_eq!(all.last().map(|(step, _)| (step.length, step.turns)), Some((record.length, record.depth)));
    }
    assert!(seen > 2000, "{seen}");
}
