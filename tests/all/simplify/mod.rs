//! Scenes with fewer vertices against what must not change in them.

mod recipe;

use std::cell::Cell;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::engine::{Engine, Job, Reference};
use tautline::geometry::{forwards, higher, lower, orient, same_side};
use tautline::scene::{Model, Scene};
use tautline::simplify::simplify;
use tautline::trace::settle;

use recipe::{Kind, Recipe, recipes};

/// Whether two walls meet, other than at an end that both have.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    if lower(a, b).cmpgt(higher(c, d)).any() || lower(c, d).cmpgt(higher(a, b)).any() {
        return false;
    }
    match [a, b].into_iter().filter(|end| [c, d].contains(end)).collect::<Vec<_>>()[..] {
        [] => !same_side(orient(c, d, a), orient(c, d, b)) && !same_side(orient(a, b, c), orient(a, b, d)),
        [here] => {
            let (there, away) = (if a == here { b } else { a }, if c == here { d } else { c });
            orient(there, here, away) == 0.0 && !forwards(there, here, away)
        }
        _ => true,
    }
}

/// The lowest number of a vertex that each vertex hangs together with.
fn components(scene: &Scene) -> Vec<u32> {
    let mut of: Vec<u32> = (0..scene.vertices().len() as u32).collect();
    loop {
        let before = of.clone();
        for &[u, v] in scene.walls() {
            let low = of[u as usize].min(of[v as usize]);
            (of[u as usize], of[v as usize]) = (low, low);
        }
        if of == before {
            return of;
        }
    }
}

/// Whether a half-line from `p` crosses the walls an odd number of times. `None` where it stands on one of their ends.
fn is_inside(walls: &[[DVec2; 2]], p: DVec2) -> Option<bool> {
    if walls.iter().flatten().any(|&end| end == p) {
        return None;
    }
    let crosses = |&&[a, b]: &&[DVec2; 2]| {
        let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
        low.y <= p.y && p.y < high.y && orient(low, high, p) > 0.0
    };
    Some(walls.iter().filter(crosses).count() % 2 == 1)
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + share * (b - a))
}

fn walls(scene: &Scene) -> Vec<[DVec2; 2]> {
    (0..scene.walls().len()).map(|wall| scene.ends(wall)).collect()
}

/// The walls of each component of `scene`, by the number that the first of its vertices has among `numbers`'
/// components.
fn by_component(scene: &Scene, component: &HashMap<[u64; 2], u32>) -> BTreeMap<u32, Vec<[DVec2; 2]>> {
    let mut all: BTreeMap<u32, Vec<[DVec2; 2]>> = BTreeMap::new();
    for wall in walls(scene) {
        all.entry(component[&wall[0].to_array().map(f64::to_bits)]).or_default().push(wall);
    }
    all
}

/// What must be the same in both scenes, and how near they must be.
fn check(model: &Model, anchors: &[DVec2], simple: &Scene, tolerance: f64) {
    let scene = model.scene();
    let (old, new) = (walls(scene), walls(simple));
    for p in simple.vertices() {
        assert!(model.vertex_at(*p).is_some(), "{p} is none of the scene's vertices");
    }
    let is_old = |wall: &[DVec2; 2]| old.contains(wall) || old.contains(&[wall[1], wall[0]]);
    for (i, &wall) in new.iter().enumerate().filter(|(_, wall)| !is_old(wall)) {
        for (j, &other) in new.iter().enumerate() {
            assert!(i == j || !meet(wall, other), "{wall:?} meets {other:?}");
        }
        let hits = |&at: &DVec2| orient(wall[0], wall[1], at) == 0.0 && forwards(wall[0], at, wall[1]);
        assert_eq!(anchors.iter().find(|at| hits(at)), None, "{wall:?}");
    }

    let named = scene.vertices().iter().zip(components(scene));
    let component: HashMap<_, _> = named.map(|(p, c)| (p.to_array().map(f64::to_bits), c)).collect();
    let [before, after] = [scene, simple].map(|scene| by_component(scene, &component));
    assert!(before.keys().eq(after.keys()), "parts came or went");
    let mut apart = components(simple);
    apart.sort_unstable();
    apart.dedup();
    assert_eq!(apart.len(), after.len(), "parts fell apart");

    for (before, after) in before.values().zip(after.values()) {
        // Each is near the other.
        for p in before.iter().flatten() {
            let nearest = after.iter().map(|&wall| distance(*p, wall)).fold(f64::INFINITY, f64::min);
            assert!(nearest <= tolerance * (1.0 + 1e-12), "{p} is {nearest} away");
        }
        for [a, b] in after {
            for share in (0..=8).map(|i| f64::from(i) / 8.0) {
                let p = *a + share * (*b - *a);
                let nearest = before.iter().map(|&wall| distance(p, wall)).fold(f64::INFINITY, f64::min);
                assert!(nearest <= tolerance * (1.0 + 1e-12), "{p} is {nearest} away");
            }
        }
        // Closed walls have the same in them: anchors and the ends of other walls. Points on walls may fall on either
        // side.
        let mut ends: HashMap<[u64; 2], usize> = HashMap::new();
        before.iter().flatten().for_each(|p| *ends.entry(p.to_array().map(f64::to_bits)).or_default() += 1);
        if ends.values().any(|count| count % 2 == 1) {
            continue;
        }
        let others = simple.vertices().iter().chain(anchors).copied();
        for p in others.filter(|&p| before.iter().all(|&wall| !meet(wall, [p, p]))) {
            assert_eq!(is_inside(before, p), is_inside(after, p), "{p}");
        }
    }
}

/// Runs `body` on random models, their anchors and what is left of their scenes.
fn on_all(kinds: Vec<Kind>, body: impl Fn(&Recipe, &Arc<Model>, &[DVec2], Scene) -> Result<(), TestCaseError>) {
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let (cases, gone, tied) = (config.cases as usize, Cell::new(0), Cell::new(0));
    let result = TestRunner::new(config).run(&recipes(kinds), |recipe| {
        let Some(model) = recipe.model() else { return Ok(()) };
        let anchors = recipe.anchors(&model);
        let simple = simplify(model.scene(), &anchors, recipe.tolerance).unwrap();
        let more = model.vertices().len() - simple.vertices().len();
        gone.set(gone.get() + more);
        tied.set(tied.get() + usize::from(more > 0 && anchors.len() > 1));
        body(&recipe, &model, &anchors, simple)
    });
    result.unwrap_or_else(|e| panic!("{e}"));
    let (gone, tied) = (gone.get(), tied.get());
    assert!(gone > cases / 4 && tied > cases / 20, "{gone} went, in {tied} scenes of several anchors");
}

#[test]
fn nothing_meets_changes_sides_or_moves_too_far() {
    on_all(vec![Kind::Rings, Kind::Lattice, Kind::Chains, Kind::Crossing], |recipe, model, anchors, simple| {
        check(model, anchors, &simple, recipe.tolerance);
        let again = simplify(model.scene(), anchors, recipe.tolerance).unwrap();
        prop_assert_eq!((simple.vertices(), simple.walls()), (again.vertices(), again.walls()));
        Ok(())
    });
}

#[test]
fn closed_obstacles_only_give_way() {
    let longer = Cell::new(0);
    on_all(vec![Kind::Rings, Kind::Lattice], |recipe, model, _, simple| {
        if recipe.anchor.1 {
            return Ok(());
        }
        let simple = Arc::new(Model::new(simple, Some(model.anchor())).unwrap());
        let before = settle(model, &recipe.trace(model));
        let after = before.clone().coarsened(&simple, 1);
        prop_assert_eq!((after.crossings(), after.breaks_rules()), (0, false));
        // Each rope of the scene is one of the simpler scene too, if perhaps not its shortest.
        let length = |model, trace| Reference::new(model).evaluate(&[trace], &Job::new()).unwrap()[0].length;
        let [before, after] = [length(model.clone(), before), length(simple, after)];
        prop_assert!(after <= before * (1.0 + 1e-12), "{after} is longer than {before}");
        longer.set(longer.get() + usize::from(before > after));
        Ok(())
    });
    assert!(longer.get() > 0, "only {} ropes became shorter", longer.get());
}

fn line(points: &[[f64; 2]]) -> Vec<[DVec2; 2]> {
    points.windows(2).map(|p| [p[0].into(), p[1].into()]).collect()
}

fn left(walls: Vec<[DVec2; 2]>, anchors: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let anchors: Vec<DVec2> = anchors.iter().copied().map(DVec2::from).collect();
    let scene = simplify(&Scene::new(walls).unwrap(), &anchors, tolerance).unwrap();
    scene.vertices().iter().map(|p| p.to_array()).collect()
}

/// A square with a bump outwards below and a dent inwards above.
const SQUARE: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [4.0, 0.0],
    [5.0, -0.5],
    [6.0, 0.0],
    [9.0, 0.0],
    [9.0, 9.0],
    [6.0, 9.0],
    [5.0, 8.5],
    [4.0, 9.0],
    [0.0, 9.0],
    [0.0, 0.0],
];

#[test]
fn obstacles_give_way_to_where_the_rope_is_not() {
    let gone = |anchors: &[[f64; 2]]| {
        let left = left(line(&SQUARE), anchors, 0.6);
        SQUARE[..10].iter().filter(|p| !left.contains(p)).map(|p| p[0] as i32 * 10 + p[1] as i32).collect::<Vec<_>>()
    };
    // From outside, tips go and what is between them; from inside, the other way round.
    assert_eq!(gone(&[[5.0, -3.0]]), [50, 69, 49]);
    assert_eq!(gone(&[[5.0, 3.0]]), [40, 60, 58]);
    // Tied on both sides, nothing may give way; on the wall itself, all may.
    assert_eq!(gone(&[[5.0, -3.0], [5.0, 3.0]]), [0i32; 0]);
    assert_eq!(gone(&[[0.0, 0.0]]).len(), 6);
}

#[test]
fn what_stands_in_the_way_is_left_in_peace() {
    let hill = [[0.0, 0.0], [5.0, 1.0], [10.0, 0.0]];
    let ends = [hill[0], hill[2]];
    assert_eq!(left(line(&hill), &[[5.0, 3.0]], 1.0), ends);
    assert_eq!(left(line(&hill), &[[5.0, 3.0]], 0.999), hill);
    // The anchor, on the hill, in it, and under it right on the line.
    for anchor in [hill[1], [5.0, 0.5], [5.0, 0.0]] {
        assert_eq!(left(line(&hill), &[anchor], 2.0), hill, "{anchor:?}");
    }
    assert_eq!(left(line(&hill), &[[5.0, -1e-9]], 2.0), ends);
    assert_eq!(left(line(&hill), &[[5.0, 3.0], [5.0, 0.5]], 2.0), hill);
    // Walls: in it, with an end on the line, ending at one of its own ends, across.
    for wall in [
        [[4.0, 0.2], [5.0, 0.2]],
        [[4.0, 0.0], [4.0, -3.0]],
        [[0.0, 0.0], [2.0, 0.1]],
        [[2.0, -1.0], [2.0, 3.0]],
        [[5.0, 1.0], [5.0, 3.0]],
        [[0.0, 0.0], [10.0, 0.0]],
        [[0.0, 0.0], [10.0, 2.0]],
    ] {
        let with = [line(&hill), line(&wall)].concat();
        assert!(left(with, &[[7.0, 3.0]], 2.0).contains(&hill[1]), "{wall:?}");
    }
    // Walls that lead away from it are not in the way.
    let left_ones = [line(&[[0.0, 0.0], [-3.0, 0.0]]), line(&[[0.0, 0.0], [-3.0, 1.0]])].concat();
    let right_ones = [line(&[[10.0, 0.0], [0.0, -3.0]]), line(&[[10.0, 0.0], [12.0, 0.0]])].concat();
    let kept = left([line(&hill), left_ones, right_ones].concat(), &[[7.0, 3.0]], 2.0);
    assert!(!kept.contains(&hill[1]) && kept.len() == 6, "{kept:?}");
}

#[test]
fn what_waits_for_another_goes_after_it() {
    // The spike stands in the hill, and costs more.
    let both = [line(&[[0.0, 0.0], [5.0, 1.0], [10.0, 0.0]]), line(&[[4.9, -3.0], [5.0, 0.5], [5.1, -3.0]])].concat();
    assert_eq!(left(both.clone(), &[[5.0, 9.0]], 4.0).len(), 4);
    assert_eq!(left(both.clone(), &[[5.0, 9.0]], 2.0).len(), 6);
    // With an anchor in it, the spike stays, and so does the hill.
    assert_eq!(left(both, &[[5.0, 9.0], [5.0, -1.0]], 4.0).len(), 6);
}

#[test]
fn vertices_in_line_go_where_no_trace_may_stand_on_them() {
    let line_of = |y: f64| line(&[[0.0, y], [1.0, y], [2.0, y], [3.0, y]]);
    assert_eq!(left(line_of(0.0), &[[1.0, 3.0]], 1e-9), [[0.0, 0.0], [3.0, 0.0]]);
    let square =
        [line_of(0.0), line(&[[3.0, 0.0], [3.0, 3.0]]), line_of(3.0), line(&[[0.0, 3.0], [0.0, 0.0]])].concat();
    assert_eq!(left(square.clone(), &[[1.0, 9.0]], 1e-9).len(), 8);
    // Inside another, out of reach.
    let wall = [[-1.0, -1.0], [9.0, -1.0], [9.0, 9.0], [-1.0, 9.0], [-1.0, -1.0]];
    assert_eq!(left([square, line(&wall)].concat(), &[[-5.0, 9.0]], 1e-9).len(), 8);
}

#[test]
fn a_room_closed_by_walls_that_cross_anywhere_is_not_thought_open() {
    // Its walls cross at (1/3, ...), which no f64 names. Nothing is known of what is inside.
    let room = [[1.0, 3.0], [0.0, 0.0], [0.0, -9.0], [4.0, -8.5], [9.0, -9.0], [9.0, 0.0], [0.0, 1.0]];
    let kept = left(line(&room), &[[4.0, -20.0]], 1.0);
    assert!(kept.contains(&[4.0, -8.5]), "{kept:?}");
}

#[test]
fn what_is_no_tolerance_is_refused() {
    let scene = Scene::new(line(&[[0.0, 0.0], [1.0, 0.0]])).unwrap();
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = simplify(&scene, &[DVec2::new(0.0, 1.0)], tolerance).unwrap_err().to_string();
        assert!(error.contains("give a number above 0"), "{error}");
    }
    for anchors in [[f64::NAN, 9.0], [9.0, f64::NAN]] {
        let error = simplify(&scene, &anchors.map(|x| DVec2::new(x, 0.0)), 1.0).unwrap_err().to_string();
        assert!(error.contains("NaN is not a finite number"), "{error}");
    }
    let far = Scene::new(line(&[[0.0, 0.0], [2f64.powi(-300), 1.0], [2f64.powi(400), 0.0]])).unwrap();
    let error = simplify(&far, &[DVec2::new(0.0, 1.0)], 1.0).unwrap_err().to_string();
    assert!(error.contains("140 binary orders"), "{error}");
}

#[test]
fn long_lines_and_circles_take_no_longer_than_others() {
    // Ties everywhere: no wall may gather one vertex after the other.
    let n = 50_000;
    let corner = (0..=2 * n).map(|i| [f64::from((n - i).max(0)), f64::from((i - n).max(0))]);
    let corner: Vec<[f64; 2]> = corner.collect();
    assert_eq!(left(line(&corner), &[[-1.0, -1.0]], 1.0).len(), 3);
    let n = 100_000;
    let circle = (0..=n).map(|i| DVec2::from_angle(std::f64::consts::TAU * f64::from(i % n) / f64::from(n)).to_array());
    let circle: Vec<[f64; 2]> = circle.collect();
    let round = left(line(&circle), &[[3.0, 0.0]], 1e-4).len();
    assert!((150..500).contains(&round), "{round}");
}
