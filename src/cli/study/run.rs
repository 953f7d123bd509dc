//! `tautline study run` and `tautline study resume`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use serde_json::json;
use tautline::engine::{Engine, Job};
use tautline::picture;
use tautline::report::Environment;
use tautline::study::{
    EXAMPLE, Plan, PlanError, RunError, Shard, Spent, State, Stopped, Study, Summary, run as go, run_again as go_again,
};

use super::folder::{BaseArgs, Folder, PAGE, RUN_REPORT, SUMMARY};
use super::keeper::Keeper;
use super::parts::{self, Parts};
use super::{shard, show};
use crate::cli::engine::{EngineArgs, of_studies};
use crate::cli::failure::Failure;
use crate::cli::input::{note, warn};
use crate::cli::interrupt::{Guard, Last};
use crate::cli::progress::{Progress, with_progress};
use crate::cli::summary::precision;
use crate::cli::trade::TradeArgs;
use crate::cli::{print, print_json};

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct RunArgs {
    /// The study's file (TOML); without one, the built-in example
    file: Option<PathBuf>,
    /// The folder for what comes out; one that holds this study already is gone on with [default: NAME-study]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How many traces, instead of what the file says
    #[arg(long, alias = "traces", value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,
    /// The seed, instead of the file's
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Do only every N-th block, from the K-th on, counted from 0; `study merge` puts the shards together
    #[arg(long, value_name = "K/N", value_parser = shard, default_value = "0/1", hide_default_value = true)]
    shard: Shard,
    /// Check everything, say what it would cost, and stop
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    trade: TradeArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct ResumeArgs {
    /// The study's folder
    folder: PathBuf,
    #[command(flatten)]
    base: BaseArgs,
    #[command(flatten)]
    engine: EngineArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

/// How many anchors are looked at for whether they stand where they were meant to.
const WARNED: usize = 8;

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    let (mut plan, base) = match &args.file {
        Some(file) => (Plan::read(file)?, file.parent().map(Path::to_owned).unwrap_or_default()),
        None => (Plan::parse(EXAMPLE)?, PathBuf::new()),
    };
    let base = if base.as_os_str().is_empty() { PathBuf::from(".") } else { base };
    plan.run.traces = args.count.or(plan.run.traces);
    plan.run.seed = args.seed.unwrap_or(plan.run.seed);
    plan.run.precision = args.engine.precision().unwrap_or(plan.run.precision);
    plan.run.stride = args.trade.stride.unwrap_or(plan.run.stride);
    plan.run.simplify = args.trade.simplify.or(plan.run.simplify);
    args.engine.check(plan.run.precision)?;
    if args.shard.of() > 1 && (plan.until.relative_error.is_some() || plan.until.seconds.is_some()) {
        return Err(Failure::input(anyhow!(
            "--shard: a shard cannot know when the whole study is certain enough; leave out [until]"
        )));
    }
    let located = |e: PlanError| match &args.file {
        Some(file) => e.in_file(file),
        None => e,
    };
    let study = Study::open(plan, &base).map_err(located)?;
    study.check_moves().map_err(located)?;
    if let Some(file) = &study.plan().scene.file {
        note(file, study.models()[0].scene());
        // Sampled anchors lie in the free space of the first one.
        study.models().iter().take(WARNED).for_each(|model| warn(&file.display().to_string(), model));
    }
    if args.dry_run {
        return dry_run(&study, args);
    }
    let stem = args.file.as_deref().and_then(Path::file_stem).map_or("example".into(), |s| s.to_string_lossy());
    let part = if args.shard == Shard::WHOLE {
        String::new()
    } else {
        format!("-{}", args.shard.to_string().replace('/', "-of-"))
    };
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-study{part}")));
    // An engine that is refused leaves no folder behind.
    let engines = Engines::open(&args.engine, &study)?;
    let folder = Arc::new(Folder::make(&out)?);
    let guard = Guard::new(Last::TakeBack(Box::new({
        let folder = folder.clone();
        move || folder.take_back()
    })));
    let ended = begin(&folder, &guard, &study, &base, args.shard)
        .and_then(|state| proceed(&folder, &guard, &study, state, engines, args.json));
    if ended.is_err() {
        folder.take_back();
    }
    ended
}

/// How far a folder is with this part of a study, which it remembers from now on.
fn begin(folder: &Folder, guard: &Guard, study: &Study, base: &Path, part: Shard) -> Result<State, Failure> {
    let held = folder.held(study, part)?;
    if let Some(state) = &held {
        let (shown, done, all) = (folder.path().display(), state.place(study), study.places(part));
        match state.stopped() {
            Stopped::Unfinished => say!("note: {shown} holds {done} of {all} traces of this study already"),
            _ => say!("note: {shown} holds the answer of this study already"),
        }
    }
    // What is written besides the answer may be asked for in another way than before.
    folder.remember(study.plan(), base, part)?;
    let state = held.unwrap_or_else(|| State::new(study, part));
    // Once a state is there, the study can be gone on with, whenever it is stopped.
    guard.change(stopped_before(folder.path()));
    folder.save(&state)?;
    Ok(state)
}

/// What is said of a study that is stopped before anything new is done.
fn stopped_before(folder: &Path) -> Last {
    let shown = folder.display().to_string();
    Last::Save(Box::new(move || {
        Failure::checkpoint(anyhow!("stopped before it went on: do so with `tautline study resume {shown}`"))
    }))
}

pub(super) fn resume(args: &ResumeArgs) -> Result<(), Failure> {
    let guard = Guard::new(stopped_before(&args.folder));
    let folder = Arc::new(Folder::go_on(&args.folder)?);
    let (study, _) = folder.study(&args.base)?;
    let state = folder.state_or_new(&study)?;
    let begun = study.plan().run.precision;
    if args.engine.precision().is_some_and(|asked| asked != begun) {
        return Err(Failure::input(anyhow!(
            "--precision: the study was begun with precision {}, and goes on with that only",
            begun.name()
        )));
    }
    let engines = Engines::open(&args.engine, &study)?;
    proceed(&folder, &guard, &study, state, engines, args.json)
}

/// Goes on until the end, and writes what there is to say.
fn proceed(
    folder: &Arc<Folder>,
    guard: &Guard,
    study: &Study,
    mut state: State,
    Engines { mut engines, on }: Engines,
    as_json: bool,
) -> Result<(), Failure> {
    let job = Job::new();
    let name = (engines[0].name(), precision(&*engines[0]));
    let (parts, gaps) = if study.plan().outputs.traces {
        Parts::open(folder, study, &mut state, provenance(study, name, &on))?
    } else {
        if !std::mem::take(&mut state.kept.parts).is_empty() {
            parts::clear(folder)?;
        }
        (None, Vec::new())
    };
    let (traces_before, mut place) = (state.traces(), state.place(study));
    let (shard, is_done) = (state.shard(), state.stopped() != Stopped::Unfinished);
    let left = if is_done { 0 } else { study.places(shard) - place };
    let traces = left + gaps.iter().map(|gap| gap.end - gap.start).sum::<u64>();
    let steps = study.plan().walk.steps().map_or(0, |steps| traces * u64::from(steps));
    let progress = Progress::new(if steps > 0 { traces } else { 0 });
    progress.begin(traces, steps);
    let keeper = Arc::new(Keeper::new(folder.clone(), study, state, parts));
    guard.change(Last::Save(Box::new({
        let keeper = keeper.clone();
        move || keeper.stop()
    })));
    let start = Instant::now();
    let outcome = with_progress(&progress, &job, || {
        for gap in gaps {
            let mut next = gap.start;
            go_again(study, &mut engines, shard, gap, &job, |records| {
                let first = next;
                next += records.len() as u64;
                keeper.add_again(first, &records)
            })?;
            keeper.keep().map_err(RunError::Caller)?;
        }
        go(study, &mut engines, &keeper.state, &job, |state, records, added| {
            let first = place;
            place += added as u64;
            keeper.add(state, first, &records[..added])
        })
    });
    let ended = match outcome {
        Ok(spent) => Ok(spent),
        Err(RunError::Engine(error)) => Err(error.into()),
        Err(RunError::Plan(error)) => Err(error.into()),
        // Rows may be lost that the state counts: what was saved before stands.
        Err(RunError::Caller(failure)) => return Err(failure),
    };
    let spent = match (keeper.keep(), ended) {
        (kept, Ok(spent)) => kept.map(|()| spent)?,
        // The first fault is the one to be told.
        (_, Err(failure)) => return Err(failure),
    };
    keeper.finish_rows()?;
    let mut state = keeper.state();
    let done = [state.traces() - traces_before, job.steps()];
    let mut run = cost(&state, name, &on, start.elapsed(), &spent, done);
    run["scene"] = tried(study, &engines);
    // Where nothing was left to do, what was said of the run that did it stands.
    let before = if done[0] == 0 { folder.run_report(&state) } else { None };
    let run = before.unwrap_or(run);
    conclude(folder, study, &mut state, &run, as_json)
}

/// The engines, one for each anchor, and in words what they run on.
struct Engines {
    engines: Vec<Box<dyn Engine>>,
    on: String,
}

impl Engines {
    /// Two engines are refused, since an answer does not tell what computed it: the ropes of `note` are wrong on purpose, and
    /// `funnel` knows no contacts passed straight.
    fn open(args: &EngineArgs, study: &Study) -> Result<Self, Failure> {
        let mut all = Engines { engines: Vec::new(), on: String::new() };
        for model in study.models() {
            let (engine, on) = args.open_for(study.plan().run.precision, model)?;
            if ["note", "funnel"].contains(&engine.name()) {
                return Err(Failure::input(anyhow!(
                    "--engine: {} does not count the same events as the other engines; give one of those for a study",
                    engine.name()
                )));
            }
            all.engines.push(engine);
            all.on = on;
        }
        Ok(all)
    }
}

/// What each file of rows says of where it comes from.
pub(super) fn provenance(study: &Study, (engine, precision): (&str, &str), on: &str) -> Vec<(&'static str, String)> {
    let here = Environment::here(None);
    let run = &study.plan().run;
    let mut notes = vec![
        ("tautline.version", here.version.to_owned()),
        ("tautline.commit", here.commit.to_owned()),
        ("tautline.study", study.identity().to_owned()),
        ("tautline.seed", run.seed.to_string()),
        ("tautline.engine", engine.to_owned()),
        ("tautline.precision", precision.to_owned()),
        ("tautline.on", on.to_owned()),
    ];
    notes.extend(run.trade().notes());
    notes
}

/// What the run cost and where it ran.
fn cost(
    state: &State,
    (engine, precision): (&str, &str),
    on: &str,
    took: Duration,
    spent: &Spent,
    [traces, steps]: [u64; 2],
) -> serde_json::Value {
    let here = Environment::here(None);
    let seconds = took.as_secs_f64();
    json!({
        "version": here.version, "commit": here.commit, "engine": engine, "precision": precision, "on": on,
        "processor": here.processor, "os": here.os, "threads": here.threads, "shard": state.shard().to_string(),
        "traces": traces, "steps": steps, "seconds": seconds, "steps_per_second": steps as f64 / seconds,
        "seconds_of_all_runs": state.seconds(),
        "spent": {
            "drawing_beside": spent.drawn, "waiting_for_traces": spent.waited, "evaluating": spent.evaluated,
            "tallying": spent.tallied,
        },
    })
}

/// How many wall ends the scene has, and how many of them the engine of each anchor tries.
fn tried(study: &Study, engines: &[Box<dyn Engine>]) -> serde_json::Value {
    let remaining: Option<Vec<usize>> = engines.iter().map(|engine| engine.remaining()).collect();
    json!({"vertices": study.models()[0].vertices().len(), "remaining": remaining})
}

/// A report as it is written.
pub(super) fn pretty(report: &serde_json::Value) -> String {
    format!("{report:#}\n")
}

/// Writes and prints the answer. Exit code 5 if it is not as certain as was asked for.
pub(super) fn conclude(
    folder: &Folder,
    study: &Study,
    state: &mut State,
    run: &serde_json::Value,
    as_json: bool,
) -> Result<(), Failure> {
    let summary = state.summary(study);
    let answer = serde_json::to_value(&summary).map_err(|e| Failure::internal(e.into()))?;
    folder.write(SUMMARY, pretty(&answer).as_bytes())?;
    let report = pretty(run);
    folder.write(RUN_REPORT, report.as_bytes())?;
    state.kept.files.insert(RUN_REPORT.to_owned(), blake3::hash(report.as_bytes()).into());
    folder.save(state)?;
    if study.plan().outputs.pictures {
        draw(folder, &summary, study, run)?;
    }
    if as_json {
        print_json(&answer)?;
    } else {
        print(&show::table(&summary, Some(run)))?;
        print(&format!("\nwritten to {}\n", folder.path().display()))?;
    }
    let wanted = study.plan().until.relative_error;
    match (wanted, state.stopped()) {
        (Some(wanted), Stopped::Complete | Stopped::Seconds) => Err(Failure::unmet(anyhow!(
            "until.relative_error: the mean greatest length is not as certain as {wanted}; more traces would help"
        ))),
        _ => Ok(()),
    }
}

/// How wide the pictures are as PNG, in pixels: two for each of the SVG's units.
const WIDTH: u32 = 1600;

/// Writes the pictures and the page that shows them.
fn draw(folder: &Folder, summary: &Summary, study: &Study, run: &serde_json::Value) -> Result<(), Failure> {
    let pictures = picture::all(summary, study.models()[0].scene());
    for (name, _, svg) in &pictures {
        folder.write(&format!("{name}.svg"), svg.as_bytes())?;
        let png = picture::png(svg, WIDTH).map_err(|e| Failure::internal(anyhow!("{name}.png: {e}")))?;
        folder.write(&format!("{name}.png"), &png)?;
    }
    let shown: Vec<_> = pictures.into_iter().map(|(_, title, svg)| (title, svg)).collect();
    folder.write(PAGE, picture::page(summary, &shown, Some(run)).as_bytes())
}

/// Does the first blocks, to say what all of them would cost.
fn dry_run(study: &Study, args: &RunArgs) -> Result<(), Failure> {
    let plan = study.plan();
    let Engines { mut engines, on } = Engines::open(&args.engine, study)?;
    let (name, precision) = (engines[0].name(), precision(&*engines[0]));
    let state = Mutex::new(State::new(study, args.shard));
    let clock = Instant::now();
    let mut first = None;
    let outcome = go(study, &mut engines, &state, &Job::new(), |_, _, traces| {
        first = Some((traces, clock.elapsed()));
        Err(())
    });
    match outcome {
        Ok(_) | Err(RunError::Caller(())) => {}
        Err(RunError::Engine(error)) => return Err(error.into()),
        Err(RunError::Plan(error)) => return Err(error.into()),
    }
    let mut text = format!(
        "the study is sound: {} traces in {} blocks, {} walls, anchors: {}, engine {name} ({precision}) on {on}\n",
        plan.run.count(),
        plan.blocks(),
        study.models()[0].scene().walls().len(),
        study.models().len(),
    );
    if let Some((traces, took)) = first.filter(|&(traces, _)| traces > 0) {
        let share = plan.run.count() as f64 / f64::from(args.shard.of()) / traces as f64;
        let all = Duration::try_from_secs_f64(took.as_secs_f64() * share).unwrap_or(Duration::MAX);
        text += &format!("about {}, going by the first {traces} of the traces\n", show::duration(all));
        if let Some(steps) = show::standing(&state.lock().unwrap_or_else(PoisonError::into_inner).summary(study)) {
            text += &format!("{steps} in these\n");
        }
    }
    print(&text)
}
