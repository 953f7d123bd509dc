//! The plane in colours: where ropes touch walls, and how long they are.

use std::collections::BTreeMap;
use std::fmt::Write;

use glam::DVec2;

use super::chart::WIDTH;
use super::colour::{INK, MUTED, colour};
use super::label::width;
use super::plane::{Frame, View};
use super::svg::{Align, Svg, px};
use super::ticks::Ticks;
use super::unit::unit;
use crate::scene::Scene;
use crate::study::{AnchorPlan, Cell, Map, Summary};

/// How many colours there are.
const SHADES: usize = 48;

/// Where ropes touch walls: cells coloured by contacts per step. `None` without a map or without contacts.
pub fn map(summary: &Summary, scene: &Scene) -> Option<String> {
    let contacts = |c: &Cell| Some(c.contacts.value).filter(|&x| x > 0.0);
    draw(summary, scene, "contacts per step", "", &contacts)
}

/// How long ropes are: cells coloured by the mean length while the free end was there. `None` without a map or without
/// lengths.
pub fn length_map(summary: &Summary, scene: &Scene) -> Option<String> {
    let length = |c: &Cell| c.length.map(|e| e.value).filter(|x| x.is_finite());
    draw(summary, scene, "mean rope length", unit(scene), &length)
}

/// Which colour a value has.
struct Shades {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Shades {
    /// Counts span orders of magnitude; lengths do not matter near zero.
    fn new(values: &[f64], counts: bool) -> Option<Self> {
        let low = values.iter().copied().reduce(f64::min)?;
        let high = values.iter().copied().reduce(f64::max)?;
        let logarithmic = counts && high > 50.0 * low;
        let low = if counts && !logarithmic { 0.0 } else { low };
        // One value alone is the dark end of a scale that starts at nothing.
        Some(Shades { low: if low < high { low } else { low.min(0.0) }, high, logarithmic })
    }

    /// Where `x` lies between the lightest, 0, and the darkest, 1.
    fn at(&self, x: f64) -> f64 {
        let t = if self.logarithmic {
            libm::log(x / self.low) / libm::log(self.high / self.low)
        } else {
            (x - self.low) / (self.high - self.low)
        };
        if t.is_finite() { t.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn shade(&self, x: f64) -> usize {
        (self.at(x) * (SHADES - 1) as f64).round() as usize
    }
}

fn shade(i: usize) -> String {
    colour(i as f64 / (SHADES - 1) as f64)
}

fn draw(
    summary: &Summary,
    scene: &Scene,
    what: &str,
    unit: &str,
    value: &dyn Fn(&Cell) -> Option<f64>,
) -> Option<String> {
    let map = summary.map.as_ref().filter(|m| m.columns > 0 && m.rows > 0 && m.cell > 0.0)?;
    let known: Vec<(u64, f64)> = map.cells.iter().filter_map(|c| Some((c.cell, value(c)?))).collect();
    let shades = Shades::new(&known.iter().map(|&(_, x)| x).collect::<Vec<_>>(), unit.is_empty())?;

    let low = DVec2::from(map.low);
    let high = low + DVec2::new(f64::from(map.columns), f64::from(map.rows)) * map.cell;
    let view = View::around(scene.vertices().iter().copied().chain([low, high]))?.widened(0.0, 12.0);
    let ticks = |low: f64, high: f64| Ticks::linear(low, high, 5);
    let y_ticks = ticks(view.low.y, view.high.y);
    let left = 18.0 + y_ticks.width();
    let frame = Frame::fit(view, [left, 34.0], [WIDTH - left - 118.0, 580.0]).of(scene);
    let bar_height = frame.height.max(150.0);
    let mut svg = Svg::new(WIDTH, frame.top + bar_height.max(frame.height) + 52.0, &format!("Map: {what}"));

    let ground = "fill=\"#f4f4f4\"";
    svg.rect([frame.left, frame.top], [frame.width, frame.height], ground);
    cells(&mut svg, map, &frame, &shades, &known);
    walls(&mut svg, &frame, scene);
    for anchor in anchors(summary, scene) {
        svg.circle(frame.at(anchor), 5.0, &format!("fill=\"{INK}\" stroke=\"#fff\" stroke-width=\"1.5\""));
    }
    axes(&mut svg, &frame, &y_ticks, self::unit(scene));
    let blank = if unit.is_empty() { "grey: no contact" } else { "grey: not seen there" };
    let bottom = frame.top + bar_height.max(frame.height);
    let x = frame.left + frame.width + 22.0;
    svg.text([beside(x, blank, 12.0), bottom + 36.0], Align::Start, &format!("fill=\"{MUTED}\""), blank);
    bar(&mut svg, [x, frame.top], bar_height, &shades, what, unit);
    Some(svg.finish())
}

/// One path for each colour; cells side by side are one rectangle.
fn cells(svg: &mut Svg, map: &Map, frame: &Frame, shades: &Shades, known: &[(u64, f64)]) {
    let columns = u64::from(map.columns);
    let mut paths: BTreeMap<usize, String> = BTreeMap::new();
    let mut rest = known;
    while let [(cell, value), ..] = *rest {
        let shade = shades.shade(value);
        let (column, row) = (cell % columns, cell / columns);
        // Numbers of cells ascend, so those side by side in the map are so in the list.
        let alike = |i: &usize| {
            let (c, x) = rest[*i];
            c == cell + *i as u64 && c / columns == row && shades.shade(x) == shade
        };
        let run = (0..rest.len()).take_while(alike).count().max(1);
        let corner = |c: u64, r: u64| frame.at(DVec2::from(map.low) + DVec2::new(c as f64, r as f64) * map.cell);
        let ([x0, y0], [x1, y1]) = (corner(column, row), corner(column + run as u64, row + 1));
        let path = paths.entry(shade).or_default();
        let _ = write!(path, "M{} {}H{}V{}H{}Z", px(x0), px(y0), px(x1), px(y1), px(x0));
        rest = &rest[run..];
    }
    for (i, path) in &paths {
        svg.path(path, &format!("fill=\"{}\" shape-rendering=\"crispEdges\"", shade(*i)));
    }
}

/// Dark lines with a light edge, so that they are seen on light and on dark cells; finer where walls are very many.
fn walls(svg: &mut Svg, frame: &Frame, scene: &Scene) {
    let path = frame.walls(scene);
    let (line, edge) = if path.len() > 40_000 { (".5", "1.2") } else { (".9", "2.2") };
    svg.open("g", "fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    // The edge is the same line again. Where that would be much to write, there is none.
    if path.len() < 400_000 {
        svg.path(&path, &format!("stroke=\"#fff\" stroke-opacity=\".75\" stroke-width=\"{edge}\""));
    }
    svg.path(&path, &format!("class=\"walls\" stroke=\"{INK}\" stroke-width=\"{line}\""));
    svg.close("g");
}

/// Where ropes are tied, as far as the study itself says.
fn anchors(summary: &Summary, scene: &Scene) -> Vec<DVec2> {
    match &summary.study.scene.anchor {
        Some(AnchorPlan::One(at)) => vec![DVec2::from(*at)],
        Some(AnchorPlan::Several(all)) => all.iter().map(|&at| DVec2::from(at)).collect(),
        Some(AnchorPlan::Sampled(_)) => Vec::new(),
        None => scene.anchor().into_iter().collect(),
    }
}

/// A frame with ticks along the bottom and the left.
fn axes(svg: &mut Svg, frame: &Frame, y_ticks: &Ticks, unit: &str) {
    let stroke = &format!("stroke=\"{INK}\"");
    let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
    svg.rect([frame.left, frame.top], [frame.width, frame.height], &format!("fill=\"none\" {stroke}"));
    let x_ticks = Ticks::across(frame.view.low.x, frame.view.high.x, frame.width);
    for (x, name) in &x_ticks.marks {
        let [x, _] = frame.at(DVec2::new(*x, frame.view.low.y));
        svg.line([x, bottom], [x, bottom + 4.0], stroke);
        svg.text([x, bottom + 17.0], Align::Middle, "", name);
    }
    for (y, name) in &y_ticks.marks {
        let [_, y] = frame.at(DVec2::new(frame.view.low.x, *y));
        svg.line([frame.left - 4.0, y], [frame.left, y], stroke);
        svg.text([frame.left - 7.0, y + 4.0], Align::End, "", name);
    }
    let title = format!("x ({})", x_ticks.unit(unit));
    let middle = ((frame.left + right) / 2.0).max(8.0 + width(&title, 13.0) / 2.0);
    svg.text([middle, bottom + 38.0], Align::Middle, "font-size=\"13\"", &format!("x ({})", x_ticks.unit(unit)));
    svg.text([8.0, 18.0], Align::Start, "font-size=\"13\"", &format!("y ({})", y_ticks.unit(unit)));
}

/// The colour bar.
fn bar(svg: &mut Svg, [x, top]: [f64; 2], height: f64, shades: &Shades, what: &str, unit: &str) {
    for i in 0..SHADES {
        // Each lies on the lighter ones and reaches to the top, so that no seam shows between two.
        let rest = height * (SHADES - i) as f64 / SHADES as f64;
        svg.rect([x, top], [16.0, rest], &format!("fill=\"{}\" shape-rendering=\"crispEdges\"", shade(i)));
    }
    let most = (height / 50.0).clamp(2.0, 8.0) as usize;
    let ticks = if shades.logarithmic {
        Ticks::logarithmic(shades.low, shades.high, most)
    } else {
        Ticks::linear(shades.low, shades.high, most)
    };
    for (value, name) in &ticks.marks {
        let y = top + height * (1.0 - shades.at(*value));
        svg.line([x + 16.0, y], [x + 20.0, y], &format!("stroke=\"{INK}\""));
        svg.text([x + 24.0, y + 4.0], Align::Start, "", name);
    }
    let what = match ticks.unit(unit) {
        unit if unit.is_empty() => what.to_string(),
        unit => format!("{what} ({})", unit.trim_end()),
    };
    svg.text([beside(x, &what, 13.0), 18.0], Align::Start, "font-size=\"13\"", &what);
}

/// Where words at the colour bar start: at the bar, but neither beyond the right edge nor on the axes' titles.
fn beside(x: f64, words: &str, size: f64) -> f64 {
    x.min(WIDTH - 12.0 - width(words, size)).max(190.0)
}
