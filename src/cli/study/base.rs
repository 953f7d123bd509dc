//! What all commands about a study's folder have in common.

use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tautline::session::{Folder, SessionError};

use super::time::time;

/// Where the study's files are.
#[derive(Debug, clap::Args)]
pub(crate) struct BaseArgs {
    /// The folder from which the study's file names scene and traces, if it is another than when the study began
    #[arg(long, value_name = "DIR")]
    base: Option<PathBuf>,
}

impl BaseArgs {
    /// The folder, if it is given.
    pub(super) fn folder(&self) -> Option<&Path> {
        self.base.as_deref()
    }
}

/// Which folder to take, and for how long to wait for it.
#[derive(Debug, clap::Args)]
pub(crate) struct WaitArgs {
    /// Wait for so long, such as 90s, 55m or 2h, where another run writes to the folder; else leave with exit code 6
    #[arg(long, value_name = "TIME", value_parser = time)]
    wait: Option<Duration>,
}

impl WaitArgs {
    /// What `take` takes, at the latest once the time is over.
    pub(super) fn take<T>(&self, take: impl Fn() -> Result<T, SessionError>) -> Result<T, SessionError> {
        let start = Instant::now();
        let mut is_told = false;
        loop {
            match take() {
                Err(error @ SessionError::InUse { .. }) if self.wait.is_some_and(|most| start.elapsed() < most) => {
                    if !std::mem::replace(&mut is_told, true) {
                        say!("note: {error}; waiting");
                    }
                    sleep(BETWEEN);
                }
                taken => return taken,
            }
        }
    }
}

/// How long a run that waits does not look.
const BETWEEN: Duration = Duration::from_secs(1);

/// Says what there is to note of a study's folder.
pub(super) fn tell(folder: &Folder) {
    folder.notes().iter().for_each(|note| say!("note: {note}"));
}
