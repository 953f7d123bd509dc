//! Lengths, as attributes and as style sheets write them.

use std::str::FromStr;

use glam::DVec2;
use svgtypes::{Length, LengthUnit};

use super::super::excerpt;
use super::style::Value;

/// What a percentage is a part of.
#[derive(Debug, Clone, Copy)]
pub(super) enum Along {
    X,
    Y,
    /// Neither: the viewport's diagonal over the square root of two.
    Both,
}

/// A length in the element's own coordinates; `None` if it is `auto`.
///
/// # Errors
///
/// No length, one that depends on a font, and one of a style sheet without a unit, which programs pass over.
pub(super) fn length(
    name: &str,
    value: Value<'_>,
    along: Along,
    viewport: Option<DVec2>,
) -> Result<Option<f64>, String> {
    let text = value.text;
    if value.is(&["auto"]) {
        return Ok(None);
    }
    let length = Length::from_str(text)
        .map_err(|_| format!("{name} is {:?}; it must be a length such as 12.5, 12.5mm or 50%", excerpt(text)))?;
    Ok(Some(match length.unit {
        LengthUnit::Percent => {
            let all = viewport.ok_or_else(|| format!("{name} is {text:?}, but of what is not known"))?;
            let all = match along {
                Along::X => all.x,
                Along::Y => all.y,
                Along::Both => (all.length_squared() / 2.0).sqrt(),
            };
            length.number / 100.0 * all
        }
        LengthUnit::None if value.css && length.number != 0.0 => {
            return Err(format!("{name} is {text:?} in a style, where lengths need a unit, such as {text}px"));
        }
        unit => {
            let pixels = pixels(unit)
                .ok_or_else(|| format!("{name} is {text:?}, which depends on a font; give it in px or mm"))?;
            length.number * pixels
        }
    }))
}

/// How many pixels a unit is; `None` if that depends on something else.
pub(super) fn pixels(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::None | LengthUnit::Px => Some(1.0),
        LengthUnit::In => Some(96.0),
        LengthUnit::Cm => Some(96.0 / 2.54),
        LengthUnit::Mm => Some(96.0 / 25.4),
        LengthUnit::Pt => Some(96.0 / 72.0),
        LengthUnit::Pc => Some(16.0),
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => None,
    }
}
