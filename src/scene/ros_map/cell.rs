//! What `map_server` makes of a pixel: nav2's of ROS 2 as it is today, and that of ROS 1.

use super::super::Ros;
use super::super::image::Pixel;
use super::map::{Map, Mode};

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cell {
    /// 100 in the map that the server gives out.
    Occupied,
    /// -1, or what no map may hold.
    Unknown,
    /// Free, or occupied by a chance that is not enough.
    Other,
}

/// A cell of a map that the server gives out, from 0 to 100 where it is known.
fn valued(value: i32) -> Cell {
    match value {
        100 => Cell::Occupied,
        0..=99 => Cell::Other,
        _ => Cell::Unknown,
    }
}

impl Map {
    pub(super) fn cell(&self, pixel: Pixel, ros: Ros) -> Cell {
        match ros {
            Ros::Two => self.today(pixel),
            Ros::One => self.of_old(pixel),
        }
    }

    /// Everything is in f32 there, and both thresholds are taken with what lies on them; what is free is so even if it
    /// is occupied too.
    fn today(&self, pixel: Pixel) -> Cell {
        let shade = luminance(pixel.colours);
        if self.mode == Mode::Raw {
            return valued(shade.into());
        }
        if pixel.alpha.is_some_and(|alpha| alpha / 257 < 255) {
            return Cell::Unknown;
        }
        let shade = f32::from(shade) / 255.0;
        let dark = if self.negate { shade } else { 1.0 - shade };
        let (occupied, free) = (self.occupied as f32, self.free as f32);
        match self.mode {
            _ if dark <= free => Cell::Other,
            _ if dark >= occupied => Cell::Occupied,
            Mode::Scale => valued(((dark - free) / (self.occupied - self.free) as f32 * 100.0).round() as i32),
            _ => Cell::Unknown,
        }
    }

    /// Colours count by their mean; in the mode `trinary` alpha is one of them. What lies on a threshold is beyond
    /// neither.
    fn of_old(&self, pixel: Pixel) -> Cell {
        // Its images have 8 bits, of which the lower ones were cut off.
        let bytes = pixel.colours.map(|c| f64::from(c >> 8));
        let alpha = pixel.alpha.map(|a| f64::from(a >> 8));
        let counted = alpha.filter(|_| self.mode == Mode::Trinary);
        let sum: f64 = bytes.iter().chain(&counted).sum();
        let mean = sum / if counted.is_some() { 4.0 } else { 3.0 };
        let mean = if self.negate { 255.0 - mean } else { mean };
        if self.mode == Mode::Raw {
            return valued(mean as i32);
        }
        let dark = (255.0 - mean) / 255.0;
        match self.mode {
            _ if dark > self.occupied => Cell::Occupied,
            _ if dark < self.free => Cell::Other,
            Mode::Scale if alpha.is_none_or(|alpha| alpha > 0.0) => {
                valued((1.0 + 98.0 * (dark - self.free) / (self.occupied - self.free)) as i32)
            }
            _ => Cell::Unknown,
        }
    }

    /// When a cell is occupied, in words that go on.
    pub(super) fn rule(&self, ros: Ros) -> String {
        let shade = if self.negate { "light" } else { "dark" };
        match (self.mode, ros) {
            (Mode::Raw, _) => "occupied is the value 100".to_owned(),
            (_, Ros::Two) => format!("occupied is what is {shade} by occupied_thresh, {}, or more", self.occupied),
            (_, Ros::One) => format!("occupied is what is {shade} by more than occupied_thresh, {}", self.occupied),
        }
    }
}

/// How light a colour is, from 0 to 255, as GraphicsMagick has it, with which nav2 reads images: by the weights of
/// ITU-R BT.601, rounded to 16 bits, of which the upper 8 are taken.
fn luminance([r, g, b]: [u16; 3]) -> u8 {
    let sum = 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
    ((sum + 500) / 1000 / 257) as u8
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::Cell::{Occupied, Other, Unknown};
    use super::*;

    const MAP: &str =
        "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    const SHADES: [u8; 8] = [0, 89, 90, 100, 101, 205, 206, 254];

    fn pixel(colours: [u8; 3], alpha: Option<u8>) -> Pixel {
        Pixel { colours: colours.map(|c| u16::from(c) * 257), alpha: alpha.map(|a| u16::from(a) * 257) }
    }

    fn all(text: &str, ros: Ros) -> [Cell; 8] {
        let map = parse(text).unwrap();
        SHADES.map(|shade| map.cell(pixel([shade; 3], None), ros))
    }

    /// Grey: from 0.65 on up to 89 of 255; up to 0.196 from 206 on.
    #[test]
    fn modes_and_thresholds_are_those_of_the_map_servers() {
        let trinary = [Occupied, Occupied, Unknown, Unknown, Unknown, Unknown, Other, Other];
        let negated = [Other, Unknown, Unknown, Unknown, Unknown, Occupied, Occupied, Occupied];
        let scale = [Occupied, Occupied, Other, Other, Other, Other, Other, Other];
        let raw = [Other, Other, Other, Occupied, Unknown, Unknown, Unknown, Unknown];
        let negate = MAP.replace("negate: 0", "negate: yes");
        for ros in [Ros::One, Ros::Two] {
            assert_eq!(all(MAP, ros), trinary);
            assert_eq!(all(&negate, ros), negated);
            assert_eq!(all(&format!("{MAP}mode: trinary\n"), ros), trinary);
            assert_eq!(all(&format!("{MAP}mode: Raw\n"), ros), raw);
        }
        assert_eq!(all(&format!("{MAP}mode: SCALE\n"), Ros::One), scale);
        // 90 of 255 is dark by 0.647, which rounds to 99.
        assert_eq!(all(&format!("{MAP}mode: scale\n"), Ros::Two), scale);
        // ROS 1 turns raw values over, nav2 does not.
        let raw = parse(&format!("{negate}mode: raw\n")).unwrap();
        let values = |ros| [100, 155].map(|shade| raw.cell(pixel([shade; 3], None), ros));
        assert_eq!((values(Ros::Two), values(Ros::One)), ([Occupied, Unknown], [Unknown, Occupied]));
    }

    #[test]
    fn thresholds_count_as_each_server_has_it() {
        // 0 is dark by 1, 255 by 0, 204 by a fifth.
        let with = |thresholds: [&str; 2], mode: &str, ros| {
            let text = MAP.replace("0.65", thresholds[0]).replace("0.196", thresholds[1]);
            let map = parse(&format!("{text}mode: {mode}\n")).unwrap();
            [0, 1, 2, 204, 255].map(|shade| map.cell(pixel([shade; 3], None), ros))
        };
        assert_eq!(with(["1.0", "0.0"], "trinary", Ros::Two), [Occupied, Unknown, Unknown, Unknown, Other]);
        assert_eq!(with(["1.0", "0.0"], "trinary", Ros::One), [Unknown; 5]);
        // What rounds to 100 is occupied; ROS 1 goes up to 99 between the thresholds.
        assert_eq!(with(["1.0", "0.0"], "scale", Ros::Two), [Occupied, Occupied, Other, Other, Other]);
        assert_eq!(with(["1.0", "0.0"], "scale", Ros::One), [Other; 5]);
        // In f32 a fifth less than all of it is a little less than a fifth; nothing is free and occupied in ROS 1
        // alone.
        assert_eq!(with(["0.2", "0.1"], "trinary", Ros::Two)[3], Unknown);
        assert_eq!(with(["0.5", "0.2"], "trinary", Ros::Two)[3], Other);
        assert_eq!(with(["0.5", "0.2"], "trinary", Ros::One)[3], Unknown);
        assert_eq!(with(["0.1", "0.3"], "trinary", Ros::Two)[3], Other);
        assert_eq!(with(["0.1", "0.3"], "trinary", Ros::One)[3], Occupied);
    }

    #[test]
    fn what_is_transparent_is_unknown_today_and_lighter_in_ros_1() {
        let cell = |mode: &str, alpha: u8, ros| {
            parse(&format!("{MAP}mode: {mode}\n")).unwrap().cell(pixel([0; 3], Some(alpha)), ros)
        };
        for mode in ["trinary", "scale"] {
            assert_eq!([0, 254, 255].map(|a| cell(mode, a, Ros::Two)), [Unknown, Unknown, Occupied]);
        }
        assert_eq!(cell("raw", 0, Ros::Two), Other);
        // Opaque black is dark by three quarters; alpha is light.
        assert_eq!([0, 255].map(|a| cell("trinary", a, Ros::One)), [Occupied, Occupied]);
        assert_eq!([0, 255].map(|a| cell("scale", a, Ros::One)), [Occupied, Occupied]);
        let dark = parse(&MAP.replace("0.65", "0.9")).unwrap();
        assert_eq!(dark.cell(pixel([0; 3], Some(255)), Ros::One), Unknown);
        assert_eq!(dark.cell(pixel([0; 3], Some(255)), Ros::Two), Occupied);
    }

    /// Values that GraphicsMagick 1.3.40 gave for these colours and 16-bit greys.
    #[test]
    fn luminance_is_that_of_graphicsmagick() {
        for (colours, expected) in [
            ([10, 200, 30], 123),
            ([68, 32, 130], 53),
            ([60, 253, 230], 192),
            ([148, 11, 213], 74),
            ([127, 216, 81], 174),
            ([177, 138, 255], 163),
            ([255, 255, 255], 255),
        ] {
            assert_eq!(luminance(colours.map(|c| c * 257)), expected, "{colours:?}");
        }
        let deep = [0, 256, 257, 385, 25700, 25829, 65535].map(|c| luminance([c; 3]));
        assert_eq!(deep, [0, 0, 1, 1, 100, 100, 255]);
    }
}
