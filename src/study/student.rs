//! Quantiles of the normal distribution and of Student's.
//!
//! Both are asked for by the share that lies *outside*, beyond the quantile on either side: of a confidence near 1 that
//! share keeps all its digits (1 - confidence is exact from 0.5 on), while 0.5 + 0.5 * confidence loses them.
//!
//! Elementary functions are those of `libm`, which give the same bytes on every machine.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

/// From so many degrees of freedom on, the share outside is computed by an asymptotic series, below by one that
/// converges.
const ASYMPTOTIC: u64 = 30;

/// How many terms of the asymptotic series are taken.
///
/// It follows from `outside = c * integral from L of exp(-T s) / sqrt(s) * phi(s / 2) ds` with T = freedom / 2 - 1/4,
/// L = ln(1 + t^2 / freedom) and phi(y) = (sinh(y) / y)^(-1/2), whose power series in y^2 is integrated term by term
/// (DiDonato and Morris, ACM Trans. Math. Softw. 18, 1992, section 9, for one parameter 1/2). Its coefficients
/// alternate and fall by 1/pi^2 each, so the error is about the first term left out. That is greatest for few degrees
/// of freedom and far out: 5e-18 of the share for 30 of them and a share of 1e-12, and 2e-14 for the least share there
/// is, 2^-53.
const TERMS: usize = 16;

/// The power series of (sinh(y) / y)^(-1/2) in y^2.
const SERIES: [f64; TERMS] = {
    // Of sinh(y) / y.
    let mut sinh = [1.0; TERMS];
    let mut n = 1;
    while n < TERMS {
        sinh[n] = sinh[n - 1] / (2 * n * (2 * n + 1)) as f64;
        n += 1;
    }
    // The power of a series (Euler): n d(n) = sum over k of (-k / 2 - (n - k)) s(k) d(n - k).
    let mut series = [1.0; TERMS];
    let mut n = 1;
    while n < TERMS {
        let (mut sum, mut k) = (0.0, 1);
        while k <= n {
            sum += (0.5 * k as f64 - n as f64) * sinh[k] * series[n - k];
            k += 1;
        }
        series[n] = sum / n as f64;
        n += 1;
    }
    series
};

/// A share outside and the density at the quantile.
struct Tail {
    outside: f64,
    density: f64,
}

/// So many standard deviations of a normal distribution on either side of its mean leave this share outside, above 0
/// and at most 1. Good to some units in the last place for shares up to 0.5; of larger ones, to those of the share
/// inside.
pub(super) fn normal(outside: f64) -> f64 {
    let tail = |t: f64| Tail { outside: libm::erfc(t / SQRT_2), density: libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt() };
    // No less than the quantile, since erfc(x) <= exp(-x^2).
    solve((-2.0 * libm::log(outside)).sqrt(), outside, tail)
}

/// The quantile of Student's distribution with that many degrees of freedom, at least 1, that leaves this share
/// outside, above 0 and at most 1. The relative error is below 1e-13 for shares up to 0.5.
pub(super) fn student(freedom: u64, outside: f64) -> f64 {
    let n = freedom as f64;
    match freedom {
        1 => 1.0 / libm::tan(FRAC_PI_2 * outside),
        2 => (1.0 - outside) / (outside * (1.0 - 0.5 * outside)).sqrt(),
        ..ASYMPTOTIC => {
            // Gamma((n + 1) / 2) / (sqrt(pi) Gamma(n / 2)).
            let start = if freedom % 2 == 1 { (1, 1.0 / PI) } else { (2, 0.5) };
            let factor = (start.0..freedom).step_by(2).fold(start.1, |f, k| f * (k + 1) as f64 / k as f64);
            solve(normal(outside), outside, |t| converging(n, factor, t))
        }
        _ => {
            let whole = asymptotic(n, 0.0);
            solve(normal(outside), outside, |t| {
                let along = libm::log1p(t * t / n);
                let density = ((0.5 * n - 0.25) / (n * PI)).sqrt() * libm::exp(-0.5 * (n + 1.0) * along) / whole;
                Tail { outside: asymptotic(n, along) / whole, density }
            })
        }
    }
}

/// The `t` with that share outside, by Newton's method on logarithms, starting at `t`. The logarithm of the share is a
/// concave falling function of ln t, so the steps converge from wherever they start: mostly four, some dozens where
/// nearly all is outside.
fn solve(mut t: f64, outside: f64, tail: impl Fn(f64) -> Tail) -> f64 {
    // What is inside has no digit left.
    if outside >= 1.0 {
        return 0.0;
    }
    for _ in 0..100 {
        let there = tail(t);
        let step = libm::log(there.outside / outside) * there.outside / (2.0 * t * there.density);
        t *= libm::exp(step);
        // What is left is about the square of the last step.
        if step.abs() < 1e-8 {
            break;
        }
    }
    t
}

/// For few degrees of freedom: the incomplete beta function as a series of positive terms. Close to the middle it is
/// that of the share inside, so that neither takes more than some thousand terms.
fn converging(n: f64, factor: f64, t: f64) -> Tail {
    let along = libm::log1p(t * t / n);
    let density = factor / n.sqrt() * libm::exp(-0.5 * (n + 1.0) * along);
    let outside = if t < 1.0 {
        1.0 - 2.0 * t * density * series(t * t / (n + t * t), 0.5 * n + 0.5, 1.5)
    } else {
        let edge = libm::exp(-0.5 * n * along) * t / (n + t * t).sqrt();
        2.0 * factor / n * edge * series(n / (n + t * t), 0.5 * n + 0.5, 0.5 * n + 1.0)
    };
    Tail { outside, density }
}

/// The sum over k of x^k a (a + 1) ... (a + k - 1) / (b (b + 1) ... (b + k - 1)), for x below 1.
fn series(x: f64, a: f64, b: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 0.0);
    loop {
        let ratio = x * (a + k) / (b + k);
        term *= ratio;
        sum += term;
        k += 1.0;
        // No later ratio is above the greater of this one and x, so what is left is less than a geometric series.
        let most = ratio.max(x);
        if most < 1.0 && term * most <= f64::EPSILON / 8.0 * sum * (1.0 - most) {
            return sum;
        }
    }
}

/// For many degrees of freedom: the share outside, but for a factor, where ln(1 + t^2 / n) is `along`. See [`TERMS`].
fn asymptotic(n: f64, along: f64) -> f64 {
    let rate = 0.5 * n - 0.25;
    // The integral from `along` of sqrt(rate / pi) exp(-rate s) s^(2 i - 1/2), by parts from that of the term before.
    let mut integral = libm::erfc((rate * along).sqrt());
    let mut edge = (rate / PI).sqrt() * libm::exp(-rate * along) * along.sqrt() / rate;
    let mut quarter = 1.0;
    let mut sum = 0.0;
    for (i, coefficient) in SERIES.iter().enumerate() {
        sum += coefficient * quarter * integral;
        let (low, high) = (2.0 * i as f64 + 0.5, 2.0 * i as f64 + 1.5);
        integral = edge * (along + high / rate) + high * low / (rate * rate) * integral;
        edge *= along * along;
        quarter /= 4.0;
    }
    sum
}

#[cfg(test)]
#[allow(clippy::excessive_precision)] // digits as they were computed
mod tests {
    use super::*;

    /// Degrees of freedom, confidence, quantile.
    ///
    /// Computed with mpmath 1.4.1 at 60 digits, for the confidence as the f64 that stands here: the root of
    /// `betainc(n/2, 1/2, 0, n/(n+t*t), regularized=True) == 1 - confidence` up to 10,000 degrees, beyond by the
    /// expansion of Cornish and Fisher (Abramowitz and Stegun 26.7.5, four terms), which at 100,000 degrees agrees with
    /// the root to 1e-20. SciPy 1.17.1's `stats.t.isf((1 - confidence) / 2, n)` gives the same to 2e-15.
    #[rustfmt::skip]
    const KNOWN: [(u64, f64, f64); 64] = [
        (1, 0.5, 1.0),
        (1, 0.95, 12.706204736174693),
        (1, 0.999999998, 318309877.51646106),
        (1, 1.0 - 1e-12, 636633855803.5593),
        (2, 0.5, 0.81649658092772603),
        (2, 0.95, 4.3026527297494618),
        (2, 0.999999998, 22360.679437024951),
        (2, 1.0 - 1e-12, 1000011.0610428281),
        (3, 0.5, 0.76489232840434528),
        (3, 0.95, 3.1824463052837084),
        (3, 0.999999998, 1033.1096651268634),
        (3, 1.0 - 1e-12, 13016.476782874553),
        (4, 0.5, 0.74069708411268263),
        (4, 0.95, 2.7764451051977935),
        (4, 0.999999998, 234.0276088129247),
        (4, 1.0 - 1e-12, 1565.092170884186),
        (5, 0.8, 1.4758840488244813),
        (5, 0.99, 4.0321429835552272),
        (5, 1.0 - 1e-12, 452.54122659108977),
        (8, 0.8, 1.3968153097438649),
        (8, 0.99, 3.3553873313333949),
        (8, 1.0 - 1e-12, 76.012154463792721),
        (13, 0.8, 1.3501712887800552),
        (13, 0.99, 3.012275838716578),
        (13, 1.0 - 1e-12, 26.627967038740461),
        (22, 0.8, 1.3212367416133618),
        (22, 0.99, 2.8187560606001431),
        (22, 1.0 - 1e-12, 14.477773988988402),
        (29, 0.5, 0.68304386082161315),
        (29, 0.95, 2.0452296421327039),
        (29, 0.999999998, 8.5564272965334589),
        (29, 1.0 - 1e-12, 11.951355221885924),
        (30, 0.5, 0.68275569332129255),
        (30, 0.95, 2.0422724563012379),
        (30, 0.999999998, 8.445862785522561),
        (30, 1.0 - 1e-12, 11.722018886810611),
        (57, 0.8, 1.2965810437990111),
        (57, 0.99, 2.6648704822419714),
        (57, 1.0 - 1e-12, 9.1156485647528194),
        (100, 0.8, 1.2900747613465161),
        (100, 0.99, 2.6258905214380176),
        (100, 1.0 - 1e-12, 8.1655332781695255),
        (1000, 0.5, 0.67473516460700944),
        (1000, 0.95, 1.9623390808264081),
        (1000, 0.999999998, 6.0536902675348582),
        (1000, 1.0 - 1e-12, 7.2239577505187438),
        (1001, 0.5, 0.67473491935844706),
        (1001, 0.95, 1.9623367052808795),
        (1001, 0.999999998, 6.0536339954064642),
        (1001, 1.0 - 1e-12, 7.2238633607334601),
        (10000, 0.8, 1.2816362297304777),
        (10000, 0.99, 2.5763210466685286),
        (10000, 1.0 - 1e-12, 7.139761992691773),
        (1000000, 0.5, 0.67448999553108738),
        (1000000, 0.95, 1.9599663568141067),
        (1000000, 0.999999998, 5.9978624512878209),
        (1000000, 1.0 - 1e-12, 7.1306023127441386),
        (1000000000, 0.8, 1.2815515663911854),
        (1000000000, 0.99, 2.5758293084654481),
        (1000000000, 1.0 - 1e-12, 7.1305099852981176),
        (9007199254740992, 0.5, 0.67448975019608177),
        (9007199254740992, 0.95, 1.9599639845400541),
        (9007199254740992, 0.999999998, 5.9978070105847389),
        (9007199254740992, 1.0 - 1e-12, 7.1305098928792827),
    ];

    #[test]
    fn students_quantiles_are_those_of_high_precision() {
        for (freedom, confidence, known) in KNOWN {
            let error = student(freedom, 1.0 - confidence) / known - 1.0;
            assert!(error.abs() < 1e-13, "{freedom} degrees, {confidence}: {error:e}");
        }
    }

    /// The two ways of computing meet, and no number of degrees makes a jump: the quantile falls towards the normal
    /// one, by about (z^3 + z) / (4 n^2) from n to n + 1.
    #[test]
    fn quantiles_fall_with_the_degrees_of_freedom() {
        for confidence in [0.01, 0.5, 0.9, 0.95, 0.999, 1.0 - 1e-12, 1.0 - f64::EPSILON / 2.0] {
            let outside = 1.0 - confidence;
            let z = normal(outside);
            for freedom in (1..3000).chain([1 << 20, 1 << 40]) {
                let (this, next) = (student(freedom, outside), student(freedom + 1, outside));
                assert!(
                    next <= this * (1.0 + 1e-13) && next >= z * (1.0 - 1e-13),
                    "{freedom}, {confidence}: {this}, {next}"
                );
                let n = freedom as f64;
                if freedom > 1000 {
                    let fall = (z * z * z + z) / (4.0 * n * (n + 1.0));
                    assert!(((this - next) - fall).abs() < 0.1 * fall + 1e-14 * z, "{freedom}, {confidence}");
                }
            }
        }
    }

    /// mpmath 1.4.1 at 40 digits: `sqrt(2) * erfinv(confidence)`.
    #[test]
    fn normal_quantiles_are_those_of_high_precision() {
        let known = [
            (0.5, 0.67448975019608174),
            (0.8, 1.2815515655446006),
            (0.95, 1.9599639845400539),
            (0.99, 2.5758293035489005),
            (0.999999998, 5.9978070105847327),
            (1.0 - 1e-12, 7.1305098928792724),
        ];
        for (confidence, known) in known {
            let error = normal(1.0 - confidence) / known - 1.0;
            assert!(error.abs() < 1e-14, "{confidence}: {error:e}");
        }
    }

    /// Confidences so small that their complement loses digits: nothing hangs, and what is left of the digits is right.
    #[test]
    fn nearly_everything_outside() {
        for confidence in [1e-3, 1e-6, 1e-9] {
            let z = confidence * (PI / 2.0).sqrt();
            assert!((normal(1.0 - confidence) / z - 1.0).abs() < 1e-6);
            // The density at 0 is 2 / (pi sqrt(3)) for 3 degrees.
            let three = confidence / 2.0 / (2.0 / (PI * 3.0f64.sqrt()));
            assert!((student(3, 1.0 - confidence) / three - 1.0).abs() < 1e-6);
            assert!((student(1 << 30, 1.0 - confidence) / z - 1.0).abs() < 1e-6);
        }
        for freedom in [1, 2, 3, 29, 30, 1 << 50] {
            assert!(student(freedom, 1.0).abs() < 1e-15);
        }
    }
}
