//! `tautline study merge`.

use std::path::PathBuf;

use anyhow::anyhow;
use tautline::session::{SessionError, SweepFolder, merge, merge_sweep};

use super::answer::conclude;
use super::base::{BaseArgs, tell};
use super::sweep;
use crate::cli::failure::Failure;
use crate::cli::interrupt::{Guard, Last};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The parts' folders, all of them, in any order
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The folder for what comes out; must not hold another study
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Take the parts that are there, also those under way, and say what they do; what is missing is named
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    base: BaseArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if SweepFolder::is_at(&args.folders[0]) {
        return run_sweep(args);
    }
    let mut guard = None;
    let merged = merge(&args.folders, args.partial, args.base.folder(), &args.out, |folder| {
        tell(folder);
        let folder = folder.clone();
        guard = Some(Guard::new(Last::TakeBack(Box::new(move || folder.take_back()))));
    });
    let (session, report) = merged.map_err(of_out)?;
    conclude(&session, &report, args.json)
}

/// Puts the parts of a sweep together, study by study.
fn run_sweep(args: &Args) -> Result<(), Failure> {
    let mut guard = None;
    let merged = merge_sweep(&args.folders, args.partial, args.base.folder(), &args.out, |folder| {
        tell(folder);
        let folder = folder.clone();
        let stopped = Last::Save(Box::new(move || {
            folder.take_back();
            Failure::checkpoint(anyhow!("stopped before all studies were put together: repeat the command"))
        }));
        match &guard {
            Some(guard) => Guard::change(guard, stopped),
            None => guard = Some(Guard::new(stopped)),
        }
    });
    let (folder, answer) = merged.map_err(of_out)?;
    sweep::tell_answer(&folder, &answer, args.json)
}

fn of_out(error: SessionError) -> Failure {
    match error {
        SessionError::IsShard { .. } => Failure::input(anyhow!("--out: {error}")),
        other => other.into(),
    }
}
