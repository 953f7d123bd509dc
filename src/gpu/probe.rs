//! Asking a device what it makes of f32.

use std::sync::{Arc, OnceLock};

use super::arithmetic::{Arithmetic, Outcome};
use super::once::Once;
use super::sample::{Sample, samples};
use super::{Device, GpuError};

/// The source of the kernel that asks.
pub const PROBE_WGSL: &str = include_str!("../../shaders/probe.wgsl");

/// How many lanes a workgroup has; the same number stands in the shader.
const WORKGROUP: u32 = 64;

impl Arithmetic {
    /// Asks the device by the kernel with source `wgsl`, in some milliseconds.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    pub fn of(device: &Device, wgsl: &str) -> Result<Self, GpuError> {
        let samples = samples();
        Ok(Arithmetic::learned(&samples, &run(device, wgsl, &samples)?))
    }
}

impl Device {
    /// The same device, judged by what the kernel with source `wgsl` finds instead of `probe.wgsl`.
    ///
    /// # Errors
    ///
    /// As [`arithmetic`](Self::arithmetic).
    pub fn probed(mut self, wgsl: &str) -> Result<Device, GpuError> {
        self.arithmetic = Arc::new(OnceLock::from(Arithmetic::of(&self, wgsl)?));
        Ok(self)
    }

    /// What the device makes of f32. It is asked once, in some milliseconds.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    pub fn arithmetic(&self) -> Result<&Arithmetic, GpuError> {
        if let Some(known) = self.arithmetic.get() {
            return Ok(known);
        }
        let found = Arithmetic::of(self, PROBE_WGSL)?;
        Ok(self.arithmetic.get_or_init(|| found))
    }

    /// An error if exact ropes cannot rely on the device's f32.
    pub(crate) fn certify(&self) -> Result<(), GpuError> {
        match &self.arithmetic()?.fault {
            None => Ok(()),
            Some(fault) => Err(self.unfit(format!("{fault}. Take another adapter, the engine cpu, or precision fast"))),
        }
    }
}

fn run(opened: &Device, wgsl: &str, samples: &[Sample]) -> Result<Vec<Outcome>, GpuError> {
    let gives = samples.len() * size_of::<Outcome>();
    let probe = Once::new(opened, "probe", wgsl, size_of_val(samples), gives)?;
    probe.run(bytemuck::cast_slice(samples), (samples.len() as u32).div_ceil(WORKGROUP))
}
