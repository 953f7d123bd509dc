//! For how long ropes stay short: the share never longer than each limit, step by step.

use super::chart::{Chart, WIDTH};
use super::colour::{MUTED, colour};
use super::label::number;
use super::svg::{Align, Svg};
use super::unit::unit;
use crate::scene::Scene;
use crate::study::{Estimate, Summary, Survival};

/// How far apart the names of curves are at the least.
const LINE: f64 = 15.0;

/// The share of ropes that were never longer than each limit, against the step; `None` if the study has no limits.
pub fn survival(summary: &Summary, scene: &Scene) -> Option<String> {
    let title = "Share of ropes never longer than each limit, step by step";
    draw(summary.survival.iter().collect(), scene, title, ["share of ropes never longer than the limit", "limit", "≤ "])
}

/// The share of walks that their tether has not held back yet, against the step; `None` without one.
pub fn held_back(summary: &Summary, scene: &Scene) -> Option<String> {
    let tether = summary.tether.as_ref()?;
    let curve = Survival { limit: tether.length, curve: tether.curve.clone() };
    let title = "Share of walks that the tether has not held back yet, step by step";
    draw(vec![&curve], scene, title, ["share of walks not held back yet", "tether", ""])
}

/// Curves of a share, each named by its limit: what that is, and the sign before it.
fn draw(curves: Vec<&Survival>, scene: &Scene, title: &str, [share, name, sign]: [&str; 3]) -> Option<String> {
    let mut curves: Vec<&Survival> = curves.into_iter().filter(|s| !s.curve.is_empty()).collect();
    curves.sort_by(|a, b| b.limit.total_cmp(&a.limit));
    let steps = || curves.iter().flat_map(|s| &s.curve).map(|p| p.step as f64);
    let (first, last) = (steps().reduce(f64::min)?, steps().reduce(f64::max)?);

    let height = 400.0;
    let mut svg = Svg::new(WIDTH, height, title);
    let low = if first < 0.4 * last { 0.0 } else { first };
    let chart = Chart::new((low, last), (0.0, 100.0), WIDTH - 120.0, 46.0, height - 54.0);
    chart.grid(&mut svg);
    let [_, right, top, bottom] = chart.bounds();

    // The longest limit is lightest, but never as light as paper.
    let shade = |i: usize| colour(0.2 + 0.8 * (i as f64 + 1.0) / curves.len() as f64);
    let y = |share: f64| chart.y.within(100.0 * share);
    let stairs = |curve: &Survival, of: &dyn Fn(&Estimate) -> f64| {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for p in &curve.curve {
            let (x, y) = (chart.x.at(p.step as f64), y(of(&p.share)));
            if let Some(&[_, before]) = points.last() {
                points.push([x, before]);
            }
            points.push([x, y]);
        }
        points
    };
    for (i, curve) in curves.iter().enumerate() {
        let mut band = stairs(curve, &|e| e.low.unwrap_or(e.value));
        band.extend(stairs(curve, &|e| e.high.unwrap_or(e.value)).into_iter().rev());
        svg.polygon(&band, &format!("fill=\"{}\" fill-opacity=\".25\"", shade(i)));
    }
    for (i, curve) in curves.iter().enumerate() {
        let points = stairs(curve, &|e| e.value);
        svg.polyline(&points, &format!("stroke=\"{}\" stroke-width=\"2\" stroke-linejoin=\"round\"", shade(i)));
        if let [only] = points[..] {
            svg.circle(only, 3.5, &format!("fill=\"{}\"", shade(i)));
        }
    }
    chart.axes(&mut svg, ("step", ""), (share, "%"));

    // Each curve is named at its right end; where there are too many names, every second, third, ... curve is.
    let room = ((bottom - top) / LINE) as usize;
    let every = curves.len().div_ceil(room.max(1));
    let named: Vec<usize> = (0..curves.len()).rev().step_by(every).collect();
    let ends = named.iter().rev().map(|&i| curves[i].curve.last().map_or(bottom, |p| y(p.share.value)));
    let places = spread(&ends.collect::<Vec<_>>(), top, bottom);
    for (&i, place) in named.iter().rev().zip(places) {
        let last = curves[i].curve[curves[i].curve.len() - 1];
        let at = [chart.x.at(last.step as f64), y(last.share.value)];
        svg.polyline(
            &[at, [right + 4.0, at[1]], [right + 14.0, place], [right + 18.0, place]],
            &format!("stroke=\"{}\"", shade(i)),
        );
        svg.text([right + 22.0, place + 4.0], Align::Start, "", &format!("{sign}{}", number(curves[i].limit, None)));
    }
    svg.text([right + 22.0, 24.0], Align::Start, &format!("fill=\"{MUTED}\""), name);
    svg.text(
        [right + 22.0, 38.0 - 1.0],
        Align::Start,
        &format!("fill=\"{MUTED}\" font-size=\"10\""),
        &format!("({})", unit(scene)),
    );
    Some(svg.finish())
}

/// Moves `wanted`, which ascends or nearly so, as little as keeps neighbours a line apart between `top` and `bottom`.
fn spread(wanted: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut places: Vec<f64> = wanted.to_vec();
    let mut least = top + 4.0;
    for place in &mut places {
        *place = place.max(least);
        least = *place + LINE;
    }
    let mut most = bottom;
    for place in places.iter_mut().rev() {
        *place = place.min(most);
        most = *place - LINE;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_apart() {
        assert_eq!(spread(&[50.0, 52.0, 100.0], 0.0, 100.0), [50.0, 65.0, 100.0]);
        assert_eq!(spread(&[100.0, 100.0, 100.0], 0.0, 100.0), [70.0, 85.0, 100.0]);
    }
}
