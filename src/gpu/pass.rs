//! A kernel on the GPU: its buffers and its round trip.

use std::marker::PhantomData;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages;

use super::buffers::{Mapped, binding, buffer, mapped};
use super::kernel::{Kernel, Sweeping};
use super::pages::{Pages, pages_of};
use super::{Device, GpuError, Tuning};
use crate::candidates::{DevicePlace, ListKey};

/// How many tests a round has at most, one a vertex and point, if that leaves work for one workgroup: 2^32, some
/// seconds on the slowest adapter known (0.7e9 tests a second), well within the patience of drivers that watch for
/// hanging kernels on real GPUs.
const TESTS_A_ROUND: usize = 1 << 32;

/// How far apart the spans lie in their buffer: every device can bind a uniform buffer at multiples of 256 bytes.
const SPAN_BYTES: u64 = 256;

/// How many rounds can be on their way at a time: one on the GPU while the CPU works on the other.
pub const HALVES: usize = 2;

/// The shader's `Span`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Span {
    pub first: u32,
    pub end: u32,
    unused: [u32; 2],
}

/// Runs the queries of a kernel on a GPU, in up to [`HALVES`] rounds at a time.
pub struct GpuPass<K = Sweeping> {
    device: Device,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    pages: Pages,
    halves: [Half; HALVES],
    capacity: usize,
    workgroup: u32,
    kernel: PhantomData<K>,
}

/// The buffers of a round.
struct Half {
    queries: wgpu::Buffer,
    found: wgpu::Buffer,
    /// For kernels that take points of traces.
    points: Option<wgpu::Buffer>,
    readback: wgpu::Buffer,
    /// A span for each page that a round touches, and how many there is room for.
    spans: wgpu::Buffer,
    room: usize,
    bindings: wgpu::BindGroup,
    sent: Option<Sent>,
}

/// A round that is on its way.
struct Sent {
    submission: wgpu::SubmissionIndex,
    mapped: Mapped,
}

impl<K: Kernel> GpuPass<K> {
    /// A pass of the kernel with source `wgsl` for `lists` lists, of at most `largest` vertices each,
    /// that keeps up to `budget` bytes of them on the device. A round takes `tuning.queries` queries, or fewer where
    /// the device's limits or the size of the lists ask for it.
    ///
    /// # Errors
    ///
    /// What the device complains of, be it the shader or the memory.
    pub fn new(
        opened: Device,
        lists: usize,
        largest: usize,
        budget: usize,
        tuning: Tuning,
        wgsl: &str,
    ) -> Result<Self, GpuError> {
        let device = &opened.device;
        let limits = device.limits();
        let pages = Pages::new(&opened, lists, largest, budget);
        if pages.block_bytes() > limits.max_buffer_size {
            return Err(opened.unfit(format!("its buffers are too small for lists of {largest} vertices")));
        }
        let workgroup = tuning.workgroup.min(limits.max_compute_invocations_per_workgroup);
        let capacity = tuning
            .queries
            .min(limits.max_storage_buffer_binding_size as usize / bytes_a_query::<K>())
            .min(opened.memory() / 4 / (HALVES * bytes_a_query::<K>()))
            .min(limits.max_compute_workgroups_per_dimension as usize * workgroup as usize)
            .min(TESTS_A_ROUND / (largest.max(1) * K::POINTS.max(1)))
            .max(workgroup as usize)
            .min(tuning.queries.max(1));
        let mut entries = vec![
            binding(0, wgpu::BufferBindingType::Uniform, true),
            binding(1, wgpu::BufferBindingType::Storage { read_only: true }, false),
            binding(2, wgpu::BufferBindingType::Storage { read_only: false }, false),
        ];
        if K::POINTS > 0 {
            entries.push(binding(3, wgpu::BufferBindingType::Storage { read_only: true }, false));
        }
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("round"), entries: &entries });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(K::NAME),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(K::NAME),
                bind_group_layouts: &[Some(&layout), Some(pages.layout())],
                immediate_size: 0,
            })),
            module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(K::NAME),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            }),
            entry_point: Some(K::NAME),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("WORKGROUP", f64::from(workgroup))],
                ..Default::default()
            },
            cache: None,
        });
        let halves = std::array::from_fn(|_| Half::new::<K>(device, &layout, capacity));
        opened.check()?;
        Ok(GpuPass { device: opened, pipeline, layout, pages, halves, capacity, workgroup, kernel: PhantomData })
    }

    /// The adapter on which it runs.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// How many queries a round can take.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// How often lists on the device had to make room for others, a block of them at a time.
    pub fn emptied(&self) -> u64 {
        self.pages.emptied()
    }

    /// Forgets which lists lie on the device.
    pub fn forget(&mut self) {
        self.pages.forget();
    }

    /// Starts to put a round together; see [`place`](Self::place).
    pub fn start_round(&mut self) {
        self.pages.start_round();
    }

    /// Where the list of this key, of `len` vertices, lies on the device until the round is sent: the `first` of
    /// queries that try it. If it is not there, it is brought, with the `coordinates` of its vertices. `None` if there
    /// is no room beside the other lists of this round; the first list of a round always finds room.
    pub fn place(
        &mut self,
        key: ListKey,
        len: usize,
        coordinates: impl FnOnce() -> Vec<[f32; 2]>,
    ) -> Option<DevicePlace> {
        self.pages.place(&self.device, key, len, coordinates)
    }

    /// Sends a round of queries, sorted by `first`, whose lists were placed since the round was started, and the points
    /// that they name.
    ///
    /// # Panics
    ///
    /// If there are more queries or points than a round can take, or if the half's last round was not collected.
    pub fn send(&mut self, half: usize, queries: &[K::Query], points: &[[f32; 2]]) {
        assert!(queries.len() <= self.capacity, "a round takes what it has room for");
        assert!(points.len() <= self.capacity * K::POINTS, "a round takes the points that it has room for");
        assert!(self.halves[half].sent.is_none(), "a half takes one round at a time");
        if queries.is_empty() {
            return;
        }
        let spans = spans(queries.iter().map(K::tried));
        let Device { device, queue, .. } = &self.device;
        self.halves[half].make_room(device, &self.layout, spans.len());
        let buffers = &self.halves[half];
        queue.write_buffer(&buffers.queries, 0, bytemuck::cast_slice(queries));
        if let Some(buffer) = &buffers.points {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(points));
        }
        let mut bytes = vec![0; spans.len() * SPAN_BYTES as usize];
        for ((_, span), bytes) in spans.iter().zip(bytes.chunks_mut(SPAN_BYTES as usize)) {
            let span = Span { first: span.start, end: span.end, unused: [0; 2] };
            bytes[..size_of::<Span>()].copy_from_slice(bytemuck::bytes_of(&span));
        }
        queue.write_buffer(&buffers.spans, 0, &bytes);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("round") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            for (i, (page, span)) in spans.iter().enumerate() {
                let (lists, offset) = self.pages.binding(*page);
                pass.set_bind_group(0, &buffers.bindings, &[i as u32 * SPAN_BYTES as u32]);
                pass.set_bind_group(1, lists, &[offset]);
                pass.dispatch_workgroups((span.end - span.start).div_ceil(K::QUERIES * self.workgroup), 1, 1);
            }
        }
        let bytes = (queries.len() * size_of::<K::Found>()) as u64;
        encoder.copy_buffer_to_buffer(&buffers.found, 0, &buffers.readback, 0, bytes);
        let mapped = mapped(&encoder, &buffers.readback, wgpu::MapMode::Read, bytes);
        let submission = queue.submit([encoder.finish()]);
        self.halves[half].sent = Some(Sent { submission, mapped });
    }

    /// Waits until the half's round, if there is one, is done.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    pub fn wait(&self, half: usize) -> Result<(), GpuError> {
        let Some(sent) = &self.halves[half].sent else { return Ok(()) };
        self.device.wait(&sent.submission)
    }

    /// Waits for the half's round and copies what its queries found, in their order, into `found`, which is as long.
    ///
    /// # Errors
    ///
    /// As [`wait`](Self::wait).
    pub fn collect(&mut self, half: usize, found: &mut [K::Found]) -> Result<(), GpuError> {
        let waited = self.wait(half);
        let Some(Sent { mapped, .. }) = self.halves[half].sent.take() else { return waited };
        let read = waited.and_then(|()| {
            mapped.recv().map_err(|e| self.device.failed(e))?.map_err(|e| self.device.failed(e))?;
            let range = 0..size_of_val(found) as u64;
            let view = self.halves[half].readback.get_mapped_range(range).map_err(|e| self.device.failed(e))?;
            bytemuck::cast_slice_mut(found).copy_from_slice(&view);
            Ok(())
        });
        // Also after an error, so that the next round finds the buffer free.
        self.halves[half].readback.unmap();
        read
    }
}

impl Half {
    fn new<K: Kernel>(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, capacity: usize) -> Self {
        let (queries_bytes, found_bytes) = (capacity * size_of::<K::Query>(), capacity * size_of::<K::Found>());
        let points_bytes = capacity * K::POINTS * size_of::<[f32; 2]>();
        let queries = buffer(device, "queries", queries_bytes, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let found = buffer(device, "found", found_bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let readback = buffer(device, "readback", found_bytes, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        let points = || buffer(device, "points", points_bytes, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let points = (points_bytes > 0).then(points);
        let room = 64;
        let (spans, bindings) = bind_spans(device, layout, room, &queries, &found, points.as_ref());
        Half { queries, found, points, readback, spans, room, bindings, sent: None }
    }

    /// Makes room for `spans` spans.
    fn make_room(&mut self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout, spans: usize) {
        if spans > self.room {
            self.room = spans.next_power_of_two();
            let Half { queries, found, points, .. } = self;
            (self.spans, self.bindings) = bind_spans(device, layout, self.room, queries, found, points.as_ref());
        }
    }
}

fn bind_spans(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    room: usize,
    queries: &wgpu::Buffer,
    found: &wgpu::Buffer,
    points: Option<&wgpu::Buffer>,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
    let spans = buffer(device, "spans", room * SPAN_BYTES as usize, usage);
    let size = wgpu::BufferSize::new(size_of::<Span>() as u64);
    let span = wgpu::BufferBinding { buffer: &spans, offset: 0, size };
    let mut entries = vec![
        wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(span) },
        wgpu::BindGroupEntry { binding: 1, resource: queries.as_entire_binding() },
        wgpu::BindGroupEntry { binding: 2, resource: found.as_entire_binding() },
    ];
    entries.extend(points.map(|p| wgpu::BindGroupEntry { binding: 3, resource: p.as_entire_binding() }));
    let descriptor = wgpu::BindGroupDescriptor { label: Some("round"), layout, entries: &entries };
    let bindings = device.create_bind_group(&descriptor);
    (spans, bindings)
}

/// The most that a query takes of any of the round's buffers, in bytes.
fn bytes_a_query<K: Kernel>() -> usize {
    size_of::<K::Query>().max(size_of::<K::Found>()).max(K::POINTS * size_of::<[f32; 2]>())
}

/// The pages that queries sorted by `first` touch, in order, and for each which queries do. Of each query it is given
/// where the vertices to be tried begin and how many they are.
fn spans(queries: impl Iterator<Item = (DevicePlace, u32)>) -> Vec<(u32, Range<u32>)> {
    let mut spans: Vec<(u32, Range<u32>)> = Vec::new();
    // The pages of neighbours are the same or follow each other, since lists do not overlap.
    for (number, (first, count)) in (0..).zip(queries) {
        for page in pages_of(first, count) {
            match spans.iter_mut().rev().find(|(p, _)| *p <= page) {
                Some((p, span)) if *p == page => span.end = number + 1,
                _ => spans.push((page, number..number + 1)),
            }
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::super::pages::PAGE_VERTICES;
    use super::*;

    #[test]
    fn spans_cover_the_pages_of_their_queries() {
        let page = PAGE_VERTICES;
        assert_eq!(spans([].into_iter()), []);
        // Two short lists in page 0, one in page 2 that holds nothing, one that takes pages 3 to 5, one behind it.
        let queries = [
            (0, 10),
            (0, 10),
            (10, 4),
            (2 * page, 0),
            (3 * page, 2 * page + 6),
            (3 * page, 2 * page + 6),
            (5 * page + 6, 8),
        ];
        let queries = queries.map(|(first, count)| (DevicePlace(first), count));
        assert_eq!(spans(queries.into_iter()), [(0, 0..3), (2, 3..4), (3, 4..6), (4, 4..6), (5, 4..7)]);
    }
}
