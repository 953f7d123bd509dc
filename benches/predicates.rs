//! The exact signs: `cargo bench --bench predicates`. Rates are in signs.
//!
//! Points anywhere are decided by the first, rounded product; points almost on one line need the exact arithmetic.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::DVec2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use tautline::geometry::{Hair, TracePoint, Turn, left_of, orient, orient_step};

fn main() {
    divan::main();
}

const TRIPLES: usize = 1000;

const ANYWHERE: &str = "anywhere";
const PLACES: [&str; 2] = [ANYWHERE, "almost on one line"];

/// Triples of points: anywhere, or the third as near to the line of the others as it can be rounded.
fn triples(place: &str) -> Vec<[DVec2; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut unit = || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut triple = || {
        let [p, q, r] = [(); 3].map(|()| DVec2::new(unit(), unit()));
        if place == ANYWHERE { [p, q, r] } else { [p, q, p + unit() * (q - p)] }
    };
    (0..TRIPLES).map(|_| triple()).collect()
}

fn time(bencher: Bencher<'_, '_>, place: &str, sign: impl Fn(&[DVec2; 3]) -> bool) {
    let triples = triples(place);
    bencher
        .counter(ItemsCount::new(TRIPLES))
        .bench_local(|| black_box(&triples).iter().filter(|triple| sign(triple)).count());
}

#[divan::bench(name = "orient", args = PLACES)]
fn orient_(bencher: Bencher<'_, '_>, place: &str) {
    time(bencher, place, |&[p, q, r]| orient(p, q, r) > 0.0);
}

#[divan::bench(name = "left_of", args = PLACES)]
fn left_of_(bencher: Bencher<'_, '_>, place: &str) {
    time(bencher, place, |&[o, p, a]| left_of(o, p, a.into()));
}

#[divan::bench(name = "orient_step", args = PLACES)]
fn orient_step_(bencher: Bencher<'_, '_>, place: &str) {
    time(bencher, place, |&[a0, a1, p]| orient_step(a0.into(), a1.into(), p) > 0.0);
}

/// The goal stands on the very vertex, so that its hair decides.
#[divan::bench]
fn orient_step_by_hair(bencher: Bencher<'_, '_>) {
    time(bencher, ANYWHERE, |&[a0, p, witness]| {
        let a1 = TracePoint { at: p, hair: Some(Hair { witness, away: false, turn: Turn::Left }) };
        orient_step(a0.into(), a1, p) > 0.0
    });
}
