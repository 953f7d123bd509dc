//! Choosing what computes the ropes.

use anyhow::anyhow;
use clap::ValueEnum;
use tautline::engine::{Cpu, Engine, FastGpu, Funnel, Gpu, Note, Precision, Reference, WINDOW};
use tautline::gpu::{AdapterChoice, Device, GpuError, driver_faults};
use tautline::scene::Model;

use super::failure::Failure;

/// What computes the ropes, and on what.
#[derive(Debug, clap::Args)]
pub(crate) struct EngineArgs {
    /// What computes the ropes
    #[arg(long, value_enum, default_value = "auto")]
    engine: EngineName,
    /// Which GPU: part of its name, its number in `tautline adapters`, or `software`; implies `--engine gpu`
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Whether exact signs decide, or f32 alone; `fast` implies `--engine gpu` [default: certified]
    #[arg(long, value_enum, value_name = "PRECISION")]
    precision: Option<PrecisionName>,
    /// The most steps that one query covers; no certified result depends on it
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    window: Option<u32>,
    /// Try all wall ends in every query, not only those that the pivot sees and a rope can turn at; no certified result
    /// depends on it
    #[arg(long)]
    keep_all: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum EngineName {
    /// `gpu` on a real GPU, else `cpu`
    Auto,
    /// A compute shader finds candidates for many traces at once, the CPU decides exactly
    Gpu,
    /// The same on threads
    Cpu,
    /// One trace and one step after the other, every vertex tried: the arbiter
    Reference,
    /// Another method: triangulation, crossing word, funnel
    Funnel,
    /// The seed note's listing 1, as written: wrong on purpose, for comparison
    Note,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum PrecisionName {
    /// Every rope is right
    Certified,
    /// The GPU decides in f32 and nothing confirms it: ropes can be wrong
    Fast,
}

/// The engines that an answer can be computed with: those that count the same events. The others are not offered; given all
/// the same, they are [refused](super::study) with the reason.
pub(super) fn of_studies(arg: clap::Arg) -> clap::Arg {
    use clap::builder::{PossibleValuesParser, TypedValueParser};
    let offered = EngineName::value_variants().iter().filter_map(|name| {
        let is_hidden = matches!(name, EngineName::Funnel | EngineName::Note);
        Some(name.to_possible_value()?.hide(is_hidden))
    });
    let named = |name: String| EngineName::from_str(&name, false).expect("only names of engines are taken");
    arg.value_parser(PossibleValuesParser::new(offered).map(named))
}

/// An engine, and in words what it runs on.
type Opened<'m> = (Box<dyn Engine + 'm>, String);

impl EngineArgs {
    /// The precision asked for, if one was.
    pub(crate) fn precision(&self) -> Option<Precision> {
        self.precision.map(|precision| match precision {
            PrecisionName::Certified => Precision::Certified,
            PrecisionName::Fast => Precision::Fast,
        })
    }

    /// Opens the engine asked for; says on stderr what was chosen where there was a choice.
    pub(crate) fn open<'m>(&self, model: &'m Model) -> Result<Opened<'m>, Failure> {
        self.open_for(self.precision().unwrap_or_default(), model)
    }

    /// Refuses what does not go together, with that precision.
    pub(crate) fn check(&self, precision: Precision) -> Result<(), Failure> {
        let takes_gpu = matches!(self.engine, EngineName::Gpu | EngineName::Auto);
        if self.adapter.is_some() && !takes_gpu {
            return Err(Failure::input(anyhow!("--adapter goes with --engine gpu or auto")));
        }
        if precision == Precision::Fast && !takes_gpu {
            return Err(Failure::input(anyhow!(
                "precision fast is one of the engine gpu: give --engine gpu or auto with it, or take precision certified"
            )));
        }
        Ok(())
    }

    /// Opens the engine asked for, with a precision that was settled elsewhere.
    pub(crate) fn open_for<'m>(&self, precision: Precision, model: &'m Model) -> Result<Opened<'m>, Failure> {
        self.check(precision)?;
        let one_thread = || "one thread".to_owned();
        match (self.engine, &self.adapter) {
            (_, Some(name)) => Ok(self.gpu(&named(name), precision, model)?),
            (EngineName::Gpu, None) => Ok(self.gpu(&AdapterChoice::Best, precision, model)?),
            (EngineName::Auto, None) if precision == Precision::Fast => {
                Ok(self.gpu(&AdapterChoice::Best, precision, model)?)
            }
            (EngineName::Auto, None) => Ok(self.gpu(&AdapterChoice::Real, precision, model).unwrap_or_else(|error| {
                let why = match error {
                    GpuError::NoAdapter { .. } => {
                        let faults = driver_faults().into_iter().map(|fault| format!(", and {fault}"));
                        "there is no real GPU here".to_owned() + &faults.collect::<String>()
                    }
                    other => other.to_string(),
                };
                say!("engine: cpu, since {why} (`tautline adapters` lists what there is)");
                self.cpu(model)
            })),
            (EngineName::Cpu, None) => Ok(self.cpu(model)),
            (EngineName::Reference, None) => Ok((Box::new(Reference::new(model)), one_thread())),
            (EngineName::Funnel, None) => Ok((Box::new(Funnel::new(model)), threads())),
            (EngineName::Note, None) => Ok((Box::new(Note::new(model)), one_thread())),
        }
    }

    fn gpu<'m>(&self, choice: &AdapterChoice, precision: Precision, model: &'m Model) -> Result<Opened<'m>, GpuError> {
        let device = Device::open(choice)?;
        let on = device.summary().to_string();
        let notes = notes(choice, &device);
        let engine: Box<dyn Engine> = match (precision, self.keep_all) {
            (Precision::Certified, false) => Box::new(Gpu::new(device, model)?.window(self.window())),
            (Precision::Certified, true) => Box::new(Gpu::new(device, model)?.window(self.window()).keep_all()),
            (Precision::Fast, false) => Box::new(FastGpu::new(device, model)?.window(self.window())),
            (Precision::Fast, true) => Box::new(FastGpu::new(device, model)?.window(self.window()).keep_all()),
        };
        say!("engine: gpu on {on}");
        notes.iter().for_each(|note| say!("{note}"));
        if precision == Precision::Fast {
            say!("note: precision fast: f32 decides alone, so ropes can be wrong");
        }
        Ok((engine, on))
    }

    fn cpu<'m>(&self, model: &'m Model) -> Opened<'m> {
        let mut engine = Cpu::new(model).window(self.window());
        if self.keep_all {
            engine = engine.keep_all();
        }
        (Box::new(engine), threads())
    }

    fn window(&self) -> usize {
        self.window.map_or(WINDOW, |w| w as usize)
    }
}

fn threads() -> String {
    format!("{} threads", rayon::current_num_threads())
}

/// The adapter that `--adapter` means.
pub(super) fn named(adapter: &str) -> AdapterChoice {
    if adapter == "software" { AdapterChoice::Software } else { AdapterChoice::Named(adapter.to_owned()) }
}

/// What to say of the device that was taken: where another was meant, perhaps.
pub(super) fn notes(choice: &AdapterChoice, device: &Device) -> Vec<String> {
    let taken = device.summary();
    let mut notes: Vec<String> = driver_faults().into_iter().map(|fault| format!("warning: {fault}")).collect();
    match choice {
        AdapterChoice::Software if !taken.is_lavapipe() => {
            notes.push(format!("note: Mesa's lavapipe is not here, so the software adapter is {}", taken.name))
        }
        AdapterChoice::Named(words) if !device.passed_over().is_empty() => {
            let others: Vec<String> = device.passed_over().iter().map(|a| format!("{}: {a}", a.number)).collect();
            notes.push(format!(
                "note: {words:?} is in the names of other adapters too; this is number {}, and --adapter with its number takes \
                 {}",
                taken.number,
                others.join("; ")
            ));
        }
        _ => {}
    }
    notes
}
