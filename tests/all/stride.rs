//! Coarser traces: which points are left out, and that all engines make the same of what is left.

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::engine::{Cpu, Engine, Funnel, Job, Reference};
use tautline::rope::TraceRecord;
use tautline::scene::Model;
use tautline::trace::{SettledTrace, Trace, settle, settle_strided};

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
                let settled = settle_strided(&model, trace.clone(), k);
                let (used, jumps) = used(&model, &trace, k);
                prop_assert!(settled.violation().is_none());
                prop_assert_eq!((settled.jumps(), settled.steps()), (jumps, trace.points.len() - 1));

                // The same points as a trace of their own, whose steps are numbered anew.
                let points = used.iter().map(|&i| trace.points[i]).collect();
                let own = settle(&model, &Trace { id: 5, points });
                let mut truth = run(&mut Reference::new(&model), &own);
                truth.events.iter_mut().for_each(|e| e.step = used[e.step as usize] as u32);
                truth.steps = settled.steps() as u64;
                prop_assert_eq!(&run(&mut Reference::new(&model), &settled), &truth);
                prop_assert_eq!(&run(&mut Cpu::new(&model), &settled), &truth);
                let funnel = run(&mut Funnel::new(&model), &settled);
                prop_assert_eq!(
                    (&funnel.wraps, funnel.steps, funnel.length),
                    (&truth.wraps, truth.steps, truth.length)
                );
                let of_own = run(&mut Funnel::new(&model), &own).events;
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
    let model = Model::new(floor_plan(), None).unwrap();
    let traces: Vec<SettledTrace> = walks(&model, Walker { step: 0.25, steps: 103, seed: 4 }, 40)
        .into_iter()
        .map(|trace| settle_strided(&model, trace, 4))
        .collect();
    assert!(traces.iter().any(|t| t.jumps() > 0 && t.is_thinned()) && traces.iter().all(|t| t.points().len() < 100));
    let job = Job::new();
    let truth = Reference::new(&model).evaluate(&traces, &job).unwrap();
    assert_eq!(job.steps(), 40 * 103);
    let job = Job::new();
    assert_eq!(gpu(&model).evaluate(&traces, &job).unwrap(), truth);
    assert_eq!(job.steps(), 40 * 103);
    assert!(truth.iter().all(|record| record.steps == 103));
    assert!(truth.iter().flat_map(|record| &record.events).all(|e| e.step.is_multiple_of(4) || e.step <= 103));
}

#[test]
fn a_violation_keeps_its_step() {
    let wall = [[[2.5, -9.0].into(), [2.5, 9.0].into()]];
    let model = Model::new(tautline::scene::Scene::new(wall).unwrap(), Some([0.0, 0.0].into())).unwrap();
    let points = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0].map(|x| [x, 0.0].into()).to_vec();
    let settled = settle_strided(&model, Trace { id: 1, points: points.clone() }, 3);
    assert_eq!(settled.violation(), settle(&model, &Trace { id: 1, points }).violation());
    assert_eq!((settled.violation().unwrap().step, settled.jumps()), (5, 1));
}
