//! The differences of a sweep against what is known otherwise.

use std::path::Path;
use std::sync::Mutex;

use tautline::engine::{Cpu, Engine, Job};
use tautline::study::{Estimate, PointAnswer, Reference, Shard, State, Study, StudyFile, run};

/// What both studies of a sweep over two steps say.
fn answers(traces: u32, block: u32, seed: u32) -> [PointAnswer; 2] {
    let text = format!(
        "[scene]\nbuilt_in = \"random-40\"\n[walk]\nkind = \"uniform\"\nsteps = 40\n[run]\ntraces = {traces}\n\
         block = {block}\nseed = {seed}\n[tallies]\nconfidence = 0.9\nlimits = [0.8]\nmap = 0\nropes = 0\n\
         [sweep]\nwalk.step = [0.12, 0.13]\n"
    );
    let sweep = StudyFile::parse(&text, &[]).unwrap().sweep().unwrap().unwrap();
    let done = [0, 1].map(|point| {
        let study = Study::open(sweep.points()[point].plan.clone(), Path::new(".")).unwrap();
        let state = Mutex::new(State::new(&study, Shard::WHOLE));
        let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(Cpu::new(study.models()[0].clone()))];
        run(&study, &mut engines, &state, &Job::new(), |_, _, _| Ok::<(), ()>(())).unwrap();
        (study, state.into_inner().unwrap())
    });
    let against = Reference::new(&done[0].0, &done[0].1);
    done.map(|(study, state)| PointAnswer::new(String::new(), Vec::new(), (&study, &state), Some(&against)))
}

/// The differences of the second: of all means, and of the share within the limit.
fn differences(answers: &[PointAnswer; 2]) -> Vec<(String, Estimate)> {
    let found = answers[1].differences.as_ref().unwrap();
    let means = found.scalars.iter().map(|scalar| (scalar.name.clone(), scalar.mean.unwrap()));
    means.chain([("within".to_owned(), found.within[0].share.unwrap())]).collect()
}

#[test]
fn intervals_of_differences_hold_the_truth_as_often_as_they_say_and_are_narrower() {
    let truth = differences(&answers(80_000, 800, 99));
    const SWEEPS: u32 = 400;
    let mut held = vec![0u32; truth.len()];
    // The squares of the errors, paired and as if the studies had nothing in common.
    let mut squares = vec![[0.0; 2]; truth.len()];
    for seed in 1000..1000 + SWEEPS {
        let both = answers(400, 20, seed);
        let apart = |place: usize| {
            let error = |answer: &PointAnswer| match answer.scalars.get(place) {
                Some(scalar) => scalar.mean.error.unwrap(),
                None => answer.within[0].share.error.unwrap(),
            };
            error(&both[0]).hypot(error(&both[1]))
        };
        for (place, ((_, found), (_, truth))) in differences(&both).iter().zip(&truth).enumerate() {
            held[place] += u32::from(found.low.unwrap() <= truth.value && truth.value <= found.high.unwrap());
            squares[place][0] += found.error.unwrap().powi(2);
            squares[place][1] += apart(place).powi(2);
        }
    }
    for (place, (name, truth)) in truth.iter().enumerate() {
        let share = f64::from(held[place]) / f64::from(SWEEPS);
        // Four standard deviations of what 400 sweeps can show, 0.06, and what is left open of the truth.
        assert!((0.84..=0.96).contains(&share), "{name}: {share} of the intervals of 0.9 hold {truth:?}");
        let [paired, apart] = squares[place];
        assert!(paired < 0.8 * apart, "{name}: variances of {paired} paired, {apart} unpaired");
    }
}
