//! All that is printed: what comes from outside is shown without characters that a terminal obeys.

use std::fmt;
use std::io::Write;
use std::process::ExitCode;

use tautline::escape::{escaped, escaped_json, escaped_lines};

use super::failure::Failure;

/// Says something to people, on a line of stderr: takes what `eprintln!` takes.
macro_rules! say {
    ($($what:tt)*) => {
        $crate::cli::say::to_stderr(format_args!($($what)*))
    };
}

/// A line on stderr; where nobody can read it, that is no fault.
pub(crate) fn to_stderr(what: fmt::Arguments<'_>) {
    let _ = std::io::stderr().lock().write_all(format!("{}\n", escaped_lines(&what.to_string())).as_bytes());
}

/// Prints to stdout; a reader that has seen enough (`| head`) is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write(escaped_lines(text).as_bytes())
}

/// Prints a report as one JSON document.
pub(crate) fn print_json(report: &impl serde::Serialize) -> Result<(), Failure> {
    // By way of a value, which has its keys in order.
    let report = serde_json::to_value(report).map_err(|e| Failure::internal(e.into()))?;
    write(escaped_json(&format!("{report:#}\n")).as_bytes())
}

fn write(text: &[u8]) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(text) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::internal(anyhow::anyhow!(e))),
        _ => Ok(()),
    }
}

/// Says what is wrong with the command line, exit code 2, or the help that it asks for.
pub(crate) fn usage(other: &clap::Error) -> ExitCode {
    // Colours come as escape sequences, so what the user gave cannot be told from them any more.
    let obeyed = std::env::args_os().any(|arg| escaped(&arg.to_string_lossy()) != arg.to_string_lossy());
    if obeyed && other.use_stderr() {
        say!("{}", other.render().to_string().trim_end());
    } else {
        if let (Err(cause), false) = (other.print(), other.use_stderr())
            && cause.kind() != std::io::ErrorKind::BrokenPipe
        {
            say!("error: {cause}");
            return ExitCode::from(1);
        }
    }
    ExitCode::from(other.exit_code() as u8)
}
