//! What a device makes of f32, found out by asking it: the candidate pass relies on some of it.

use std::cmp::Ordering;
use std::sync::mpsc;

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec2};
use wgpu::{BufferUsages, PollType};

use super::pass::{PATIENCE, binding, buffer};
use super::shapes::{Computed, SHAPES, computed};
use super::{Device, GpuError};
use crate::candidates::{ARITHMETIC, LONGEST_NORMAL};

/// The source of the kernel that asks.
pub const PROBE_WGSL: &str = include_str!("../../shaders/probe.wgsl");

/// How many samples there are: enough to meet every way of rounding many times, few enough for a millisecond.
const SAMPLES: usize = 4096;

/// How many lanes a workgroup has; the same number stands in the shader.
const WORKGROUP: u32 = 64;

/// The least f32 that is not subnormal.
const NORMAL: f64 = f32::MIN_POSITIVE as f64;

/// The shader's `Sample`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Sample {
    pub normal: Vec2,
    pub p: Vec2,
    pub q: Vec2,
    pub a: Vec2,
    pub b: Vec2,
    pub origin: Vec2,
    pub offset: f32,
    pub dir: f32,
}

/// The shader's `Result`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Outcome {
    pub product: f32,
    pub sum: f32,
    pub least: f32,
    pub holds: u32,
    pub shapes: [f32; SHAPES.len()],
}

/// What a device makes of f32, as far as a few thousand samples show.
///
/// The bound of the candidate pass ([`MARGIN`](crate::candidates::MARGIN), step 1) assumes that a product or sum is one of the two
/// nearest f32, that subnormal numbers may be taken for 0, that products and sums may be fused and put in another order, that a
/// minimum is one of its arguments, and that a comparison with 0 holds for 0 and above. Whether a device fuses, flushes or
/// rewrites sums is told, shape by shape, because it decides close calls with `--precision fast`.
#[derive(Debug, Clone, PartialEq)]
pub struct Arithmetic {
    /// Whether all products and sums are the nearest f32, not only one of the two nearest.
    pub rounds_to_nearest: bool,
    /// Whether a product and a sum are rounded once in some shape, and nothing else is done to it.
    pub fuses: bool,
    /// Whether subnormal products become 0.
    pub flushes: bool,
    /// How each shape of sums and products is computed that the kernels contain, and three usual ones: `((a*b)+c)`,
    /// `((a+b)-a)` and `((a-b)+b)`. A shape is written with the same letter for the same number.
    pub shapes: Vec<(&'static str, Computed)>,
    /// The largest error of a half-plane's value, as a share of what the bound allows.
    pub largest_error: f64,
    /// What the candidate pass cannot live with.
    pub fault: Option<String>,
}

impl Arithmetic {
    /// Asks the device by the kernel with source `wgsl`, in some milliseconds.
    ///
    /// # Errors
    ///
    /// What the device complains of, or that it does not answer.
    pub fn of(device: &Device, wgsl: &str) -> Result<Self, GpuError> {
        let samples = samples();
        let outcomes = run(device, wgsl, &samples)?;
        let mut found = Arithmetic {
            rounds_to_nearest: true,
            fuses: false,
            flushes: false,
            shapes: SHAPES.map(|shape| (shape, Computed::AsWritten)).to_vec(),
            largest_error: 0.0,
            fault: None,
        };
        for (i, outcome) in outcomes.iter().enumerate() {
            found.learn(&samples[i], outcome);
            let of_shape = |shape| samples[(i + shape) % SAMPLES];
            for (shape, computed) in computed(of_shape, &outcome.shapes).into_iter().enumerate() {
                // What becomes of subnormal numbers is another question.
                if !is_small(&of_shape(shape)) {
                    found.shapes[shape].1 = found.shapes[shape].1.max(computed);
                }
            }
        }
        found.fuses = found.shapes.iter().any(|(_, computed)| *computed == Computed::Fused);
        Ok(found)
    }

    fn learn(&mut self, sample: &Sample, outcome: &Outcome) {
        let Sample { normal, p, offset, .. } = *sample;
        let value = outcome.shapes[0];
        // Exact: 48 bits, and sums of numbers at most 24 binary orders of magnitude apart, or of which one is 0.
        let (product, sum) = (f64::from(normal.x) * f64::from(p.x), f64::from(normal.x) + f64::from(offset));
        let exact = normal.as_dvec2().dot(p.as_dvec2()) + f64::from(offset);
        let error = (f64::from(value) - exact).abs() / ARITHMETIC;
        let least = normal.x.min(p.x).min(offset);
        let is_least = outcome.least == least || is_subnormal(least.into()) && outcome.least == 0.0;
        let is_told = match outcome.holds {
            1 => least > -f32::MIN_POSITIVE,
            holds => holds == 0 && least < 0.0,
        };
        let (nearest, bound) = ("be one of the two nearest f32", format!("be good to {ARITHMETIC:.2e}"));
        let why = if !is_near(outcome.product, product) {
            Some(("product", nearest, format!("{:e}", outcome.product), product))
        } else if !is_near(outcome.sum, sum) {
            Some(("sum", nearest, format!("{:e}", outcome.sum), sum))
        } else if !is_least {
            Some(("minimum", "be one of its arguments", format!("{:e}", outcome.least), least.into()))
        } else if !is_told {
            Some(("comparison with 0", "hold for 0 and above", outcome.holds.to_string(), least.into()))
        } else if error.is_nan() || error > 1.0 {
            Some(("value of a half-plane", &*bound, format!("{value:e}"), exact))
        } else {
            None
        };
        if let (Some((what, must, given, exact)), None) = (why, &self.fault) {
            self.fault = Some(format!(
                "its f32 are not what exact ropes rely on: a {what} must {must}, but is {given} where {exact:e} is exact"
            ));
        }
        self.largest_error = self.largest_error.max(error);
        let is_flushed = product.abs() < NORMAL;
        self.flushes |= outcome.product == 0.0 && is_subnormal(product);
        self.rounds_to_nearest &= (is_flushed || outcome.product == product as f32) && outcome.sum == sum as f32;
    }
}

/// Whether a sample was made to have a subnormal product.
fn is_small(sample: &Sample) -> bool {
    (sample.normal.x * sample.p.x).abs() < 2f32.powi(-100)
}

/// Whether f32 has at most a subnormal number for it, and it is not 0.
fn is_subnormal(exact: f64) -> bool {
    exact != 0.0 && exact.abs() < NORMAL
}

/// Whether `result` is one of the two f32 between which `exact` lies, or it itself if it is one; or 0 for a subnormal one.
fn is_near(result: f32, exact: f64) -> bool {
    let nearest = exact as f32;
    let next = match f64::from(nearest).partial_cmp(&exact) {
        Some(Ordering::Less) => nearest.next_up(),
        Some(Ordering::Greater) => nearest.next_down(),
        _ => nearest,
    };
    result == nearest || result == next || (exact.abs() < NORMAL && result == 0.0)
}

/// Normals that are close to 0 or subnormal themselves, and 0 from either side.
const SMALL: [f32; 8] =
    [0.0, -0.0, 1e-40, -1e-40, f32::from_bits(1), -f32::from_bits(1), f32::MIN_POSITIVE, -f32::MIN_POSITIVE];

/// Half-planes and points close to their lines, where rounding counts most; some have subnormal products or coordinates.
fn samples() -> Vec<Sample> {
    let mut state = 1u64;
    // SplitMix64 (Steele, Lea and Flood, OOPSLA 2014), from -1 to 1.
    let mut draw = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as i64 as f64 / 2f64.powi(63)
    };
    let sample = |i: usize| {
        let along = DVec2::from_angle(draw() * std::f64::consts::PI);
        let normal = (along * (1.0 + (LONGEST_NORMAL - 1.0) * draw().abs())).as_vec2();
        let p = DVec2::new(draw(), draw()).as_vec2();
        let close = draw() * 2f64.powi(-(i as i32 % 24));
        let offset = (close - normal.as_dvec2().dot(p.as_dvec2())) as f32;
        let [q, a, b, origin] = std::array::from_fn(|_| DVec2::new(draw(), draw()).as_vec2());
        let dir = if draw() < 0.0 { -1.0 } else { 1.0 };
        let sample = Sample { normal, p, q, a, b, origin, offset, dir };
        let (tiny, less) = (2f32.powi(-100), 2f32.powi(-30));
        match i % 16 {
            0 => {
                Sample { normal: Vec2::new(normal.x * tiny, 0.0), p: Vec2::new(p.x * less, p.y), offset: 0.0, ..sample }
            }
            8 => {
                let small = SMALL[i / 16 % SMALL.len()];
                Sample { normal: Vec2::new(small, normal.y), p: Vec2::new(1.0, p.y), offset: 1.0, ..sample }
            }
            _ => sample,
        }
    };
    (0..SAMPLES).map(sample).collect()
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
