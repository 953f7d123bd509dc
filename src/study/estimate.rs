//! Standard errors and intervals.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::summary::Estimate;
use super::tally::Moments;

/// How often intervals hold the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Confidence {
    share: f64,
    /// So many standard deviations of a normal distribution hold that share of it.
    normal: f64,
}

impl Confidence {
    /// For intervals that hold the truth in this share of all studies, between 0 and 1.
    pub(super) fn new(share: f64) -> Self {
        let normal = Normal::standard().inverse_cdf(0.5 + 0.5 * share);
        Confidence { share, normal }
    }

    /// The mean of independent numbers: Student's interval.
    pub(super) fn mean(&self, moments: &Moments) -> Estimate {
        let error = moments.variance().map(|v| (v / moments.count as f64).sqrt());
        self.around(moments.mean, error, moments.count)
    }

    /// A value whose standard error was estimated from `count` independent parts: Student's interval.
    pub(super) fn around(&self, value: f64, error: Option<f64>, count: u64) -> Estimate {
        let half = error.map(|error| error * self.student(count.saturating_sub(1)));
        Estimate { value, error, low: half.map(|h| value - h), high: half.map(|h| value + h) }
    }

    /// The share of `count` among `of` independent cases: Wilson's interval (J. Am. Stat. Assoc. 22, 1927).
    pub(super) fn share(&self, count: u64, of: u64) -> Estimate {
        if of == 0 {
            return Estimate { value: 0.0, error: None, low: None, high: None };
        }
        let (n, p) = (of as f64, count as f64 / of as f64);
        let z2 = self.normal * self.normal;
        let centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half = self.normal / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
        // The ends are exact where nothing or everything was seen.
        let low = if count == 0 { 0.0 } else { centre - half };
        let high = if count == of { 1.0 } else { centre + half };
        Estimate { value: p, error: Some((p * (1.0 - p) / n).sqrt()), low: Some(low), high: Some(high) }
    }

    /// The shares of `of` sorted numbers between which the quantile of `share` lies: the ranks of the order statistics that
    /// hold it, by the normal approximation of their binomial distribution.
    pub(super) fn ranks(&self, share: f64, of: u64) -> [f64; 2] {
        let half = self.normal * (share * (1.0 - share) / of as f64).sqrt();
        [(share - half).max(0.0), (share + half).min(1.0)]
    }

    fn student(&self, freedom: u64) -> f64 {
        // Beyond a thousand degrees of freedom the difference from the normal distribution is below a thousandth.
        match freedom {
            0 => f64::INFINITY,
            1..=1000 => StudentsT::new(0.0, 1.0, freedom as f64)
                .expect("degrees of freedom are positive")
                .inverse_cdf(0.5 + 0.5 * self.share),
            _ => self.normal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_quantiles() {
        let c = Confidence::new(0.95);
        assert!((c.normal - 1.959964).abs() < 1e-6);
        // Tables of Student's distribution.
        assert!((c.student(1) - 12.7062).abs() < 1e-3 && (c.student(10) - 2.22814).abs() < 1e-4);
        // Brown, Cai and DasGupta, Stat. Sci. 16 (2001): Wilson's interval of 0 of 10 ends at z^2 / (n + z^2).
        let none = c.share(0, 10);
        assert_eq!(none.low, Some(0.0));
        assert!((none.high.unwrap() - 3.8415 / 13.8415).abs() < 1e-4);
        let half = c.share(5, 10);
        assert!((half.low.unwrap() - 0.2366).abs() < 1e-4 && (half.high.unwrap() - 0.7634).abs() < 1e-4);
    }
}
