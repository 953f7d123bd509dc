//! The kernel that takes traces along, `shaders/drag.wgsl`: its buffers, and its round trips.

use std::collections::BTreeSet;

use rayon::prelude::*;
use wgpu::{BufferUsages, PollType};

use super::buffers::{Mapped, binding, buffer, mapped};
use super::lane::{Head, Job, Lane, NOTES, Note, Ray, Room, STACK, Stacked};
use super::pass::HALVES;
use super::{Device, GpuError};

/// The source of the kernel that takes traces along.
pub const DRAG_WGSL: &str = include_str!("../../shaders/drag.wgsl");

/// How many rays are written again at a time.
const PAGE: usize = 256;

/// How many points are written at a time.
pub const CHUNK: usize = 64;

/// The size of a point, in bytes.
const POINT: usize = size_of::<[i32; 2]>();

/// After how many looks of a lane events are seen to: lanes that have met one wait for the others.
const LOOKS: u32 = 16;

/// How many looks a lane takes in a round at most: a round takes some milliseconds.
const MOST_LOOKS: u32 = 1 << 13;

/// Takes traces along on a device, in up to [`HALVES`] rounds at a time.
pub struct DragPass {
    device: Device,
    pipeline: wgpu::ComputePipeline,
    workgroup: u32,
    room: Room,
    data: wgpu::Buffer,
    rays: wgpu::Buffer,
    pivots: wgpu::Buffer,
    heads: Vec<Head>,
    heads_changed: bool,
    /// All rays, how many of them are on the device, the ways of those that are not, and which pages of those that are
    /// have changed.
    all_rays: Vec<Ray>,
    filled: usize,
    new_ways: Vec<[f32; 2]>,
    changed: BTreeSet<usize>,
    halves: [Half; HALVES],
}

struct Half {
    job: wgpu::Buffer,
    lanes: wgpu::Buffer,
    stacks: wgpu::Buffer,
    notes: wgpu::Buffer,
    lanes_back: wgpu::Buffer,
    notes_back: wgpu::Buffer,
    /// Where points are written to before they are copied; mapped, but while a round is on its way.
    upload: wgpu::Buffer,
    /// How many bytes of it are to be copied.
    written: u64,
    mapping: Option<Mapped>,
    bindings: wgpu::BindGroup,
    sent: Option<Sent>,
}

struct Sent {
    submission: wgpu::SubmissionIndex,
    /// How many bytes of lanes and of notes come back.
    bytes: [u64; 2],
    lanes: Mapped,
    notes: Mapped,
}

impl DragPass {
    /// The most room that a device has for a pass of at most `lanes` lanes a half, in the [memory](Device::memory) that
    /// it gives: a quarter of that for fans, at most one for lanes, what is left for points.
    pub fn most(device: &Device, lanes: usize) -> Room {
        let largest = device.largest_buffer() as usize;
        // Fans and points share a buffer, half of all that they take.
        let bytes = device.memory().min(largest.saturating_mul(2));
        let lanes = lanes.min(bytes / 4 / (HALVES * Room::LANE)).min(largest / (STACK * size_of::<Stacked>())).max(1);
        let left = (bytes / 4 * 3).saturating_sub(lanes * HALVES * Room::LANE);
        Room {
            lanes,
            points: (left / (HALVES * Room::POINT) / CHUNK).max(1) * CHUNK,
            rays: (bytes / 4 / Room::RAY).max(1),
        }
    }

    /// A pass of the kernel with source `wgsl` about pivots at these `places`, the anchor last.
    ///
    /// # Errors
    ///
    /// What the device complains of, be it the shader or the memory.
    pub fn new(opened: Device, places: &[[i32; 2]], room: Room, workgroup: u32, wgsl: &str) -> Result<Self, GpuError> {
        let device = &opened.device;
        let storage = |number, read_only| binding(number, wgpu::BufferBindingType::Storage { read_only }, false);
        let entries = [
            binding(0, wgpu::BufferBindingType::Uniform, false),
            storage(1, true),
            storage(2, true),
            storage(3, true),
            storage(4, false),
            storage(5, false),
            storage(6, false),
        ];
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("drag"), entries: &entries });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("drag"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("drag"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("drag"),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            }),
            entry_point: Some("drag"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("WORKGROUP", f64::from(workgroup))],
                ..Default::default()
            },
            cache: None,
        });
        let input = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let data = buffer(device, "data", (room.rays + HALVES * room.points) * size_of::<[u32; 2]>(), input);
        let rays = buffer(device, "rays", room.rays * size_of::<Ray>(), input);
        let heads: Vec<Head> = places.iter().map(|&place| Head { first: 0, rays: 0, place }).collect();
        let pivots = buffer(device, "pivots", size_of_val(&*heads), input);
        let halves = std::array::from_fn(|_| Half::new(device, &layout, room, [&data, &rays, &pivots]));
        opened.check()?;
        Ok(DragPass {
            device: opened,
            pipeline,
            workgroup,
            room,
            data,
            rays,
            pivots,
            heads,
            heads_changed: true,
            all_rays: Vec::new(),
            filled: 0,
            new_ways: Vec::new(),
            changed: BTreeSet::new(),
            halves,
        })
    }

    /// The adapter on which it runs.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The room that it has.
    pub fn room(&self) -> Room {
        self.room
    }

    /// Whether any fan lies on the device.
    pub fn has_fans(&self) -> bool {
        !self.all_rays.is_empty()
    }

    /// All pivots, by their index, and where their fans lie.
    pub fn heads(&self) -> &[Head] {
        &self.heads
    }

    /// Brings the fan of a pivot, each ray's way in units of the grid; false if there is no room for it.
    pub fn bring_fan(&mut self, pivot: usize, ways: &[[f32; 2]], rays: &[Ray]) -> bool {
        let first = self.all_rays.len();
        if first + ways.len() > self.room.rays {
            return false;
        }
        self.new_ways.extend_from_slice(ways);
        self.all_rays.extend_from_slice(rays);
        let head = &mut self.heads[pivot];
        (head.first, head.rays) = (first as u32, ways.len() as u32);
        self.heads_changed = true;
        true
    }

    /// Says where ray `i` of a pivot's fan [goes on](Ray::goes_on).
    pub fn set_goes_on(&mut self, pivot: usize, i: usize, goes_on: u32) {
        let at = self.heads[pivot].first as usize + i;
        self.all_rays[at].goes_on = goes_on;
        self.changed.insert(at / PAGE);
    }

    /// Forgets all fans.
    pub fn forget(&mut self) {
        self.heads.iter_mut().for_each(|head| head.rays = 0);
        (self.filled, self.heads_changed) = (0, true);
        self.all_rays.clear();
        self.new_ways.clear();
        self.changed.clear();
    }

    /// Where a half's points begin.
    pub fn first_point(&self, half: usize) -> u32 {
        (self.room.rays + half * self.room.points) as u32
    }

    /// Brings the points of a half, the first to [`first_point`](Self::first_point), with the next round: a part after
    /// the other, each as many [`CHUNK`]s as it says. They are written on all threads: `write` is given a part, the
    /// number of one of its chunks, and the chunk.
    ///
    /// # Errors
    ///
    /// As [`wait`](Self::wait).
    ///
    /// # Panics
    ///
    /// If there are more points than a half has room for.
    pub fn bring_points<T: Sync>(
        &mut self,
        half: usize,
        parts: &[(usize, T)],
        write: impl Fn(&T, usize, &mut [[i32; 2]; CHUNK]) + Sync,
    ) -> Result<(), GpuError> {
        let failed = |e: &dyn std::fmt::Display| self.device.failed(e.to_string());
        if let Some(mapped) = self.halves[half].mapping.take() {
            self.device.device.poll(PollType::Poll).map_err(|e| failed(&e))?;
            mapped.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
        }
        let Half { upload, written, .. } = &mut self.halves[half];
        *written = parts.iter().map(|(chunks, _)| chunks * CHUNK * POINT).sum::<usize>() as u64;
        if *written == 0 {
            return Ok(());
        }
        let mut view = upload.get_mapped_range_mut(0..*written).map_err(|e| failed(&e))?;
        // What is behind a slice of mapped memory cannot go to another thread, what is behind an array of it can.
        let mut chunks = view.slice(..).into_chunks::<{ CHUNK * POINT }>().0.into_iter();
        let mut split = Vec::with_capacity(parts.len());
        for (count, part) in parts {
            split.push((part, chunks.by_ref().take(*count).collect::<Vec<_>>()));
        }
        split.into_par_iter().with_min_len(16).for_each(|(part, chunks)| {
            let mut points = [[0; 2]; CHUNK];
            for (i, chunk) in chunks.into_iter().enumerate() {
                write(part, i, &mut points);
                chunk.write(bytemuck::cast(points));
            }
        });
        Ok(())
    }

    /// Brings the last contacts of the trace of this number, above the lowest `below` of its stack; at most [`STACK`]
    /// in all.
    pub fn bring_stack(&self, half: usize, number: usize, below: usize, stack: &[Stacked]) {
        if !stack.is_empty() {
            let at = ((number * STACK + below) * size_of::<Stacked>()) as u64;
            self.device.queue.write_buffer(&self.halves[half].stacks, at, bytemuck::cast_slice(stack));
        }
    }

    /// Sends a round.
    ///
    /// # Panics
    ///
    /// If there are more lanes than a half has, or if the half's last round was not collected.
    pub fn send(&mut self, half: usize, lanes: &[Lane]) {
        assert!(lanes.len() <= self.room.lanes, "a half takes what it has room for");
        let Device { device, queue, .. } = &self.device;
        if !self.new_ways.is_empty() {
            queue.write_buffer(&self.data, (self.filled * POINT) as u64, bytemuck::cast_slice(&self.new_ways));
            self.changed.extend(self.filled / PAGE..self.all_rays.len().div_ceil(PAGE));
            self.filled = self.all_rays.len();
            self.new_ways.clear();
        }
        while let Some(page) = self.changed.pop_first() {
            let mut end = page + 1;
            while self.changed.remove(&end) {
                end += 1;
            }
            let part = &self.all_rays[page * PAGE..(end * PAGE).min(self.filled)];
            queue.write_buffer(&self.rays, (page * PAGE * size_of::<Ray>()) as u64, bytemuck::cast_slice(part));
        }
        if std::mem::take(&mut self.heads_changed) {
            queue.write_buffer(&self.pivots, 0, bytemuck::cast_slice(&self.heads));
        }
        let points_at = u64::from(self.first_point(half)) * POINT as u64;
        let Half {
            job, lanes: buffer, notes, lanes_back, notes_back, upload, written, mapping, bindings, sent, ..
        } = &mut self.halves[half];
        assert!(sent.is_none(), "a half takes one round at a time");
        if lanes.is_empty() {
            return;
        }
        let (count, anchor) = (lanes.len() as u32, self.heads.len() as u32 - 1);
        let with = Job { lanes: count, turns: MOST_LOOKS / LOOKS, looks: LOOKS, anchor };
        queue.write_buffer(job, 0, bytemuck::bytes_of(&with));
        queue.write_buffer(buffer, 0, bytemuck::cast_slice(lanes));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("drag") });
        let written = std::mem::take(written);
        if written > 0 {
            upload.unmap();
            encoder.copy_buffer_to_buffer(upload, 0, &self.data, points_at, written);
            *mapping = Some(mapped(&encoder, upload, wgpu::MapMode::Write, upload.size()));
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &*bindings, &[]);
            pass.dispatch_workgroups(count.div_ceil(self.workgroup), 1, 1);
        }
        let bytes = [size_of_val(lanes) as u64, (lanes.len() * NOTES * size_of::<Note>()) as u64];
        encoder.copy_buffer_to_buffer(buffer, 0, lanes_back, 0, bytes[0]);
        encoder.copy_buffer_to_buffer(notes, 0, notes_back, 0, bytes[1]);
        let lanes = mapped(&encoder, lanes_back, wgpu::MapMode::Read, bytes[0]);
        let notes = mapped(&encoder, notes_back, wgpu::MapMode::Read, bytes[1]);
        let submission = queue.submit([encoder.finish()]);
        *sent = Some(Sent { submission, bytes, lanes, notes });
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

    /// Waits for the half's round, if there is one, and gives its lanes and their notes, [`NOTES`] a lane, to `read`.
    ///
    /// # Errors
    ///
    /// As [`wait`](Self::wait).
    pub fn collect<T>(&mut self, half: usize, read: impl FnOnce(&[Lane], &[Note]) -> T) -> Result<Option<T>, GpuError> {
        let waited = self.wait(half);
        let Half { lanes_back, notes_back, sent, .. } = &mut self.halves[half];
        let Some(Sent { bytes, lanes, notes, .. }) = sent.take() else { return waited.map(|()| None) };
        let failed = |e: &dyn std::fmt::Display| self.device.failed(e.to_string());
        let done = waited.and_then(|()| {
            for mapped in [lanes, notes] {
                mapped.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
            }
            let lanes = lanes_back.get_mapped_range(0..bytes[0]).map_err(|e| failed(&e))?;
            let notes = notes_back.get_mapped_range(0..bytes[1]).map_err(|e| failed(&e))?;
            Ok(Some(read(bytemuck::cast_slice(&lanes), bytemuck::cast_slice(&notes))))
        });
        // Also after an error, so that the next round finds the buffers free.
        lanes_back.unmap();
        notes_back.unmap();
        done
    }
}

impl Half {
    fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, room: Room, shared: [&wgpu::Buffer; 3]) -> Self {
        let job = buffer(device, "job", size_of::<Job>(), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let sizes =
            [size_of::<Lane>(), STACK * size_of::<Stacked>(), NOTES * size_of::<Note>()].map(|size| size * room.lanes);
        let both = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let back = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let [lanes, stacks, notes] =
            [("lanes", sizes[0]), ("stacks", sizes[1]), ("notes", sizes[2])].map(|(l, s)| buffer(device, l, s, both));
        let [lanes_back, notes_back] =
            [("lanes back", sizes[0]), ("notes back", sizes[2])].map(|(l, s)| buffer(device, l, s, back));
        let upload = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("upload"),
            size: (room.points * POINT) as u64,
            usage: BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        let [data, rays, pivots] = shared;
        let all = [&job, data, rays, pivots, &lanes, &stacks, &notes];
        let entries: Vec<_> = (0..)
            .zip(all)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bindings =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("drag"), layout, entries: &entries });
        Half {
            job,
            lanes,
            stacks,
            notes,
            lanes_back,
            notes_back,
            upload,
            written: 0,
            mapping: None,
            bindings,
            sent: None,
        }
    }
}
