//! How long ropes are: the share of each bin.

use super::chart::{Chart, WIDTH, legend};
use super::colour::{BLUE, INK, MUTED, SKY, VERMILION};
use super::label::{estimate, number, percent};
use super::svg::{Align, Svg};
use super::unit::unit;
use crate::scene::Scene;
use crate::study::{Bin, Estimate, Summary, quantity};

/// Bars narrower than this have no room for an error bar each.
const NARROW: f64 = 5.0;

/// The histogram of that name: bars, error bars, mean and median.
///
/// A histogram that the summary does not have is an empty picture that says so.
pub fn histogram(summary: &Summary, scene: &Scene, name: &str) -> String {
    let (height, what) = (360.0, quantity(name));
    let mut svg = Svg::new(WIDTH, height, &format!("Histogram: {what}"));
    let found = summary.histograms.iter().find(|h| h.name == name);
    let Some((width, bins)) = found.map(|h| (h.width, &h.bins[..])).filter(|(_, bins)| !bins.is_empty()) else {
        svg.text(
            [WIDTH / 2.0, height / 2.0],
            Align::Middle,
            "font-size=\"13\"",
            &format!("Nothing was counted: {what}"),
        );
        return svg.finish();
    };

    let ends = |b: &Bin| (b.bin as f64 * width, (b.bin as f64 + 1.0) * width);
    let (first, last) = (ends(&bins[0]).0, ends(&bins[bins.len() - 1]).1);
    // A length starts at zero; the axis does so too unless that would squeeze the bars.
    let low = if first < 0.4 * last { 0.0 } else { first };
    let tallest = bins.iter().map(|b| 100.0 * high(&b.share)).fold(0.0, f64::max);
    let tallest = if tallest > 0.0 { tallest * 1.04 } else { 1.0 };
    let chart = Chart::new((low, last), (0.0, tallest), WIDTH - 24.0, 66.0, height - 54.0);
    chart.grid(&mut svg);

    let bar = chart.x.at(first + width) - chart.x.at(first);
    let ground = chart.y.at(0.0);
    let share = |x: f64| chart.y.within(100.0 * x);
    let gap = if bar >= NARROW { 1.0 } else { 0.0 };
    for b in bins {
        let (from, to) = ends(b);
        let (x, y) = (chart.x.at(from), share(b.share.value));
        let size = [(chart.x.at(to) - x - gap).max(0.3), ground - y];
        let name = format!("{} to {}: {}", number(from, Some(width)), number(to, Some(width)), percent(&b.share));
        svg.rect_named([x + gap / 2.0, y], size, &format!("fill=\"{SKY}\" class=\"bar\""), &name);
    }
    for b in bins {
        if let Some((low, high)) = b.share.low.zip(b.share.high) {
            let x = (chart.x.at(ends(b).0) + chart.x.at(ends(b).1)) / 2.0;
            let cap = (bar / 5.0).min(4.0);
            let (low, high) = (share(low), share(high));
            if bar >= NARROW {
                for y in [low, high] {
                    svg.line([x - cap, y], [x + cap, y], &format!("stroke=\"{INK}\""));
                }
            }
            let style = if bar >= NARROW { "" } else { " stroke-width=\".6\" stroke-opacity=\".6\"" };
            svg.line([x, low], [x, high], &format!("stroke=\"{INK}\"{style}"));
        }
    }

    let [left, right, top, _] = chart.bounds();
    let mut known = Vec::new();
    let scalar = summary.scalars.iter().find(|s| s.name == name);
    if let Some(mean) = scalar.map(|s| s.mean) {
        let x = chart.x.within(mean.value);
        if let Some((low, high)) = mean.low.zip(mean.high) {
            let (low, high) = (chart.x.within(low), chart.x.within(high));
            svg.rect([low, top], [high - low, ground - top], &format!("fill=\"{VERMILION}\" fill-opacity=\".25\""));
        }
        let style = format!("stroke=\"{VERMILION}\" stroke-width=\"2\"");
        svg.line([x, top], [x, ground], &style);
        known.push((style, format!("mean {}", estimate(&mean))));
    }
    if let Some(median) = scalar.and_then(|s| s.quantile(0.5)) {
        let x = chart.x.within(median.value);
        let style = format!("stroke=\"{BLUE}\" stroke-width=\"2\" stroke-dasharray=\"5 3\"");
        svg.line([x, top], [x, ground], &style);
        known.push((style, format!("median {}", number(median.value, None))));
    }
    chart.axes(&mut svg, (what, unit(scene)), ("share of traces", "%"));
    legend(&mut svg, [left, 18.0], &known);
    let note = format!("error bars: {} % intervals", number(100.0 * summary.study.tallies.confidence, None));
    if bins.iter().any(|b| b.share.low.is_some()) {
        svg.text([right, 52.0], Align::End, &format!("fill=\"{MUTED}\""), &note);
    }
    svg.finish()
}

/// How far up an estimate reaches.
fn high(e: &Estimate) -> f64 {
    e.high.unwrap_or(e.value).max(e.value)
}
