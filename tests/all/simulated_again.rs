//! Walks simulated again by what docs/studies.md says alone, with its numbers read from there, and compared with what
//! the program draws, bit for bit. Nothing of the library is used.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;

use crate::naive_rope::{NaiveRope, P, distance, orient};

/// The constants of the page, by their names.
struct Page(HashMap<String, f64>);

impl Page {
    fn read() -> Self {
        let text = include_str!("../../docs/studies.md");
        let start = text.find("| constant | value |").expect("the page has a table of constants");
        let rows = text[start..].lines().skip(2).take_while(|line| line.starts_with('|'));
        let row = |line: &str| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            (cells[0].to_owned(), cells[1].parse().unwrap())
        };
        Page(rows.map(row).collect())
    }

    fn number(&self, name: &str) -> f64 {
        *self.0.get(name).unwrap_or_else(|| panic!("{name}: {:?}", self.0.keys()))
    }

    fn count(&self, name: &str) -> usize {
        self.number(name) as usize
    }
}

/// One stream of random words.
struct Stream {
    key: [u32; 2],
    purpose: u64,
    trace: u64,
    together: usize,
    block: u64,
    words: Vec<u32>,
}

impl Stream {
    fn new(page: &Page, seed: u64, purpose: &str, trace: u64) -> Self {
        let together = page.count("random blocks made together");
        let purpose = page.count(purpose) as u64;
        Stream { key: [seed as u32, (seed >> 32) as u32], purpose, trace, together, block: 0, words: vec![] }
    }

    fn word(&mut self) -> u32 {
        if self.words.is_empty() {
            let blocks: Vec<[u32; 4]> = (0..self.together as u64)
                .map(|k| {
                    let b = self.block + k;
                    let second = self.purpose + 256 * (b >> 32);
                    philox([b as u32, second as u32, self.trace as u32, (self.trace >> 32) as u32], self.key)
                })
                .collect();
            self.block += self.together as u64;
            // Taken from the end.
            self.words = (0..4).flat_map(|i| blocks.iter().map(move |block| block[i])).rev().collect();
        }
        self.words.pop().unwrap()
    }

    fn either_way(&mut self) -> f64 {
        (f64::from(self.word() as i32) + 0.5) / 2147483648.0
    }

    fn disc(&mut self) -> (f64, f64, f64) {
        loop {
            let x = self.either_way();
            let y = self.either_way();
            let s = x * x + y * y;
            if s < 1.0 {
                return (x, y, s);
            }
        }
    }

    fn direction(&mut self) -> P {
        let (x, y, s) = self.disc();
        [(x * x - y * y) / s, 2.0 * x * y / s]
    }

    fn normal(&mut self) -> P {
        let (x, y, s) = self.disc();
        let r = (-2.0 * libm::log(s) / s).sqrt();
        [x * r, y * r]
    }
}

fn philox(mut c: [u32; 4], mut k: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let p = 0xD2511F53u64 * u64::from(c[0]);
        let q = 0xCD9E8D57u64 * u64::from(c[2]);
        c = [(q >> 32) as u32 ^ c[1] ^ k[0], q as u32, (p >> 32) as u32 ^ c[3] ^ k[1], p as u32];
        k = [k[0].wrapping_add(0x9E3779B9), k[1].wrapping_add(0xBB67AE85)];
    }
    c
}

/// The direction at an angle by the page's series.
fn series(angle: f64) -> P {
    let x = 0.25 * angle;
    let s = x * x;
    let c =
        1.0 + s * (-1.0 / 2.0 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40320.0 + s * (-1.0 / 3628800.0)))));
    let d = x + x * s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * (1.0 / 362880.0))));
    let (c, d) = (c * c - d * d, 2.0 * c * d);
    let (c, d) = (c * c - d * d, 2.0 * c * d);
    let n = 1.5 - 0.5 * (c * c + d * d);
    [c * n, d * n]
}

/// What draws the steps of one trace.
struct Walk<'a> {
    page: &'a Page,
    kind: &'a str,
    step: f64,
    turn: f64,
    random: Stream,
    heading: P,
    turned: P,
    before: f64,
    spread: f64,
    ahead: Vec<P>,
}

impl Walk<'_> {
    fn along(&mut self, t: P) -> P {
        let [hx, hy] = self.heading;
        let f = 1.25 - 0.25 * self.before;
        self.turned = [(t[0] * hx - t[1] * hy) * f, (t[1] * hx + t[0] * hy) * f];
        [self.step * self.turned[0], self.step * self.turned[1]]
    }

    fn draw(&mut self) -> P {
        match self.kind {
            "uniform" => self.random.direction().map(|c| self.step * c),
            "gaussian" => self.random.normal().map(|c| self.step * c),
            _ => {
                if self.ahead.is_empty() {
                    let count = self.page.count("turns drawn together");
                    let angles: Vec<f64> = (0..count).map(|_| self.turn * self.random.either_way()).collect();
                    self.ahead = angles.into_iter().map(series).rev().collect();
                }
                self.spread = self.turn;
                let turn = self.ahead.pop().unwrap();
                self.along(turn)
            }
        }
    }

    fn draw_again(&mut self) -> P {
        if self.kind != "persistent" {
            return self.draw();
        }
        let least = self.page.number("least turn once drawn again");
        self.spread = (self.spread.max(least) * self.page.number("widening of the turn")).min(PI);
        let turn = series(self.spread * self.random.either_way());
        self.along(turn)
    }

    fn take(&mut self) {
        let [x, y] = self.heading;
        self.before = x * x + y * y;
        self.heading = self.turned;
    }
}

fn is_same_side(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

/// The walls, and the box round them and the anchor.
struct Room {
    walls: Vec<[P; 2]>,
    low: P,
    high: P,
}

impl Room {
    fn is_open(&self, a: P, b: P) -> bool {
        let is_inside = (0..2).all(|i| self.low[i] <= b[i] && b[i] <= self.high[i]);
        is_inside && !self.walls.iter().any(|&[u, v]| touches(u, v, a, b))
    }

    /// Where a step ends that is thrown back, if anywhere.
    fn reflect(&self, page: &Page, walk: &mut Walk<'_>, here: P, next: P) -> Option<P> {
        let (mut from, mut to, mut last) = (here, next, None);
        for _ in 0..page.count("looks for a mirror") {
            let Some((share, [ax, ay], mirror)) = self.first_met(from, to, last) else {
                return self.is_open(here, to).then_some(to);
            };
            let d = 2.0 * (walk.turned[0] * ax + walk.turned[1] * ay);
            walk.turned = [walk.turned[0] - d * ax, walk.turned[1] - d * ay];
            from = [0, 1].map(|i| from[i] * (1.0 - share) + to[i] * share);
            let d = 2.0 * ((to[0] - from[0]) * ax + (to[1] - from[1]) * ay);
            to = [to[0] - d * ax, to[1] - d * ay];
            last = Some(mirror);
        }
        None
    }

    fn first_met(&self, from: P, to: P, last: Option<usize>) -> Option<(f64, P, usize)> {
        let mut met: Vec<(f64, P, usize)> = vec![];
        for i in 0..2 {
            let across = if i == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
            for (side, is_beyond, name) in
                [(self.low[i], to[i] < self.low[i], 2 * i), (self.high[i], to[i] > self.high[i], 2 * i + 1)]
            {
                if is_beyond {
                    met.push((((side - from[i]) / (to[i] - from[i])).clamp(0.0, 1.0), across, name));
                }
            }
        }
        for (number, &[u, v]) in self.walls.iter().enumerate() {
            let (before, after) = (orient(u, v, from), orient(u, v, to));
            if before != 0.0 && !is_same_side(before, after) && !is_same_side(orient(from, to, u), orient(from, to, v))
            {
                let share = if after == 0.0 { 1.0 } else { before / (before - after) };
                let (x, y) = (-(v[1] - u[1]), v[0] - u[0]);
                let one = 1.0 / (x * x + y * y).sqrt();
                met.push((share, [x * one, y * one], 4 + number));
            }
        }
        met.into_iter().filter(|m| Some(m.2) != last).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Whether the step from `a` to `b` touches the wall. One that ends where the step starts is only touched along it.
fn touches(u: P, v: P, a: P, b: P) -> bool {
    if a == u || a == v {
        let end = if a == u { v } else { u };
        let is_ahead = (end[0] - a[0]) * (b[0] - a[0]) + (end[1] - a[1]) * (b[1] - a[1]) > 0.0;
        return orient(a, end, b) == 0.0 && is_ahead;
    }
    let is_near = (0..2).all(|i| a[i].min(b[i]) <= u[i].max(v[i]) && u[i].min(v[i]) <= a[i].max(b[i]));
    is_near && !is_same_side(orient(u, v, a), orient(u, v, b)) && !is_same_side(orient(a, b, u), orient(a, b, v))
}

/// A tether, and the rope that it is.
struct Tether<'a> {
    length: f64,
    at: &'a str,
    rope: NaiveRope,
    /// Of walls.
    ends: Vec<P>,
}

impl Tether<'_> {
    /// Has the free end go from `here` to `to` if the rope is no longer than the tether there.
    fn goes(&mut self, here: P, to: P) -> bool {
        let moved = self.rope.moved(here, to, &self.ends);
        let goes = to == here || moved.length(to) <= self.length;
        if goes && to != here {
            self.rope = moved;
        }
        goes
    }

    /// Where a step ends that would lead too far, to `to`.
    fn held_back(&mut self, page: &Page, room: &Room, walk: &mut Walk<'_>, here: P, to: P) -> P {
        match self.at {
            "stay" => {
                walk.draw_again();
                walk.take();
            }
            "turn" => {
                for _ in 0..page.count("draws of a step that meets a wall") {
                    let step = walk.draw_again();
                    let next = [here[0] + step[0], here[1] + step[1]];
                    if room.is_open(here, next) && self.goes(here, next) {
                        walk.take();
                        return next;
                    }
                }
            }
            _ => {
                let rope = self.rope.moved(here, to, &self.ends);
                let (mut c, mut q, mut before) = (to, rope.anchor(), 0.0);
                for next in rope.turns().chain([to]) {
                    (c, q) = (q, next);
                    if before + distance(c, q) > self.length {
                        break;
                    }
                    before += distance(c, q);
                }
                let sizes = [self.length, c[0], c[1], q[0], q[1]];
                let e = sizes.iter().fold(0.0, |most: f64, x| most.max(x.abs())) / 2f64.powi(52);
                for less in 0..=page.count("slides drawn in") as i32 {
                    let less = if less == 0 { 0.0 } else { e * 2f64.powi(less - 1) };
                    let share = (self.length - before - less).max(0.0) / distance(c, q);
                    let next = [0, 1].map(|i| c[i] + (q[i] - c[i]) * share);
                    if !room.is_open(here, next) {
                        break;
                    }
                    if self.goes(here, next) {
                        return next;
                    }
                }
            }
        }
        here
    }
}

/// The points of a trace, how many steps met a wall, and how many the tether held back.
fn simulated(
    page: &Page,
    room: &Room,
    anchor: P,
    walk: &mut Walk<'_>,
    (at_walls, mut tether): (&str, Option<Tether<'_>>),
    steps: usize,
) -> (Vec<P>, usize, usize) {
    let (mut points, mut here, mut met, mut held) = (vec![anchor], anchor, 0, 0);
    for _ in 0..steps {
        let step = walk.draw();
        let next = [here[0] + step[0], here[1] + step[1]];
        if room.is_open(here, next) {
            let goes = tether.as_mut().is_none_or(|tether| tether.goes(here, next));
            if goes || tether.as_ref().is_some_and(|tether| tether.at == "slide") {
                walk.take();
            }
            here = match &mut tether {
                Some(tether) if !goes => {
                    held += 1;
                    tether.held_back(page, room, walk, here, next)
                }
                _ => next,
            };
            points.push(here);
            continue;
        }
        met += 1;
        let before = here;
        match at_walls {
            "redraw" => {
                for _ in 0..page.count("draws of a step that meets a wall") {
                    let step = walk.draw_again();
                    let next = [here[0] + step[0], here[1] + step[1]];
                    if room.is_open(here, next) {
                        walk.take();
                        here = next;
                        break;
                    }
                }
            }
            "reject" => {
                walk.draw_again();
                walk.take();
            }
            _ => {
                let thrown = room.reflect(page, walk, here, next);
                walk.take();
                here = thrown.unwrap_or(here);
            }
        }
        if let Some(tether) = &mut tether
            && !tether.goes(before, here)
        {
            held += 1;
            here = tether.held_back(page, room, walk, before, here);
        }
        points.push(here);
    }
    (points, met, held)
}

#[test]
fn walks_are_simulated_again_by_the_page_alone() {
    let page = Page::read();
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &str| {
        let output = Command::new(cargo_bin!("tautline"))
            .current_dir(folder.path())
            .args(args.split_whitespace())
            .output()
            .unwrap();
        assert!(output.status.success(), "{args}: {}", String::from_utf8_lossy(&output.stderr));
    };
    // Two rooms with slanted walls, a door, and a pillar, in steps that are long in them.
    let lines = ["0 0, 9 0, 9 6, 0 6, 0 0", "4 0, 4.5 2.5", "4.25 4, 3.75 6", "6 2, 7 2, 7 3, 6 3, 6 2", "1 1, 2.5 2"];
    let text: String = lines.iter().map(|line| format!("LINESTRING ({line})\n")).collect();
    std::fs::write(folder.path().join("s.wkt"), text + "POINT (2 3.5)\n").unwrap();
    let walls: Vec<[P; 2]> = lines
        .iter()
        .flat_map(|line| {
            let ends: Vec<P> = line
                .split(", ")
                .map(|p| {
                    let c: Vec<f64> = p.split(' ').map(|c| c.parse().unwrap()).collect();
                    [c[0], c[1]]
                })
                .collect();
            ends.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
        })
        .collect();
    let mut ends: Vec<P> = walls.iter().flatten().copied().collect();
    ends.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    ends.dedup();
    let room = Room { walls, low: [0.0, 0.0], high: [9.0, 6.0] };
    let (seed, step, steps, turn) = (0x1234_5678_9abc_def0_u64, 0.75, 400, 0.6);
    let (anchor, length) = ([2.0, 3.5], 4.5);
    let (mut all_met, mut all_held) = (0, 0);
    let tethers = [None, Some("stay"), Some("slide"), Some("turn")];
    for kind in ["uniform", "gaussian", "persistent"] {
        for (at_walls, at_tether) in ["redraw", "reject", "reflect"].into_iter().flat_map(|w| tethers.map(|t| (w, t))) {
            let turn_of = if kind == "persistent" { format!("turn = {turn}\n") } else { String::new() };
            let tether = at_tether.map_or(String::new(), |at| format!("tether = {length}\nat_tether = \"{at}\"\n"));
            let study = format!(
                "[scene]\nfile = \"s.wkt\"\n[walk]\nkind = \"{kind}\"\nstep = {step}\nsteps = {steps}\n{turn_of}\
                 at_walls = \"{at_walls}\"\n{tether}[run]\ntraces = 3\nseed = {seed}\n[outputs]\npictures = false\n"
            );
            std::fs::write(folder.path().join("s.toml"), study).unwrap();
            let out = format!("{kind}-{at_walls}-{}", at_tether.unwrap_or("free"));
            run(&format!("study run s.toml --out {out} --engine reference"));
            let mut held_in_all = 0;
            for trace in 0..3 {
                run(&format!("study replay {out} --trace {trace} --points p.csv"));
                let rows = std::fs::read_to_string(folder.path().join("p.csv")).unwrap();
                let row = |line: &str| {
                    let cells: Vec<&str> = line.split(',').collect();
                    assert_eq!(cells[0].parse::<u64>().unwrap(), trace);
                    [cells[1], cells[2]].map(|c| c.parse::<f64>().unwrap().to_bits())
                };
                let drawn: Vec<[u64; 2]> = rows.lines().skip(1).map(row).collect();
                let mut random = Stream::new(&page, seed, "stream of steps", trace);
                let heading = if kind == "persistent" { random.direction() } else { [1.0, 0.0] };
                let mut walk = Walk {
                    page: &page,
                    kind,
                    step,
                    turn,
                    random,
                    heading,
                    turned: heading,
                    before: 1.0,
                    spread: turn,
                    ahead: vec![],
                };
                let rope = NaiveRope::new(anchor);
                let tether = at_tether.map(|at| Tether { length, at, rope, ends: ends.clone() });
                let (points, met, held) = simulated(&page, &room, anchor, &mut walk, (at_walls, tether), steps);
                let points: Vec<[u64; 2]> = points.iter().map(|p| p.map(f64::to_bits)).collect();
                assert_eq!(points.len(), steps + 1);
                for (i, (ours, theirs)) in points.iter().zip(&drawn).enumerate() {
                    let shown = [ours, theirs].map(|p| p.map(f64::from_bits));
                    assert_eq!(ours, theirs, "{out}, trace {trace}, point {i}: {shown:?}");
                }
                assert_eq!(points.len(), drawn.len());
                assert!(met > if at_tether.is_none() { 20 } else { 5 }, "{out}: only {met} steps met a wall");
                all_met += met;
                held_in_all += held;
            }
            all_held += held_in_all;
            let summary = std::fs::read_to_string(folder.path().join(out).join("summary.json")).unwrap();
            let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
            let told = summary["tether"]["held_back"]["value"].as_f64();
            let told = told.map(|share| (share * (3 * steps) as f64).round() as usize);
            assert_eq!(told, at_tether.map(|_| held_in_all));
        }
    }
    assert!(all_met > 4000 && all_held > 2000, "{all_met} {all_held}");
}
