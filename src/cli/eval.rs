//! `tautline eval`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use anyhow::anyhow;
use tautline::engine::{Engine, Job};
use tautline::output::check_output;
use tautline::scene::Model;

use super::batches::{Batch, Batches};
use super::engine::EngineArgs;
use super::failure::Failure;
use super::input::InputArgs;
use super::output::Output;
use super::progress::{Progress, with_progress};
use super::summary::{Summary, Times};
use super::trade::TradeArgs;
use super::words::dropped;
use super::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Queries of a path planner's benchmark in place of traces: a MovingAI .scen for a scene that is a .map. Each rope is tied
    /// at a query's start; its free end goes straight to the goal, or along a shortest way from cell to cell
    #[arg(
        long, value_name = "FILE", requires = "scene",
        conflicts_with_all = [
            "traces", "anchor", "events", "engine", "adapter", "precision", "window", "keep_all", "stride", "simplify",
            "on_violation",
        ]
    )]
    queries: Option<PathBuf>,
    /// Where to write one row a trace: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Where to write every wrap and unwrap: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    trade: TradeArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    check_outputs(args)?;
    if let (Some(queries), Some(scene)) = (&args.queries, &args.input.scene) {
        return super::queries::run(scene, queries, args.out.as_deref(), args.json);
    }
    let start = Instant::now();
    let terms = args.trade.terms(&args.input.name(), args.input.model()?)?;
    let model = &terms.used;
    if model.scene().dropped() > 0 {
        say!("note: {}", dropped(model.scene().dropped()));
    }
    let source = args.input.source()?;
    let (mut engine, on) = args.engine.open(model)?;
    let batches = Batches::start(source, terms.clone(), engine.batch());
    let mut summary = Summary::new(&args.input.name(), &terms.given, &*engine, on);
    if args.trade.is_any() {
        summary.trade(args.trade, model);
    }
    summary.label(model);
    let mut times = evaluate(args, model, batches, &mut *engine, &mut summary)?;
    summary.learn(&*engine);
    times.total = start.elapsed();
    if args.json { print_json(&summary.json(&times)) } else { print(&summary.table(&times, args.out.is_none())) }
}

/// Evaluates batch after batch, and writes what was asked for.
fn evaluate(
    args: &Args,
    model: &Arc<Model>,
    mut batches: Batches,
    engine: &mut dyn Engine,
    summary: &mut Summary,
) -> Result<Times, Failure> {
    let job = Job::new();
    let mut times = Times::default();
    let mut violations = args.input.violations();
    let notes = args.trade.notes(engine.precision());
    let mut output = Output::new(args.out.as_deref(), args.events.as_deref(), model, notes);
    let progress = Progress::new(batches.size());
    with_progress(&progress, &job, || {
        while let Some(Batch { settled, position, prepared }) = batches.next()? {
            violations.take(&settled)?;
            progress.begin(position, settled.iter().map(|t| t.steps() as u64).sum());
            times.prepared += prepared;
            let start = Instant::now();
            let records = engine.evaluate(&settled, &job)?;
            times.evaluated += start.elapsed();
            summary.add(model, &settled, &records);
            output.write(records)?;
        }
        violations.finish();
        times.written = output.finish()?;
        Ok(times)
    })
}

/// Refuses outputs that cannot be written, and those that would replace another file of this run.
fn check_outputs(args: &Args) -> Result<(), Failure> {
    [&args.out, &args.events].into_iter().flatten().try_for_each(|path| check_output(path))?;
    let files = [
        ("--scene", &args.input.scene),
        ("--traces", &args.input.traces),
        ("--queries", &args.queries),
        ("--out", &args.out),
        ("--events", &args.events),
    ];
    for (i, (output, path)) in files.iter().enumerate().skip(3) {
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
