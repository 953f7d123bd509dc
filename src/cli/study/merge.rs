//! `tautline study merge`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::anyhow;
use serde_json::json;
use tautline::output::{WriteError, merge_results};
use tautline::study::{Shard, State, merge};

use super::folder::{BaseArgs, Folder, check};
use super::lock::Lock;
use super::parts::{self, TRACES};
use super::run::{conclude, provenance};
use crate::cli::failure::Failure;
use crate::cli::interrupt::{Guard, Last};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The shards' folders, all of them
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The folder for what comes out; must not hold another study
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    base: BaseArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(shard) = args.folders.iter().find(|shard| is_same(shard, &args.out)) {
        return Err(Failure::input(anyhow!("--out: {} is one of the shards; give another folder", shard.display())));
    }
    let _shared = args.folders.iter().map(|shard| Lock::share(shard)).collect::<Result<Vec<_>, Failure>>()?;
    let (study, base) = Folder::at(&args.folders[0]).study(&args.base)?;
    let shards: Vec<_> = args
        .folders
        .iter()
        .map(|path| Ok((path.clone(), Folder::at(path).state(&study)?)))
        .collect::<Result<_, Failure>>()?;
    let mut state = merge(&study, shards.clone())?;
    let with_rows = study.plan().outputs.traces;
    let rows = |(path, state): &(PathBuf, State)| parts::of_shard(&Folder::at(path), state);
    let rows: Vec<PathBuf> = shards.iter().filter(|_| with_rows).map(rows).collect::<Result<_, Failure>>()?;
    let folder = Arc::new(Folder::make(&args.out)?);
    let _guard = Guard::new(Last::TakeBack(Box::new({
        let folder = folder.clone();
        move || folder.take_back()
    })));
    let merged = folder.held(&study, Shard::WHOLE).and_then(|_| {
        // The state comes last: without it, this can be done again.
        folder.remember(study.plan(), &base, Shard::WHOLE)?;
        if with_rows {
            let notes = provenance(&study, ("merged", study.plan().run.precision.name()), "several runs");
            let file = folder.file(TRACES);
            merge_results(&rows, &file, study.models()[0].scene(), &notes, state.traces())?;
            let check = check(&file).map_err(|cause| WriteError::Io { path: file, cause })?;
            state.kept.files.insert(TRACES.to_owned(), check);
        }
        Ok(folder.save(&state)?)
    });
    if merged.is_err() {
        folder.take_back();
    }
    merged?;
    let run = json!({
        "version": env!("CARGO_PKG_VERSION"), "commit": env!("TAUTLINE_COMMIT"), "merged": args.folders,
        "precision": study.plan().run.precision.name(), "seconds_of_all_runs": state.seconds(),
    });
    conclude(&folder, &study, &mut state, &run, args.json)
}

/// Whether both are one folder.
fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}
