//! The GPU: adapters, and the kernels in `shaders/`.

mod adapter;
mod arithmetic;
mod drivers;
mod kernel;
mod pages;
mod pass;
mod shapes;
mod tuning;

pub use adapter::{AdapterChoice, AdapterKind, AdapterSummary, Device, SOFTWARE_HINT, adapters, open_all};
pub use arithmetic::{Arithmetic, PROBE_WGSL};
pub use drivers::driver_faults;
pub use kernel::{DECIDE_WGSL, Deciding, Kernel, SWEEP_WGSL, Sweeping};
pub use pass::{GpuPass, HALVES};
pub use shapes::Computed;
pub use tuning::Tuning;

/// What can go wrong with a GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter fits what was asked for.
    #[error("no {wanted} was found; this machine offers {}. {advice}{SOFTWARE_HINT}", offer(found))]
    NoAdapter {
        /// What was asked for.
        wanted: String,
        /// What there is.
        found: Vec<AdapterSummary>,
        /// What the environment has to do with it, in sentences; empty if nothing.
        advice: String,
    },
    /// The adapter lacks something that the pass needs.
    #[error("the adapter {adapter} cannot be used: {why}")]
    Unfit {
        /// Its name.
        adapter: String,
        /// What it lacks.
        why: String,
    },
    /// The device did not finish a round in time.
    #[error("the adapter {adapter} did not answer within {seconds} s")]
    Timeout {
        /// Its name.
        adapter: String,
        /// How long was waited.
        seconds: u64,
    },
    /// The device failed or was lost.
    #[error("the adapter {adapter} failed: {why}")]
    Failed {
        /// Its name.
        adapter: String,
        /// What it or its driver said.
        why: String,
    },
}

fn offer(found: &[AdapterSummary]) -> String {
    if found.is_empty() {
        return "none".to_owned();
    }
    let lines: Vec<String> = found.iter().map(|adapter| format!("number {}, {adapter}", adapter.number)).collect();
    lines.join("; ")
}
