//! `tautline study show`.

use std::path::PathBuf;

use tautline::session::{SweepFolder, is_answer, look};

use super::answer::{print_answer, table};
use super::base::BaseArgs;
use super::sweep_table;
use crate::cli::failure::Failure;
use crate::cli::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The study's folder
    folder: PathBuf,
    #[command(flatten)]
    base: BaseArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if SweepFolder::is_at(&args.folder) {
        let answer = SweepFolder::open(&args.folder)?.answer(args.base.folder())?;
        return if args.json { print_json(&answer) } else { print(&sweep_table::table(&answer)) };
    }
    let (study, state) = look(&args.folder, args.base.folder())?;
    let summary = state.summary(&study);
    if !is_answer(&args.folder, &summary)? {
        let (file, shown) = (args.folder.join("summary.json"), args.folder.display());
        say!("note: {} does not hold this answer; `tautline study resume {shown}` writes it", file.display());
    }
    if args.json { print_answer(&summary) } else { print(&table(&summary, study.models()[0].scene(), None)) }
}
