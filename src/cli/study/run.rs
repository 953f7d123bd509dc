//! `tautline study run` and `tautline study resume`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::anyhow;
use serde_json::json;
use tautline::engine::{Engine, EngineError, Job};
use tautline::picture;
use tautline::report::Environment;
use tautline::study::{EXAMPLE, Plan, PlanError, RunError, Shard, Spent, State, Stopped, Study, Summary, run as go};

use super::folder::{BaseArgs, Folder, RUN_REPORT};
use super::parts::Parts;
use super::show;
use crate::cli::engine::{EngineArgs, of_studies};
use crate::cli::failure::Failure;
use crate::cli::input::note;
use crate::cli::interrupt::{self, Writing};
use crate::cli::progress::{Progress, with_progress};
use crate::cli::summary::precision;
use crate::cli::trade::{self, TradeArgs};
use crate::cli::{print, print_json};

/// How often the state is saved.
const CHECKPOINT: Duration = Duration::from_secs(10);

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct RunArgs {
    /// The study's file (TOML); without one, the built-in example
    file: Option<PathBuf>,
    /// The folder for what comes out; must not hold a study yet
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

fn shard(text: &str) -> Result<Shard, String> {
    let wrong = || "give K/N with K from 0 to N - 1, such as 0/4".to_owned();
    let (number, of) = text.split_once('/').ok_or_else(wrong)?;
    let [number, of] = [number, of].map(|n| n.parse::<u32>().map_err(|_| wrong()));
    Shard::new(number?, of?).ok_or_else(wrong)
}

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    interrupt::listen()?;
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
    let out = args.out.clone().unwrap_or_else(|| Folder::unused(&format!("{stem}-study{part}")));
    let _writing = Writing::begin();
    interrupt::check()?;
    // An engine that is refused leaves no folder behind.
    let engines = Engines::open(&args.engine, &study)?;
    let folder = Folder::create(&out)?;
    folder.remember(study.plan(), &base)?;
    let state = State::new(&study, args.shard);
    folder.save(&state)?;
    proceed(&folder, &study, state, engines, args.json)
}

pub(super) fn resume(args: &ResumeArgs) -> Result<(), Failure> {
    interrupt::listen()?;
    let _writing = Writing::begin();
    interrupt::check()?;
    let (folder, study, state) = Folder::open(&args.folder, &args.base)?;
    let begun = study.plan().run.precision;
    if args.engine.precision().is_some_and(|asked| asked != begun) {
        return Err(Failure::input(anyhow!(
            "--precision: the study was begun with precision {}, and goes on with that only",
            begun.name()
        )));
    }
    proceed(&folder, &study, state, Engines::open(&args.engine, &study)?, args.json)
}

/// Goes on until the end or Ctrl-C, and writes what there is to say.
fn proceed(
    folder: &Folder,
    study: &Study,
    mut state: State,
    Engines { mut engines, on }: Engines<'_>,
    as_json: bool,
) -> Result<(), Failure> {
    let job = Arc::new(Job::new());
    interrupt::stops(&job);
    let name = (engines[0].name(), precision(&*engines[0]));
    let left = state.shard().count(study.plan().blocks()).saturating_sub(state.done());
    let traces = left * u64::from(study.plan().run.block);
    let steps = study.plan().walk.steps().map_or(0, |steps| traces * u64::from(steps));
    let progress = Progress::new(if steps > 0 { traces } else { 0 });
    progress.begin(traces, steps);
    let mut parts = match study.plan().outputs.traces {
        true => Parts::open(folder.path(), &state, provenance(study, name, &on))?,
        false => None,
    };
    let traces_before = state.traces();
    let (start, mut saved, mut written) = (Instant::now(), Instant::now(), state.done());
    let outcome = with_progress(&progress, &job, || {
        go(study, &mut engines, &mut state, &job, |state, records, added| {
            if let Some(parts) = &mut parts {
                parts.write(written, study.models()[0].scene(), &records[..added])?;
                written = state.done();
            }
            if saved.elapsed() >= CHECKPOINT {
                // First the rows: those that the state does not know of yet are written again.
                parts.as_mut().map_or(Ok(()), Parts::close)?;
                folder.save(state)?;
                saved = Instant::now();
            }
            Ok::<(), Failure>(())
        })
    });
    let ended = match outcome {
        Ok(spent) => Ok(spent),
        Err(RunError::Engine(EngineError::Stopped)) => {
            let (done, shown) = (state.done(), folder.path().display());
            let all = state.shard().count(study.plan().blocks());
            Err(Failure::checkpoint(anyhow!(
                "stopped; {done} of {all} blocks are saved: go on with `tautline study resume {shown}`"
            )))
        }
        Err(RunError::Engine(error)) => Err(error.into()),
        Err(RunError::Plan(error)) => Err(error.into()),
        // Rows may be lost that the state counts: what was saved before stands.
        Err(RunError::Caller(failure)) => return Err(failure),
    };
    parts.as_mut().map_or(Ok(()), Parts::close)?;
    folder.save(&state)?;
    let spent = ended?;
    parts.map_or(Ok(()), |parts| parts.finish(state.traces()))?;
    let done = [state.traces() - traces_before, job.steps()];
    let mut run = cost(&state, name, &on, start.elapsed(), &spent, done);
    run["scene"] = tried(study, &engines);
    // Where nothing was left to do, what was said of the run that did it stands.
    let before = if done[0] == 0 { folder.run_report() } else { None };
    let run = before.unwrap_or(run);
    conclude(folder, study, &state, &run, as_json)
}

/// The engines, one for each anchor, and in words what they run on.
struct Engines<'s> {
    engines: Vec<Box<dyn Engine + 's>>,
    on: String,
}

impl<'s> Engines<'s> {
    /// Two engines are refused, since an answer does not tell what computed it: the ropes of `note` are wrong on purpose, and
    /// `funnel` knows no contacts passed straight.
    fn open(args: &EngineArgs, study: &'s Study) -> Result<Self, Failure> {
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
    notes.extend(trade::notes(run.stride, run.simplify));
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
fn tried(study: &Study, engines: &[Box<dyn Engine + '_>]) -> serde_json::Value {
    let remaining: Option<Vec<usize>> = engines.iter().map(|engine| engine.remaining()).collect();
    json!({"vertices": study.models()[0].vertices().len(), "remaining": remaining})
}

/// Writes and prints the answer. Exit code 5 if it is not as certain as was asked for.
pub(super) fn conclude(
    folder: &Folder,
    study: &Study,
    state: &State,
    run: &serde_json::Value,
    as_json: bool,
) -> Result<(), Failure> {
    let summary = state.summary(study);
    let pretty = |value: &serde_json::Value| format!("{value:#}\n");
    let answer = serde_json::to_value(&summary).map_err(|e| Failure::internal(e.into()))?;
    folder.write("summary.json", pretty(&answer).as_bytes())?;
    folder.write(RUN_REPORT, pretty(run).as_bytes())?;
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
    folder.write("report.html", picture::page(summary, &shown, Some(run)).as_bytes())
}

/// Does the first blocks, to say what all of them would cost.
fn dry_run(study: &Study, args: &RunArgs) -> Result<(), Failure> {
    let plan = study.plan();
    let Engines { mut engines, on } = Engines::open(&args.engine, study)?;
    let (name, precision) = (engines[0].name(), precision(&*engines[0]));
    let mut state = State::new(study, args.shard);
    let clock = Instant::now();
    let mut first = None;
    let outcome = go(study, &mut engines, &mut state, &Job::new(), |_, _, traces| {
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
        if let Some(steps) = show::standing(&state.summary(study)) {
            text += &format!("{steps} in these\n");
        }
    }
    print(&text)
}
