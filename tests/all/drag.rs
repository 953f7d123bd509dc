//! The kernel that takes traces along: what it is certain of is what the exact update says, however little room it has,
//! and the comparison is able to fail.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};
use tautline::candidates::Lists;
use tautline::engine::{Engine, EngineError, Gpu, Job, Reference};
use tautline::example::{Walker, floor_plan, lattice_walls, random_walls, settled_walks, walks};
use tautline::gpu::{DRAG_WGSL, DragPass, Tuning};
use tautline::rope::TraceRecord;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::support::software;

const PLENTY: usize = 128 << 20;

fn engine(model: &Arc<Model>, memory: usize, lanes: usize, wgsl: &str) -> Gpu {
    let tuning = Tuning { queries: lanes, workgroup: 64 };
    Gpu::with(software().with_memory(memory), Lists::new(model.clone()).after(0), tuning, wgsl).unwrap()
}

fn truth(model: &Arc<Model>, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    Reference::new(model.clone()).evaluate(traces, &Job::new()).unwrap()
}

/// The first trace of which the engine says something else than the reference.
fn differs(engine: &mut Gpu, traces: &[SettledTrace], truth: &[TraceRecord]) -> Option<String> {
    let records = engine.evaluate(traces, &Job::new()).unwrap();
    assert_eq!(records.len(), truth.len());
    let (record, truth) = records.iter().zip(truth).find(|(record, truth)| record != truth)?;
    Some(format!("{record:?} instead of {truth:?}"))
}

/// Numbers from -1 to 1.
struct Draws(TestRng);

impl Draws {
    fn next(&mut self) -> f64 {
        f64::from(self.0.next_u32() as i32) / f64::from(1u32 << 31)
    }

    fn below(&mut self, n: usize) -> usize {
        self.0.next_u32() as usize % n
    }
}

/// Some short walls.
fn short_walls(count: usize, draws: &mut Draws) -> Arc<Model> {
    let mut point = || DVec2::new(draws.next(), draws.next());
    let walls: Vec<_> = (0..count).map(|_| (point(), 0.1 * point())).map(|(p, way)| [p, p + way]).collect();
    Arc::new(Model::new(Scene::new(walls).unwrap(), Some(point())).unwrap())
}

/// A trace that leads from line to line through two wall ends, or one and the anchor, or one of the last points, always
/// within some units of the grid from it, and often from the wall end itself; no leg touches a wall.
fn nearly_on_lines(model: &Arc<Model>, legs: usize, id: u64, draws: &mut Draws) -> SettledTrace {
    let mut points = vec![model.anchor()];
    while points.len() <= legs {
        let vertices = model.vertices();
        let p = vertices[draws.below(vertices.len())];
        let from = match draws.below(4) {
            0 => model.anchor(),
            1 => points[points.len() - 1],
            2 => points[points.len().saturating_sub(2)],
            _ => vertices[draws.below(vertices.len())],
        };
        let along = [1e-7, 1e-5, 1e-3, 0.1, 0.5][draws.below(5)] * (draws.next() + 0.2);
        let off = 2f64.powi(-29) * [0.0, 0.4, 1.0, 3.0, 40.0, 1000.0][draws.below(6)] * draws.next().signum();
        let way = (p - from).normalize_or(DVec2::X);
        let q = p + along * way + off * way.perp();
        if q.abs().max_element() < 3.0 && model.is_clear(points[points.len() - 1], q) {
            points.push(q);
        }
    }
    settle(model, &Trace { id, points })
}

/// Scenes of a few walls, and traces of `legs` legs in each.
fn degenerate(scenes: usize, traces: usize, legs: usize) -> Vec<(Arc<Model>, Vec<SettledTrace>)> {
    let mut draws = Draws(TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    (0..scenes)
        .map(|scene| {
            let model = short_walls(3 + scene % 5, &mut draws);
            let traces = (0..traces as u64).map(|id| nearly_on_lines(&model, legs, id, &mut draws)).collect();
            (model, traces)
        })
        .collect()
}

/// How many of the steps were decided on the device, of those of traces that go there.
fn share_decided(engine: &mut Gpu, traces: &[SettledTrace]) -> f64 {
    let job = Job::new();
    engine.evaluate(traces, &job).unwrap();
    1.0 - job.doubts() as f64 / job.steps() as f64
}

/// Over some million legs near lines; `TAUTLINE_SCENES=220` in the environment makes that 10^7.
#[test]
fn no_sign_that_is_certain_is_wrong() {
    let scenes = std::env::var("TAUTLINE_SCENES").map_or(20, |count| count.parse().expect("a number of scenes"));
    let mut steps = 0;
    for (model, traces) in degenerate(scenes, 128, 400) {
        let truth = truth(&model, &traces);
        assert!(truth.iter().map(|r| r.events.len()).sum::<usize>() > 1000, "little happens");
        let mut engine = engine(&model, PLENTY, 128, DRAG_WGSL);
        assert_eq!(differs(&mut engine, &traces, &truth), None);
        steps += traces.iter().filter(|t| !t.breaks_rules()).map(SettledTrace::steps).sum::<usize>();
    }
    assert!(steps > 45_000 * scenes, "{steps}");
}

#[test]
fn a_bound_that_is_too_small_is_found_out() {
    let mut scenes = degenerate(6, 64, 400);
    // Walls on one line.
    for (scene, step) in [(floor_plan(), 0.25), (lattice_walls(60, 2), 0.9)] {
        let model = Arc::new(Model::new(scene, None).unwrap());
        let walks = settled_walks(&model, Walker { step, steps: 400, seed: 6 }, 64);
        scenes.push((model, walks));
    }
    let truths: Vec<_> = scenes.iter().map(|(model, traces)| truth(model, traces)).collect();
    let changes = [
        ("const SHARE: f32 = 0.00000095367431640625;", "const SHARE: f32 = 0.0;"),
        ("const OFF: f32 = 1.25;", "const OFF: f32 = 0.0;"),
        ("(abs(left) + abs(right)) * SHARE + more", "more"),
        ("products * (2.0 * SHARE) + 2.0 * OFF * sum_of(ray) + 2.0 * sums", "0.0"),
        ("let turn = left - right;", "let turn = left + right;"),
        ("past_ray < 0.0 && past_way < 0.0)", "past_ray < 0.0)"),
        ("low_number != way_low", "low_number == way_low"),
        ("beyond < -bound", "beyond > -bound"),
        ("var next_back = -dir;", "var next_back = dir;"),
        ("let last = goes_on >> 1u;", "let last = goes_on / 2u + 1u;"),
        ("(goes_on & 1u) == 1u && dir > 0.0", "false"),
        ("max(farthest, wb.x * wb.x + wb.y * wb.y)", "wb.x * wb.x"),
    ];
    for (right, wrong) in changes {
        assert_eq!(DRAG_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        let changed = DRAG_WGSL.replace(right, wrong);
        let found = scenes.iter().zip(&truths).any(|((model, traces), truth)| {
            match engine(model, PLENTY, 64, &changed).evaluate(traces, &Job::new()) {
                Ok(records) => records != *truth,
                Err(EngineError::Gpu(error)) => error.to_string().contains("it named an event that cannot be"),
                Err(other) => panic!("{other}"),
            }
        });
        assert!(found, "{wrong:?} in the place of {right:?} went unnoticed");
    }
}

#[test]
fn most_of_a_walk_is_certain() {
    let model = Arc::new(Model::new(random_walls(60, 1), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.03, steps: 800, seed: 2 }, 400);
    let truth = truth(&model, &traces);
    let mut engine = engine(&model, PLENTY, 400, DRAG_WGSL);
    assert_eq!(differs(&mut engine, &traces, &truth), None);
    let share = share_decided(&mut engine, &traces);
    assert!(share > 0.99, "{share}");
}

#[test]
fn any_room_will_do() {
    let model = Arc::new(Model::new(random_walls(40, 3), None).unwrap());
    let mut traces = settled_walks(&model, Walker { step: 0.05, steps: 300, seed: 4 }, 30);
    traces.extend(settled_walks(&model, Walker { step: 0.05, steps: 3, seed: 5 }, 9));
    traces.push(settle(&model, &Trace { id: 99, points: vec![model.anchor()] }));
    let truth = truth(&model, &traces);
    // Room for pieces of a few legs, for a few fans, for none; lanes for one trace, for some, for all.
    for memory in [0, 1 << 12, 1 << 15, 1 << 17, 1 << 19, 1 << 21, PLENTY] {
        for lanes in [0, 1, 7, 64] {
            let mut engine = engine(&model, memory, lanes, DRAG_WGSL);
            for _ in 0..2 {
                assert_eq!(differs(&mut engine, &traces, &truth), None, "{memory} bytes, {lanes} lanes");
            }
        }
    }
}

#[test]
fn a_pass_takes_no_more_memory_than_it_is_given() {
    for shift in 14..34 {
        for lanes in [1, 64, 1 << 13, 1 << 16] {
            let room = DragPass::most(&software().with_memory(1 << shift), lanes);
            // A lane, a chunk of points and a ray are the least.
            assert!(room.bytes() <= (1 << shift).max(8 << 10), "2^{shift} bytes, {lanes} lanes: {room:?}");
            assert!(room.lanes <= lanes);
        }
    }
}

#[test]
fn walls_on_one_line_are_certain() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.25, steps: 1000, seed: 3 }, 400);
    let truth = truth(&model, &traces);
    let mut engine = engine(&model, PLENTY, 400, DRAG_WGSL);
    assert_eq!(differs(&mut engine, &traces, &truth), None);
    let share = share_decided(&mut engine, &traces);
    assert!(share > 0.99, "{share}");
}

#[test]
fn pieces_of_long_traces_follow_each_other() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let long = walks(&model, Walker { step: 0.3, steps: 20_000, seed: 7 }, 8);
    let traces: Vec<_> = long.iter().map(|t| settle(&model, t)).collect();
    let truth = truth(&model, &traces);
    assert_eq!(differs(&mut engine(&model, PLENTY, 8, DRAG_WGSL), &traces, &truth), None);
}

/// Round and round a post, so that the rope has more contacts than a lane's stack, and back; one leg of it has more
/// events than a lane notes.
#[test]
fn ropes_may_be_deeper_than_the_stack() {
    let corner = |x: f64, y: f64| DVec2::new(x, y);
    let square = [corner(-1.0, -1.0), corner(1.0, -1.1), corner(1.05, 1.0), corner(-1.1, 1.03)];
    let mut walls: Vec<[DVec2; 2]> = (0..4).map(|i| [square[i], square[(i + 1) % 4]]).collect();
    // A row of pins nearly on one line, each a bit further to the left.
    walls.extend((0..50).map(|i| {
        let x = 3.0 + 0.1 * f64::from(i);
        let p = DVec2::new(x, 1e-4 * (x - 3.0).powi(2) - 3.0);
        [p, p - DVec2::new(0.0, 1e-7)]
    }));
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(corner(-2.0, -3.2))).unwrap());
    let mut points = vec![model.anchor(), corner(9.0, -3.6), corner(9.0, -2.0)];
    let turn = |k: i32| DVec2::from_angle(0.7 * f64::from(k) - 0.3) * 2.2;
    points.extend((0..120).map(turn));
    points.extend((0..120).rev().map(turn));
    points.extend([corner(9.0, -2.0), corner(9.0, -3.6), model.anchor()]);
    let trace = |id: u64, drop: usize| settle(&model, &Trace { id, points: points[..points.len() - drop].to_vec() });
    let traces: Vec<_> = (0..64).map(|id| trace(id, 2 * id as usize)).collect();
    assert!(traces.iter().all(|t| !t.breaks_rules()));
    let truth = truth(&model, &traces);
    assert!(truth.iter().any(|r| r.max_depth > 40), "{}", truth[0].max_depth);
    assert_eq!(differs(&mut engine(&model, PLENTY, 64, DRAG_WGSL), &traces, &truth), None);
}

#[test]
fn traces_that_touch_or_cross_walls_or_leave_the_grid_are_evaluated_too() {
    let model = Arc::new(Model::new(lattice_walls(60, 2), None).unwrap());
    let mut traces = settled_walks(&model, Walker { step: 0.4, steps: 100, seed: 8 }, 20);
    let far = DVec2::new(1e9, 3e9);
    traces.push(settle(&model, &Trace { id: 98, points: vec![model.anchor(), far, -far, model.vertices()[3]] }));
    let truth = truth(&model, &traces);
    assert_eq!(differs(&mut engine(&model, PLENTY, 20, DRAG_WGSL), &traces, &truth), None);
}

#[test]
fn a_device_that_tells_what_cannot_be_is_found_out() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.3, steps: 100, seed: 9 }, 50);
    let changes = [
        ("events++;", "events = 77u;"),
        ("point += select(0u, 1u, goes_on);", "point += select(0u, 1000000u, goes_on);"),
        ("depth = select(depth - 1u, depth + 1u, is_wrap);", ""),
        ("pivot = next;", "pivot = 0x7fffffffu;"),
        ("vec4<u32>(point, vertex, bit", "vec4<u32>(point, 12345678u, bit"),
        ("vertex = UNWRAP;", ""),
    ];
    for (right, wrong) in changes {
        assert_eq!(DRAG_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        let mut engine = engine(&model, PLENTY, 64, &DRAG_WGSL.replace(right, wrong));
        for _ in 0..2 {
            match engine.evaluate(&traces, &Job::new()) {
                Ok(_) => panic!("{wrong:?} in the place of {right:?} went unnoticed"),
                Err(error) => assert!(error.to_string().contains("it named an event that cannot be"), "{error}"),
            }
        }
    }
}
