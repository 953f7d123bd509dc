//! What a device is asked to find out what it makes of f32.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec2};

use crate::candidates::LONGEST_NORMAL;

/// How many samples there are: enough to meet every way of rounding many times, few enough for a millisecond.
const SAMPLES: usize = 4096;

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

impl Sample {
    /// Whether it was made to have a subnormal product.
    pub(super) fn is_small(&self) -> bool {
        (self.normal.x * self.p.x).abs() < 2f32.powi(-100)
    }
}

/// Normals that are close to 0 or subnormal themselves, and 0 from either side.
const SMALL: [f32; 8] =
    [0.0, -0.0, 1e-40, -1e-40, f32::from_bits(1), -f32::from_bits(1), f32::MIN_POSITIVE, -f32::MIN_POSITIVE];

/// Half-planes and points close to their lines, where rounding counts most; some have subnormal products or
/// coordinates.
pub(super) fn samples() -> Vec<Sample> {
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
