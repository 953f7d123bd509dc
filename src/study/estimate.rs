//! Standard errors and intervals.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::moments::Moments;
use super::order;
use super::student::{normal, student};

/// A number with its uncertainty: the true value lies between `low` and `high` as often as the study's confidence says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// The best guess.
    pub value: f64,
    /// Its standard error; `None` where too little was seen to say.
    pub error: Option<f64>,
    /// The lower end of the interval; `None` where too little was seen to say.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
}

/// How often intervals hold the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Confidence {
    /// The share of all studies in which they do not.
    outside: f64,
    /// So many standard deviations of a normal distribution leave that share of it outside.
    normal: f64,
}

impl Confidence {
    /// For intervals that hold the truth in this share of all studies, between 0 and 1.
    pub(super) fn new(share: f64) -> Self {
        let outside = 1.0 - share;
        Confidence { outside, normal: normal(outside) }
    }

    /// The mean of independent numbers: Student's interval.
    pub(super) fn mean(&self, moments: &Moments) -> Estimate {
        let error = moments.variance().map(|v| (v / moments.count as f64).sqrt());
        self.around(moments.mean, error, moments.count)
    }

    /// A value whose standard error was estimated from `count` independent parts: Student's interval. Fewer than two
    /// say nothing of an error.
    pub(super) fn around(&self, value: f64, error: Option<f64>, count: u64) -> Estimate {
        let error = error.filter(|_| count > 1);
        let half = error.map(|error| error * student(count - 1, self.outside));
        Estimate { value, error, low: half.map(|h| value - h), high: half.map(|h| value + h) }
    }

    /// The share of `count` among `of` independent cases: Wilson's interval (J. Am. Stat. Assoc. 22, 1927).
    pub(super) fn share(&self, count: u64, of: u64) -> Estimate {
        if of == 0 {
            return Estimate { value: 0.0, error: None, low: None, high: None };
        }
        let n = of as f64;
        let (p, q) = (count as f64 / n, (of - count) as f64 / n);
        let z2 = self.normal * self.normal;
        let half = self.normal * (p * q / n + z2 / (4.0 * n * n)).sqrt();
        // The ends solve (p - x)^2 = z^2 x (1 - x) / n. The lower is the square of p over the other solution, and so
        // keeps its digits where it is close to 0; the upper is as far from 1 as the lower of the cases left is from 0.
        let low = |p: f64| p * p / (p + z2 / (2.0 * n) + half);
        Estimate { value: p, error: Some((p * q / n).sqrt()), low: Some(low(p)), high: Some(1.0 - low(q)) }
    }

    /// The difference of the means of independent numbers: Student's interval with Welch's degrees of freedom
    /// (Biometrika 34, 1947), rounded down.
    pub(super) fn difference(&self, one: &Moments, other: &Moments) -> Estimate {
        let value = one.mean - other.mean;
        let of = |moments: &Moments| moments.variance().map(|v| (v / moments.count as f64, (moments.count - 1) as f64));
        let Some(((a, m), (b, n))) = of(one).zip(of(other)) else { return self.around(value, None, 0) };
        let freedom = ((a + b) * (a + b) / (a * a / m + b * b / n)).max(m.min(n));
        // Without any spread all degrees are as good.
        let freedom = if freedom.is_finite() { freedom as u64 } else { m.min(n) as u64 };
        self.around(value, Some((a + b).sqrt()), freedom + 1)
    }

    /// The difference of the shares among independent cases, each `(count, of)`: the interval made of Wilson's two
    /// (Newcombe, Stat. Med. 17, 1998, method 10).
    pub(super) fn share_difference(&self, one: (u64, u64), other: (u64, u64)) -> Estimate {
        let [a, b] = [one, other].map(|(count, of)| self.share(count, of));
        let value = a.value - b.value;
        let away = |end: Option<f64>, e: &Estimate| end.map(|end| end - e.value);
        let both = |x: Option<f64>, y: Option<f64>| x.zip(y).map(|(x, y)| x.hypot(y));
        Estimate {
            value,
            error: both(a.error, b.error),
            low: both(away(a.low, &a), away(b.high, &b)).map(|half| value - half),
            high: both(away(a.high, &a), away(b.low, &b)).map(|half| value + half),
        }
    }

    /// The ranks, counted from 1, of the two among `of` sorted numbers that hold the quantile of `share`, the exact
    /// interval of order statistics; `None` for an end that is beyond what was seen.
    pub(super) fn ranks(&self, share: f64, of: u64) -> [Option<u64>; 2] {
        order::ranks(share, of, self.outside)
    }
}

#[cfg(test)]
#[allow(clippy::excessive_precision)] // digits as they were computed
mod tests {
    use super::*;

    /// Of the whole numbers up to that, the given ones as often as said.
    fn moments(values: &[(f64, u64)]) -> Moments {
        let mut all = Moments::default();
        values.iter().for_each(|&(value, times)| (0..times).for_each(|_| all.add(value)));
        all
    }

    #[track_caller]
    fn close(found: f64, known: f64) {
        assert!((found - known).abs() <= 1e-13 * known.abs(), "{found:e} instead of {known:e}");
    }

    /// Half the interval's width in standard errors, by SciPy 1.17.1's `stats.t.isf((1 - confidence) / 2, traces - 1)`.
    #[test]
    fn means_have_students_interval_at_every_size() {
        let known = [
            (0.999999998, 2, 318309877.5164611),
            (0.999999998, 3, 22360.67943702495),
            (0.95, 1001, 1.9623390808264083),
            (0.95, 1002, 1.9623367052808798),
            (0.95, 1_000_000, 1.9599663568164791),
        ];
        for (confidence, traces, factor) in known {
            let found = Confidence::new(confidence).mean(&moments(&[(-1.0, traces / 2), (1.0, traces - traces / 2)]));
            close((found.high.unwrap() - found.value) / found.error.unwrap(), factor);
            close((found.value - found.low.unwrap()) / found.error.unwrap(), factor);
        }
        // The same by hand: 0 and 2 have the mean 1 and the error 1.
        let two = Confidence::new(0.95).mean(&moments(&[(0.0, 1), (2.0, 1)]));
        assert_eq!((two.value, two.error), (1.0, Some(1.0)));
        close(two.high.unwrap(), 1.0 + 12.706204736174694);
        let one = Confidence::new(0.95).mean(&moments(&[(3.0, 1)]));
        assert_eq!(one, Estimate { value: 3.0, error: None, low: None, high: None });
        let alike = Confidence::new(0.95).mean(&moments(&[(0.1, 1000)]));
        assert_eq!(alike, Estimate { value: 0.1, error: Some(0.0), low: Some(0.1), high: Some(0.1) });
        // One block has no error, whatever is said.
        assert_eq!(Confidence::new(0.95).around(3.0, Some(0.0), 1).high, None);
    }

    /// By hand: 0 and 2 against 1, 3, 1 and 3.
    #[test]
    fn differences_of_independent_means_have_welchs_interval() {
        let (one, other) = (moments(&[(0.0, 1), (2.0, 1)]), moments(&[(1.0, 2), (3.0, 2)]));
        // Variances of 2 and 4/3, so squared errors of 1 and 1/3: 16/9 over 1 + 1/27 are 1.71 degrees, so 1.
        let found = Confidence::new(0.95).difference(&one, &other);
        close(found.value, -1.0);
        close(found.error.unwrap(), (4.0f64 / 3.0).sqrt());
        close(found.high.unwrap(), -1.0 + 12.706204736174694 * (4.0f64 / 3.0).sqrt());
        let alike = Confidence::new(0.95).difference(&moments(&[(1.0, 9)]), &moments(&[(1.0, 5)]));
        assert_eq!(alike, Estimate { value: 0.0, error: Some(0.0), low: Some(0.0), high: Some(0.0) });
        assert_eq!(Confidence::new(0.95).difference(&one, &moments(&[(1.0, 1)])).error, None);
    }

    /// Newcombe's own example (Table II of the paper, method 10): 56 of 70 against 48 of 80.
    #[test]
    fn differences_of_independent_shares_have_newcombes_interval() {
        let found = Confidence::new(0.95).share_difference((56, 70), (48, 80));
        let [low, high] = [found.low.unwrap(), found.high.unwrap()];
        assert!((found.value - 0.2).abs() < 1e-15);
        assert!((low - 0.0524).abs() < 5e-5 && (high - 0.3339).abs() < 5e-5, "{low} to {high}");
        // None of either is not known to be none.
        let none = Confidence::new(0.95).share_difference((0, 10), (0, 10));
        assert!(none.value == 0.0 && none.high.unwrap() > 0.2 && none.low.unwrap() < -0.2);
    }

    /// How many of how many, at which confidence, the interval's lower end and how far its upper end is from 1:
    /// Wilson's formula, with mpmath 1.4.1 at 50 digits.
    #[test]
    fn shares_have_wilsons_interval_at_the_extremes() {
        let known = [
            (0, 1, 0.95, 0.0, 0.20654931437723745),
            (1, 1, 0.95, 0.20654931437723745, 0.0),
            (0, 10, 0.95, 0.0, 0.72246720013711083),
            (5, 10, 0.95, 0.23659309051256401, 0.23659309051256401),
            (1, 1_000_000_000, 0.95, 1.7652455495696318e-10, 0.99999999433506576),
            (999_999_999, 1_000_000_000, 0.95, 0.99999999433506576, 1.7652455495696318e-10),
            (1_000_000_000, 1_000_000_000, 0.95, 0.99999999615854119, 0.0),
            (3, 1_000_000_000_000_000, 1.0 - 1e-12, 1.58771040756308e-16, 0.99999999999994331),
        ];
        for (count, of, confidence, low, beyond) in known {
            let found = Confidence::new(confidence).share(count, of);
            close(found.low.unwrap(), low);
            assert!((1.0 - found.high.unwrap() - beyond).abs() <= 2e-16, "{count} of {of}: {found:?}");
            assert!(found.low.unwrap() <= found.value && found.value <= found.high.unwrap());
        }
        // All but one are as uncertain as one.
        let [one, others] =
            [1, 999_999_999].map(|count| Confidence::new(0.95).share(count, 1_000_000_000).error.unwrap());
        close(one, 9.999999995e-10);
        assert_eq!(one, others);
        assert_eq!(Confidence::new(0.95).share(0, 0).high, None);
    }
}
