//! Marks and dashes: what stands for what in a picture.

use super::theme::{Theme, Tone};
use crate::picture::svg::Svg;

/// The rope is dashed, the rays of the pivot dash-dotted, the unwrapping ray dotted.
pub(super) const DASHES: &str = "stroke-width=\"2.2\" stroke-dasharray=\"7 4\" stroke-linejoin=\"round\"";
pub(super) const RAY_DASHES: &str = "stroke-width=\".9\" stroke-dasharray=\"9 3 1.5 3\"";
pub(super) const DOTS: &str = "stroke-width=\"2\" stroke-dasharray=\"0 4.5\" stroke-linecap=\"round\"";

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
