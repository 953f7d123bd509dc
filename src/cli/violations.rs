//! Traces that cross walls: what is said about them, and whether they end the run.

use anyhow::anyhow;
use tautline::trace::{SettledTrace, Violation};

use super::failure::Failure;

/// What to do with a trace that breaks the small update condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum OnViolation {
    /// Stop, and name the first
    Error,
    /// Mark such traces in the results and go on
    Flag,
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
        let file = &self.file;
        match (violations.first(), self.policy) {
            (Some(first), OnViolation::Error) => {
                let hint = "--on-violation flag marks such traces and goes on";
                return Err(Failure::input(anyhow!("{file}{first}; {hint}")));
            }
            (Some(_), OnViolation::Flag) => {
                let left = SHOWN.saturating_sub(self.found);
                violations.iter().take(left).for_each(|v| say!("warning: {file}{v}"));
            }
            (None, _) => {}
        }
        self.found += violations.len();
        Ok(violations)
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
