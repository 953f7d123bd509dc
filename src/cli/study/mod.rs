//! `tautline study`.

mod answer;
mod base;
mod engines;
mod estimate;
mod merge;
mod proceed;
mod replay;
mod run;
mod run_args;
mod script;
mod show;
mod status;
mod stop;
mod sweep;
mod sweep_table;
mod time;

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Subcommand;
use tautline::output::write_whole;
use tautline::session::{RunReport, SweepRecord};
use tautline::study::{EXAMPLE, StudyFile, Summary, SweepAnswer};

use super::failure::Failure;
use super::{examples, print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a study, or the built-in example
    #[command(after_help = examples::STUDY_RUN)]
    Run(run_args::RunArgs),
    /// Go on with a study that was stopped
    #[command(after_help = examples::STUDY_RESUME)]
    Resume(run_args::ResumeArgs),
    /// Put the shards of a study together
    #[command(after_help = examples::STUDY_MERGE)]
    Merge(merge::Args),
    /// Show what a study says so far
    #[command(after_help = examples::STUDY_SHOW)]
    Show(show::Args),
    /// How far studies are, over many folders at once: blocks, who writes there, time left
    #[command(after_help = examples::STUDY_STATUS)]
    Status(status::Args),
    /// Write a script that has a scheduler run a study in parts and merge them
    #[command(after_help = examples::STUDY_SCRIPT)]
    Script(script::Args),
    /// Evaluate one of a study's traces again
    #[command(after_help = examples::STUDY_REPLAY)]
    Replay(replay::Args),
    /// Write a study's file to start from, with comments
    #[command(after_help = examples::STUDY_INIT)]
    Init(InitArgs),
    /// Print the JSON Schema of studies' files, of their answers, or of what runs cost
    #[command(after_help = examples::STUDY_SCHEMA)]
    Schema(SchemaArgs),
}

#[derive(Debug, clap::Args)]
struct SchemaArgs {
    /// Of what
    #[arg(long, value_enum, default_value = "study")]
    of: Described,
}

/// What there are schemas of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Described {
    /// The file of a study
    Study,
    /// Its answer, summary.json
    Summary,
    /// What a run of it cost, run.json
    Run,
    /// What a sweep is, sweep.json
    Sweep,
    /// What `study show --json` prints of a sweep
    SweepAnswer,
}

#[derive(Debug, clap::Args)]
struct InitArgs {
    /// The file to write; must not be there yet
    #[arg(default_value = "study.toml")]
    file: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::Run(args) => run::run(args),
        Command::Resume(args) => run::resume(args),
        Command::Merge(args) => merge::run(args),
        Command::Show(args) => show::run(args),
        Command::Status(args) => status::run(args),
        Command::Script(args) => script::run(args),
        Command::Replay(args) => replay::run(args),
        Command::Init(args) => init(args),
        Command::Schema(args) => print_json(&match args.of {
            Described::Study => StudyFile::schema(),
            Described::Summary => Summary::schema(),
            Described::Run => RunReport::schema(),
            Described::Sweep => SweepRecord::schema(),
            Described::SweepAnswer => SweepAnswer::schema(),
        }),
    }
}

fn init(args: &InitArgs) -> Result<(), Failure> {
    let name = args.file.display();
    if args.file.symlink_metadata().is_ok() {
        return Err(Failure::input(anyhow!("cannot write {name}: it is there already; give another name")));
    }
    write_whole(&args.file, EXAMPLE.as_bytes())?;
    print(&format!("wrote {name}; run it with: tautline study run {name}\n"))
}
