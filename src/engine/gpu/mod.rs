//! The engine of the product, in two precisions: a compute shader [finds](certified) candidates among which the CPU decides
//! exactly, or [decides](fast) alone. In both, traces go round after round between device and CPU.

mod certified;
mod deciding;
mod fast;
mod finding;
mod rounds;

pub use certified::Gpu;
pub use fast::FastGpu;
