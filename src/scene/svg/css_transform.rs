//! Transforms as style sheets write them: with units, and by `translate`, `rotate` and `scale` on their own too.

use glam::{DAffine2, DVec2};

use super::super::curves::direction;
use super::super::excerpt;
use super::length::{Along, length};
use super::style::Value;

/// The transform that `transform`, `translate`, `rotate` or `scale` describes.
///
/// # Errors
///
/// What is not understood, such as turns in space.
pub(super) fn property(name: &str, text: &str, viewport: Option<DVec2>) -> Result<DAffine2, String> {
    let read = if name == "transform" {
        functions(text, viewport)
    } else {
        let all: Vec<&str> = text.split_whitespace().collect();
        function(name, if name == "rotate" { all.strip_prefix(&["z"]).unwrap_or(&all) } else { &all }, viewport)
    };
    read.ok_or_else(|| {
        let right = "write the attribute transform, or such as rotate(90deg) translate(10px, 5px)";
        format!("{name} is {:?} in a style, which is not understood; {right}", excerpt(text))
    })
}

/// Where `transform-origin` lies. The usual box is the viewport; that of the shape itself is not taken.
///
/// # Errors
///
/// What is not understood.
pub(super) fn origin(value: Value<'_>, of: &str, viewport: Option<DVec2>) -> Result<DVec2, String> {
    let text = value.text.to_ascii_lowercase();
    let mut words: Vec<&str> = text.split_whitespace().collect();
    // Words may come in either order.
    if matches!(words[..], ["top" | "bottom", _] | [_, "left" | "right"]) {
        words.swap(0, 1);
    } else if let ["top" | "bottom"] = words[..] {
        words.insert(0, "center");
    }
    let part = |i: usize, along: Along| {
        let word = match *words.get(i).unwrap_or(&"center") {
            "left" | "top" => "0%",
            "center" => "50%",
            "right" | "bottom" => "100%",
            word => word,
        };
        // Attributes may leave the unit out.
        length("transform-origin", Value { text: word, css: value.css }, along, viewport).ok().flatten()
    };
    match (part(0, Along::X), part(1, Along::Y), words.len(), of) {
        (Some(x), Some(y), 1..=2, "" | "view-box") => Ok(DVec2::new(x, y)),
        _ => {
            let of = if of.is_empty() { "view-box" } else { of };
            let right = "give two lengths, or write it into the attribute transform";
            Err(format!("transform-origin is {:?} of the {of}, which is not understood; {right}", excerpt(value.text)))
        }
    }
}

/// Functions one after the other.
fn functions(mut text: &str, viewport: Option<DVec2>) -> Option<DAffine2> {
    let mut all = DAffine2::IDENTITY;
    while !text.trim().is_empty() {
        let (name, rest) = text.split_once('(')?;
        let (inside, rest) = rest.split_once(')')?;
        let arguments: Vec<&str> = inside.split(',').map(str::trim).collect();
        all *= function(&name.trim().to_ascii_lowercase(), &arguments, viewport)?;
        text = rest;
    }
    Some(all)
}

fn function(name: &str, arguments: &[&str], viewport: Option<DVec2>) -> Option<DAffine2> {
    let distance = |text: &str, along| length("", Value { text, css: true }, along, viewport).ok().flatten();
    let [x, y] = [Along::X, Along::Y].map(|along| move |text: &str| distance(text, along));
    let by = |x: f64, y: f64| Some(DAffine2::from_translation(DVec2::new(x, y)));
    let times = |x: f64, y: f64| Some(DAffine2::from_scale(DVec2::new(x, y)));
    let skew = |x: f64, y: f64| {
        let tan = |degrees: f64| libm::tan(degrees.to_radians());
        Some(DAffine2::from_cols_array(&[1.0, tan(y), tan(x), 1.0, 0.0, 0.0]))
    };
    match (name, arguments) {
        ("translate", [a]) | ("translatex", [a]) => by(x(a)?, 0.0),
        ("translate", [a, b]) => by(x(a)?, y(b)?),
        ("translatey", [b]) => by(0.0, y(b)?),
        ("scale", [a]) => times(factor(a)?, factor(a)?),
        ("scale", [a, b]) => times(factor(a)?, factor(b)?),
        ("scalex", [a]) => times(factor(a)?, 1.0),
        ("scaley", [b]) => times(1.0, factor(b)?),
        ("rotate" | "rotatez", [a]) => {
            let d = direction(degrees(a)?);
            Some(DAffine2::from_cols_array(&[d.x, d.y, -d.y, d.x, 0.0, 0.0]))
        }
        ("skew" | "skewx", [a]) => skew(degrees(a)?, 0.0),
        ("skew", [a, b]) => skew(degrees(a)?, degrees(b)?),
        ("skewy", [b]) => skew(0.0, degrees(b)?),
        ("matrix", [a, b, c, d, e, f]) => {
            Some(DAffine2::from_cols_array(&[a, b, c, d, e, f].map(|n| number(n).unwrap_or(f64::NAN))))
                .filter(|m| m.is_finite())
        }
        _ => None,
    }
}

fn number(text: &str) -> Option<f64> {
    // Words such as "inf" are no numbers here.
    text.parse().ok().filter(|_| !text.contains(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E')))
}

fn factor(text: &str) -> Option<f64> {
    match text.strip_suffix('%') {
        Some(percent) => number(percent).map(|p| p / 100.0),
        None => number(text),
    }
}

fn degrees(text: &str) -> Option<f64> {
    let text = text.to_ascii_lowercase();
    for (unit, in_degrees) in [("deg", 1.0), ("grad", 0.9), ("rad", 180.0 / std::f64::consts::PI), ("turn", 360.0)] {
        if let Some(value) = text.strip_suffix(unit) {
            return number(value.trim_end()).map(|value| value * in_degrees);
        }
    }
    number(&text).filter(|&zero| zero == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEWPORT: Option<DVec2> = Some(DVec2::new(200.0, 100.0));

    #[test]
    fn transforms_with_units() {
        let at = |name: &str, text: &str| {
            property(name, text, VIEWPORT).unwrap_or_else(|e| panic!("{e}")).transform_point2(DVec2::new(3.0, 5.0))
        };
        for (name, text, expected) in [
            ("transform", "translate(10px, 1in)", [13., 101.]),
            ("transform", "translateX(10%)translateY(10%)", [23., 15.]),
            ("transform", "rotate(90deg) scale(2, 50%)", [-2.5, 6.]),
            ("transform", "ROTATE(0.25turn)", [-5., 3.]),
            ("transform", "rotate(100grad)", [-5., 3.]),
            ("transform", "matrix(1, 2, 3, 4, 5, 6)", [23., 32.]),
            ("transform", "scaleX(-1) scaley(2) rotate(0)", [-3., 10.]),
            ("translate", "10px 20px", [13., 25.]),
            ("translate", "10px", [13., 5.]),
            ("rotate", "90deg", [-5., 3.]),
            ("rotate", "z 90deg", [-5., 3.]),
            ("scale", "2", [6., 10.]),
            ("scale", "2 50%", [6., 2.5]),
        ] {
            assert_eq!(at(name, text).to_array(), expected, "{text}");
        }
        let [x, y] = at("transform", "skew(45deg, 0)").to_array();
        assert!((x - 8.0).abs() < 1e-12 && y == 5.0);
        for (name, wrong) in [
            ("transform", "rotate(90)"),
            ("transform", "translate(10, 20)"),
            ("transform", "rotate3d(1, 0, 0, 9deg)"),
            ("transform", "rotate(90deg"),
            ("transform", "matrix(1, 2, 3)"),
            ("transform", "scale(inf)"),
            ("transform", "var(--t)"),
            ("rotate", "x 90deg"),
            ("scale", "1 1 2"),
        ] {
            let e = property(name, wrong, VIEWPORT).unwrap_err();
            assert!(e.starts_with(&format!("{name} is {wrong:?} in a style, which is not understood; ")), "{e}");
        }
    }

    #[test]
    fn origins_are_lengths_or_parts_of_the_viewport() {
        let at = |text: &str, css: bool| origin(Value { text, css }, "", VIEWPORT).map(|p| p.to_array());
        assert_eq!(at("10 20", false), Ok([10., 20.]));
        assert_eq!(at("10px 50%", true), Ok([10., 50.]));
        assert_eq!(at("center", true), Ok([100., 50.]));
        assert_eq!(at("bottom right", true), Ok([200., 100.]));
        assert_eq!(at("top", true), Ok([100., 0.]));
        let e = origin(Value { text: "center", css: true }, "fill-box", VIEWPORT).unwrap_err();
        assert!(e.starts_with("transform-origin is \"center\" of the fill-box, which is not understood; "), "{e}");
        assert!(at("10 20", true).is_err() && at("1px 2px 3px", true).is_err());
    }
}
