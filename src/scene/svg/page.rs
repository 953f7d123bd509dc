//! How large the drawing is, and what a unit of it is.

use std::str::FromStr;

use glam::DVec2;
use roxmltree::Node;
use svgtypes::{Length, LengthUnit, ViewBox};

use super::super::excerpt;
use super::shapes::pixels;

/// The size of the outermost viewport in user units, if it is known, and a sentence about what a unit is.
pub(super) fn viewport_of(root: Node<'_, '_>) -> Result<(Option<DVec2>, String), String> {
    let view = view_box(root)?;
    let length = |name: &str| root.attribute(name).and_then(|text| Length::from_str(text.trim()).ok());
    let absolute = |l: Length| pixels(l.unit).map(|p| l.number * p).filter(|&size| size > 0.0);
    let [width, height] = [length("width"), length("height")];
    let Some(view) = view else {
        let size = width.and_then(absolute).zip(height.and_then(absolute));
        return Ok((size.map(|(w, h)| DVec2::new(w, h)), "a unit is a pixel, of which 96 are an inch".into()));
    };
    let unit = match width {
        Some(l) if absolute(l).is_some() => {
            let name = match l.unit {
                LengthUnit::In => "in",
                LengthUnit::Cm => "cm",
                LengthUnit::Mm => "mm",
                LengthUnit::Pt => "pt",
                LengthUnit::Pc => "pc",
                _ => "px",
            };
            // To six digits: a page's size is often rounded.
            let size: f64 = format!("{:.5e}", l.number / view.w).parse().unwrap_or(f64::NAN);
            format!("a unit is {size} {name} (the drawing is {} {name} wide, its viewBox {})", l.number, view.w)
        }
        _ => "units are those of the viewBox".into(),
    };
    Ok((Some(DVec2::new(view.w, view.h)), unit))
}

/// The attribute `viewBox`.
pub(super) fn view_box(node: Node<'_, '_>) -> Result<Option<ViewBox>, String> {
    let parse = |text| ViewBox::from_str(text).map_err(|e| format!("viewBox is {:?}: {e}", excerpt(text)));
    node.attribute("viewBox").map(parse).transpose()
}
