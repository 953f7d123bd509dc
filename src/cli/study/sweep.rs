//! `tautline study run` and `tautline study resume` of a sweep.

use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use tautline::session::{Folder, Session, SessionError, SweepFolder, answered, is_answered};
use tautline::study::{Study, Sweep, SweepAnswer};

use super::answer::duration;
use super::base::{WaitArgs, tell};
use super::engines::Engines;
use super::estimate::check_sweep;
use super::proceed::{proceed, stopped_before};
use super::run_args::{ResumeArgs, RunArgs};
use super::sweep_table::{table, words};
use crate::cli::engine::EngineArgs;
use crate::cli::failure::Failure;
use crate::cli::interrupt::Guard;
use crate::cli::words::plainly;
use crate::cli::{print, print_json};

pub(super) fn run(args: &RunArgs, mut sweep: Sweep, base: &Path, guard: &Guard) -> Result<(), Failure> {
    if let Some((option, key)) = args.changed().find(|(_, key)| sweep.sweeps(key)) {
        return Err(Failure::input(anyhow!("{option}: the file sweeps {key}; leave one of them out")));
    }
    sweep.change(|plan| args.change(plan));
    for (i, point) in sweep.points().iter().enumerate() {
        args.check(&point.plan)?;
        args.check_part(&point.plan).map_err(|e| sweep.located(e, i))?;
    }
    let (out, shard) = (args.folder(), args.part());
    if args.dry_run {
        let expected = check_sweep(&sweep, base, Some((&args.engine, shard)))?;
        let count = sweep.points().len();
        return print(&format!(
            "the sweep is sound: {}, from {} to {}\nabout {}, going by the first traces of some of them\n",
            plainly(count as u64, "study", "studies"),
            sweep.words(0),
            sweep.words(count - 1),
            duration(expected)
        ));
    }
    // None is begun before all are known to be sound, and an engine that is refused leaves no folder behind.
    if !(args.resume && SweepFolder::is_at(&out)) {
        check_sweep(&sweep, base, None)?;
        drop(Engines::open(&args.engine, &Study::open(sweep.points()[0].plan.clone(), base)?)?);
    }
    let folder = SweepFolder::begin(&out, &sweep, base, shard, args.resume)?;
    guard.change(stopped_before(&out, || ()));
    let enough = args.enough.as_deref();
    let work = Work { engine: &args.engine, wait: &args.wait, may_raise: args.resume, enough };
    work.all(&folder, base, guard)?;
    conclude(&folder, Some(base), args.json)
}

pub(super) fn resume(args: &ResumeArgs, guard: &Guard) -> Result<(), Failure> {
    let folder = SweepFolder::open(&args.folder)?;
    folder.points().try_for_each(|(_, point)| args.check(&point.study))?;
    let base = args.base.folder().unwrap_or(&folder.record().base).to_owned();
    let work = Work { engine: &args.engine, wait: &args.wait, may_raise: true, enough: None };
    work.all(&folder, &base, guard)?;
    conclude(&folder, args.base.folder(), args.json)
}

/// What the studies of a sweep are run with.
struct Work<'a> {
    engine: &'a EngineArgs,
    wait: &'a WaitArgs,
    /// Whether folders may hold the same with fewer traces.
    may_raise: bool,
    /// The folder of a sweep whose answers need not be computed again.
    enough: Option<&'a Path>,
}

impl Work<'_> {
    /// Does all studies, one after the other. Those that are done are left as they are.
    fn all(&self, sweep: &SweepFolder, base: &Path, guard: &Guard) -> Result<(), Failure> {
        let count = sweep.record().points.len();
        for (out, point) in sweep.points() {
            let study = Study::open(point.study.clone(), base)
                .map_err(|error| SessionError::Plan { error, began: Some(base.to_owned()) })?;
            if answered(&out, &study, sweep.record().shard)?.is_some() {
                continue;
            }
            if let Some(whole) = self.enough
                && is_answered(&whole.join(&point.folder), &study)?
            {
                say!("{} of {count}: {} has the answer already", point.folder, whole.display());
                continue;
            }
            say!("{} of {count}: {}", point.folder, words(&sweep.record().keys, &point.values));
            self.one(&out, Arc::new(study), base, sweep, guard)?;
        }
        Ok(())
    }

    fn one(
        &self,
        out: &Path,
        study: Arc<Study>,
        base: &Path,
        sweep: &SweepFolder,
        guard: &Guard,
    ) -> Result<(), Failure> {
        let engines = Engines::open(self.engine, &study)?;
        let folder = Arc::new(self.wait.take(|| Folder::make(out))?);
        guard.change(stopped_before(sweep.path(), {
            let folder = folder.clone();
            move || folder.take_back()
        }));
        let begin = if self.may_raise { Session::begin_or_raise } else { Session::begin };
        let begun = begin(folder.clone(), study, base, sweep.record().shard);
        tell(&folder);
        let ended = begun.map_err(Failure::from).and_then(|session| {
            let session = Arc::new(session);
            let report = proceed(&session, guard, engines, sweep.path())?;
            Ok(session.conclude(&report)?)
        });
        if ended.is_err() {
            folder.take_back();
        }
        ended.map(|_| ())
    }
}

/// Writes what all studies say, side by side, and prints it.
fn conclude(folder: &SweepFolder, base: Option<&Path>, as_json: bool) -> Result<(), Failure> {
    let answer = folder.conclude(base)?;
    tell_answer(folder, &answer, as_json)
}

/// Prints what all studies say. Exit code 5 if some are not as certain as was asked for.
pub(super) fn tell_answer(folder: &SweepFolder, answer: &SweepAnswer, as_json: bool) -> Result<(), Failure> {
    if as_json {
        print_json(answer)?;
    } else {
        print(&format!("{}\nwritten to {}\n", table(answer), folder.path().display()))?;
    }
    let unmet: Vec<&str> = folder.unmet(answer).collect();
    match unmet[..] {
        [] => Ok(()),
        _ => Err(Failure::unmet(anyhow!(
            "until.relative_error: the mean greatest length is not as certain as was asked for in {}; more traces \
             would help",
            unmet.join(", ")
        ))),
    }
}
