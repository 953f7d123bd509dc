//! The batch pipeline at its edges, and on real scenes: always the reference's records, event for event.

use std::sync::Arc;

use glam::DVec2;
use tautline::candidates::{LISTS_BUDGET, Lists, Query, ROOM, Simd};
use tautline::engine::{Cpu, Engine, EngineError, Funnel, GpuWindows, Job, Note, Reference};
use tautline::example::{Walker, floor_plan, random_walls, walks};
use tautline::gpu::{SWEEP_WGSL, Tuning};
use tautline::rope::TraceRecord;
use tautline::scene::{Model, Scene, read_scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::engine_table::Subject;
use crate::support::{self, cases, posts, software};

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

/// The engine `gpu-windows` with rounds of a given number of queries, that asks the GPU about every pivot.
fn gpu(model: &Arc<Model>, queries: usize) -> GpuWindows {
    let tuning = Tuning { queries, workgroup: 64 };
    GpuWindows::with(software(), Lists::new(model.clone()).after(0), LISTS_BUDGET, tuning, SWEEP_WGSL).unwrap()
}

fn settled(model: &Model, traces: &[Trace]) -> Vec<SettledTrace> {
    traces.iter().map(|t| settle(model, t)).collect()
}

fn example(walker: Walker, count: u64) -> (Arc<Model>, Vec<SettledTrace>) {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces = settled(&model, &walks(&model, walker, count));
    (model, traces)
}

/// Compares all engines with the reference, which must have met events for that to mean anything.
fn agree(model: &Arc<Model>, traces: &[SettledTrace]) {
    let truth = run(&mut Reference::new(model.clone()), traces);
    assert!(truth.iter().any(|r| r.events.len() > 4), "nothing happened to compare");
    Subject::usual().iter().for_each(|subject| subject.check(model, traces, &truth, &subject.run(model, traces)));
    assert_eq!(run(&mut gpu(model, 1 << 13), traces), truth);
}

#[test]
fn batches_larger_than_the_slots() {
    let (model, mut traces) = example(Walker { step: 0.3, steps: 200, seed: 5 }, 40);
    // Traces of all lengths, so that slots are freed at different times.
    for (i, short) in walks(&model, Walker { step: 0.3, steps: 7, seed: 6 }, 40).into_iter().enumerate() {
        traces.insert(i * 2, settle(&model, &short));
    }
    let truth = run(&mut Reference::new(model.clone()), &traces);
    for slots in [1, 3, 79, 80, 81] {
        assert_eq!(run(&mut gpu(&model, slots), &traces), truth, "{slots} slots");
    }
}

/// Whatever thread a trace comes to, and after whatever other trace.
#[test]
fn the_final_rope_of_a_trace_does_not_depend_on_the_others() {
    let (model, traces) = example(Walker { step: 0.3, steps: 200, seed: 9 }, 60);
    let mut engine = Funnel::new(model).final_only();
    let alone: Vec<_> = traces.iter().map(|t| run(&mut engine, std::slice::from_ref(t)).remove(0)).collect();
    assert!(alone.iter().any(|r| r.events.len() > 4), "nothing happened to compare");
    let backwards: Vec<_> = traces.iter().rev().cloned().collect();
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| run(&mut engine, &traces)), alone, "{threads} threads");
        let records = pool.install(|| run(&mut engine, &backwards));
        assert!(records.iter().rev().eq(&alone), "{threads} threads, backwards");
    }
}

/// The triangulation is kept from batch to batch unless a trace leads out of its frame.
#[test]
fn the_funnels_frame_grows_with_the_traces() {
    let (model, traces) = example(Walker { step: 0.3, steps: 100, seed: 7 }, 10);
    let out = |size: f64| {
        let points = [[1.0, 0.1], [1.1, 1.0], [-1.0, 1.1], [-1.1, -1.0], [0.1, -1.1]];
        let points = points.iter().map(|&p| model.anchor() + size * DVec2::from(p)).collect();
        settle(&model, &Trace { id: 0, points })
    };
    let mut engine = Funnel::new(model.clone());
    for batch in [&traces[..], &[out(1e2)], &[out(1e9)], &traces, &[out(1e3)]] {
        let records = run(&mut engine, batch);
        assert_eq!(records, run(&mut Funnel::new(model.clone()), batch));
        let [truth, found] = [run(&mut Reference::new(model.clone()), batch), records].map(|records| {
            records.into_iter().map(|r| (r.length, r.max_length, r.wraps, r.max_depth)).collect::<Vec<_>>()
        });
        assert_eq!(found, truth);
    }
}

/// The baseline is right on a lone wrap and wrong on two in one step, of which it sees one.
#[test]
fn the_notes_listing_sees_one_event_a_step() {
    let wall = |x: f64| [DVec2::new(x, 0.0), DVec2::new(x, 5.0)];
    let model = Arc::new(Model::new(Scene::new([wall(1.0), wall(2.0)]).unwrap(), Some(DVec2::new(0.0, 1.0))).unwrap());
    let events = |engine: &mut dyn Engine, points: &[[f64; 2]]| {
        let points = points.iter().copied().map(DVec2::from).collect();
        let record = run(engine, &[settle(&model, &Trace { id: 0, points })]).remove(0);
        record.events.iter().map(|e| (e.step, e.vertex)).collect::<Vec<_>>()
    };
    let slowly = [[0.0, -1.0], [1.5, -1.0], [1.5, 0.5], [1.9, -0.5], [3.0, -0.5], [3.0, 1.0]];
    assert_eq!(events(&mut Note::new(model.clone()), &slowly), events(&mut Reference::new(model.clone()), &slowly));
    let at_once = [[0.0, -1.0], [1.5, -1.5], [4.0, 0.5]];
    assert_eq!(events(&mut Reference::new(model.clone()), &at_once).len(), 2);
    assert_eq!(events(&mut Note::new(model.clone()), &at_once).len(), 1);
}

/// 60 wall ends on an arc about the anchor, swept in a few steps: each step meets more than a query has room for.
#[test]
fn overflowing_queries_are_evaluated_exactly() {
    let end = |k: usize, r: f64| r * DVec2::from_angle(-0.7 + 1.4 * k as f64 / 59.0);
    let walls = (0..60).map(|k| [end(k, 1.0 + 0.01 * (k % 7) as f64), end(k, 0.4)]);
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::ZERO)).unwrap());
    let at = |turn: f64| 3.0 * DVec2::from_angle(turn);
    let points: Vec<DVec2> = vec![at(-1.2), at(-0.9), at(1.0), at(1.3), at(-1.1), at(0.1), at(-1.0)];
    let lists = Lists::new(model.clone());
    let (simd, mut found) = (Simd::detected(), vec![]);
    let query = Query::leg(lists.frame(), model.anchor(), points[1], points[2]);
    simd.sweep(lists.all(), &query, 60 * 2, &mut found);
    assert!(found.len() > ROOM, "no overflow: {found:?}");
    // The first leg, from the anchor to the ring, is clear: it goes below all walls.
    let traces = settled(&model, &[Trace { id: 0, points }]);
    assert_eq!(traces[0].violation(), None);
    agree(&model, &traces);
}

#[test]
fn real_coasts() {
    let scene = read_scene(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/aegean.geojson").as_ref()).unwrap();
    let model = Arc::new(Model::new(scene, None).unwrap());
    for (step, steps) in [(0.5, 1000), (5.0, 200), (25.0, 100)] {
        let walker = Walker { step, steps, seed: 11 };
        agree(&model, &settled(&model, &walks(&model, walker, 20)));
    }
}

/// More vertices than one page holds.
#[test]
fn lists_of_several_pages() {
    let model = posts();
    assert_eq!(model.vertices().len(), 20_000);
    let traces = settled(&model, &walks(&model, Walker { step: 0.8, steps: 200, seed: 2 }, 10));
    agree(&model, &traces);
    let tuning = Tuning { queries: 64, workgroup: 64 };
    let all = Lists::new(model.clone()).keep_all();
    let mut engine = GpuWindows::with(software(), all, LISTS_BUDGET, tuning, SWEEP_WGSL).unwrap();
    assert_eq!(run(&mut engine, &traces), run(&mut Reference::new(model.clone()), &traces));
}

/// Lists come and go within a budget that holds a few of them only.
#[test]
fn lists_that_do_not_fit_the_budget_are_made_again() {
    // More pivots than a thread keeps at hand.
    let model = Arc::new(Model::new(random_walls(1000, 1), None).unwrap());
    let traces = settled(&model, &walks(&model, Walker { step: 0.02, steps: 500, seed: 9 }, 100));
    let truth = run(&mut Reference::new(model.clone()), &traces);
    let mut roomy = Cpu::with_lists(Lists::new(model.clone()).after(0));
    assert_eq!(run(&mut roomy, &traces), truth);
    let once = roomy.lists().made();
    let mut cramped = Cpu::with_lists(Lists::new(model.clone()).after(0).budget(1 << 14));
    assert_eq!(run(&mut cramped, &traces), truth);
    assert!(cramped.lists().made() > 2 * once, "{} lists, with room {once}", cramped.lists().made());
    // On the device there are two blocks of three pages at least, since a list may hold all 20,000 vertices.
    let model = posts();
    let traces = settled(&model, &walks(&model, Walker { step: 0.8, steps: 100, seed: 4 }, 150));
    let tuning = Tuning { queries: 7, workgroup: 64 };
    let mut gpu =
        GpuWindows::with(software(), Lists::new(model.clone()).after(0).budget(1 << 14), 0, tuning, SWEEP_WGSL)
            .unwrap();
    assert_eq!(run(&mut gpu, &traces), run(&mut Reference::new(model.clone()), &traces));
    assert!(gpu.pass().emptied() > 2, "{} blocks were emptied", gpu.pass().emptied());
}

#[test]
fn a_stopped_funnel_of_final_ropes_ends_early_and_one_that_is_not_counts_all_steps() {
    let (model, traces) = example(Walker { step: 0.01, steps: 5000, seed: 1 }, 3);
    let mut engine = Funnel::new(model).final_only();
    let job = Job::new();
    job.stop();
    assert!(matches!(engine.evaluate(&traces, &job), Err(EngineError::Stopped)));
    assert_eq!(job.steps(), 0);
    let job = Job::new();
    engine.evaluate(&traces, &job).unwrap();
    assert_eq!(job.steps(), 15_000);
}

/// The golden ropes where the device is asked about every pivot.
#[test]
fn golden_ropes_from_the_device() {
    let (mut judged, mut wrong) = (0, vec![]);
    for case in cases() {
        let model = case.model();
        let (n, w) = case.differences(&model, &run(&mut support::gpu(&model), &case.settled(&model)));
        judged += n;
        wrong.extend(w);
    }
    assert!(wrong.is_empty(), "{} of {judged} ropes differ:\n{}", wrong.len(), wrong.join("\n"));
    assert!(judged > 15_000, "only {judged} ropes were judged");
}

/// Short walls along a ring, all ends of which see most others: looks and lists give up, and all vertices are tried.
/// Their number is also more than one page holds, so that lists of different lengths share a page.
#[test]
fn where_all_sees_all_everything_is_tried() {
    let n = 4500;
    let turn = |k: f64| DVec2::from_angle(std::f64::consts::TAU * k / f64::from(n));
    let walls = (0..n).map(|k| [turn(f64::from(k)), 1.0001 * turn(f64::from(k))]);
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::new(0.05, 0.0))).unwrap());
    let trace = |id: u64| {
        let out = (37 * id % 4500) as f64 + 0.5;
        let around = (0..12).map(|j| 1.2 * turn(out + 70.0 * f64::from(j)));
        Trace { id, points: [model.anchor(), 0.999 * turn(out)].into_iter().chain(around).collect() }
    };
    let traces = settled(&model, &(0..12).map(trace).collect::<Vec<_>>());
    agree(&model, &traces);
    let visible = Lists::new(model.clone()).after(0);
    assert!(
        visible.of(model.pivot(None), f64::INFINITY).is_some_and(|list| list.len() == 9000),
        "the anchor does not see too much"
    );
}

/// Walls that lie on each other are cut by each other's ends into more pieces than are kept.
#[test]
fn walls_that_lie_on_each_other() {
    let walls = (0..400).map(|k| {
        let x = 1.0 + f64::from(k) / 512.0;
        [DVec2::new(-x, 0.25), DVec2::new(x, 0.25)]
    });
    let walls = walls.chain([[DVec2::new(0.5, -1.0), DVec2::new(0.75, -0.5)]]);
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::ZERO)).unwrap());
    let points =
        [[0.0, -1.5], [3.0, -1.5], [3.0, 2.0], [-3.0, 2.0], [-3.0, -2.0], [1.0, -0.5]].map(DVec2::from).to_vec();
    agree(&model, &settled(&model, &[Trace { id: 0, points }]));
}
