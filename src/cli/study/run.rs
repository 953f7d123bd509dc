//! `tautline study run` and `tautline study resume`.

use std::path::Path;
use std::sync::Arc;

use tautline::output::folder_of;
use tautline::session::{Folder, Session, SweepFolder, answered, is_answered};
use tautline::study::{EXAMPLE, Study, StudyFile};

use super::answer::{conclude, duration, standing, tell as tell_answer};
use super::base::tell;
use super::engines::Engines;
use super::estimate::measure;
use super::proceed::{nothing_new, proceed, stopped_before};
use super::run_args::{ResumeArgs, RunArgs};
use super::sweep;
use crate::cli::failure::Failure;
use crate::cli::input::{note, warn};
use crate::cli::interrupt::Guard;
use crate::cli::print;
use crate::cli::words::plainly;

/// How many anchors are looked at for whether they stand where they were meant to.
const WARNED: usize = 8;

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    let is_repeated = args.resume || args.stop.is_given();
    let guard = Guard::new(nothing_new(is_repeated, None));
    args.stop.set()?;
    let (file, base) = match &args.file {
        Some(file) => (StudyFile::read(file, &args.set)?, folder_of(file)),
        None => (StudyFile::parse(EXAMPLE, &args.set)?, Path::new(".")),
    };
    if let Some(swept) = file.sweep()? {
        return sweep::run(args, swept, base, &guard);
    }
    let mut plan = file.plan()?;
    args.change(&mut plan);
    args.check(&plan)?;
    args.check_part(&plan).map_err(|e| file.located(e))?;
    let study = Arc::new(Study::open(plan, base).map_err(|e| file.located(e))?);
    study.check_moves().map_err(|e| file.located(e))?;
    if let Some(file) = &study.plan().scene.file {
        note(file, study.models()[0].scene());
        // Sampled anchors lie in the free space of the first one.
        study.models().iter().take(WARNED).for_each(|model| warn(&file.display().to_string(), model));
    }
    if args.dry_run {
        return dry_run(&study, args);
    }
    let (out, shard) = (args.folder(), args.part());
    if args.resume
        && let Some(summary) = answered(&out, &study, shard)?
    {
        return tell_answer(&summary, &study, None, &out, args.json);
    }
    if let Some(whole) = &args.enough
        && is_answered(whole, &study)?
    {
        return print(&format!("{} has the answer already\n", whole.display()));
    }
    // An engine that is refused leaves no folder behind.
    let engines = Engines::open(&args.engine, &study)?;
    let folder = Arc::new(args.wait.take(|| Folder::make(&out))?);
    guard.change(nothing_new(is_repeated, Some(folder.clone())));
    let begin = if args.resume { Session::begin_or_raise } else { Session::begin };
    let begun = begin(folder.clone(), study.clone(), base, shard);
    tell(&folder);
    let ended = begun.map_err(Failure::from).and_then(|session| {
        let session = Arc::new(session);
        let report = proceed(&session, &guard, engines, folder.path())?;
        conclude(&session, &report, args.json)
    });
    if ended.is_err() {
        folder.take_back();
    }
    ended
}

pub(super) fn resume(args: &ResumeArgs) -> Result<(), Failure> {
    let guard = Guard::new(stopped_before(&args.folder, || ()));
    args.stop.set()?;
    if SweepFolder::is_at(&args.folder) {
        return sweep::resume(args, &guard);
    }
    let folder = Arc::new(args.wait.take(|| Folder::open(&args.folder))?);
    tell(&folder);
    let session = Session::resume(folder.clone(), args.base.folder());
    tell(&folder);
    let session = session?;
    let study = session.study().clone();
    args.check(study.plan())?;
    let engines = Engines::open(&args.engine, &study)?;
    let session = Arc::new(session);
    let report = proceed(&session, &guard, engines, folder.path())?;
    conclude(&session, &report, args.json)
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
