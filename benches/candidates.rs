//! The candidate pass, on the CPU and as one round of the GPU: `cargo bench --bench candidates`. Rates are in queries.

use std::sync::LazyLock;

use divan::Bencher;
use divan::counter::ItemsCount;
use tautline::candidates::{CandidatePass, CpuPass, Found, Query, swept};
use tautline::example::{BuiltIn, Walker, settled_walks};
use tautline::gpu::{AdapterChoice, Device, GpuPass};
use tautline::scene::Model;

fn main() {
    divan::main();
}

/// As many queries as a round of the engine `cpu` has.
const QUERIES: u64 = 4096;

/// How many legs a query covers: about what windows grow to.
const LEGS: usize = 32;

static MODEL: LazyLock<Model> =
    LazyLock::new(|| Model::new(BuiltIn::Random(500).scene(1), None).expect("the anchor stands off the walls"));

/// Runs queries over the first legs of as many walks.
fn time<P: CandidatePass>(bencher: Bencher<'_, '_>, mut pass: P) {
    let walks = settled_walks(&MODEL, Walker { step: 0.01, steps: LEGS, seed: 1 }, QUERIES);
    let frame = *pass.frame();
    let queries: Vec<Query> = walks.iter().map(|t| swept(&frame, MODEL.anchor(), t.points()).query).collect();
    let mut found = vec![Found::default(); queries.len()];
    bencher.counter(ItemsCount::new(queries.len())).bench_local(|| assert!(pass.run(&queries, &mut found).is_ok()));
}

#[divan::bench]
fn cpu(bencher: Bencher<'_, '_>) {
    time(bencher, CpuPass::new(&MODEL, QUERIES as usize));
}

/// One round: upload, kernel and readback, on the best adapter that there is.
#[divan::bench]
fn gpu_round(bencher: Bencher<'_, '_>) {
    let device = Device::open(&AdapterChoice::Best).expect("an adapter");
    time(bencher, GpuPass::new(device, &MODEL, QUERIES as usize).expect("a pass"));
}
