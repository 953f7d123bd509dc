//! What touching means, against a truth that pushes points off the walls really.
//!
//! On lattices, every point at which a trace touches is replaced by points a little off the walls, all round it, and
//! all ways over such points that touch no wall are tried. A trace keeps to the rules exactly if there is such a way,
//! and its rope is, but for that little, the rope of one of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};
use tautline::engine::{Engine, Job, Reference};
use tautline::geometry::{between, opposite, orient};
use tautline::scene::{Inside, Model, Object, Scene, Wall};
use tautline::trace::{Trace, settle};

/// How far points are pushed: so little that no way comes near another lattice point, and exact in f64.
const LITTLE: f64 = 1.0 / 16384.0;

/// How many ways are kept at each point, of those that differ in their ropes.
const WAYS: usize = 24;

/// Boxes on even numbers and walls between whole numbers; traces on whole numbers.
#[derive(Debug, Clone)]
struct Case {
    boxes: Vec<[i8; 4]>,
    walls: Vec<[i8; 4]>,
    anchor: Stand,
    points: Vec<Stand>,
}

/// Where a trace stands: on a lattice point, or for some on one of those that lie on walls, if there are any.
#[derive(Debug, Clone, Copy)]
struct Stand([i8; 2], Option<u8>);

fn cases() -> impl Strategy<Value = Case> {
    let at = || -4i8..5;
    let boxes = prop::collection::vec([at(), at(), 1i8..4, 1i8..4], 0..3);
    let walls = prop::collection::vec([at(), at(), -3i8..4, -3i8..4], 0..4);
    let stand = || ([-5i8..6, -5i8..6], prop::option::weighted(0.7, any::<u8>())).prop_map(|(at, on)| Stand(at, on));
    let points = prop::collection::vec(stand(), 1..6);
    (boxes, walls, stand(), points).prop_map(|(boxes, walls, anchor, points)| Case { boxes, walls, anchor, points })
}

fn p([x, y]: [i8; 2]) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y))
}

impl Case {
    /// Boxes are solid, walls thin.
    fn scene(&self) -> Scene {
        let (mut objects, mut walls) = (vec![Object::default()], vec![]);
        for &[x, y, w, h] in &self.walls {
            walls.push(Wall { ends: [p([x, y]), p([x + w, y + h])], object: 0, reversed: false });
        }
        for &[x, y, w, h] in &self.boxes {
            let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(p);
            let object = objects.len() as u32;
            objects.push(Object { inside: Inside::EvenOdd, ..Object::default() });
            walls.extend((0..4).map(|i| Wall { ends: [corners[i], corners[(i + 1) % 4]], object, reversed: false }));
        }
        Scene::of(objects, walls).unwrap()
    }

    /// Whether a point a little off the anchor lies in a box on whose border the anchor stands.
    fn is_in_border_box(&self, anchor: DVec2, q: DVec2) -> bool {
        self.boxes.iter().any(|&[x, y, w, h]| {
            let (low, high) = (p([x, y]), p([x + w, y + h]));
            let closed = |q: DVec2| q.cmpge(low).all() && q.cmple(high).all();
            let open = |q: DVec2| q.cmpgt(low).all() && q.cmplt(high).all();
            closed(anchor) && !open(anchor) && open(q)
        })
    }
}

fn ends(scene: &Scene) -> impl Iterator<Item = [DVec2; 2]> {
    (0..scene.walls().len()).map(|wall| scene.ends(wall))
}

fn is_on(scene: &Scene, q: DVec2) -> bool {
    ends(scene).any(|[u, v]| q == u || q == v || orient(u, v, q) == 0.0 && between(u, v, q))
}

/// Whether a segment shares no point with any wall.
fn is_free(scene: &Scene, a: DVec2, b: DVec2) -> bool {
    ends(scene).all(|[u, v]| {
        let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
        let boxes = u.min(v).cmpgt(a.max(b)).any() || u.max(v).cmplt(a.min(b)).any();
        boxes || apart(orient(u, v, a), orient(u, v, b)) || apart(orient(a, b, u), orient(a, b, v))
    })
}

/// `q`, or where it touches a wall the points round it, close together enough that lattice walls part them.
fn pushed(scene: &Scene, q: DVec2) -> Vec<DVec2> {
    if !is_on(scene, q) {
        return vec![q];
    }
    // Directions between any two of walls whose slopes are fractions of numbers up to 3.
    let round = [
        [8, 1],
        [5, 2],
        [7, 5],
        [5, 4],
        [4, 5],
        [5, 7],
        [2, 5],
        [1, 8],
        [1, 0],
        [3, 1],
        [2, 1],
        [3, 2],
        [1, 1],
        [2, 3],
        [1, 2],
        [1, 3],
    ];
    let quarter = |[x, y]: [i8; 2]| [[x, y], [-y, x], [-x, -y], [y, -x]];
    let all: Vec<DVec2> = round.into_iter().flat_map(quarter).map(|d| q + LITTLE * p(d) / 8.0).collect();
    all.into_iter().filter(|&q| !is_on(scene, q)).collect()
}

/// The rope's corners without those that it passes straight once everything is back on the lattice.
fn corners(wraps: &[(DVec2, tautline::rope::Side)], from: DVec2, to: DVec2) -> Vec<[i64; 2]> {
    let mut rope = vec![from];
    for &(at, _) in wraps {
        if rope[rope.len() - 1] != at {
            rope.push(at);
        }
    }
    if rope[rope.len() - 1] != to || rope.len() == 1 {
        rope.push(to);
    }
    let mut i = 1;
    while i + 1 < rope.len() {
        let [a, b, c] = [rope[i - 1], rope[i], rope[i + 1]];
        if orient(a, b, c) == 0.0 && between(a, c, b) {
            rope.remove(i);
        } else {
            i += 1;
        }
    }
    rope.iter().map(|q| [q.x as i64, q.y as i64]).collect()
}

/// The ropes of all ways over pushed points, `None` if there is no way. Also whether some ways were left out.
fn truth(case: &Case, model: &Arc<Model>, points: &[DVec2]) -> (Option<Vec<Vec<[i64; 2]>>>, bool) {
    let scene = model.scene();
    let anchor = points[0];
    let starts = pushed(scene, anchor).into_iter().filter(|&q| !case.is_in_border_box(anchor, q));
    // Ways by where they end and by their rope, so that one of each kind is kept.
    let mut ways: Vec<Vec<DVec2>> = starts.map(|q| vec![q]).collect();
    let mut left_out = false;
    for i in 0..points.len() {
        let here = points[i];
        let places = pushed(scene, here);
        if i > 0 {
            let mut next: BTreeMap<(usize, Vec<[i64; 2]>), Vec<DVec2>> = BTreeMap::new();
            for way in &ways {
                for (k, &q) in places.iter().enumerate() {
                    if is_free(scene, way[way.len() - 1], q) {
                        let mut longer = way.clone();
                        longer.push(q);
                        next.entry((k, rope(model, &longer, anchor, here))).or_insert(longer);
                    }
                }
            }
            left_out |= next.len() > WAYS;
            ways = spread(next.into_values().collect(), WAYS);
        }
        // Round the point where it stays, from place to place.
        let mut known: BTreeMap<(usize, Vec<[i64; 2]>), Vec<DVec2>> = BTreeMap::new();
        let number = |q: DVec2| places.iter().position(|&p| p == q).expect("ways end at places");
        for way in &ways {
            known.entry((number(way[way.len() - 1]), rope(model, way, anchor, here))).or_insert_with(|| way.clone());
        }
        let mut fresh: Vec<Vec<DVec2>> = known.values().cloned().collect();
        while let Some(way) = fresh.pop() {
            for (k, &q) in places.iter().enumerate() {
                if q != way[way.len() - 1] && is_free(scene, way[way.len() - 1], q) {
                    let mut longer = way.clone();
                    longer.push(q);
                    let key = (k, rope(model, &longer, anchor, here));
                    // Once round a whole pillar of no size is not meant: a rope that winds up at a point.
                    if longer.len() <= 3 * points.len() && !known.contains_key(&key) {
                        known.insert(key, longer.clone());
                        fresh.push(longer);
                    }
                }
            }
            if known.len() > 4 * WAYS {
                left_out = true;
                break;
            }
        }
        ways = known.into_values().collect();
    }
    let mut ropes: Vec<_> = ways.iter().map(|way| rope(model, way, anchor, points[points.len() - 1])).collect();
    ropes.sort();
    ropes.dedup();
    ((!ropes.is_empty()).then_some(ropes), left_out)
}

/// At most so many of them, from everywhere.
fn spread(ways: Vec<Vec<DVec2>>, most: usize) -> Vec<Vec<DVec2>> {
    let step = ways.len().div_ceil(most).max(1);
    ways.into_iter().step_by(step).collect()
}

/// The rope of a way that touches nothing, brought back to the lattice.
fn rope(model: &Arc<Model>, way: &[DVec2], anchor: DVec2, to: DVec2) -> Vec<[i64; 2]> {
    let model = Arc::new(model.tied(way[0]).unwrap());
    let settled = settle(&model, &Trace { id: 0, points: way.to_vec() });
    assert_eq!(settled.violation(), None);
    let record = Reference::new(model.clone()).evaluate(&[settled], &Job::new()).unwrap().remove(0);
    corners(&record.wraps, anchor, to)
}

fn check(case: &Case) {
    let scene = case.scene();
    let lattice = (-8i8..9).flat_map(|x| (-8i8..9).map(move |y| p([x, y])));
    let on_walls: Vec<DVec2> = lattice.filter(|&q| is_on(&scene, q)).collect();
    let stand = |Stand(at, on)| match on {
        Some(k) if !on_walls.is_empty() => on_walls[usize::from(k) % on_walls.len()],
        _ => p(at),
    };
    let anchor = stand(case.anchor);
    let model = Arc::new(Model::new(scene.clone(), Some(anchor)).unwrap());
    let own: Vec<DVec2> = case.points.iter().map(|&q| stand(q)).collect();
    // With the vertices that steps pass.
    let mut points = vec![anchor];
    for &to in &own {
        let from = points[points.len() - 1];
        let mut passed: Vec<DVec2> =
            scene.vertices().iter().copied().filter(|&v| orient(from, to, v) == 0.0 && between(from, to, v)).collect();
        passed.sort_by(|a, b| from.distance_squared(*a).total_cmp(&from.distance_squared(*b)));
        points.extend(passed);
        points.push(to);
    }
    points.dedup();
    if points.windows(2).any(|w| {
        ends(&scene).any(|[u, v]| {
            opposite(orient(u, v, w[0]), orient(u, v, w[1])) && opposite(orient(w[0], w[1], u), orient(w[0], w[1], v))
        })
    }) {
        // Through a wall: no way of pushing helps, and `settle` says so.
        assert!(settle(&model, &Trace { id: 0, points: own }).violation().is_some());
        return;
    }
    let settled = settle(&model, &Trace { id: 0, points: own });
    let (ropes, left_out) = truth(case, &model, &points);
    let Some(ropes) = ropes else {
        assert!(left_out || settled.violation().is_some(), "no way is free, and no step is refused");
        return;
    };
    assert_eq!(settled.violation(), None, "some way is free: {ropes:?}");
    let record = Reference::new(model.clone()).evaluate(&[settled], &Job::new()).unwrap().remove(0);
    let ours = corners(&record.wraps, anchor, points[points.len() - 1]);
    assert!(left_out || ropes.contains(&ours), "{ours:?} is none of {ropes:?}");
}

#[test]
fn touching_is_what_pushing_off_makes_of_it() {
    // PROPTEST_CASES=2560 runs ten times as many.
    let cases_count = 300 * ProptestConfig::default().cases / 256;
    let config = ProptestConfig { cases: cases_count, failure_persistence: None, ..ProptestConfig::default() };
    let result = TestRunner::new(config).run(&cases(), |case| {
        check(&case);
        Ok(())
    });
    if let Err(TestError::Fail(why, case)) = &result {
        panic!("{why}\n{case:?}");
    }
    result.unwrap();
}
