//! The scenes that have names: what is promised of them.

use glam::DVec2;
use tautline::example::{BuiltIn, Walker, settled_walks, walks};
use tautline::geometry::{between, orient};
use tautline::scene::{Model, Scene};
use tautline::trace::settle;

/// Whether two segments have a point in common: each crosses the other's line, or an end of one lies on the other.
fn meet(s: [DVec2; 2], t: [DVec2; 2]) -> bool {
    let sides = |[a, b]: [DVec2; 2], of: [DVec2; 2]| of.map(|p| orient(a, b, p).total_cmp(&0.0));
    let crosses = |line, of| matches!(sides(line, of), [one, other] if one == other.reverse() && one.is_ne());
    let on = |p: DVec2, [a, b]: [DVec2; 2]| p == a || p == b || (orient(a, b, p) == 0.0 && between(a, b, p));
    (crosses(s, t) && crosses(t, s)) || s.iter().any(|&p| on(p, t)) || t.iter().any(|&p| on(p, s))
}

fn walls(scene: &Scene) -> Vec<[DVec2; 2]> {
    (0..scene.walls().len()).map(|wall| scene.ends(wall)).collect()
}

#[test]
fn random_walls_are_disjoint_and_lie_in_the_square() {
    for (count, seeds) in [(1, 20), (2, 20), (7, 20), (60, 5), (500, 3), (20_000, 1)] {
        for seed in 0..seeds {
            let model = Model::new(BuiltIn::Random(count).scene(seed), None).unwrap();
            let walls = walls(model.scene());
            assert_eq!((walls.len(), model.vertices().len()), (count as usize, 2 * count as usize));
            assert!(model.vertices().iter().all(|p| p.abs().max_element() <= 1.0));
            for (i, &wall) in walls.iter().enumerate() {
                let [a, b] = wall;
                let near = model.index().near(a.min(b), a.max(b));
                let met = near.filter(|&other| other as usize != i).find(|&other| meet(wall, walls[other as usize]));
                assert_eq!(met, None, "random-{count}, seed {seed}, wall {i}");
            }
        }
    }
}

#[test]
fn random_walls_are_as_long_as_they_should_be() {
    let unit = 1.2 / 5000f64.sqrt();
    let lengths: Vec<f64> = walls(&BuiltIn::Random(5000).scene(2)).iter().map(|[a, b]| a.distance(*b) / unit).collect();
    assert!(lengths.iter().all(|l| (0.1 - 1e-9..=1.5 + 1e-9).contains(l)));
    // The mean of 5,000 uniform numbers in 0.1..1.5 is 0.8, within some hundredths; so is the share of the longest
    // tenth.
    let mean = lengths.iter().sum::<f64>() / 5000.0;
    assert!((mean - 0.8).abs() < 0.03, "{mean}");
    let longest = lengths.iter().filter(|l| **l > 1.36).count();
    assert!((400..600).contains(&longest), "{longest}");
}

#[test]
fn lattice_walls_are_the_walls_they_should_be() {
    for (count, seeds) in [(1, 20), (30, 5), (2000, 2)] {
        for seed in 0..seeds {
            let scene = BuiltIn::Lattice(count).scene(seed);
            assert_eq!(scene.walls().len(), count as usize);
            for [a, b] in walls(&scene) {
                assert_eq!([a, b], [a.round(), b.round()]);
                assert!((a.x == b.x) != (a.y == b.y) && [1.0, 2.0, 3.0].contains(&a.distance(b)), "{a} {b}");
            }
        }
    }
    // 4,000 ends on 8,281 places: some are shared.
    assert!(BuiltIn::Lattice(2000).scene(1).vertices().len() < 3400);
}

#[test]
fn scenes_are_the_same_for_the_same_seed_only() {
    for scene in [BuiltIn::Random(80), BuiltIn::Lattice(80)] {
        assert_eq!(walls(&scene.scene(5)), walls(&scene.scene(5)));
        assert_ne!(walls(&scene.scene(5)), walls(&scene.scene(6)), "{scene}");
    }
    // The same on every machine: these numbers must never change.
    let [a, b] = BuiltIn::Random(10).scene(1).ends(0);
    assert_eq!([a.to_array(), b.to_array()], FIRST_OF_RANDOM_10);
}

/// The first wall of `random-10` with seed 1.
const FIRST_OF_RANDOM_10: [[f64; 2]; 2] =
    [[0.7518839080117872, 0.6153645944791101], [0.9747414075264424, 0.6909520211341617]];

#[test]
fn walks_keep_to_the_rules_in_all_of_them() {
    for scene in [BuiltIn::Random(200), BuiltIn::Random(1), BuiltIn::Lattice(150), BuiltIn::Rooms] {
        let model = Model::new(scene.scene(3), None).unwrap();
        let walker = Walker { step: scene.step(), steps: 300, seed: 3 };
        let settled = settled_walks(&model, walker, 10);
        let one_by_one: Vec<_> = walks(&model, walker, 10).iter().map(|trace| settle(&model, trace)).collect();
        assert_eq!(settled, one_by_one);
        for trace in &settled {
            assert_eq!((trace.steps(), trace.violation()), (300, None), "{scene}");
            // It gets away from where it starts.
            let far = trace.points().iter().map(|p| p.distance(model.anchor())).fold(0.0, f64::max);
            assert!(far > 5.0 * scene.step(), "{scene}: trace {} stays within {far}", trace.id());
        }
    }
}

#[test]
fn names_are_read_as_they_are_written() {
    for scene in [BuiltIn::Random(1), BuiltIn::Random(1_000_000), BuiltIn::Lattice(7), BuiltIn::Rooms] {
        assert_eq!(scene.to_string().parse(), Ok(scene));
    }
    for name in ["", "room", "rooms-3", "random", "random500", "Random-5", "grid-5"] {
        let error = name.parse::<BuiltIn>().unwrap_err().to_string();
        assert!(error.contains(&format!("{name:?}; there are random-M and lattice-M, with M walls")), "{error}");
    }
    for number in ["", "0", "-1", "+5", "1.5", "1e3", "1000001", "99999999999999999999", "5 "] {
        for kind in ["random", "lattice"] {
            let error = format!("{kind}-{number}").parse::<BuiltIn>().unwrap_err().to_string();
            let expected = format!("{number:?} is no number of walls; give a whole number from 1 to 1,000,000");
            assert!(error.contains(&expected) && error.ends_with(&format!("such as {kind}-500")), "{error}");
        }
    }
}
