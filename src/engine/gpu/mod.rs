//! The engines on a device. That of the product, in two precisions: a compute shader [takes traces along](resident),
//! and the CPU decides what it is not certain of, or it [decides](fast) alone. Two more in which it only finds what the
//! rope can meet, in a [window](windowed) of steps or in [each](rays), and the CPU decides all.

mod deciding;
mod dragged;
mod fans;
mod fast;
mod finding;
mod rays;
mod resident;
mod rounds;
mod windowed;

use self::resident::NAME;
use super::table::Open;
use super::{EngineKind, Precision, Promise};

pub use fast::FastGpu;
pub use rays::{GPU_RAYS, GpuRays};
pub use resident::Gpu;
pub use windowed::{GPU_WINDOWS, GpuWindows};

/// The product.
pub static GPU: EngineKind = EngineKind {
    name: NAME,
    about: "A compute shader takes many traces along at once, the CPU decides what it is not certain of",
    precisions: &[Precision::Certified, Precision::Fast],
    asks: true,
    both_ends: false,
    promise: Promise::Events,
    open: Open::Device(|device, model, options| {
        Ok(match options.precision {
            Precision::Certified => Box::new(Gpu::new(device, model)?),
            Precision::Fast => Box::new(FastGpu::new(device, model)?.window(options.window)),
        })
    }),
};
