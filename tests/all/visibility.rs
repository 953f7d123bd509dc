//! What a pivot sees, against a look at every wall for every vertex.

use glam::DVec2;
use proptest::prelude::*;
use tautline::geometry::{between, opposite, orient};
use tautline::scene::Model;
use tautline::visibility::{Scratch, Visibility};

use crate::scenes::{KINDS, Kind, recipe};

/// Whether a wall lies properly across the way from `o` to `p`.
fn is_blocked(model: &Model, o: DVec2, p: DVec2) -> bool {
    (0..model.scene().walls().len()).any(|wall| {
        let [u, v] = model.scene().ends(wall);
        opposite(orient(u, v, o), orient(u, v, p)) && opposite(orient(o, p, u), orient(o, p, v))
    })
}

/// Whether the walls that meet at vertex `v` leave one side of the line from `o` free.
fn is_tangent(model: &Model, o: DVec2, v: u32) -> bool {
    let p = model.vertices()[v as usize];
    let meets = model.scene().walls().iter().filter(|w| w.contains(&v));
    let sides: Vec<f64> = meets
        .map(|w| model.vertices()[if w[0] == v { w[1] } else { w[0] } as usize])
        .map(|end| orient(o, p, end))
        .collect();
    !(sides.iter().any(|&s| s > 0.0) && sides.iter().any(|&s| s < 0.0))
}

/// Whether walls cross where no vertex is.
fn has_crossings(model: &Model) -> bool {
    let ends: Vec<_> = (0..model.scene().walls().len()).map(|w| model.scene().ends(w)).collect();
    ends.iter().enumerate().any(|(i, &[a, b])| {
        ends[..i]
            .iter()
            .any(|&[c, d]| opposite(orient(a, b, c), orient(a, b, d)) && opposite(orient(c, d, a), orient(c, d, b)))
    })
}

/// Looks from every pivot of a model, and returns how many vertices were seen.
fn check(kind: Kind, model: &Model) -> Result<usize, TestCaseError> {
    let Some(visibility) = Visibility::new(model) else {
        prop_assert!(matches!(kind, Kind::Tiny | Kind::Huge | Kind::Far), "{kind:?} can be triangulated");
        return Ok(0);
    };
    let exact = kind == Kind::Lattice || !has_crossings(model);
    // The same from inside a box, as far as it reaches.
    let n = model.vertices().len();
    let reach = model.vertices()[n / 3..]
        .iter()
        .take(n / 3 + 1)
        .fold((model.anchor(), model.anchor()), |(l, h), &p| (l.min(p), h.max(p)));
    let is_near = |p: DVec2| p.cmpge(reach.0).all() && p.cmple(reach.1).all();
    let near = Visibility::within(model, reach).expect("a part can be triangulated where the whole can");
    let (mut scratch, mut seen, mut total) = (Scratch::default(), vec![], 0);
    for pivot in model.pivots() {
        visibility.look(pivot, &mut scratch, &mut seen);
        total += seen.len();
        let mut once = seen.clone();
        once.sort_unstable();
        once.dedup();
        prop_assert_eq!(once.len(), seen.len(), "a vertex is listed twice");
        let o = model.position(pivot);
        if is_near(o) {
            let mut nearby = vec![];
            near.look(pivot, &mut scratch, &mut nearby);
            nearby.retain(|&v| is_near(model.vertices()[v as usize]));
            nearby.sort_unstable();
            let expected: Vec<u32> = once.iter().copied().filter(|&v| is_near(model.vertices()[v as usize])).collect();
            if exact {
                prop_assert_eq!(nearby, expected, "a look from {} within {:?}", o, reach);
            } else {
                // Which of the walls that cross stay open may differ; what is surely to be seen is checked below.
                for (v, &p) in (0..).zip(model.vertices()) {
                    let is_next = !is_blocked(model, o, p) && is_tangent(model, o, v) && p != o;
                    let behind = model.vertices().iter().any(|&q| orient(o, p, q) == 0.0 && between(o, p, q));
                    prop_assert!(
                        !is_next || behind || !is_near(p) || nearby.contains(&v),
                        "{p} is missing within {reach:?}"
                    );
                }
            }
        }
        // Bounded by lines through walls that do not go through the pivot, a look sees the same, as far as they let it.
        let lines: Vec<[DVec2; 2]> = (0..model.scene().walls().len())
            .map(|wall| model.scene().ends(wall))
            .filter(|&[u, v]| orient(u, v, o) != 0.0)
            .skip(pivot.index() % 5)
            .take(3)
            .collect();
        let is_outside = |p: DVec2, [u, v]: [DVec2; 2]| opposite(orient(u, v, o), orient(u, v, p));
        let outside = |p: DVec2| lines.iter().zip(0..).map(|(&line, i)| u8::from(is_outside(p, line)) << i).sum();
        let mut within = vec![];
        visibility.look_into(pivot, outside, usize::MAX, &mut scratch, &mut within);
        let expected: Vec<u32> = once.iter().copied().filter(|&v| outside(model.vertices()[v as usize]) == 0).collect();
        within.sort_unstable();
        prop_assert_eq!(within, expected, "a look from {} bounded by {:?}", o, lines);
        for (v, &p) in (0..).zip(model.vertices()) {
            let hidden = is_blocked(model, o, p);
            let behind = model.vertices().iter().any(|&q| orient(o, p, q) == 0.0 && between(o, p, q));
            if p != o && !hidden && !behind && is_tangent(model, o, v) {
                prop_assert!(seen.contains(&v), "{p} is missing from the list of {o}");
            }
            if exact && seen.contains(&v) {
                prop_assert!(!hidden && is_tangent(model, o, v), "{p} cannot be next after {o}");
            }
        }
    }
    Ok(total)
}

#[test]
fn lists_hold_what_a_look_at_every_wall_finds() {
    for kind in KINDS {
        let cases = 100 * ProptestConfig::default().cases / 256;
        let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
        let mut runner = proptest::test_runner::TestRunner::new(config);
        let total = std::cell::Cell::new(0);
        let result = runner.run(&recipe(kind, false), |recipe| {
            total.set(total.get() + check(kind, &recipe.model())?);
            Ok(())
        });
        result.unwrap_or_else(|e| panic!("{kind:?}: {e}"));
        assert!(total.get() > 1000 || matches!(kind, Kind::Tiny | Kind::Huge), "{kind:?}: only {} seen", total.get());
    }
}
