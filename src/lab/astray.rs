//! How far the engines that promise nothing are off in [extreme cases](crate::lab::extremes).

use rayon::prelude::*;
use std::fmt;

use crate::engine::{Cpu, Engine, EngineError, FastGpu, Job, Note};
use crate::gpu::Device;
use crate::lab::extremes::{Extreme, FAMILIES, Family};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::{SettledTrace, settle};

/// How many events a trace may have to be given to a device: it answers one of them a round, so that a longer chain in
/// a lone trace takes minutes.
pub const LONGEST_CHAIN: usize = 1500;

/// What one engine made of one family.
#[derive(Debug, Clone)]
pub struct Errors {
    /// `fast` or `note`.
    pub engine: &'static str,
    /// The family.
    pub family: Family,
    /// How many of its cases were evaluated.
    pub cases: usize,
    /// How many were not, because a lone trace of theirs has more than [`LONGEST_CHAIN`] events.
    pub left_out: usize,
    /// What the engine says of the cases that it refused, each message once.
    pub refused: Vec<String>,
    /// How many traces were evaluated.
    pub traces: usize,
    /// How many steps they have.
    pub steps: u64,
    /// How many traces have other events than they should.
    pub other_events: usize,
    /// How many traces end with another taut rope than they should.
    pub other_ropes: usize,
    /// The largest error of a final rope's length, as a share of the longest that the right rope of that trace ever
    /// was.
    pub worst_length: f64,
}

/// Evaluates all extreme cases with `fast` on `device` and with `note`, and compares them with `cpu`. Two lines a
/// family, in the order of [`FAMILIES`]. Under a minute on two cores and a software adapter.
///
/// # Errors
///
/// [`EngineError::Stopped`] when `job` was stopped, and whatever goes wrong with the device but for its refusals.
pub fn errors(device: &Device, job: &Job) -> Result<Vec<Errors>, EngineError> {
    let mut lines = Vec::new();
    for family in FAMILIES {
        let [mut fast, mut note] = ["fast", "note"].map(|engine| Errors::none(engine, family));
        for case in family.cases() {
            let model = case.model();
            let traces = settled(&model, &case);
            let truth = Cpu::new(model.clone()).evaluate(&traces, job)?;
            if truth.iter().any(|record| record.events.len() > LONGEST_CHAIN) {
                fast.left_out += 1;
            } else {
                match FastGpu::new(device.clone(), model.clone()) {
                    Ok(mut engine) => fast.add(&truth, &engine.evaluate(&traces, job)?),
                    Err(error) => fast.refuse(error.to_string()),
                }
            }
            note.add(&truth, &Note::new(model.clone()).evaluate(&traces, job)?);
        }
        lines.extend([fast, note]);
    }
    Ok(lines)
}

fn settled(model: &Model, case: &Extreme) -> Vec<SettledTrace> {
    case.traces.par_iter().map(|trace| settle(model, trace)).collect()
}

impl Errors {
    fn none(engine: &'static str, family: Family) -> Self {
        let (cases, left_out, traces, steps, other_events, other_ropes) = (0, 0, 0, 0, 0, 0);
        let (refused, worst_length) = (Vec::new(), 0.0);
        Errors { engine, family, cases, left_out, refused, traces, steps, other_events, other_ropes, worst_length }
    }

    fn refuse(&mut self, why: String) {
        if !self.refused.contains(&why) {
            self.refused.push(why);
        }
    }

    fn add(&mut self, truth: &[TraceRecord], found: &[TraceRecord]) {
        self.cases += 1;
        for (right, found) in truth.iter().zip(found) {
            self.traces += 1;
            self.steps += right.steps;
            self.other_events += usize::from(right.events != found.events);
            self.other_ropes += usize::from(right.wraps != found.wraps);
            let error = (found.length - right.length).abs();
            // A rope that never had a length has none to be wrong by.
            let share = if error == 0.0 { 0.0 } else { error / right.max_length };
            self.worst_length = self.worst_length.max(share);
        }
    }
}

impl fmt::Display for Errors {
    /// A line of a Markdown table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Errors { engine, family, cases, traces, steps, worst_length, .. } = self;
        let share = |count: usize| match (count, *traces) {
            (0, _) => "0".to_owned(),
            (count, traces) => format!("{:.3} %", 100.0 * count as f64 / traces as f64),
        };
        let family = format!("{}: {}", family.name.replace('_', " "), family.what);
        let (events, ropes) = (share(self.other_events), share(self.other_ropes));
        write!(f, "| {family} | {engine} | {cases} | {traces} | {steps} | {events} | {ropes} | {worst_length:.1e} |")?;
        let left_out = (self.left_out > 0).then(|| format!("{} left out: too many events", self.left_out));
        let remarks: Vec<String> = self.refused.iter().cloned().chain(left_out).collect();
        write!(f, " {} |", remarks.join("; "))
    }
}

/// The head of the Markdown table of which [`Errors`] are the lines.
pub const HEAD: &str = "\
| family | engine | cases | traces | steps | other events | other final rope | worst length | |
|---|---|---|---|---|---|---|---|---|";

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::engine::Reference;
    use crate::trace::Trace;

    #[test]
    fn errors_are_counted_against_the_right_ropes() {
        let case = Extreme {
            name: String::new(),
            walls: vec![[DVec2::new(3.0, 4.0), DVec2::new(3.0, -4.0)]],
            anchor: DVec2::ZERO,
            traces: [vec![[0.0, 12.0]], vec![[5.0, 12.0], [5.0, 4.0], [5.0, 12.0], [5.0, 4.0]]]
                .map(|points| Trace { id: 0, points: points.into_iter().map(DVec2::from).collect() })
                .into(),
        };
        let model = case.model();
        let truth = Reference::new(model.clone()).evaluate(&settled(&model, &case), &Job::new()).unwrap();
        let mut errors = Errors::none("note", FAMILIES[2]);
        errors.add(&truth, &truth);
        assert_eq!(
            errors.to_string(),
            "| near lines: three wall ends 1 to 2^40 units in the last place off a line | note | 1 | 2 | 3 | 0 | 0 | \
             0.0e0 |  |"
        );
        // Without its last contact, and a quarter of the longest rope, which is 13 long, too long.
        let mut found = truth.clone();
        found[1].wraps.pop();
        found[1].length += 3.25;
        errors.add(&truth, &found);
        found[1].events.pop();
        errors.add(&truth, &found);
        errors.left_out = 1;
        errors.refuse("too wide".to_owned());
        errors.refuse("too wide".to_owned());
        let line = "| note | 3 | 6 | 9 | 16.667 % | 33.333 % | 2.5e-1 | too wide; 1 left out: too many events |";
        assert!(errors.to_string().ends_with(line), "{errors}");
    }
}
