use std::path::Path;

use super::*;
use crate::engine::Cpu;
use crate::study::opened::ANSWERS;
use crate::study::{Plan, merge};

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
        let ended = in_groups(study, &mut engines(study), &state, &Job::new(), size, stop);
        let state = state.into_inner().unwrap();
        if let Ok(spent) = ended {
            assert_eq!(spent, Spent::default(), "nothing was left to do");
            return (state, all, sizes);
        }
        assert!(matches!(ended, Err(RunError::Caller(()))));
        state.save(&path).unwrap();
    }
}

#[test]
fn a_study_that_is_stopped_within_blocks_ends_the_same() {
    let study = study();
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
    let states = shards.iter().map(|shard| (Path::new("").to_owned(), shard.0.clone())).collect();
    assert!(merge(&study, states).unwrap().summary(&study) == answer);
    // The last block, of 5 traces, is the second of the shard with number 2.
    assert_eq!(
        shards[2].1.iter().map(|record| record.trace).collect::<Vec<_>>(),
        Vec::from_iter((14..21).chain(35..40))
    );
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
