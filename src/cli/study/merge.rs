//! `tautline study merge`.

use std::path::PathBuf;

use serde_json::json;
use tautline::output::merge_results;
use tautline::study::merge;

use super::folder::{BaseArgs, Folder};
use super::parts::TRACES;
use super::run::{conclude, provenance};
use crate::cli::failure::Failure;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The shards' folders, all of them
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The folder for what comes out; must not hold a study yet
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    base: BaseArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (study, base) = Folder::at(&args.folders[0]).study(&args.base)?;
    let state = |path: &PathBuf| Ok((path.clone(), Folder::at(path).state(&study)?));
    let state = merge(&study, args.folders.iter().map(state).collect::<Result<_, Failure>>()?)?;
    let folder = Folder::create(&args.out)?;
    // The state comes last: without it, this can be done again.
    if study.plan().outputs.traces {
        let parts: Vec<PathBuf> = args.folders.iter().map(|folder| folder.join(TRACES)).collect();
        let notes = provenance(&study, ("merged", study.plan().run.precision.name()), "several runs");
        merge_results(&parts, &folder.path().join(TRACES), &notes, state.traces())?;
    }
    folder.remember(study.plan(), &base)?;
    folder.save(&state)?;
    let run = json!({
        "version": env!("CARGO_PKG_VERSION"), "commit": env!("TAUTLINE_COMMIT"), "merged": args.folders,
        "precision": study.plan().run.precision.name(), "seconds_of_all_runs": state.seconds(),
    });
    conclude(&folder, &study, &state, &run, args.json)
}
