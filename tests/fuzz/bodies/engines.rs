//! Any scene and any traces: all engines give the reference's ropes.

use std::sync::Arc;
use std::sync::LazyLock;
use std::{iter, slice};

use tautline::candidates::{LISTS_BUDGET, Lists};
use tautline::engine::{Cpu, Engine, EngineError, FastGpu, Funnel, Gpu, Job, Reference};
use tautline::gpu::{AdapterChoice, Device, SWEEP_WGSL};
use tautline::rope::{TraceRecord, replay};
use tautline::scene::Model;
use tautline::simplify::simplify;
use tautline::trace::SettledTrace;

use super::recipe::recipe;

/// `cpu`, as it is and with other windows and lists, and `funnel` against `reference`; then coarser traces.
pub(super) fn cpu(input: &[u8]) {
    let Some((model, traces)) = recipe(input) else { return };
    let truth = agree(&model, &traces);
    let others = [
        Cpu::new(model.clone()).window(1),
        Cpu::new(model.clone()).keep_all(),
        Cpu::with_lists(Lists::new(model.clone()).after(0)),
        Cpu::with_lists(Lists::new(model.clone()).after(0)).window(3),
    ];
    for mut other in others {
        assert_eq!(run(&mut other, &traces), truth);
    }
    for (trace, record) in traces.iter().zip(&truth) {
        is_sound(&model, trace, record);
        if trace.violation().is_none() {
            match Funnel::new(model.clone()).evaluate(slice::from_ref(trace), &Job::new()) {
                Ok(ropes) => assert_eq!(without_events(&ropes[0]), without_events(record)),
                Err(EngineError::Unfit { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }
    coarser(&model, &traces, input.len());
}

/// The same traces on coarser terms, among the walls as they are and simplified: `cpu` against `reference`. How coarse, the input's
/// length says.
fn coarser(model: &Arc<Model>, traces: &[SettledTrace], length: usize) {
    let (low, high) = model.bounds();
    let tolerance = (high - low).max_element() * 2f64.powi(-(length as i32 % 24));
    let simple = simplify(model.scene(), &[model.anchor()], tolerance).ok();
    let simple =
        simple.map(|scene| Arc::new(Model::new(scene, Some(model.anchor())).unwrap_or_else(|e| panic!("{e}"))));
    for used in iter::once(model).chain(&simple) {
        let coarse: Vec<_> = traces.iter().map(|trace| trace.clone().coarsened(used, 1 + length % 5)).collect();
        let records = agree(used, &coarse);
        coarse.iter().zip(&records).for_each(|(trace, record)| is_sound(used, trace, record));
    }
}

/// `gpu` against `reference`, and whether the records of the fast one are sound.
pub(super) fn gpu(input: &[u8]) {
    static DEVICE: LazyLock<Device> =
        LazyLock::new(|| Device::open(&AdapterChoice::Software).unwrap_or_else(|e| panic!("{e}")));
    let Some((model, traces)) = recipe(input) else { return };
    let truth = run(&mut Reference::new(model.clone()), &traces);
    let lists = Lists::new(model.clone()).after(0);
    let gpu = Gpu::with(DEVICE.clone(), lists, LISTS_BUDGET, DEVICE.tuning(), SWEEP_WGSL);
    let mut gpu = gpu.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(run(&mut gpu, &traces), truth);
    assert_eq!(run(&mut gpu.keep_all().window(2), &traces), truth);
    let mut fast = FastGpu::new(DEVICE.clone(), model.clone()).unwrap_or_else(|e| panic!("{e}"));
    let records = run(&mut fast, &traces);
    traces.iter().zip(&records).for_each(|(trace, record)| is_sound(&model, trace, record));
}

/// The reference's records, which those of `cpu` must be.
pub(super) fn agree(model: &Arc<Model>, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    let truth = run(&mut Reference::new(model.clone()), traces);
    assert_eq!(run(&mut Cpu::new(model.clone()), traces), truth);
    truth
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap_or_else(|e| panic!("{e}"))
}

/// All but the events: `funnel` knows no contacts that are passed straight.
fn without_events(record: &TraceRecord) -> TraceRecord {
    TraceRecord { events: Vec::new(), ..record.clone() }
}

/// Every number is finite, and the numbers, the rope and the events of a record say the same.
pub(crate) fn is_sound(model: &Model, trace: &SettledTrace, record: &TraceRecord) {
    assert_eq!((record.trace, record.steps), (trace.id(), trace.steps() as u64));
    assert!(record.length.is_finite() && record.max_length.is_finite());
    assert!(record.max_length >= record.length && record.max_depth >= record.depth);
    assert_eq!(record.depth as usize, record.wraps.len());
    assert!(record.pull.is_none_or(|pull| (pull.length() - 1.0).abs() < 1e-9));
    assert!(record.events.is_sorted_by_key(|event| event.step));
    assert!(record.events.iter().all(|event| event.step as u64 <= record.steps));
    let end = *trace.points().last().unwrap();
    let steps = record.steps as usize;
    replay(model.anchor(), model.vertices(), steps + 1, &record.events, |k, rope| {
        if k == steps {
            let wraps: Vec<_> = rope.taut(end).iter().map(|c| (c.at, c.side)).collect();
            assert_eq!(wraps, record.wraps);
            assert_eq!(rope.length(end), record.length);
        }
    });
}
