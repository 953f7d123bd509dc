//! Several moments of one trace, side by side in small pictures.

use std::ops::RangeInclusive;

use super::canvas::{Canvas, wall_style};
use super::key::{Entry, Key};
use super::rope::{RopeStyle, Shape};
use super::still::{MARGIN, document, window};
use super::theme::Tone;
use super::trace::TraceStyle;
use super::{Dragged, DrawError, Drawing};
use crate::picture::chart::WIDTH;
use crate::picture::label::{count, width};
use crate::picture::plane::Frame;
use crate::picture::svg::{Align, Svg};
use crate::rope::Moment;

/// How many small pictures one picture holds at the most.
pub const MOST_FRAMES: usize = 120;

/// How many of them there are unless asked for.
const FRAMES: usize = 24;

const COLUMNS: usize = 3;
const GAP: f64 = 14.0;
/// How high a small picture may be.
const HIGHEST: f64 = 300.0;
/// How much room the words above a small picture take.
const HEAD: f64 = 24.0;

/// A small picture: the moment, and what is said above it.
pub(in crate::picture) struct Panel {
    title: String,
    moment: Moment,
}

impl Drawing<'_> {
    /// The moment after a step of the one trace, as a small picture.
    pub(in crate::picture) fn panel_after(&self, step: usize) -> Result<Panel, DrawError> {
        let moment = self.clone().at_step(step).moment(self.one("a small picture")?)?;
        Ok(Panel { title: format!("after step {step}"), moment })
    }
}

impl Drawing<'_> {
    /// A filmstrip as SVG: a small picture for each event, with the free end where it happens.
    ///
    /// `events` counts from 1; without it the first 24 are shown. A line in the picture says which of how many they
    /// are.
    ///
    /// # Errors
    ///
    /// No trace or several, a rope that touches nothing, events that there are not, and more than [`MOST_FRAMES`].
    pub fn frames(&self, events: Option<RangeInclusive<usize>>) -> Result<String, DrawError> {
        let dragged = self.one("a filmstrip")?;
        let (trace, all) = (dragged.record.trace, dragged.record.events.len());
        if all == 0 {
            return Err(DrawError::NoEvents { trace });
        }
        let (from, to) = events.map_or((1, all.min(FRAMES)), RangeInclusive::into_inner);
        if from < 1 || from > to || to > all {
            return Err(DrawError::Events { trace, from, to, events: all });
        }
        if to - from >= MOST_FRAMES {
            return Err(DrawError::TooManyFrames { from, to, most: MOST_FRAMES });
        }
        let mut panels = Vec::new();
        self.moments(dragged, &dragged.points, |m| {
            if let Some(i) = m.event.filter(|i| (from..=to).contains(&(i + 1))) {
                let (step, kind) = (count(m.step as u64), dragged.record.events[i].kind.name());
                panels.push(Panel { title: format!("{}. {kind} in step {step}", i + 1), moment: m.clone() });
            }
        });
        let heading = match (from, to) {
            (1, 1) if all == 1 => format!("Trace {trace}: its one event"),
            (1, to) if to == all => format!("Trace {trace}: all its {} events", count(all as u64)),
            _ => {
                let left_out = count((all - panels.len()) as u64);
                format!("Trace {trace}: events {from} to {to} of {}; {left_out} are left out", count(all as u64))
            }
        };
        self.strip(&panels, &heading, self.rays.unwrap_or(0))
    }

    /// Small pictures in rows of three under a heading of one or several lines, each with at most so many rays.
    pub(in crate::picture) fn strip(&self, panels: &[Panel], heading: &str, rays: usize) -> Result<String, DrawError> {
        let dragged = self.one("a filmstrip")?;
        let wide = WIDTH - 2.0 * MARGIN;
        let columns = panels.len().clamp(1, COLUMNS);
        let each = (wide - GAP * (columns - 1) as f64) / columns as f64;
        let frame = Frame::fit(self.view(1.5)?, [0.0, 0.0], [each, HIGHEST]).of(self.scene);
        let lines = wrapped(heading, wide, 14.0);
        let top = MARGIN + 20.0 * lines.len() as f64;
        let rows = panels.len().div_ceil(columns);
        let below = top + rows as f64 * (HEAD + frame.height + GAP);

        let mut key = Key::default();
        let windows: Vec<Svg> = panels.iter().map(|p| self.panel(dragged, p, frame, rays, &mut key)).collect();
        let walls = frame.walls(self.scene);
        if !walls.is_empty() {
            key.add(Entry::Wall);
        }
        let mut svg = document([WIDTH, below + key.height(wide) + 8.0], heading, self.theme);
        for (i, line) in lines.iter().enumerate() {
            let style = format!("font-size=\"14\" {}", self.theme.fill(Tone::Ink));
            svg.text([MARGIN, 22.0 + 20.0 * i as f64], Align::Start, &style, line);
        }
        // The walls stand in the file once.
        svg.open("defs", "");
        svg.path(&walls, &format!("id=\"walls\" {}", wall_style(self.theme, walls.len(), frame.width)));
        svg.close("defs");
        for (i, (panel, inside)) in panels.iter().zip(windows).enumerate() {
            let left = MARGIN + (i % columns) as f64 * (each + GAP) + (each - frame.width) / 2.0;
            let y = top + HEAD + (i / columns) as f64 * (HEAD + frame.height + GAP);
            svg.text([left, y - 7.0], Align::Start, &self.theme.fill(Tone::Muted), &panel.title);
            window(&mut svg, [left, y], frame, inside);
            let style = format!("fill=\"none\" {}", self.theme.stroke(Tone::Line));
            svg.rect([left, y], [frame.width, frame.height], &style);
        }
        key.draw(&mut svg, self.theme, [MARGIN, below], wide);
        Ok(svg.finish())
    }

    /// What is inside a small picture.
    fn panel(&self, dragged: &Dragged<'_>, panel: &Panel, frame: Frame, rays: usize, key: &mut Key) -> Svg {
        let moment = &panel.moment;
        let mut svg = Svg::part();
        svg.copy("walls", [0.0, 0.0]);
        let mut canvas = Canvas { svg: &mut svg, frame, theme: self.theme, key };
        if let Some(model) = self.model {
            canvas.rays(model, moment, rays);
        }
        // Within a step, its end is still to come.
        let made = if moment.event.is_some() { moment.step } else { moment.step + 1 };
        canvas.trace(&dragged.points, made, moment.at, &TraceStyle { tone: Tone::Trace(0), points: true });
        let anchor = self.anchor.unwrap_or_default();
        let turns = [Tone::Left, Tone::Right];
        canvas.rope(&Shape::new(anchor, moment), &RopeStyle { tone: Tone::Ink, turns, numbers: true });
        canvas.free_end(moment.at, anchor, Tone::Ink);
        canvas.anchor(anchor);
        if let Some(event) = moment.event.map(|i| dragged.record.events[i]) {
            canvas.ring(self.scene.vertices()[event.vertex as usize]);
        }
        svg
    }
}

/// The lines of a text that is at most that wide.
fn wrapped(text: &str, wide: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + size < wide => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
