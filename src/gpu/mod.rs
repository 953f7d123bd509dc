//! The GPU: adapters, and the kernels in `shaders/`.

mod adapter;
mod arithmetic;
mod buffers;
mod device;
mod drag;
mod drivers;
mod error;
mod kernel;
mod lane;
mod nodes;
mod once;
mod pages;
mod pass;
mod peak;
mod probe;
mod sample;
mod shapes;
mod tuning;

pub use adapter::{AdapterChoice, AdapterKind, AdapterSummary, SOFTWARE_HINT, adapters};
pub use arithmetic::Arithmetic;
pub use device::{Device, open_all};
pub use drag::{CHUNK, DRAG_WGSL, DragPass};
pub use drivers::driver_faults;
pub use error::GpuError;
pub use kernel::{DECIDE_WGSL, Deciding, Kernel, RAYS_WGSL, SWEEP_WGSL, Sweeping, TryingAll};
pub use lane::{DONE, Head, Lane, NOTES, Note, RIGHT, RUNS, Ray, Room, STACK, STOPPED, Stacked, UNKNOWN, UNWRAPPED};
pub use pass::{GpuPass, HALVES};
pub use peak::PEAK_WGSL;
pub use probe::PROBE_WGSL;
pub use shapes::Computed;
pub use tuning::Tuning;
