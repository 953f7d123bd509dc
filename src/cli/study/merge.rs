//! `tautline study merge`.

use std::path::PathBuf;

use anyhow::anyhow;
use serde_json::json;
use tautline::output::merge_results;
use tautline::study::{StateError, merge};

use super::folder::Folder;
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
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut opened = args.folders.iter().map(|path| Folder::open(path)).collect::<Result<Vec<_>, _>>()?;
    let shards = opened.iter().map(|(folder, _, state)| (folder.path().to_owned(), state.clone())).collect();
    let (_, study, _) = &opened[0];
    if let Some((folder, ..)) = opened.iter().find(|(_, other, _)| other.identity() != study.identity()) {
        let what = format!("another study than {}'s", args.folders[0].display());
        return Err(StateError { path: folder.path().to_owned(), what }.into());
    }
    let state = merge(study, shards)?;
    let base = opened[0].0.base()?;
    let folder = Folder::create(&args.out)?;
    let (_, study, _) = opened.remove(0);
    folder.remember(study.plan(), &base)?;
    folder.save(&state).map_err(|e| Failure::internal(anyhow!(e)))?;
    if study.plan().outputs.traces {
        let parts: Vec<PathBuf> = args.folders.iter().map(|folder| folder.join(TRACES)).collect();
        let engine = ("merged", study.plan().run.precision.name());
        merge_results(&parts, &folder.path().join(TRACES), &provenance(&study, engine, "several runs"))?;
    }
    let run = json!({
        "version": env!("CARGO_PKG_VERSION"), "commit": env!("TAUTLINE_COMMIT"), "merged": args.folders,
        "precision": study.plan().run.precision.name(), "seconds_of_all_runs": state.seconds(),
    });
    conclude(&folder, &study, &state, &run, args.json)
}
