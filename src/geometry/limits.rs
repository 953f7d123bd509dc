//! Which coordinates can be computed with exactly.

use glam::DVec2;

/// The largest magnitude of a coordinate: 2^500, about 3.27e150.
///
/// A signed area multiplies two coordinate differences (each below 2^501) and adds two such products: below 2^1004,
/// which leaves room for the error terms of the exact arithmetic under the f64 maximum of 2^1024.
pub const COORDINATE_MAX: f64 = f64::from_bits((1023 + 500) << 52);

/// The smallest magnitude of a coordinate that is not zero: 2^-450, about 3.4e-136.
///
/// Such a coordinate is a multiple of 2^-502, so every exact product of two differences is a multiple of 2^-1004: no
/// part of it falls below the smallest f64, 2^-1074. And where such a product does not fit 53 bits, it is at least
/// 2^-951, so the predicates' error bound, 2^-51 of that, is itself a normal number (above 2^-1022) and as large as it
/// should be.
pub const COORDINATE_MIN: f64 = f64::from_bits((1023 - 450) << 52);

/// Why a coordinate cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CoordinateFault {
    /// A NaN or an infinity.
    #[error("{0} is not a finite number")]
    NotFinite(f64),
    /// Above [`COORDINATE_MAX`] in magnitude.
    #[error("{0:e} is too large for exact products: coordinates must lie within 2^500 (3.27e150) of zero")]
    TooLarge(f64),
    /// Below [`COORDINATE_MIN`] in magnitude and not zero.
    #[error("{0:e} is too small for exact products: coordinates must be 0 or at least 2^-450 (3.4e-136) in magnitude")]
    TooSmall(f64),
}

/// Checks both coordinates of `point` and turns a negative zero into a positive one, so that equal points have equal
/// bits.
///
/// # Errors
///
/// The first coordinate that is not finite, too large or too small for exact products.
///
/// ```
/// use tautline::geometry::check_point;
/// assert!(check_point([1.0, -0.0].into()).is_ok());
/// assert!(check_point([f64::NAN, 0.0].into()).is_err());
/// assert!(check_point([1e200, 0.0].into()).is_err());
/// ```
pub fn check_point(point: DVec2) -> Result<DVec2, CoordinateFault> {
    Ok(DVec2::new(check(point.x)?, check(point.y)?))
}

/// The point itself, but for coordinates too small to compute with exactly, which become 0; so does a negative zero.
#[inline]
pub(crate) fn point(p: DVec2) -> DVec2 {
    let fit = |c: f64| if c.abs() < COORDINATE_MIN { 0.0 } else { c };
    DVec2::new(fit(p.x), fit(p.y))
}

/// [`check_point`] for many points at once; zeros keep their signs. A few instructions a point.
///
/// # Errors
///
/// The first coordinate that is not finite, too large or too small, with the index of its point.
pub fn check_points(points: &[DVec2]) -> Result<(), (usize, CoordinateFault)> {
    let fits = |c: f64| {
        let size = c.abs();
        // No branches, so that several points are looked at in one instruction. A NaN fits no comparison.
        (COORDINATE_MIN..=COORDINATE_MAX).contains(&size) | (size == 0.0)
    };
    if points.iter().fold(true, |sound, p| sound & fits(p.x) & fits(p.y)) {
        return Ok(());
    }
    points.iter().enumerate().try_for_each(|(i, &p)| check_point(p).map(drop).map_err(|fault| (i, fault)))
}

fn check(c: f64) -> Result<f64, CoordinateFault> {
    if !c.is_finite() {
        Err(CoordinateFault::NotFinite(c))
    } else if c.abs() > COORDINATE_MAX {
        Err(CoordinateFault::TooLarge(c))
    } else if c != 0.0 && c.abs() < COORDINATE_MIN {
        Err(CoordinateFault::TooSmall(c))
    } else {
        Ok(c + 0.0)
    }
}

/// A point as messages show it: `(1, -2.5)`, with exponents where plain digits would be many.
pub(crate) struct Shown(pub DVec2);

impl std::fmt::Display for Shown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", number(self.0.x), number(self.0.y))
    }
}

/// A number as messages show it: the fewest digits that name it, with an exponent where plain ones would be many.
///
/// ```
/// use tautline::geometry::number;
///
/// assert_eq!([0.4, 2.0, 1e-300].map(number), ["0.4", "2", "1e-300"]);
/// ```
pub fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e16).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_the_powers_of_two_they_say() {
        assert_eq!(COORDINATE_MAX, 2f64.powi(500));
        assert_eq!(COORDINATE_MIN, 2f64.powi(-450));
    }

    #[test]
    fn the_first_refused_magnitude_lies_just_outside() {
        let up = |x: f64| f64::from_bits(x.to_bits() + 1);
        let down = |x: f64| f64::from_bits(x.to_bits() - 1);
        assert!(check(COORDINATE_MAX).is_ok() && check(-COORDINATE_MIN).is_ok());
        assert_eq!(check(up(COORDINATE_MAX)), Err(CoordinateFault::TooLarge(up(COORDINATE_MAX))));
        assert_eq!(check(down(COORDINATE_MIN)), Err(CoordinateFault::TooSmall(down(COORDINATE_MIN))));
        assert!(check(f64::INFINITY).is_err());
        let sizes = [0.0, 1.0, COORDINATE_MIN, down(COORDINATE_MIN), COORDINATE_MAX, up(COORDINATE_MAX), f64::NAN];
        for c in sizes.into_iter().chain([f64::INFINITY, 5e-324]).flat_map(|c| [c, -c]) {
            for bad in [DVec2::new(c, 1.0), DVec2::new(1.0, c)] {
                let found = check_points(&[DVec2::ZERO, bad, bad]).map_err(|(i, fault)| (i, fault.to_string()));
                assert_eq!(found, check(c).map(drop).map_err(|fault| (1, fault.to_string())));
            }
        }
        assert_eq!(check(-0.0).unwrap().to_bits(), 0);
    }
}
