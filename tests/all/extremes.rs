//! Extreme cases on every engine. Those that promise right ropes must all give the same events, and the two methods the
//! same ropes, after every step; `fast` and `note` must come to an end with records that are sound in themselves.

use std::sync::Arc;
use std::sync::OnceLock;

use glam::DVec2;
use tautline::candidates::{Lists, Simd};
use tautline::engine::{Cpu, Engine, EngineError, FastGpu, Funnel, Gpu, Job, Promise, REFERENCE, Reference, WINDOW};
use tautline::example::{Walker, random_walls, settled_walks};
use tautline::geometry::{COORDINATE_MAX, COORDINATE_MIN, between, orient};
use tautline::gpu::Device;
use tautline::lab::astray::LONGEST_CHAIN;
use tautline::lab::extremes::{Extreme, FAMILIES};
use tautline::rope::{EventKind, TraceRecord, replay};
use tautline::scene::Model;
use tautline::trace::{SettledTrace, Trace, settle};

use crate::corpus::bodies::engines::is_sound;
use crate::engine_table::Subject;
use crate::support::{gpu_on, software};

macro_rules! families {
    ($($name:ident),*) => {
        $(#[test]
        fn $name() {
            check(stringify!($name));
        })*

        #[test]
        fn all_families_are_tried() {
            assert_eq!(FAMILIES.map(|family| family.name), [$(stringify!($name)),*]);
        }
    };
}

families!(
    scales,
    offsets,
    near_lines,
    needles,
    lattices,
    rays,
    touching,
    anchors,
    steps,
    windings,
    long_and_many,
    sizes,
    piles,
    degenerate
);

fn device() -> Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(software).clone()
}

fn cases(family: &str) -> Vec<Extreme> {
    FAMILIES.iter().find(|f| f.name == family).unwrap().cases()
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

fn settled(model: &Model, case: &Extreme) -> Vec<SettledTrace> {
    case.traces.iter().map(|trace| settle(model, trace)).collect()
}

fn check(family: &str) {
    let mut wrong = Vec::new();
    for case in cases(family) {
        // Seen only if an engine panics.
        println!("{family}, {}", case.name);
        wrong.extend(complaints(&case).into_iter().map(|what| format!("{}: {what}", case.name)));
    }
    assert!(wrong.is_empty(), "{} times wrong in {family}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Which engines are wrong, and where first.
fn complaints(case: &Extreme) -> Vec<String> {
    let model = case.model();
    let traces = settled(&model, case);
    for trace in &traces {
        assert_eq!(trace.violation(), None, "{}", case.name);
    }
    let truth = run(&mut Reference::new(model.clone()), &traces);
    let mut wrong: Vec<String> = Vec::from_iter(left_out(&model, &truth));
    let mut compare = |name: &str, engine: &mut dyn Engine| {
        wrong.extend(difference(&truth, &run(engine, &traces)).map(|what| format!("{name}, {what}")));
    };
    // What has very many steps is evaluated once by each engine, and what a device would take minutes for, by the
    // others.
    let is_short = traces.iter().map(SettledTrace::steps).sum::<usize>() <= 100_000;
    let suits_devices = truth.iter().all(|record| record.events.len() <= LONGEST_CHAIN);
    if is_short {
        compare("cpu, lists at once", &mut Cpu::with_lists(Lists::new(model.clone()).after(0)));
        compare("cpu, baseline", &mut Cpu::new(model.clone()).simd(Simd::baseline()));
    }
    if suits_devices {
        compare("gpu, lists at once", &mut gpu_on(device(), Lists::new(model.clone()).after(0)));
    }
    for subject in Subject::all().iter().filter(|subject| subject.kind != &REFERENCE) {
        let is_usual = subject.options.window == WINDOW;
        // Rounds of few legs each take devices too long.
        let suits = !subject.kind.needs_gpu() || suits_devices && is_usual;
        if !suits || !is_usual && !is_short {
            continue;
        }
        match (subject.open(&model).evaluate(&traces, &Job::new()), subject.promise()) {
            (Ok(found), Promise::Events) => {
                wrong.extend(difference(&truth, &found).map(|what| format!("{subject}, {what}")))
            }
            (Ok(found), Promise::Ropes) => {
                wrong.extend(other_ropes(&model, case, &truth, &found).map(|what| format!("{subject}, {what}")))
            }
            (Ok(found), Promise::Nothing) => subject.check(&model, &traces, &truth, &found),
            (Err(EngineError::Unfit { why, .. }), Promise::Ropes) if spans_too_much(case) => {
                assert!(why.to_string().contains("triangulation"))
            }
            (Err(error), _) => wrong.push(format!("{subject}: {error}")),
        }
    }
    if let Ok(found) = Funnel::new(model.clone()).final_only().evaluate(&traces, &Job::new()) {
        wrong.extend(other_end(&truth, &found));
    }
    wrong
}

/// Whether coordinates span more orders of magnitude than a triangulation takes.
fn spans_too_much(case: &Extreme) -> bool {
    let points = case.walls.iter().flatten().chain(case.traces.iter().flat_map(|trace| &trace.points));
    let sizes = points.flat_map(|p| p.to_array()).map(f64::abs).filter(|&size| size > 0.0);
    let (low, high) = sizes.fold((f64::INFINITY, 0.0f64), |(low, high), size| (low.min(size), high.max(size)));
    high / low > 2f64.powi(130)
}

/// Where the first record differs, in few words: records may hold 100,000s of events.
fn difference(truth: &[TraceRecord], found: &[TraceRecord]) -> Option<String> {
    assert_eq!(truth.len(), found.len());
    let (truth, found) = truth.iter().zip(found).find(|(truth, found)| truth != found)?;
    let first = truth.events.iter().zip(&found.events).position(|(a, b)| a != b);
    let event = first.unwrap_or(truth.events.len().min(found.events.len()));
    let [right, wrong] = [truth, found].map(|r| (r.length, r.max_length, r.depth, r.max_depth, r.events.get(event)));
    Some(format!("trace {}, event {event}: {wrong:?} instead of {right:?}", truth.trace))
}

/// Whether the rope wraps round a vertex and not round a nearer one on the same line. Its taut rope would not show
/// that.
fn left_out(model: &Model, truth: &[TraceRecord]) -> Option<String> {
    let at = |vertex: u32| model.vertices()[vertex as usize];
    for record in truth.iter().filter(|record| record.events.len() * model.vertices().len() <= 1 << 23) {
        let mut contacts = Vec::new();
        for event in &record.events {
            if event.kind == EventKind::Unwrap {
                contacts.pop();
                continue;
            }
            let (pivot, to) = (contacts.last().map_or(model.anchor(), |&vertex| at(vertex)), at(event.vertex));
            let is_nearer = |&p: &DVec2| orient(pivot, to, p) == 0.0 && between(pivot, to, p);
            if let Some(nearer) = model.vertices().iter().copied().find(is_nearer) {
                let (trace, step) = (record.trace, event.step);
                return Some(format!("reference, trace {trace}, step {step}: wraps round {to} and not {nearer}"));
            }
            contacts.push(event.vertex);
        }
    }
    None
}

/// Whether the funnel has another taut rope after some step. Of very deep ropes only the length, bit for bit, and the
/// depth are compared after each step, and all of the last.
fn other_ropes(model: &Arc<Model>, case: &Extreme, truth: &[TraceRecord], found: &[TraceRecord]) -> Option<String> {
    for ((trace, truth), found) in case.traces.iter().zip(truth).zip(found) {
        let whole = trace.points.len() * truth.max_depth as usize <= 1 << 21;
        let [right, wrong] = [truth, found].map(|record| {
            let mut ropes = Vec::with_capacity(trace.points.len());
            replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |k, rope| {
                let a = trace.points[k];
                let taut = if whole { rope.taut(a).iter().map(|c| (c.vertex, c.side)).collect() } else { vec![] };
                ropes.push((rope.measure(a), taut));
            });
            ropes
        });
        if let Some(step) = (0..right.len()).find(|&k| right[k] != wrong[k]) {
            return Some(format!("trace {}, step {step}: {:?} instead of {:?}", trace.id, wrong[step], right[step]));
        }
        let [right, wrong] = [truth, found].map(|record| TraceRecord { events: vec![], ..record.clone() });
        if right != wrong {
            return Some(format!("trace {}: another final rope, or another longest one", trace.id));
        }
    }
    None
}

/// Whether the funnel of final ropes only has another one.
fn other_end(truth: &[TraceRecord], found: &[TraceRecord]) -> Option<String> {
    let is_same = |(a, b): &(&TraceRecord, &TraceRecord)| {
        (a.trace, a.length, a.depth, &a.wraps, a.pull) == (b.trace, b.length, b.depth, &b.wraps, b.pull)
    };
    let other = truth.iter().zip(found).find(|pair| !is_same(pair))?;
    Some(format!(
        "funnel, final rope only, trace {}: {} instead of {} long",
        other.0.trace, other.1.length, other.0.length
    ))
}

/// More events in one trace, and more contacts on one rope, than 16 bits can number. The cases above that are as long
/// are not for devices, which answer one event of a trace a round: several traces at a time take no longer than one.
#[test]
fn long_chains_on_devices() {
    let mut case = cases("windings").into_iter().find(|case| case.name == "100000 turns round 4 corners").unwrap();
    let ways: Vec<Vec<DVec2>> = case.traces.iter().map(|trace| trace.points[..70_000].to_vec()).collect();
    let half = &ways[0][..35_000];
    let and_back = half.iter().chain(half.iter().rev()).copied().collect();
    let ways = [ways[0].clone(), and_back, ways[2].clone()];
    case.traces = (0..).zip(ways).map(|(id, points)| Trace { id, points }).collect();
    let model = case.model();
    let traces = settled(&model, &case);
    let truth = run(&mut Reference::new(model.clone()), &traces);
    assert!(truth.iter().all(|record| record.events.len() > 1 << 16), "too short");
    assert!(truth[0].depth > 1 << 16 && truth[1].depth < 10, "another shape");
    assert_eq!(difference(&truth, &run(&mut Gpu::new(device(), model.clone()).unwrap(), &traces)), None);
    let found = run(&mut FastGpu::new(device(), model.clone()).unwrap(), &traces);
    traces.iter().zip(&found).for_each(|(trace, record)| is_sound(&model, trace, record));
    // Whole numbers and halves: f32 holds them all.
    assert_eq!(difference(&truth, &found), None);
}

/// Powers of two and whole numbers are exact, so scaled and moved scenes are another truth where the funnel has none.
#[test]
fn scaling_and_moving_changes_no_event() {
    for (family, kind, least) in [("scales", "random walls", 13), ("scales", "lattice", 17), ("offsets", "lattice", 14)]
    {
        let mut first = None;
        let cases: Vec<_> = cases(family).into_iter().filter(|case| case.name.contains(kind)).collect();
        assert!(cases.len() >= least, "{} cases", cases.len());
        for case in cases {
            let model = case.model();
            let records = run(&mut Reference::new(model.clone()), &settled(&model, &case));
            let events: Vec<_> = records.into_iter().map(|record| record.events).collect();
            assert!(events.iter().map(Vec::len).sum::<usize>() > 100, "nothing happened to compare");
            assert!(events == *first.get_or_insert(events.clone()), "{}", case.name);
        }
    }
}

/// The scales go to the very ends of what is taken.
#[test]
fn the_last_magnitudes_taken_are_among_the_scales() {
    let sizes: Vec<f64> = cases("scales")
        .iter()
        .flat_map(|case| case.walls.iter().flatten().flat_map(|p| p.abs().to_array()).collect::<Vec<_>>())
        .collect();
    assert!(sizes.contains(&COORDINATE_MAX) && sizes.contains(&COORDINATE_MIN));
}

/// Too much for the reference, which looks at 200,000 vertices a step: three engines against each other.
#[test]
fn very_many_walls_and_steps() {
    let model = Arc::new(Model::new(random_walls(100_000, 8), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.002, steps: 2000, seed: 3 }, 300);
    let records = run(&mut Cpu::new(model.clone()), &traces);
    assert!(records.iter().map(|record| record.events.len()).sum::<usize>() > 10_000, "nothing happened to compare");
    assert_eq!(difference(&records, &run(&mut Gpu::new(device(), model.clone()).unwrap(), &traces)), None);
    let found = run(&mut Funnel::new(model.clone()), &traces);
    for (ours, found) in records.into_iter().zip(found) {
        assert_eq!(TraceRecord { events: vec![], ..ours }, TraceRecord { events: vec![], ..found });
    }
}
