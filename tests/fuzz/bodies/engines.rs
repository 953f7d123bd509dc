//! Any scene and any traces: all engines of the table give what they promise.

use std::iter;
use std::sync::{Arc, LazyLock};

use tautline::candidates::{LISTS_BUDGET, Lists};
use tautline::engine::{
    Cpu, ENGINES, Engine, EngineError, EngineKind, GpuWindows, Job, Options, Precision, Promise, Reference,
};
use tautline::gpu::{AdapterChoice, Device, SWEEP_WGSL};
use tautline::rope::{Side, TraceRecord, replay};
use tautline::scene::Model;
use tautline::simplify::simplify;
use tautline::trace::SettledTrace;

use super::recipe::recipe;

/// All engines that need no device, and `cpu` with other windows and lists; then coarser traces.
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
    traces.iter().zip(&truth).for_each(|(trace, record)| is_sound(&model, trace, record));
    coarser(&model, &traces, input.len());
}

/// The same traces on coarser terms, among the walls as they are and simplified. How coarse, the input's length says.
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

/// All engines that need a device, in every precision, and `gpu` where it asks about every pivot.
pub(super) fn gpu(input: &[u8]) {
    static DEVICE: LazyLock<Device> =
        LazyLock::new(|| Device::open(&AdapterChoice::Software).unwrap_or_else(|e| panic!("{e}")));
    let Some((model, traces)) = recipe(input) else { return };
    let truth = run(&mut Reference::new(model.clone()), &traces);
    let lists = Lists::new(model.clone()).after(0);
    let gpu = GpuWindows::with(DEVICE.clone(), lists, LISTS_BUDGET, DEVICE.tuning(), SWEEP_WGSL);
    let mut gpu = gpu.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(run(&mut gpu, &traces), truth);
    assert_eq!(run(&mut gpu.window(2), &traces), truth);
    for kind in ENGINES.into_iter().filter(|kind| kind.needs_gpu()) {
        for &precision in kind.precisions {
            keeps_promise(kind, Some(DEVICE.clone()), precision, (&model, &traces), &truth);
        }
    }
}

/// The reference's records, with which those of all engines that need no device agree as they promise.
pub(super) fn agree(model: &Arc<Model>, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    let truth = run(&mut Reference::new(model.clone()), traces);
    for kind in ENGINES.into_iter().filter(|kind| !kind.needs_gpu()) {
        keeps_promise(kind, None, Precision::default(), (model, traces), &truth);
    }
    truth
}

/// Fails unless an engine gives what it promises, or does not take the scene.
fn keeps_promise(
    kind: &'static EngineKind,
    device: Option<Device>,
    precision: Precision,
    (model, traces): (&Arc<Model>, &[SettledTrace]),
    truth: &[TraceRecord],
) {
    let options = Options { precision, ..Options::default() };
    let opened = kind.open(model.clone(), device, &options);
    let found = opened.and_then(|mut opened| opened.engine.evaluate(traces, &Job::new()));
    match found {
        Ok(found) => {
            assert_eq!(found.len(), traces.len());
            for ((trace, truth), found) in traces.iter().zip(truth).zip(&found) {
                is_as_promised(kind.promise(precision), model, trace, truth, found);
            }
        }
        Err(EngineError::Unfit { .. }) => {}
        Err(error) => panic!("{}: {error}", kind.name),
    }
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap_or_else(|e| panic!("{e}"))
}

/// All but the events: `funnel` knows no contacts that are passed straight.
fn without_events(record: &TraceRecord) -> TraceRecord {
    TraceRecord { events: Vec::new(), ..record.clone() }
}

/// Fails unless a record is what its engine promises, given the reference's. Of traces that break the rules, only those
/// that promise events promise anything.
pub(crate) fn is_as_promised(
    promise: Promise,
    model: &Model,
    trace: &SettledTrace,
    truth: &TraceRecord,
    found: &TraceRecord,
) {
    match promise {
        Promise::Events => assert_eq!(found, truth),
        Promise::Ropes if trace.breaks_rules() => {}
        Promise::Ropes => {
            assert_eq!(ropes(model, trace, found), ropes(model, trace, truth));
            assert_eq!(without_events(found), without_events(truth));
        }
        Promise::Nothing => is_sound(model, trace, found),
    }
}

/// The taut rope after every step.
fn ropes(model: &Model, trace: &SettledTrace, record: &TraceRecord) -> Vec<Vec<(u32, Side)>> {
    let ends = trace.ends();
    let mut ropes = Vec::with_capacity(ends.len());
    replay(model.anchor(), model.vertices(), ends.len(), &record.events, |k, rope| {
        ropes.push(rope.taut(ends[k]).iter().map(|c| (c.vertex, c.side)).collect());
    });
    ropes
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
