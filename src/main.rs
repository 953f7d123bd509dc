//! The command line of `tautline`.

// Everything is printed by `cli::say`, which shows no character that a terminal obeys.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::environment::quieten_vulkan();
    cli::environment::outlive_size_limits();
    cli::run()
}
