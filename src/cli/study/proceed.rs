//! Going on with a study to its end, and what is done where it is stopped on the way.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::Job;
use tautline::session::{Computed, Folder, RunReport, Saved, Session};
use tautline::study::Stopped;

use super::base::tell;
use super::engines::Engines;
use crate::cli::failure::Failure;
use crate::cli::interrupt::{Guard, Last};
use crate::cli::progress::{Progress, with_progress};

/// What is done where a run is stopped before anything new is done. One that can be repeated is to be.
pub(super) fn nothing_new(is_repeated: bool, folder: Option<Arc<Folder>>) -> Last {
    let take_back = move || folder.iter().for_each(|folder| folder.take_back());
    match is_repeated {
        true => Last::Save(Box::new(move || {
            take_back();
            Failure::checkpoint(anyhow!("stopped before it went on: repeat the command"))
        })),
        false => Last::TakeBack(Box::new(take_back)),
    }
}

/// What is said of a study that is stopped before anything new is done.
pub(super) fn stopped_before(folder: &Path, give_up: impl FnOnce() + Send + 'static) -> Last {
    let shown = folder.display().to_string();
    Last::Save(Box::new(move || {
        give_up();
        Failure::checkpoint(anyhow!("stopped before it went on: do so with `tautline study resume {shown}`"))
    }))
}

/// Goes on until the end. One that is stopped is gone on with in the folder `whole`: its own, or that of its sweep.
pub(super) fn proceed(
    session: &Arc<Session>,
    guard: &Guard,
    Engines { mut engines, on }: Engines,
    whole: &Path,
) -> Result<RunReport, Failure> {
    // Once a state is there, the study can be gone on with, whenever it is stopped.
    guard.change(stopped_before(whole, {
        let session = session.clone();
        move || session.folder().give_up()
    }));
    let left = session.prepare(Computed::by(&*engines[0], &on));
    tell(session.folder());
    let left = left?;
    guard.change(Last::Save(Box::new({
        let (session, whole) = (session.clone(), whole.to_owned());
        move || stopped(&session, whole)
    })));
    let (progress, job) = (Progress::new(if left.steps > 0 { left.traces } else { 0 }), Job::new());
    progress.begin(left.traces, left.steps);
    let report = with_progress(&progress, &job, || session.run(&mut engines, &job))?;
    tell(session.folder());
    Ok(report)
}

/// Saves what is done because the program is to end, and says how to go on.
fn stopped(session: &Session, whole: PathBuf) -> Failure {
    let Saved { done, all, stopped } = match session.save() {
        Ok(saved) => saved,
        Err(error) => return error.into(),
    };
    session.folder().give_up();
    let own = session.folder().path();
    let name = own.file_name().filter(|_| own != whole).unwrap_or_default().to_string_lossy();
    let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
    // Past its end there is nothing new, but that what there is to say may not be written yet.
    let what = match stopped {
        Stopped::Unfinished => format!("{done} of {all} traces{of} are saved: go on"),
        _ => "all that was to be done is saved: have the answer written".to_owned(),
    };
    let shown = whole.display();
    Failure::checkpoint(anyhow!("stopped; {what} with `tautline study resume {shown}`"))
}
