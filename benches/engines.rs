//! Engines side by side on the built-in floor plan: `cargo bench`.

use std::sync::Arc;
use std::sync::LazyLock;

use divan::Bencher;
use divan::counter::ItemsCount;
use tautline::engine::{Cpu, Engine, Funnel, Gpu, Job, Note, Reference};
use tautline::example::{Walker, floor_plan, walks};
use tautline::gpu::{AdapterChoice, Device};
use tautline::scene::Model;
use tautline::trace::{SettledTrace, Trace, settle};

fn main() {
    divan::main();
}

static MODEL: LazyLock<Arc<Model>> =
    LazyLock::new(|| Arc::new(Model::new(floor_plan(), None).expect("the plan has an anchor")));
static TRACES: LazyLock<Vec<Trace>> = LazyLock::new(|| walks(&MODEL, Walker { step: 0.25, steps: 500, seed: 1 }, 1000));
static SETTLED: LazyLock<Vec<SettledTrace>> = LazyLock::new(|| TRACES.iter().map(|t| settle(&MODEL, t)).collect());

/// Times `engine` over the first `traces` traces; the rate is in trace-steps.
fn time(bencher: Bencher<'_, '_>, engine: &mut dyn Engine, traces: usize) {
    let batch = &SETTLED[..traces];
    let steps: usize = batch.iter().map(SettledTrace::steps).sum();
    bencher.counter(ItemsCount::new(steps)).bench_local(|| engine.evaluate(batch, &Job::new()).expect("it runs"));
}

#[divan::bench(sample_count = 10)]
fn reference(bencher: Bencher<'_, '_>) {
    time(bencher, &mut Reference::new(MODEL.clone()), 20);
}

#[divan::bench(sample_count = 10)]
fn note(bencher: Bencher<'_, '_>) {
    time(bencher, &mut Note::new(MODEL.clone()), 20);
}

#[divan::bench(sample_count = 10)]
fn funnel(bencher: Bencher<'_, '_>) {
    time(bencher, &mut Funnel::new(MODEL.clone()), 200);
}

#[divan::bench(sample_count = 10)]
fn cpu(bencher: Bencher<'_, '_>) {
    time(bencher, &mut Cpu::new(MODEL.clone()), 1000);
}

/// On the best adapter that there is.
#[divan::bench(sample_count = 10)]
fn gpu(bencher: Bencher<'_, '_>) {
    let device = Device::open(&AdapterChoice::Best).expect("an adapter");
    time(bencher, &mut Gpu::new(device, MODEL.clone()).expect("a pass"), 1000);
}

/// Checking traces against the walls and settling touches.
#[divan::bench(sample_count = 10)]
fn settling(bencher: Bencher<'_, '_>) {
    let steps: usize = SETTLED[..200].iter().map(SettledTrace::steps).sum();
    bencher
        .counter(ItemsCount::new(steps))
        .bench_local(|| TRACES[..200].iter().map(|t| settle(&MODEL, t)).collect::<Vec<_>>());
}
