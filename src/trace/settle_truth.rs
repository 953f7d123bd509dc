//! Settling in the plain way: every step against every wall, every point a stay. What [`settle`] does must be the same.

use std::rc::Rc;

use glam::DVec2;
use proptest::prelude::*;

use super::corner::Corner;
use super::pluck::pluck_stays;
use super::settled::{Broken, violation};
use super::slide::Stay;
use super::{SettledTrace, Trace, ViolationKind, settle, settle_owned};
use crate::geometry::{between, opposite, orient, same_side};
use crate::scene::{Model, Scene};

fn settle_plainly(model: &Model, trace: &Trace) -> SettledTrace {
    let mut settled = SettledTrace::new(trace.id, vec![model.anchor()], vec![], Broken::default());
    settled.points.clear();
    let mut touching = vec![];
    let mut add = |settled: &mut SettledTrace, at: DVec2, ends_step: bool| {
        let i = settled.points.len() as u32;
        settled.points.push(at);
        settled.added.extend((!ends_step).then_some(i));
        touching.push(is_on_wall(model, at));
    };
    if trace.points[0] != model.anchor() {
        add(&mut settled, model.anchor(), false);
    }
    let mut a = model.anchor();
    for (step, &b) in trace.points.iter().enumerate() {
        for p in step_plainly(model, trace, step, [a, b], &mut settled) {
            add(&mut settled, p, false);
        }
        add(&mut settled, b, true);
        a = b;
    }
    let mut stays: Vec<Stay> = vec![];
    for (i, &at) in settled.points.iter().enumerate() {
        match stays.last_mut() {
            Some(stay) if stay.at == at => stay.end = i + 1,
            _ => {
                let corner = touching[i].then(|| Rc::new(Corner::new(model, at)));
                stays.push(Stay { at, first: i, end: i + 1, corner });
            }
        }
    }
    let [x, y] = [0, 1].map(|axis| settled.points.iter().map(move |p| p[axis]));
    let [low, high] = [f64::min, f64::max].map(|f: fn(f64, f64) -> f64| {
        DVec2::new(x.clone().reduce(f).expect("a trace has points"), y.clone().reduce(f).expect("a trace has points"))
    });
    settled.bounds = (low, high);
    pluck_stays(model, &mut settled, &stays);
    settled
}

/// The vertices that a step passes, in order; notes a violation.
fn step_plainly(
    model: &Model,
    trace: &Trace,
    step: usize,
    [a, b]: [DVec2; 2],
    settled: &mut SettledTrace,
) -> Vec<DVec2> {
    let mut passed: Vec<DVec2> = vec![];
    for wall in 0..model.scene().walls().len() {
        let [u, v] = model.scene().ends(wall);
        if u.min(v).cmpgt(a.max(b)).any() || u.max(v).cmplt(a.min(b)).any() {
            continue;
        }
        let (from_a, from_b) = (orient(u, v, a), orient(u, v, b));
        if a == b || same_side(from_a, from_b) {
            continue;
        }
        let (to_u, to_v) = (orient(a, b, u), orient(a, b, v));
        if opposite(from_a, from_b) && opposite(to_u, to_v) {
            settled.broken.note(violation(model, trace.id, step, ViolationKind::Crosses, wall as u32, [a, b]));
        }
        passed.extend([(to_u, u), (to_v, v)].into_iter().filter(|&(s, w)| s == 0.0 && between(a, b, w)).map(|p| p.1));
    }
    let along = |p: &DVec2| {
        if a.x == b.x {
            if a.y < b.y { p.y } else { -p.y }
        } else if a.x < b.x {
            p.x
        } else {
            -p.x
        }
    };
    passed.sort_by(|p, q| along(p).total_cmp(&along(q)));
    passed.dedup();
    passed
}

/// Whether a point stands on a wall, its ends included.
fn is_on_wall(model: &Model, p: DVec2) -> bool {
    let mut walls = (0..model.scene().walls().len()).map(|wall| model.scene().ends(wall));
    walls.any(|[u, v]| p == u || p == v || orient(u, v, p) == 0.0 && between(u, v, p))
}

/// Whether a step crosses a wall from one side to the other.
fn breaks(model: &Model, a: DVec2, b: DVec2) -> bool {
    (0..model.scene().walls().len()).map(|wall| model.scene().ends(wall)).any(|[u, v]| {
        let (from_a, from_b) = (orient(u, v, a), orient(u, v, b));
        opposite(from_a, from_b) && opposite(orient(a, b, u), orient(a, b, v))
    })
}

/// Where the walls of a random scene lie.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Anywhere, a tenth of the scene long or less.
    Anywhere,
    /// The same, each as long as the scene.
    Long,
    /// On integers, so that traces touch and slide.
    Lattice,
    /// All on one line.
    Line,
    /// Tiny, in one corner, below one that goes across the whole scene.
    Town,
    /// So far from the origin that neighbouring points are neighbouring numbers.
    Offset,
}

const KINDS: [Kind; 6] = [Kind::Anywhere, Kind::Long, Kind::Lattice, Kind::Line, Kind::Town, Kind::Offset];

type Numbers = ([f64; 2], [f64; 2]);

fn wall(kind: Kind, &(at, along): &Numbers) -> [DVec2; 2] {
    let (at, along) = (DVec2::from(at), DVec2::from(along));
    let wall = match kind {
        Kind::Anywhere => [at, at + 0.1 * along],
        Kind::Long => [at, along],
        Kind::Lattice => [at, at + 0.3 * along].map(|p| (8.0 * p).round() / 8.0),
        Kind::Line => [at, at + 0.1 * along].map(|p| DVec2::new((64.0 * p.x).round() / 64.0, 0.5)),
        Kind::Town => [at, at + 0.1 * along].map(|p| p * 2f64.powi(-20)),
        Kind::Offset => [at, at + 0.1 * along],
    };
    wall.map(|p| placed(kind, p))
}

fn placed(kind: Kind, p: DVec2) -> DVec2 {
    if matches!(kind, Kind::Offset) { (p * 64.0).round() + DVec2::new(2f64.powi(52), -(2f64.powi(52))) } else { p }
}

/// A walk in steps of every length, to vertices at times, and out of the scene at times.
fn walk(kind: Kind, model: &Model, moves: &[(Numbers, u8)]) -> Vec<DVec2> {
    let mut here = placed(kind, DVec2::ZERO);
    let step = |(&((to, by), how), here): (&(Numbers, u8), &mut DVec2)| {
        let (to, by) = (DVec2::from(to), DVec2::from(by));
        *here = match (how % 16, kind) {
            (0 | 1, Kind::Town) => to * 2f64.powi(-20),
            (0, _) => placed(kind, to),
            (1, _) => placed(kind, to * 1e6),
            (2 | 3, _) if !model.vertices().is_empty() => {
                model.vertices()[((to.x + 1.0) * 1e6) as usize % model.vertices().len()]
            }
            (4, _) => *here,
            (_, Kind::Lattice) => ((*here + 0.2 * by) * 16.0).round() / 16.0,
            (_, Kind::Line) => DVec2::new(here.x + 0.02 * by.x, if by.y > 0.0 { 0.5 } else { to.y }),
            (_, Kind::Town) => *here + by * 2f64.powi(-24),
            (_, Kind::Offset) => (*here + by * 2.0).round(),
            _ => *here + by * 0.01,
        };
        *here
    };
    moves.iter().map(|m| step((m, &mut here))).collect()
}

fn agrees(kind: Kind, scale: i32, walls: &[Numbers], moves: &[(Numbers, u8)]) {
    let mut walls: Vec<_> = walls.iter().map(|w| wall(kind, w)).collect();
    if matches!(kind, Kind::Town) {
        walls.push([DVec2::new(-1.0, 1.0), DVec2::new(1.0, 1.5)]);
    }
    let model = |scale: f64| {
        let scene = Scene::new(walls.iter().map(|w| w.map(|p| p * scale))).unwrap();
        Model::new(scene, Some(placed(kind, DVec2::new(0.0, 1.0 / 64.0)) * scale))
    };
    let scale = 2f64.powi(scale);
    let (Ok(unscaled), Ok(model)) = (model(1.0), model(scale)) else { return };
    let points = walk(kind, &unscaled, moves).into_iter().map(|p| p * scale).collect();
    let trace = Trace { id: 3, points };
    let truth = settle_plainly(&model, &trace);
    assert_eq!(settle(&model, &trace), truth);
    // Steps that leave a wall on the wrong side are the only others that break the rules.
    let steps = std::iter::once(model.anchor()).chain(trace.points.iter().copied()).zip(trace.points.iter().copied());
    let broken: Vec<u32> = steps.zip(0..).filter(|&((a, b), _)| breaks(&model, a, b)).map(|(_, step)| step).collect();
    let counted = &truth.broken.steps;
    assert!(counted.is_sorted_by(|a, b| a < b) && broken.iter().all(|step| counted.contains(step)));
    assert_eq!(truth.violations(), if truth.hairs.is_empty() { broken.len() } else { counted.len() });
    // Step by step, so that what comes after a violation is seen too.
    let mut from = model.anchor();
    for &to in &trace.points {
        let step = Trace { id: 3, points: vec![from, to] };
        let truth = settle_plainly(&model, &step);
        assert_eq!(settle_owned(&model, step), truth);
        from = to;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn settling_is_the_same_as_with_every_wall(
        kind in prop::sample::select(KINDS.to_vec()),
        scale in prop::sample::select(vec![0, 0, -300, 400]),
        walls in prop::collection::vec(prop::array::uniform2(-1.0..1.0f64).prop_flat_map(|at| {
            (Just(at), prop::array::uniform2(-1.0..1.0f64))
        }), 0..400),
        moves in prop::collection::vec(
            ((prop::array::uniform2(-1.0..1.0f64), prop::array::uniform2(-1.0..1.0f64)), any::<u8>()), 1..120),
    ) {
        agrees(kind, scale, &walls, &moves);
    }
}

#[test]
fn scenes_that_fit_no_grid_take_neither_time_nor_memory() {
    let tiny = |i: f64| [DVec2::new(i * 1e-9, 0.0), DVec2::new(i * 1e-9, 1e-9)];
    let far = 2f64.powi(499);
    for huge in [
        [DVec2::new(-far, far / 2.0), DVec2::splat(far)],
        [DVec2::new(-far, 2.0), DVec2::new(far, 2.0)],
        [DVec2::new(-1.0, 2.0), DVec2::new(1.0, 2.0)],
    ] {
        let scene = Scene::new((0..100_000).map(|i| tiny(f64::from(i))).chain([huge])).unwrap();
        let model = Model::new(scene, Some(DVec2::new(-1e-3, -1e-3))).unwrap();
        // Along the row of walls, a nanometre below it and in steps of two, and far away from there.
        let mut points: Vec<_> = (0..50_000).map(|i| DVec2::new(f64::from(i) * 2e-9, -1e-9)).collect();
        points.extend([1.0, 1e6, 1e30, far].map(|x| DVec2::new(x, -1e-3)));
        let settled = settle_owned(&model, Trace { id: 0, points });
        assert_eq!(settled.steps(), 50_003);
        assert_eq!(settled.violation(), None);
    }
}
