//! Stopping before a scheduler does.

use std::time::{Duration, SystemTime};

use anyhow::anyhow;

use super::time::time;
use crate::cli::failure::Failure;
use crate::cli::interrupt::end_in;

/// What Slurm sets: when the job will be ended, in seconds since 1970.
const END: &str = "SLURM_JOB_END_TIME";

/// When to stop, whatever is done by then.
#[derive(Debug, clap::Args)]
pub(crate) struct StopArgs {
    /// Save and stop with exit code 4 after so long, such as 90s, 55m or 2h; the same command goes on
    #[arg(long, value_name = "TIME", value_parser = time)]
    stop_after: Option<Duration>,
    /// The same so long before the end of the job, where Slurm says when that is (SLURM_JOB_END_TIME)
    #[arg(long, value_name = "TIME", value_parser = time)]
    stop_before: Option<Duration>,
}

impl StopArgs {
    /// Whether there is a time at which to stop.
    pub(super) fn is_given(&self) -> bool {
        self.stop_after.is_some() || self.stop_before.is_some()
    }

    /// Has the process end in time.
    pub(super) fn set(&self) -> Result<(), Failure> {
        self.stop_after.into_iter().for_each(end_in);
        let Some(before) = self.stop_before else { return Ok(()) };
        let Ok(end) = std::env::var(END) else {
            say!("note: --stop-before: {END} is not set, so nobody knows when the job ends; it ends with the study");
            return Ok(());
        };
        let seconds = end.parse().map_err(|_| {
            Failure::input(anyhow!("--stop-before: {END} is {end:?}, and should be a whole number of seconds"))
        })?;
        let now = SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
        end_in(Duration::from_secs(seconds).saturating_sub(now).saturating_sub(before));
        Ok(())
    }
}
