//! Traces of all kinds, against every wall.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::*;
use crate::example::BuiltIn;
use crate::geometry::{between, forwards, orient};
use crate::scene::{Scene, read_scene};
use crate::study::Start;
use crate::trace::settle;

pub(super) const STARTS: [Start; 2] = [Start::Anchor, Start::Visible];

/// Whether two segments have a point in common: each crosses the other's line, or an end of one lies on the other.
fn meet(s: [DVec2; 2], t: [DVec2; 2]) -> bool {
    let sides = |[a, b]: [DVec2; 2], of: [DVec2; 2]| of.map(|p| orient(a, b, p).total_cmp(&0.0));
    let crosses = |line, of| matches!(sides(line, of), [one, other] if one == other.reverse() && one.is_ne());
    let on = |p: DVec2, [a, b]: [DVec2; 2]| p == a || p == b || (orient(a, b, p) == 0.0 && between(a, b, p));
    (crosses(s, t) && crosses(t, s)) || s.iter().any(|&p| on(p, t)) || t.iter().any(|&p| on(p, s))
}

/// Whether a step from `a` to `b` touches a wall from which it does not just leave.
fn touches(model: &Model, [a, b]: [DVec2; 2]) -> bool {
    (0..model.scene().walls().len()).map(|wall| model.scene().ends(wall)).any(|[u, v]| {
        match [(u, v), (v, u)].iter().find(|end| end.0 == a) {
            Some(&(_, far)) if a == model.anchor() => b != a && orient(a, far, b) == 0.0 && !forwards(far, a, b),
            _ => meet([a, b], [u, v]),
        }
    })
}

/// Scenes with the lengths of steps that suit them. In the last the anchor stands at walls' ends.
pub(super) fn scenes() -> Vec<(Arc<Model>, f64)> {
    let built_in = [BuiltIn::Rooms, BuiltIn::Random(150), BuiltIn::Random(1), BuiltIn::Lattice(120)];
    let models = built_in.map(|s| (Arc::new(Model::new(s.scene(3), None).unwrap()), 4.0 * s.step()));
    let walls =
        [[[0.0, 0.0], [2.0, 0.5]], [[0.0, 0.0], [-1.0, 2.0]], [[-3.0, -3.0], [3.0, -2.0]], [[3.0, 3.0], [3.0, 1.0]]];
    let scene = Scene::new(walls.map(|wall| wall.map(DVec2::from))).unwrap();
    let at_end = Model::new(scene, Some(DVec2::ZERO)).unwrap();
    models.into_iter().chain([(Arc::new(at_end), 0.5)]).collect()
}

fn uniform(step: f64, steps: u32, start: Start, at_walls: AtWalls) -> WalkPlan {
    WalkPlan::Uniform(UniformWalk { step, steps, start, at_walls, tether: None, at_tether: None })
}

fn gaussian(step: f64, steps: u32, start: Start, at_walls: AtWalls) -> WalkPlan {
    WalkPlan::Gaussian(GaussianWalk { step, steps, start, at_walls, tether: None, at_tether: None })
}

fn persistent(step: f64, steps: u32, turn: f64, start: Start, at_walls: AtWalls) -> WalkPlan {
    WalkPlan::Persistent(PersistentWalk { step, steps, turn, start, at_walls, tether: None, at_tether: None })
}

/// All kinds of walks with a step of that length.
fn walks(step: f64, steps: u32, start: Start) -> Vec<WalkPlan> {
    let at = |at_walls| {
        [
            uniform(step, steps, start, at_walls),
            gaussian(step, steps, start, at_walls),
            persistent(step, steps, 0.4, start, at_walls),
        ]
    };
    [AtWalls::Redraw, AtWalls::Reject, AtWalls::Reflect].into_iter().flat_map(at).collect()
}

pub(super) fn own_points(trace: &SettledTrace) -> Vec<DVec2> {
    (0..trace.points().len()).filter(|&i| trace.ends_step(i)).map(|i| trace.points()[i]).collect()
}

#[test]
fn walks_touch_no_wall_and_stay_in_the_box() {
    for (model, step) in scenes() {
        let (low, high) = model.bounds();
        for start in STARTS {
            for plan in walks(step, 250, start) {
                let walks = Walks::new(model.clone(), &plan, 11).unwrap();
                for number in [0, 1, 2, u64::MAX] {
                    let trace = walks.trace(number);
                    let points = own_points(&trace);
                    assert_eq!((trace.id(), points.len(), trace.violation()), (number, 251, None));
                    assert_eq!(start == Start::Anchor, points[0] == model.anchor());
                    let way: Vec<DVec2> = [&[model.anchor()], points.as_slice()].concat();
                    for pair in way.windows(2) {
                        assert!(!touches(&model, [pair[0], pair[1]]), "{plan:?}, trace {number}: {pair:?}");
                        assert!(pair[1].cmpge(low).all() && pair[1].cmple(high).all(), "{plan:?}: {pair:?}");
                    }
                    // What is known of it without a look at the walls is what the look says.
                    let again = settle(&model, &Trace { id: number, points });
                    assert_eq!(trace, again.with_walked(trace.walked()), "{plan:?}");
                    let far = way.iter().map(|p| p.distance(way[1])).fold(0.0, f64::max);
                    assert!(far > 2.0 * step, "{plan:?}, trace {number} stays within {far}");
                }
            }
        }
    }
}

#[test]
fn drives_keep_to_the_rules_and_to_their_steps() {
    let coasts = read_scene(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/aegean.geojson").as_ref()).unwrap();
    let coasts = (Arc::new(Model::new(coasts, None).unwrap()), 5.0);
    for (model, step) in scenes().into_iter().chain([coasts]) {
        let (low, high) = model.bounds();
        for start in STARTS {
            let plan = WalkPlan::Waypoints(WaypointDrive { step, steps: 400, start });
            let walks = Walks::new(model.clone(), &plan, 11).unwrap();
            for number in 0..6 {
                let trace = walks.trace(number);
                let points = own_points(&trace);
                assert_eq!((points.len(), trace.violation()), (401, None), "trace {number}");
                assert!(points.iter().all(|p| p.cmpge(low).all() && p.cmple(high).all()));
                assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "it goes on and on");
                for pair in points.windows(2).filter(|pair| pair[0].distance(pair[1]) > step * (1.0 + 1e-12)) {
                    // Only where there is no room for the points between.
                    let at_ends = pair.iter().all(|&p| model.vertex_at(p).is_some() || p == model.anchor());
                    assert!(at_ends, "trace {number}: {pair:?} is longer than {step}");
                }
            }
        }
    }
}

#[test]
fn a_trace_is_found_by_its_number_alone() {
    let (model, step) = scenes().remove(0);
    let drive = WalkPlan::Waypoints(WaypointDrive { step, steps: 50, start: Start::Visible });
    for plan in walks(step, 50, Start::Visible).into_iter().chain([drive]) {
        let all: Vec<_> = {
            let walks = Walks::new(model.clone(), &plan, 5).unwrap();
            (0..40u64).into_par_iter().map(|number| walks.trace(number)).collect()
        };
        let walks = Walks::new(model.clone(), &plan, 5).unwrap();
        for number in [39, 3, 17, 3, 0] {
            assert_eq!(walks.trace(number), all[number as usize], "{plan:?}");
        }
        assert!((1..40).all(|i| all[i].points() != all[0].points()), "{plan:?}");
        assert_ne!(Walks::new(model.clone(), &plan, 6).unwrap().trace(3).points(), all[3].points());
    }
}

/// A square room of that size round the anchor.
pub(super) fn square(half: f64) -> Arc<Model> {
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]].map(DVec2::from);
    let scene = Scene::new((0..4).map(|i| [corners[i], corners[(i + 1) % 4]])).unwrap();
    Arc::new(Model::new(scene, Some(DVec2::ZERO)).unwrap())
}

#[test]
fn steps_have_their_length_and_headings_turn_within_their_bounds() {
    for (half, is_free) in [(1e6, true), (3.0, false)] {
        for plan in walks(0.5, 2000, Start::Anchor) {
            let points = own_points(&Walks::new(square(half), &plan, 1).unwrap().trace(0));
            let steps: Vec<DVec2> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (at_walls, turn) = match plan {
                WalkPlan::Uniform(UniformWalk { at_walls, .. }) => (at_walls, None),
                WalkPlan::Persistent(PersistentWalk { at_walls, turn, .. }) => (at_walls, Some(turn)),
                _ => continue,
            };
            let has_length = |s: &&DVec2| (s.length() - 0.5).abs() < 1e-9;
            let taken: Vec<&DVec2> = steps.iter().filter(|s| **s != DVec2::ZERO).collect();
            assert!(taken.len() > 100 && (!is_free || taken.len() == 2000), "{plan:?}: {}", taken.len());
            if is_free || at_walls != AtWalls::Reflect {
                assert!(taken.iter().all(has_length), "{plan:?}");
            }
            if let Some(turn) = turn.filter(|_| is_free) {
                let turns: Vec<f64> = steps.windows(2).map(|pair| pair[0].angle_to(pair[1])).collect();
                assert!(turns.iter().all(|t| t.abs() < turn + 1e-9));
                let mean = turns.iter().sum::<f64>() / 1999.0;
                assert!(mean.abs() < 5.0 * turn / (3.0 * 1999f64).sqrt() && turns.iter().any(|t| t.abs() > 0.9 * turn));
            }
        }
    }
}

#[test]
fn gaussian_steps_have_their_moments() {
    let plan = gaussian(0.5, 40_000, Start::Anchor, AtWalls::Redraw);
    let points = own_points(&Walks::new(square(1e6), &plan, 1).unwrap().trace(0));
    let n = 40_000f64;
    let steps: Vec<DVec2> = points.windows(2).map(|pair| (pair[1] - pair[0]) / 0.5).collect();
    let mean = steps.iter().sum::<DVec2>() / n;
    let square = steps.iter().map(|s| s * s).sum::<DVec2>() / n;
    let product = steps.iter().map(|s| s.x * s.y).sum::<f64>() / n;
    assert!(mean.abs().max_element() < 5.0 / n.sqrt(), "{mean}");
    assert!((square - 1.0).abs().max_element() < 5.0 * (2.0 / n).sqrt(), "{square}");
    assert!(product.abs() < 5.0 / n.sqrt(), "{product}");
}

#[test]
fn starts_are_uniform_over_what_is_visible() {
    // A wall before the anchor hides what lies behind it: a quarter of the room, from below the anchor at its centre.
    let corners = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]].map(DVec2::from);
    let hiding = [[-1.0, 1.0], [1.0, 1.0]].map(DVec2::from);
    let scene = Scene::new((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).chain([hiding])).unwrap();
    let model = Arc::new(Model::new(scene, Some(DVec2::ZERO)).unwrap());
    let plan = uniform(0.1, 1, Start::Visible, AtWalls::Redraw);
    let walks = Walks::new(model, &plan, 1).unwrap();
    let mut counts = [0; 4];
    for number in 0..4900 {
        let p = own_points(&walks.trace(number))[0];
        // Left, right, below; and above, of which only the unit triangle before the wall is visible, 1 of 16.
        let side = if p.x.abs() > p.y.abs() { usize::from(p.x > 0.0) } else { 2 + usize::from(p.y > 0.0) };
        assert!(side != 3 || p.y < 1.0, "{p} is hidden");
        counts[side] += 1;
    }
    let expected = [1600.0, 1600.0, 1600.0, 100.0];
    assert!((0..4).all(|i| (f64::from(counts[i]) - expected[i]).abs() < 5.0 * expected[i].sqrt()), "{counts:?}");
}

#[test]
fn errors_say_what_would_be_right() {
    let error = |model: Arc<Model>, plan: WalkPlan| {
        Walks::new(model, &plan, 1).err().map(|e| e.to_string()).unwrap_or_default()
    };
    let uniform = |step, steps| uniform(step, steps, Start::Anchor, AtWalls::Redraw);
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(error(square(1.0), uniform(step, 10)).contains("give a number above 0"), "{step}");
    }
    for steps in [0, (1 << 31) - 1, u32::MAX] {
        assert!(error(square(1.0), uniform(0.1, steps)).contains("from 1 to 2147483646"), "{steps}");
    }
    for turn in [-0.1, 3.15, f64::NAN] {
        let plan = persistent(0.1, 9, turn, Start::Anchor, AtWalls::Redraw);
        assert!(error(square(1.0), plan).contains("from 0 to pi"), "{turn}");
    }
    let flat = Scene::new([[DVec2::ZERO, DVec2::X]]).unwrap();
    let flat = Arc::new(Model::new(flat, Some(DVec2::new(2.0, 0.0))).unwrap());
    assert!(error(flat, uniform(0.1, 9)).contains("no room to walk in"));
    assert!(error(square(1.0), WalkPlan::Given { file: "a.csv".into() }).contains("not drawn"));
    let wide = Scene::new([[DVec2::ZERO, DVec2::new(1e120, 1e-120)], [DVec2::Y, DVec2::X]]).unwrap();
    let wide = Arc::new(Model::new(wide, Some(DVec2::splat(2.0))).unwrap());
    let drive = WalkPlan::Waypoints(WaypointDrive { step: 0.1, steps: 9, start: Start::Anchor });
    assert!(error(wide, drive).contains("cannot be triangulated"));
}

/// What other versions drew, by which stored studies go on: where this fails, the number in the identity of studies
/// must rise.
#[test]
fn traces_are_those_of_other_versions() {
    let model = Arc::new(Model::new(BuiltIn::Rooms.scene(1), None).unwrap());
    let (step, steps, start) = (0.25, 300, Start::Anchor);
    let plans = [
        (uniform(step, steps, start, AtWalls::Redraw), "535b71366e5512d0"),
        (gaussian(step, steps, start, AtWalls::Reflect), "fe6d55280f7cd262"),
        (persistent(step, steps, 0.4, Start::Visible, AtWalls::Reject), "190a31891113e557"),
        (WalkPlan::Waypoints(WaypointDrive { step, steps, start }), "70d78d68716207ef"),
    ];
    for (plan, known) in plans {
        let walks = Walks::new(model.clone(), &plan, 5).unwrap();
        let mut hasher = blake3::Hasher::new();
        for point in (0..20).flat_map(|number| walks.trace(number).points().to_vec()) {
            for c in point.to_array() {
                hasher.update(&c.to_bits().to_le_bytes());
            }
        }
        assert_eq!(&hasher.finalize().to_hex()[..16], known, "{plan:?}");
    }
}

/// Other programs draw the same walks by what the page says.
#[test]
fn the_page_has_the_constants_of_the_code() {
    use crate::study::{free_space, random};
    let page = include_str!("../../../docs/studies.md");
    let constants = [
        ("random blocks made together", random::BLOCKS.to_string()),
        ("stream of steps", (Purpose::Walk as u8).to_string()),
        ("stream of starts", (Purpose::Start as u8).to_string()),
        ("stream of anchors", (Purpose::Anchor as u8).to_string()),
        ("stream of goals", (Purpose::Goal as u8).to_string()),
        ("turns drawn together", persistent::AHEAD.to_string()),
        ("draws of a step that meets a wall", at_walls::TRIES.to_string()),
        ("least turn once drawn again", persistent::LEAST.to_string()),
        ("widening of the turn", persistent::WIDENS.to_string()),
        ("looks for a mirror", at_walls::MIRRORS.to_string()),
        ("goals drawn in vain", waypoints::TRIES.to_string()),
        ("points drawn in vain", free_space::TRIES.to_string()),
        ("slides drawn in", leash::DRAWN_IN.to_string()),
    ];
    let start = page.find("| constant | value |").expect("a table of constants");
    let rows: Vec<&str> = page[start..].lines().skip(2).take_while(|line| line.starts_with('|')).collect();
    let expected: Vec<String> = constants.iter().map(|(name, value)| format!("| {name} | {value} |")).collect();
    assert_eq!(rows, expected);
    // And what the text says of them.
    for phrase in [
        format!("drawn again up to {} times", at_walls::TRIES),
        format!("{} times the wider", persistent::WIDENS),
        format!("Up to {} times", at_walls::MIRRORS),
        format!("{} angles at once", persistent::AHEAD),
        format!("{} blocks at once", random::BLOCKS),
        format!("after {} times the free end stays", leash::DRAWN_IN),
    ] {
        let found = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(found.contains(&phrase), "{phrase}");
    }
}
