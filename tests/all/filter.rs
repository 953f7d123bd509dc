//! That the candidate pass misses nothing, on two million near-degenerate queries and on real walks; and that this is
//! able to fail.

use std::sync::Arc;

use proptest::prelude::ProptestConfig;
use rayon::prelude::*;
use tautline::candidates::{LISTS_BUDGET, Lists, MARGIN, Simd};
use tautline::example::{Walker, random_walls, settled_walks};
use tautline::gpu::{GpuPass, SWEEP_WGSL, Tuning};
use tautline::lab::filter::{Filter, QUERIES, Trial};
use tautline::scene::{Model, read_scene};

use crate::support::software;

const SEED: u64 = 20;

/// What the loops at full width, those of the baseline, and the shader on the software adapter make of some trials.
fn all_passes(trials: u64, change: impl Fn(Trial) -> Trial + Sync) -> [Filter; 3] {
    let tuning = Tuning { queries: QUERIES, workgroup: 64 };
    let mut pass: GpuPass = GpuPass::new(software(), 1, QUERIES * 14, LISTS_BUDGET, tuning, SWEEP_WGSL).unwrap();
    let mut all = [Filter::default(); 3];
    for first in (0..trials).step_by(32) {
        let swept = |number| {
            let trial = change(Trial::new(SEED, number));
            let [wide, narrow] = [Simd::detected(), Simd::baseline()].map(|simd| trial.swept(simd));
            (trial, wide, narrow)
        };
        let swept: Vec<_> = (first..trials.min(first + 32)).into_par_iter().map(swept).collect();
        for (trial, wide, narrow) in swept {
            let found = [wide, narrow, trial.dispatched(&mut pass).unwrap()];
            all = std::array::from_fn(|i| [all[i], found[i]].into_iter().sum());
        }
    }
    all
}

/// PROPTEST_CASES=2560 asks ten times as many.
#[test]
fn no_pass_misses_a_vertex_in_two_million_near_degenerate_queries() {
    let trials = 4096 * u64::from(ProptestConfig::default().cases) / 256;
    let [wide, narrow, device] = all_passes(trials, |trial| trial);
    println!("near-degenerate queries: {wide:?}, {:.2} % of the vertices named are false", 100.0 * wide.false_share());
    println!("on the device: {device:?}, {:.2} %", 100.0 * device.false_share());
    assert_eq!(wide, narrow);
    for found in [wide, device] {
        assert_eq!((found.queries, found.missed), (trials * QUERIES as u64, 0), "{found:?}");
        // Vertices inside, vertices so close by that they are named too, and others.
        assert!(
            found.inside > 4 * found.queries && found.inside < found.named && found.named < found.tried,
            "{found:?}"
        );
        assert!((0.001..0.5).contains(&found.false_share()), "{found:?}");
    }
}

#[test]
fn without_its_margin_every_pass_misses_some() {
    for found in all_passes(32, |trial| trial.shrunk(MARGIN)) {
        assert!(found.missed > 100, "{found:?}");
    }
    // What all errors come to is enough, with what rounding the offsets once more costs.
    let enough = 1.6e-6 + 2f64.powi(-23);
    for found in all_passes(32, |trial| trial.shrunk(MARGIN - enough)) {
        assert_eq!(found.missed, 0, "{found:?}");
    }
}

#[test]
fn no_walk_meets_a_vertex_that_its_queries_miss() {
    let aegean = read_scene(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/aegean.geojson").as_ref()).unwrap();
    for (name, scene, step) in [("random-500", random_walls(500, 1), 0.01), ("aegean", aegean, 0.5)] {
        let model = Arc::new(Model::new(scene, None).unwrap());
        let walks = settled_walks(&model, Walker { step, steps: 1000, seed: 1 }, 100);
        let found = Filter::of_walks(&model, &walks).unwrap();
        println!("{name}: {found:?}, {:.4} % of the vertices named are false", 100.0 * found.false_share());
        assert!(found.queries > 1000 && found.inside > 100 && found.named < found.tried / 10, "{name}: {found:?}");
        assert!(found.missed == 0 && found.false_share() < 0.05, "{name}: {found:?}");
    }
}

/// The NaN by which lists fill up their last block stay on the CPU.
#[test]
fn devices_are_given_numbers_only() {
    let model = Arc::new(Model::new(random_walls(9, 1), None).unwrap());
    let lists = Lists::new(model.clone());
    let given: Vec<[f32; 2]> = lists.all().coordinates().collect();
    assert_eq!(given.len(), 18);
    assert!(given.iter().flatten().all(|x| x.abs() <= 1.0), "{given:?}");
}
