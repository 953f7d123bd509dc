//! The box round lines and curves: where curves themselves turn back, not where their control points or whole circles
//! lie.

use glam::{DAffine2, DVec2};

use super::curves::{Curve, Ellipse, Piece};

/// How often a curve is halved at most in search of its extremes; each time the search is four times as close.
const HALVINGS_MAX: usize = 64;

/// The lowest and highest x and y of `pieces` in the coordinates that `transform` leads to; `None` if nothing is drawn.
///
/// Extremes of arcs are as exact as their centre and radii, those of Bezier curves to 2^-48 of their coordinates.
pub(super) fn extent(pieces: &[Piece], transform: DAffine2) -> Option<[DVec2; 2]> {
    let place = |p: DVec2| transform.transform_point2(p);
    let ends = pieces.iter().filter_map(|piece| match piece {
        Piece::Object => None,
        Piece::Start(p) | Piece::Line(p) | Piece::Curve(_, p) => Some(place(*p)),
    });
    let [mut low, mut high] = ends.map(|p| [p, p]).reduce(|[l, h], [p, _]| [l.min(p), h.max(p)])?;
    for piece in pieces {
        let Piece::Curve(curve, _) = piece else { continue };
        match &**curve {
            Curve::Bezier(points) => {
                for axis in 0..2 {
                    let along: Vec<f64> = points.iter().map(|&p| place(p)[axis]).collect();
                    low[axis] = -highest(along.iter().map(|x| -x).collect(), -low[axis]);
                    high[axis] = highest(along, high[axis]);
                }
            }
            Curve::Ellipse(e) => {
                let [a, b] = [e.a, e.b].map(|v| transform.transform_vector2(v));
                let e = Ellipse { centre: place(e.centre), a, b, ..*e };
                for axis in 0..2 {
                    let [l, h] = turns(&e, axis);
                    low[axis] = l.map_or(low[axis], |l| low[axis].min(l));
                    high[axis] = h.map_or(high[axis], |h| high[axis].max(h));
                }
            }
        }
    }
    Some([low, high])
}

/// The lowest and the highest coordinate of the whole ellipse, each if the arc comes there.
fn turns(e: &Ellipse, axis: usize) -> [Option<f64>; 2] {
    let (centre, a, b) = (e.centre[axis], e.a[axis], e.b[axis]);
    let reach = libm::hypot(a, b);
    let at = libm::atan2(b, a).to_degrees();
    let comes = |degrees: f64| {
        let on = if e.sweep < 0.0 { e.from - degrees } else { degrees - e.from };
        on.rem_euclid(360.0) <= e.sweep.abs()
    };
    [comes(at + 180.0).then_some(centre - reach), comes(at).then_some(centre + reach)]
}

/// The greatest value of the Bezier curve with these control values, or `best` if that is no less.
///
/// A curve lies below its highest control value; halves that cannot rise above what was found are left out.
fn highest(points: Vec<f64>, mut best: f64) -> f64 {
    let most = |points: &[f64]| points.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let hair = points.iter().fold(0.0, |size: f64, x| size.max(x.abs())) * 2f64.powi(-48);
    let mut open = vec![(points, 0)];
    while let Some((mut points, halvings)) = open.pop() {
        if most(&points) <= best + hair || halvings == HALVINGS_MAX {
            continue;
        }
        let mut first = vec![points[0]];
        for last in (1..points.len()).rev() {
            for i in 0..last {
                points[i] = points[i] / 2.0 + points[i + 1] / 2.0;
            }
            first.push(points[0]);
        }
        best = best.max(points[0]);
        let mut halves = [first, points];
        halves.sort_by(|a, b| most(a).total_cmp(&most(b)));
        open.extend(halves.map(|half| (half, halvings + 1)));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::outlines::Outlines;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    fn of(pieces: Vec<Piece>) -> [[f64; 2]; 2] {
        extent(&pieces, DAffine2::IDENTITY).unwrap().map(|p| p.to_array())
    }

    fn curve(points: &[DVec2]) -> Vec<Piece> {
        let last = points[points.len() - 1];
        vec![Piece::Start(points[0]), Piece::Curve(Box::new(Curve::Bezier(points.to_vec())), last)]
    }

    #[test]
    fn bezier_curves_reach_as_far_as_they_go() {
        // Half way, a cubic is at three quarters of the height of its inner control points.
        assert_eq!(of(curve(&[p(0., 0.), p(2., 4.), p(4., 4.), p(6., 0.)])), [[0., 0.], [6., 3.]]);
        assert_eq!(of(curve(&[p(0., 0.), p(1., -2.), p(2., 0.)])), [[0., -1.], [2., 0.]]);
        // y = 3 t (1 - t)^2 is greatest at a third, with 4/9; y = t^5 (1 - t) * 6 at five sixths.
        let [_, [_, y]] = of(curve(&[p(0., 0.), p(1., 1.), p(2., 0.), p(3., 0.)]));
        assert!((y - 4.0 / 9.0).abs() < 1e-14, "{y}");
        let sixth: Vec<DVec2> = (0..=6).map(|i| p(f64::from(i), f64::from(i == 5))).collect();
        let [_, [_, y]] = of(curve(&sixth));
        assert!((y - (5.0f64 / 6.0).powi(5)).abs() < 1e-14, "{y}");
        // There and back along x, and a curve that is a point.
        let [[x, _], _] = of(curve(&[p(0., 0.), p(-1., 0.), p(1., 0.)]));
        assert!((x + 1.0 / 3.0).abs() < 1e-14, "{x}");
        assert_eq!(of(curve(&[p(7., 7.); 12])), [[7., 7.], [7., 7.]]);
    }

    #[test]
    fn arcs_reach_as_far_as_they_go() {
        let arc = |from: f64, sweep: f64| {
            let e = Ellipse { centre: p(1.0, 2.0), a: p(3.0, 0.0), b: p(0.0, 2.0), from, sweep };
            of(vec![Piece::Start(e.at(from)), Piece::Curve(Box::new(Curve::Ellipse(e)), e.at(from + sweep))])
        };
        assert_eq!(arc(0.0, 360.0), [[-2., 0.], [4., 4.]]);
        assert_eq!(arc(0.0, 90.0), [[1., 2.], [4., 4.]]);
        assert_eq!(arc(90.0, -180.0), [[1., 0.], [4., 4.]]);
        assert_eq!(arc(180.0, 90.0), [[-2., 0.], [1., 2.]]);
        assert_eq!(arc(-90.0, -90.0), [[-2., 0.], [1., 2.]]);
        assert_eq!(arc(350.0, 100.0)[1], [4., 4.]);
        // A turned ellipse touches its box where its axes do not end.
        let mut outlines = Outlines::default();
        let turned = DAffine2::from_angle(0.7) * DAffine2::from_scale(p(3.0, 1.0));
        outlines.pen(turned).ellipse(p(0., 0.), p(1., 0.), p(0., 1.)).unwrap();
        let [_, high] = extent(&outlines.pieces, DAffine2::IDENTITY).unwrap();
        let right = p(f64::hypot(3.0 * 0.7f64.cos(), 0.7f64.sin()), f64::hypot(3.0 * 0.7f64.sin(), 0.7f64.cos()));
        assert!(high.distance(right) < 1e-14, "{high}");
        let [_, back] = extent(&outlines.pieces, turned.inverse()).unwrap();
        assert!(back.distance(p(1.0, 1.0)) < 1e-14, "{back}");
    }

    #[test]
    fn all_curves_lie_in_their_box_and_touch_it() {
        for seed in 0..200u32 {
            let number = |i: u32| f64::from((seed * 97 + i * 31 + i * i * seed) % 101) - 50.0;
            let points: Vec<DVec2> = (0..3 + seed % 9).map(|i| p(number(2 * i), number(2 * i + 1))).collect();
            let pieces = curve(&points);
            let [low, high] = extent(&pieces, DAffine2::IDENTITY).unwrap();
            let Piece::Curve(curve, _) = &pieces[1] else { panic!() };
            let on = (0..=4000).map(|k| curve.at(f64::from(k) / 4000.0));
            let [l, h] = on.map(|p| [p, p]).reduce(|[l, h], [p, _]| [l.min(p), h.max(p)]).unwrap();
            assert!((l - low).min_element() > -1e-12 && (high - h).min_element() > -1e-12, "{points:?}");
            assert!((l - low).max_element() < 1e-3 && (high - h).max_element() < 1e-3, "{points:?}");
        }
    }
}
