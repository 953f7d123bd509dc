//! Maps of ROS's `map_server`: the borders between occupied and other cells are the walls.

use std::path::Path;

use glam::DVec2;
use saphyr_parser::{Event, Parser, ScalarStyle};

use super::cells::borders;
use super::image::{self, Pixel};
use super::{Scene, Unknown, excerpt};
use crate::read_error::{Fault, Place, ReadError, read_text};

/// How many walls a map may have. Images as small as a few bytes can hold far more.
const WALLS_MAX: usize = 1 << 23;

/// What the file says of its image.
#[derive(Debug, PartialEq)]
struct Map {
    image: String,
    /// Metres a pixel.
    resolution: f64,
    /// Where the lower left corner of the image is, in metres.
    origin: DVec2,
    /// By how much the image is turned about it, in radians.
    yaw: f64,
    negate: bool,
    occupied: f64,
    free: f64,
    mode: Mode,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Trinary,
    Scale,
    Raw,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Occupied,
    Unknown,
    /// Free, or occupied by a chance that is not enough.
    Other,
}

/// Reads a map and the image that it names, relative to the map's own folder. Coordinates are metres in the map's frame,
/// y upwards. What lies around the image is no cell: its outer edge is no wall.
pub(super) fn read(path: &Path, unknown: Unknown) -> Result<Scene, ReadError> {
    let text = read_text(path)?;
    let map = parse(&text).map_err(|fault| fault.in_file(path))?;
    let image = path.parent().unwrap_or(Path::new("")).join(&map.image);
    let mut unknowns = 0;
    let bits = image::read(&image, |pixel| match map.cell(pixel) {
        Cell::Occupied => true,
        Cell::Unknown => {
            unknowns += 1;
            unknown == Unknown::Blocked
        }
        Cell::Other => false,
    })?;
    let (sin, cos) = libm::sincos(map.yaw);
    let turn = DVec2::new(cos, sin);
    let corner = |[x, y]: [usize; 2]| {
        let p = DVec2::new(x as f64, (bits.height - y) as f64) * map.resolution;
        // A map that is not turned has no roundings but those of its steps.
        map.origin + if map.yaw == 0.0 { p } else { turn.rotate(p) }
    };
    let blocked = |x, y| bits.get(x, y);
    let walls: Vec<_> = borders(bits.width, bits.height, &blocked).take(WALLS_MAX + 1).collect();
    if walls.len() > WALLS_MAX {
        let what = format!("more than {WALLS_MAX} walls; is this the image of a map?");
        return Err(Fault::new(Place::default(), what).in_file(&image));
    }
    let scene = Scene::new(walls.into_iter().map(|ends| ends.map(corner)));
    let mut scene = scene.map_err(|fault| Fault::from(fault).in_file(path))?;
    scene.note("a unit is 1 m; y points up");
    if unknowns > 0 {
        let (are, other) = match unknown {
            Unknown::Free => ("no obstacles", "blocked"),
            Unknown::Blocked => ("obstacles", "free"),
        };
        scene.note(format!("{unknowns} unknown cells are {are} (--unknown {other} for the other way)"));
    }
    Ok(scene)
}

impl Map {
    /// What `map_server` makes of a pixel.
    fn cell(&self, pixel: Pixel) -> Cell {
        let shade = match (pixel.alpha, self.mode) {
            // As it always did, it counts alpha among the colours here.
            (Some((alpha, colours)), Mode::Trinary) => (pixel.shade * colours + alpha) / (colours + 1.0),
            _ => pixel.shade,
        };
        if self.mode == Mode::Raw {
            return match (shade * 255.0).round() as u8 {
                100 => Cell::Occupied,
                101.. => Cell::Unknown,
                _ => Cell::Other,
            };
        }
        let chance = if self.negate { shade } else { 1.0 - shade };
        let seen_through = pixel.alpha.is_some_and(|(alpha, _)| alpha < 1.0);
        match self.mode {
            Mode::Scale if seen_through => Cell::Unknown,
            _ if chance > self.occupied => Cell::Occupied,
            Mode::Trinary if chance >= self.free => Cell::Unknown,
            _ => Cell::Other,
        }
    }
}

/// A value of the file, and its line.
struct Value {
    line: u64,
    items: Vec<String>,
    list: bool,
}

impl Value {
    fn fault(&self, key: &str, right: &str) -> Fault {
        let shown = if self.list { format!("[{}]", self.items.join(", ")) } else { self.items.concat() };
        Fault::new(Place::line(self.line), format!("{key} is {:?}; it must be {right}", excerpt(&shown)))
    }

    fn numbers<const N: usize>(&self, key: &str, right: &str) -> Result<[f64; N], Fault> {
        let numbers: Option<Vec<f64>> = self.items.iter().map(|item| item.parse().ok()).collect();
        let numbers = numbers.filter(|all| self.list == (N > 1) && all.iter().all(|n| n.is_finite()));
        numbers.and_then(|all| all.try_into().ok()).ok_or_else(|| self.fault(key, right))
    }

    fn text(&self, key: &str, right: &str) -> Result<&str, Fault> {
        match &self.items[..] {
            [text] if !self.list && !text.is_empty() => Ok(text),
            _ => Err(self.fault(key, right)),
        }
    }
}

fn parse(text: &str) -> Result<Map, Fault> {
    let values = values(text)?;
    let get = |key: &str| {
        let value = values.iter().find(|(k, _)| k == key).map(|(_, value)| value);
        value.ok_or_else(|| Fault::new(Place::default(), format!("no {key}; a map needs {}", KEYS.join(", "))))
    };
    let chance = |key: &str| {
        let right = "a number from 0 to 1";
        let value = get(key)?;
        let [chance] = value.numbers(key, right)?;
        if (0.0..=1.0).contains(&chance) { Ok(chance) } else { Err(value.fault(key, right)) }
    };
    let image = get("image")?.text("image", "the name of a .png or .pgm file")?.to_owned();
    let [resolution] = get("resolution")?.numbers("resolution", METRES)?;
    if resolution <= 0.0 {
        return Err(get("resolution")?.fault("resolution", METRES));
    }
    let [x, y, yaw] = get("origin")?.numbers("origin", "three numbers, [x, y, yaw]")?;
    let right = "0 or 1";
    let negate = match get("negate")?.text("negate", right)? {
        "0" | "false" | "False" => false,
        "1" | "true" | "True" => true,
        _ => return Err(get("negate")?.fault("negate", right)),
    };
    let mode = match values.iter().find(|(k, _)| k == "mode") {
        None => Mode::Trinary,
        Some((_, value)) => match value.text("mode", MODES)? {
            "trinary" => Mode::Trinary,
            "scale" => Mode::Scale,
            "raw" => Mode::Raw,
            _ => return Err(value.fault("mode", MODES)),
        },
    };
    let (occupied, free) = (chance("occupied_thresh")?, chance("free_thresh")?);
    Ok(Map { image, resolution, origin: DVec2::new(x, y), yaw, negate, occupied, free, mode })
}

const KEYS: [&str; 6] = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"];
const METRES: &str = "a number of metres a pixel, above 0";
const MODES: &str = "trinary, scale or raw";

/// The values of all keys that a map has; others, with whatever is in them, are passed over.
fn values(text: &str) -> Result<Vec<(String, Value)>, Fault> {
    let mut values: Vec<(String, Value)> = Vec::new();
    let mut depth = 0;
    let mut key: Option<String> = None;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| {
            let place = Place::line(e.marker().line() as u64).then("column", e.marker().col() as u64 + 1);
            Fault::new(place, format!("not YAML: {}", e.info()))
        })?;
        let line = span.start.line() as u64;
        let fault = |what: &str| Err(Fault::new(Place::line(line), what));
        match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                let list = matches!(event, Event::SequenceStart(..));
                if depth == 0 && list {
                    return fault("a list; a map is written as lines of a key and its value, such as resolution: 0.05");
                }
                if depth == 1 {
                    let key = key.clone().unwrap_or_default();
                    push(&mut values, key, Value { line, items: Vec::new(), list })?;
                }
                depth += 1;
            }
            Event::MappingEnd | Event::SequenceEnd => {
                depth -= 1;
                if depth == 1 {
                    key = None;
                }
            }
            Event::Scalar(scalar, style, ..) => match (depth, key.take()) {
                (0, _) => {
                    return fault("no map; a map is written as lines of a key and its value, such as resolution: 0.05");
                }
                (1, None) => key = Some(scalar.into_owned()),
                (1, Some(key)) => {
                    let empty = style == ScalarStyle::Plain && scalar == "~";
                    let items = vec![if empty { String::new() } else { scalar.into_owned() }];
                    push(&mut values, key, Value { line, items, list: false })?;
                }
                (_, of) => {
                    key = of;
                    if let (2, Some((_, value))) = (depth, values.last_mut()) {
                        value.items.push(scalar.into_owned());
                    }
                }
            },
            Event::Alias(_) => return fault("an alias (*); write the value out"),
            _ => {}
        }
    }
    Ok(values)
}

fn push(values: &mut Vec<(String, Value)>, key: String, value: Value) -> Result<(), Fault> {
    if values.iter().any(|(k, _)| *k == key) {
        return Err(Fault::new(Place::line(value.line), format!("{key} a second time")));
    }
    values.push((key, value));
    Ok(())
}
