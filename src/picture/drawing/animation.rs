//! A trace that is played in an SVG by itself, without a script (SMIL).

use std::collections::BTreeMap;
use std::fmt::Write;

use glam::DVec2;

use super::canvas::Canvas;
use super::film::{Film, most_contacts};
use super::key::{Entry, Key};
use super::marks::{DASHES, turn_mark};
use super::still::Plot;
use super::theme::Tone;
use super::trace::TraceStyle;
use super::{DrawError, Drawing};
use crate::picture::label::counted;
use crate::picture::svg::{Svg, px};

/// The most points of all moments' ropes together, about: a megabyte.
const POINTS: usize = 60_000;

/// The most moments, however short the ropes.
const MOMENTS: usize = 1500;

/// How long it takes in seconds: so long for each step, within bounds, and it rests at the end.
const STEP: f64 = 0.15;
const SHORTEST: f64 = 5.0;
const LONGEST: f64 = 40.0;
const REST: f64 = 1.5;

impl Drawing<'_> {
    /// An SVG that plays the trace over and over, the rope following. Where SVGs do not move it shows the last moment.
    ///
    /// Time goes by steps. Of very long traces every so many steps are played.
    ///
    /// # Errors
    ///
    /// No trace or several, an empty part of the plane.
    pub fn animated(&self) -> Result<String, DrawError> {
        let dragged = self.one("an animation")?;
        let corners = most_contacts(dragged) + 2;
        let film = self.film(dragged, (POINTS / corners).clamp(50, MOMENTS));
        let plot = Plot::new(self.view(2.5)?, self.scene);
        let (mut inside, mut key) = (Svg::part(), Key::default());
        let mut canvas = Canvas { svg: &mut inside, frame: plot.frame, theme: self.theme, key: &mut key };
        canvas.walls(self.scene);
        let anchor = self.anchor.unwrap_or_default();
        let end = dragged.points[dragged.points.len() - 1];
        canvas.trace(&dragged.points, dragged.points.len(), end, &TraceStyle { tone: Tone::Trace(0), points: false });
        canvas.play(&film, anchor, corners);
        canvas.anchor(anchor);
        let steps = counted(dragged.points.len() as u64 - 1, "step", "steps");
        Ok(plot.finish(self.theme, &[format!("Trace {}, {steps}", dragged.record.trace)], inside, &key))
    }
}

/// A value that an attribute takes, and when, from 0 to 1.
type Change = (f64, String);

/// When each moment is shown.
struct Clock {
    /// From 0 to 1 for each state.
    times: Vec<f64>,
    seconds: f64,
}

impl Clock {
    fn new(film: &Film) -> Self {
        let (first, last) = film.span();
        let playing = (STEP * (last - first)).clamp(SHORTEST, LONGEST);
        let seconds = playing + REST;
        let times = film.states.iter().map(|s| (s.time - first) / (last - first) * playing / seconds).collect();
        Clock { times, seconds }
    }

    /// An element that gives an attribute these values at these times, and the last one until it begins anew.
    fn animate(&self, attribute: &str, discrete: bool, values: &[Change]) -> String {
        let rest = values.last().filter(|_| !discrete).map(|(_, value)| (1.0, value.clone()));
        let all: Vec<&Change> = values.iter().chain(&rest).collect();
        let list = |each: &dyn Fn(&Change) -> String| all.iter().map(|v| each(v)).collect::<Vec<_>>().join(";");
        format!(
            "<animate attributeName=\"{attribute}\" calcMode=\"{}\" dur=\"{:.2}s\" repeatCount=\"indefinite\" \
             keyTimes=\"{}\" values=\"{}\"/>",
            if discrete { "discrete" } else { "linear" },
            self.seconds,
            list(&|v| format!("{:.5}", v.0)),
            list(&|v| v.1.clone())
        )
    }
}

impl Canvas<'_> {
    /// The moving rope, its turns and the free end.
    fn play(&mut self, film: &Film, anchor: DVec2, corners: usize) {
        let clock = Clock::new(film);
        self.key.add(Entry::Rope);
        self.key.add(Entry::FreeEnd);
        let ropes = self.ropes(film, &clock, anchor, corners);
        let last = ropes.last().map_or(String::new(), |(_, points)| points.clone());
        let moves = clock.animate("points", false, &ropes);
        let style = format!("{} {DASHES}", self.theme.stroke(Tone::Ink));
        self.svg.raw(&format!("<polyline points=\"{last}\" fill=\"none\" {style}>{moves}</polyline>"));
        self.turning(film, &clock);
        let places: Vec<[f64; 2]> = film.states.iter().map(|s| near(self.at(s.at))).collect();
        let along = |axis: usize| -> Vec<Change> {
            clock.times.iter().zip(&places).map(|(&t, place)| (t, px(place[axis]))).collect()
        };
        let end = places[places.len() - 1].map(px);
        let style = format!("{} stroke-width=\"2\"", self.theme.both(Tone::Ground, Tone::Ink));
        let (x, y) = (clock.animate("cx", false, &along(0)), clock.animate("cy", false, &along(1)));
        self.svg.raw(&format!("<circle cx=\"{}\" cy=\"{}\" r=\"4.6\" {style}>{x}{y}</circle>", end[0], end[1]));
    }

    /// The rope's points at each moment, as many for each: a rope with fewer corners goes through its pivot several
    /// times. Where the corners change there are two of one time, which lie on each other.
    fn ropes(&self, film: &Film, clock: &Clock, anchor: DVec2, corners: usize) -> Vec<Change> {
        let text = |rope: usize, a: DVec2| {
            let mut points: Vec<DVec2> = std::iter::once(anchor).chain(film.ropes[rope].iter().map(|c| c.at)).collect();
            points.resize(corners - 1, points[points.len() - 1]);
            points.push(a);
            let mut out = String::new();
            for (i, p) in points.into_iter().enumerate() {
                let [x, y] = near(self.at(p)).map(px);
                let _ = write!(out, "{}{x},{y}", if i == 0 { "" } else { " " });
            }
            out
        };
        let mut ropes = Vec::new();
        for (i, (state, &time)) in film.states.iter().zip(&clock.times).enumerate() {
            let before = i.checked_sub(1).map(|i| film.states[i].rope).filter(|&before| before != state.rope);
            ropes.extend(before.map(|before| (time, text(before, state.at))));
            ropes.push((time, text(state.rope, state.at)));
        }
        ropes
    }

    /// A mark for each wall end and side at which the rope ever turns, seen while it does.
    fn turning(&mut self, film: &Film, clock: &Clock) {
        let mut seen: BTreeMap<(u32, bool), (DVec2, Vec<Change>)> = BTreeMap::new();
        let name = |there: bool| if there { "visible" } else { "hidden" }.to_owned();
        for c in film.ropes.iter().flatten().filter(|c| c.turns) {
            seen.entry((c.vertex, c.left)).or_insert((c.at, vec![(0.0, name(false))]));
        }
        let mut before = usize::MAX;
        for (state, &time) in film.states.iter().zip(&clock.times).filter(|(s, _)| {
            let changed = s.rope != before;
            before = s.rope;
            changed
        }) {
            for (&(vertex, left), (_, changes)) in &mut seen {
                let rope = &film.ropes[state.rope];
                let there = name(rope.iter().any(|c| c.turns && c.vertex == vertex && c.left == left));
                if changes.last().is_none_or(|(_, last)| *last != there) {
                    changes.push((time, there));
                }
            }
        }
        for ((_, left), (at, changes)) in seen {
            self.key.add(if left { Entry::TurnLeft } else { Entry::TurnRight });
            let last = changes.last().map_or("hidden", |(_, value)| value);
            self.svg.open("g", &format!("visibility=\"{last}\""));
            let tone = if left { Tone::Left } else { Tone::Right };
            turn_mark(self.svg, self.theme, near(self.at(at)), left, 1.0, tone);
            self.svg.raw(&clock.animate("visibility", true, &changes));
            self.svg.close("g");
        }
    }
}

/// A pixel, not further away than a browser can draw.
pub(super) fn near(at: [f64; 2]) -> [f64; 2] {
    at.map(|x| x.clamp(-1e5, 1e5))
}
