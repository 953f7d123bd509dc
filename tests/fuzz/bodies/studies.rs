//! Readers of what belongs to a study: its file, its state, and the rows of its traces.

use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex};

use tautline::engine::{Cpu, Engine, Job};
use tautline::output::merge_results;
use tautline::scene::Scene;
use tautline::study::{AnchorPlan, Plan, Shard, State, Study, WalkPlan, run};

/// Reads `input` as a study's file, or, where it begins with a brace, as a plan that a study's folder remembers; what
/// is taken and small is run.
pub(super) fn read(input: &[u8], folder: &Path) {
    let plan = if input.starts_with(b"{") {
        serde_json::from_slice::<Plan>(input).ok().and_then(|plan| plan.checked().ok())
    } else {
        fs::write(folder.join("study.toml"), input).expect("the folder can be written to");
        Plan::read(&folder.join("study.toml")).ok()
    };
    let Some(plan) = plan else { return };
    let text = serde_json::to_string(&plan).expect("a plan can be written");
    let again: Plan = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(serde_json::to_string(&again).unwrap(), text);
    if is_small(&plan)
        && let Ok(study) = Study::open(plan, folder)
    {
        let state = complete(&study);
        let path = folder.join("own.bin");
        state.save(&path).expect("a state can be saved");
        let again = State::load(&path, &study).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(again.summary(&study), state.summary(&study));
    }
}

/// Whether a study is done in some milliseconds, and reads no files.
fn is_small(plan: &Plan) -> bool {
    let steps = plan.walk.steps().map_or(u64::MAX, |steps| plan.run.count().saturating_mul(steps.into()));
    let anchors = match &plan.scene.anchor {
        Some(AnchorPlan::Several(anchors)) => anchors.len(),
        Some(AnchorPlan::Sampled(sampled)) => sampled.sample as usize,
        _ => 1,
    };
    let scene = plan.scene.built_in.as_deref();
    let is_given = matches!(plan.walk, WalkPlan::Given { .. });
    // A dozen walls at the most, or the rooms.
    let is_small_scene = scene.is_some_and(|name| name == "rooms" || name.len() < 10);
    steps <= 2000 && anchors <= 4 && is_small_scene && !is_given && plan.tallies.limits.len() <= 100
}

fn complete(study: &Study) -> State {
    let mut engines: Vec<Box<dyn Engine>> =
        study.models().iter().map(|model| Box::new(Cpu::new(model.clone())) as _).collect();
    let state = Mutex::new(State::new(study, Shard::WHOLE));
    let done = run::<Infallible>(study, &mut engines, &state, &Job::new(), |_, _, _| Ok(()));
    done.unwrap_or_else(|e| panic!("{e}"));
    state.into_inner().expect("nobody panicked")
}

/// Loads `input` as a state: as it is, and with a header and a check sum that fit.
pub(super) fn load(input: &[u8], folder: &Path) {
    static STUDY: LazyLock<(Study, Vec<u8>)> = LazyLock::new(|| {
        let text =
            "[scene]\nbuilt_in = \"random-9\"\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 9\n[run]\ntraces = 9";
        let study = Study::open(Plan::parse(text).expect("a plan"), Path::new("")).expect("a study");
        let file = tempfile::NamedTempFile::new().expect("a file");
        complete(&study).save(file.path()).expect("it can be saved");
        let bytes = fs::read(file.path()).expect("it is there");
        let magic = 1 + bytes.iter().position(|&b| b == b'\n').expect("the header is a line");
        (study, bytes[..magic].to_vec())
    });
    let (study, magic) = &*STUDY;
    let path = folder.join("state.bin");
    let forged = [magic.as_slice(), blake3::hash(input).as_bytes(), input].concat();
    for bytes in [input, &forged] {
        fs::write(&path, bytes).expect("the folder can be written to");
        if let Ok(state) = State::load(&path, study)
            && let Ok(whole) = tautline::study::merge(study, std::slice::from_ref(&path), false, |_| {
                Ok::<_, tautline::study::StateError>(state.clone())
            })
        {
            whole.save(&path).expect("it can be saved");
            State::load(&path, study).unwrap_or_else(|e| panic!("{e}"));
        }
    }
}

/// Merges the rows of a file: the first byte says how many they are to be, the others are the file.
pub(super) fn merge(input: &[u8], folder: &Path) {
    let Some((&rows, bytes)) = input.split_first() else { return };
    let [from, to, again] = ["from", "to", "again"].map(|name| folder.join(name).with_extension("parquet"));
    fs::write(&from, bytes).expect("the folder can be written to");
    let no_walls = Scene::new([]).expect("it has no walls");
    let merge = |from: &PathBuf, to: &PathBuf| {
        merge_results(&[(from.clone(), u64::MAX)], to, &no_walls, &[], rows.into(), false)
    };
    match merge(&from, &to) {
        Ok(()) => {
            merge(&to, &again).unwrap_or_else(|e| panic!("{e}"));
            assert!(fs::read(&to).expect("it is there") == fs::read(&again).expect("it is there"));
        }
        Err(error) => assert!(error.to_string().contains(folder.to_str().unwrap()), "{error} names no file"),
    }
}
