//! Engines against each other on random scenes of every kind, with shrinking.

use std::sync::Arc;
use std::sync::OnceLock;

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::candidates::{Lists, Simd};
use tautline::engine::{Cpu, Engine, Funnel, GpuWindows, Job, Reference};
use tautline::gpu::{SWEEP_WGSL, Tuning};
use tautline::rope::{EventKind, Status, TraceRecord, replay};
use tautline::scene::Model;
use tautline::trace::{SettledTrace, Trace, settle};

use crate::scenes::{KINDS, Kind, on_lawful, on_random, recipe};
use crate::support::{gpu_on, software};

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

/// The taut ropes of a trace after every step.
fn ropes(model: &Model, trace: &Trace, record: &TraceRecord) -> Vec<Vec<(u32, &'static str)>> {
    let mut ropes = vec![];
    replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |k, rope| {
        ropes.push(rope.taut(trace.points[k]).iter().map(|c| (c.vertex, c.side.name())).collect());
    });
    ropes
}

/// Runs `test` on random scenes of one kind, with traces that keep to the rules.
fn check(kind: Kind, touching: bool, cases: u32, test: impl Fn(&Arc<Model>, &Trace, &SettledTrace)) {
    on_lawful(kind, touching, cases, |model, trace, settled| {
        assert_eq!(settled.violation(), None);
        test(model, trace, settled);
    });
}

fn reference_agrees_with_funnel(model: &Arc<Model>, trace: &Trace, settled: &SettledTrace) {
    let batch = std::slice::from_ref(settled);
    let [ours, truth] = [run(&mut Reference::new(model.clone()), batch), run(&mut Funnel::new(model.clone()), batch)];
    assert_eq!(ropes(model, trace, &ours[0]), ropes(model, trace, &truth[0]));
    let report = |r: &TraceRecord| TraceRecord { events: vec![], ..r.clone() };
    assert_eq!(report(&ours[0]), report(&truth[0]));
}

#[test]
fn reference_agrees_with_funnel_after_every_step() {
    for kind in KINDS {
        check(kind, false, 1000, reference_agrees_with_funnel);
    }
}

#[test]
fn reference_agrees_with_funnel_where_traces_touch() {
    for kind in KINDS {
        check(kind, true, 1000, reference_agrees_with_funnel);
    }
}

/// After every step: the trace is cut off there, and settled anew, so that it ends as it would there.
fn final_only_agrees_with_funnel(model: &Arc<Model>, trace: &Trace, _: &SettledTrace) {
    let cut = |k: usize| settle(model, &Trace { id: k as u64, points: trace.points[..k].to_vec() });
    let cuts: Vec<_> = (1..=trace.points.len()).map(cut).collect();
    let every_step = run(&mut Funnel::new(model.clone()), &cuts);
    let final_only = run(&mut Funnel::new(model.clone()).final_only(), &cuts);
    assert_eq!(every_step.len(), final_only.len());
    for (every, last) in every_step.iter().zip(&final_only) {
        let result = |r: &TraceRecord| (r.trace, r.status, r.steps, r.length, r.depth, r.wraps.clone(), r.pull);
        assert_eq!(result(every), result(last));
        assert_eq!((last.max_length, last.max_depth), (last.length, last.depth));
        let wraps: Vec<_> = last.events.iter().map(|e| (model.vertices()[e.vertex as usize], e.side)).collect();
        assert_eq!(wraps, last.wraps);
        assert!(last.events.iter().all(|e| (e.kind, u64::from(e.step)) == (EventKind::Wrap, last.steps)));
    }
}

#[test]
fn final_only_gives_the_funnels_ropes() {
    for kind in KINDS {
        for touching in [false, true] {
            check(kind, touching, 300, final_only_agrees_with_funnel);
        }
    }
}

#[test]
fn cpu_gives_the_references_events_whatever_its_lists_and_instructions() {
    for kind in KINDS {
        for touching in [false, true] {
            check(kind, touching, 300, |model, _, settled| {
                let batch = std::slice::from_ref(settled);
                let truth = run(&mut Reference::new(model.clone()), batch);
                assert_eq!(run(&mut Cpu::new(model.clone()).simd(Simd::baseline()), batch), truth);
                assert_eq!(run(&mut Cpu::with_lists(Lists::new(model.clone()).after(0)), batch), truth);
                assert_eq!(run(&mut Cpu::with_lists(Lists::new(model.clone()).after(2)).window(3), batch), truth);
            });
        }
    }
}

#[test]
fn gpu_gives_the_references_events() {
    static ADAPTER: OnceLock<tautline::gpu::Device> = OnceLock::new();
    let adapter = ADAPTER.get_or_init(software);
    for kind in KINDS {
        for touching in [false, true] {
            check(kind, touching, 40, |model, _, settled| {
                let batch = std::slice::from_ref(settled);
                let truth = run(&mut Reference::new(model.clone()), batch);
                assert_eq!(run(&mut gpu_on(adapter.clone(), Lists::new(model.clone()).after(0)), batch), truth);
                assert_eq!(
                    run(&mut gpu_on(adapter.clone(), Lists::new(model.clone()).keep_all()).window(1), batch),
                    truth
                );
            });
        }
    }
}

/// Traces that cross walls at will are evaluated all the same when they are only to be marked: they come to an end, and
/// up to the step that breaks the rules nothing is different.
#[test]
fn lawless_traces_are_lawful_until_they_cross_a_wall() {
    for kind in KINDS {
        for touching in [false, true] {
            on_random(
                kind,
                touching,
                300,
                |recipe, model| recipe.lawless_trace(model, 0),
                |model, trace, settled| {
                    let truth = run(&mut Reference::new(model.clone()), std::slice::from_ref(settled)).remove(0);
                    let Some(violation) = settled.violation() else { return };
                    assert_eq!((truth.status, truth.steps), (Status::Violation, trace.points.len() as u64 - 1));
                    // The step before may pass a wall on another side when the trace does not go on from there.
                    let Some(kept) = violation.step.checked_sub(1).filter(|&k| k > 0) else { return };
                    let start = Trace { id: 0, points: trace.points[..kept].to_vec() };
                    if model.is_on_wall(trace.points[kept - 1]) {
                        return;
                    }
                    let lawful = settle(model, &start);
                    assert_eq!(lawful.violation(), None);
                    let lawful = run(&mut Reference::new(model.clone()), &[lawful]).remove(0);
                    let same =
                        truth.events.iter().take_while(|e| (e.step as usize) < kept).copied().collect::<Vec<_>>();
                    assert_eq!(lawful.events, same);
                },
            );
        }
    }
}

/// Records do not depend on the number of threads, the order of the traces, the size of rounds, or what else is
/// evaluated.
#[test]
fn how_traces_are_batched_changes_nothing() {
    static ADAPTER: OnceLock<tautline::gpu::Device> = OnceLock::new();
    let adapter = ADAPTER.get_or_init(software);
    let pools = [1, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    let shape = (1usize..40, 1usize..8, 0usize..1000, 1usize..300, 0u32..6);
    let config = ProptestConfig { cases: 20 * ProptestConfig::default().cases / 256, ..ProptestConfig::default() };
    for kind in [Kind::Random, Kind::Lattice, Kind::Boxes, Kind::Fine] {
        let mut runner = TestRunner::new(ProptestConfig { failure_persistence: None, ..config.clone() });
        let recipes = prop::collection::vec(recipe(kind, true), 1..12);
        let result = runner.run(&(recipes, shape.clone()), |(recipes, (queries, stride, shift, window, after))| {
            // All traces of the first recipe's scene: those of the others that keep to its walls, and its own.
            let model = recipes[0].model();
            let traces: Vec<Trace> = recipes.iter().zip(0..).map(|(recipe, id)| recipe.trace(&model, id)).collect();
            let settled: Vec<SettledTrace> = traces.iter().map(|t| settle(&model, t)).collect();
            let truth = run(&mut Reference::new(model.clone()), &settled);
            // Another order, with repeats.
            let order: Vec<usize> = (0..3 * settled.len()).map(|i| (i * stride + shift) % settled.len()).collect();
            let mixed: Vec<SettledTrace> = order.iter().map(|&i| settled[i].clone()).collect();
            let expected: Vec<TraceRecord> = order.iter().map(|&i| truth[i].clone()).collect();
            let tuning = Tuning { queries, workgroup: 64 };
            let lists = || Lists::new(model.clone()).after(after);
            for pool in &pools {
                pool.install(|| {
                    assert_eq!(run(&mut Cpu::with_lists(lists()).window(window), &mixed), expected);
                    let gpu = GpuWindows::with(adapter.clone(), lists(), 0, tuning, SWEEP_WGSL).unwrap();
                    assert_eq!(run(&mut gpu.window(window), &mixed), expected);
                });
            }
            Ok(())
        });
        result.unwrap_or_else(|e| panic!("{kind:?}: {e}"));
    }
}
