//! `tautline study run` and `tautline study resume`.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::Job;
use tautline::output::folder_of;
use tautline::session::{Computed, Folder, Saved, Session, answered};
use tautline::study::{EXAMPLE, Plan, PlanError, Shard, Stopped, Study, read_blocks};

use super::answer::{conclude, duration, standing, tell as tell_answer};
use super::base::{BaseArgs, WaitArgs, tell};
use super::engines::Engines;
use super::estimate::measure;
use super::stop::StopArgs;
use crate::cli::engine::{EngineArgs, of_studies};
use crate::cli::failure::Failure;
use crate::cli::input::{note, warn};
use crate::cli::interrupt::{Guard, Last};
use crate::cli::print;
use crate::cli::progress::{Progress, with_progress};
use crate::cli::trade::TradeArgs;
use crate::cli::words::plainly;

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct RunArgs {
    /// The study's file (TOML); without one, the built-in example
    file: Option<PathBuf>,
    /// The folder for what comes out; one that holds this study already is gone on with [default: NAME-study]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How many traces, instead of what the file says
    #[arg(
        long, allow_negative_numbers = true, alias = "traces", value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    count: Option<u64>,
    /// The seed, instead of the file's
    #[arg(long, allow_negative_numbers = true, value_name = "S")]
    seed: Option<u64>,
    /// Do only every N-th block, from the K-th on, counted from 0; `study merge` puts the shards together. K@A-B stands
    /// for the tasks of an array: task K of those numbered from A to B
    #[arg(long, value_name = "K/N", default_value = "0/1", hide_default_value = true)]
    shard: Shard,
    /// Do only the blocks from A on, counted from 0, up to that before B; of these the shard, if one is given
    #[arg(long, value_name = "A..B", value_parser = read_blocks)]
    blocks: Option<Range<u64>>,
    /// Begin, or go on with what is there, however often this is called: one that is done is told and left as it is
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    stop: StopArgs,
    #[command(flatten)]
    wait: WaitArgs,
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
    stop: StopArgs,
    #[command(flatten)]
    wait: WaitArgs,
    #[command(flatten)]
    engine: EngineArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

impl RunArgs {
    /// Which part of the study is asked for.
    fn part(&self) -> Shard {
        let part = self.blocks.clone().and_then(|blocks| self.shard.within(blocks));
        part.unwrap_or(self.shard)
    }
}

/// How many anchors are looked at for whether they stand where they were meant to.
const WARNED: usize = 8;

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    let is_repeated = args.resume || args.stop.is_given();
    let guard = Guard::new(nothing_new(is_repeated, None));
    args.stop.set()?;
    let (mut plan, base) = match &args.file {
        Some(file) => (Plan::read(file)?, folder_of(file)),
        None => (Plan::parse(EXAMPLE)?, Path::new(".")),
    };
    plan.run.traces = args.count.or(plan.run.traces);
    plan.run.seed = args.seed.unwrap_or(plan.run.seed);
    plan.run.precision = args.engine.precision().unwrap_or(plan.run.precision);
    plan.run.stride = args.trade.stride.unwrap_or(plan.run.stride);
    plan.run.simplify = args.trade.simplify.or(plan.run.simplify);
    args.engine.check(plan.run.precision)?;
    let shard = args.part();
    if shard != Shard::WHOLE && plan.until.seconds.is_some() {
        return Err(Failure::input(anyhow!(
            "--shard: what a shard does must not depend on its machine; leave out until.seconds, or give --stop-after"
        )));
    }
    if shard != Shard::WHOLE && plan.until.relative_error.is_some() && plan.outputs.traces {
        return Err(Failure::input(anyhow!(
            "--shard: which rows there are is known only once all shards are merged; leave out outputs.traces, or \
             [until]"
        )));
    }
    let located = |e: PlanError| match &args.file {
        Some(file) => e.in_file(file),
        None => e,
    };
    let study = Arc::new(Study::open(plan, base).map_err(located)?);
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
    let part = if shard == Shard::WHOLE {
        String::new()
    } else {
        format!("-{}", shard.to_string().replace('/', "-of-").replace(' ', "-").replace("..", "-to-"))
    };
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-study{part}")));
    if args.resume
        && let Some(summary) = answered(&out, &study, shard)?
    {
        return tell_answer(&summary, &study, None, &out, args.json);
    }
    // An engine that is refused leaves no folder behind.
    let engines = Engines::open(&args.engine, &study)?;
    let folder = Arc::new(args.wait.take(|| Folder::make(&out))?);
    guard.change(nothing_new(is_repeated, Some(folder.clone())));
    let begin = if args.resume { Session::begin_or_raise } else { Session::begin };
    let begun = begin(folder.clone(), study.clone(), base, shard);
    tell(&folder);
    let ended = begun.map_err(Failure::from).and_then(|session| proceed(Arc::new(session), &guard, engines, args.json));
    if ended.is_err() {
        folder.take_back();
    }
    ended
}

/// What is done where a run is stopped before anything new is done. One that can be repeated is to be.
fn nothing_new(is_repeated: bool, folder: Option<Arc<Folder>>) -> Last {
    let take_back = move || folder.iter().for_each(|folder| folder.take_back());
    match is_repeated {
        true => Last::Save(Box::new(move || {
            take_back();
            Failure::checkpoint(anyhow!("stopped before it went on: repeat the command"))
        })),
        false => Last::TakeBack(Box::new(take_back)),
    }
}

/// What is said of a study that is stopped before anything new is done.
fn stopped_before(folder: &Path, give_up: impl FnOnce() + Send + 'static) -> Last {
    let shown = folder.display().to_string();
    Last::Save(Box::new(move || {
        give_up();
        Failure::checkpoint(anyhow!("stopped before it went on: do so with `tautline study resume {shown}`"))
    }))
}

pub(super) fn resume(args: &ResumeArgs) -> Result<(), Failure> {
    let guard = Guard::new(stopped_before(&args.folder, || ()));
    args.stop.set()?;
    let folder = Arc::new(args.wait.take(|| Folder::open(&args.folder))?);
    tell(&folder);
    let session = Session::resume(folder.clone(), args.base.folder());
    tell(&folder);
    let session = session?;
    let study = session.study().clone();
    let begun = study.plan().run.precision;
    if args.engine.precision().is_some_and(|asked| asked != begun) {
        return Err(Failure::input(anyhow!(
            "--precision: the study was begun with precision {}, and goes on with that only",
            begun.name()
        )));
    }
    let engines = Engines::open(&args.engine, &study)?;
    proceed(Arc::new(session), &guard, engines, args.json)
}

/// Goes on until the end, and writes what there is to say.
fn proceed(
    session: Arc<Session>,
    guard: &Guard,
    Engines { mut engines, on }: Engines,
    as_json: bool,
) -> Result<(), Failure> {
    // Once a state is there, the study can be gone on with, whenever it is stopped.
    guard.change(stopped_before(session.folder().path(), {
        let session = session.clone();
        move || session.folder().give_up()
    }));
    let left = session.prepare(Computed::by(&*engines[0], &on));
    tell(session.folder());
    let left = left?;
    guard.change(Last::Save(Box::new({
        let session = session.clone();
        move || stopped(&session)
    })));
    let (progress, job) = (Progress::new(if left.steps > 0 { left.traces } else { 0 }), Job::new());
    progress.begin(left.traces, left.steps);
    let report = with_progress(&progress, &job, || session.run(&mut engines, &job))?;
    tell(session.folder());
    conclude(&session, &report, as_json)
}

/// Saves what is done because the program is to end, and says how to go on.
fn stopped(session: &Session) -> Failure {
    let Saved { done, all, stopped } = match session.save() {
        Ok(saved) => saved,
        Err(error) => return error.into(),
    };
    session.folder().give_up();
    // Past its end there is nothing new, but that what there is to say may not be written yet.
    let what = match stopped {
        Stopped::Unfinished => format!("{done} of {all} traces are saved: go on"),
        _ => "all that was to be done is saved: have the answer written".to_owned(),
    };
    let shown = session.folder().path().display();
    Failure::checkpoint(anyhow!("stopped; {what} with `tautline study resume {shown}`"))
}

/// Does the first blocks, to say what all of them would cost.
fn dry_run(study: &Study, args: &RunArgs) -> Result<(), Failure> {
    let (plan, part) = (study.plan(), args.part());
    let measured = measure(study, &args.engine, part)?;
    let mut text = format!(
        "the study is sound: {} in {}, {}, anchors: {}, {}\n",
        plainly(plan.run.count(), "trace", "traces"),
        plainly(plan.blocks(), "block", "blocks"),
        plainly(study.models()[0].scene().walls().len() as u64, "wall", "walls"),
        study.models().len(),
        measured.engine,
    );
    if let (Some(all), Some((traces, _))) = (measured.all(study, part), measured.first) {
        text += &format!("about {}, going by the first {traces} of the traces\n", duration(all));
        if let Some(steps) = standing(&measured.summary) {
            text += &format!("{steps} in these\n");
        }
    }
    print(&text)
}
