//! One moment of one or several traces, with axes and a key.

use super::canvas::Canvas;
use super::key::{Entry, Key};
use super::rope::{RopeStyle, Shape};
use super::theme::{TRACES, Theme, Tone};
use super::trace::TraceStyle;
use super::{Dragged, DrawError, Drawing, RAYS};
use crate::picture::chart::WIDTH;
use crate::picture::label::{count, number, width};
use crate::picture::plane::{Frame, View};
use crate::picture::svg::{Align, Svg, px};
use crate::picture::ticks::Ticks;
use crate::picture::unit::unit;
use crate::rope::Moment;
use crate::scene::Scene;

/// How high the plane may be, in pixels.
const HIGHEST: f64 = 600.0;
pub(super) const MARGIN: f64 = 14.0;
/// Where the plane begins below the heading.
const TOP: f64 = 32.0;

impl Drawing<'_> {
    /// The picture of one moment as SVG: the scene, all traces and the rope of each.
    ///
    /// Long traces have circles at every 10th point, say, or none; ropes of very many turns have smaller marks, and
    /// numbers where there is room. O(walls + points + events).
    ///
    /// # Errors
    ///
    /// A step that a trace does not have, an empty part of the plane, more than six traces.
    pub fn svg(&self) -> Result<String, DrawError> {
        if self.dragged.len() > TRACES {
            return Err(DrawError::TooManyTraces { traces: self.dragged.len(), most: TRACES });
        }
        let shown = self.dragged.iter().map(|d| Ok((d, self.moment(d)?))).collect::<Result<Vec<_>, DrawError>>()?;
        let plot = Plot::new(self.view(2.5)?, self.scene);
        let (mut inside, mut key) = (Svg::part(), Key::default());
        let mut canvas = Canvas { svg: &mut inside, frame: plot.frame, theme: self.theme, key: &mut key };
        canvas.walls(self.scene);
        if let ([(Dragged { both: None, .. }, moment)], Some(model)) = (shown.as_slice(), self.model) {
            canvas.rays(model, moment, self.rays.unwrap_or(RAYS));
        }
        let alone = shown.len() == 1;
        for (i, (dragged, moment)) in shown.iter().enumerate() {
            let style = TraceStyle { tone: Tone::Trace(i), points: alone };
            canvas.trace(&dragged.points, moment.step + 1, moment.at, &style);
            if let Some((anchors, _)) = &dragged.both {
                let tone = if alone { Tone::Trace(1) } else { style.tone };
                canvas.anchor_trace(anchors, moment.step + 1, &TraceStyle { tone, ..style });
            }
        }
        for (i, (dragged, moment)) in shown.iter().enumerate() {
            let tone = if alone { Tone::Ink } else { Tone::Trace(i) };
            let turns = if alone { [Tone::Left, Tone::Right] } else { [tone; 2] };
            let moved = dragged.both.as_ref().map(|(anchors, _)| anchors[moment.step]);
            let anchor = moved.or(self.anchor).unwrap_or_default();
            let shape = Shape::new(anchor, moment);
            canvas.rope(&shape, &RopeStyle { tone, turns, numbers: alone });
            canvas.free_end(moment.at, anchor, tone);
            moved.into_iter().for_each(|anchor| canvas.anchor(anchor));
            if !alone {
                canvas.key.add(Entry::Several(i, dragged.record.trace));
            }
        }
        self.tied().into_iter().for_each(|anchor| canvas.anchor(anchor));
        Ok(plot.finish(self.theme, &heading(&shown), inside, &key))
    }
}

/// What a picture of these traces says above it.
fn heading(shown: &[(&Dragged<'_>, Moment)]) -> Vec<String> {
    match shown {
        [] => Vec::new(),
        [(dragged, moment)] => {
            let mut lines = vec![state(dragged, moment)];
            lines.extend(warning(dragged, moment));
            lines
        }
        [(first, moment), ..] => {
            let names: Vec<String> = shown.iter().map(|(d, _)| d.record.trace.to_string()).collect();
            let alike = shown.iter().all(|(_, m)| m.step == moment.step);
            let when = match alike {
                true => format!("after step {} of {}", count(moment.step as u64), count(first.points.len() as u64 - 1)),
                false => "after their last steps".into(),
            };
            vec![format!("Traces {} {when}", names.join(", "))]
        }
    }
}

/// `Trace 4 after step 37 of 500: 3 turns, 12.34 long`.
fn state(dragged: &Dragged<'_>, moment: &Moment) -> String {
    let depth = moment.rope.depth(moment.at);
    format!(
        "Trace {} after step {} of {}: {} turn{}, {} long",
        dragged.record.trace,
        count(moment.step as u64),
        count(dragged.points.len() as u64 - 1),
        count(u64::from(depth)),
        if depth == 1 { "" } else { "s" },
        number(moment.rope.length(moment.at), None)
    )
}

/// What is said about a trace that has crossed a wall by then.
fn warning(dragged: &Dragged<'_>, moment: &Moment) -> Option<String> {
    let step = dragged.crossing.filter(|&step| step <= moment.step)?;
    Some(format!("It crosses a wall in step {}; from there on the rope may be wrong.", count(step as u64)))
}

/// A frame with ticks, a heading above it and a key below.
pub(super) struct Plot {
    /// In pixels of the plane's own.
    pub(super) frame: Frame,
    left: f64,
    y_ticks: Ticks,
    /// What a unit of the plane is called.
    unit: String,
}

impl Plot {
    pub(super) fn new(view: View, scene: &Scene) -> Self {
        let y_ticks = Ticks::linear(view.low.y, view.high.y, 5);
        let left = MARGIN + 8.0 + y_ticks.width();
        let frame = Frame::fit(view, [0.0, 0.0], [WIDTH - left - MARGIN, HIGHEST]).of(scene);
        Plot { frame, left, y_ticks, unit: unit(scene).to_owned() }
    }

    /// The picture, with what is `inside` the frame.
    pub(super) fn finish(&self, theme: Theme, heading: &[String], inside: Svg, key: &Key) -> String {
        let Frame { width: w, height: h, .. } = self.frame;
        let left = self.left + (WIDTH - MARGIN - self.left - w) / 2.0;
        let top = if heading.is_empty() { MARGIN } else { TOP + 17.0 * (heading.len() - 1) as f64 };
        let (wide, below) = (WIDTH - 2.0 * MARGIN, top + h + 46.0);
        let title = heading.first().map_or("A scene", String::as_str);
        let mut svg = document([WIDTH, below + key.height(wide) + 8.0], title, theme);
        for (i, line) in heading.iter().enumerate() {
            let style = format!("font-size=\"14\" {}", theme.fill(Tone::Ink));
            svg.text([MARGIN, 21.0 + 17.0 * i as f64], Align::Start, &style, line);
        }
        window(&mut svg, [left, top], self.frame, inside);
        svg.rect([left, top], [w, h], &format!("fill=\"none\" {}", theme.stroke(Tone::Line)));
        self.axes(&mut svg, theme, [left, top]);
        key.draw(&mut svg, theme, [MARGIN, below], wide);
        svg.finish()
    }

    fn axes(&self, svg: &mut Svg, theme: Theme, [left, top]: [f64; 2]) {
        let (view, h) = (self.frame.view, self.frame.height);
        let (line, words) = (theme.stroke(Tone::Muted), theme.fill(Tone::Muted));
        let x_ticks = Ticks::across(view.low.x, view.high.x, self.frame.width);
        for (x, name) in &x_ticks.marks {
            let [x, _] = self.frame.at([*x, view.low.y].into());
            svg.line([left + x, top + h], [left + x, top + h + 4.0], &line);
            svg.text([left + x, top + h + 17.0], Align::Middle, &words, name);
        }
        for (y, name) in &self.y_ticks.marks {
            let [_, y] = self.frame.at([view.low.x, *y].into());
            svg.line([left - 4.0, top + y], [left, top + y], &line);
            svg.text([left - 7.0, top + y + 4.0], Align::End, &words, name);
        }
        let units = [&x_ticks, &self.y_ticks].map(|ticks| ticks.unit(&self.unit));
        let text = match units {
            [x, y] if x == y => format!("x and y in {x}"),
            [x, y] => format!("x in {x}, y in {y}"),
        };
        let right = (left + self.frame.width).max(MARGIN + width(&text, 12.0));
        svg.text([right, top + h + 35.0], Align::End, &words, &text);
    }
}

/// A document with its ground.
pub(super) fn document([w, h]: [f64; 2], title: &str, theme: Theme) -> Svg {
    let mut svg = Svg::blank([w, h], title, &theme.fill(Tone::Ink));
    let style = theme.style();
    if !style.is_empty() {
        svg.raw(&style);
    }
    svg.rect([0.0, 0.0], [w.ceil(), h.ceil()], &theme.fill(Tone::Ground));
    svg
}

/// A window at (`left`, `top`) beyond whose edges nothing is seen of what is `inside`.
pub(super) fn window(svg: &mut Svg, [left, top]: [f64; 2], frame: Frame, inside: Svg) {
    let [x, y, w, h] = [left, top, frame.width, frame.height].map(px);
    svg.open("svg", &format!("x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" overflow=\"hidden\""));
    svg.add(inside);
    svg.close("svg");
}
