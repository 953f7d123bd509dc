//! Whether a shape is painted, and with what of it.

use glam::DVec2;
use svgtypes::{Color, PaintFallback};

use super::super::Inside;
use super::length::{Along, length};
use super::style::{Style, Value};

/// What an area or a line is painted with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ink {
    /// Nothing is said: areas are black, lines are not drawn.
    Unsaid,
    None,
    White,
    Other,
}

/// How what is in an element is painted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    fill: Ink,
    fill_opaque: bool,
    even_odd: bool,
    stroke: Ink,
    stroke_opaque: bool,
    stroke_width: f64,
    markers: [bool; 3],
    /// Neither the element nor anything round it has an opacity of 0.
    opaque: bool,
    /// Whether it is visible.
    pub(super) visible: bool,
}

impl Default for Paint {
    fn default() -> Self {
        Paint {
            fill: Ink::Unsaid,
            fill_opaque: true,
            even_odd: false,
            stroke: Ink::Unsaid,
            stroke_opaque: true,
            stroke_width: 1.0,
            markers: [false; 3],
            opaque: true,
            visible: true,
        }
    }
}

impl Paint {
    /// How an element with this style is painted that lies in what is painted as `self`, and what of its style is not
    /// understood. `known` says whether the file has an element of this id.
    pub(super) fn within(
        mut self,
        style: &Style<'_>,
        viewport: Option<DVec2>,
        known: impl Fn(&str) -> bool,
    ) -> (Self, Vec<String>) {
        let mut unread = Vec::new();
        self.begin(style);
        let said = |name: &str| style.get(name).filter(|value| !value.is(&["inherit"]));
        let mut not = |name: &str, value: Value<'_>| unread.push(format!("{name}: {}", value.text));
        for (name, ink) in [("fill", &mut self.fill), ("stroke", &mut self.stroke)] {
            if let Some(value) = said(name) {
                match Ink::of(value.text, &known) {
                    Some(read) => *ink = read,
                    None => not(name, value),
                }
            }
        }
        let opacities = [("fill-opacity", &mut self.fill_opaque), ("stroke-opacity", &mut self.stroke_opaque)];
        let mut own = true;
        for (name, opaque) in opacities.into_iter().chain([("opacity", &mut own)]) {
            if let Some(value) = said(name) {
                match value.text.strip_suffix('%').unwrap_or(value.text).trim().parse::<f64>() {
                    Ok(opacity) => *opaque = opacity > 0.0,
                    Err(_) => not(name, value),
                }
            }
        }
        self.opaque &= own;
        if let Some(value) = said("stroke-width") {
            // Widths without a unit are usual in styles too.
            match length("stroke-width", Value { css: false, ..value }, Along::Both, viewport) {
                Ok(width) => self.stroke_width = width.unwrap_or(1.0),
                Err(_) => not("stroke-width", value),
            }
        }
        for (i, name) in ["marker-start", "marker-mid", "marker-end"].into_iter().enumerate() {
            if let Some(value) = said(name) {
                self.markers[i] = !value.is(&["none"]);
            }
        }
        match style.word("fill-rule").as_str() {
            "evenodd" => self.even_odd = true,
            "nonzero" => self.even_odd = false,
            _ => {}
        }
        match style.word("visibility").as_str() {
            "visible" => self.visible = true,
            "hidden" | "collapse" => self.visible = false,
            _ => {}
        }
        (self, unread)
    }

    /// Takes back what is inherited where the style says so.
    fn begin(&mut self, style: &Style<'_>) {
        let initial = |name| style.is_initial(name);
        let usual = Paint::default();
        if initial("fill") {
            self.fill = usual.fill;
        }
        if initial("stroke") {
            self.stroke = Ink::None;
        }
        self.fill_opaque |= initial("fill-opacity");
        self.stroke_opaque |= initial("stroke-opacity");
        self.even_odd &= !initial("fill-rule");
        self.visible |= initial("visibility");
        if initial("stroke-width") {
            self.stroke_width = usual.stroke_width;
        }
        for (marker, name) in self.markers.iter_mut().zip(["marker-start", "marker-mid", "marker-end"]) {
            *marker &= !initial(name);
        }
    }

    fn fills(&self) -> bool {
        self.fill != Ink::None && self.fill_opaque && self.opaque
    }

    fn strokes(&self) -> bool {
        !matches!(self.stroke, Ink::None | Ink::Unsaid) && self.stroke_opaque && self.opaque && self.stroke_width > 0.0
    }

    /// Whether a shape is painted at all. One that is filled counts as painted even if it has no area, but for a `line`
    /// of which it is said that its stroke is none.
    pub(super) fn shows(&self, line: bool) -> bool {
        self.strokes() || (self.fills() && !(line && self.stroke != Ink::Unsaid))
    }

    /// How wide the stroke is, 0 if there is none.
    pub(super) fn width(&self) -> f64 {
        if self.strokes() { self.stroke_width } else { 0.0 }
    }

    /// Whether there are markers on lines.
    pub(super) fn marked(&self) -> bool {
        self.opaque && self.markers.contains(&true)
    }

    /// What is solid of a shape whose outline is closed, or not. White is the paper's own colour: floor, no solid.
    pub(super) fn inside(&self, closed: bool) -> Inside {
        match (closed && self.fills() && self.fill != Ink::White, self.even_odd) {
            (false, _) => Inside::Free,
            (true, false) => Inside::NonZero,
            (true, true) => Inside::EvenOdd,
        }
    }
}

impl Ink {
    fn of(text: &str, known: impl Fn(&str) -> bool) -> Option<Self> {
        let colour = |Color { red, green, blue, alpha }: Color| match ([red, green, blue], alpha) {
            (_, 0) => Ink::None,
            ([255, 255, 255], _) => Ink::White,
            _ => Ink::Other,
        };
        if text.eq_ignore_ascii_case("none") {
            return Some(Ink::None);
        }
        // The same colour by another profile may follow.
        let text = text.split(" icc-color").next().unwrap_or_default();
        Some(match svgtypes::Paint::from_str(text).ok()? {
            svgtypes::Paint::None => Ink::None,
            svgtypes::Paint::Color(c) => colour(c),
            svgtypes::Paint::FuncIRI(id, _) if known(id) => Ink::Other,
            svgtypes::Paint::FuncIRI(_, Some(PaintFallback::Color(c))) => colour(c),
            svgtypes::Paint::FuncIRI(_, Some(PaintFallback::CurrentColor)) => Ink::Other,
            svgtypes::Paint::FuncIRI(..) => Ink::None,
            _ => Ink::Other,
        })
    }
}
