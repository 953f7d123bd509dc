//! What most people want to know: how many walks a tether of some length holds.

use super::chart::{Chart, WIDTH, legend};
use super::colour::{BLUE, MUTED, SKY, VERMILION};
use super::label::{number, percent, resolution};
use super::svg::{Align, Svg};
use super::unit::unit;
use crate::scene::Scene;
use crate::study::{Estimate, Held, Summary};

/// The answer in one sentence. Of walks that a tether holds back that is `a tether of 12 m holds the walks back in 63 %
/// (62–64) of their steps`, else `99 % of the walks need at most 367 mm (360 to 372)`: the highest of the quantiles of
/// the greatest rope length with its interval, in the scene's unit, if that has a name. `None` if there are no traces.
pub fn sentence(summary: &Summary, scene: &Scene) -> Option<String> {
    let need = summary.need()?;
    let walks = if summary.study.is_given() { "traces" } else { "walks" };
    let share = number(100.0 * need.share, None);
    let unit = scene.unit().map_or(String::new(), |unit| format!(" {unit}"));
    if let Some(tether) = &summary.tether {
        let (length, share) = (number(tether.length, None), percent(&tether.held_back));
        return Some(format!("a tether of {length}{unit} holds the walks back in {share} of their steps"));
    }
    Some(format!("{share} % of the {walks} need at most {}{unit}{}", value(&need.value), range(&need.value)))
}

fn value(length: &Estimate) -> String {
    number(length.value, resolution(length))
}

/// An interval in parentheses; an end that is not known is not told.
fn range(length: &Estimate) -> String {
    let end = |x| number(x, resolution(length));
    match (length.low, length.high) {
        (Some(low), Some(high)) => format!(" ({} to {})", end(low), end(high)),
        (Some(low), None) => format!(" ({} or more)", end(low)),
        (None, Some(high)) => format!(" ({} or less)", end(high)),
        (None, None) => String::new(),
    }
}

/// The share of the walks that a tether holds, against its length, with a band of intervals, and the length that the
/// [`sentence`] names. `None` if there are no traces.
pub fn tether(summary: &Summary, scene: &Scene) -> Option<String> {
    let (held, need) = (summary.held(), summary.need()?);
    let (first, last) = (held.first()?, held.last()?);
    let height = 380.0;
    let mut svg = Svg::new(WIDTH, height, "The share of the walks that a tether holds, by its length");
    let low = if first.length < 0.4 * last.length { 0.0 } else { first.length };
    let end = need.value.high.unwrap_or(need.value.value).max(last.length);
    let chart = Chart::new((low, end), (0.0, 100.0), WIDTH - 24.0, 66.0, height - 54.0);
    chart.grid(&mut svg);
    let [left, right, top, bottom] = chart.bounds();
    let at = |held: &Held, share: f64| [chart.x.within(held.length), chart.y.within(100.0 * share)];

    let lower = held.iter().map(|h| at(h, h.share.low.unwrap_or(h.share.value)));
    let upper = held.iter().rev().map(|h| at(h, h.share.high.unwrap_or(h.share.value)));
    svg.polygon(&lower.chain(upper).collect::<Vec<_>>(), &format!("fill=\"{SKY}\" fill-opacity=\".6\""));
    let mut curve: Vec<[f64; 2]> = held.iter().map(|h| at(h, h.share.value)).collect();
    curve.insert(0, [left, bottom]);
    curve.push([right, curve[curve.len() - 1][1]]);
    let line = format!("stroke=\"{BLUE}\" stroke-width=\"2\" stroke-linejoin=\"round\"");
    svg.polyline(&curve, &line);

    let (x, y) = (chart.x.within(need.value.value), chart.y.within(100.0 * need.share));
    if let Some(low) = need.value.low {
        let (low, high) = (chart.x.within(low), chart.x.within(need.value.high.unwrap_or(end)));
        let style = format!("fill=\"{VERMILION}\" fill-opacity=\".25\"");
        svg.rect([low, top], [(high - low).max(0.5), bottom - top], &style);
    }
    let style = format!("stroke=\"{VERMILION}\" stroke-width=\"2\"");
    svg.line([left, y], [x, y], &format!("stroke=\"{VERMILION}\" stroke-dasharray=\"4 3\""));
    svg.line([x, y], [x, bottom], &style);
    svg.circle([x, y], 3.5, &format!("fill=\"{VERMILION}\""));
    let what = summary.need().map_or(String::new(), |need| {
        format!("{} %: {}{}", number(100.0 * need.share, None), value(&need.value), range(&need.value))
    });
    chart.axes(&mut svg, ("length of the tether", unit(scene)), ("share of walks that it holds", "%"));
    legend(&mut svg, [left, 18.0], &[(style, what), (line, "share held".to_owned())]);
    let confidence = number(100.0 * summary.study.tallies.confidence, None);
    let note = format!("band: {confidence} % intervals");
    svg.text([right, 52.0], Align::End, &format!("fill=\"{MUTED}\""), &note);
    Some(svg.finish())
}
