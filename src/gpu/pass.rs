//! The candidate pass on the GPU: `shaders/sweep.wgsl`, its buffers and its round trip.

use std::sync::mpsc;
use std::time::Duration;

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, PollType};

use super::{Device, GpuError};
use crate::candidates::{CandidatePass, Found, Frame, Query};
use crate::scene::Model;

/// The shader's source.
pub const SWEEP_WGSL: &str = include_str!("../../shaders/sweep.wgsl");

/// The size of the shader's `Chunk`: 64 KiB, which every adapter that meets WebGPU's default limits can bind.
pub(super) const CHUNK_BYTES: u64 = 1 << 16;
/// How many vertices a chunk holds: what is left of it after its header, at 8 bytes each.
const CHUNK_VERTICES: usize = (CHUNK_BYTES as usize - size_of::<ChunkHeader>()) / 8;

/// The workgroup's size in the shader.
const WORKGROUP: u32 = 64;

/// How many tests a round has at most, if that leaves work for one workgroup: 2^32, some seconds on the slowest adapter
/// known (0.7e9 tests a second), well within the patience of drivers that watch for hanging kernels on real GPUs.
const TESTS_A_ROUND: usize = 1 << 32;

/// How long a round may take before the device is given up.
const PATIENCE: Duration = Duration::from_secs(120);

/// The start of the shader's `Chunk`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ChunkHeader {
    first: u32,
    count: u32,
    unused: [u32; 2],
}

/// The shader's `Round`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Round {
    queries: u32,
    unused: [u32; 3],
}

/// Runs queries on a GPU. All buffers are made once.
pub struct GpuPass<'m> {
    model: &'m Model,
    frame: Frame,
    device: Device,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    round: wgpu::Buffer,
    queries: wgpu::Buffer,
    found: wgpu::Buffer,
    readback: wgpu::Buffer,
    chunks: u32,
    capacity: usize,
}

impl<'m> GpuPass<'m> {
    /// A pass over the model's vertices that takes `capacity` queries at once, or fewer where the device's limits or the
    /// number of vertices ask for it.
    ///
    /// # Errors
    ///
    /// What the device complains of, be it the shader or the memory.
    pub fn new(device: Device, model: &'m Model, capacity: usize) -> Result<Self, GpuError> {
        Self::with_shader(device, model, capacity, SWEEP_WGSL)
    }

    /// The same with another shader in the place of `sweep.wgsl`: what tests use to see that they can fail.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn with_shader(opened: Device, model: &'m Model, capacity: usize, wgsl: &str) -> Result<Self, GpuError> {
        let frame = Frame::new(model);
        let device = &opened.device;
        let limits = device.limits();
        let chunks = chunked(&frame.vertices(model));
        if chunks.len() as u64 > limits.max_buffer_size {
            return Err(opened.unfit(format!("its buffers are too small for {} vertices", model.vertices().len())));
        }
        let capacity = capacity
            .min(limits.max_storage_buffer_binding_size as usize / size_of::<Found>())
            .min(limits.max_compute_workgroups_per_dimension as usize * WORKGROUP as usize)
            .min(TESTS_A_ROUND / model.vertices().len().max(1))
            .max(WORKGROUP as usize)
            .min(capacity.max(1));
        let buffer = |label, size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        let vertices = buffer("chunks", chunks.len(), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        opened.queue.write_buffer(&vertices, 0, &chunks);
        let round = buffer("round", size_of::<Round>(), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let queries = buffer("queries", capacity * size_of::<Query>(), BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let found_bytes = capacity * size_of::<Found>();
        let found = buffer("found", found_bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let readback = buffer("readback", found_bytes, BufferUsages::COPY_DST | BufferUsages::MAP_READ);

        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("sweep"),
            entries: &[
                binding(0, wgpu::BufferBindingType::Uniform, false),
                binding(1, wgpu::BufferBindingType::Uniform, true),
                binding(2, wgpu::BufferBindingType::Storage { read_only: true }, false),
                binding(3, wgpu::BufferBindingType::Storage { read_only: false }, false),
            ],
        });
        let chunk = wgpu::BufferBinding { buffer: &vertices, offset: 0, size: wgpu::BufferSize::new(CHUNK_BYTES) };
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sweep"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: round.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Buffer(chunk) },
                wgpu::BindGroupEntry { binding: 2, resource: queries.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: found.as_entire_binding() },
            ],
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("sweep"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("sweep"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("sweep.wgsl"),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            }),
            entry_point: Some("sweep"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        opened.check()?;
        let chunks = (chunks.len() as u64 / CHUNK_BYTES) as u32;
        Ok(GpuPass {
            model,
            frame,
            device: opened,
            pipeline,
            bindings,
            round,
            queries,
            found,
            readback,
            chunks,
            capacity,
        })
    }

    /// The adapter on which it runs.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Waits for a submission and copies what it found.
    fn read(
        &self,
        submission: wgpu::SubmissionIndex,
        mapped: &mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
        found: &mut [Found],
    ) -> Result<(), GpuError> {
        self.wait(submission)?;
        self.device.check()?;
        mapped.recv().map_err(|e| self.device.failed(e))?.map_err(|e| self.device.failed(e))?;
        let bytes = size_of_val(found) as u64;
        let view = self.readback.get_mapped_range(0..bytes).map_err(|e| self.device.failed(e))?;
        bytemuck::cast_slice_mut(found).copy_from_slice(&view);
        Ok(())
    }

    fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let wait = PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
        match self.device.device.poll(wait) {
            Ok(_) => Ok(()),
            Err(wgpu::PollError::Timeout) => {
                Err(GpuError::Timeout { adapter: self.device.summary().name.clone(), seconds: PATIENCE.as_secs() })
            }
            Err(other) => Err(self.device.failed(other)),
        }
    }
}

impl CandidatePass for GpuPass<'_> {
    type Error = GpuError;

    fn model(&self) -> &Model {
        self.model
    }

    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, queries: &[Query], found: &mut [Found]) -> Result<(), GpuError> {
        assert!(queries.len() <= self.capacity && queries.len() == found.len(), "a run takes what it has room for");
        if queries.is_empty() {
            return Ok(());
        }
        let (device, queue) = (&self.device.device, &self.device.queue);
        let count = queries.len() as u32;
        queue.write_buffer(&self.round, 0, bytemuck::bytes_of(&Round { queries: count, unused: [0; 3] }));
        queue.write_buffer(&self.queries, 0, bytemuck::cast_slice(queries));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("round") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            for chunk in 0..self.chunks {
                pass.set_bind_group(0, &self.bindings, &[chunk * CHUNK_BYTES as u32]);
                pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
            }
        }
        let bytes = size_of_val(found) as u64;
        encoder.copy_buffer_to_buffer(&self.found, 0, &self.readback, 0, bytes);
        let (sender, mapped) = mpsc::sync_channel(1);
        encoder.map_buffer_on_submit(&self.readback, wgpu::MapMode::Read, 0..bytes, move |result| {
            // The receiver is gone only if waiting failed, which is reported there.
            let _ = sender.send(result);
        });
        let submission = queue.submit([encoder.finish()]);
        let read = self.read(submission, &mapped, found);
        // Also after an error, so that the next round finds the buffer free.
        self.readback.unmap();
        read
    }
}

fn binding(binding: u32, ty: wgpu::BufferBindingType, has_dynamic_offset: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
        count: None,
    }
}

/// The vertices as a row of the shader's `Chunk`s, at least one.
fn chunked(vertices: &[glam::Vec2]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (i, chunk) in vertices.chunks(CHUNK_VERTICES).enumerate() {
        let header = ChunkHeader { first: (i * CHUNK_VERTICES) as u32, count: chunk.len() as u32, unused: [0; 2] };
        bytes.extend_from_slice(bytemuck::bytes_of(&header));
        bytes.extend_from_slice(bytemuck::cast_slice(chunk));
        bytes.resize((i + 1) * CHUNK_BYTES as usize, 0);
    }
    // A scene without walls still has one chunk, of no vertices: it starts the lists.
    bytes.resize(bytes.len().max(CHUNK_BYTES as usize), 0);
    bytes
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use naga::{Module, TypeInner};

    use super::*;
    use crate::candidates::ROOM;

    fn shader() -> Module {
        naga::front::wgsl::parse_str(SWEEP_WGSL).unwrap_or_else(|e| panic!("{}", e.emit_to_string(SWEEP_WGSL)))
    }

    /// The size of a struct of the shader and the names and offsets of its members.
    fn layout(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
        let ty =
            module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap_or_else(|| panic!("no {name}"));
        let TypeInner::Struct { members, span } = &ty.1.inner else { panic!("{name} is no struct") };
        (*span, members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect())
    }

    #[test]
    fn the_shader_is_valid() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&shader()).unwrap();
    }

    /// The members of a host struct with their offsets.
    macro_rules! members {
        ($ty:ty: $($member:ident),*) => {
            vec![$((stringify!($member).to_owned(), offset_of!($ty, $member) as u32)),*]
        };
    }

    #[test]
    fn host_and_shader_lay_their_structs_out_alike() {
        let module = shader();
        let query = (size_of::<Query>() as u32, members!(Query: right, left, far));
        assert_eq!(layout(&module, "Query"), query);
        assert_eq!(layout(&module, "Found"), (size_of::<Found>() as u32, members!(Found: count, vertices)));
        let (size, round) = layout(&module, "Round");
        assert_eq!((size, &round[..1]), (size_of::<Round>() as u32, &members!(Round: queries)[..]));
        let (size, mut chunk) = layout(&module, "Chunk");
        assert_eq!(u64::from(size), CHUNK_BYTES);
        assert_eq!(chunk.pop(), Some(("pairs".to_owned(), size_of::<ChunkHeader>() as u32)));
        assert_eq!(chunk, members!(ChunkHeader: first, count, unused));
    }

    #[test]
    fn host_and_shader_agree_on_numbers() {
        let module = shader();
        assert_eq!(module.entry_points[0].workgroup_size, [WORKGROUP, 1, 1]);
        assert!(SWEEP_WGSL.contains(&format!("count < {ROOM}u")));
    }

    #[test]
    fn chunks_hold_all_vertices_once() {
        let vertices: Vec<glam::Vec2> = (0..CHUNK_VERTICES + 3).map(|i| glam::Vec2::splat(i as f32)).collect();
        let bytes = chunked(&vertices);
        assert_eq!(bytes.len() as u64, 2 * CHUNK_BYTES);
        let second = &bytes[CHUNK_BYTES as usize..];
        let header: ChunkHeader = bytemuck::pod_read_unaligned(&second[..size_of::<ChunkHeader>()]);
        assert_eq!((header.first as usize, header.count), (CHUNK_VERTICES, 3));
        assert_eq!(&second[16..40], bytemuck::cast_slice::<_, u8>(&vertices[CHUNK_VERTICES..]));
        assert_eq!(chunked(&[]).len() as u64, CHUNK_BYTES);
    }
}
