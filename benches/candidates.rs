//! The candidate pass over all vertices, on the CPU and as one round of the GPU: `cargo bench --bench candidates`.
//! Rates are in queries.

use std::sync::Arc;
use std::sync::LazyLock;

use divan::Bencher;
use divan::counter::ItemsCount;
use tautline::candidates::{Found, LISTS_BUDGET, Lists, Query, Simd, Slopes, Window};
use tautline::example::{BuiltIn, Walker, settled_walks};
use tautline::gpu::{AdapterChoice, Device, GpuPass, SWEEP_WGSL, Sweeping};
use tautline::scene::Model;

fn main() {
    divan::main();
}

const QUERIES: u64 = 4096;

/// How many legs a query covers at most: about what windows grow to.
const LEGS: usize = 32;

static MODEL: LazyLock<Arc<Model>> = LazyLock::new(|| {
    Arc::new(Model::new(BuiltIn::Random(500).scene(1), None).expect("the anchor stands off the walls"))
});

/// Queries about the anchor over the windows that start with the second point of as many walks.
fn queries(lists: &Lists) -> Vec<Query> {
    let mut slopes = Slopes::default();
    let mut query = |points: &[_]| {
        let window = Window::fold(Simd::detected(), MODEL.anchor(), None, points, &mut slopes)?;
        Some(window.query(lists.frame(), MODEL.anchor()))
    };
    let walks = settled_walks(&MODEL, Walker { step: 0.01, steps: LEGS, seed: 1 }, QUERIES);
    walks.iter().filter_map(|walk| query(&walk.points()[1..])).collect()
}

/// On one thread.
#[divan::bench]
fn cpu(bencher: Bencher<'_, '_>) {
    let lists = Lists::new(MODEL.clone()).keep_all();
    let queries = queries(&lists);
    let (list, simd, mut found) = (lists.all(), Simd::detected(), Vec::new());
    bencher.counter(ItemsCount::new(queries.len())).bench_local(|| {
        found.clear();
        queries.iter().for_each(|query| simd.sweep(list, query, list.len(), &mut found));
        found.len()
    });
}

/// One round: upload, kernel and readback, on the best adapter that there is.
#[divan::bench]
fn gpu_round(bencher: Bencher<'_, '_>) {
    let lists = Lists::new(MODEL.clone()).keep_all();
    let (list, mut queries) = (lists.all(), queries(&lists));
    let device = Device::open(&AdapterChoice::Best).expect("an adapter");
    let (n, tuning) = (MODEL.vertices().len(), device.tuning());
    let mut pass = GpuPass::<Sweeping>::new(device, lists.keys(), n, LISTS_BUDGET, tuning, SWEEP_WGSL).expect("a pass");
    queries.truncate(pass.capacity());
    let mut found = vec![Found::default(); queries.len()];
    bencher.counter(ItemsCount::new(queries.len())).bench_local(|| {
        pass.start_round();
        let first = pass.place(lists.key(MODEL.pivot(None), list), list.len(), || list.coordinates().collect());
        let first = first.expect("the first list of a round finds room");
        queries.iter_mut().for_each(|query| (query.first, query.count) = (first, n as u32));
        pass.send(0, &queries, &[]);
        pass.collect(0, &mut found).expect("the round is done");
    });
}
