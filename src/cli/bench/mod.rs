//! `tautline bench`.

pub(super) mod json;
pub(super) mod table;

use std::time::Duration;

use anyhow::anyhow;
use glam::DVec2;
use tautline::engine::{EngineKind, WINDOW};
use tautline::environment::Environment;
use tautline::gpu::{AdapterChoice, Device};
use tautline::lab::bench::{BenchError, CONTENDERS, Contender, Gear, Measured, Plan, Setting, Sweep, measure};

use super::engine::{measured, named, notes};
use super::failure::Failure;
use super::input::FileArgs;
use super::parse::point;
use super::progress::Runs;
use super::{named_scene, print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Where the traces are walked: random-M or lattice-M with M walls, rooms, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "random-500")]
    scene: String,
    /// Where the rope is tied in a scene file; overrides what the file says
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    anchor: Option<DVec2>,
    #[command(flatten)]
    file: FileArgs,
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
    #[arg(long, value_name = "NAME")]
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

/// A number above 0, neither so large nor so small that no clock and no walk could make anything of it.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| (1e-9..=1e9).contains(x));
    number.ok_or_else(|| "give a number from 1e-9 to 1e9, such as 0.01".to_owned())
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let base = args.setting()?;
    let sweep = args.sweep.map(SweepName::sweep);
    let settings = match sweep {
        Some(sweep) => sweep.settings(&base).map_err(|e| Failure::input(e.into()))?,
        None => vec![base.clone()],
    };
    let contenders = args.contenders();
    let device = args.device(&contenders)?;
    let environment = Environment::here(device.as_ref().map(|d| d.summary().clone()));
    let measured = measure_all(&settings, &contenders, device.as_ref(), &args.plan())?;
    for skipped in &measured.skipped {
        say!("note: {} was left out: {}", skipped.contender, skipped.why);
    }
    if let (true, Some(first)) = (measured.rows.is_empty(), measured.skipped.first()) {
        return Err(Failure::input(anyhow!("nothing could be measured: {}", first.why)));
    }
    match (args.json, sweep) {
        (true, _) => print_json(&json::report(&environment, args.seed, &measured)),
        (false, Some(sweep)) => print(&table::sweep(&environment, sweep, &base, &args.plan(), &measured.rows)),
        (false, None) => print(&table::bench(&environment, &base, &args.plan(), &measured.rows)),
    }
}

/// Measures every setting after the other, with its progress on stderr.
fn measure_all(
    settings: &[Setting],
    contenders: &[Contender],
    device: Option<&Device>,
    plan: &Plan,
) -> Result<Measured, Failure> {
    let mut bar = Runs::new();
    let mut all = Measured::default();
    for (i, setting) in settings.iter().enumerate() {
        bar.say(format!("{}: walking", setting.scene.name()));
        let work = setting.work().map_err(failure)?;
        let gear = Gear { device: device.cloned(), window: setting.window };
        let measured = measure(&work, contenders, &gear, plan, &mut |progress| {
            bar.reach(
                (i * progress.total + progress.done) as u64,
                (settings.len() * progress.total) as u64,
                progress.contender.name(),
            );
        });
        let measured = measured.map_err(failure)?;
        all.rows.extend(measured.rows);
        let new: Vec<_> = measured.skipped.into_iter().filter(|s| !all.skipped.contains(s)).collect();
        all.skipped.extend(new);
    }
    bar.finish();
    Ok(all)
}

/// What a failed bench ends the program with. Results that are wrong are this program's fault.
fn failure(error: BenchError) -> Failure {
    match error {
        BenchError::Engine(error) => error.into(),
        BenchError::Anchor(error) => error.into(),
        BenchError::Disagreement(_) | BenchError::Violation(_) => Failure::internal(error.into()),
    }
}

impl Args {
    fn setting(&self) -> Result<Setting, Failure> {
        let scene = named_scene::open(&self.scene, self.anchor, &self.file)?;
        Ok(Setting {
            step: self.step.unwrap_or_else(|| scene.step()),
            scene,
            steps: self.steps as usize,
            traces: u64::from(self.count),
            seed: self.seed,
            window: self.window.map_or(WINDOW, |w| w as usize),
        })
    }

    fn plan(&self) -> Plan {
        Plan { repeats: self.repeats as usize, run: Duration::from_secs_f64(self.seconds) }
    }

    /// Those asked for. A sweep over windows is for those that have them, beside the baseline.
    fn contenders(&self) -> Vec<Contender> {
        let wanted = |c: &Contender| {
            let asked = self.engine.is_empty() || self.engine.contains(&c.engine);
            asked && (self.sweep != Some(SweepName::Window) || c.is_windowed() || c.is_baseline())
        };
        CONTENDERS.into_iter().filter(wanted).collect()
    }

    /// The GPU, where one is needed.
    fn device(&self, contenders: &[Contender]) -> Result<Option<Device>, Failure> {
        if !contenders.iter().any(Contender::needs_gpu) {
            return match self.adapter {
                Some(_) => Err(Failure::input(anyhow!("--adapter goes with --engine gpu"))),
                None => Ok(None),
            };
        }
        open_device(self.adapter.as_deref(), !self.engine.is_empty())
    }
}

/// The GPU called `adapter`, else the best. One that nobody asked for may be missing.
pub(super) fn open_device(adapter: Option<&str>, is_asked_for: bool) -> Result<Option<Device>, Failure> {
    let choice = adapter.map_or(AdapterChoice::Best, named);
    match Device::open(&choice) {
        Ok(device) => {
            say!("engine: gpu on {}", device.summary());
            notes(&choice, &device).iter().for_each(|note| say!("{note}"));
            Ok(Some(device))
        }
        Err(error) if adapter.is_some() || is_asked_for => Err(error.into()),
        Err(error) => {
            say!("note: {error}");
            Ok(None)
        }
    }
}
