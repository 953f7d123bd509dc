//! The part of a picture in which the plane is drawn: walls, marks, and lines that end at its edge.

use std::fmt::Write;

use glam::DVec2;

use super::key::{Entry, Key};
use super::theme::{Theme, Tone};
use super::trace::distance;
use crate::picture::plane::{Frame, View, clip};
use crate::picture::svg::{Svg, px};
use crate::scene::Scene;

/// The rope is dashed, the rays of the pivot dash-dotted, the unwrapping ray dotted.
pub(super) const DASHES: &str = "stroke-width=\"2.2\" stroke-dasharray=\"7 4\" stroke-linejoin=\"round\"";
pub(super) const RAY_DASHES: &str = "stroke-width=\".9\" stroke-dasharray=\"9 3 1.5 3\"";
pub(super) const DOTS: &str = "stroke-width=\"2\" stroke-dasharray=\"0 4.5\" stroke-linecap=\"round\"";

/// Where the plane is drawn, in pixels from its own top left corner.
pub(super) struct Canvas<'a> {
    pub(super) svg: &'a mut Svg,
    pub(super) frame: Frame,
    pub(super) theme: Theme,
    pub(super) key: &'a mut Key,
}

impl Canvas<'_> {
    /// Where a point of the plane lies.
    pub(super) fn at(&self, p: DVec2) -> [f64; 2] {
        self.frame.at(p)
    }

    /// Whether a pixel is to be seen.
    pub(super) fn shows(&self, [x, y]: [f64; 2]) -> bool {
        (0.0..=self.frame.width).contains(&x) && (0.0..=self.frame.height).contains(&y)
    }

    /// Path data of the part of a line that is to be seen. No number leaves the picture by much, however long the line is.
    pub(super) fn line(&self, points: &[[f64; 2]]) -> String {
        let room = View { low: DVec2::splat(-8.0), high: DVec2::new(self.frame.width, self.frame.height) + 8.0 };
        let mut data = String::new();
        let mut pen = None;
        for ends in points.windows(2) {
            let Some([a, b]) = clip(room, [ends[0].into(), ends[1].into()]) else { continue };
            let [a, b] = [a, b].map(|p| [px(p.x), px(p.y)]);
            if pen.as_ref() != Some(&a) {
                let _ = write!(data, "M{} {}", a[0], a[1]);
            }
            if a != b {
                let _ = write!(data, "L{} {}", b[0], b[1]);
            }
            pen = Some(b);
        }
        data
    }

    /// All walls that are to be seen, finer where they are very many.
    pub(super) fn walls(&mut self, scene: &Scene) {
        let path = self.frame.walls(scene);
        if path.is_empty() {
            return;
        }
        self.key.add(Entry::Wall);
        self.svg.path(&path, &wall_style(self.theme, path.len(), self.frame.width));
    }

    /// Where the rope is tied.
    pub(super) fn anchor(&mut self, anchor: DVec2) {
        let at = self.at(anchor);
        if self.shows(at) {
            self.key.add(Entry::Anchor);
            anchor_mark(self.svg, self.theme, at);
        }
    }

    /// The free end; a ring round the anchor's mark where it lies on that.
    pub(super) fn free_end(&mut self, a: DVec2, anchor: DVec2, tone: Tone) {
        let (at, tied) = (self.at(a), self.at(anchor));
        if !self.shows(at) {
            return;
        }
        self.key.add(Entry::FreeEnd);
        if distance(at, tied) < 8.0 {
            let stroke = self.theme.stroke(tone);
            self.svg.circle(at, 8.0, &format!("fill=\"none\" {stroke} stroke-width=\"2\""));
        } else {
            free_end_mark(self.svg, self.theme, at, tone);
        }
    }

    /// A ring about the wall end at which something happens.
    pub(super) fn ring(&mut self, p: DVec2) {
        let at = self.at(p);
        if self.shows(at) {
            self.key.add(Entry::Event);
            self.svg.circle(at, 8.0, &format!("fill=\"none\" {} stroke-width=\"1.2\"", self.theme.stroke(Tone::Ink)));
        }
    }
}

/// The style of walls whose path has that many letters in a picture that is that wide.
pub(super) fn wall_style(theme: Theme, letters: usize, wide: f64) -> String {
    let dense = letters as f64 / wide;
    let line = match dense {
        ..=0.25 => "2.4",
        ..=40.0 => "1.6",
        ..=120.0 => "1",
        _ => ".6",
    };
    let stroke = theme.stroke(Tone::Wall);
    format!("fill=\"none\" {stroke} stroke-width=\"{line}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"")
}

pub(super) fn anchor_mark(svg: &mut Svg, theme: Theme, at: [f64; 2]) {
    svg.circle(at, 5.0, &theme.both(Tone::Ink, Tone::Ground));
}

pub(super) fn free_end_mark(svg: &mut Svg, theme: Theme, at: [f64; 2], tone: Tone) {
    svg.circle(at, 4.6, &format!("{} stroke-width=\"2\"", theme.both(Tone::Ground, tone)));
}

pub(super) fn point_mark(svg: &mut Svg, theme: Theme, at: [f64; 2], tone: Tone) {
    svg.circle(at, 2.6, &theme.both(Tone::Ground, tone));
}

/// A contact that the rope passes straight: a hollow diamond.
pub(super) fn straight_mark(svg: &mut Svg, theme: Theme, [x, y]: [f64; 2]) {
    let corners = [[x, y - 4.5], [x + 4.5, y], [x, y + 4.5], [x - 4.5, y]];
    svg.polygon(&corners, &format!("{} stroke-width=\"1.3\"", theme.both(Tone::Ground, Tone::Ink)));
}

/// A turn of the rope: round where the wall end lies on its left, square where it lies on its right.
pub(super) fn turn_mark(svg: &mut Svg, theme: Theme, [x, y]: [f64; 2], left: bool, size: f64, tone: Tone) {
    let style = theme.both(tone, Tone::Ground);
    if left {
        svg.circle([x, y], 3.7 * size, &style);
    } else {
        let half = 3.3 * size;
        svg.rect([x - half, y - half], [2.0 * half, 2.0 * half], &style);
    }
}
