//! `tautline eval`.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::anyhow;
use tautline::engine::{Engine, EngineKind, Job, Precision};
use tautline::homotopy::Classes;
use tautline::output::check_output;
use tautline::scene::Model;
use tautline::stream::{Account, Batches, EndsFiles, Files, Source, Stage, evaluate};
use tautline::trade::Terms;

use super::ends::{self, EndsArgs, Given};
use super::engine::EngineArgs;
use super::failure::Failure;
use super::input::{InputArgs, dropped};
use super::paths::keep_apart;
use super::progress::{Progress, with_progress};
use super::steps::StepArgs;
use super::summary::finish;
use super::trade::TradeArgs;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Queries of a path planner's benchmark in place of traces: a MovingAI .scen for a scene that is a .map. Each rope
    /// is tied at a query's start; its free end goes straight to the goal, or along a shortest way from cell to cell
    #[arg(
        long, value_name = "FILE", requires = "scene",
        conflicts_with_all = [
            "traces", "anchor", "events", "steps", "forces", "engine", "adapter", "precision", "stride", "simplify",
            "on_violation", "anchor_trace", "class",
        ]
    )]
    queries: Option<PathBuf>,
    /// Where to write one row a trace: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Where to write every wrap and unwrap: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Also write the class of each rope: which way it lies among the obstacles, as a word, and how often it winds
    /// about each of them
    #[arg(long, requires = "out")]
    class: bool,
    /// Where to write the forces of the ropes at the end on what they bend round, one row a turn: .jsonl, .csv or
    /// .parquet; without friction unless --friction says how much
    #[arg(long, value_name = "FILE")]
    forces: Option<PathBuf>,
    #[command(flatten)]
    ends: EndsArgs,
    #[command(flatten)]
    every: StepArgs,
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
    // What is wrong with the traces is said after what is wrong with the scene.
    let mut source = args.input.source();
    if let Ok(given) = &mut source
        && args.ends.move_in(given)?
        && let Ok(Source::File(traces)) = source
    {
        if args.class {
            let what = "--class is for ropes that are tied, and here the anchor moves: leave it out";
            return Err(Failure::input(anyhow!(what)));
        }
        return ends::run(&args.of_ends(), traces);
    }
    let terms = args.trade.terms(&args.input.name(), args.input.model()?)?;
    let model = &terms.used;
    if model.scene().dropped() > 0 {
        say!("note: {}", dropped(model.scene().dropped()));
    }
    let source = source?;
    let (mut engine, on) = args.engine.open(model)?;
    let batches = Batches::start(source, terms.clone(), engine.batch());
    let mut account = Account::new(&args.input.name(), &terms, &*engine, on);
    let files = Files::new(args.out.as_deref(), args.events.as_deref(), model, notes(&terms, &*engine));
    let files = match &args.every.steps {
        Some(path) => files.with_steps(path, args.every.extras(model.scene())?),
        None => files,
    };
    let files = match &args.forces {
        Some(path) => files.with_forces(path, args.every.friction.unwrap_or_default()),
        None => files,
    };
    let files = if args.class { files.with_classes(classes(&*engine, model)?) } else { files };
    let mut violations = args.input.violations();
    let (job, progress, policy) = (Job::new(), Progress::new(batches.size()), violations.policy());
    let watch = |stage: Stage<'_>| match stage {
        Stage::Read { settled, position } => {
            violations.flag(settled);
            progress.begin(position, settled.iter().map(|t| t.steps() as u64).sum());
        }
        Stage::Evaluated { settled, records } => account.add(settled, records),
    };
    let outcome = with_progress(&progress, &job, || evaluate(batches, &mut *engine, files, policy, &job, watch));
    let times = outcome.map_err(|error| violations.failure(error))?;
    violations.finish();
    finish(&account.report(&*engine, &job, &times, start.elapsed()), args.json, args.out.is_none())
}

impl Args {
    /// The same where both ends of ropes move.
    fn of_ends(&self) -> Given<'_> {
        let [out, events] = [&self.out, &self.events].map(Option::as_deref);
        let forces = self.forces.as_deref().map(|path| (path, self.every.friction.unwrap_or_default()));
        let files = EndsFiles { out, events, steps: None, forces };
        let others = [("--stride", self.trade.stride.is_some()), ("--simplify", self.trade.simplify.is_some())];
        let Args { input, ends, engine, every, json, .. } = self;
        Given { input, ends, engine, every, files, others, json: *json }
    }
}

/// What tells the classes of ropes that `engine` evaluates.
fn classes(engine: &dyn Engine, model: &Arc<Model>) -> Result<Classes, Failure> {
    if EngineKind::named(engine.name()).is_some_and(EngineKind::counts_events) {
        return Ok(Classes::new(model));
    }
    let name = engine.name();
    let what = "takes no note of wall ends that a rope passes straight, and so not of the side on which they lie";
    Err(Failure::input(anyhow!("--class: the engine {name} {what}; give --engine cpu, or leave --engine out")))
}

/// What results say of themselves: nothing if they are exact.
fn notes(terms: &Terms, engine: &dyn Engine) -> Vec<(&'static str, String)> {
    let fast = engine.precision().filter(|&p| p == Precision::Fast);
    let fast = fast.map(|p| ("tautline.precision", p.name().to_owned()));
    terms.trade.notes().into_iter().chain(fast).collect()
}

/// Refuses outputs that cannot be written, and those that would replace another file of this run.
fn check_outputs(args: &Args) -> Result<(), Failure> {
    let outputs = [&args.out, &args.events, &args.every.steps, &args.forces];
    outputs.into_iter().flatten().try_for_each(|path| check_output(path))?;
    if outputs[2].is_none() && outputs[3].is_none() && args.every.friction.is_some() {
        return Err(Failure::input(anyhow!("--friction: say with --steps or --forces where to write what it makes")));
    }
    let [out, events, steps, forces] = outputs.map(Option::as_deref);
    let [scene, traces] = args.input.named();
    let paths = args.ends.anchor_trace.as_deref();
    let inputs = [scene, traces, ("--queries", args.queries.as_deref()), ("--anchor-trace", paths)];
    keep_apart(&inputs, &[("--out", out), ("--events", events), ("--steps", steps), ("--forces", forces)])
}
