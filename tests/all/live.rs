//! One rope, step by step.

use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{AdvanceError, Engine, Job, LiveRope, Reference};
use tautline::example::{BuiltIn, Walker, walks};
use tautline::scene::{Model, Scene};
use tautline::trace::{Trace, settle};

/// What the reference says of a trace is what a live rope says, move by move.
fn same(model: &Arc<Model>, trace: &Trace) -> usize {
    let settled = settle(model, trace);
    assert!(settled.violation().is_none());
    let record = Reference::new(model.clone()).evaluate(&[settled], &Job::new()).unwrap().remove(0);
    let mut rope = LiveRope::new(model.clone());
    let mut expected = record.events.iter().peekable();
    let mut longest = 0.0f64;
    for (step, &to) in trace.points.iter().enumerate() {
        for found in rope.advance(to).unwrap() {
            let e = expected.next().unwrap();
            assert_eq!((e.step as usize, e.kind, e.vertex, e.side), (step, found.kind, found.vertex, found.side));
        }
        assert!(expected.peek().is_none_or(|e| e.step as usize > step));
        longest = longest.max(rope.length());
    }
    assert_eq!((rope.length(), longest, rope.pull()), (record.length, record.max_length, record.pull));
    record.events.len()
}

#[test]
fn a_live_rope_is_the_trace_s() {
    let mut events = 0;
    for (scene, step) in [(BuiltIn::Random(60), 0.1), (BuiltIn::Lattice(60), 0.9), (BuiltIn::Rooms, 0.5)] {
        for seed in 0..4 {
            let model = Arc::new(Model::new(scene.scene(seed), None).unwrap());
            for trace in walks(&model, Walker { step, steps: 300, seed }, 4) {
                events += same(&model, &trace);
            }
        }
    }
    assert!(events > 2000, "{events}");
}

#[test]
fn a_rope_that_is_tied_at_a_wall_s_end_goes_round_it() {
    let walls = [[[0.0, 0.0], [1.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]]].map(|w| w.map(DVec2::from));
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::ZERO)).unwrap());
    for points in
        [[[-0.5, 0.5], [-0.5, 2.0], [0.5, 2.0], [0.5, 0.5]], [[0.5, -0.5], [2.0, -0.5], [2.0, 0.5], [0.5, 0.5]]]
    {
        assert!(same(&model, &Trace { id: 0, points: points.map(DVec2::from).to_vec() }) > 0);
    }
}

#[test]
fn moves_that_touch_walls_are_refused_and_change_nothing() {
    let wall = [[0.0, 0.0], [2.0, 0.0]].map(DVec2::from);
    let model = Arc::new(Model::new(Scene::new([wall]).unwrap(), Some(DVec2::new(0.0, -1.0))).unwrap());
    let mut rope = LiveRope::new(model.clone());
    rope.advance([3.0, -1.0].into()).unwrap();
    assert_eq!(rope.advance([3.0, 1.0].into()).unwrap().len(), 1);
    let before = (rope.rope().clone(), rope.free_end(), rope.length());
    // Across it, onto it, onto its end, and past its end.
    for to in [[1.0, -1.0], [1.0, 0.0], [2.0, 0.0], [1.0, -1.0]] {
        let error = rope.advance(to.into()).unwrap_err();
        assert!(matches!(error, AdvanceError::Touches { wall: 0, .. }), "{error}");
    }
    let message = rope.advance([1.0, -1.0].into()).unwrap_err().to_string();
    assert_eq!(message, "the move from (3, 1) to (1, -1) touches wall 0, from (0, 0) to (2, 0); keep off the walls");
    for to in [[f64::NAN, 0.0], [1e200, 0.0], [0.0, 1e-300]] {
        assert!(matches!(rope.advance(to.into()), Err(AdvanceError::Coordinate { .. })));
    }
    assert_eq!((rope.rope().clone(), rope.free_end(), rope.length()), before);
    assert!(rope.advance(before.1).unwrap().is_empty());
}
