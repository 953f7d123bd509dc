//! The command line of `tautline`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::environment::quieten_vulkan();
    cli::run()
}
