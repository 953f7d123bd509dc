//! The colours of a picture, on light and on dark ground.

use std::fmt::Write;

/// Which ground a picture has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// Light, and dark where the reader's system asks for that. As PNG it is light.
    #[default]
    Reader,
    /// Light.
    Light,
    /// Dark.
    Dark,
}

/// What a colour is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Tone {
    /// The ground.
    Ground,
    /// The rope, and words.
    Ink,
    /// Rays, and words that explain.
    Muted,
    /// Frames.
    Line,
    Wall,
    /// Turns whose wall end lies on the left of the rope.
    Left,
    /// Turns whose wall end lies on the right.
    Right,
    /// One of several traces, counted from 0. One alone is the first.
    Trace(usize),
}

/// How many traces have a colour of their own.
pub(super) const TRACES: usize = 6;

/// Where the tones of traces begin among all.
const NAMES: [&str; 7 + TRACES] =
    ["ground", "ink", "muted", "line", "wall", "left", "right", "t0", "t1", "t2", "t3", "t4", "t5"];

/// For light and for dark ground. Hues by M. Okabe and K. Ito, "Color Universal Design" (2008); lighter on dark.
const COLOURS: [[&str; 2]; 7 + TRACES] = [
    ["#fff", "#161616"],
    ["#222", "#f0f0f0"],
    ["#666", "#a8a8a8"],
    ["#ccc", "#4a4a4a"],
    ["#777", "#8c8c8c"],
    ["#0072b2", "#56b4e9"],
    ["#d55e00", "#f58a3c"],
    ["#009e73", "#2fc496"],
    ["#cc79a7", "#e39cc3"],
    ["#0072b2", "#56b4e9"],
    ["#d55e00", "#f58a3c"],
    ["#b58900", "#e6b422"],
    ["#6a51a3", "#a58fdc"],
];

impl Tone {
    fn number(self) -> usize {
        match self {
            Tone::Ground => 0,
            Tone::Ink => 1,
            Tone::Muted => 2,
            Tone::Line => 3,
            Tone::Wall => 4,
            Tone::Left => 5,
            Tone::Right => 6,
            Tone::Trace(i) => 7 + i % TRACES,
        }
    }
}

impl Theme {
    fn colour(self, tone: Tone) -> &'static str {
        COLOURS[tone.number()][usize::from(self == Theme::Dark)]
    }

    /// The attributes of what is filled, or has a line, or both.
    ///
    /// The colours stand in attributes, which everything reads that reads SVG. Classes change them where a reader's
    /// style applies.
    fn attributes(self, parts: &[(&str, char, Tone)]) -> String {
        let mut out = String::new();
        if self == Theme::Reader {
            let names: Vec<String> =
                parts.iter().map(|&(_, c, tone)| format!("{c}-{}", NAMES[tone.number()])).collect();
            let _ = write!(out, "class=\"{}\" ", names.join(" "));
        }
        let colours: Vec<String> =
            parts.iter().map(|&(what, _, tone)| format!("{what}=\"{}\"", self.colour(tone))).collect();
        out + &colours.join(" ")
    }

    /// Something that is filled and has no line.
    pub(super) fn fill(self, tone: Tone) -> String {
        self.attributes(&[("fill", 'f', tone)])
    }

    /// A line.
    pub(super) fn stroke(self, tone: Tone) -> String {
        self.attributes(&[("stroke", 's', tone)])
    }

    /// Something that is filled and has a line round it.
    pub(super) fn both(self, fill: Tone, stroke: Tone) -> String {
        self.attributes(&[("fill", 'f', fill), ("stroke", 's', stroke)])
    }

    /// The style sheet that belongs to the attributes: what is different in the dark.
    pub(super) fn style(self) -> String {
        if self != Theme::Reader {
            return String::new();
        }
        let mut out = String::from("<style>@media (prefers-color-scheme: dark) {\n");
        for (name, [_, dark]) in NAMES.iter().zip(COLOURS) {
            let _ = writeln!(out, ".f-{name} {{ fill: {dark} }} .s-{name} {{ stroke: {dark} }}");
        }
        out + "}</style>"
    }

    /// How a page declares it to the browser.
    pub(super) fn scheme(self) -> &'static str {
        match self {
            Theme::Reader => "light dark",
            Theme::Light => "light",
            Theme::Dark => "dark",
        }
    }
}
