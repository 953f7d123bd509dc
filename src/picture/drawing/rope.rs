//! A rope in a picture: dashed from the anchor to the free end, its turns marked and numbered.

use std::collections::HashMap;

use glam::DVec2;

use super::canvas::{Canvas, distance};
use super::key::Entry;
use super::marks::{DASHES, straight_mark, turn_mark};
use super::theme::Tone;
use crate::picture::label::width;
use crate::picture::ropes::{beside, towards};
use crate::picture::svg::Align;
use crate::rope::{Contact, Moment, Side};

/// Beyond this many turns the marks are smaller.
const MANY: usize = 40;

/// A contact that is passed straight so near to another mark has none, in pixels.
const CROWDED: f64 = 6.0;

/// The size of the letters that number turns.
const LETTERS: f64 = 10.5;

/// A rope as it is drawn.
pub(super) struct Shape {
    anchor: DVec2,
    turns: Vec<Contact>,
    straight: Vec<Contact>,
    a: DVec2,
}

impl Shape {
    /// The rope at a moment: at the end of a step the taut one, and in the middle of it the one that goes on from
    /// there.
    pub(super) fn new(anchor: DVec2, moment: &Moment) -> Self {
        let turns = if moment.event.is_some() { moment.turns() } else { moment.rope.taut(moment.at) };
        // The turns are some of the contacts, in the same order.
        let mut rest = turns.as_slice();
        let mut straight = Vec::new();
        for contact in moment.rope.contacts() {
            match rest {
                [first, others @ ..] if first == contact => rest = others,
                _ if contact.at == moment.at => {}
                _ => straight.push(*contact),
            }
        }
        Shape { anchor, turns, straight, a: moment.at }
    }
}

/// How a rope is drawn.
pub(super) struct RopeStyle {
    pub(super) tone: Tone,
    /// The tones of turns on the left and on the right.
    pub(super) turns: [Tone; 2],
    pub(super) numbers: bool,
}

impl Canvas<'_> {
    /// The rope without its ends' marks.
    pub(super) fn rope(&mut self, shape: &Shape, style: &RopeStyle) {
        let corners = shape.turns.iter().map(|c| c.at);
        let line: Vec<[f64; 2]> =
            std::iter::once(shape.anchor).chain(corners).chain([shape.a]).map(|p| self.at(p)).collect();
        let data = self.line(&line);
        if !data.is_empty() && shape.anchor.distance(shape.a) + shape.turns.len() as f64 > 0.0 {
            self.key.add(Entry::Rope);
            let halo = self.theme.stroke(Tone::Ground);
            self.svg.path(&data, &format!("fill=\"none\" {halo} stroke-opacity=\".5\" stroke-width=\"4.5\""));
            self.svg.path(&data, &format!("fill=\"none\" {} {DASHES}", self.theme.stroke(style.tone)));
        }
        let size = if shape.turns.len() > MANY { 0.65 } else { 1.0 };
        let mut places: Vec<[f64; 2]> = shape.turns.iter().map(|c| self.at(c.at)).collect();
        for contact in &shape.straight {
            let at = self.at(contact.at);
            if self.shows(at) && places.iter().all(|&p| distance(p, at) > CROWDED) {
                self.key.add(Entry::Straight);
                straight_mark(self.svg, self.theme, at);
                places.push(at);
            }
        }
        // A wall end that is touched several times on one side is marked once.
        let mut marked = HashMap::new();
        for contact in &shape.turns {
            let left = contact.side.shown(self.frame.mirrored()) == Side::Left;
            let at = self.at(contact.at);
            if self.shows(at) && marked.insert((contact.vertex, left), ()).is_none() {
                self.key.add(if left { Entry::TurnLeft } else { Entry::TurnRight });
                turn_mark(self.svg, self.theme, at, left, size, style.turns[usize::from(!left)]);
            }
        }
        if style.numbers {
            self.numbers(shape, &line);
        }
    }

    /// Numbers the turns from the anchor on, where there is room: turns without a number follow along the rope.
    fn numbers(&mut self, shape: &Shape, line: &[[f64; 2]]) {
        let mut order: Vec<(u32, Vec<usize>)> = Vec::new();
        let mut places: HashMap<u32, usize> = HashMap::new();
        for (i, contact) in shape.turns.iter().enumerate() {
            let place = *places.entry(contact.vertex).or_insert(order.len());
            if place == order.len() {
                order.push((contact.vertex, Vec::new()));
            }
            order[place].1.push(i);
        }
        let mark = |[x, y]: [f64; 2], r: f64| Box { low: [x - r, y - r], high: [x + r, y + r] };
        let mut taken: Vec<Box> = line.iter().map(|&p| mark(p, 3.0)).collect();
        taken.extend([mark(line[0], 5.0), mark(line[line.len() - 1], 5.0)]);
        for (_, turns) in &order {
            let first = turns[0];
            if !self.shows(line[first + 1]) {
                continue;
            }
            let text = numbers(turns);
            let left = shape.turns[first].side.shown(self.frame.mirrored()) == Side::Left;
            let away = beside(line[first], line[first + 1], line.get(first + 2).copied(), left);
            let Some(place) = self.room(line[first + 1], away, width(&text, LETTERS), &taken) else { continue };
            let middle = [(place.low[0] + place.high[0]) / 2.0, place.high[1] - 1.5];
            let outlined = format!(
                "font-size=\"{LETTERS}\" {} stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                self.theme.both(Tone::Ink, Tone::Ground)
            );
            self.svg.text(middle, Align::Middle, &outlined, &text);
            taken.push(place);
        }
    }

    /// Room for words that are that wide near `at`: in the direction of `away` if that is free, else as near to it as
    /// can be.
    fn room(&self, at: [f64; 2], away: [f64; 2], wide: f64, taken: &[Box]) -> Option<Box> {
        let [x, y] = towards(at, away);
        let turned = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [x * cos - y * sin, x * sin + y * cos]
        };
        let half = [wide / 2.0, LETTERS / 2.0];
        [0.0, 40.0, -40.0, 80.0, -80.0].into_iter().map(turned).find_map(|[x, y]| {
            let far = 5.5 + (x.abs() * half[0]).max(y.abs() * half[1]);
            let (cx, cy) = (at[0] + x * far, at[1] + y * far);
            let cx = cx.clamp(half[0] + 2.0, (self.frame.width - half[0] - 2.0).max(half[0] + 2.0));
            let cy = cy.clamp(half[1] + 2.0, (self.frame.height - half[1] - 2.0).max(half[1] + 2.0));
            let place = Box { low: [cx - half[0], cy - half[1]], high: [cx + half[0], cy + half[1]] };
            taken.iter().all(|t| !place.meets(t)).then_some(place)
        })
    }
}

/// What is taken by a mark or a word, in pixels.
struct Box {
    low: [f64; 2],
    high: [f64; 2],
}

impl Box {
    fn meets(&self, other: &Box) -> bool {
        (0..2).all(|i| self.low[i] < other.high[i] && other.low[i] < self.high[i])
    }
}

/// The numbers of a wall end's turns, counted from 1, with what is between the first and the last of very many left
/// out.
fn numbers(turns: &[usize]) -> String {
    let text = |i: &usize| (i + 1).to_string();
    match turns {
        [first, second, .., last] if turns.len() > 4 => format!("{}, {} … {}", text(first), text(second), text(last)),
        _ => turns.iter().map(text).collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_one_wall_end_are_listed() {
        assert_eq!(numbers(&[0]), "1");
        assert_eq!(numbers(&[0, 4, 8]), "1, 5, 9");
        assert_eq!(numbers(&[1, 5, 9, 13, 17]), "2, 6 … 18");
    }
}
