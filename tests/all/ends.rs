//! Ropes whose ends both move, held to another method: the rope from where the anchor is to where the free end is, is
//! that of the path which goes back along the anchor's way and then along the free end's.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};
use tautline::engine::{Cpu, ENGINES, Engine, EngineError, EngineKind, Funnel, Job, LiveEnds, Options, Reference};
use tautline::rope::{EndsRecord, EndsSteps, Side, Status, TraceRecord};
use tautline::scene::Model;
use tautline::trace::{End, SettledEnds, SettledTrace, Trace, settle, settle_ends};

use crate::scenes::{KINDS, Kind, Recipe, recipe};

/// A scene, and the points of both ends, as many of the one as of the other.
struct Case {
    model: Arc<Model>,
    free: Vec<DVec2>,
    anchor: Vec<DVec2>,
}

impl Case {
    /// Two traces in the scene of the first recipe; `None` where the anchor would start on a wall.
    fn of([first, second]: &[Recipe; 2]) -> Option<Case> {
        let model = first.model();
        if model.is_on_wall(model.anchor()) {
            return None;
        }
        let mut free = first.trace(&model, 0).points;
        let mut anchor = vec![model.anchor()];
        anchor.extend(second.trace(&model, 0).points);
        let points = free.len().max(anchor.len());
        free.resize(points, free[free.len() - 1]);
        anchor.resize(points, anchor[anchor.len() - 1]);
        Some(Case { model, free, anchor })
    }

    fn settled(&self, points: usize) -> SettledEnds {
        let free = Trace { id: 7, points: self.free[..points].to_vec() };
        settle_ends(&self.model, &free, &self.anchor[..points]).unwrap()
    }
}

fn check(kinds: &[Kind], touching: bool, cases: u32, test: impl Fn(&Case)) {
    let default = ProptestConfig::default();
    let cases = cases * default.cases / 256;
    for &kind in kinds {
        let mut runner = TestRunner::new(ProptestConfig { cases, failure_persistence: None, ..default.clone() });
        let result = runner.run(&[recipe(kind, touching), recipe(kind, touching)], |recipes| {
            if let Some(case) = Case::of(&recipes) {
                test(&case);
            }
            Ok(())
        });
        if let Err(TestError::Fail(why, recipes)) = &result {
            let Case { model, free, anchor } = Case::of(recipes).unwrap();
            let walls: Vec<_> = (0..model.scene().walls().len()).map(|w| model.scene().ends(w)).collect();
            panic!("{kind:?}, touching {touching}: {why}\nwalls {walls:?}\nfree {free:?}\nanchor {anchor:?}");
        }
        result.unwrap();
    }
}

fn run(engine: &mut dyn Engine, settled: &SettledEnds) -> EndsRecord {
    let record = engine.evaluate_ends(std::slice::from_ref(settled), &Job::new()).unwrap().remove(0);
    assert_eq!(record.ends.len(), record.record.events.len());
    record
}

/// The taut rope, its length, and its pull.
type Rope = (Vec<(DVec2, Side)>, f64, Option<DVec2>);

fn rope(record: &TraceRecord) -> Rope {
    assert_eq!(record.depth as usize, record.wraps.len());
    (record.wraps.clone(), record.length, record.pull)
}

/// What the other method says of a rope that is tied where the anchor is in the end.
fn truth(model: &Model, at: DVec2, path: &SettledTrace) -> Rope {
    let tied = Arc::new(model.tied(at).unwrap());
    rope(&Funnel::new(tied).evaluate(std::slice::from_ref(path), &Job::new()).unwrap()[0])
}

/// After every step, the points and the rope.
fn after_every_step(case: &Case, mut test: impl FnMut(usize, &SettledEnds, Rope)) {
    let whole = case.settled(case.free.len());
    for k in 0..case.free.len() {
        let cut = case.settled(k + 1);
        test(k, &cut, rope(&run(&mut Reference::new(case.model.clone()), &cut).record));
    }
    assert_eq!(whole.violation(), None);
}

#[test]
fn both_ends_give_the_rope_of_the_path_there_and_back() {
    check(&KINDS, false, 100, |case| {
        after_every_step(case, |k, cut, rope| {
            // On which side of a lone wall a trace passes over its end depends on the way in which it goes.
            if !cut.doubled(k).is_plain() {
                return;
            }
            let there = case.anchor[..=k].iter().rev().chain(&case.free[..=k]);
            let path = Trace { id: 7, points: there.copied().collect() };
            let tied = case.model.tied(case.anchor[k]).unwrap();
            assert_eq!(rope, truth(&case.model, case.anchor[k], &settle(&tied, &path)), "step {k}");
        });
    });
}

#[test]
fn both_ends_may_touch_walls() {
    check(&KINDS, true, 100, |case| {
        after_every_step(case, |k, cut, rope| {
            assert_eq!(rope, truth(&case.model, case.anchor[k], &cut.doubled(k)), "step {k}");
        });
    });
}

#[test]
fn every_step_has_the_rope_of_the_traces_that_end_there() {
    check(&KINDS, false, 100, |case| {
        let whole = case.settled(case.free.len());
        // What comes after may decide on which side a trace passes what it touches.
        if !whole.doubled(case.free.len() - 1).is_plain() {
            return;
        }
        let record = run(&mut Cpu::new(case.model.clone()), &whole);
        let mut steps = EndsSteps::new(&case.model, &whole, &record, &[]);
        after_every_step(case, |k, _, (wraps, length, pull)| {
            let tied = record.rope_after(case.model.vertices(), case.anchor[k], k);
            let taut: Vec<_> = tied.taut(case.free[k]).iter().map(|c| (c.at, c.side)).collect();
            let (step, anchor) = steps.next().unwrap();
            assert_eq!((step.at, anchor, step.step), (case.free[k], case.anchor[k], k as u64));
            assert_eq!((&taut, step.length, step.pull, step.turns as usize), (&wraps, length, pull, wraps.len()));
            assert_eq!(step.contacts as usize, tied.contacts().len());
        });
        assert!(steps.next().is_none());
    });
}

#[test]
fn swapping_the_ends_reverses_the_rope() {
    check(&KINDS, true, 100, |case| {
        let swapped = Case { model: case.model.clone(), free: case.anchor.clone(), anchor: case.free.clone() };
        if case.model.is_on_wall(case.free[0]) {
            return;
        }
        let [there, back] = [case, &swapped].map(|case| {
            let settled = case.settled(case.free.len());
            run(&mut Reference::new(case.model.clone()), &settled).record
        });
        let reversed = back.wraps.iter().rev().map(|&(at, side)| (at, side.shown(true)));
        assert_eq!(there.wraps, reversed.collect::<Vec<_>>());
        assert!((there.length - back.length).abs() <= 1e-12 * there.length);
    });
}

#[test]
fn the_order_in_which_the_ends_move_does_not_matter() {
    check(&KINDS, true, 100, |case| {
        let last = |points: &[DVec2]| points[points.len() - 1];
        let n = case.free.len();
        let rest = |at: DVec2| std::iter::repeat_n(at, n);
        let by = |free: Vec<DVec2>, anchor: Vec<DVec2>| {
            let case = Case { model: case.model.clone(), free, anchor };
            rope(&run(&mut Reference::new(case.model.clone()), &case.settled(case.free.len())).record)
        };
        let together = by(case.free.clone(), case.anchor.clone());
        let first = by(
            case.free.iter().copied().chain(rest(last(&case.free))).collect(),
            rest(case.anchor[0]).chain(case.anchor.iter().copied()).collect(),
        );
        let second = by(
            rest(case.free[0]).chain(case.free.iter().copied()).collect(),
            case.anchor.iter().copied().chain(rest(last(&case.anchor))).collect(),
        );
        assert_eq!(together, first);
        assert_eq!(together, second);
    });
}

#[test]
fn an_anchor_that_stays_gives_the_records_of_a_fixed_one() {
    check(&KINDS, true, 100, |case| {
        let free = Trace { id: 7, points: case.free.clone() };
        let truth = Reference::new(case.model.clone()).evaluate(&[settle(&case.model, &free)], &Job::new()).unwrap();
        let settled = settle_ends(&case.model, &free, &vec![case.model.anchor(); case.free.len()]).unwrap();
        let record = run(&mut Reference::new(case.model.clone()), &settled);
        assert_eq!(record.record, truth[0]);
        assert!(record.ends.iter().all(|&end| end == End::Free));
    });
}

#[test]
fn cpu_gives_the_references_records() {
    check(&KINDS, true, 100, |case| {
        let settled = case.settled(case.free.len());
        let truth = run(&mut Reference::new(case.model.clone()), &settled);
        let lists = tautline::candidates::Lists::new(case.model.clone());
        assert_eq!(run(&mut Cpu::with_lists(lists.after(0)), &settled), truth);
        assert_eq!(run(&mut Cpu::new(case.model.clone()).keep_all(), &settled), truth);
        // The model's rope may be tied elsewhere, even where none of these can come.
        let far = Arc::new(case.model.tied(case.free[case.free.len() / 2]).unwrap());
        let lists = tautline::candidates::Lists::new(far);
        assert_eq!(run(&mut Cpu::with_lists(lists.after(0)), &settled), truth);
    });
}

/// Traces that cross walls at will come to an end, whatever engine evaluates them, and are marked.
#[test]
fn lawless_traces_come_to_an_end() {
    for kind in KINDS {
        let mut runner =
            TestRunner::new(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() });
        let recipes = [recipe(kind, true), recipe(kind, true)];
        let result = runner.run(&recipes, |[first, second]| {
            let model = first.model();
            let [mut free, mut anchor] = [first.lawless_trace(&model, 0), second.lawless_trace(&model, 0)];
            let points = free.points.len().min(anchor.points.len());
            free.points.truncate(points);
            anchor.points.truncate(points);
            let Ok(settled) = settle_ends(&model, &free, &anchor.points) else { return Ok(()) };
            let truth = run(&mut Reference::new(model.clone()), &settled);
            assert_eq!(truth.record.status == Status::Violation, settled.violation().is_some());
            assert_eq!(run(&mut Cpu::new(model.clone()), &settled), truth);
            let rope = truth.rope_after(model.vertices(), anchor.points[points - 1], points - 1);
            assert!(rope.contacts().len() >= truth.record.wraps.len());
            Ok(())
        });
        result.unwrap_or_else(|e| panic!("{kind:?}: {e}"));
    }
}

#[test]
fn a_live_rope_has_the_events_of_the_traces() {
    let compared = std::cell::Cell::new(0);
    check(&KINDS, false, 100, |case| {
        let settled = case.settled(case.free.len());
        if settled.is_tied() {
            // Events of an anchor that stays are those of a fixed one, also where they make no difference to the rope.
            return;
        }
        let record = run(&mut Reference::new(case.model.clone()), &settled);
        let mut expected = record.events();
        let mut rope = LiveEnds::new(case.model.clone()).unwrap();
        for (k, ends) in case.free.iter().zip(&case.anchor).enumerate() {
            for (end, &to) in [(End::Free, ends.0), (End::Anchor, ends.1)] {
                // Of a move that touches a wall it says so.
                let Ok(events) = rope.advance(end, to) else { return };
                for found in events {
                    let (e, at) = expected.next().unwrap();
                    assert_eq!((e.step as usize, e.kind, e.vertex, e.side), (k, found.kind, found.vertex, found.side));
                    assert_eq!(at, end);
                    compared.set(compared.get() + 1);
                }
            }
            let tied = record.rope_after(case.model.vertices(), *ends.1, k);
            assert_eq!(rope.rope().measure(), tied.measure(*ends.0));
        }
        assert_eq!(expected.next(), None);
        assert_eq!((rope.length(), rope.pull(End::Free)), (record.record.length, record.record.pull));
    });
    assert!(compared.get() > 1000, "{}", compared.get());
}

#[test]
fn engines_take_two_ends_or_say_that_they_do_not() {
    let model = Arc::new(Model::new(tautline::example::floor_plan(), None).unwrap());
    let free = Trace { id: 7, points: vec![model.anchor(); 2] };
    let settled = settle_ends(&model, &free, &[model.anchor(), model.anchor() + 0.01]).unwrap();
    let open = |kind: &'static EngineKind| kind.open(model.clone(), None, &Options::default()).unwrap().engine;
    for kind in ENGINES.into_iter().filter(|kind| !kind.needs_gpu()) {
        let outcome = open(kind).evaluate_ends(std::slice::from_ref(&settled), &Job::new());
        match outcome {
            Ok(records) => assert!(kind.both_ends && records[0].record.length > 0.01),
            Err(error) => assert!(!kind.both_ends && matches!(error, EngineError::TwoEnds { .. }), "{error}"),
        }
    }
    assert!(ENGINES.iter().all(|kind| !(kind.needs_gpu() && kind.both_ends)));
}
