use std::path::{Path, PathBuf};

use super::*;
use crate::engine::Cpu;
use crate::study::opened::ANSWERS;
use crate::study::random::{Purpose, Random};
use crate::study::{Plan, StateError, merge};

/// Two anchors, and blocks of 7 traces of which the last is smaller.
const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\nanchor = { sample = 2 }\n\
    [walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\nstart = \"visible\"\n\
    [run]\ntraces = 40\nblock = 7\n[tallies]\nlimits = [2.0, 9.0]\n";

fn study() -> Study {
    Study::open(Plan::parse(STUDY).unwrap(), Path::new("")).unwrap()
}

fn engines(study: &Study) -> Vec<Box<dyn Engine>> {
    study.models().iter().map(|model| Box::new(Cpu::new(model.clone())) as _).collect()
}

/// Runs a shard to its end in groups of at most `size` traces, and stops after every one of them: the state is saved,
/// and read for the next. Tells how many traces each group had that are in the state.
fn stopped_after_each(study: &Study, shard: Shard, size: u64) -> (State, Vec<TraceRecord>, Vec<usize>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.bin");
    State::new(study, shard).save(&path).unwrap();
    let (mut all, mut sizes) = (Vec::new(), Vec::new());
    loop {
        let state = Mutex::new(State::load(&path, study).unwrap());
        let before = state.lock().unwrap().place(study);
        assert_eq!(before, all.len() as u64);
        let stop = |_: &mut State, records: Vec<TraceRecord>, added: usize| {
            sizes.push(added);
            all.extend(records.into_iter().take(added));
            Err(())
        };
        let ended = in_groups(study, &mut engines(study), &state, &Job::new(), Room::between(size, size), stop);
        let state = state.into_inner().unwrap();
        if let Ok(spent) = ended {
            assert_eq!(spent, Spent::default(), "nothing was left to do");
            return (state, all, sizes);
        }
        assert!(matches!(ended, Err(RunError::Caller(()))));
        state.save(&path).unwrap();
    }
}

/// Puts parts together that have their places as names.
fn merged<'a>(study: &Study, parts: impl Iterator<Item = &'a State>, is_partial: bool) -> Result<State, StateError> {
    let parts: Vec<&State> = parts.collect();
    let paths: Vec<PathBuf> = (0..parts.len()).map(|i| PathBuf::from(i.to_string())).collect();
    let load = |path: &Path| Ok(parts[path.to_str().unwrap().parse::<usize>().unwrap()].clone());
    merge(study, &paths, is_partial, load)
}

#[test]
fn a_study_that_is_stopped_within_blocks_ends_the_same() {
    let tethered = STUDY.replace("start", "tether = 3.0\nat_tether = \"slide\"\nstart");
    for text in [STUDY, &tethered] {
        ends_the_same_if_stopped(Study::open(Plan::parse(text).unwrap(), Path::new("")).unwrap());
    }
}

fn ends_the_same_if_stopped(study: Study) {
    let (whole, records, sizes) = stopped_after_each(&study, Shard::WHOLE, 70);
    assert_eq!(sizes, [40]);
    assert!(records.iter().map(|record| record.trace).eq(0..40));
    let answer = whole.summary(&study);
    for (size, expected) in [
        (14, vec![14, 14, 12]),
        (10, vec![10, 4, 10, 4, 10, 2]),
        (3, [3, 3, 1].repeat(5).into_iter().chain([3, 2]).collect()),
        (1, vec![1; 40]),
    ] {
        let (state, again, sizes) = stopped_after_each(&study, Shard::WHOLE, size);
        assert_eq!(sizes, expected);
        assert!(state.summary(&study) == answer && again == records, "{size}");
    }
    // Shards too, and put together.
    let shards: Vec<_> = (0..3).map(|k| stopped_after_each(&study, Shard::new(k, 3).unwrap(), 4)).collect();
    assert!(merged(&study, shards.iter().map(|shard| &shard.0), false).unwrap().summary(&study) == answer);
    // The last block, of 5 traces, is the second of the shard with number 2.
    assert_eq!(
        shards[2].1.iter().map(|record| record.trace).collect::<Vec<_>>(),
        Vec::from_iter((14..21).chain(35..40))
    );
}

/// An engine that remembers how many traces it was given at once.
struct Watched(Cpu, std::sync::Arc<Mutex<Vec<usize>>>);

impl Engine for Watched {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, crate::engine::EngineError> {
        self.1.lock().unwrap().push(traces.len());
        self.0.evaluate(traces, job)
    }

    fn batch(&self) -> usize {
        8192
    }
}

#[test]
fn what_a_stop_can_lose_is_little_from_the_first_trace_on() {
    let text = STUDY.replace("anchor = { sample = 2 }", "").replace("traces = 40", "traces = 4000");
    let study = Study::open(Plan::parse(&text).unwrap(), Path::new("")).unwrap();
    let given = std::sync::Arc::<Mutex<Vec<usize>>>::default();
    let watched = Box::new(Watched(Cpu::new(study.models()[0].clone()), given.clone()));
    let state = Mutex::new(State::new(&study, Shard::WHOLE));
    let mut places = Vec::new();
    let after = |state: &mut State, _: Vec<TraceRecord>, _: usize| {
        places.push(state.place(&study));
        Ok::<(), ()>(())
    };
    run(&study, &mut [watched], &state, &Job::new(), after).unwrap();
    let given = given.lock().unwrap().clone();
    // However many the engine can take at once, the first have some 65,536 steps together, in whole blocks.
    assert_eq!(given[0], 65_536 / 61 / 7 * 7);
    // Whatever has been evaluated is in the state at once.
    let evaluated = given.iter().scan(0, |sum, &count| {
        *sum += count as u64;
        Some(*sum)
    });
    assert_eq!(places, Vec::from_iter(evaluated));
}

#[test]
fn traces_are_evaluated_again_by_their_places() {
    let study = study();
    let shard = Shard::new(1, 2).unwrap();
    let (state, records, _) = stopped_after_each(&study, shard, 70);
    assert_eq!((state.place(&study), study.places(shard)), (19, 19));
    for places in [0..19, 5..6, 6..8, 12..19, 19..19] {
        let mut again = Vec::new();
        let each = |records| {
            again.extend(records);
            Ok::<(), ()>(())
        };
        run_again(&study, &mut engines(&study), shard, places.clone(), &Job::new(), each).unwrap();
        assert!(again == records[places.start as usize..places.end as usize], "{places:?}");
    }
}

#[test]
fn a_study_ends_with_a_whole_block() {
    for until in ["seconds = 1e-9", "relative_error = 0.3"] {
        let text = STUDY.replace("traces = 40", "traces = 150") + "[until]\n" + until;
        let study = Study::open(Plan::parse(&text).unwrap(), Path::new("")).unwrap();
        let (state, records, _) = stopped_after_each(&study, Shard::WHOLE, 3);
        assert!(state.stopped() != Stopped::Unfinished && state.traces().is_multiple_of(7), "{until}");
        assert_eq!(records.len() as u64, state.traces(), "{until}");
    }
}

/// Any parts, in any order, some of them stopped on the way, some put together before: the first block with which the
/// study is certain enough ends it.
#[test]
fn parts_in_any_order_end_where_one_run_does() {
    let text = STUDY.replace("traces = 40", "traces = 250");
    for (until, expected) in [("", None), ("[until]\nrelative_error = 0.2\n", Some(Stopped::RelativeError))] {
        let study = Study::open(Plan::parse(&(text.clone() + until)).unwrap(), Path::new("")).unwrap();
        let (whole, ..) = stopped_after_each(&study, Shard::WHOLE, 70);
        assert_eq!(whole.stopped(), expected.unwrap_or(Stopped::Complete));
        let blocks = whole.blocks().count() as u64;
        assert!(expected.is_none() || (blocks > 10 && blocks < 30), "{blocks}");
        let answer = whole.summary(&study);
        let mut parts: Vec<State> = ["0/3 of blocks 0..20", "2/3 of blocks 0..20", "0/1 of blocks 20..30"]
            .into_iter()
            .chain(["1/3 of blocks 0..20", "0/2 of blocks 30..99", "1/2 of blocks 30..99"])
            .map(|part| stopped_after_each(&study, part.parse().unwrap(), 5).0)
            .collect();
        let mut random = Random::new(7, Purpose::Walk, 0);
        for _ in 0..20 {
            for i in (1..parts.len()).rev() {
                parts.swap(i, (random.unit() * (i + 1) as f64) as usize);
            }
            assert!(merged(&study, parts.iter(), false).unwrap().summary(&study) == answer);
            // Some of them first.
            let some = merged(&study, parts[..3].iter(), true).unwrap();
            let both = merged(&study, [&some].into_iter().chain(&parts[3..]), false);
            if some.is_partial() {
                let told = some.summary(&study);
                assert!(told.missing.is_some() && told.blocks == some.blocks().count() as u64 && told.traces < 250);
                assert!(both.unwrap().summary(&study) == answer);
                let error = merged(&study, [&some].into_iter().chain(&parts[2..]), true).err().unwrap();
                assert!(error.to_string().contains(" is in 0 too"), "{error}");
            } else {
                assert!(expected.is_some() && some.summary(&study) == answer);
            }
        }
    }
}

/// A study with more traces is as if it had had them from the beginning.
#[test]
fn traces_can_be_raised() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.bin");
    for until in ["", "[until]\nrelative_error = 0.25\n"] {
        let with = |traces: u64| {
            Study::open(Plan::parse(&(STUDY.replace("= 40", &format!("= {traces}")) + until)).unwrap(), Path::new(""))
                .unwrap()
        };
        for shard in ["0/1", "1/3", "2/3", "0/1 of blocks 1..9"] {
            let shard: Shard = shard.parse().unwrap();
            let (large, truth) = (with(180), stopped_after_each(&with(180), shard, 50).0.summary(&with(180)));
            for traces in [5, 40, 42, 110, 140, 175] {
                let small = with(traces);
                stopped_after_each(&small, shard, 50).0.save(&path).unwrap();
                assert!(State::load(&path, &large).err().unwrap().is_foreign());
                assert!(State::load_raised(&path, &large, traces + 1).err().unwrap().is_foreign());
                let state = Mutex::new(State::load_raised(&path, &large, traces).unwrap());
                let done = state.lock().unwrap().place(&large);
                let is_over = state.lock().unwrap().stopped() == Stopped::RelativeError;
                assert!(is_over || done == small.places(shard), "what was done stays done");
                state.lock().unwrap().save(&path).unwrap();
                State::load(&path, &large).unwrap();
                run(&large, &mut engines(&large), &state, &Job::new(), |_, _, _| Ok::<(), ()>(())).unwrap();
                assert!(state.into_inner().unwrap().summary(&large) == truth, "{traces} {shard}");
            }
        }
    }
}

/// The number that stands for how studies answer, and for each part of an answer its hash.
const ANSWERED: (u32, [(&str, &str); 7]) = (
    3,
    [
        ("scalars", "aaa6c4576cbf8e43"),
        ("histograms", "a5344c1e49172f6b"),
        ("survival", "c0a8657a4310f573"),
        ("obstacles", "2a4045acd79be56d"),
        ("ropes", "2c5e22e2ef9735b0"),
        ("contacts", "e5fb24a9dc58dbc0"),
        ("map", "a4734d1f5ba8bc0e"),
    ],
);

#[test]
fn answers_that_change_have_another_number() {
    let mut hashers = ANSWERED.1.map(|_| blake3::Hasher::new());
    for kind in ["uniform", "gaussian", "persistent", "waypoints"] {
        let study = Study::open(Plan::parse(&STUDY.replace("persistent", kind)).unwrap(), Path::new("")).unwrap();
        let (state, ..) = stopped_after_each(&study, Shard::WHOLE, 70);
        let answer = serde_json::to_value(state.summary(&study)).unwrap();
        for (hasher, (part, _)) in hashers.iter_mut().zip(ANSWERED.1) {
            hasher.update(answer[part].to_string().as_bytes());
        }
    }
    let found: Vec<(&str, String)> = hashers
        .iter()
        .zip(ANSWERED.1)
        .map(|(hasher, (part, _))| (part, hasher.finalize().to_hex()[..16].to_owned()))
        .collect();
    let expected = ANSWERED.1.map(|(part, hash)| (part, hash.to_owned()));
    assert!(
        found == expected && ANSWERED.0 == ANSWERS,
        "studies answer otherwise than before: raise the number of ANSWERS in src/study/opened.rs, so that no study \
         goes on with what came out before, and write it here with {found:#?}"
    );
}
