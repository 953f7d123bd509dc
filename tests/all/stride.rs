//! Coarser traces: which points are left out, and that all engines make the same of what is left.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::engine::{Cpu, Engine, Funnel, Job, Reference};
use tautline::rope::{Status, TraceRecord};
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::scenes::{KINDS, recipe};
use crate::support::gpu;

fn run(engine: &mut dyn Engine, trace: &SettledTrace) -> TraceRecord {
    engine.evaluate(std::slice::from_ref(trace), &Job::new()).unwrap().remove(0)
}

/// The numbers of the trace's points that a stride of `k` uses, by its definition, and the jumps.
fn used(model: &Model, trace: &Trace, k: usize) -> (Vec<usize>, usize) {
    let (mut used, mut jumps) = (vec![0], 0);
    let last = trace.points.len() - 1;
    for from in (0..last).step_by(k) {
        let to = last.min(from + k);
        // No wall may touch the longer step, not even where it starts.
        let [a, b] = [from, to].map(|i| trace.points[i]);
        if to == from + 1 || (model.is_clear(a, b) && model.is_clear(b, a)) {
            used.push(to);
        } else {
            jumps += 1;
            used.extend(from + 1..=to);
        }
    }
    (used, jumps)
}

#[test]
fn all_engines_make_the_same_of_a_coarser_trace() {
    let default = ProptestConfig::default();
    for kind in KINDS {
        for touching in [false, true] {
            let config = ProptestConfig { cases: default.cases / 8, failure_persistence: None, ..default.clone() };
            let result = TestRunner::new(config).run(&(recipe(kind, touching), 1usize..9), |(recipe, k)| {
                let model = recipe.model();
                let trace = recipe.trace(&model, 5);
                let settled = settle(&model, &trace).coarsened(&model, k);
                let (used, jumps) = used(&model, &trace, k);
                prop_assert!(!settled.breaks_rules());
                prop_assert_eq!((settled.jumps(), settled.steps()), (jumps, trace.points.len() - 1));

                // The same points as a trace of their own, whose steps are numbered anew.
                let points = used.iter().map(|&i| trace.points[i]).collect();
                let own = settle(&model, &Trace { id: 5, points });
                let mut truth = run(&mut Reference::new(model.clone()), &own);
                truth.events.iter_mut().for_each(|e| e.step = used[e.step as usize] as u32);
                truth.steps = settled.steps() as u64;
                prop_assert_eq!(&run(&mut Reference::new(model.clone()), &settled), &truth);
                prop_assert_eq!(&run(&mut Cpu::new(model.clone()), &settled), &truth);
                let funnel = run(&mut Funnel::new(model.clone()), &settled);
                prop_assert_eq!(
                    (&funnel.wraps, funnel.steps, funnel.length),
                    (&truth.wraps, truth.steps, truth.length)
                );
                let of_own = run(&mut Funnel::new(model.clone()), &own).events;
                let mapped = of_own.iter().map(|e| used[e.step as usize] as u32);
                prop_assert!(funnel.events.iter().map(|e| e.step).eq(mapped));

                // After steps that were left out it stays where it was.
                let ends = settled.ends();
                prop_assert_eq!(ends.len(), trace.points.len());
                for (step, end) in ends.iter().enumerate() {
                    prop_assert_eq!(end, &trace.points[used[used.partition_point(|&u| u <= step) - 1]]);
                }
                Ok(())
            });
            result.unwrap_or_else(|e| panic!("{kind:?}, touching {touching}: {e}"));
        }
    }
}

#[test]
fn the_gpu_counts_the_same_steps() {
    use tautline::example::{Walker, floor_plan, walks};
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces: Vec<SettledTrace> = walks(&model, Walker { step: 0.25, steps: 103, seed: 4 }, 40)
        .into_iter()
        .map(|trace| settle(&model, &trace).coarsened(&model, 4))
        .collect();
    assert!(traces.iter().any(|t| t.jumps() > 0 && t.is_thinned()) && traces.iter().all(|t| t.points().len() < 100));
    let job = Job::new();
    let truth = Reference::new(model.clone()).evaluate(&traces, &job).unwrap();
    assert_eq!(job.steps(), 40 * 103);
    let job = Job::new();
    assert_eq!(gpu(&model).evaluate(&traces, &job).unwrap(), truth);
    assert_eq!(job.steps(), 40 * 103);
    assert!(truth.iter().all(|record| record.steps == 103));
    // Every fourth step, the last, and those of jumps.
    for (record, trace) in truth.iter().zip(&traces) {
        let steps: Vec<usize> = (0..trace.points().len()).map(|i| trace.step(i)).collect();
        let others = steps.iter().filter(|&&step| step % 4 > 0 && step < 103).count();
        assert!((trace.jumps()..=3 * trace.jumps()).contains(&others), "{others} of {} jumps", trace.jumps());
        assert!(record.events.iter().all(|e| steps.contains(&(e.step as usize))));
    }
}

/// Walls from point to point, and the anchor at the origin.
fn model(walls: &[[[f64; 2]; 2]]) -> Arc<Model> {
    let walls = walls.iter().map(|wall| wall.map(Into::into));
    Arc::new(Model::new(Scene::new(walls).unwrap(), Some([0.0, 0.0].into())).unwrap())
}

fn trace(points: &[[f64; 2]]) -> Trace {
    Trace { id: 1, points: points.iter().map(|&p| p.into()).collect() }
}

#[test]
fn a_violation_keeps_its_step() {
    let model = model(&[[[2.5, -9.0], [2.5, 9.0]]]);
    let given = settle(&model, &trace(&[0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0].map(|x| [x, 0.0])));
    let coarse = given.clone().coarsened(&model, 3);
    assert_eq!(coarse.violation(), given.violation());
    assert_eq!((coarse.violation().unwrap().step, coarse.jumps(), coarse.crossings()), (5, 1, 1));
}

#[test]
fn what_breaks_the_rules_in_steps_that_are_left_out_is_no_secret() {
    let model = model(&[[[1.0, -1.0], [1.0, 1.0]]]);
    // Through the wall and back: straight from the first point to the last, it is not met.
    let given = settle(&model, &trace(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5]]));
    let coarse = given.clone().coarsened(&model, 2);
    assert_eq!(coarse.points(), [[0.0, 0.0].into(), [0.5, 0.5].into()]);
    assert_eq!((coarse.violation(), coarse.violations()), (given.violation(), 2));
    assert_eq!((coarse.crossings(), coarse.jumps(), coarse.breaks_rules()), (0, 0, true));
    let record = run(&mut Cpu::new(model.clone()), &coarse);
    assert_eq!((record.status, record.steps, record.events.len()), (Status::Violation, 2, 0));
}

#[test]
fn walls_that_are_simplified_away_are_still_broken_through() {
    let bump = model(&[[[1.0, -9.0], [1.5, 0.0]], [[1.5, 0.0], [1.0, 9.0]]]);
    let simple = model(&[[[1.0, -9.0], [1.0, 9.0]]]);
    let [into, through] = [&[[0.0, 0.0], [1.2, 0.0]], &[[0.0, 0.0], [1.6, 0.0]]].map(|p| settle(&bump, &trace(p)));
    // Into the bump, which was no wall, and through it, which was one.
    assert_eq!((into.violation(), through.violations()), (None, 1));
    let [into, through] = [into, through].map(|given| given.coarsened(&simple, 1));
    assert_eq!((into.violation(), into.crossings(), into.breaks_rules()), (None, 1, true));
    assert_eq!((through.violation().unwrap().ends[0].x, through.crossings()), (1.0, 1));
    assert_eq!(run(&mut Reference::new(simple.clone()), &into).status, Status::Violation);
}
