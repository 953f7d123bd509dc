//! `tautline eval` where both ends of ropes move.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::anyhow;
use tautline::engine::Job;
use tautline::output::Extras;
use tautline::stream::{Account, EndsFiles, EndsSource, EndsStage, Source, evaluate_ends};
use tautline::trace::TraceReader;
use tautline::trade::Terms;

use super::engine::EngineArgs;
use super::failure::Failure;
use super::input::{InputArgs, tie};
use super::progress::{Progress, with_progress};
use super::steps::StepArgs;
use super::summary::finish;

/// Where the anchors' paths are.
#[derive(Debug, clap::Args)]
pub(crate) struct EndsArgs {
    /// Paths of the ropes' other ends, as traces of as many points: one for all traces, or one of each trace's number.
    /// Traces with columns bx,by need none. In each step the free end moves first
    #[arg(long, value_name = "FILE", requires = "traces", conflicts_with = "anchor")]
    pub anchor_trace: Option<PathBuf>,
}

/// How many traces are read to see where the first rope starts.
const AHEAD: usize = 1 << 10;

impl EndsArgs {
    /// Whether both ends move in these traces.
    pub(crate) fn move_in(&self, source: &mut Source) -> Result<bool, Failure> {
        let Source::File(reader) = source else { return Ok(false) };
        let in_rows = reader.moves_anchor()?;
        if in_rows && self.anchor_trace.is_some() {
            return Err(Failure::input(anyhow!(
                "the traces have columns bx and by, which say where the anchor is: leave --anchor-trace or these \
                 columns out"
            )));
        }
        Ok(in_rows || self.anchor_trace.is_some())
    }

    /// Refuses a place to tie ropes at that are not tied.
    pub(crate) fn refuse_anchor(&self, input: &InputArgs) -> Result<(), Failure> {
        if input.anchor.is_some() { Err(refused("--anchor")) } else { Ok(()) }
    }

    /// The paths of both ends.
    pub(crate) fn source(&self, reader: TraceReader) -> Result<EndsSource, Failure> {
        Ok(match &self.anchor_trace {
            Some(paths) => EndsSource::with_paths(reader, paths)?,
            None => EndsSource::in_rows(reader),
        })
    }
}

fn refused(option: &str) -> Failure {
    Failure::input(anyhow!("the anchor moves in these traces, and {option} is for ropes that are tied: leave it out"))
}

/// What is given of a run.
pub(crate) struct Given<'a> {
    pub input: &'a InputArgs,
    pub ends: &'a EndsArgs,
    pub engine: &'a EngineArgs,
    pub every: &'a StepArgs,
    /// Those without steps.
    pub files: EndsFiles<'a>,
    /// Options that do not go with it, if they are given.
    pub others: [(&'static str, bool); 2],
    pub json: bool,
}

/// Evaluates ropes whose ends both move.
pub(crate) fn run(given: &Given<'_>, traces: TraceReader) -> Result<(), Failure> {
    let Given { input, ends, engine, every, files, others, json } = given;
    ends.refuse_anchor(input)?;
    if let Some((option, _)) = others.iter().find(|(_, is_given)| *is_given) {
        return Err(refused(option));
    }
    let start = Instant::now();
    let mut source = ends.source(traces)?;
    let scene = input.walls()?;
    // Without traces there are no ropes, and any place will do.
    let anchor = source.start(AHEAD)?.or(scene.anchor()).unwrap_or_default();
    let model = Arc::new(tie(scene, Some(anchor), &input.name(), &input.how_to_tie())?);
    let extras = if every.steps.is_some() { every.extras(model.scene())? } else { Extras::default() };
    let files = EndsFiles { steps: every.steps.as_deref().map(|path| (path, &extras)), ..*files };
    let (mut engine, on) = engine.open_both_ends(&model)?;
    say!("note: both ends of the ropes move; the anchor told of is where that of the first trace starts");
    let terms = Terms::exact(model.clone());
    let mut account = Account::new(&input.name(), &terms, &*engine, on);
    let mut violations = input.violations();
    let (job, progress, policy) = (Job::new(), Progress::new(source.size()), violations.policy());
    let watch = |stage: EndsStage<'_>| match stage {
        EndsStage::Read { settled, position } => {
            violations.flag_ends(settled);
            progress.begin(position, settled.iter().map(|t| t.steps() as u64).sum());
        }
        EndsStage::Evaluated { settled, records } => account.add_ends(settled, records),
    };
    let evaluate = || evaluate_ends(source, &model, &mut *engine, files, policy, &job, watch);
    let outcome = with_progress(&progress, &job, evaluate);
    let times = outcome.map_err(|error| violations.failure(error))?;
    violations.finish();
    let report = account.report(&*engine, &job, &times, start.elapsed());
    finish(&report, *json, files.out.is_none())
}
