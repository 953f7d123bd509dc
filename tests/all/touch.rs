//! Traces that touch walls: small cases worked out by hand.

use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Engine, Funnel, Job, Reference};
use tautline::rope::{Status, replay};
use tautline::scene::{Inside, Model, Object, Scene, Wall, read_scene};
use tautline::trace::{Trace, ViolationKind, settle};

type P = [f64; 2];

fn model(anchor: P, walls: &[[P; 2]]) -> Arc<Model> {
    let walls = walls.iter().map(|w| w.map(DVec2::from));
    Arc::new(Model::new(Scene::new(walls).unwrap(), Some(anchor.into())).unwrap())
}

fn trace(points: &[P]) -> Trace {
    Trace { id: 0, points: points.iter().copied().map(DVec2::from).collect() }
}

/// The taut rope after every step, as vertices with `<` for left and `>` for right; both methods must agree on it.
fn ropes(model: &Arc<Model>, points: &[P]) -> Vec<String> {
    let trace = trace(points);
    let settled = settle(model, &trace);
    assert_eq!(settled.violation(), None);
    let by = |engine: &mut dyn Engine| {
        let record = engine.evaluate(std::slice::from_ref(&settled), &Job::new()).unwrap().remove(0);
        let mut ropes = vec![];
        replay(model.anchor(), model.vertices(), points.len(), &record.events, |k, rope| {
            let contacts = rope.taut(points[k].into());
            let sign = |side: &str| if side == "left" { '<' } else { '>' };
            ropes.push(contacts.iter().map(|c| format!("{}{}", c.vertex, sign(c.side.name()))).collect::<String>());
        });
        ropes
    };
    let ropes = by(&mut Reference::new(model.clone()));
    assert_eq!(ropes, by(&mut Funnel::new(model.clone())));
    ropes
}

fn violation(model: &Model, points: &[P]) -> Option<(usize, ViolationKind, usize)> {
    settle(model, &trace(points)).violation().map(|v| (v.step, v.kind, v.wall))
}

/// A wall from vertex 0 at the origin to vertex 1 at (4, 0).
const LONE: [[P; 2]; 1] = [[[0.0, 0.0], [4.0, 0.0]]];

/// A closed square with vertices 0 (0, 0), 1 (2, 0), 2 (2, 2), 3 (0, 2).
const BOX: [[P; 2]; 4] =
    [[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [2.0, 2.0]], [[2.0, 2.0], [0.0, 2.0]], [[0.0, 2.0], [0.0, 0.0]]];

#[test]
fn a_trace_turns_back_on_a_wall_end() {
    // To the end and back: nothing is wound. To the end and on past it: wound round it.
    let m = model([1.0, -1.0], &LONE);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [-1.0, -1.0]]), ["", ""]);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [1.0, 1.0]]), ["", "0>"]);
    assert_eq!(ropes(&m, &[[-1.0, -1.0], [1.0, 1.0]]), ["", "0>"]);
}

#[test]
fn a_slide_stays_on_the_side_that_it_comes_from() {
    // From below along the wall and off below: never above it.
    let m = model([1.0, -1.0], &LONE);
    assert_eq!(ropes(&m, &[[-1.0, -1.0], [0.0, 0.0], [4.0, 0.0], [5.0, -1.0]]), ["", "", "", ""]);
    // From above and off above: round the near end.
    assert_eq!(ropes(&m, &[[-1.0, 0.5], [0.0, 0.0], [4.0, 0.0], [5.0, 1.0]]), ["", "", "0>", "0>"]);
    // From below and off above: both sides would do, so it is the left.
    assert_eq!(ropes(&m, &[[-1.0, -1.0], [0.0, 0.0], [4.0, 0.0], [3.0, 1.0]]), ["", "", "0>", "0>"]);
}

#[test]
fn a_slide_there_and_back_winds_round_nothing() {
    // Along the wall and back on one side of it. It comes from below and goes on to above, so that is the left: above.
    let m = model([-1.0, -0.5], &LONE);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [4.0, 0.0], [0.0, 0.0], [-1.0, 0.5]]), ["", "0>", "", ""]);
    // It comes from below and goes on to below.
    assert_eq!(ropes(&m, &[[0.0, 0.0], [4.0, 0.0], [0.0, 0.0], [-1.0, -0.6]]), ["", "", "", ""]);
}

#[test]
fn a_slide_straight_over_both_ends_goes_on_the_left() {
    // From east to west the left is below, where the anchor is; from west to east it is above.
    let m = model([2.0, -1.0], &LONE);
    assert_eq!(ropes(&m, &[[5.0, 0.0], [-1.0, 0.0], [2.0, -0.5]]), ["", "", ""]);
    assert_eq!(ropes(&m, &[[-1.0, 0.0], [5.0, 0.0], [2.0, -0.5]]), ["", "0>", "0>1>"]);
    assert_eq!(
        ropes(&m, &[[-1.0, 0.0], [0.0, 0.0], [4.0, 0.0], [5.0, 0.0], [2.0, -0.5]]),
        ["", "", "0>", "0>", "0>1>"]
    );
}

#[test]
fn slides_go_round_the_corners_of_a_box() {
    let m = model([-1.0, -1.0], &BOX);
    let round = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0], [-1.0, 0.5]];
    assert_eq!(ropes(&m, &round), ["", "", "1<", "1<2<", "1<2<3<", "1<2<3<"]);
    // From corner to corner inside, the anchor being inside: nothing to wind round.
    let inside = model([0.5, 0.5], &BOX);
    assert_eq!(ropes(&inside, &[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]]), ["", "", "", "", ""]);
}

#[test]
fn a_slide_rounds_the_tip_of_a_wall() {
    // A stick on a box: along its one side to the tip and back along the other.
    let mut walls = BOX.to_vec();
    walls.push([[2.0, 2.0], [5.0, 5.0]]);
    let m = model([3.0, 1.0], &walls);
    assert_eq!(ropes(&m, &[[2.0, 0.0], [2.0, 2.0], [5.0, 5.0], [2.0, 2.0], [0.0, 2.0]]), ["", "", "", "4<", "4<"]);
}

#[test]
fn slides_round_a_tip_there_and_back() {
    let mut walls = BOX.to_vec();
    walls.push([[2.0, 2.0], [5.0, 5.0]]);
    let m = model([3.0, 1.0], &walls);
    let there = [[2.0, 0.0], [2.0, 2.0], [5.0, 5.0], [2.0, 2.0], [0.0, 2.0]];
    let back = [[2.0, 2.0], [5.0, 5.0], [5.0, 5.0], [2.0, 2.0], [2.0, 0.0]];
    let all = [&there[..], &back, &there[1..], &back].concat();
    let round = ["", "", "", "4<", "4<", "4<", "", "", "", "", "", "", "4<", "4<", "4<", "", "", "", ""];
    assert_eq!(ropes(&m, &all), round);
}

#[test]
fn a_step_passes_several_ends_at_once() {
    // Three posts in a row: their ends lie on one line, which the step follows. They stand below it.
    let posts = [0.0, 1.0, 2.0].map(|x| [[x, 0.0], [x, -1.0]]);
    let m = model([-1.0, -0.5], &posts);
    assert_eq!(ropes(&m, &[[-1.0, 0.0], [3.0, 0.0], [2.5, -2.0]]), ["", "0>", "0>4>"]);
}

#[test]
fn an_anchor_at_a_walls_end() {
    let m = model([0.0, 0.0], &LONE);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [4.0, 0.0], [5.0, 1.0], [5.0, -1.0], [1.0, -1.0]]), ["", "", "", "1>", "1>"]);
    // Past the anchor and back.
    assert_eq!(ropes(&m, &[[1.0, 1.0], [0.0, 0.0], [-1.0, -1.0], [1.0, -1.0]]), ["", "", "", ""]);
}

#[test]
fn walls_that_overlap_are_slid_along_as_one() {
    let m = model([1.0, -1.0], &[[[0.0, 0.0], [2.0, 0.0]], [[1.0, 0.0], [3.0, 0.0]]]);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [3.0, 0.0], [4.0, -1.0]]), ["", "", ""]);
    assert_eq!(ropes(&m, &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, -1.0]]), ["", "", "", "", ""]);
}

#[test]
fn steps_that_break_the_rules_are_named() {
    use ViolationKind::{Crosses, SlipsThrough};
    let m = model([1.0, -1.0], &BOX);
    assert_eq!(violation(&m, &[[1.0, 1.0]]), Some((0, Crosses, 0)));
    assert_eq!(violation(&m, &[[3.0, -1.0], [3.0, 1.0], [1.0, 1.5]]), Some((2, Crosses, 1)));
    // On to the middle of a wall and away on its other side: it is the step away that crosses it.
    assert_eq!(violation(&m, &[[1.0, -0.5], [1.0, 0.0], [1.0, 1.0]]), Some((2, Crosses, 0)));
    // Through the corner of the closed box, at one stroke or resting there.
    assert_eq!(violation(&m, &[[-1.0, -1.0], [1.0, 1.0]]), Some((1, SlipsThrough, 0)));
    assert_eq!(violation(&m, &[[0.0, 0.0], [0.0, 0.0], [1.0, 1.0]]), Some((2, SlipsThrough, 0)));
    // Touching from outside is legal in every way.
    assert_eq!(violation(&m, &[[0.0, 0.0], [-1.0, 1.0], [0.0, 2.0], [3.0, 2.0], [2.0, 0.0], [2.0, 2.0]]), None);
}

#[test]
fn a_trace_stands_on_the_middle_of_a_wall_on_the_side_from_which_it_comes() {
    let m = model([1.0, -1.0], &LONE);
    // From below, along the wall and off again below: nothing to wind round.
    assert_eq!(ropes(&m, &[[1.0, 0.0], [3.0, 0.0], [3.0, -1.0]]), ["", "", ""]);
    // From above: round the near end, also while it stands there.
    assert_eq!(ropes(&m, &[[-1.0, 1.0], [1.0, 0.0], [3.0, 0.0], [3.0, 1.0]]), ["", "0>", "0>", "0>"]);
    // To the tip and round it, where it goes on to the other side.
    assert_eq!(ropes(&m, &[[1.0, 0.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]), ["", "", "0>", "0>"]);
    // Off to the other side it may not go, neither at once nor after a stay or a slide.
    for points in
        [&[[1.0, 0.0], [1.0, 1.0]][..], &[[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]], &[[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]]
    {
        let last = points.len() - 1;
        assert_eq!(violation(&m, points), Some((last, ViolationKind::Crosses, 0)), "{points:?}");
    }
}

#[test]
fn an_anchor_on_the_middle_of_a_wall() {
    // A thin wall has no side: the first step says on which the rope starts, and it keeps to that.
    let m = model([2.0, 0.0], &LONE);
    assert_eq!(ropes(&m, &[[2.0, 1.0], [-1.0, 1.0], [1.0, -1.0]]), ["", "", "0<"]);
    assert_eq!(ropes(&m, &[[2.0, -1.0], [-1.0, -1.0], [1.0, 1.0]]), ["", "", "0>"]);
    assert_eq!(ropes(&m, &[[3.0, 0.0], [5.0, 0.0], [3.0, -1.0]]), ["", "", "1>"]);
}

/// A solid box, 3 wide and 1 high, with vertices 0 (1, 1), 1 (4, 1), 2 (4, 2), 3 (1, 2).
fn solid(anchor: P, inside: Inside) -> Arc<Model> {
    let corners = [[1.0, 1.0], [4.0, 1.0], [4.0, 2.0], [1.0, 2.0]].map(DVec2::from);
    let wall = |i: usize| Wall { ends: [corners[i], corners[(i + 1) % 4]], object: 0, reversed: false };
    // Counter-clockwise: its inside is on the left, so seen the other way round it is on the right.
    let wall = |i| Wall { reversed: inside == Inside::Right, ..wall(i) };
    let scene = Scene::of(vec![Object { inside, ..Object::default() }], (0..4).map(wall)).unwrap();
    Arc::new(Model::new(scene, Some(anchor.into())).unwrap())
}

#[test]
fn a_trace_along_the_border_of_a_solid_goes_round_it() {
    for inside in [Inside::EvenOdd, Inside::NonZero, Inside::Right] {
        let m = solid([1.0, 2.0], inside);
        assert_eq!(ropes(&m, &[[1.0, 1.0], [4.0, 1.0]]), ["", "0<"]);
        let m = solid([4.0, 1.0], inside);
        assert_eq!(ropes(&m, &[[1.0, 1.0], [1.0, 2.0]]), ["", "0>"]);
        // From the middle of its border, on over a corner; and into it.
        let m = solid([2.0, 2.0], inside);
        assert_eq!(ropes(&m, &[[1.0, 2.0], [1.0, 1.0], [3.0, 1.0]]), ["", "3<", "3<0<"]);
        assert_eq!(violation(&m, &[[2.0, 1.5]]), Some((0, ViolationKind::EntersSolid, 2)));
        assert_eq!(violation(&m, &[[2.0, 2.0], [3.0, 2.0], [3.0, 1.5]]), Some((2, ViolationKind::Crosses, 2)));
        let m = solid([1.0, 2.0], inside);
        assert_eq!(violation(&m, &[[1.0, 2.0], [2.0, 1.5]]), Some((1, ViolationKind::EntersSolid, 2)));
        assert_eq!(violation(&m, &[[1.0, 2.0], [1.0, 2.0]]), None);
    }
    // A thin outline has no inside: the rope starts on the side on which the trace goes on.
    let m = solid([1.0, 2.0], Inside::Free);
    assert_eq!(ropes(&m, &[[1.0, 2.0], [2.0, 1.5]]), ["", ""]);
}

/// Between two solids that touch there is no way, and a hole in a solid is free.
#[test]
fn solids_that_touch_and_holes() {
    let ring = |low: P, high: P| {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(DVec2::from);
        (0..4).map(move |i| [corners[i], corners[(i + 1) % 4]]).collect::<Vec<_>>()
    };
    let scene = |objects: &[&[Vec<[DVec2; 2]>]]| {
        let walls = objects.iter().zip(0..).flat_map(|(rings, object)| {
            rings.iter().flatten().map(move |&ends| Wall { ends, object, reversed: false })
        });
        let polygon = Object { inside: Inside::EvenOdd, ..Object::default() };
        Scene::of(vec![polygon; objects.len()], walls).unwrap()
    };
    let [left, right] = [ring([0.0, 0.0], [1.0, 1.0]), ring([1.0, 0.0], [2.0, 1.0])];
    let touching = scene(&[&[left], &[right]]);
    let m = Arc::new(Model::new(touching, Some([1.0, 1.0].into())).unwrap());
    assert_eq!(violation(&m, &[[1.0, 1.0], [1.0, 0.5]]), Some((1, ViolationKind::EntersSolid, 1)));
    let frame = scene(&[&[ring([0.0, 0.0], [4.0, 4.0]), ring([1.0, 1.0], [3.0, 3.0])]]);
    let m = Arc::new(Model::new(frame.clone(), Some([1.0, 1.0].into())).unwrap());
    assert_eq!(ropes(&m, &[[3.0, 1.0], [2.0, 2.0]]), ["", ""]);
    assert_eq!(violation(&m, &[[0.5, 0.5]]), Some((0, ViolationKind::EntersSolid, 4)));
    let m = Arc::new(Model::new(frame, Some([0.0, 0.0].into())).unwrap());
    assert_eq!(violation(&m, &[[0.5, 0.5]]), Some((0, ViolationKind::EntersSolid, 0)));
}

/// The step at which nothing helps any more is named, not an earlier one that would have been right another way.
#[test]
fn the_step_that_is_wrong_is_named() {
    let walls = [[[2.0, 0.0], [3.0, 0.0]], [[3.0, 0.0], [3.0, 3.0]], [[2.0, 0.0], [2.0, 3.0]]];
    let m = model([1.0, 0.0], &walls);
    // Below the lower wall and up the right one, which is legal.
    assert_eq!(ropes(&m, &[[1.0, 0.0], [3.0, 0.0], [3.0, 1.0]]), ["", "", "1<"]);
    // From there to the inside it is not, nor from the corner.
    assert_eq!(violation(&m, &[[1.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.5, 1.0]]), Some((3, ViolationKind::Crosses, 1)));
    assert_eq!(violation(&m, &[[1.0, 0.0], [3.0, 0.0], [2.5, 1.0]]), Some((2, ViolationKind::SlipsThrough, 0)));
}

/// Along real coasts from vertex to vertex, resting on them, cutting corners and leaving them again, as planners'
/// shortest paths do.
#[test]
fn traces_along_real_coasts() {
    let scene = read_scene(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/aegean.geojson").as_ref()).unwrap();
    let coast = scene.vertices().to_vec();
    let mut touched = 0;
    for start in (0..coast.len()).step_by(97) {
        let m = Arc::new(Model::new(scene.clone(), Some(coast[start])).unwrap());
        let (mut here, mut points, mut draw) = (start, vec![coast[start]], start as u64);
        for _ in 0..60 {
            // Knuth's linear congruential generator.
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let last = points[points.len() - 1];
            let there = (here + 1 + (draw >> 60) as usize / 4).min(coast.len() - 1);
            let next = match (draw >> 40) % 4 {
                0 => last + DVec2::from_angle((draw >> 50) as f64) * 0.7,
                1 => coast[here.saturating_sub(1)],
                _ => coast[there],
            };
            points.push(next);
            if settle(&m, &Trace { id: 0, points: points.clone() }).violation().is_some() {
                points.pop();
            } else if let Some(vertex) = m.vertex_at(next) {
                (here, touched) = (vertex as usize, touched + 1);
            }
        }
        ropes(&m, &points.iter().map(|p| p.to_array()).collect::<Vec<_>>());
    }
    assert!(touched > 1000, "only {touched} points stand on vertices");
}

/// The product of two areas of the smallest scenes underflows to zero.
#[test]
fn steps_that_break_the_rules_are_named_at_every_scale() {
    for exponent in [-440, -300, 0, 300, 490] {
        let scaled = |p: P| p.map(|c| c * 2f64.powi(exponent));
        let m = model(scaled([1.0, -1.0]), &BOX.map(|w| w.map(scaled)));
        let points = [[1.0, -0.5], [0.5, -0.5], [1.0, 1.0]].map(scaled);
        assert_eq!(violation(&m, &points), Some((2, ViolationKind::Crosses, 0)), "2^{exponent}");
    }
}

/// Through walls a rope can turn more than half way round a wall's end, where the update's rules found events without
/// end.
#[test]
fn a_trace_through_walls_comes_to_an_end() {
    let walls = [
        [[4.0, 2.0], [5.0, 2.0]],
        [[-4.0, -2.0], [-4.0, -3.0]],
        [[-2.0, 1.0], [-1.0, 1.0]],
        [[-2.0, 2.0], [-2.0, -1.0]],
    ];
    #[rustfmt::skip]
    let points = [
        [0.013, 0.017], [-1.0, 2.0], [-2.5, 0.0], [0.5, 0.0], [2.0, -1.0], [0.5, 2.5], [3.0, 0.0], [5.0, 3.5], [4.5, 5.5],
        [4.5, 7.5], [2.0, 5.0], [3.5, 2.0], [5.0, 0.5], [4.0, -3.5], [4.0, -2.0], [4.5, 1.5], [0.5, 5.0], [-2.0, 2.0],
        [-3.0, -0.5], [-4.5, 1.0], [-3.5, 0.5], [-1.0, 4.0], [0.5, 4.5], [3.5, 0.5], [3.0, -1.0], [2.0, 2.0], [3.5, 2.5],
        [2.0, 6.5], [1.0, 7.5], [0.5, 6.0], [-1.5, 5.0], [2.5, 5.5], [3.0, 2.0], [4.5, 4.5], [0.5, 5.0], [4.5, 2.0],
        [6.5, 0.5], [3.0, 3.0], [-0.5, 1.5], [0.0, 0.0], [-1.0, -0.5], [0.0, 0.0],
    ];
    let m = model([0.013, 0.017], &walls);
    let settled = settle(&m, &trace(&points));
    assert!(settled.violation().is_some());
    let record = Reference::new(m.clone()).evaluate(&[settled], &Job::new()).unwrap().remove(0);
    assert_eq!((record.status, record.steps), (Status::Violation, 41));
}

/// Across a corner where four walls meet, again and again: a step that breaks the rules each time. However many there
/// are, none is said to do so that need not.
#[test]
fn tens_of_thousands_of_slips_hide_none() {
    let hub = [0.0, 0.0];
    let [east, north, west, south] = [[2.0, 0.0], [0.0, 2.0], [-2.0, 0.0], [0.0, -2.0]];
    let m = model([1.0, -1.0], &[east, north, west, south].map(|tip| [hub, tip]));
    // In on the one side of the wall to the east and out along it, which is allowed; to the west from there it is not.
    for slips in [1, 65_535, 65_536, 70_000] {
        let across = [west, hub, east, hub].into_iter().cycle().take(2 * slips - 1);
        let points: Vec<P> = [[1.0, -1.0], hub, east, hub].into_iter().chain(across).collect();
        assert_eq!(violation(&m, &points), Some((4, ViolationKind::SlipsThrough, 0)), "{slips} slips");
    }
}
