//! What `--precision fast` promises: the reference's ropes where f32 holds all products exactly; and everywhere that it
//! comes to an end, with a record that is sound in itself and does not depend on the batch.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::engine::{Engine, FastGpu, Job, Reference};
use tautline::example::{Walker, floor_plan, random_walls, walks};
use tautline::gpu::{DECIDE_WGSL, Device, Tuning};
use tautline::rope::TraceRecord;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::corpus::bodies::engines::is_sound;
use crate::support::{posts, software};

fn fast(device: &Device, model: &Arc<Model>) -> FastGpu {
    FastGpu::new(device.clone(), model.clone()).unwrap()
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

/// A wall: from, to, and whether it is made one along x or y.
type Wall = ([i32; 2], [i32; 2], bool);

/// A walk: its moves, and the unit in which they are.
type Walk = (Vec<[i32; 2]>, f64);

/// Walls between whole numbers, and walks of quarters.
fn whole_numbers() -> impl Strategy<Value = (Vec<Wall>, Vec<Walk>)> {
    let place = || [-12..=12i32, -12..=12];
    let walls = prop::collection::vec((place(), place(), any::<bool>()), 1..40);
    let moves = prop::collection::vec(place(), 20..200);
    (walls, prop::collection::vec((moves, prop::sample::select(vec![0.25, 0.5, 1.0])), 3))
}

/// A scene of such walls, and of such walks what touches no wall: no product is rounded in f32, while many signs are 0.
fn whole_scene(walls: &[Wall], walks: &[Walk]) -> (Arc<Model>, Vec<SettledTrace>) {
    let point = |[x, y]: [i32; 2]| DVec2::new(x.into(), y.into());
    let along = |[x, y]: [i32; 2], to: [i32; 2]| if to[0] % 2 == 0 { [to[0], y] } else { [x, to[1]] };
    let ends = walls.iter().map(|&(from, to, is_along)| [from, if is_along { along(from, to) } else { to }]);
    let scene = Scene::new(ends.map(|ends| ends.map(point))).unwrap();
    // Walls between whole numbers that pass through this point are longer than these.
    let model = Arc::new(Model::new(scene, Some(DVec2::new(1.0 / 64.0, 0.5))).unwrap());
    let walk = |(id, (moves, unit)): (u64, &Walk)| {
        let mut points = vec![model.anchor()];
        for &by in moves {
            let here = points[points.len() - 1];
            let next = here + point(by) * *unit;
            if next.abs().max_element() < 16.0 && model.is_clear(here, next) {
                points.push(next);
            }
        }
        settle(&model, &Trace { id, points })
    };
    let traces = (0..).zip(walks).map(walk).collect();
    (model, traces)
}

#[test]
fn where_f32_is_exact_fast_is_the_reference() {
    let device = software();
    let events = std::cell::Cell::new(0);
    let cases = ProptestConfig::default().cases / 2;
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let result = TestRunner::new(config).run(&whole_numbers(), |(walls, walks)| {
        let (model, traces) = whole_scene(&walls, &walks);
        assert!(traces.iter().all(|trace| trace.is_plain() && trace.violation().is_none()));
        let truth = run(&mut Reference::new(model.clone()), &traces);
        assert_eq!(run(&mut fast(&device, &model), &traces), truth);
        assert_eq!(run(&mut fast(&device, &model).keep_all(), &traces), truth);
        assert_eq!(run(&mut fast(&device, &model).window(3), &traces), truth);
        events.set(events.get() + truth.iter().map(|record| record.events.len()).sum::<usize>());
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(events.get() > 10 * cases as usize, "only {} events were compared", events.get());
}

/// The free end comes to the ray of a wall's end, goes out along it and comes back: the rope has a contact there, but
/// never one that it bends round.
#[test]
fn a_contact_passed_straight_is_no_depth() {
    let walls = [[[1.0, 0.0], [1.0, 1.0]]].map(|wall| wall.map(DVec2::from));
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::ZERO)).unwrap());
    let points = [[0.0, 0.0], [2.0, -1.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0], [3.0, -1.0]].map(DVec2::from).to_vec();
    let trace = [settle(&model, &Trace { id: 0, points })];
    let truth = run(&mut Reference::new(model.clone()), &trace);
    assert_eq!((truth[0].max_depth, truth[0].events.len()), (0, 2));
    assert_eq!(run(&mut fast(&software(), &model), &trace), truth);
}

/// Scenes and traces at the ends of what is taken: 2^500, 2^-450, both at once, and a tiny scene 10^12 times its size
/// away.
#[test]
fn records_are_sound_at_the_ends_of_the_range() {
    let device = software();
    let (huge, tiny) = (2f64.powi(500), 2f64.powi(-450));
    let walls =
        [[[1.0, -0.5], [1.0, 0.75]], [[2.0, 0.0], [3.0, 0.0]], [[4.0, 0.0], [5.0, 0.0]], [[-1.0, 0.25], [-1.0, -2.0]]];
    let ring = [[0.25, -1.0], [3.5, -1.5], [6.0, 0.5], [2.5, 1.5], [-2.0, 2.5], [-2.5, -2.5], [0.5, -0.25]];
    let offset = DVec2::new(3e12, -1e12);
    let stretches =
        [(1.0, 1.0), (huge / 8.0, 1.0), (4.0 * tiny, 1.0), (4.0 * tiny, huge / tiny / 32.0), (1.0, huge / 8.0)];
    for (scale, stretch) in stretches {
        for origin in [DVec2::ZERO, offset] {
            let place = |p: [f64; 2]| DVec2::from(p) * scale + if scale == 1.0 { origin } else { DVec2::ZERO };
            let scene = Scene::new(walls.map(|wall| wall.map(place))).unwrap();
            let model = Arc::new(Model::new(scene, Some(place([0.0, 0.0]))).unwrap());
            let points: Vec<_> = ring.iter().cycle().take(40).map(|&p| place(p.map(|c| c * stretch))).collect();
            let trace = settle(&model, &Trace { id: 0, points });
            for mut engine in [fast(&device, &model), fast(&device, &model).keep_all()] {
                let records = run(&mut engine, std::slice::from_ref(&trace));
                is_sound(&model, &trace, &records[0]);
            }
        }
    }
}

/// Round a box along its walls, from corner to corner, both ways, and back: points that stand on corners count as
/// standing off them, on the side that the exact update has them on.
#[test]
fn points_on_corners_are_taken_off_them() {
    let device = software();
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]].map(DVec2::from);
    let walls = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]);
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::new(-2.0, -1.0))).unwrap());
    let way = |id, order: &[usize]| {
        let mut points = vec![model.anchor(), DVec2::new(-0.5, -0.25)];
        points.extend(order.iter().map(|&i| corners[i]));
        points.push(DVec2::new(-0.75, if order.last() == Some(&3) { 3.5 } else { -0.5 }));
        settle(&model, &Trace { id, points })
    };
    let traces =
        [way(0, &[0, 1, 2, 3]), way(1, &[0, 3, 2, 1, 0]), way(2, &[0, 1, 2, 1, 0]), way(3, &[0, 1, 2, 3, 0, 1, 0])];
    assert!(traces.iter().all(|trace| !trace.is_plain() && trace.violation().is_none()));
    let truth = run(&mut Reference::new(model.clone()), &traces);
    assert!(truth[0].depth >= 2 && truth[3].depth >= 3, "{} and {}", truth[0].depth, truth[3].depth);
    let ropes = |records: &[TraceRecord]| records.iter().map(|record| record.wraps.clone()).collect::<Vec<_>>();
    assert_eq!(ropes(&run(&mut fast(&device, &model), &traces)), ropes(&truth));
}

#[test]
fn no_trace_depends_on_the_others() {
    let device = software();
    let plan = Arc::new(Model::new(floor_plan(), None).unwrap());
    let walls = Arc::new(Model::new(random_walls(200, 4), None).unwrap());
    for (model, step) in [(&plan, 0.3), (&walls, 0.03)] {
        let traces: Vec<_> =
            walks(model, Walker { step, steps: 150, seed: 9 }, 90).iter().map(|t| settle(model, t)).collect();
        let alone: Vec<_> =
            traces.iter().map(|t| run(&mut fast(&device, model), std::slice::from_ref(t)).remove(0)).collect();
        assert!(alone.iter().any(|record| record.events.len() > 9));
        let mut backwards: Vec<_> = traces.clone();
        backwards.reverse();
        for queries in [1, 7, 1 << 13] {
            let tuning = Tuning { queries, workgroup: 64 };
            let mut engine = FastGpu::with(device.clone(), model.clone(), tuning, DECIDE_WGSL).unwrap();
            assert_eq!(run(&mut engine, &traces), alone, "{queries} queries a round");
            let mut records = run(&mut engine, &backwards);
            records.reverse();
            assert_eq!(records, alone, "{queries} queries a round, backwards");
        }
    }
}

#[test]
fn lists_of_several_pages() {
    let model = posts();
    let device = software();
    let traces: Vec<_> =
        walks(&model, Walker { step: 0.8, steps: 60, seed: 2 }, 12).iter().map(|t| settle(&model, t)).collect();
    for (trace, record) in traces.iter().zip(run(&mut fast(&device, &model).keep_all(), &traces)) {
        is_sound(&model, trace, &record);
    }
}

/// Where the shader writes its answer down.
const LAST: &str =
    "answers[lane] = try_legs(question, count, last <= page.first + PAGE && is_pivot_in_wedge(question), met);";

#[test]
fn a_device_that_answers_nonsense_is_found_out_or_comes_to_an_end() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let device = software();
    let traces = [settle(&model, &walks(&model, Walker { step: 0.3, steps: 50, seed: 3 }, 1)[0])];
    assert_eq!(DECIDE_WGSL.matches(LAST).count(), 1);
    // A device that unwraps what is not there is found out, and does not hang.
    let broken = DECIDE_WGSL.replace(LAST, "answers[lane] = Answer(0u, UNWRAP, 1.0, 0u, met.at);");
    let tuning = Tuning { queries: 8, workgroup: 64 };
    let error = FastGpu::with(device.clone(), model.clone(), tuning, &broken).unwrap().evaluate(&traces, &Job::new());
    assert!(error.unwrap_err().to_string().contains("it named a vertex that it was not given"));
    // Nor does one that names the same vertex again and again.
    let broken = DECIDE_WGSL.replace(LAST, "answers[lane] = Answer(0u, question.first, 1.0, 0u, met.at);");
    let records =
        FastGpu::with(device.clone(), model.clone(), tuning, &broken).unwrap().evaluate(&traces, &Job::new()).unwrap();
    is_sound(&model, &traces[0], &records[0]);
}
