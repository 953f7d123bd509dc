//! Buffers of the device, and how long it is waited for.

use std::sync::mpsc;
use std::time::Duration;

use wgpu::BufferUsages;

/// The size of a page in bytes: what every device can bind as a uniform buffer.
pub(super) const PAGE_BYTES: u64 = 1 << 16;

/// How long a round may take before the device is given up.
pub(super) const PATIENCE: Duration = Duration::from_secs(120);

/// A buffer of `size` bytes.
pub(super) fn buffer(device: &wgpu::Device, label: &str, size: usize, usage: BufferUsages) -> wgpu::Buffer {
    let size = size as u64;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

/// How a kernel sees the buffer at `binding`.
pub(super) fn binding(
    binding: u32,
    ty: wgpu::BufferBindingType,
    has_dynamic_offset: bool,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
        count: None,
    }
}

/// What is told once a buffer is mapped.
pub(super) type Mapped = mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>;

/// Maps the first `bytes` of a buffer once what is encoded is done.
pub(super) fn mapped(encoder: &wgpu::CommandEncoder, buffer: &wgpu::Buffer, mode: wgpu::MapMode, bytes: u64) -> Mapped {
    let (sender, mapped) = mpsc::sync_channel(1);
    encoder.map_buffer_on_submit(buffer, mode, 0..bytes, move |result| {
        // The receiver is gone only if waiting failed, which is reported there.
        let _ = sender.send(result);
    });
    mapped
}
