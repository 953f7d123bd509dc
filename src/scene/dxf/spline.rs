//! Splines as Bezier curves.

use crate::words::plainly;
use glam::DVec2;

/// The highest degree that is taken. CAD programs make cubic ones and write at most this.
const DEGREE_MAX: usize = 11;

/// The Bezier curves, each with all its control points, of a B-spline of this degree over these knots: one for each
/// span between different knots. O(points).
///
/// # Errors
///
/// Numbers of knots and control points that do not fit each other, knots that descend.
pub(super) fn beziers(degree: usize, knots: &[f64], points: &[DVec2]) -> Result<Vec<Vec<DVec2>>, String> {
    if !(1..=DEGREE_MAX).contains(&degree) {
        return Err(format!("degree {degree}; it must be from 1 to {DEGREE_MAX}"));
    }
    if points.len() <= degree || knots.len() != points.len() + degree + 1 {
        let (knots, points, more) = (knots.len(), points.len(), degree + 1);
        let right = format!("degree {degree} needs at least {more} points and {more} knots more than points");
        let [knots, points] =
            [plainly(knots as u64, "knot", "knots"), plainly(points as u64, "control point", "control points")];
        return Err(format!("{knots} for {points}; {right}"));
    }
    if let Some(pair) = knots.windows(2).find(|pair| pair[0].partial_cmp(&pair[1]).is_none_or(|order| order.is_gt())) {
        return Err(format!("the knot {} comes before {}; knots must ascend", pair[0], pair[1]));
    }
    let spans = (degree..points.len()).filter(|&j| knots[j] < knots[j + 1]);
    let bezier = |j: usize| {
        let (knots, points) = (&knots[j - degree..], &points[j - degree..=j]);
        (0..=degree).map(|i| blossom(knots, points, i)).collect()
    };
    Ok(spans.map(bezier).collect())
}

/// Control point `i` of the Bezier curve over the span that the control points `points` decide: the polar form of
/// the spline (Ramshaw), with `i` of its arguments at the span's end and the others at its beginning.
///
/// `knots` begin with the first one that bears on the span.
fn blossom(knots: &[f64], points: &[DVec2], i: usize) -> DVec2 {
    let degree = points.len() - 1;
    let mut points = points.to_vec();
    for round in 1..=degree {
        let at = if round <= i { knots[degree + 1] } else { knots[degree] };
        for k in (round..=degree).rev() {
            let [from, to] = [knots[k], knots[k + degree + 1 - round]];
            let share = (at - from) / (to - from);
            points[k] = points[k - 1] * (1.0 - share) + points[k] * share;
        }
    }
    points[degree]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The point at `t` by de Boor's recursion on basis functions: slow, and another way.
    fn basis(degree: usize, knots: &[f64], i: usize, t: f64) -> f64 {
        if degree == 0 {
            return f64::from(knots[i] <= t && t < knots[i + 1]);
        }
        let part = |from: f64, to: f64, value: f64| if to > from { value / (to - from) } else { 0.0 };
        part(knots[i], knots[i + degree], t - knots[i]) * basis(degree - 1, knots, i, t)
            + part(knots[i + 1], knots[i + degree + 1], knots[i + degree + 1] - t) * basis(degree - 1, knots, i + 1, t)
    }

    fn bezier(points: &[DVec2], t: f64) -> DVec2 {
        match points {
            [p] => *p,
            _ => bezier(&points[..points.len() - 1], t) * (1.0 - t) + bezier(&points[1..], t) * t,
        }
    }

    #[test]
    fn the_curve_stays_the_same() {
        let points: Vec<DVec2> = (0..8).map(|i| DVec2::new(f64::from(i), f64::from(i * i * 7 % 5))).collect();
        for (degree, knots) in [
            (3, vec![0., 0., 0., 0., 1., 2., 3., 4., 5., 5., 5., 5.]),
            (3, vec![0., 0., 0., 0., 1., 1., 3., 3., 5., 5., 5., 5.]),
            (3, (0..12).map(f64::from).collect()),
            (2, vec![0., 0., 0., 0.5, 1., 2., 3., 4., 5., 5., 5.]),
            (1, (0..10).map(f64::from).collect()),
            (5, (0..14).map(f64::from).collect()),
        ] {
            let curves = beziers(degree, &knots, &points).unwrap();
            let mut spans: Vec<f64> = knots[degree..=points.len()].to_vec();
            spans.dedup();
            assert_eq!(curves.len(), spans.len() - 1, "{degree} {knots:?}");
            for (curve, span) in curves.iter().zip(spans.windows(2)) {
                assert_eq!(curve.len(), degree + 1);
                for k in 0..10 {
                    let t = f64::from(k) / 10.0;
                    let at = span[0] + (span[1] - span[0]) * t;
                    let right: DVec2 = points.iter().enumerate().map(|(i, &p)| p * basis(degree, &knots, i, at)).sum();
                    assert!(bezier(curve, t).distance(right) < 1e-12, "{degree} {knots:?} at {at}");
                }
            }
            assert!(curves.windows(2).all(|c| c[0][degree].distance(c[1][0]) < 1e-12));
        }
    }

    #[test]
    fn splines_that_do_not_fit_are_refused() {
        let points = [DVec2::ZERO; 4];
        let fault = |degree, knots: &[f64]| beziers(degree, knots, &points).unwrap_err();
        assert!(fault(0, &[]).starts_with("degree 0; "));
        assert!(fault(3, &[0.0; 7]).starts_with("7 knots for 4 control points; degree 3 needs at least 4 points"));
        assert!(fault(4, &[0.0; 9]).starts_with("9 knots for 4 control points; "));
        assert!(fault(3, &[0., 0., 0., 0., 1., 0., 1., 1.]).contains("the knot 1 comes before 0"));
        assert!(fault(3, &[0., 0., 0., f64::NAN, 1., 1., 1., 1.]).contains("knots must ascend"));
        // All knots are one: there is no curve, and no endless loop.
        assert!(beziers(3, &[1.0; 8], &points).unwrap().is_empty());
    }
}
