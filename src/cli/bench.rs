//! `tautline bench`.

use std::time::Duration;

use anyhow::anyhow;
use tautline::engine::{EngineKind, WINDOW};
use tautline::environment::Environment;
use tautline::lab::bench::{
    BenchError, CONTENDERS, Contender, Document, Plan, Report, Setting, Stage, Sweep, measure_all,
};

use super::engine::adapter_name;
use super::failure::Failure;
use super::measured::{SceneArgs, device, length, measured};
use super::progress::Runs;
use super::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Where the traces are walked: random-M or lattice-M with M walls, rooms, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "random-500")]
    scene: String,
    #[command(flatten)]
    place: SceneArgs,
    /// The length of a step, about, in the scene's unit [default: 0.01 in random-M, 0.1 in lattice-M, 0.25 in rooms, a
    /// tenth of the mean distance between walls in files]
    #[arg(long, allow_negative_numbers = true, value_name = "LENGTH", value_parser = length)]
    step: Option<f64>,
    /// How many traces there are
    #[arg(
        long, allow_negative_numbers = true, alias = "traces", value_name = "N", default_value = "2000",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    count: u32,
    /// How many steps a trace has
    #[arg(
        long, allow_negative_numbers = true, value_name = "N", default_value = "1000",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    steps: u32,
    /// Decides where random walls lie and walks lead
    #[arg(long, allow_negative_numbers = true, value_name = "N", default_value = "1")]
    seed: u64,
    /// How often every engine runs
    #[arg(
        long, allow_negative_numbers = true, value_name = "N", default_value = "5",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    repeats: u32,
    /// About how long one run may take, in seconds; engines that need longer run on part of the work
    #[arg(long, allow_negative_numbers = true, value_name = "TIME", default_value = "1", value_parser = length)]
    seconds: f64,
    /// Only this engine; may be given several times
    #[arg(long, value_name = "ENGINE", value_parser = measured(CONTENDERS.map(|c| c.engine)))]
    engine: Vec<&'static EngineKind>,
    /// Which GPU: part of its name, its number in `tautline adapters`, or `software`
    #[arg(long, value_name = "NAME", value_parser = adapter_name)]
    adapter: Option<String>,
    /// The most steps that one query covers
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    window: Option<u32>,
    /// Measure over a range of values: vertices, traces at once, lengths of a step, or widest windows
    #[arg(long, value_enum)]
    sweep: Option<SweepName>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum SweepName {
    /// random-M from 50 to 17,353 walls, with steps as the distances between walls
    N,
    /// 1 to 4,096 traces
    Batch,
    /// 0.1 to 3 times the step
    Step,
    /// 1 to 1,024 steps
    Window,
}

impl SweepName {
    fn sweep(self) -> Sweep {
        match self {
            SweepName::N => Sweep::Vertices,
            SweepName::Batch => Sweep::Batch,
            SweepName::Step => Sweep::Step,
            SweepName::Window => Sweep::Window,
        }
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (base, sweep) = (args.setting()?, args.sweep.map(SweepName::sweep));
    let settings = match sweep {
        Some(sweep) => sweep.settings(&base)?,
        None => vec![base.clone()],
    };
    let plan = Plan { repeats: args.repeats as usize, run: Duration::from_secs_f64(args.seconds) };
    let contenders = Contender::of(&args.engine, sweep == Some(Sweep::Window));
    let needs_gpu = contenders.iter().any(Contender::needs_gpu);
    let device = device(needs_gpu, args.adapter.as_deref(), !args.engine.is_empty())?;
    let environment = Environment::here(device.as_ref().map(|d| d.summary().clone()));
    let mut bar = Runs::new();
    let measured = measure_all(&settings, &contenders, device.as_ref(), &plan, &mut |stage| match stage {
        Stage::Walking(setting) => bar.say(format!("{}: walking", setting.scene.name())),
        Stage::Runs(progress) => bar.reach(progress.done as u64, progress.total as u64, progress.contender.name()),
    })?;
    bar.finish();
    for skipped in &measured.skipped {
        say!("note: {} was left out: {}", skipped.contender, skipped.why);
    }
    if let (true, Some(first)) = (measured.rows.is_empty(), measured.skipped.first()) {
        return Err(Failure::input(anyhow!("nothing could be measured: {}", first.why)));
    }
    let report = Report { environment, sweep, base, plan, measured };
    if args.json { print_json(&Document::from(&report)) } else { print(&report.to_string()) }
}

impl Args {
    fn setting(&self) -> Result<Setting, Failure> {
        let scene = self.place.open(&self.scene)?;
        Ok(Setting {
            step: self.step.unwrap_or_else(|| scene.step()),
            scene,
            steps: self.steps as usize,
            traces: u64::from(self.count),
            seed: self.seed,
            window: self.window.map_or(WINDOW, |w| w as usize),
        })
    }
}

/// Results that are wrong are this program's fault.
impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Engine(error) => error.into(),
            BenchError::Anchor(error) => error.into(),
            BenchError::Disagreement(_) | BenchError::Violation(_) => Failure::internal(error.into()),
        }
    }
}
