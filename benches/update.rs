//! The exact update of one leg with a few candidates: `cargo bench --bench update`. Rates are in legs.
//! The arguments are numbers of candidates.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::DVec2;
use tautline::rope::{EventKind, Leg, Rope, Sweep};

fn main() {
    divan::main();
}

const LEGS: usize = 1000;

/// Vertices beside each other at distance 1 from the anchor in the origin, within a quarter turn.
fn vertices(count: usize) -> Vec<DVec2> {
    (0..count).map(|i| DVec2::from_angle(1.5 * (i as f64 + 0.5) / count as f64)).collect()
}

/// The leg from direction `from` to direction `to` at distance 2.
fn leg(from: f64, to: f64) -> Leg {
    let at = |angle: f64| (2.0 * DVec2::from_angle(angle)).into();
    Leg { a0: at(from), a1: at(to) }
}

/// Plays `legs`, whose candidates are all `vertices`, and returns how many events there were.
fn play(rope: &mut Rope, legs: &[Leg], vertices: &[DVec2]) -> usize {
    let mut events = 0;
    for leg in legs {
        let mut sweep = Sweep::default();
        while sweep.next(rope, leg, vertices, 0..vertices.len() as u32).is_some() {
            events += 1;
        }
    }
    events
}

/// Most legs: they pass between the vertices, and nothing happens.
#[divan::bench(args = [0, 1, 4, 15])]
fn nothing_happens(bencher: Bencher<'_, '_>, candidates: usize) {
    let vertices = vertices(candidates);
    let steps = (0..LEGS).map(|k| 1.6 + 0.4 * k as f64 / LEGS as f64);
    let legs: Vec<Leg> = steps.map(|angle| leg(angle, angle + 0.4 / LEGS as f64)).collect();
    let mut rope = Rope::new(DVec2::ZERO);
    bencher.counter(ItemsCount::new(LEGS)).bench_local(|| {
        assert_eq!(play(&mut rope, black_box(&legs), &vertices), 0);
    });
}

/// One wrap forth and its unwrap back, over and over.
#[divan::bench(args = [1, 4, 15])]
fn a_wrap_and_an_unwrap(bencher: Bencher<'_, '_>, candidates: usize) {
    let vertices = vertices(candidates);
    let ends = [-0.1, 1.5 / candidates as f64];
    let legs: Vec<Leg> = (0..LEGS).map(|k| leg(ends[k % 2], ends[1 - k % 2])).collect();
    let mut rope = Rope::new(DVec2::ZERO);
    let mut first = Sweep::default();
    assert!(matches!(first.next(&mut rope, &legs[0], &vertices, [0]), Some((EventKind::Wrap, 0, _))));
    rope.reset(DVec2::ZERO);
    bencher.counter(ItemsCount::new(LEGS)).bench_local(|| {
        assert_eq!(play(&mut rope, black_box(&legs), &vertices), LEGS);
    });
}
