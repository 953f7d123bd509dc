//! A work-precision diagram: what a trace-step costs against what is wrong about its rope.

use super::colour::{BLUE, GRID, INK, MUTED, VERMILION};
use super::label::width;
use super::svg::{Align, Svg};
use super::ticks::Ticks;
use crate::geometry::number;
use crate::lab::tradeoff::{Method, Point, Setting, Tradeoff};

/// How wide the whole is, and what stands above the panels.
const WIDTH: f64 = 1080.0;
const HEAD: f64 = 96.0;

/// How high a panel is, with its axes.
const PANEL: f64 = 370.0;

/// How wide the strip is in which points stand whose error is 0: a logarithm has no place for them.
const STRIP: f64 = 64.0;

/// What lies behind errors that are less than the sample leaves open.
const GREEN: &str = "#e8f1e4";

/// The colours of methods, in their order, of the eight of M. Okabe and K. Ito (see `colour.rs`) but the yellow, which
/// is too light for white paper.
const COLOURS: [&str; Method::ALL.len()] =
    [BLUE, "#56b4e9", VERMILION, "#009e73", "#cc79a7", "#000", "#8a8a8a", "#e69f00"];

/// What one panel shows along its lower axis.
struct Measure {
    title: &'static str,
    /// Below what a point stands that has none of it.
    none: &'static str,
    of: fn(&Point) -> Option<f64>,
    /// Errors below it are less than the sample leaves open.
    noise: Option<f64>,
}

/// Four panels, of which each shows the time of a trace-step against one measure of error, both logarithmic: traces
/// whose events differ, traces whose rope at the end differs, the mean error of its length, and the error of the mean
/// length beside what the sample leaves open of it.
pub fn tradeoff(measured: &Tradeoff) -> String {
    let noise = measured.points.iter().filter_map(|p| p.length.noise()).fold(f64::INFINITY, f64::min);
    let measures = [
        Measure {
            title: "share of traces whose events differ",
            none: "below 3/N",
            of: |p| Some(p.share(p.event_mismatch?)),
            noise: None,
        },
        Measure {
            title: "share of traces whose rope at the end differs",
            none: "below 3/N",
            of: |p| Some(p.share(p.final_mismatch)),
            noise: None,
        },
        Measure {
            title: "mean relative error of the length at the end",
            none: "none",
            of: |p| Some(p.length_error.mean),
            noise: None,
        },
        Measure {
            title: "relative error of the mean length, the study's answer",
            none: "none",
            of: |p| Some(p.length.error().abs()),
            noise: Some(noise),
        },
    ];
    let mut svg =
        Svg::new(WIDTH, HEAD + 2.0 * PANEL, "Time per trace-step against error, for all methods and settings");
    let title = format!("What speed costs in accuracy: {}", measured.scene);
    svg.text([16.0, 24.0], Align::Start, "font-size=\"15\" font-weight=\"bold\"", &title);
    legend(&mut svg, &measured.points);
    let times = range(measured.points.iter().map(|p| p.ns_per_step.median));
    for (i, measure) in measures.iter().enumerate() {
        let (column, row) = ((i % 2) as f64, (i / 2) as f64);
        Panel::new(measure, &measured.points, times, [column * WIDTH / 2.0, HEAD + row * PANEL]).draw(&mut svg);
    }
    svg.finish()
}

/// The colours of the methods that are there, and the marks of the settings.
fn legend(svg: &mut Svg, points: &[Point]) {
    let muted = format!("fill=\"{MUTED}\"");
    let mut x = 16.0;
    for (method, colour) in methods(points) {
        svg.rect([x, 40.0], [12.0, 12.0], &format!("fill=\"{colour}\""));
        svg.text([x + 18.0, 50.0], Align::Start, "", method);
        x += 36.0 + width(method, 12.0);
    }
    let mut x = 22.0;
    let entries = [
        (Some(Setting::EXACT), "all points and walls"),
        (Some(Setting::Stride(2)), "every K-th point"),
        (Some(Setting::Simplify(1.0)), "walls simplified"),
        (None, "ring: no other point is faster and as right"),
    ];
    for (setting, name) in entries {
        match setting {
            Some(setting) => mark(svg, [x, 72.0], setting, MUTED),
            None => ring(svg, [x, 72.0]),
        }
        svg.text([x + 13.0, 76.0], Align::Start, &muted, name);
        x += 40.0 + width(name, 12.0);
    }
}

/// Each method that is there, with its colour, which is the same in all diagrams.
fn methods(points: &[Point]) -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = Method::ALL.into_iter().map(|method| method.name).zip(COLOURS);
    all.filter(|(method, _)| points.iter().any(|p| p.method == *method))
}

/// The mark of a setting in a colour, about a point.
fn mark(svg: &mut Svg, [x, y]: [f64; 2], setting: Setting, colour: &str) {
    let style = format!("fill=\"{colour}\" fill-opacity=\".8\" stroke=\"#fff\" stroke-width=\".7\"");
    match setting {
        Setting::Stride(1) => svg.circle([x, y], 5.0, &style),
        Setting::Stride(_) => svg.polygon(&[[x, y - 5.5], [x + 5.0, y + 4.0], [x - 5.0, y + 4.0]], &style),
        Setting::Simplify(_) => svg.rect([x - 4.2, y - 4.2], [8.4, 8.4], &style),
    }
}

fn ring(svg: &mut Svg, at: [f64; 2]) {
    svg.circle(at, 8.5, &format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.3\""));
}

/// An axis of decades.
struct Decades {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Decades {
    fn at(&self, x: f64) -> f64 {
        let [x, low, high] = [x.clamp(self.low, self.high), self.low, self.high].map(libm::log10);
        self.from + (x - low) / (high - low) * (self.to - self.from)
    }

    fn ticks(&self) -> Ticks {
        Ticks::logarithmic(self.low, self.high, 7)
    }
}

/// Round bounds about all values above 0; some decades where there are none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|x| *x > 0.0 && x.is_finite());
    let found = finite.fold(None, |bounds: Option<(f64, f64)>, x| {
        Some(bounds.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
    });
    // Some room, and at least a decade.
    found.map_or((1e-4, 1.0), |(low, high)| (low / 1.6, (high * 1.6).max(low * 6.0)))
}

/// One panel at its place.
struct Panel<'a> {
    measure: &'a Measure,
    points: &'a [Point],
    x: Decades,
    y: Decades,
    /// Where the strip begins.
    left: f64,
}

impl<'a> Panel<'a> {
    fn new(measure: &'a Measure, points: &'a [Point], times: (f64, f64), [left, top]: [f64; 2]) -> Self {
        let (low, high) = range(points.iter().filter_map(measure.of).chain(measure.noise));
        let left = left + 66.0;
        let x = Decades { low, high, from: left + STRIP, to: left + WIDTH / 2.0 - 84.0 };
        let y = Decades { low: times.0, high: times.1, from: top + PANEL - 58.0, to: top + 34.0 };
        Panel { measure, points, x, y, left }
    }

    /// Where a point stands, if it has this measure.
    fn place(&self, point: &Point) -> Option<[f64; 2]> {
        let error = (self.measure.of)(point)?;
        let x = if error > 0.0 { self.x.at(error) } else { self.left + STRIP / 2.0 };
        Some([x, self.y.at(point.ns_per_step.median)])
    }

    fn draw(&self, svg: &mut Svg) {
        self.ground(svg);
        for (method, colour) in methods(self.points) {
            let own: Vec<&Point> = self.points.iter().filter(|p| p.method == method).collect();
            self.lines(svg, &own, colour);
            for point in &own {
                if let Some(at) = self.place(point) {
                    mark(svg, at, point.setting, colour);
                }
            }
        }
        let places: Vec<[f64; 2]> = self.points.iter().filter_map(|p| self.place(p)).collect();
        let mut names: Vec<[f64; 2]> = Vec::new();
        // From the far end, so that of points at one place the one that gives most away keeps its name.
        for point in self.points.iter().rev().filter(|p| p.pareto) {
            let Some([x, y]) = self.place(point) else { continue };
            ring(svg, [x, y]);
            let name = match point.setting {
                Setting::Stride(1) => continue,
                Setting::Stride(k) => k.to_string(),
                Setting::Simplify(tolerance) => number(tolerance),
            };
            let style = format!("font-size=\"10\" fill=\"{MUTED}\"");
            let wide = width(&name, 10.0);
            let middle = [x + 11.0 + wide / 2.0, y];
            let touches = |at: &[f64; 2]| (at[0] - middle[0]).abs() < wide / 2.0 + 6.0 && (at[1] - y).abs() < 10.0;
            if !places.iter().chain(&names).any(touches) {
                svg.text([x + 11.0, y + 4.0], Align::Start, &style, &name);
                names.push(middle);
            }
        }
    }

    /// The axes and what stands behind the marks.
    fn ground(&self, svg: &mut Svg) {
        let (top, bottom, right) = (self.y.to, self.y.from, self.x.to);
        let grid = format!("stroke=\"{GRID}\"");
        svg.rect([self.left, top], [STRIP, bottom - top], "fill=\"#f4f4f4\"");
        svg.text([self.left + STRIP / 2.0, bottom + 18.0], Align::Middle, "font-size=\"11\"", self.measure.none);
        let noise = self.measure.noise.filter(|noise| noise.is_finite());
        if let Some(noise) = noise {
            let wide = self.x.at(noise) - self.x.from;
            svg.rect([self.x.from, top], [wide, bottom - top], &format!("fill=\"{GREEN}\""));
        }
        for (value, name) in &self.y.ticks().marks {
            let y = self.y.at(*value);
            svg.line([self.left, y], [right, y], &grid);
            svg.text([self.left - 7.0, y + 4.0], Align::End, "", name);
        }
        for (value, name) in &self.x.ticks().marks {
            let x = self.x.at(*value);
            svg.line([x, top], [x, bottom], &grid);
            svg.text([x, bottom + 18.0], Align::Middle, "", name);
        }
        if noise.is_some() {
            // Over the grid, which it hides.
            let style = format!(
                "font-size=\"11\" fill=\"{MUTED}\" stroke=\"{GREEN}\" stroke-width=\"4\" paint-order=\"stroke\""
            );
            svg.text([self.x.from + 6.0, top + 14.0], Align::Start, &style, "green: less than the sample leaves open");
        }
        svg.line([self.left, bottom], [right, bottom], &format!("stroke=\"{INK}\""));
        svg.text([(self.left + right) / 2.0, bottom + 40.0], Align::Middle, "font-size=\"13\"", self.measure.title);
        svg.text([self.left - 7.0, top - 12.0], Align::Start, "font-size=\"13\"", "ns per trace-step");
    }

    /// Lines from the point that gives nothing away through those of ever longer strides, and through those of ever
    /// larger tolerances.
    fn lines(&self, svg: &mut Svg, own: &[&Point], colour: &str) {
        let is_stride = |p: &&&Point| matches!(p.setting, Setting::Stride(_));
        let strides: Vec<[f64; 2]> = own.iter().filter(is_stride).filter_map(|p| self.place(p)).collect();
        let exact = own.iter().filter(|p| p.setting == Setting::EXACT);
        let simplified = own.iter().filter(|p| !is_stride(p));
        let simplified: Vec<[f64; 2]> = exact.chain(simplified).filter_map(|p| self.place(p)).collect();
        svg.polyline(&strides, &format!("stroke=\"{colour}\" stroke-opacity=\".5\""));
        svg.polyline(&simplified, &format!("stroke=\"{colour}\" stroke-opacity=\".5\" stroke-dasharray=\"3 3\""));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_all_that_has_a_logarithm() {
        let (low, high) = range([0.0, 3e-4, 0.2, f64::INFINITY].into_iter());
        assert!(low < 3e-4 && low > 1e-4 && high > 0.2 && high < 0.5);
        let (low, high) = range([0.5].into_iter());
        assert!(low < 0.5 && high > 5.0 * low);
        assert_eq!(range([0.0].into_iter()), (1e-4, 1.0));
    }

    #[test]
    fn decades_are_equally_long() {
        let axis = Decades { low: 0.01, high: 100.0, from: 0.0, to: 400.0 };
        assert_eq!([0.01, 0.1, 1.0, 100.0, 1e9].map(|x| axis.at(x)), [0.0, 100.0, 200.0, 400.0, 400.0]);
    }
}
