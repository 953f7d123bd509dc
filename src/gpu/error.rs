//! What can go wrong with a GPU.

use super::adapter::{AdapterSummary, SOFTWARE_HINT};

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
    /// No real GPU can be here.
    #[error("there is no real GPU here: all Vulkan drivers that are installed need a device in /dev that is not there")]
    NoDeviceFile,
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

impl GpuError {
    /// Whether there is no device for this job, which is known before anything is computed: another adapter may do, or
    /// an engine without one. `false` for a device that failed on the way, which may do another time.
    pub fn is_unfit(&self) -> bool {
        match self {
            GpuError::NoAdapter { .. } | GpuError::NoDeviceFile | GpuError::Unfit { .. } => true,
            GpuError::Timeout { .. } | GpuError::Failed { .. } => false,
        }
    }
}

fn offer(found: &[AdapterSummary]) -> String {
    if found.is_empty() {
        return "none".to_owned();
    }
    let lines: Vec<String> = found.iter().map(|adapter| format!("number {}, {adapter}", adapter.number)).collect();
    lines.join("; ")
}
