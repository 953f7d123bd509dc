use std::sync::Arc;

use glam::DVec2;

use crate::engine::{Cpu, Engine, Job, Reference};
use crate::rope::TraceRecord;
use crate::scene::{Inside, Model, Object, Scene, Wall};
use crate::study::walk::tests::{STARTS, own_points, scenes, square};
use crate::study::{AtTether, AtWalls, GaussianWalk, PersistentWalk, Start, UniformWalk, WalkPlan, Walks};
use crate::trace::{SettledTrace, Trace, settle};

const ALL: [AtTether; 3] = [AtTether::Stay, AtTether::Slide, AtTether::Turn];

/// All kinds of walks on a tether of that length.
fn walks(step: f64, start: Start, at_walls: AtWalls, length: f64, at: AtTether) -> [WalkPlan; 3] {
    let (steps, tether, at_tether) = (250, Some(length), Some(at));
    [
        WalkPlan::Uniform(UniformWalk { step, steps, start, at_walls, tether, at_tether }),
        WalkPlan::Gaussian(GaussianWalk { step, steps, start, at_walls, tether, at_tether }),
        WalkPlan::Persistent(PersistentWalk { step, steps, turn: 0.4, start, at_walls, tether, at_tether }),
    ]
}

/// The same record of two engines.
fn record(model: &Arc<Model>, trace: &SettledTrace) -> TraceRecord {
    let traces = std::slice::from_ref(trace);
    let of = |engine: &mut dyn Engine| engine.evaluate(traces, &Job::new()).unwrap().remove(0);
    let record = of(&mut Reference::new(model.clone()));
    assert_eq!(record, of(&mut Cpu::new(model.clone())));
    record
}

/// Far from the origin a coordinate's last bit is much of a step.
fn far() -> (Arc<Model>, f64) {
    let walls = [[[0.0, 0.0], [64.0, 0.0]], [[0.0, 32.0], [9.0, 40.0]], [[20.0, 8.0], [30.0, 9.0]]];
    let scene = Scene::new(walls.map(|wall| wall.map(|p| DVec2::from(p) + 1e13))).unwrap();
    (Arc::new(Model::new(scene, Some(DVec2::splat(1e13) + DVec2::new(18.0, 12.0))).unwrap()), 2.0)
}

/// The anchor stands on the border of a solid, in the middle of a side.
fn on_a_solid() -> (Arc<Model>, f64) {
    let ring = |corners: [[f64; 2]; 4], object| {
        let walls = (0..4).map(move |i| [corners[i], corners[(i + 1) % 4]].map(DVec2::from));
        walls.map(move |ends| Wall { ends, object, reversed: false })
    };
    let solid = Object { inside: Inside::EvenOdd, ..Object::default() };
    let walls = ring([[3.0, 3.0], [5.0, 3.0], [5.0, 4.0], [3.0, 4.0]], 0)
        .chain(ring([[0.0, 0.0], [9.0, 0.0], [9.0, 7.0], [0.0, 7.0]], 1));
    let scene = Scene::of(vec![solid, Object::default()], walls).unwrap();
    (Arc::new(Model::new(scene, Some(DVec2::new(4.0, 4.0))).unwrap()), 0.5)
}

#[test]
fn no_rope_is_longer_than_the_tether() {
    for (model, step) in scenes().into_iter().chain([far(), on_a_solid()]) {
        let (low, high) = model.bounds();
        let mut held_back = [0; 3];
        for (k, at) in ALL.into_iter().enumerate() {
            for at_walls in [AtWalls::Redraw, AtWalls::Reject, AtWalls::Reflect] {
                for (length, start) in [3.0 * step, 7.3 * step, 20.0 * step].into_iter().zip([STARTS, STARTS].concat())
                {
                    for plan in walks(step, start, at_walls, length, at) {
                        let trace = Walks::new(model.clone(), &plan, 3).unwrap().trace(2);
                        let points = own_points(&trace);
                        let record = record(&model, &trace);
                        assert!(record.max_length <= length, "{plan:?}: {}", record.max_length);
                        assert_eq!((points.len(), trace.violation()), (251, None));
                        assert!(points.iter().all(|p| p.cmpge(low).all() && p.cmple(high).all()));
                        let again = settle(&model, &Trace { id: 2, points });
                        assert_eq!(trace, again.with_walked(trace.walked()), "{plan:?}");
                        held_back[k] += trace.walked().held_back.unwrap().steps;
                    }
                }
            }
        }
        assert!(held_back.iter().all(|&steps| steps > 400), "{held_back:?}");
    }
}

/// In the open what a tether lets the free end reach is a disc about the anchor.
#[test]
fn the_steps_that_are_held_back_are_those_that_were() {
    let length = 3.0;
    for at in ALL {
        for plan in walks(0.5, Start::Anchor, AtWalls::Redraw, length, at) {
            let walks = Walks::new(square(100.0), &plan, 1).unwrap();
            let mut all = 0;
            for trace in (0..8).map(|number| walks.trace(number)) {
                let points = own_points(&trace);
                let is_held = |pair: &[DVec2]| match at {
                    AtTether::Slide => pair[1].length() >= length * (1.0 - 1e-15),
                    AtTether::Stay | AtTether::Turn => pair[0] == pair[1],
                };
                let held = points.windows(2).zip(1..).filter(|(pair, _)| is_held(pair)).map(|(_, step)| step);
                let held: Vec<usize> = held.collect();
                let known = trace.walked().held_back.unwrap();
                all += known.steps;
                match at {
                    // Among 32 draws there is one that leads back in.
                    AtTether::Turn => assert!(held.is_empty(), "{held:?}"),
                    _ => assert_eq!((held.first().copied(), held.len()), (known.first, known.steps), "{plan:?}"),
                }
            }
            assert!(all > 60, "{plan:?}: {all}");
        }
    }
}

/// The point to which a walk slides is the one of the circle nearest to the step's end.
#[test]
fn a_slide_ends_nearest_to_where_the_step_leads() {
    let free = |plan: &WalkPlan| match plan.clone() {
        WalkPlan::Persistent(walk) => WalkPlan::Persistent(PersistentWalk { tether: None, at_tether: None, ..walk }),
        other => other,
    };
    let (room, length) = (square(1000.0), 10.0);
    let [_, _, plan] = walks(0.5, Start::Anchor, AtWalls::Redraw, length, AtTether::Slide);
    let (mut slides, mut shares) = (0, 0.0);
    for number in 0..20 {
        let of = |plan: &WalkPlan| own_points(&Walks::new(room.clone(), plan, 1).unwrap().trace(number));
        let (held, free) = (of(&plan), of(&free(&plan)));
        // The headings are the same, so each step was drawn as that of the free walk.
        for i in 0..250 {
            let to = held[i] + (free[i + 1] - free[i]);
            let nearest = if to.length() > length { to * (length / to.length()) } else { to };
            assert!(nearest.distance(held[i + 1]) < 1e-11, "{number}, {i}: {nearest} {}", held[i + 1]);
            if to.length() > length {
                slides += 1;
                shares += held[i].distance(held[i + 1]) / 0.5;
            }
        }
    }
    assert!(slides > 500 && shares / f64::from(slides) > 0.2, "{slides} {shares}");
}

#[test]
fn a_tether_that_is_never_taut_changes_nothing() {
    for (model, step) in scenes() {
        for start in STARTS {
            for at in ALL {
                for plan in walks(step, start, AtWalls::Reflect, 1e6, at) {
                    let free = match plan.clone() {
                        WalkPlan::Uniform(w) => WalkPlan::Uniform(UniformWalk { tether: None, at_tether: None, ..w }),
                        WalkPlan::Gaussian(w) => {
                            WalkPlan::Gaussian(GaussianWalk { tether: None, at_tether: None, ..w })
                        }
                        WalkPlan::Persistent(w) => {
                            WalkPlan::Persistent(PersistentWalk { tether: None, at_tether: None, ..w })
                        }
                        other => other,
                    };
                    let [held, free] = [&plan, &free].map(|plan| Walks::new(model.clone(), plan, 9).unwrap().trace(7));
                    assert_eq!(held.points(), free.points(), "{plan:?}");
                    assert_eq!((held.walked().met, held.walked().still), (free.walked().met, free.walked().still));
                    assert_eq!(held.walked().held_back.map(|held| (held.steps, held.first)), Some((0, None)));
                    assert_eq!(free.walked().held_back, None);
                }
            }
        }
    }
}

#[test]
fn tethers_that_cannot_be_are_refused() {
    let error = |tether, at_tether| {
        let (start, at_walls) = (Start::Anchor, AtWalls::Redraw);
        let plan = UniformWalk { step: 0.1, steps: 9, start, at_walls, tether, at_tether };
        Walks::new(square(1.0), &WalkPlan::Uniform(plan), 1).err().map(|e| e.to_string()).unwrap_or_default()
    };
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(error(Some(length), None).contains("give a number above 0"), "{length}");
    }
    assert!(error(None, Some(AtTether::Stay)).contains("give its length as walk.tether"));
    assert_eq!(error(Some(0.5), Some(AtTether::Turn)), "");
}
