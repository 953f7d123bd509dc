//! What is asked of `tautline study run` and `tautline study resume`.

use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tautline::study::{Assignment, Plan, PlanError, Shard, read_blocks};

use super::base::{BaseArgs, WaitArgs};
use super::stop::StopArgs;
use crate::cli::engine::{EngineArgs, of_studies};
use crate::cli::failure::Failure;
use crate::cli::trade::TradeArgs;

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct RunArgs {
    /// The study's file (TOML); without one, the built-in example
    pub(super) file: Option<PathBuf>,
    /// The folder for what comes out; one that holds this study already is gone on with [default: NAME-study]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// A value for a key of the file, in place of what stands there: walk.step=2. May be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) set: Vec<Assignment>,
    /// How many traces, instead of what the file says
    #[arg(
        long, allow_negative_numbers = true, alias = "traces", value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    pub(super) count: Option<u64>,
    /// The seed, instead of the file's
    #[arg(long, allow_negative_numbers = true, value_name = "S")]
    pub(super) seed: Option<u64>,
    /// Do only every N-th block, from the K-th on, counted from 0; `study merge` puts the shards together. K@A-B stands
    /// for the tasks of an array: task K of those numbered from A to B
    #[arg(long, value_name = "K/N", default_value = "0/1", hide_default_value = true)]
    pub(super) shard: Shard,
    /// Do only the blocks from A on, counted from 0, up to that before B; of these the shard, if one is given
    #[arg(long, value_name = "A..B", value_parser = read_blocks)]
    pub(super) blocks: Option<Range<u64>>,
    /// Begin, or go on with what is there, however often this is called: one that is done is told and left as it is
    #[arg(long)]
    pub(super) resume: bool,
    /// Leave alone what has its answer in this folder: the study, or each such point of a sweep. For parts of a study
    /// that ends once it is certain enough, with what `study merge --partial` makes of all of them
    #[arg(long, value_name = "DIR")]
    pub(super) enough: Option<PathBuf>,
    #[command(flatten)]
    pub(super) stop: StopArgs,
    #[command(flatten)]
    pub(super) wait: WaitArgs,
    /// Check everything, say what it would cost, and stop
    #[arg(long)]
    pub(super) dry_run: bool,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
    #[command(flatten)]
    pub(super) trade: TradeArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct ResumeArgs {
    /// The study's folder
    pub(super) folder: PathBuf,
    #[command(flatten)]
    pub(super) base: BaseArgs,
    #[command(flatten)]
    pub(super) stop: StopArgs,
    #[command(flatten)]
    pub(super) wait: WaitArgs,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
    /// Print the summary as one JSON document
    #[arg(long)]
    pub(super) json: bool,
}

impl RunArgs {
    /// Which part of the study is asked for.
    pub(super) fn part(&self) -> Shard {
        let part = self.blocks.clone().and_then(|blocks| self.shard.within(blocks));
        part.unwrap_or(self.shard)
    }

    /// Puts what options say in the place of what the file does.
    pub(super) fn change(&self, plan: &mut Plan) {
        plan.run.traces = self.count.or(plan.run.traces);
        plan.run.seed = self.seed.unwrap_or(plan.run.seed);
        plan.run.precision = self.engine.precision().unwrap_or(plan.run.precision);
        plan.run.stride = self.trade.stride.unwrap_or(plan.run.stride);
        plan.run.simplify = self.trade.simplify.or(plan.run.simplify);
    }

    /// The options that are given of those that stand for keys, with these.
    pub(super) fn changed(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let all = [
            (self.count.is_some(), "--count", "run.traces"),
            (self.seed.is_some(), "--seed", "run.seed"),
            (self.engine.precision().is_some(), "--precision", "run.precision"),
            (self.trade.stride.is_some(), "--stride", "run.stride"),
            (self.trade.simplify.is_some(), "--simplify", "run.simplify"),
        ];
        all.into_iter().filter(|(is_given, ..)| *is_given).map(|(_, option, key)| (option, key))
    }

    /// Refuses a part of a study that has none.
    pub(super) fn check_part(&self, plan: &Plan) -> Result<(), PlanError> {
        if self.part() == Shard::WHOLE { Ok(()) } else { plan.check_shared() }
    }

    /// Refuses options that do not go with a study.
    pub(super) fn check(&self, plan: &Plan) -> Result<(), Failure> {
        self.engine.check(plan.run.precision)
    }

    /// The folder for what comes out.
    pub(super) fn folder(&self) -> PathBuf {
        let stem = self.file.as_deref().and_then(Path::file_stem).map_or("example".into(), |s| s.to_string_lossy());
        let part = match self.part() {
            Shard::WHOLE => String::new(),
            part => format!("-{}", part.to_string().replace('/', "-of-").replace(' ', "-").replace("..", "-to-")),
        };
        self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-study{part}")))
    }
}

impl ResumeArgs {
    /// Refuses to go on with a study that was begun with another precision.
    pub(super) fn check(&self, plan: &Plan) -> Result<(), Failure> {
        let begun = plan.run.precision;
        match self.engine.precision() {
            Some(asked) if asked != begun => Err(Failure::input(anyhow!(
                "--precision: the study was begun with precision {}, and goes on with that only",
                begun.name()
            ))),
            _ => Ok(()),
        }
    }
}
