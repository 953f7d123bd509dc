//! Parsing and printing. Everything that happens in between is the library's.

#[macro_use]
mod say;

mod adapters;
mod bench;
mod check;
mod convert;
mod draw;
mod ends;
mod engine;
pub(crate) mod environment;
mod eval;
mod examples;
mod failure;
mod input;
mod interrupt;
mod look;
mod manual;
mod measured;
mod of_class;
mod parse;
mod paths;
mod progress;
mod queries;
mod steps;
mod study;
mod summary;
mod trade;
mod tradeoff;
mod violations;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use say::{print, print_json};
use tautline::words;

/// Taut ropes of dragged traces among walls, in bulk and exactly, on the GPU.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 110,
    after_help = "Exit codes: 0 done; 1 internal error; 2 bad input or usage; \
    3 no such or lost GPU; 4 stopped early with a checkpoint; 5 finished with a target not met; \
    6 another run writes to the study's folder; 130 stopped by Ctrl-C."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Evaluate the ropes of given traces in a scene; without any, those of the built-in example
    #[command(after_help = examples::EVAL)]
    Eval(eval::Args),
    /// Monte-Carlo studies: very many random traces, and what their ropes are like on the whole
    Study(study::Args),
    /// Check a scene, and traces in it, without evaluating ropes
    #[command(after_help = examples::CHECK)]
    Check(check::Args),
    /// Draw traces and their ropes: at one moment, event by event, or moving
    #[command(after_help = examples::DRAW)]
    Draw(draw::Args),
    /// Write a scene of any format as GeoJSON or well-known text
    #[command(after_help = examples::CONVERT)]
    Convert(convert::Args),
    /// Measure the throughput of all engines, side by side on the same walks
    #[command(after_help = examples::BENCH)]
    Bench(bench::Args),
    /// Measure what speed costs in accuracy: every method at every setting, against the exact reference
    #[command(after_help = examples::TRADEOFF)]
    Tradeoff(tradeoff::Args),
    /// List the GPUs that this machine offers
    #[command(after_help = examples::ADAPTERS)]
    Adapters(adapters::Args),
    /// Print a script that has a shell complete commands and options
    #[command(after_help = examples::COMPLETIONS)]
    Completions(manual::CompletionsArgs),
    /// Write manual pages, one for each command
    #[command(after_help = examples::MAN)]
    Man(manual::ManArgs),
}

/// Runs the command line and returns the process's exit code.
pub(crate) fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(other) => return say::usage(&other),
    };
    // A panic is a bug of this program; its message is printed by then.
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        interrupt::listen()?;
        match cli.command {
            Command::Eval(args) => eval::run(&args),
            Command::Study(args) => study::run(&args),
            Command::Check(args) => check::run(&args),
            Command::Draw(args) => draw::run(&args),
            Command::Convert(args) => convert::run(&args),
            Command::Bench(args) => bench::run(&args),
            Command::Tradeoff(args) => tradeoff::run(&args),
            Command::Adapters(args) => adapters::run(&args),
            Command::Completions(args) => manual::completions(&args, Cli::command()),
            Command::Man(args) => manual::man(&args, Cli::command()),
        }
    }));
    match outcome {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            say!("error: {failure}");
            failure.code()
        }
        Err(_) => {
            say!("error: this is a bug in tautline; please report it with the input that shows it");
            ExitCode::from(1)
        }
    }
}
