//! Shapes of sums and products: what a device may make of them, and what it makes of them.
//!
//! One shape does not speak for others. SwiftShader keeps `(a + b) - a` as it is written and takes `(a - b) + b` for
//! `a`; other compilers do it the other way about. So the probe asks for every shape that the kernels have, and a test
//! holds it against their source.

#[cfg(test)]
mod source;

use std::fmt;
use std::ops::{Add, Mul, Sub};

use super::sample::Sample;

/// The shapes for which the probe asks, in its order, each as the kernels write it: the same letter is the same number.
pub(super) const SHAPES: [&str; 18] = [
    "(((a*b)+(c*d))+e)",
    "((a*b)+c)",
    "((a+b)-a)",
    "((a-b)+b)",
    "(a-b)",
    "((a*b)+(c*d))",
    "((a*b)-(c*d))",
    "(((a*b)-(c*d))*e)",
    "((a*(b-c))+(d*(e-f)))",
    "(a-((b*(c-d))+(e*(f-g))))",
    "(((a*(b-c))-(d*(e-f)))*g)",
    "(((a-b)*c)-((d-e)*f))",
    "((((a-b)*c)-((d-e)*f))*g)",
    "((((a-b)*(c-d))-((e-d)*(f-b)))*g)",
    "((((a-(b-c))*(d-(e-f)))-((g-(e-f))*(h-(b-c))))*i)",
    "((a*(b-a))+(c*(d-c)))",
    "(((a-b)*(c-(a-b)))+((d-e)*(f-(d-e))))",
    "(((a-b)*((c-b)-(a-b)))+((d-e)*((f-e)-(d-e))))",
];

/// How a device computes a shape, as far as some thousand samples show; the first that explains all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Computed {
    /// Each sum and product is rounded to nearest, in the order in which they are written.
    AsWritten,
    /// Some product and sum are rounded once.
    Fused,
    /// Neither: sums are put in another order, say, or terms cancelled.
    Rewritten,
    /// With an error that is more than rounding, in whatever order.
    Wrong,
}

impl fmt::Display for Computed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Computed::AsWritten => "as written",
            Computed::Fused => "fused",
            Computed::Rewritten => "rewritten",
            Computed::Wrong => "wrong",
        })
    }
}

/// How the device computed all shapes of one sample each: those of `results[i]` from `samples[i]`.
pub(super) fn computed(sample: impl Fn(usize) -> Sample, results: &[f32; SHAPES.len()]) -> [Computed; SHAPES.len()] {
    std::array::from_fn(|i| {
        let (sample, result) = (sample(i), results[i]);
        let ways = shape(i, &sample, Ways::of);
        if result == ways.values[0] {
            return Computed::AsWritten;
        }
        if ways.values[..ways.count].contains(&result) {
            return Computed::Fused;
        }
        let exact = shape(i, &sample, Exact::of);
        // Of at most eight sums and products each is off by less than 2^-23 of the size, as is what goes into it.
        let is_near = (f64::from(result) - exact.value).abs() <= exact.size / f64::from(1 << 18);
        if is_near { Computed::Rewritten } else { Computed::Wrong }
    })
}

/// Numbers of which sums and products are made.
trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}
impl Number for Ways {}
impl Number for Exact {}

/// The shape of that number, as in `shaders/probe.wgsl`.
fn shape<N: Number>(number: usize, sample: &Sample, of: fn(f32) -> N) -> N {
    let Sample { normal, p, q, a, b, origin, offset, dir } = *sample;
    let [normal, p, q, a, b, origin] = [normal, p, q, a, b, origin].map(|v| [of(v.x), of(v.y)]);
    let [offset, dir] = [offset, dir].map(of);
    let minus = |u: [N; 2], v: [N; 2]| [u[0] - v[0], u[1] - v[1]];
    let cross = |u: [N; 2], v: [N; 2]| u[0] * v[1] - u[1] * v[0];
    let dot = |u: [N; 2], v: [N; 2]| u[0] * v[0] + u[1] * v[1];
    let way = minus(p, origin);
    match number {
        0 => normal[0] * p[0] + normal[1] * p[1] + offset,
        1 => normal[0] * p[0] + offset,
        2 => (normal[0] + offset) - normal[0],
        3 => (normal[0] - offset) + offset,
        4 => way[0],
        5 => dot(a, b),
        6 => cross(a, b),
        7 => cross(a, b) * dir,
        8 => dot(normal, way),
        9 => offset - dot(normal, way),
        10 => cross(normal, way) * dir,
        11 => cross(way, a),
        12 => cross(way, a) * dir,
        13 => cross(minus(a, p), minus(b, p)) * dir,
        14 => cross(minus(a, way), minus(b, way)) * dir,
        15 => dot(a, minus(b, a)),
        16 => dot(way, minus(q, way)),
        17 => dot(way, minus(minus(q, origin), way)),
        _ => unreachable!("there are no more shapes"),
    }
}

/// What a number may come out as where products and sums may be fused: first as written.
#[derive(Debug, Clone, Copy)]
struct Ways {
    values: [f32; 4],
    count: usize,
    /// The factors, if it is a product of two numbers that are known.
    product: Option<[f32; 2]>,
}

impl Ways {
    fn of(value: f32) -> Self {
        Ways { values: [value; 4], count: 1, product: None }
    }

    fn all(values: impl Iterator<Item = f32>) -> Self {
        let mut ways = Ways { values: [0.0; 4], count: 0, product: None };
        for value in values {
            ways.values[ways.count] = value;
            ways.count += 1;
        }
        ways
    }

    fn values(&self) -> impl Iterator<Item = f32> + Clone {
        self.values.into_iter().take(self.count)
    }
}

impl Add for Ways {
    type Output = Ways;
    fn add(self, other: Ways) -> Ways {
        let plain = self.values().flat_map(|x| other.values().map(move |y| x + y));
        let left = self.product.into_iter().flat_map(|[x, y]| other.values().map(move |z| x.mul_add(y, z)));
        let right = other.product.into_iter().flat_map(|[x, y]| self.values().map(move |z| x.mul_add(y, z)));
        Ways::all(plain.chain(left).chain(right))
    }
}

impl Sub for Ways {
    type Output = Ways;
    #[allow(clippy::suspicious_arithmetic_impl)] // a difference is the sum with the negative
    fn sub(self, other: Ways) -> Ways {
        let values = other.values.map(|x| -x);
        let product = other.product.map(|[x, y]| [-x, y]);
        self + Ways { values, product, ..other }
    }
}

impl Mul for Ways {
    type Output = Ways;
    fn mul(self, other: Ways) -> Ways {
        let product = (self.count == 1 && other.count == 1).then_some([self.values[0], other.values[0]]);
        let values = self.values().flat_map(|x| other.values().map(move |y| x * y));
        Ways { product, ..Ways::all(values) }
    }
}

/// What is exact but for the rounding of f64, and how large its parts are.
#[derive(Debug, Clone, Copy)]
struct Exact {
    value: f64,
    size: f64,
}

impl Exact {
    fn of(value: f32) -> Self {
        Exact { value: value.into(), size: value.abs().into() }
    }
}

impl Add for Exact {
    type Output = Exact;
    fn add(self, other: Exact) -> Exact {
        Exact { value: self.value + other.value, size: self.size + other.size }
    }
}

impl Sub for Exact {
    type Output = Exact;
    fn sub(self, other: Exact) -> Exact {
        Exact { value: self.value - other.value, size: self.size + other.size }
    }
}

impl Mul for Exact {
    type Output = Exact;
    fn mul(self, other: Exact) -> Exact {
        Exact { value: self.value * other.value, size: self.size * other.size }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::source::shapes;
    use super::*;
    use crate::gpu::{DECIDE_WGSL, PROBE_WGSL, RAYS_WGSL, SWEEP_WGSL};

    /// A sample in which everything is nothing but these.
    fn sample(normal: f32, p: f32, offset: f32) -> Sample {
        let none = Vec2::ZERO;
        let (normal, p) = (Vec2::new(normal, 0.0), Vec2::new(p, 0.0));
        Sample { normal, p, q: none, a: none, b: none, origin: none, offset, dir: 1.0 }
    }

    fn one(shape: usize, sample: Sample, result: f32) -> Computed {
        let mut results = [0.0; SHAPES.len()];
        results[shape] = result;
        computed(|_| sample, &results)[shape]
    }

    #[test]
    fn ways_of_computing_are_told_apart() {
        // The square of 1 + 2^-12 is 1 + 2^-11 + 2^-24, of which the last is rounded away.
        let x = 1.0 + 2f32.powi(-12);
        let (plain, fused) = (2f32.powi(-11), 2f32.powi(-11) + 2f32.powi(-24));
        for (result, expected) in [
            (plain, Computed::AsWritten),
            (fused, Computed::Fused),
            (plain - 2f32.powi(-24), Computed::Rewritten),
            (plain - 2f32.powi(-12), Computed::Wrong),
            (f32::NAN, Computed::Wrong),
        ] {
            assert_eq!(one(1, sample(x, x, -1.0), result), expected, "{result:e}");
        }
        // 1 is lost beside 2^30.
        let far = sample(1.0, 0.0, 2f32.powi(30));
        assert_eq!((one(3, far, 0.0), one(3, far, 1.0)), (Computed::AsWritten, Computed::Rewritten));
        let far = sample(2f32.powi(30), 0.0, 1.0);
        assert_eq!((one(2, far, 0.0), one(2, far, 1.0)), (Computed::AsWritten, Computed::Rewritten));
    }

    #[test]
    fn every_product_of_a_sum_can_be_fused() {
        let [a, b, c, d] = [1.1f32, 1.3, 1.7, 1.9].map(Ways::of);
        let found: Vec<f32> = (a * b - c * d).values().collect();
        let [a, b, c, d] = [1.1f32, 1.3, 1.7, 1.9];
        assert_eq!(found, [a * b - c * d, a.mul_add(b, -(c * d)), (-c).mul_add(d, a * b)]);
    }
    #[test]
    fn the_probe_asks_for_every_shape_of_the_shaders() {
        let asked = shapes(PROBE_WGSL);
        for (name, wgsl) in [("sweep.wgsl", SWEEP_WGSL), ("rays.wgsl", RAYS_WGSL), ("decide.wgsl", DECIDE_WGSL)] {
            let missing: Vec<_> = shapes(wgsl).difference(&asked).cloned().collect();
            assert!(missing.is_empty(), "probe.wgsl does not ask for these shapes of {name}: {missing:#?}");
        }
        // What is said of shapes goes by these names.
        for shape in SHAPES {
            assert!(asked.contains(shape), "probe.wgsl has no {shape}: {asked:#?}");
        }
    }

    /// Shaders with one sum or product more are found out, also where it only comes about when functions are put in
    /// place, or by what is kept in a variable.
    #[test]
    fn a_new_shape_in_a_shader_is_missed() {
        let asked = shapes(PROBE_WGSL);
        for (wgsl, right, wrong, shape) in [
            (SWEEP_WGSL, "p.y + query.far.z;", "p.y + query.far.z - p.x;", "((((a*b)+(c*d))+e)-b)"),
            (
                SWEEP_WGSL,
                "min(min(right, left), far)",
                "min(min(right + left, left), far)",
                "((((a*b)+(c*d))+e)+(((f*b)+(g*d))+h))",
            ),
            (RAYS_WGSL, "p.y + four.far;", "p.y + four.far - p.x;", "((((a*b)+(c*d))+e)-b)"),
            (DECIDE_WGSL, "return u.x * v.y - u.y * v.x;", "return u.x * v.y - u.y * v.x + 1.0;", "(((a*b)-(c*d))+e)"),
            (DECIDE_WGSL, "dot_of(p, q - p)", "dot_of(p, q + p)", "(((a-b)*((c-b)+(a-b)))+((d-e)*((f-e)+(d-e))))"),
            (DECIDE_WGSL, "kept[count] = p;", "kept[count] = p * 0.5;", "((((a-b)*c)*d)-(((e-f)*c)*g))"),
        ] {
            assert_eq!(wgsl.matches(right).count(), 1, "{right:?}");
            let found = shapes(&wgsl.replace(right, wrong));
            assert!(found.contains(shape), "{wrong}: {found:#?}");
            assert!(!asked.contains(shape), "{shape}");
        }
    }
}
