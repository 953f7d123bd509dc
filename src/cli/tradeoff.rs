//! `tautline tradeoff`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::anyhow;
use tautline::engine::{EngineKind, WINDOW};
use tautline::environment::Environment;
use tautline::example::Walker;
use tautline::gpu::Device;
use tautline::lab::bench::{BenchScene, Gear, Plan};
use tautline::lab::tradeoff::{Document, Method, Report, Setting, Tradeoff, TradeoffError, Wanted, Work, tradeoff};
use tautline::picture;

use super::engine::adapter_name;
use super::failure::Failure;
use super::look::Target;
use super::measured::{SceneArgs, device, length, measured};
use super::parse::{above_zero, stride};
use super::paths::keep_apart;
use super::progress::Runs;
use super::{print, print_json};

/// The seed of built-in walks and scenes unless told otherwise.
const SEED: u64 = 1;

/// How many random walks there are unless told otherwise, and how many steps they have.
const COUNT: u32 = 10_000;
const STEPS: u32 = 500;

/// How wide the diagram is as PNG, in pixels.
const WIDTH: u32 = 1920;

/// What is said while nothing is measured yet.
const PREPARING: &str = "checking traces, simplifying walls";

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Where the traces are: rooms, random-M or lattice-M with M walls, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "rooms")]
    scene: String,
    #[command(flatten)]
    place: SceneArgs,
    /// The traces: .csv or .parquet [default: random walks]
    #[arg(long, value_name = "FILE")]
    traces: Option<PathBuf>,
    /// How many random walks there are without traces [default: 10000]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    count: Option<u32>,
    /// How many steps a random walk has [default: 500]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// The length of a step of random walks, about, in the scene's unit [default: as of `tautline bench`]
    #[arg(long, allow_negative_numbers = true, value_name = "LENGTH", value_parser = length)]
    step: Option<f64>,
    /// Decides where random walls lie and walks lead [default: 1]
    #[arg(long, allow_negative_numbers = true, value_name = "N")]
    seed: Option<u64>,
    /// Use every K-th point of a trace; several with commas between them [default: 2,4,8,16]
    #[arg(long, allow_negative_numbers = true, value_name = "K", value_delimiter = ',', value_parser = stride)]
    stride: Option<Vec<u32>>,
    /// Simplify walls by at most TOL; several with commas between them [default: half, 2 and 8 steps]
    #[arg(long, allow_negative_numbers = true, value_name = "TOL", value_delimiter = ',', value_parser = above_zero)]
    simplify: Option<Vec<f64>>,
    /// Only this engine's methods; may be given several times
    #[arg(long, value_name = "ENGINE", value_parser = measured(Method::ALL.map(|m| m.engine())))]
    engine: Vec<&'static EngineKind>,
    /// Which GPU: part of its name, its number in `tautline adapters`, or `software`
    #[arg(long, value_name = "NAME", value_parser = adapter_name)]
    adapter: Option<String>,
    /// How often every method runs at every setting
    #[arg(
        long, allow_negative_numbers = true, value_name = "N", default_value = "3",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    repeats: u32,
    /// About how long one run may take, in seconds; what takes longer runs on the first traces, one at least
    #[arg(long, allow_negative_numbers = true, value_name = "TIME", default_value = "1", value_parser = length)]
    seconds: f64,
    /// Where to draw the diagram: .svg or .png
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let inputs = [("--scene", Some(Path::new(&args.scene))), ("--traces", args.traces.as_deref())];
    keep_apart(&inputs, &[("--out", args.out.as_deref())])?;
    let diagram =
        args.out.as_deref().map(|path| Target::still(path, "diagrams are drawn as .svg or .png")).transpose()?;
    let scene = args.place.open(&args.scene)?;
    let methods = Method::of(&args.engine);
    let needs_gpu = methods.iter().any(Method::needs_gpu);
    let device = device(needs_gpu, args.adapter.as_deref(), !args.engine.is_empty())?;
    let work = args.work(&scene)?;
    let step = args.step.unwrap_or_else(|| scene.step());
    let wanted = Wanted { methods, settings: Setting::all(args.stride.as_deref(), args.simplify.as_deref(), step) };
    let environment = Environment::here(device.as_ref().map(|d| d.summary().clone()));
    let measured = args.measure(&work, &wanted, device)?;
    if let (true, Some(first)) = (measured.points.is_empty(), measured.failed.first()) {
        return Err(Failure::input(anyhow!("nothing could be measured: {}", first.why)));
    }
    if let Some(diagram) = &diagram {
        diagram.save(picture::tradeoff(&measured), WIDTH)?;
        say!("wrote {}", diagram.shown());
    }
    let report = Report { environment, seed: args.seed(), repeats: args.repeats as usize, measured };
    if args.json {
        return print_json(&Document::from(&report));
    }
    print(&format!("{report}{}", if diagram.is_none() { "\n--out FILE draws the diagram\n" } else { "" }))
}

impl Args {
    fn seed(&self) -> u64 {
        self.seed.unwrap_or(SEED)
    }

    fn work(&self, scene: &BenchScene) -> Result<Work, Failure> {
        let Some(path) = &self.traces else {
            let (step, steps) = (self.step.unwrap_or_else(|| scene.step()), self.steps.unwrap_or(STEPS) as usize);
            let walker = Walker { step, steps, seed: self.seed() };
            return Work::walked(scene, walker, self.count.unwrap_or(COUNT).into())
                .map_err(|e| Failure::input(e.into()));
        };
        let walked = [
            self.count.map(|_| "--count"),
            self.steps.map(|_| "--steps"),
            self.step.map(|_| "--step"),
            self.seed.map(|_| "--seed"),
        ];
        if let Some(option) = walked.into_iter().flatten().next() {
            let what = "says how random walks are walked; the traces of a file are taken as they are";
            return Err(Failure::input(anyhow!("{option} {what}")));
        }
        if !path.exists()
            && let Ok(count) = path.to_string_lossy().parse::<u64>()
        {
            return Err(Failure::input(anyhow!(
                "--traces {count}: give a file of traces; how many random walks there are says --count {count}"
            )));
        }
        Ok(Work::given(scene, self.seed(), path)?)
    }

    /// Measures, with its progress on stderr.
    fn measure(&self, work: &Work, wanted: &Wanted, device: Option<Device>) -> Result<Tradeoff, Failure> {
        let gear = Gear { device, window: WINDOW };
        let plan = Plan { repeats: self.repeats as usize, run: Duration::from_secs_f64(self.seconds) };
        let mut bar = Runs::new();
        bar.say(PREPARING.to_owned());
        let measured = tradeoff(work, wanted, &gear, &plan, &mut |progress| {
            let next = progress.next.map(|(method, setting)| format!("{}, {setting}", method.name));
            bar.reach(progress.done as u64, progress.total as u64, next.unwrap_or_else(|| PREPARING.to_owned()));
        });
        bar.finish();
        measured.map_err(|error| match error {
            TradeoffError::Engine(error) => error.into(),
            TradeoffError::Violation(violation) => {
                let file = self.traces.iter().map(|path| format!("{}: ", path.display())).collect::<String>();
                Failure::input(anyhow!("{file}{violation}"))
            }
            TradeoffError::Disagreement(_) => Failure::internal(error.into()),
        })
    }
}
