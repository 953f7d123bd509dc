//! Choosing what computes the ropes.

use std::sync::Arc;

use anyhow::anyhow;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use tautline::engine::{
    CPU, ENGINES, Engine, EngineError, EngineKind, GPU, Opened, Options, Precision, RunsOn, Why, open_best,
};
use tautline::gpu::{AdapterChoice, Device, GpuError, driver_faults};
use tautline::scene::Model;

use super::failure::Failure;
use super::parse::memory;

/// What computes the ropes, and on what.
#[derive(Debug, clap::Args)]
pub(crate) struct EngineArgs {
    /// What computes the ropes
    #[arg(long, value_parser = names(|_| false), default_value = AUTO)]
    engine: EngineName,
    /// Which GPU: part of its name, its number in `tautline adapters`, or `software`; implies `--engine gpu`
    #[arg(long, value_name = "NAME", value_parser = adapter_name)]
    adapter: Option<String>,
    /// Whether exact signs decide, or f32 alone; `fast` implies `--engine gpu` [default: certified]
    #[arg(long, value_enum, value_name = "PRECISION")]
    precision: Option<PrecisionName>,
    /// How much of a GPU's memory the traces take at once at most, such as 512M or 2G [default: see `tautline
    /// adapters`]
    #[arg(long, value_name = "SIZE", value_parser = memory)]
    gpu_memory: Option<usize>,
}

/// The engine asked for; `None` for the one that suits the machine.
#[derive(Debug, Clone, Copy)]
struct EngineName(Option<&'static EngineKind>);

/// What stands for the engine that suits the machine.
const AUTO: &str = "auto";

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum PrecisionName {
    /// Every rope is right
    Certified,
    /// The GPU decides in f32 and nothing confirms it: ropes can be wrong
    Fast,
}

/// Takes the names of all engines, and `auto`; offers those of which `is_hidden` does not hold.
fn names(is_hidden: fn(&EngineKind) -> bool) -> impl TypedValueParser<Value = EngineName> {
    let auto = PossibleValue::new(AUTO).help("`gpu` on a real GPU, else `cpu`");
    let named = ENGINES.map(|kind| PossibleValue::new(kind.name).help(kind.about).hide(is_hidden(kind)));
    PossibleValuesParser::new([auto].into_iter().chain(named)).map(|name| EngineName(EngineKind::named(&name)))
}

/// The engines that an answer can be computed with: those that count the same events. The others are not offered; given
/// all the same, they are [refused](super::study) with the reason.
pub(super) fn of_studies(arg: clap::Arg) -> clap::Arg {
    arg.value_parser(names(|kind| !kind.counts_events()))
}

impl EngineArgs {
    /// The precision asked for, if one was.
    pub(crate) fn precision(&self) -> Option<Precision> {
        self.precision.map(|precision| match precision {
            PrecisionName::Certified => Precision::Certified,
            PrecisionName::Fast => Precision::Fast,
        })
    }

    /// Opens the engine asked for, and tells in words what it runs on; says on stderr what was chosen where there was a
    /// choice.
    pub(crate) fn open(&self, model: &Arc<Model>) -> Result<(Box<dyn Engine>, String), Failure> {
        let opened = self.open_for(self.precision().unwrap_or_default(), model)?;
        Ok((opened.engine, opened.on.to_string()))
    }

    /// Opens the engine asked for, for ropes whose ends both move; `cpu` unless told otherwise.
    pub(crate) fn open_both_ends(&self, model: &Arc<Model>) -> Result<(Box<dyn Engine>, String), Failure> {
        let kind = match self.engine.0 {
            None if self.adapter.is_some() || self.precision() == Some(Precision::Fast) => &GPU,
            asked => asked.unwrap_or(&CPU),
        };
        if !kind.both_ends {
            return Err(EngineError::TwoEnds { engine: kind.name }.into());
        }
        self.check(self.precision().unwrap_or_default())?;
        let opened = kind.open(model.clone(), None, &Options::default())?;
        Ok((opened.engine, opened.on.to_string()))
    }

    /// Refuses what does not go together, with that precision.
    pub(crate) fn check(&self, precision: Precision) -> Result<(), Failure> {
        let EngineName(Some(kind)) = self.engine else { return Ok(()) };
        if self.adapter.is_some() && !kind.needs_gpu() {
            return Err(Failure::input(anyhow!("--adapter goes with --engine gpu or auto")));
        }
        if self.gpu_memory.is_some() && !kind.needs_gpu() {
            return Err(Failure::input(anyhow!("--gpu-memory goes with --engine gpu or auto")));
        }
        if !kind.takes(precision) {
            return Err(Failure::input(anyhow!(
                "precision fast is one of the engine gpu: give --engine gpu or auto with it, or take precision \
                 certified"
            )));
        }
        Ok(())
    }

    /// Opens the engine asked for, with a precision that was settled elsewhere.
    pub(crate) fn open_for(&self, precision: Precision, model: &Arc<Model>) -> Result<Opened, Failure> {
        self.check(precision)?;
        let options = Options { precision, memory: self.gpu_memory, ..Options::default() };
        let choice = self.adapter.as_deref().map_or(AdapterChoice::Best, named);
        let opened = match (self.engine.0, &self.adapter) {
            (None, None) => open_best(model.clone(), &options)?,
            (kind, _) => {
                let kind = kind.unwrap_or(&GPU);
                let device = kind.needs_gpu().then(|| Device::open(&choice)).transpose()?;
                kind.open(model.clone(), device, &options)?
            }
        };
        if let Why::NoRealGpu(error) = &opened.why {
            let why = match error {
                EngineError::Gpu(GpuError::NoAdapter { .. } | GpuError::NoDeviceFile) => {
                    let faults = driver_faults().into_iter().map(|fault| format!(", and {fault}"));
                    "there is no real GPU here".to_owned() + &faults.collect::<String>()
                }
                other => other.to_string(),
            };
            say!("engine: {}, since {why} (`tautline adapters` lists what there is)", opened.kind.name);
        }
        if let RunsOn::Device(device) = &opened.on {
            say!("engine: {} on {}", opened.kind.name, opened.on);
            notes(&choice, device).iter().for_each(|note| say!("{note}"));
            if precision == Precision::Fast {
                say!("note: precision fast: f32 decides alone, so ropes can be wrong");
            }
        }
        Ok(opened)
    }
}

/// What names an adapter: nothing at all would be in every name.
pub(super) fn adapter_name(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => {
            Err("give part of an adapter's name or its number, as `tautline adapters` lists them, or software".into())
        }
        _ => Ok(text.to_owned()),
    }
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
                "note: {words:?} is in the names of other adapters too; this is number {}, and --adapter with its \
                 number takes {}",
                taken.number,
                others.join("; ")
            ));
        }
        _ => {}
    }
    notes
}
