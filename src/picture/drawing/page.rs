//! A page that plays a trace, with a slider.

use std::ops::RangeInclusive;

use glam::DVec2;
use serde_json::{Value, json};

use super::animation::near;
use super::canvas::Canvas;
use super::film::{Film, most_contacts};
use super::key::{Entry, Key};
use super::marks::DASHES;
use super::rope::{RopeStyle, Shape};
use super::still::Plot;
use super::theme::{Theme, Tone};
use super::trace::TraceStyle;
use super::{Dragged, DrawError, Drawing};
use crate::picture::label::count;
use crate::picture::svg::{Svg, escape};

const STYLE: &str = include_str!("player.css");
const SCRIPT: &str = include_str!("player.js");

/// The most moments of a film, and the most corners of all its ropes together.
const MOMENTS: usize = 20_000;
const CORNERS: usize = 400_000;

impl Drawing<'_> {
    /// A page that plays the one trace of this drawing in a browser, with a button and a slider; with no trace or
    /// several, or where the anchor moves, a page that shows [`svg`](Self::svg). It needs no other file and no network.
    ///
    /// It begins at the moment after [`at_step`](Self::at_step), and by itself if there is none. Without scripts it
    /// shows the picture of that moment.
    ///
    /// # Errors
    ///
    /// Those of [`svg`](Self::svg).
    pub fn page(&self) -> Result<String, DrawError> {
        match self.dragged.as_slice() {
            [one] if one.both.is_none() => self.player(one),
            _ => Ok(page(self.theme, "Ropes", &figure(&self.svg()?))),
        }
    }

    /// A page that shows the [filmstrip](Self::frames).
    ///
    /// # Errors
    ///
    /// Those of [`frames`](Self::frames).
    pub fn frames_page(&self, events: Option<RangeInclusive<usize>>) -> Result<String, DrawError> {
        Ok(page(self.theme, "Events", &figure(&self.frames(events)?)))
    }

    fn player(&self, dragged: &Dragged<'_>) -> Result<String, DrawError> {
        let moment = self.moment(dragged)?;
        let film = self.film(dragged, (CORNERS / (most_contacts(dragged) + 1)).min(MOMENTS));
        let plot = Plot::new(self.view(2.5)?, self.scene);
        let (mut inside, mut key) = (Svg::part(), Key::default());
        let mut canvas = Canvas { svg: &mut inside, frame: plot.frame, theme: self.theme, key: &mut key };
        canvas.walls(self.scene);
        let anchor = self.anchor.unwrap_or_default();
        let end = dragged.points[dragged.points.len() - 1];
        canvas.trace(&dragged.points, dragged.points.len(), end, &TraceStyle { tone: Tone::Trace(0), points: false });
        canvas.svg.open("g", "id=\"still\"");
        let turns = [Tone::Left, Tone::Right];
        canvas.rope(&Shape::new(anchor, &moment), &RopeStyle { tone: Tone::Ink, turns, numbers: false });
        canvas.free_end(moment.at, anchor, Tone::Ink);
        canvas.svg.close("g");
        for c in film.ropes.iter().flatten().filter(|c| c.turns) {
            canvas.key.add(if c.left { Entry::TurnLeft } else { Entry::TurnRight });
        }
        canvas.key.add(Entry::Rope);
        canvas.key.add(Entry::FreeEnd);
        canvas.moving();
        canvas.anchor(anchor);
        let data = self.data(dragged, &film, &plot, anchor);
        let id = dragged.record.trace;
        let svg = plot.finish(self.theme, &[], inside, &key);
        // In a script `<` could end the element.
        let data = data.to_string().replace('<', "\\u003c");
        let body = format!(
            "<h1>Trace {id}</h1>\n\
             <div class=\"player\" hidden>\n<button type=\"button\" id=\"play\">Play</button>\n\
             <input type=\"range\" id=\"time\" step=\"any\" aria-label=\"time in steps\">\n</div>\n\
             <p><output id=\"state\" for=\"time\"></output></p>\n{}\
             <script type=\"application/json\" id=\"film\">{data}</script>\n<script>\n{SCRIPT}</script>\n",
            figure(&svg)
        );
        Ok(page(self.theme, &format!("Trace {id}"), &body))
    }

    /// What the script plays, in pixels of the window.
    fn data(&self, dragged: &Dragged<'_>, film: &Film, plot: &Plot, anchor: DVec2) -> Value {
        let pixel = |p: DVec2| near(plot.frame.at(p)).map(|x| (x * 100.0).round() / 100.0);
        let corner = |c: &super::film::Corner| {
            let [x, y] = pixel(c.at);
            json!([x, y, u8::from(c.turns) * if c.left { 1 } else { 2 }])
        };
        let state = |s: &super::film::State| {
            let [x, y] = pixel(s.at);
            json!([s.time, x, y, s.rope, s.length])
        };
        json!({
            "anchor": pixel(anchor),
            "steps": dragged.points.len() - 1,
            "stepsText": count(dragged.points.len() as u64 - 1),
            "start": self.step,
            "states": film.states.iter().map(state).collect::<Vec<_>>(),
            "ropes": film.ropes.iter().map(|r| r.iter().map(corner).collect()).collect::<Vec<Vec<Value>>>(),
        })
    }
}

impl Canvas<'_> {
    /// What the script moves; nothing is seen of it before.
    fn moving(&mut self) {
        self.svg.open("g", "id=\"moving\" visibility=\"hidden\"");
        let halo = self.theme.stroke(Tone::Ground);
        self.svg.raw(&format!(
            "<polyline id=\"halo\" fill=\"none\" {halo} stroke-opacity=\".5\" stroke-width=\"4.5\"/>\n\
             <polyline id=\"rope\" fill=\"none\" {} {DASHES}/>\n<path id=\"left\" {}/>\n<path id=\"right\" {}/>\n\
             <circle id=\"free\" r=\"4.6\" {} stroke-width=\"2\"/>",
            self.theme.stroke(Tone::Ink),
            self.theme.both(Tone::Left, Tone::Ground),
            self.theme.both(Tone::Right, Tone::Ground),
            self.theme.both(Tone::Ground, Tone::Ink)
        ));
        self.svg.close("g");
    }
}

fn figure(svg: &str) -> String {
    // Within HTML an SVG needs no name space.
    format!("<figure>\n{}</figure>\n", svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1))
}

fn page(theme: Theme, title: &str, body: &str) -> String {
    let (title, scheme) = (escape(title), theme.scheme());
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n:root {{ color-scheme: {scheme}; }}\n{STYLE}</style>\n</head>\n\
         <body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}
