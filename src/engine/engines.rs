//! The table of engines, and how one is found in it.

use std::sync::Arc;

use super::table::{EngineKind, Opened, Options, Why};
use super::{CPU, EngineError, FUNNEL, GPU, GPU_RAYS, GPU_WINDOWS, NOTE, REFERENCE};
use crate::gpu::{AdapterChoice, Device};
use crate::scene::Model;

/// All engines, in the order in which they are offered. A new one is a file of its own, with what the table says of it,
/// and a line here; it is then known to the command line, and tested for what it promises.
pub static ENGINES: [&EngineKind; 7] = [&GPU, &CPU, &GPU_WINDOWS, &GPU_RAYS, &REFERENCE, &FUNNEL, &NOTE];

impl EngineKind {
    /// The engine called `name`.
    pub fn named(name: &str) -> Option<&'static EngineKind> {
        ENGINES.into_iter().find(|kind| kind.name == name)
    }
}

/// Opens the engine that suits the machine: `gpu` on a real GPU, else `cpu`. What `cpu` cannot do, `gpu` does on the
/// best adapter that there is.
///
/// # Errors
///
/// As [`EngineKind::open`], only with a precision that `cpu` has not.
pub fn open_best(model: Arc<Model>, options: &Options) -> Result<Opened, EngineError> {
    let gpu = |choice| GPU.open(model.clone(), Some(Device::open(&choice)?), options);
    if !CPU.takes(options.precision) {
        return gpu(AdapterChoice::Best);
    }
    match gpu(AdapterChoice::Real) {
        Ok(opened) => Ok(Opened { why: Why::RealGpu, ..opened }),
        Err(error) => Ok(Opened { why: Why::NoRealGpu(error), ..CPU.open(model, None, options)? }),
    }
}
