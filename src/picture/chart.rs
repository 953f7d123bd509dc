//! A rectangle with an axis along the bottom and one along the left.

use super::colour::{GRID, INK, MUTED};
use super::label::{shortened, width};
use super::svg::{Align, Svg};
use super::ticks::Ticks;

/// How wide pictures are, in pixels.
pub(super) const WIDTH: f64 = 720.0;

/// Between names along an axis, in pixels.
const GAP: f64 = 8.0;

/// Names are given at least so much room.
const LEAST: f64 = 60.0;

/// Where values lie along one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// `low` lies at pixel `from`, `high` at `to`; a range of nothing is widened.
    pub(super) fn new(low: f64, high: f64, from: f64, to: f64) -> Self {
        let half = if low < high { 0.0 } else { (low.abs() / 2.0).max(f64::MIN_POSITIVE * 1e16) };
        Scale { low: low - half, high: high.max(low) + half, from, to }
    }

    /// Where `x` lies.
    pub(super) fn at(&self, x: f64) -> f64 {
        self.from + (x - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Where `x` lies, or the nearest end.
    pub(super) fn within(&self, x: f64) -> f64 {
        self.at(x.clamp(self.low, self.high))
    }
}

/// Both axes. `top` and `bottom` are pixels of the picture.
pub(super) struct Chart {
    /// The axis along the bottom.
    pub(super) x: Scale,
    /// The axis along the left.
    pub(super) y: Scale,
    x_ticks: Ticks,
    y_ticks: Ticks,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Chart {
    /// Values from `x.0` to `x.1` and from `y.0` to `y.1` between the pixels `top` and `bottom`, up to the pixel
    /// `right`.
    pub(super) fn new(x: (f64, f64), y: (f64, f64), right: f64, top: f64, bottom: f64) -> Self {
        let y = Scale::new(y.0, y.1, bottom, top);
        let y_ticks = Ticks::linear(y.low, y.high, 6);
        let left = 40.0 + y_ticks.width();
        let x = Scale::new(x.0, x.1, left, right);
        let x_ticks = Ticks::across(x.low, x.high, right - left);
        Chart { x, y, x_ticks, y_ticks, left, right, top, bottom }
    }

    /// The same with these marks along the bottom, each a value with its name, in place of round numbers: with names as
    /// long as there is room for, and, where there are very many, evenly as many of them as have that.
    pub(super) fn with_marks(self, marks: &[(f64, String)]) -> Self {
        let slot = (self.right - self.left) / marks.len().max(1) as f64;
        let cut = |(x, name): &(f64, String)| (*x, shortened(name, (slot - GAP).max(LEAST)));
        let marks: Vec<_> = marks.iter().map(cut).collect();
        let widest = marks.iter().map(|(_, name)| width(name, 12.0)).fold(0.0, f64::max) + GAP;
        let every = (widest / slot).ceil().max(1.0) as usize;
        let x_ticks = Ticks { marks: marks.into_iter().step_by(every).collect(), exponent: 0 };
        Chart { x_ticks, ..self }
    }

    /// The lines behind the marks.
    pub(super) fn grid(&self, svg: &mut Svg) {
        for (value, _) in &self.y_ticks.marks {
            let y = self.y.at(*value);
            svg.line([self.left, y], [self.right, y], &format!("stroke=\"{GRID}\""));
        }
    }

    /// The axes, in front of the marks: what they show, and in which unit.
    pub(super) fn axes(&self, svg: &mut Svg, x: (&str, &str), y: (&str, &str)) {
        let title = |ticks: &Ticks, (what, unit): (&str, &str)| match (unit, ticks.exponent) {
            ("", 0) => what.to_string(),
            _ => format!("{what} ({})", ticks.unit(unit).trim_end()),
        };
        svg.line([self.left, self.bottom], [self.right, self.bottom], &format!("stroke=\"{INK}\""));
        for (value, name) in &self.x_ticks.marks {
            let x = self.x.at(*value);
            svg.line([x, self.bottom], [x, self.bottom + 5.0], &format!("stroke=\"{INK}\""));
            svg.text([x, self.bottom + 18.0], Align::Middle, "", name);
        }
        for (value, name) in &self.y_ticks.marks {
            svg.text([self.left - 7.0, self.y.at(*value) + 4.0], Align::End, "", name);
        }
        let middle = (self.left + self.right) / 2.0;
        svg.text([middle, self.bottom + 39.0], Align::Middle, "font-size=\"13\"", &title(&self.x_ticks, x));
        svg.text([self.left - 7.0, self.top - 14.0], Align::Start, "font-size=\"13\"", &title(&self.y_ticks, y));
    }

    /// Left, right, top and bottom of what the axes enclose.
    pub(super) fn bounds(&self) -> [f64; 4] {
        [self.left, self.right, self.top, self.bottom]
    }
}

/// One line that says what marks mean: for each a style of a short stroke, and its name. From `x` on, at the height
/// `y`.
pub(super) fn legend(svg: &mut Svg, [mut x, y]: [f64; 2], entries: &[(String, String)]) {
    for (style, name) in entries {
        svg.line([x, y], [x + 18.0, y], style);
        svg.text([x + 24.0, y + 4.0], Align::Start, &format!("fill=\"{MUTED}\""), name);
        x += 24.0 + width(name, 12.0) + 18.0;
    }
}
