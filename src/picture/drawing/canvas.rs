//! The part of a picture in which the plane is drawn: walls, marks, and lines that end at its edge.

use std::fmt::Write;

use glam::DVec2;

use super::key::{Entry, Key};
use super::marks::{anchor_mark, free_end_mark};
use super::theme::{Theme, Tone};
use crate::picture::plane::{Frame, View, clip};
use crate::picture::svg::{Svg, px};
use crate::scene::Scene;

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

    /// Path data of the part of a line that is to be seen. No number leaves the picture by much, however long the line
    /// is.
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

/// How far apart two pixels are.
pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
