//! `tautline eval`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use tautline::engine::Job;
use tautline::output::{EventWriter, ResultWriter, WholeFile, check_output};
use tautline::rope::TraceRecord;
use tautline::scene::Model;

use super::engine::EngineArgs;
use super::failure::Failure;
use super::input::InputArgs;
use super::interrupt::{self, Writing};
use super::progress::with_progress;
use super::summary::Summary;
use super::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Where to write one row a trace: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Where to write every wrap and unwrap: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    #[command(flatten)]
    engine: EngineArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    interrupt::listen()?;
    // Trying whether a file can be written makes one for a moment.
    let writing = Writing::begin();
    writing.check()?;
    check_outputs(args)?;
    writing.end()?;
    let start = Instant::now();
    let model = args.input.model()?;
    if model.scene().dropped() > 0 {
        eprintln!("note: {} walls of zero length were dropped", model.scene().dropped());
    }
    let traces = args.input.read_traces(&model)?;
    let settled = args.input.settle(&model, traces)?;
    let (mut engine, on) = args.engine.open(&model)?;
    let prepared = start.elapsed();

    let job = Job::new();
    let steps = settled.iter().map(|t| t.steps() as u64).sum();
    let start = Instant::now();
    let records = with_progress(&job, steps, || engine.evaluate(&settled, &job))?;
    let evaluated = start.elapsed();
    drop(settled);
    write(args, &model, &records)?;

    let summary = Summary::new(&args.input.name(), &model, (engine.name(), on), &records, prepared, evaluated);
    if args.json { print_json(&summary.json()) } else { print(&summary.table(args.out.is_none())) }
}

/// Refuses outputs that cannot be written, and those that would replace another file of this run.
fn check_outputs(args: &Args) -> Result<(), Failure> {
    [&args.out, &args.events].into_iter().flatten().try_for_each(|path| check_output(path))?;
    let files = [
        ("--scene", &args.input.scene),
        ("--traces", &args.input.traces),
        ("--out", &args.out),
        ("--events", &args.events),
    ];
    for (i, (output, path)) in files.iter().enumerate().skip(2) {
        let Some(path) = path else { continue };
        let same = |other: &&(_, &Option<PathBuf>)| other.1.as_deref().is_some_and(|o| place(o) == place(path));
        if let Some((other, _)) = files[..i].iter().find(same) {
            return Err(Failure::input(anyhow!("{other} and {output} name the same file, {}", path.display())));
        }
    }
    Ok(())
}

/// The path without links and detours, so that equal places have equal paths; the file need not be there yet.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        path.file_name().map_or(folder.clone(), |name| folder.join(name))
    })
}

/// Writes what was asked for; files appear under their names only when they are whole.
fn write(args: &Args, model: &Model, records: &[TraceRecord]) -> Result<(), Failure> {
    let writing = Writing::begin();
    writing.check()?;
    let mut out = args.out.as_deref().map(ResultWriter::create).transpose()?;
    let mut events = args.events.as_deref().map(EventWriter::create).transpose()?;
    for record in records {
        writing.check()?;
        out.as_mut().map_or(Ok(()), |w| w.write(record))?;
        events.as_mut().map_or(Ok(()), |w| w.write(model.vertices(), record))?;
    }
    // Neither appears before both are whole.
    let out = out.map(ResultWriter::complete).transpose()?;
    let events = events.map(EventWriter::complete).transpose()?;
    writing.check()?;
    Ok([out, events].into_iter().flatten().try_for_each(WholeFile::finish)?)
}
