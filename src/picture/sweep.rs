//! What the studies of a sweep say, against what differs between them.

use super::chart::{Chart, WIDTH};
use super::colour::{BLUE, INK, MUTED, VERMILION, colour};
use super::label::{number, width};
use super::svg::{Align, Svg};
use super::sweep_axis::{Axis, Line, axis_and_lines};
use crate::study::{Estimate, PointAnswer, SweepAnswer, quantity};

/// The scalar that is shown.
const SHOWN: &str = "max_length";

/// The quantiles that are shown beside the mean, where there is one line of it.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// The mean greatest rope length of each study with its interval, and its quantiles, against the values of the key that
/// differs. Of two keys each value of the second has a line of its own, without quantiles; of more the studies stand
/// side by side. `None` before any study has an answer.
pub fn sweep(answer: &SweepAnswer) -> Option<String> {
    let (axis, lines) = axis_and_lines(answer);
    let is_one = lines.len() == 1;
    let shown = |point: &PointAnswer| -> Vec<Estimate> {
        let quantiles = QUANTILES.iter().filter(|_| is_one).filter_map(|&share| quantile(point, share));
        mean(point).into_iter().chain(quantiles).collect()
    };
    let ends = answer.points.iter().flat_map(shown).flat_map(|e| [e.low.unwrap_or(e.value), e.high.unwrap_or(e.value)]);
    let ends: Vec<f64> = ends.filter(|x| x.is_finite()).collect();
    let (low, high) = (ends.iter().copied().reduce(f64::min)?, ends.iter().copied().reduce(f64::max)?);

    let height = 400.0;
    let names = lines.iter().map(|line| width(&line.name, 12.0)).fold(0.0, f64::max);
    let right = if is_one { WIDTH - 24.0 } else { WIDTH - 48.0 - names.max(width(&answer.keys[1], 12.0)) };
    let mut svg = Svg::new(WIDTH, height, &format!("{} against {}", quantity(SHOWN), axis.title));
    // A length starts at zero; the axis does so too unless that would squeeze what there is to see.
    let bottom = if low < 0.4 * high { low.min(0.0) } else { low - 0.06 * (high - low) };
    let margin = if axis.is_ordered { 0.04 * (axis.range.1 - axis.range.0) } else { 0.0 };
    let range = (axis.range.0 - margin, axis.range.1 + margin);
    let chart = Chart::new(range, (bottom, high + 0.04 * (high - bottom)), right, 66.0, height - 54.0);
    let chart = match &axis.marks {
        Some(marks) => chart.with_marks(marks),
        None => chart,
    };
    chart.grid(&mut svg);
    let drawn = Drawn { answer, axis: &axis, chart: &chart };
    let [left, right, ..] = chart.bounds();
    if let [line] = &lines[..] {
        let of_share = |share| move |point: &PointAnswer| quantile(point, share);
        drawn.line(&mut svg, line, 0.0, &of_share(0.05), &EXTREMES);
        drawn.line(&mut svg, line, 0.0, &of_share(0.95), &EXTREMES);
        drawn.line(&mut svg, line, 0.0, &of_share(0.5), &MEDIAN);
        drawn.line(&mut svg, line, 0.0, &mean, &MEAN);
        let mut x = left;
        for (look, name) in [(MEAN, "mean"), (MEDIAN, "median"), (EXTREMES, "5 % and 95 % of the traces")] {
            drawn.key(&mut svg, [x, 18.0], &look, name);
            x += 42.0 + width(name, 12.0);
        }
    }
    for (i, line) in lines.iter().enumerate().filter(|_| !is_one) {
        let own = colour(0.2 + 0.8 * i as f64 / (lines.len() - 1) as f64);
        let look = Look { colour: &own, ..MEAN };
        // Side by side where nothing joins them.
        let aside = if axis.is_ordered { 0.0 } else { 6.0 * (i as f64 - (lines.len() - 1) as f64 / 2.0) };
        drawn.line(&mut svg, line, aside, &mean, &look);
        drawn.key(&mut svg, [right + 14.0, 84.0 + 18.0 * i as f64], &look, &line.name);
    }
    let what = if is_one { quantity(SHOWN).to_owned() } else { format!("mean {}", quantity(SHOWN)) };
    chart.axes(&mut svg, (&axis.title, ""), (&what, "scene units"));
    let muted = format!("fill=\"{MUTED}\"");
    if !is_one {
        svg.text([right + 14.0, 66.0], Align::Start, &muted, &answer.keys[1]);
    }
    let confidence = answer.points.iter().map(|point| point.confidence).reduce(f64::min)?;
    let note = format!("error bars: {} % intervals", number(100.0 * confidence, None));
    svg.text([right, 52.0], Align::End, &muted, &note);
    Some(svg.finish())
}

fn mean(point: &PointAnswer) -> Option<Estimate> {
    point.scalar(SHOWN).map(|scalar| scalar.mean)
}

fn quantile(point: &PointAnswer, share: f64) -> Option<Estimate> {
    point.scalar(SHOWN)?.quantile(share)
}

/// What a line looks like, and its marks.
#[derive(Clone, Copy)]
struct Look<'a> {
    colour: &'a str,
    dash: &'a str,
    is_filled: bool,
}

const MEAN: Look<'static> = Look { colour: VERMILION, dash: "", is_filled: true };
const MEDIAN: Look<'static> = Look { colour: BLUE, dash: " stroke-dasharray=\"6 3\"", is_filled: true };
const EXTREMES: Look<'static> = Look { colour: BLUE, dash: " stroke-dasharray=\"2 3\"", is_filled: false };

/// What lines are drawn in.
struct Drawn<'a> {
    answer: &'a SweepAnswer,
    axis: &'a Axis,
    chart: &'a Chart,
}

impl Drawn<'_> {
    /// Marks of the points of a line with their intervals, so many pixels to the right of where they belong, joined
    /// where there is something between them.
    fn line(
        &self,
        svg: &mut Svg,
        line: &Line,
        aside: f64,
        of: &dyn Fn(&PointAnswer) -> Option<Estimate>,
        look: &Look<'_>,
    ) {
        let known = line.points.iter().filter_map(|&i| Some((self.axis.places[i], of(&self.answer.points[i])?)));
        let known: Vec<(f64, Estimate)> = known.collect();
        let y = |value: f64| self.chart.y.within(value);
        let joined: Vec<[f64; 2]> = known.iter().map(|(x, e)| [self.chart.x.at(*x) + aside, y(e.value)]).collect();
        if self.axis.is_ordered {
            svg.polyline(&joined, &stroke(look));
        }
        for ((_, estimate), at) in known.iter().zip(&joined) {
            let x = at[0];
            if let Some((low, high)) = estimate.low.zip(estimate.high) {
                let ends = [y(low), y(high)];
                svg.line([x, ends[0]], [x, ends[1]], &format!("stroke=\"{INK}\""));
                ends.iter().for_each(|&y| svg.line([x - 3.0, y], [x + 3.0, y], &format!("stroke=\"{INK}\"")));
            }
            mark(svg, *at, look);
        }
    }

    /// What a line and its marks mean.
    fn key(&self, svg: &mut Svg, [x, y]: [f64; 2], look: &Look<'_>, name: &str) {
        if self.axis.is_ordered {
            svg.line([x, y], [x + 18.0, y], &stroke(look));
        }
        mark(svg, [x + 9.0, y], look);
        svg.text([x + 24.0, y + 4.0], Align::Start, &format!("fill=\"{MUTED}\""), name);
    }
}

fn stroke(look: &Look<'_>) -> String {
    format!("stroke=\"{}\" stroke-width=\"1.7\"{}", look.colour, look.dash)
}

fn mark(svg: &mut Svg, at: [f64; 2], look: &Look<'_>) {
    let ground = if look.is_filled { look.colour } else { "#fff" };
    svg.circle(at, 3.2, &format!("fill=\"{ground}\" stroke=\"{}\" stroke-width=\"1.3\"", look.colour));
}
