//! What a device makes of f32, found out by asking it: the candidate pass relies on some of it.

use std::cmp::Ordering;
use std::fmt;

use bytemuck::{Pod, Zeroable};

use super::sample::Sample;
use super::shapes::{Computed, SHAPES, computed};
use crate::candidates::ARITHMETIC;

/// The least f32 that is not subnormal.
const NORMAL: f64 = f32::MIN_POSITIVE as f64;

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
/// The bound of the candidate pass ([`MARGIN`](crate::candidates::MARGIN), step 1) assumes that a product or sum is one
/// of the two nearest f32, that subnormal numbers may be taken for 0, that products and sums may be fused and put in
/// another order, that a minimum is one of its arguments, and that a comparison with 0 holds for 0 and above. Whether a
/// device fuses, flushes or rewrites sums is told, shape by shape, because it decides close calls with `--precision
/// fast`.
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

impl fmt::Display for Arithmetic {
    /// What it is fit for, and how it computes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(fault) = &self.fault {
            return write!(f, "fit for precision fast only: {fault}");
        }
        let rounds = if self.rounds_to_nearest { "rounds to nearest" } else { "rounds either way" };
        let fuses = if self.fuses { "fuses" } else { "fuses nothing" };
        let flushes = if self.flushes { "flushes subnormals" } else { "keeps subnormals" };
        let error = 100.0 * self.largest_error;
        write!(
            f,
            "fit for exact ropes, with errors of at most {error:.0} % of the bound; {rounds}, {fuses}, {flushes}, "
        )?;
        let rewritten = self.shapes.iter().filter(|(_, computed)| *computed > Computed::Fused);
        let rewritten: Vec<&str> = rewritten.map(|(shape, _)| *shape).collect();
        if rewritten.is_empty() {
            return f.write_str("computes all sums as they are written");
        }
        let (count, all) = (rewritten.len(), self.shapes.len());
        write!(f, "rewrites {count} of {all} shapes of sums: {}", rewritten.join(", "))
    }
}

impl Arithmetic {
    /// Learned from what the device made of `samples`.
    pub(super) fn learned(samples: &[Sample], outcomes: &[Outcome]) -> Self {
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
            let of_shape = |shape| samples[(i + shape) % samples.len()];
            for (shape, computed) in computed(of_shape, &outcome.shapes).into_iter().enumerate() {
                // What becomes of subnormal numbers is another question.
                if !of_shape(shape).is_small() {
                    found.shapes[shape].1 = found.shapes[shape].1.max(computed);
                }
            }
        }
        found.fuses = found.shapes.iter().any(|(_, computed)| *computed == Computed::Fused);
        found
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
                "its f32 are not what exact ropes rely on: a {what} must {must}, but is {given} where {exact:e} is \
                 exact"
            ));
        }
        self.largest_error = self.largest_error.max(error);
        let is_flushed = product.abs() < NORMAL;
        self.flushes |= outcome.product == 0.0 && is_subnormal(product);
        self.rounds_to_nearest &= (is_flushed || outcome.product == product as f32) && outcome.sum == sum as f32;
    }
}

/// Whether f32 has at most a subnormal number for it, and it is not 0.
fn is_subnormal(exact: f64) -> bool {
    exact != 0.0 && exact.abs() < NORMAL
}

/// Whether `result` is one of the two f32 between which `exact` lies, or it itself if it is one; or 0 for a subnormal
/// one.
fn is_near(result: f32, exact: f64) -> bool {
    let nearest = exact as f32;
    let next = match f64::from(nearest).partial_cmp(&exact) {
        Some(Ordering::Less) => nearest.next_up(),
        Some(Ordering::Greater) => nearest.next_down(),
        _ => nearest,
    };
    result == nearest || result == next || (exact.abs() < NORMAL && result == 0.0)
}
