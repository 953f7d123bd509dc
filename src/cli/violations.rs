//! Traces that cross walls: what is said about them, and whether they end the run.

use std::fmt::Display;

use anyhow::anyhow;
use tautline::stream::{self, StreamError};
use tautline::trace::{End, SettledEnds, SettledTrace, Violation};

use super::failure::Failure;

/// What to do with a trace that breaks the small update condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum OnViolation {
    /// Stop, and name the first
    Error,
    /// Mark such traces in the results and go on
    Flag,
}

impl From<OnViolation> for stream::OnViolation {
    fn from(policy: OnViolation) -> Self {
        match policy {
            OnViolation::Error => stream::OnViolation::Error,
            OnViolation::Flag => stream::OnViolation::Flag,
        }
    }
}

/// How many are warned of one by one.
const SHOWN: usize = 1000;

/// The violations of a run.
pub(crate) struct Violations {
    /// What messages start with.
    file: String,
    policy: OnViolation,
    found: usize,
}

impl Violations {
    /// None so far in `file`, whose name messages start with.
    pub(crate) fn new(file: String, policy: OnViolation) -> Self {
        Violations { file, policy, found: 0 }
    }

    /// Looks through the next traces: the first violation is an error, or all are warned of and returned.
    pub(crate) fn take(&mut self, settled: &[SettledTrace]) -> Result<Vec<Violation>, Failure> {
        let violations: Vec<Violation> = settled.iter().filter_map(|t| t.violation().copied()).collect();
        match (violations.first(), self.policy) {
            (Some(first), OnViolation::Error) => return Err(self.refused(first)),
            _ => violations.iter().for_each(|violation| self.warn(violation)),
        }
        Ok(violations)
    }

    /// Warns of the violations of traces that are marked.
    pub(crate) fn flag(&mut self, settled: &[SettledTrace]) {
        settled.iter().filter_map(|t| t.violation()).for_each(|violation| self.warn(violation));
    }

    /// Looks through the next traces of ropes whose ends both move: the first violation is an error, or all are warned
    /// of.
    pub(crate) fn take_ends(&mut self, settled: &[SettledEnds]) -> Result<(), Failure> {
        match (settled.iter().find_map(SettledEnds::violation), self.policy) {
            (Some(first), OnViolation::Error) => Err(self.refused(in_words(first))),
            _ => {
                self.flag_ends(settled);
                Ok(())
            }
        }
    }

    /// The same of ropes whose ends both move.
    pub(crate) fn flag_ends(&mut self, settled: &[SettledEnds]) {
        settled.iter().filter_map(SettledEnds::violation).for_each(|violation| self.warn(in_words(violation)));
    }

    fn warn(&mut self, violation: impl Display) {
        if self.found < SHOWN {
            say!("warning: {}{violation}", self.file);
        }
        self.found += 1;
    }

    fn refused(&self, violation: impl Display) -> Failure {
        let hint = "--on-violation flag marks such traces and goes on";
        Failure::input(anyhow!("{}{violation}; {hint}", self.file))
    }

    /// What is said of a stream that ended early.
    pub(crate) fn failure(&self, error: StreamError) -> Failure {
        match error {
            StreamError::Violation(_) | StreamError::AnchorViolation(_) => self.refused(error),
            other => other.into(),
        }
    }

    /// What is done with them.
    pub(crate) fn policy(&self) -> stream::OnViolation {
        self.policy.into()
    }

    /// Says how many were not warned of, and returns how many there are.
    pub(crate) fn finish(self) -> usize {
        if self.found > SHOWN {
            let more = self.found - SHOWN;
            let list = "`tautline check --on-violation flag --json` lists them all";
            say!("warning: and {more} more traces that cross walls; {list}");
        }
        self.found
    }
}

/// What an end does that breaks the rules.
fn in_words((end, violation): (End, &Violation)) -> String {
    match end {
        End::Free => violation.to_string(),
        End::Anchor => format!("the anchor of {violation}"),
    }
}
