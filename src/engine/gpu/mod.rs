//! The engines on a device. That of the product, in two precisions: a compute shader [finds](certified) candidates
//! among which the CPU decides exactly, or [decides](fast) alone. In both, traces go round after round between device
//! and CPU.

mod certified;
mod deciding;
mod fast;
mod finding;
mod rays;
mod rounds;

use self::rounds::NAME;
use super::table::Open;
use super::{EngineKind, Precision, Promise};

pub use certified::Gpu;
pub use fast::FastGpu;
pub use rays::{GPU_RAYS, GpuRays};

/// The product.
pub static GPU: EngineKind = EngineKind {
    name: NAME,
    about: "A compute shader finds candidates for many traces at once, the CPU decides exactly",
    precisions: &[Precision::Certified, Precision::Fast],
    asks: true,
    both_ends: false,
    promise: Promise::Events,
    open: Open::Device(|device, model, options| {
        Ok(match options.precision {
            Precision::Certified => Box::new(Gpu::new(device, model)?.window(options.window)),
            Precision::Fast => Box::new(FastGpu::new(device, model)?.window(options.window)),
        })
    }),
};
