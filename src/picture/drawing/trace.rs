//! A trace in a picture: a line through all of its points, and circles at as many of them as have room.

use glam::DVec2;

use super::canvas::{Canvas, distance};
use super::key::Entry;
use super::marks::point_mark;
use super::theme::Tone;

/// Circles lie at least that many pixels apart along the trace, on the mean.
const APART: f64 = 10.0;

/// The most circles for each pixel of the picture's width, so that those of a trace that stays in one place do not
/// cover it.
const CIRCLES: f64 = 0.14;

/// The most points of a line in the file. Lines with more are drawn coarser, which nobody can see.
const CORNERS: usize = 20_000;

/// A line of more points than that is finer.
const DENSE: usize = 3000;

/// How a trace is drawn.
pub(super) struct TraceStyle {
    pub(super) tone: Tone,
    /// Whether its points are marked.
    pub(super) points: bool,
}

impl Canvas<'_> {
    /// A trace through `points`, of which `made` lie behind the free end at `a`; the others are still to come.
    pub(super) fn trace(&mut self, points: &[DVec2], made: usize, a: DVec2, style: &TraceStyle) {
        self.way(points, made, a, style, Entry::Trace);
    }

    /// The same of an anchor that moves.
    pub(super) fn anchor_trace(&mut self, points: &[DVec2], made: usize, style: &TraceStyle) {
        self.way(points, made, points[made - 1], style, Entry::AnchorTrace);
    }

    fn way(&mut self, points: &[DVec2], made: usize, a: DVec2, style: &TraceStyle, is: Entry) {
        let here = self.at(a);
        let ways: Vec<[f64; 2]> = points.iter().map(|&p| self.at(p)).collect();
        let (behind, ahead) = ways.split_at(made);
        let stroke = self.theme.stroke(style.tone);
        let behind: Vec<_> = behind.iter().copied().chain([here]).collect();
        let ahead: Vec<_> = std::iter::once(here).chain(ahead.iter().copied()).collect();
        for (part, opacity, entry) in [(&ahead, ".35", Entry::ToCome), (&behind, ".9", is)] {
            let line = thinned(part);
            let data = self.line(&line);
            if !data.is_empty() {
                self.key.add(entry);
                let width = if line.len() > DENSE { ".7" } else { "1.2" };
                let rest = format!("stroke-width=\"{width}\" stroke-linejoin=\"round\"");
                self.svg.path(&data, &format!("fill=\"none\" {stroke} stroke-opacity=\"{opacity}\" {rest}"));
            }
        }
        if style.points {
            self.points(&ways, made, style.tone);
        }
    }

    /// Circles at every 1st, 2nd, 5th, 10th and so on of the points, such that they have room; none where that would be
    /// but a few of very many.
    ///
    /// How many have room goes by the whole trace, so that they stay the same from one moment to the next.
    fn points(&mut self, ways: &[[f64; 2]], made: usize, tone: Tone) {
        let seen: Vec<[f64; 2]> = ways.iter().copied().filter(|&p| self.shows(p)).collect();
        let most = (CIRCLES * self.frame.width) as usize;
        let Some(every) = every(ways, seen.len(), most) else { return };
        let mut drawn = false;
        for &at in ways[..made].iter().step_by(every) {
            if self.shows(at) {
                point_mark(self.svg, self.theme, at, tone);
                drawn = true;
            }
        }
        if drawn {
            self.key.add(Entry::Points(every));
        }
    }
}

/// The least of 1, 2, 5, 10 and so on such that circles at every so many of the points are few enough and far enough
/// apart on the mean.
fn every(ways: &[[f64; 2]], seen: usize, most: usize) -> Option<usize> {
    let length: f64 = ways.windows(2).map(|w| distance(w[0], w[1])).sum();
    let steps = ways.len().saturating_sub(1).max(1) as f64;
    let fits = |n: usize| seen.div_ceil(n) <= most && (seen <= 2 || length / steps * n as f64 >= APART);
    let candidates = (0..10).flat_map(|e| [1, 2, 5].map(|unit| unit * 10usize.pow(e)));
    candidates.take_while(|&n| n == 1 || 4 * n <= seen).find(|&n| fits(n))
}

/// The line without the points that hardly leave the place of the one before.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut least = 0.4;
    loop {
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for &p in points {
            if kept.last().is_none_or(|&last| distance(last, p) >= least) {
                kept.push(p);
            }
        }
        if kept.len() <= CORNERS {
            // A line ends where it ends.
            kept.extend(points.last().filter(|&&end| kept.last() != Some(&end)));
            return kept;
        }
        least *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_have_room() {
        let row = |n: usize, apart: f64| (0..n).map(|i| [i as f64 * apart, 0.0]).collect::<Vec<_>>();
        assert_eq!(every(&row(20, 12.0), 20, 80), Some(1));
        assert_eq!(every(&row(20, 6.0), 20, 80), Some(2));
        assert_eq!(every(&row(400, 3.0), 400, 80), Some(5));
        assert_eq!(every(&row(10_000, 1.0), 10_000, 80), Some(200));
        // A cloud in one place: a line says more.
        assert_eq!(every(&row(10_000, 0.001), 10_000, 80), None);
    }

    #[test]
    fn lines_keep_their_ends_and_lose_what_nobody_sees() {
        let dense: Vec<[f64; 2]> = (0..200_000).map(|i| [f64::from(i % 500) * 1.5, f64::from(i / 500)]).collect();
        let line = thinned(&dense);
        assert!(line.len() <= CORNERS + 1, "{}", line.len());
        assert_eq!((line[0], line[line.len() - 1]), (dense[0], dense[dense.len() - 1]));
        let few = [[0.0, 0.0], [5.0, 0.0], [5.1, 0.0], [9.0, 9.0]];
        assert_eq!(thinned(&few), [[0.0, 0.0], [5.0, 0.0], [9.0, 9.0]]);
    }
}
