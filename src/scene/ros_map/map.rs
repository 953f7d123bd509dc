//! The file of a map, which says how its image is to be read.

use glam::DVec2;

use super::yaml::values;
use crate::read_error::{Fault, Place};

/// What the file says of its image.
#[derive(Debug, PartialEq)]
pub(super) struct Map {
    pub(super) image: String,
    /// Metres a pixel.
    pub(super) resolution: f64,
    /// Where the lower left corner of the image is, in metres.
    pub(super) origin: DVec2,
    /// By how much the image is turned about it, in radians.
    pub(super) yaw: f64,
    pub(super) negate: bool,
    pub(super) occupied: f64,
    pub(super) free: f64,
    pub(super) mode: Mode,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Trinary,
    Scale,
    Raw,
}

/// Reads the file.
pub(super) fn parse(text: &str) -> Result<Map, Fault> {
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
    let right = "0 or 1, yes or no, true or false";
    let negate = match get("negate")?.text("negate", right)? {
        "0" => false,
        "1" => true,
        word => match truth(word) {
            Some(truth) => truth,
            None => return Err(get("negate")?.fault("negate", right)),
        },
    };
    let mode = match values.iter().find(|(k, _)| k == "mode") {
        None => Mode::Trinary,
        Some((_, value)) => match value.text("mode", MODES)?.to_ascii_lowercase().as_str() {
            "trinary" => Mode::Trinary,
            "scale" => Mode::Scale,
            "raw" => Mode::Raw,
            _ => return Err(value.fault("mode", MODES)),
        },
    };
    let (occupied, free) = (chance("occupied_thresh")?, chance("free_thresh")?);
    Ok(Map { image, resolution, origin: DVec2::new(x, y), yaw, negate, occupied, free, mode })
}

/// The words of YAML 1.1 for a truth value, in small letters, in capitals, or with one capital in front.
fn truth(word: &str) -> Option<bool> {
    let small = word.to_ascii_lowercase();
    let capital = |(i, b): (usize, u8)| if i == 0 { b.to_ascii_uppercase() } else { b };
    let spellings = [
        small.clone().into_bytes(),
        small.to_ascii_uppercase().into_bytes(),
        small.bytes().enumerate().map(capital).collect(),
    ];
    match small.as_str() {
        _ if !spellings.iter().any(|s| s == word.as_bytes()) => None,
        "y" | "yes" | "true" | "on" => Some(true),
        "n" | "no" | "false" | "off" => Some(false),
        _ => None,
    }
}

const KEYS: [&str; 6] = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"];
const METRES: &str = "a number of metres a pixel, above 0";
const MODES: &str = "trinary, scale or raw";
