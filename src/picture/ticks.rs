//! Where an axis has its ticks, and what they are called.

use super::label::{exponent, fixed, power, power_text, width};

/// Ticks of an axis.
pub(super) struct Ticks {
    /// The values and their names.
    pub(super) marks: Vec<(f64, String)>,
    /// The names are in units of ten to the power of this.
    pub(super) exponent: i32,
}

impl Ticks {
    /// At most about `most` ticks at round values from `low` to `high`.
    pub(super) fn linear(low: f64, high: f64, most: usize) -> Self {
        let largest = low.abs().max(high.abs());
        let shown = match exponent(largest) {
            e if largest > 0.0 && !(-2..5).contains(&e) => e.div_euclid(3) * 3,
            _ => 0,
        };
        let (unit, tens) = step((high - low) / most.max(1) as f64);
        let size = unit as f64 * power(tens);
        let first = (low / size - 1e-6).ceil() as i64;
        let marks = (0..=2 * most as i64)
            .map(|i| first.saturating_add(i))
            .map(|i| (i, i as f64 * size))
            .take_while(|&(_, x)| x <= high + 1e-6 * size)
            // Named from whole numbers, so that no rounding shows.
            .map(|(i, x)| (x, fixed(i.saturating_mul(unit) as f64 * power(tens - shown), shown - tens)))
            .collect();
        Ticks { marks, exponent: shown }
    }

    /// As many ticks as have room along `length` pixels when their names stand side by side.
    pub(super) fn across(low: f64, high: f64, length: f64) -> Self {
        let most = (length / 60.0).clamp(2.0, 10.0) as usize;
        let ticks = |n| Ticks::linear(low, high, n);
        let fits = |t: &Ticks| t.marks.iter().map(|(_, name)| width(name, 12.0) + 10.0).sum::<f64>() <= length;
        (2..=most).rev().map(ticks).find(fits).unwrap_or_else(|| ticks(1))
    }

    /// Ticks at powers of ten, and between them where there are few.
    pub(super) fn logarithmic(low: f64, high: f64, most: usize) -> Self {
        let (from, to) = (exponent(low), exponent(high));
        let every = ((to - from) as usize / most.max(1) + 1) as i32;
        let between: &[i32] = match to - from {
            ..=2 => &[1, 2, 5],
            _ => &[1],
        };
        let marks = (from..=to)
            .filter(|e| e.rem_euclid(every) == 0)
            .flat_map(|e| between.iter().map(move |&unit| (unit, e)))
            .map(|(unit, e)| (f64::from(unit) * power(e), unit, e))
            .filter(|(x, ..)| (low..=high).contains(x))
            .map(|(x, unit, e)| (x, logarithmic_name(unit, e)))
            .collect();
        Ticks { marks, exponent: 0 }
    }

    /// The unit on the axis: `unit` times the power of ten that the names leave out.
    pub(super) fn unit(&self, unit: &str) -> String {
        match self.exponent {
            0 => unit.into(),
            e => format!("{} {unit}", power_text(e)),
        }
    }

    /// How wide the widest name is.
    pub(super) fn width(&self) -> f64 {
        self.marks.iter().map(|(_, name)| width(name, 12.0)).fold(0.0, f64::max)
    }
}

fn logarithmic_name(unit: i32, e: i32) -> String {
    match (unit, e) {
        (_, -3..=3) => fixed(f64::from(unit) * power(e), -e),
        (1, _) => power_text(e),
        _ => format!("{unit}×{}", power_text(e)),
    }
}

/// The least of 1, 2 and 5 times a power of ten that is not below `least`.
fn step(least: f64) -> (i64, i32) {
    if !(least > 0.0 && least.is_finite()) {
        return (1, 0);
    }
    let e = exponent(least);
    let unit = [1, 2, 5].into_iter().find(|&u| f64::from(u) * power(e) >= least * (1.0 - 1e-9));
    unit.map_or((1, e + 1), |u| (i64::from(u), e))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(ticks: &Ticks) -> Vec<&str> {
        ticks.marks.iter().map(|(_, name)| name.as_str()).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(names(&Ticks::linear(0.0, 1.0, 5)), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(names(&Ticks::linear(-3.0, 17.0, 5)), ["0", "5", "10", "15"]);
        assert_eq!(names(&Ticks::linear(-0.3, 0.3, 3)), ["−0.2", "0.0", "0.2"]);
        assert_eq!(names(&Ticks::linear(9900.0, 10_100.0, 2)), ["9900", "10\u{202F}000", "10\u{202F}100"]);
        let large = Ticks::linear(0.0, 2.1e9, 4);
        assert_eq!((names(&large), large.unit("m")), (vec!["0", "1", "2"], "10⁹ m".into()));
        let small = Ticks::linear(-2e-9, 2e-9, 4);
        assert_eq!((names(&small), small.unit("m")), (vec!["−2", "−1", "0", "1", "2"], "10⁻⁹ m".into()));
        assert_eq!(names(&Ticks::logarithmic(0.004, 3.0, 6)), ["0.01", "0.1", "1"]);
        assert_eq!(names(&Ticks::logarithmic(2e-7, 1e-6, 6)), ["2×10⁻⁷", "5×10⁻⁷", "10⁻⁶"]);
        assert_eq!(names(&Ticks::logarithmic(1e-9, 1.0, 4)), ["10⁻⁹", "10⁻⁶", "0.001", "1"]);
    }

    #[test]
    fn no_range_is_too_strange() {
        for (low, high) in [(1.0, 1.0), (1e9, 1e9 + 1e-7), (-1e150, 1e150), (0.0, 1e-136), (f64::NAN, 1.0)] {
            assert!(Ticks::across(low, high, 500.0).marks.len() < 25);
        }
    }
}
