//! The plane in a picture: which part of it is shown, where it lies, and its walls as one path.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use glam::DVec2;

use super::svg::tenths;
use crate::scene::Scene;

/// An axis-parallel rectangle of the plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl View {
    /// The least rectangle round `points`; `None` without any.
    pub(super) fn around(points: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        points
            .into_iter()
            .map(|p| View { low: p, high: p })
            .reduce(|a, b| View { low: a.low.min(b.low), high: a.high.max(b.high) })
    }

    pub(super) fn size(&self) -> DVec2 {
        self.high - self.low
    }

    /// Made wider or higher about its middle until it is at least `least` wide and high, and no side is more than
    /// `aspect` times the other.
    pub(super) fn widened(self, least: f64, aspect: f64) -> Self {
        let size = self.size();
        let wanted = size.max(DVec2::splat(size.max_element() / aspect)).max(DVec2::splat(least));
        let more = (wanted - size) / 2.0;
        View { low: self.low - more, high: self.high + more }
    }

    /// With a margin of that share of its longer side.
    pub(super) fn padded(self, share: f64) -> Self {
        let more = DVec2::splat(self.size().max_element() * share);
        View { low: self.low - more, high: self.high + more }
    }

    /// What `near` takes up if that is much less than the whole plane that `all` takes up, else the whole, with a
    /// margin and no side more than `aspect` times the other; `None` without any point. A point of `near` is one of
    /// `all`.
    pub(super) fn of_what_matters(
        near: impl IntoIterator<Item = DVec2>,
        all: impl IntoIterator<Item = DVec2>,
        aspect: f64,
    ) -> Option<Self> {
        let (taken, whole) = (View::around(near)?, View::around(all)?);
        let [near, far] = [taken, whole].map(|v| v.size().max_element());
        let view = if near > 0.0 && near < 0.5 * far {
            taken.padded(0.2).widened(0.02 * far, aspect).within(whole.padded(0.02))
        } else {
            whole.padded(0.04)
        };
        // Where there is but one point, it has some room round it.
        let least = if far > 0.0 { 0.0 } else { (whole.low.abs().max_element() * 0.1).max(f64::MIN_POSITIVE * 1e16) };
        Some(view.widened(least, aspect))
    }

    /// The part that is in `other` too.
    pub(super) fn within(self, other: View) -> Self {
        View { low: self.low.max(other.low), high: self.high.min(other.high) }
    }
}

/// A view and where it lies in the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) view: View,
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) scale: f64,
    /// Whether y points down.
    down: bool,
}

impl Frame {
    /// `view` from the pixel (`left`, `top`) on, as large as fits `width` and `height`.
    pub(super) fn fit(view: View, [left, top]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        let size = view.size();
        let scale = (width / size.x).min(height / size.y);
        Frame { view, left, top, width: size.x * scale, height: size.y * scale, scale, down: false }
    }

    /// The same frame with y upwards or downwards, as the scene is meant to be looked at.
    pub(super) fn of(self, scene: &Scene) -> Self {
        Frame { down: scene.y_down(), ..self }
    }

    /// Whether left and right are the other way round in the picture.
    pub(super) fn mirrored(&self) -> bool {
        self.down
    }

    /// Where a point lies.
    pub(super) fn at(&self, p: DVec2) -> [f64; 2] {
        let down = if self.down { p.y - self.view.low.y } else { self.view.high.y - p.y };
        [self.left + (p.x - self.view.low.x) * self.scale, self.top + down * self.scale]
    }

    /// All walls within the view, as the data of one path.
    ///
    /// Ends are rounded to a tenth of a pixel. What falls together is drawn once, and walls that hang together are one
    /// line: a path has no more numbers than the picture can show.
    pub(super) fn walls(&self, scene: &Scene) -> String {
        let mut lines: BTreeSet<[Point; 2]> = BTreeSet::new();
        for wall in 0..scene.walls().len() {
            if let Some(ends) = clip(self.view, scene.ends(wall)) {
                let [a, b] = ends.map(|p| self.at(p).map(|x| (x * 10.0).round() as i64));
                if a != b {
                    lines.insert([a.min(b), a.max(b)]);
                }
            }
        }
        path(&lines)
    }
}

/// The part of the straight way from `a` to `b` within `view`.
pub(super) fn clip(view: View, [a, b]: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let along = b - a;
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        for (speed, room) in [(-along[axis], a[axis] - view.low[axis]), (along[axis], view.high[axis] - a[axis])] {
            if speed == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if speed < 0.0 {
                from = from.max(room / speed);
            } else {
                to = to.min(room / speed);
            }
        }
    }
    let point = |t: f64, end| if t == 0.0 || t == 1.0 { end } else { a + along * t };
    (from <= to).then(|| [point(from, a), point(to, b)])
}

/// In tenths of a pixel.
type Point = [i64; 2];

/// Path data of all lines, each drawn once, by as few strokes as a greedy walk finds.
fn path(lines: &BTreeSet<[Point; 2]>) -> String {
    let mut open: BTreeMap<Point, BTreeSet<Point>> = BTreeMap::new();
    for &[a, b] in lines {
        open.entry(a).or_default().insert(b);
        open.entry(b).or_default().insert(a);
    }
    // A stroke starts where one must: at odd ends first. What is left then are rings.
    let odd = open.iter().filter(|(_, next)| next.len() % 2 == 1).map(|(&p, _)| p);
    let starts: Vec<Point> = odd.chain(open.keys().copied()).collect();
    let mut data = String::new();
    let mut pen = [0, 0];
    for start in starts {
        while let Some(stroke) = walk(&mut open, start) {
            draw(&mut data, &mut pen, &stroke);
        }
    }
    data
}

/// Follows lines from `start` until there are none, straight on where it can, and takes them away. Points on straight
/// runs are left out.
fn walk(open: &mut BTreeMap<Point, BTreeSet<Point>>, start: Point) -> Option<Vec<Point>> {
    let mut stroke = vec![start];
    let mut at = start;
    while let Some(ways) = open.get_mut(&at) {
        let before = stroke.len().checked_sub(2).map(|i| stroke[i]);
        let on = before.and_then(|before| ways.iter().copied().find(|&next| straight(before, at, next)));
        let Some(next) = on.or(ways.first().copied()) else { break };
        ways.remove(&next);
        open.entry(next).or_default().remove(&at);
        if on.is_some() {
            stroke.pop();
        }
        stroke.push(next);
        at = next;
    }
    (stroke.len() > 1).then_some(stroke)
}

/// Whether the way from `a` over `b` to `c` goes straight on.
fn straight(a: Point, b: Point, c: Point) -> bool {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    u[0] * v[1] == u[1] * v[0] && u[0] * v[0] + u[1] * v[1] > 0
}

/// Adds a stroke to path data, relative to the `pen`'s last point.
fn draw(data: &mut String, pen: &mut Point, stroke: &[Point]) {
    for (i, &p) in stroke.iter().enumerate() {
        let (x, y) = (tenths(p[0] - pen[0]), tenths(p[1] - pen[1]));
        let command = match i {
            0 => "m",
            1 => "l",
            _ if x.starts_with('-') => "",
            _ => " ",
        };
        let gap = if y.starts_with('-') { "" } else { " " };
        let _ = write!(data, "{command}{x}{gap}{y}");
        *pen = p;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        let view = View { low: DVec2::ZERO, high: DVec2::splat(10.0) };
        Frame::fit(view, [0.0, 0.0], [100.0, 100.0])
    }

    #[test]
    fn walls_that_hang_together_are_one_line() {
        let corners = [[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0], [1.0, 1.0]].map(DVec2::from);
        let ring = Scene::new(corners.windows(2).map(|w| [w[0], w[1]])).unwrap();
        assert_eq!(frame().walls(&ring), "m10 70l0 20 30 0 0-20-30 0");
        let row =
            Scene::new((0..9).map(|i| [DVec2::new(f64::from(i), 5.0), DVec2::new(f64::from(i + 1), 5.0)])).unwrap();
        assert_eq!(frame().walls(&row), "m0 50l90 0");
    }

    #[test]
    fn walls_end_at_the_frame() {
        let far = Scene::new([
            [[-1e9, 5.0].into(), [1e9, 5.0].into()],
            [[-5.0, 20.0].into(), [20.0, 20.0].into()],
            [[5.0, 5.0].into(), [5.0, 5.0001].into()],
        ]);
        assert_eq!(frame().walls(&far.unwrap()), "m0 50l100 0");
    }

    #[test]
    fn a_scene_whose_y_points_down_is_shown_so() {
        let corners = [[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 2.0]].map(DVec2::from);
        let up = Scene::new(corners.windows(2).map(|w| [w[0], w[1]])).unwrap();
        // The same drawing with its coordinates counted from the upper edge.
        let turned = |p: DVec2| DVec2::new(p.x, 10.0 - p.y);
        let down = Scene::new(corners.windows(2).map(|w| [turned(w[0]), turned(w[1])])).unwrap().with_y_down();
        assert_eq!(frame().of(&up).walls(&up), frame().of(&down).walls(&down));
        assert_ne!(frame().walls(&up), frame().walls(&down));
        assert_eq!([&up, &down].map(|scene| frame().of(scene).mirrored()), [false, true]);
    }
}
