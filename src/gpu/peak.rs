//! What a device can do at the most: the yardstick for kernels.

use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};

use super::adapter::AdapterKind;
use super::once::Once;
use super::{Device, GpuError};

/// The source of the kernel that only multiplies and adds.
pub const PEAK_WGSL: &str = include_str!("../../shaders/peak.wgsl");

/// How many lanes a workgroup has; the same number stands in the shader.
const WORKGROUP: u32 = 64;

/// How many workgroups there are: enough to fill the largest devices several times, or the threads of a software one.
const fn workgroups(kind: AdapterKind) -> u32 {
    match kind {
        AdapterKind::Software => 1 << 8,
        _ => 1 << 14,
    }
}

/// How many products a lane has a round, and as many sums; `PRODUCTS` in the shader.
const PRODUCTS: u32 = 64;

/// How long a dispatch should take, so that what is around it does not count: well below what drivers allow.
const LONG: Duration = Duration::from_millis(30);

/// How many dispatches are timed.
const TIMES: usize = 5;

/// The shader's `Work`. The numbers stay finite, whatever the rounds.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Work {
    rounds: u32,
    factor: f32,
    addend: f32,
    unused: u32,
}

impl Device {
    /// How many products and sums of f32 it does a second in a kernel of nothing else; a fused product and sum is two.
    /// The fastest of some dispatches, together some tenths of a second.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    ///
    /// ```
    /// use tautline::gpu::{AdapterChoice, Device};
    /// let device = Device::open(&AdapterChoice::Software)?;
    /// assert!(device.peak()? > 0.0);
    /// # Ok::<(), tautline::gpu::GpuError>(())
    /// ```
    pub fn peak(&self) -> Result<f64, GpuError> {
        let workgroups = workgroups(self.summary().kind);
        let lanes = (workgroups * WORKGROUP) as usize;
        let kernel = Once::new(self, "peak", PEAK_WGSL, size_of::<Work>(), lanes * size_of::<f32>())?;
        let time = |rounds| {
            let work = Work { rounds, factor: 0.5, addend: 1.0, unused: 0 };
            let start = Instant::now();
            kernel.run::<f32>(bytemuck::bytes_of(&work), workgroups)?;
            Ok(start.elapsed())
        };
        // The first one waits for a compiler.
        time(1)?;
        let mut rounds = 1;
        while time(rounds)? < LONG && rounds < 1 << 20 {
            rounds *= 2;
        }
        let times: Vec<Duration> = (0..TIMES).map(|_| time(rounds)).collect::<Result<_, GpuError>>()?;
        let shortest = times.into_iter().min().unwrap_or(LONG);
        Ok(lanes as f64 * f64::from(rounds) * f64::from(2 * PRODUCTS) / shortest.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_does_what_is_counted() {
        assert!(PEAK_WGSL.contains(&format!("const PRODUCTS: u32 = {PRODUCTS}u;")));
        assert!(PEAK_WGSL.contains(&format!("@workgroup_size({WORKGROUP})")));
        assert_eq!(4 * PEAK_WGSL.matches(" * factor + addend;").count(), PRODUCTS as usize);
        // A lane of `x -> x / 2 + 1` comes to 2 in each of its sixteen numbers.
        let device = Device::open(&crate::gpu::AdapterChoice::Software).unwrap_or_else(|e| panic!("{e}"));
        let kernel = Once::new(&device, "peak", PEAK_WGSL, size_of::<Work>(), 64 * size_of::<f32>()).unwrap();
        let run = |rounds| {
            let work = Work { rounds, factor: 0.5, addend: 1.0, unused: 0 };
            kernel.run::<f32>(bytemuck::bytes_of(&work), 1).unwrap()
        };
        let sum = |lane: usize| 4.0 * (lane as f32 + 6.0) + 4.0 * (1.0 + 2.0 + 3.0 + 18.0);
        assert_eq!(run(0), (0..64).map(sum).collect::<Vec<f32>>());
        assert_eq!(run(10), [32.0; 64]);
    }
}
