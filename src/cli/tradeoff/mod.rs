//! `tautline tradeoff`.

mod json;
mod table;

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::anyhow;
use glam::DVec2;
use tautline::engine::{EngineKind, WINDOW};
use tautline::environment::Environment;
use tautline::example::{Walker, walks};
use tautline::gpu::Device;
use tautline::lab::bench::{BenchScene, Gear, Plan};
use tautline::lab::tradeoff::{Method, Setting, Tradeoff, TradeoffError, Wanted, Work, tradeoff};
use tautline::output::{WholeFile, check_place};
use tautline::picture;
use tautline::trace::{Trace, read_traces};

use super::bench::{length, open_device};
use super::engine::measured;
use super::failure::Failure;
use super::input::FileArgs;
use super::look::write_whole;
use super::parse::{above_zero, point, stride};
use super::paths::keep_apart;
use super::progress::Runs;
use super::{named_scene, print, print_json};

/// The seed of built-in walks and scenes unless told otherwise.
const SEED: u64 = 1;

/// How many random walks there are unless told otherwise.
const COUNT: u32 = 10_000;

/// Of how many points one is used, unless told otherwise.
const STRIDES: [u32; 4] = [2, 4, 8, 16];

/// By how much walls are simplified unless told otherwise, in steps of the walks that suit the scene.
const TOLERANCES: [f64; 3] = [0.5, 2.0, 8.0];

/// How wide the diagram is as PNG, in pixels.
const WIDTH: u32 = 1920;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Where the traces are: rooms, random-M or lattice-M with M walls, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "rooms")]
    scene: String,
    /// Where the rope is tied in a scene file; overrides what the file says
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    anchor: Option<DVec2>,
    #[command(flatten)]
    file: FileArgs,
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
    #[arg(long, value_name = "NAME")]
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
    let diagram = args.out.as_deref().map(Diagram::new).transpose()?;
    let scene = named_scene::open(&args.scene, args.anchor, &args.file)?;
    let methods = args.methods();
    let device = args.device(&methods)?;
    let work = args.work(&scene)?;
    let wanted = Wanted { methods, settings: args.settings(&scene) };
    let environment = Environment::here(device.as_ref().map(|d| d.summary().clone()));
    let measured = args.measure(&work, &wanted, device)?;
    if let (true, Some(first)) = (measured.points.is_empty(), measured.failed.first()) {
        return Err(Failure::input(anyhow!("nothing could be measured: {}", first.why)));
    }
    if let Some(diagram) = &diagram {
        diagram.write(&measured)?;
    }
    if args.json {
        print_json(&json::report(&environment, args.seed(), &measured))
    } else {
        print(&table::report(&environment, args.repeats, &measured, diagram.is_none()))
    }
}

impl Args {
    fn seed(&self) -> u64 {
        self.seed.unwrap_or(SEED)
    }

    fn methods(&self) -> Vec<Method> {
        let asked = |m: &Method| self.engine.is_empty() || self.engine.contains(&m.engine());
        Method::ALL.into_iter().filter(asked).collect()
    }

    fn device(&self, methods: &[Method]) -> Result<Option<Device>, Failure> {
        match methods.iter().any(Method::needs_gpu) {
            true => open_device(self.adapter.as_deref(), !self.engine.is_empty()),
            false if self.adapter.is_some() => Err(Failure::input(anyhow!("--adapter goes with --engine gpu"))),
            false => Ok(None),
        }
    }

    fn settings(&self, scene: &BenchScene) -> Vec<Setting> {
        let strides = self.stride.clone().unwrap_or_else(|| STRIDES.into());
        let usual = || TOLERANCES.map(|steps| round(steps * self.step.unwrap_or_else(|| scene.step()))).into();
        let tolerances: Vec<f64> = self.simplify.clone().unwrap_or_else(usual);
        let all = strides
            .into_iter()
            .map(|k| Setting::Stride(k as usize))
            .chain(tolerances.into_iter().map(Setting::Simplify));
        let mut settings = vec![Setting::EXACT];
        for setting in all {
            if !settings.contains(&setting) {
                settings.push(setting);
            }
        }
        settings
    }

    fn work(&self, scene: &BenchScene) -> Result<Work, Failure> {
        let model = scene.model(self.seed())?;
        let traces = match &self.traces {
            None => {
                let (step, steps) = (self.step.unwrap_or_else(|| scene.step()), self.steps.unwrap_or(500) as usize);
                walks(&model, Walker { step, steps, seed: self.seed() }, self.count.unwrap_or(COUNT).into())
            }
            Some(path) => self.given(path)?,
        };
        Ok(Work { scene: scene.name(), model, traces })
    }

    /// The traces of a file.
    fn given(&self, path: &Path) -> Result<Vec<Trace>, Failure> {
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
        let traces = read_traces(path)?;
        let shown = path.display();
        if traces.is_empty() {
            return Err(Failure::input(anyhow!("{shown}: there are no traces in it")));
        }
        if traces.iter().all(|trace| trace.points.len() == 1) {
            return Err(Failure::input(anyhow!("{shown}: no trace has a step, so there is none to be timed")));
        }
        Ok(traces)
    }

    /// Measures, with its progress on stderr.
    fn measure(&self, work: &Work, wanted: &Wanted, device: Option<Device>) -> Result<Tradeoff, Failure> {
        let gear = Gear { device, window: WINDOW };
        let plan = Plan { repeats: self.repeats as usize, run: Duration::from_secs_f64(self.seconds) };
        let mut bar = Runs::new();
        bar.say("checking traces, simplifying walls".to_owned());
        let measured = tradeoff(work, wanted, &gear, &plan, &mut |progress| {
            let next = progress.next.map(|(method, setting)| format!("{}, {setting}", method.name));
            let next = next.unwrap_or_else(|| "checking traces, simplifying walls".to_owned());
            bar.reach(progress.done as u64, progress.total as u64, next);
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

/// To one digit, 1, 2 or 5.
fn round(x: f64) -> f64 {
    let tens = 10f64.powf(x.log10().floor());
    let unit = [1.0, 2.0, 5.0, 10.0].into_iter().min_by(|a, b| (a - x / tens).abs().total_cmp(&(b - x / tens).abs()));
    // By way of text, so that it is the number that its digits say.
    format!("{:e}", unit.unwrap_or(1.0) * tens).parse().unwrap_or(x)
}

/// Where the diagram goes.
struct Diagram {
    path: PathBuf,
    is_png: bool,
}

impl Diagram {
    /// Checks, before anything is measured, that the file can be written. Leaves nothing behind.
    fn new(path: &Path) -> Result<Self, Failure> {
        check_place(path)?;
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let is_png = match extension.as_str() {
            "svg" => false,
            "png" => true,
            _ => {
                let shown = path.display();
                return Err(Failure::input(anyhow!("{shown}: diagrams are drawn as .svg or .png")));
            }
        };
        WholeFile::create(path).map(drop)?;
        Ok(Diagram { path: path.to_owned(), is_png })
    }

    fn write(&self, measured: &Tradeoff) -> Result<(), Failure> {
        let svg = picture::tradeoff(measured);
        let bytes = match self.is_png {
            true => picture::png(&svg, WIDTH).map_err(|e| Failure::internal(e.into()))?,
            false => svg.into_bytes(),
        };
        write_whole(&self.path, &bytes)?;
        say!("wrote {}", self.path.display());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn tolerances_are_round() {
        let rounded = [0.005, 0.02, 0.43, 1.7, 6.9, 8.0, 96.0, 1e-9].map(round);
        assert_eq!(rounded, [0.005, 0.02, 0.5, 2.0, 5.0, 10.0, 100.0, 1e-9]);
    }
}
