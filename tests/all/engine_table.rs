//! Every engine of the table, in every precision and with every option that it takes, on the same properties. What it
//! must give is what the table says it promises, so an engine is tested by being listed. What only one engine has, its
//! own tests look at.

use std::fmt;
use std::sync::{Arc, OnceLock};
use std::thread;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};
use tautline::engine::{
    CPU, ENGINES, Engine, EngineError, EngineKind, Job, Options, Precision, Promise, REFERENCE, Reference, RunsOn, Why,
    open_best,
};
use tautline::example::{Walker, floor_plan, random_walls, settled_walks};
use tautline::gpu::Device;
use tautline::rope::TraceRecord;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::corpus::bodies::engines::is_as_promised;
use crate::scenes::{KINDS, recipe};
use crate::support::{cases, software};

/// An engine of the table, with options that it takes.
pub(crate) struct Subject {
    pub(crate) kind: &'static EngineKind,
    pub(crate) options: Options,
}

impl Subject {
    /// All of them, those with the usual options first.
    pub(crate) fn all() -> Vec<Subject> {
        let usual = Options::default();
        let mut all = Subject::of_each(usual);
        for window in [1, 3] {
            let narrow = Subject::of_each(Options { window, ..usual });
            all.extend(narrow.into_iter().filter(|subject| subject.kind.asks));
        }
        all
    }

    /// Every engine in every precision that it takes, with the usual options besides.
    pub(crate) fn usual() -> Vec<Subject> {
        Subject::of_each(Options::default())
    }

    fn of_each(options: Options) -> Vec<Subject> {
        let precisions = [Precision::Certified, Precision::Fast];
        let taken = |kind: &'static EngineKind| precisions.into_iter().filter(|&precision| kind.takes(precision));
        let subject = |kind, precision| Subject { kind, options: Options { precision, ..options } };
        ENGINES.into_iter().flat_map(|kind| taken(kind).map(move |precision| subject(kind, precision))).collect()
    }

    pub(crate) fn open(&self, model: &Arc<Model>) -> Box<dyn Engine> {
        static DEVICE: OnceLock<Device> = OnceLock::new();
        let device = self.kind.needs_gpu().then(|| DEVICE.get_or_init(software).clone());
        self.kind.open(model.clone(), device, &self.options).unwrap_or_else(|e| panic!("{self}: {e}")).engine
    }

    pub(crate) fn promise(&self) -> Promise {
        self.kind.promise(self.options.precision)
    }

    /// The records of `traces` by an engine made anew.
    pub(crate) fn run(&self, model: &Arc<Model>, traces: &[SettledTrace]) -> Vec<TraceRecord> {
        run(&mut *self.open(model), traces)
    }

    /// Fails, and says on which engine, if `found` is not what it promises.
    pub(crate) fn check(&self, model: &Model, traces: &[SettledTrace], truth: &[TraceRecord], found: &[TraceRecord]) {
        let _told = Told(self);
        assert_eq!(found.len(), traces.len());
        for ((trace, truth), found) in traces.iter().zip(truth).zip(found) {
            is_as_promised(self.promise(), model, trace, truth, found);
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Options { precision, window, .. } = self.options;
        write!(f, "{} {}, window {window}", self.kind.name, precision.name())
    }
}

/// Says on which engine a test failed.
struct Told<'a>(&'a Subject);

impl Drop for Told<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            eprintln!("that was {}", self.0);
        }
    }
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

/// The floor plan and walks in it, in which something happens.
fn example(steps: usize, count: u64) -> (Arc<Model>, Vec<SettledTrace>, Vec<TraceRecord>) {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.3, steps, seed: 9 }, count);
    let truth = run(&mut Reference::new(model.clone()), &traces);
    assert!(truth.iter().any(|record| record.events.len() > 4), "nothing happened to compare");
    (model, traces, truth)
}

#[test]
fn the_table_tells_engines_apart_and_engines_are_as_it_says() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    assert!(ENGINES.contains(&&REFERENCE) && REFERENCE.promise(Precision::Certified) == Promise::Events);
    for (number, kind) in ENGINES.into_iter().enumerate() {
        assert_eq!(EngineKind::named(kind.name), Some(kind));
        assert!(ENGINES[..number].iter().all(|other| other != &kind && other.name != kind.name), "{}", kind.name);
        assert!(!kind.about.is_empty() && !kind.about.contains('\n') && !kind.about.ends_with('.'), "{}", kind.name);
        assert_eq!(kind.precisions.is_empty(), kind.promise(Precision::Certified) == Promise::Nothing, "{}", kind.name);
        if kind.needs_gpu() {
            let error = kind.open(model.clone(), None, &Options::default()).err();
            assert!(matches!(error, Some(EngineError::NoDevice { engine }) if engine == kind.name));
        } else if !kind.takes(Precision::Fast) {
            let fast = Options { precision: Precision::Fast, ..Options::default() };
            let error = kind.open(model.clone(), None, &fast).err().unwrap();
            assert_eq!(error.to_string(), format!("the engine {} has no precision fast", kind.name));
        }
    }
    for subject in Subject::all() {
        let engine = subject.open(&model);
        let precision = (!subject.kind.precisions.is_empty()).then_some(subject.options.precision);
        assert_eq!((engine.name(), engine.precision()), (subject.kind.name, precision), "{subject}");
        assert!(engine.batch() > 0, "{subject}");
    }
}

#[test]
fn what_suits_the_machine_says_what_it_is_and_why() {
    let (model, traces, truth) = example(60, 6);
    let mut opened = open_best(model, &Options::default()).unwrap();
    assert_eq!(run(&mut *opened.engine, &traces), truth);
    match (&opened.why, &opened.on) {
        (Why::RealGpu, RunsOn::Device(device)) => assert!(device.summary().kind.is_real()),
        (Why::NoRealGpu(error), RunsOn::Threads(threads)) => {
            assert!(!error.to_string().is_empty() && opened.kind == &CPU);
            assert_eq!(opened.on.to_string(), format!("{threads} threads"));
        }
        (why, on) => panic!("{why:?} on {on}"),
    }
}

/// Every rope of the golden cases is known from elsewhere.
#[test]
fn golden_ropes() {
    for subject in Subject::usual() {
        let mut judged = 0;
        for case in cases() {
            let model = case.model();
            let traces = case.settled(&model);
            assert!(traces.iter().all(|trace| trace.violation().is_none()), "{}", case.name);
            let records = subject.run(&model, &traces);
            if subject.promise() == Promise::Nothing {
                subject.check(&model, &traces, &records, &records);
                continue;
            }
            let (count, wrong) = case.differences(&model, &records);
            judged += count;
            let shown = wrong[..wrong.len().min(20)].join("\n");
            assert!(wrong.is_empty(), "{subject}: {} of {count} ropes differ:\n{shown}", wrong.len());
        }
        assert!(judged > 15_000 || subject.promise() == Promise::Nothing, "{subject}: only {judged} ropes were judged");
    }
}

/// Lawful traces, and others that cross walls at will, in random scenes of every kind.
fn on_random_scenes(cases: u32, subjects: &[Subject]) {
    let default = ProptestConfig::default();
    // PROPTEST_CASES=2560 runs ten times as many.
    let cases = cases * default.cases / 256;
    for kind in KINDS {
        for touching in [false, true] {
            let config = ProptestConfig { cases, failure_persistence: None, ..default.clone() };
            let result = TestRunner::new(config).run(&recipe(kind, touching), |recipe| {
                let model = recipe.model();
                let traces = [recipe.trace(&model, 0), recipe.lawless_trace(&model, 1)].map(|t| settle(&model, &t));
                let truth = run(&mut Reference::new(model.clone()), &traces);
                for subject in subjects {
                    subject.check(&model, &traces, &truth, &subject.run(&model, &traces));
                }
                Ok(())
            });
            if let Err(TestError::Fail(why, recipe)) = &result {
                panic!("{kind:?}, touching {touching}: {why}\n{recipe:?}");
            }
            result.unwrap();
        }
    }
}

#[test]
fn random_scenes_without_a_device() {
    let subjects: Vec<_> = Subject::all().into_iter().filter(|subject| !subject.kind.needs_gpu()).collect();
    on_random_scenes(300, &subjects);
}

#[test]
fn random_scenes_on_a_device() {
    let subjects: Vec<_> = Subject::all().into_iter().filter(|subject| subject.kind.needs_gpu()).collect();
    on_random_scenes(10, &subjects);
}

#[test]
fn windows_of_any_bound_change_nothing() {
    let (model, traces, truth) = example(200, 8);
    for subject in Subject::usual().into_iter().filter(|subject| subject.kind.asks) {
        for window in [1, 2, 5, 64, 1000] {
            let subject = Subject { options: Options { window, ..subject.options }, ..subject };
            subject.check(&model, &traces, &truth, &subject.run(&model, &traces));
        }
    }
}

/// Neither on the other traces, nor their order, nor the threads, nor what the engine did before; and records come in
/// the order of the traces.
#[test]
fn no_trace_depends_on_the_others() {
    let walls = Arc::new(Model::new(random_walls(200, 4), None).unwrap());
    let dense = settled_walks(&walls, Walker { step: 0.03, steps: 120, seed: 9 }, 20);
    let (plan, walks, _) = example(120, 20);
    let pools = [1, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    for (model, traces) in [(walls, dense), (plan, walks)] {
        let backwards: Vec<_> = traces.iter().rev().cloned().collect();
        for subject in Subject::all() {
            let mut engine = subject.open(&model);
            let alone: Vec<_> = traces.iter().map(|t| run(&mut *engine, std::slice::from_ref(t)).remove(0)).collect();
            assert!(alone.iter().any(|record| record.events.len() > 4), "{subject}: nothing happened to compare");
            assert!(alone.iter().zip(&traces).all(|(record, trace)| record.trace == trace.id()), "{subject}");
            assert!(run(&mut *engine, &traces) == alone, "{subject}: together");
            let fresh = pools.iter().all(|pool| pool.install(|| subject.run(&model, &traces)) == alone);
            assert!(fresh, "{subject}: on other threads");
            let records = run(&mut *engine, &[&backwards[..], &backwards[..3]].concat());
            let again = alone.iter().rev().chain(alone.iter().rev().take(3));
            assert!(records.iter().eq(again), "{subject}: backwards, and some again");
        }
    }
}

#[test]
fn forgetting_changes_nothing_but_what_is_known() {
    let (model, traces, truth) = example(60, 6);
    let all = model.vertices().len();
    for subject in Subject::all() {
        let mut engine = subject.open(&model);
        // Those that ask nothing try none, or all in every step.
        let told = engine.remaining().filter(|_| !subject.kind.asks).map(|_| all);
        assert_eq!(engine.remaining(), told, "{subject}");
        let first = run(&mut *engine, &traces);
        subject.check(&model, &traces, &truth, &first);
        let most = if told.is_some() { all } else { all - 1 };
        assert_eq!(engine.remaining().is_some(), subject.kind.asks || told.is_some(), "{subject}");
        assert!(engine.remaining().is_none_or(|tried| tried > 0 && tried <= most), "{subject}");
        engine.forget();
        assert_eq!(engine.remaining(), told, "{subject}, forgotten");
        assert!(run(&mut *engine, &traces) == first, "{subject}, forgotten");
    }
}

#[test]
fn a_stopped_job_ends_early_and_one_that_is_not_counts_all_steps() {
    let (model, traces, _) = example(400, 4);
    for subject in Subject::all() {
        let mut engine = subject.open(&model);
        let job = Job::new();
        job.stop();
        assert!(matches!(engine.evaluate(&traces, &job), Err(EngineError::Stopped)), "{subject}");
        assert_eq!(job.steps(), 0, "{subject}");
        let job = Job::new();
        engine.evaluate(&traces, &job).unwrap();
        assert_eq!(job.steps(), 1600, "{subject}");
    }
}

#[test]
fn empty_batches_and_traces_of_length_one() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let anchor = model.anchor();
    let off = anchor + DVec2::new(0.5, 0.1);
    let traces = [(0, anchor), (4, off), (9, anchor)].map(|(id, at)| settle(&model, &Trace { id, points: vec![at] }));
    for subject in Subject::all() {
        let mut engine = subject.open(&model);
        assert_eq!(run(&mut *engine, &[]), [], "{subject}");
        let found = run(&mut *engine, &traces);
        let said: Vec<_> = found.iter().map(|r| (r.trace, r.steps, r.depth, r.length)).collect();
        assert_eq!(said, [(0, 0, 0, 0.0), (4, 0, 0, anchor.distance(off)), (9, 0, 0, 0.0)], "{subject}");
    }
}

#[test]
fn a_scene_without_walls() {
    let model = Arc::new(Model::new(Scene::default(), Some(DVec2::new(1.0, 2.0))).unwrap());
    let points = vec![DVec2::new(4.0, 6.0), DVec2::new(1.0, 3.0)];
    let still = Trace { id: 1, points: vec![model.anchor()] };
    let traces = [Trace { id: 0, points }, still].map(|trace| settle(&model, &trace));
    for subject in Subject::all() {
        let [r, still] = subject.run(&model, &traces).try_into().unwrap();
        assert_eq!((r.length, r.max_length, r.depth, r.pull), (1.0, 5.0, 0, Some(-DVec2::Y)), "{subject}");
        assert_eq!((still.length, still.max_length, still.pull), (0.0, 0.0, None), "{subject}");
    }
}

/// An engine owns what it needs: it goes where its owner goes, and the model may be dropped.
#[test]
fn engines_go_to_other_threads_with_their_models() {
    let (model, traces, truth) = example(60, 6);
    for subject in Subject::usual() {
        let again = Arc::new(Model::new(model.scene().clone(), Some(model.anchor())).unwrap());
        let mut engine = subject.open(&again);
        drop(again);
        let there = traces.clone();
        let found = thread::spawn(move || run(&mut *engine, &there)).join().unwrap();
        subject.check(&model, &traces, &truth, &found);
    }
}
