use std::path::Path;

use super::*;
use crate::engine::Cpu;
use crate::study::{Plan, merge};

/// Two anchors, and blocks of 7 traces of which the last is smaller.
const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\nanchor = { sample = 2 }\n[walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
    start = \"visible\"\n[run]\ntraces = 40\nblock = 7\n[tallies]\nlimits = [2.0, 9.0]\n";

fn study() -> Study {
    Study::open(Plan::parse(STUDY).unwrap(), Path::new("")).unwrap()
}

fn engines(study: &Study) -> Vec<Box<dyn Engine>> {
    study.models().iter().map(|model| Box::new(Cpu::new(model.clone())) as _).collect()
}

/// Runs a shard to its end in groups of at most `size` traces, and stops after every one of them: the state is saved, and read for
/// the next. Tells how many traces each group had that are in the state.
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
