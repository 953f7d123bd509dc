//! What the marks of a picture mean: an entry for each kind that occurs in it.

use std::collections::BTreeSet;

use super::marks::{DASHES, DOTS, RAY_DASHES, anchor_mark, free_end_mark, point_mark, straight_mark, turn_mark};
use super::theme::{Theme, Tone};
use crate::picture::label::{count, width};
use crate::picture::svg::{Align, Svg};

/// A kind of mark, in the order in which they are explained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Entry {
    Anchor,
    FreeEnd,
    /// The trace as a line, where that stands for it; or what of it has been made.
    Trace,
    /// The way of an anchor that moves.
    AnchorTrace,
    /// Every how many of its points are drawn.
    Points(usize),
    ToCome,
    Rope,
    /// One of several traces with its rope: its place in the picture, and its number.
    Several(usize, u64),
    TurnLeft,
    TurnRight,
    Straight,
    /// How many rays of the pivot are drawn if not all of them are, of how many.
    Rays(Option<(usize, usize)>),
    Unwrapping,
    /// Where the event of a small picture happens.
    Event,
    Wall,
}

/// How high a row is, and how wide a mark.
const ROW: f64 = 20.0;
const MARK: f64 = 26.0;
const GAP: f64 = 18.0;

/// The entries of a picture.
#[derive(Debug, Default)]
pub(super) struct Key(BTreeSet<Entry>);

impl Key {
    pub(super) fn add(&mut self, entry: Entry) {
        // Small pictures have different numbers of rays; one entry stands for them all.
        if matches!(entry, Entry::Rays(_)) && self.0.iter().any(|e| matches!(e, Entry::Rays(_))) {
            self.0.retain(|e| !matches!(e, Entry::Rays(_)));
            self.0.insert(Entry::Rays(None));
        } else {
            self.0.insert(entry);
        }
    }

    /// Where each entry stands in a key that is that wide, and how high it is.
    fn places(&self, wide: f64) -> (Vec<([f64; 2], Entry)>, f64) {
        let (mut x, mut y) = (0.0, 0.0);
        let mut places = Vec::new();
        for &entry in &self.0 {
            let taken = MARK + 6.0 + width(&entry.name(), 12.0);
            if x > 0.0 && x + taken > wide {
                (x, y) = (0.0, y + ROW);
            }
            places.push(([x, y], entry));
            x += taken + GAP;
        }
        (places, y + ROW)
    }

    /// How high it is if it is that wide.
    pub(super) fn height(&self, wide: f64) -> f64 {
        self.places(wide).1
    }

    /// Draws it, its top left corner at (`left`, `top`).
    pub(super) fn draw(&self, svg: &mut Svg, theme: Theme, [left, top]: [f64; 2], wide: f64) {
        for ([x, y], entry) in self.places(wide).0 {
            let (x, y) = (left + x, top + y + ROW / 2.0);
            // Where traces have colours of their own, those of one trace mean nothing.
            let plain = self.0.iter().any(|e| matches!(e, Entry::Several(..)));
            entry.mark(svg, theme, [x, y], &|tone| if plain { Tone::Ink } else { tone });
            svg.text([x + MARK + 6.0, y + 4.0], Align::Start, &theme.fill(Tone::Muted), &entry.name());
        }
    }
}

impl Entry {
    fn name(self) -> String {
        match self {
            Entry::Anchor => "anchor".into(),
            Entry::FreeEnd => "free end".into(),
            Entry::Trace => "trace".into(),
            Entry::AnchorTrace => "trace of the anchor".into(),
            Entry::Points(1) => "points of the trace".into(),
            Entry::Points(n) => format!("every {}{} point of the trace", count(n as u64), ordinal(n)),
            Entry::ToCome => "trace still to come".into(),
            Entry::Rope => "rope".into(),
            Entry::Several(_, id) => format!("trace {id} and its rope"),
            Entry::TurnLeft => "turn, wall end on the left".into(),
            Entry::TurnRight => "turn, wall end on the right".into(),
            Entry::Straight => "contact passed straight".into(),
            Entry::Rays(None) => "rays of the pivot".into(),
            Entry::Rays(Some((shown, all))) => format!("rays of the pivot ({shown} of {})", count(all as u64)),
            Entry::Unwrapping => "unwrapping ray".into(),
            Entry::Event => "where it wraps or unwraps".into(),
            Entry::Wall => "wall".into(),
        }
    }

    /// The mark, in the middle of the left edge of its place.
    fn mark(self, svg: &mut Svg, theme: Theme, [x, y]: [f64; 2], own: &dyn Fn(Tone) -> Tone) {
        let middle = [x + MARK / 2.0, y];
        let (from, to) = ([x, y], [x + MARK, y]);
        let line = |svg: &mut Svg, tone, rest: &str| svg.line(from, to, &format!("{} {rest}", theme.stroke(tone)));
        match self {
            Entry::Anchor => anchor_mark(svg, theme, middle),
            Entry::FreeEnd => free_end_mark(svg, theme, middle, Tone::Ink),
            Entry::Trace => line(svg, own(Tone::Trace(0)), "stroke-width=\"1.2\""),
            Entry::AnchorTrace => line(svg, own(Tone::Trace(1)), "stroke-width=\"1.2\""),
            Entry::Points(_) => point_mark(svg, theme, middle, own(Tone::Trace(0))),
            Entry::ToCome => line(svg, own(Tone::Trace(0)), "stroke-width=\"1.2\" stroke-opacity=\".35\""),
            Entry::Rope => line(svg, Tone::Ink, DASHES),
            Entry::Several(i, _) => line(svg, Tone::Trace(i), DASHES),
            Entry::TurnLeft => turn_mark(svg, theme, middle, true, 1.0, own(Tone::Left)),
            Entry::TurnRight => turn_mark(svg, theme, middle, false, 1.0, own(Tone::Right)),
            Entry::Straight => straight_mark(svg, theme, middle),
            Entry::Rays(_) => line(svg, Tone::Muted, RAY_DASHES),
            Entry::Unwrapping => line(svg, Tone::Ink, DOTS),
            Entry::Event => {
                svg.circle(middle, 8.0, &format!("fill=\"none\" {} stroke-width=\"1.2\"", theme.stroke(Tone::Ink)))
            }
            Entry::Wall => line(svg, Tone::Wall, "stroke-width=\"1.6\""),
        }
    }
}

fn ordinal(n: usize) -> &'static str {
    match (n % 10, n % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    }
}
