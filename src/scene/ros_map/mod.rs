//! Maps of ROS's `map_server`: the borders between occupied and other cells are the walls.

mod cell;
mod map;
mod yaml;

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::cells::{self, borders};
use super::format::SceneFormat;
use super::image;
use super::{Ros, Scene, Unknown};
use crate::read_error::{Fault, Place, ReadError};
use crate::read_file::{SETTINGS_MAX, read_text};
use cell::Cell;
use map::parse;

/// How many walls a map may have. Images as small as a few bytes can hold far more.
const WALLS_MAX: usize = 1 << 23;

/// Maps of ROS's `map_server`, with the image that they name.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".yaml", ".yml"],
    files: "a map_server's .yaml",
    anchor: "",
    read: |path, options| read(path, options.ros, options.unknown),
};

/// Reads a map and the image that it names, relative to the map's own folder. Coordinates are metres in the map's
/// frame, y upwards. What lies around the image is no cell: its outer edge is no wall.
fn read(path: &Path, ros: Ros, unknown: Unknown) -> Result<Scene, ReadError> {
    let text = read_text(path, SETTINGS_MAX)?;
    let map = parse(&text).map_err(|fault| fault.in_file(path))?;
    let image = path.parent().unwrap_or(Path::new("")).join(&map.image);
    let mut counts = Counts::default();
    let bits = image::read(&image, |pixel| {
        let cell = map.cell(pixel, ros);
        counts.add(cell);
        cell == Cell::Occupied || cell == Cell::Unknown && unknown == Unknown::Blocked
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
    let scene = cells::scene(walls, corner, true);
    let mut scene = scene.map_err(|fault| Fault::from(fault).in_file(path))?;
    scene.note("a unit is 1 m; y points up");
    let (followed, other, argument) = match ros {
        Ros::Two => ("nav2's map_server of ROS 2", "ROS 1's map_server", 1),
        Ros::One => ("map_server of ROS 1", "nav2's of ROS 2", 2),
    };
    scene.note(format!("cells are occupied as {followed} has it (as {other}: --ros {argument})"));
    if counts.unknown > 0 {
        let (are, other) = match unknown {
            Unknown::Free => ("no obstacles", "blocked"),
            Unknown::Blocked => ("obstacles", "free"),
        };
        let count = counts.unknown;
        scene.note(format!("unknown cells, which are {are} (the other way: --unknown {other}): {count}"));
    }
    if let Some(which) = counts.uniform(unknown) {
        scene.note(format!("{which}, so there are no walls; {}", map.rule(ros)));
    }
    Ok(scene)
}

/// The image that a map of ROS's `map_server` names; `None` of other files, and of maps that cannot be read.
pub(super) fn image_of(path: &Path) -> Option<PathBuf> {
    let is_map = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"));
    let map = is_map.then(|| parse(&read_text(path, SETTINGS_MAX).ok()?).ok())??;
    Some(path.parent().unwrap_or(Path::new("")).join(map.image))
}

/// How many cells are what.
#[derive(Default)]
struct Counts {
    occupied: usize,
    unknown: usize,
    all: usize,
}

impl Counts {
    fn add(&mut self, cell: Cell) {
        self.all += 1;
        self.occupied += usize::from(cell == Cell::Occupied);
        self.unknown += usize::from(cell == Cell::Unknown);
    }

    /// What is said of a map whose cells are all obstacles or all none.
    fn uniform(&self, unknown: Unknown) -> Option<String> {
        let blocked = self.occupied + if unknown == Unknown::Blocked { self.unknown } else { 0 };
        match self.all - blocked {
            0 if blocked == self.occupied => Some(format!("all {} cells count as occupied", self.all)),
            0 => Some(format!("all {} cells count as occupied or unknown", self.all)),
            free if free == self.all => Some(format!("none of the {} cells counts as occupied", self.all)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::map::Mode;
    use super::*;

    const MAP: &str = "image: map.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
        free_thresh: 0.196\n";

    fn fault(text: &str) -> String {
        let fault = parse(text).unwrap_err();
        format!("{}: {}", fault.place, fault.what)
    }

    /// The walls of an image of this size for these values of the map.
    fn scene(text: &str, pgm: &[u8], unknown: Unknown) -> Scene {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("map.pgm"), pgm).unwrap();
        let path = folder.path().join("map.yaml");
        std::fs::write(&path, text).unwrap();
        read(&path, Ros::Two, unknown).unwrap()
    }

    fn walls(scene: &Scene) -> Vec<[f64; 4]> {
        (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
    }

    #[test]
    fn the_lower_left_corner_is_the_origin_and_y_points_up() {
        // Two columns, three rows; the upper left cell is occupied.
        let pgm = b"P5 2 3 255\n\x00\xfe\xfe\xfe\xfe\xfe";
        let text = MAP.replace("0.05", "0.5");
        assert_eq!(walls(&scene(&text, pgm, Unknown::Free)), [[-1.0, 3.0, -0.5, 3.0], [-0.5, 3.5, -0.5, 3.0]]);
        // Turned by a quarter, to the left of the origin.
        let turned = text.replace(", 0.0]", ", 1.5707963267948966]");
        let found = walls(&scene(&turned, pgm, Unknown::Free));
        for (wall, right) in found.iter().zip([[-2.0, 2.0, -2.0, 2.5], [-2.5, 2.5, -2.0, 2.5]]) {
            assert!(wall.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn unknown_cells_are_counted_and_as_is_asked() {
        // Free, unknown, occupied.
        let pgm = b"P2 3 1 255 254 205 0";
        let free = scene(MAP, pgm, Unknown::Free);
        let blocked = scene(MAP, pgm, Unknown::Blocked);
        assert_eq!((walls(&free)[0][0], walls(&blocked)[0][0]), (-1.0 + 0.1, -1.0 + 0.05));
        assert_eq!(
            free.notes(),
            [
                "a unit is 1 m; y points up",
                "cells are occupied as nav2's map_server of ROS 2 has it (as ROS 1's map_server: --ros 1)",
                "unknown cells, which are no obstacles (the other way: --unknown blocked): 1"
            ]
        );
        assert_eq!(blocked.notes()[2], "unknown cells, which are obstacles (the other way: --unknown free): 1");
        assert_eq!(scene(MAP, b"P2 2 1 255 254 0", Unknown::Free).notes().len(), 2);
    }

    #[test]
    fn a_map_that_is_all_one_is_said_to_be() {
        let said = |pgm: &[u8], unknown| scene(MAP, pgm, unknown).notes().last().unwrap().clone();
        let rule = "so there are no walls; occupied is what is dark by occupied_thresh, 0.65, or more";
        let none = said(b"P2 2 1 255 254 205", Unknown::Free);
        assert_eq!(none, format!("none of the 2 cells counts as occupied, {rule}"));
        assert_eq!(said(b"P2 2 1 255 0 0", Unknown::Free), format!("all 2 cells count as occupied, {rule}"));
        let both = said(b"P2 2 1 255 0 205", Unknown::Blocked);
        assert_eq!(both, format!("all 2 cells count as occupied or unknown, {rule}"));
    }

    #[test]
    fn truth_is_spelled_as_in_yaml() {
        let negate = |word: &str| parse(&MAP.replace("negate: 0", &format!("negate: {word}"))).map(|map| map.negate);
        for (word, expected) in [("1", true), ("yes", true), ("On", true), ("Y", true), ("TRUE", true), ("0", false)] {
            assert_eq!(negate(word).unwrap(), expected, "{word}");
        }
        for word in ["no", "No", "NO", "n", "off", "False"] {
            assert!(!negate(word).unwrap(), "{word}");
        }
        for word in ["nO", "2", "ja", "tRUE", "-"] {
            assert!(negate(word).is_err(), "{word}");
        }
    }

    #[test]
    fn files_of_either_ros_are_read() {
        let map = parse(MAP).unwrap();
        assert_eq!((map.resolution, map.origin, map.mode), (0.05, DVec2::new(-1.0, 2.0), Mode::Trinary));
        let other = "# saved\n---\nmode: trinary\nfree_thresh: 0.196\nimage: 'map.pgm'\nresolution: 5e-2\nnegate: 0\n\
            origin:\n  - -1\n  - 2.0\n  - 0\noccupied_thresh: 0.65\nextra: {a: [1, {b: 2}], c: d}\nlast: x\n...\n";
        assert_eq!(parse(other).unwrap(), map);
    }

    #[test]
    fn faults_name_line_and_key() {
        let with = |from: &str, to: &str| fault(&MAP.replace(from, to));
        for (what, expected) in [
            (fault(""), ": no image; a map needs image, resolution, origin, negate, occupied_thresh, free_thresh"),
            (with("negate: 0\n", ""), ": no negate; a map needs image, resolution, origin, negate"),
            (with("0.05", "-1"), "line 2: resolution is \"-1\"; it must be a number of metres a pixel, above 0"),
            (with("0.05", ".nan"), "line 2: resolution is \".nan\"; it must be a number"),
            (with("0.05", "inf"), "line 2: resolution is \"inf\"; it must be a number"),
            (with("0.05", "[1]"), "line 2: resolution is \"[1]\"; it must be a number"),
            (with("[-1.0, 2.0, 0.0]", "[1, 2]"), "line 3: origin is \"[1, 2]\"; it must be three numbers, [x, y, yaw]"),
            (with("negate: 0", "negate: 2"), "line 4: negate is \"2\"; it must be 0 or 1, yes or no, true or false"),
            (with("0.196", "1.5"), "line 6: free_thresh is \"1.5\"; it must be a number from 0 to 1"),
            (with("map.pgm", "~"), "line 1: image is \"\"; it must be the name of a .png or .pgm file"),
            (fault(&format!("{MAP}mode: best\n")), "line 7: mode is \"best\"; it must be trinary, scale or raw"),
            (fault(&format!("{MAP}negate: 0\n")), "line 7: negate a second time"),
            (with("negate: 0", "a: &b 1\nnegate: *b"), "line 5: an alias (*); write the value out"),
            (fault("- 1\n"), "line 1: a list; a map is written as lines of a key and its value"),
            (fault("walls"), "line 1: no map; a map is written as lines"),
            (fault("a: [1\nb"), "not YAML: "),
        ] {
            assert!(what.contains(expected), "{what} is not {expected}");
        }
    }

    #[test]
    fn the_image_is_named_if_it_is_at_fault() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.yaml");
        std::fs::write(&path, MAP).unwrap();
        let e = read(&path, Ros::Two, Unknown::Free).unwrap_err().to_string();
        assert!(e.starts_with("cannot read ") && e.contains("map.pgm: No such file"), "{e}");
        std::fs::write(folder.path().join("map.pgm"), b"P5 1000000000 1000000000 255\n").unwrap();
        let e = read(&path, Ros::Two, Unknown::Free).unwrap_err().to_string();
        assert!(e.contains("map.pgm: 1000000000 x 1000000000 pixels; each side must have from 1 to 32768"), "{e}");
        // Noise has more borders than a map.
        let noise: Vec<u8> = (0..3000 * 3000).map(|i| if (i % 3000 + i / 3000) % 2 == 0 { 0 } else { 254 }).collect();
        std::fs::write(folder.path().join("map.pgm"), [b"P5 3000 3000 255\n", &noise[..]].concat()).unwrap();
        let e = read(&path, Ros::Two, Unknown::Free).unwrap_err().to_string();
        assert!(e.contains("map.pgm: more than 8388608 walls"), "{e}");
    }
}
