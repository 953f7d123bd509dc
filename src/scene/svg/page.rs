//! How large the drawing is, and what a unit of it is.

use std::str::FromStr;

use glam::DVec2;
use roxmltree::Node;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, ViewBox};

use super::super::excerpt;
use super::length::pixels;
use super::style::Style;

/// Up to which difference, as a part of them, two units are one: a page's size is often rounded.
const ROUNDED: f64 = 1e-3;

/// The size of the outermost viewport in user units, if it is known, and a sentence about what a unit is.
///
/// # Errors
///
/// A viewBox that is none, and one that is stretched to a page of another shape: then x and y have two units.
pub(super) fn viewport_of(root: Node<'_, '_>, style: &Style<'_>) -> Result<(Option<DVec2>, String), String> {
    let view = view_box(root)?;
    let length = |name: &str| style.get(name).and_then(|value| Length::from_str(value.text).ok());
    // Of the page's sides those that are known, in pixels.
    let absolute = |l: Length| pixels(l.unit).map(|p| l.number * p).filter(|&size| size > 0.0);
    let [width, height] = ["width", "height"].map(|name| length(name).filter(|&l| absolute(l).is_some()));
    let Some(view) = view else {
        let size = width.and_then(absolute).zip(height.and_then(absolute));
        return Ok((size.map(|(w, h)| DVec2::new(w, h)), "a unit is a pixel, of which 96 are an inch".into()));
    };
    let size = Some(DVec2::new(view.w, view.h));
    let aspect = root.attribute("preserveAspectRatio").unwrap_or("xMidYMid");
    let aspect = AspectRatio::from_str(aspect).map_err(|e| format!("preserveAspectRatio: {e}"))?;
    let stretched = aspect.align == Align::None;
    let unit_of = |l: Length, part: f64| absolute(l).unwrap_or(f64::NAN) / part;
    // Which side decides: the drawing is fitted into the page, or fills it.
    let by_width = match (width, height) {
        (Some(w), Some(h)) => {
            let [x, y] = [unit_of(w, view.w), unit_of(h, view.h)];
            if stretched && (x - y).abs() > ROUNDED * x.max(y) {
                let right = "make both sides fit the viewBox, or leave preserveAspectRatio out";
                let [x, y] = [unit_name(w, view.w), unit_name(h, view.h)];
                return Err(format!("a unit is {x} along x, but {y} along y; {right}"));
            }
            // Sides that differ by a rounding alone fit both.
            (x - y).abs() <= ROUNDED * x.max(y) || (x < y) != aspect.slice
        }
        // The other side is what fits; but stretched it may be anything.
        (Some(_), None) if !stretched => true,
        (None, Some(_)) if !stretched => false,
        _ => return Ok((size, "units are those of the viewBox".into())),
    };
    let (side, part, way) = if by_width { (width, view.w, "wide") } else { (height, view.h, "high") };
    let side = side.expect("the side that decides is known");
    let unit = unit_name(side, part);
    Ok((size, format!("a unit is {unit} (the drawing is {} {} {way}, its viewBox {part})", side.number, name(side))))
}

/// The unit of which `part` make a side, to six digits.
fn unit_name(side: Length, part: f64) -> String {
    let size: f64 = format!("{:.5e}", side.number / part).parse().unwrap_or(f64::NAN);
    format!("{size} {}", name(side))
}

fn name(length: Length) -> &'static str {
    match length.unit {
        LengthUnit::In => "in",
        LengthUnit::Cm => "cm",
        LengthUnit::Mm => "mm",
        LengthUnit::Pt => "pt",
        LengthUnit::Pc => "pc",
        _ => "px",
    }
}

/// The attribute `viewBox`.
pub(super) fn view_box(node: Node<'_, '_>) -> Result<Option<ViewBox>, String> {
    let parse = |text| ViewBox::from_str(text).map_err(|e| format!("viewBox is {:?}: {e}", excerpt(text)));
    node.attribute("viewBox").map(parse).transpose()
}
