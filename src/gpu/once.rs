//! Kernels that are run by themselves, from one buffer into another: those that find out what a device is like.

use bytemuck::Pod;
use wgpu::BufferUsages;

use super::buffers::{binding, buffer, mapped};
use super::{Device, GpuError};

/// A kernel with its buffers: the first binding is what goes in, the second what comes out.
pub(super) struct Once<'d> {
    opened: &'d Device,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    given: wgpu::Buffer,
    results: wgpu::Buffer,
    readback: wgpu::Buffer,
}

impl<'d> Once<'d> {
    /// The kernel called `name` with source `wgsl`, that takes and gives so many bytes.
    pub(super) fn new(
        opened: &'d Device,
        name: &str,
        wgsl: &str,
        takes: usize,
        gives: usize,
    ) -> Result<Self, GpuError> {
        let device = &opened.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries: &[
                binding(0, wgpu::BufferBindingType::Storage { read_only: true }, false),
                binding(1, wgpu::BufferBindingType::Storage { read_only: false }, false),
            ],
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            }),
            entry_point: Some(name),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let given = buffer(device, "given", takes, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let results = buffer(device, "results", gives, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let readback = buffer(device, "readback", gives, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(name),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: given.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: results.as_entire_binding() },
            ],
        });
        opened.check()?;
        Ok(Once { opened, pipeline, bindings, given, results, readback })
    }

    /// What so many workgroups make of `given`.
    pub(super) fn run<T: Pod>(&self, given: &[u8], workgroups: u32) -> Result<Vec<T>, GpuError> {
        let Once { opened, readback, .. } = self;
        let Device { device, queue, .. } = opened;
        queue.write_buffer(&self.given, 0, given);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("once") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&self.results, 0, readback, 0, readback.size());
        let mapped = mapped(&encoder, readback, wgpu::MapMode::Read, readback.size());
        let submission = queue.submit([encoder.finish()]);
        opened.wait(&submission)?;
        mapped.recv().map_err(|e| opened.failed(e))?.map_err(|e| opened.failed(e))?;
        let view = readback.get_mapped_range(..).map_err(|e| opened.failed(e))?;
        let results = bytemuck::pod_collect_to_vec(&view[..]);
        drop(view);
        readback.unmap();
        Ok(results)
    }
}
