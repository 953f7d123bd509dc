//! Asking a device what it makes of f32.

use std::sync::{Arc, OnceLock, mpsc};

use wgpu::{BufferUsages, PollType};

use super::arithmetic::{Arithmetic, Outcome};
use super::buffers::{PATIENCE, binding, buffer};
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
    let Device { device, queue, .. } = opened;
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("probe"),
        entries: &[
            binding(0, wgpu::BufferBindingType::Storage { read_only: true }, false),
            binding(1, wgpu::BufferBindingType::Storage { read_only: false }, false),
        ],
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("probe"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("probe"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        })),
        module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        }),
        entry_point: Some("probe"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let bytes = samples.len() * size_of::<Outcome>();
    let asked = buffer(device, "samples", size_of_val(samples), BufferUsages::STORAGE | BufferUsages::COPY_DST);
    let results = buffer(device, "results", bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let readback = buffer(device, "readback", bytes, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
    let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("probe"),
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: asked.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: results.as_entire_binding() },
        ],
    });
    opened.check()?;
    queue.write_buffer(&asked, 0, bytemuck::cast_slice(samples));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("probe") });
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups((samples.len() as u32).div_ceil(WORKGROUP), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&results, 0, &readback, 0, bytes as u64);
    let (sender, mapped) = mpsc::sync_channel(1);
    encoder.map_buffer_on_submit(&readback, wgpu::MapMode::Read, .., move |result| {
        let _ = sender.send(result);
    });
    let submission = queue.submit([encoder.finish()]);
    let wait = PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
    device.poll(wait).map_err(|e| opened.failed(e))?;
    opened.check()?;
    mapped.recv().map_err(|e| opened.failed(e))?.map_err(|e| opened.failed(e))?;
    let view = readback.get_mapped_range(..).map_err(|e| opened.failed(e))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}
