//! Choosing what computes the ropes.

use anyhow::anyhow;
use tautline::engine::{Cpu, Engine, Funnel, Gpu, Note, Reference, WINDOW};
use tautline::gpu::{AdapterChoice, Device, GpuError};
use tautline::scene::Model;

use super::failure::Failure;

/// What computes the ropes, and on what.
#[derive(Debug, clap::Args)]
pub(crate) struct EngineArgs {
    /// What computes the ropes
    #[arg(long, value_enum, default_value = "auto")]
    engine: EngineName,
    /// Which GPU: part of its name, or `software`; implies `--engine gpu`
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// The most steps that one query covers; no result depends on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    window: Option<u32>,
    /// Try all wall ends in every query, not only those that the pivot sees; no result depends on it
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

/// An engine, and in words what it runs on.
type Opened<'m> = (Box<dyn Engine + 'm>, String);

impl EngineArgs {
    /// Opens the engine asked for; says on stderr what was chosen where there was a choice.
    pub(crate) fn open<'m>(&self, model: &'m Model) -> Result<Opened<'m>, Failure> {
        let one_thread = || "one thread".to_owned();
        match (self.engine, &self.adapter) {
            (EngineName::Gpu, None) => Ok(self.gpu(&AdapterChoice::Best, model)?),
            (EngineName::Gpu | EngineName::Auto, Some(name)) => Ok(self.gpu(&named(name), model)?),
            (_, Some(_)) => Err(Failure::input(anyhow!("--adapter goes with --engine gpu or auto"))),
            (EngineName::Auto, None) => Ok(self.gpu(&AdapterChoice::Real, model).unwrap_or_else(|error| {
                let why = match error {
                    GpuError::NoAdapter { .. } => "there is no real GPU here".to_owned(),
                    other => other.to_string(),
                };
                eprintln!("engine: cpu, since {why} (`tautline adapters` lists what there is)");
                self.cpu(model)
            })),
            (EngineName::Cpu, None) => Ok(self.cpu(model)),
            (EngineName::Reference, None) => Ok((Box::new(Reference::new(model)), one_thread())),
            (EngineName::Funnel, None) => Ok((Box::new(Funnel::new(model)), threads())),
            (EngineName::Note, None) => Ok((Box::new(Note::new(model)), one_thread())),
        }
    }

    fn gpu<'m>(&self, choice: &AdapterChoice, model: &'m Model) -> Result<Opened<'m>, GpuError> {
        let mut engine = Gpu::new(Device::open(choice)?, model)?.window(self.window());
        if self.keep_all {
            engine = engine.keep_all();
        }
        let on = engine.adapter().to_string();
        eprintln!("engine: gpu on {on}");
        Ok((Box::new(engine), on))
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
