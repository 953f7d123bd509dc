//! What places an element: its transform and its viewport.

use glam::{DAffine2, DMat2, DVec2};
use svgtypes::{Align, AspectRatio, TransformListParser, TransformListToken, ViewBox};

use super::super::curves::direction;
use super::super::excerpt;
use super::css_transform;
use super::style::Style;

/// How an element's own coordinates lie in those of what is round it.
pub(super) fn own(style: &Style<'_>, viewport: Option<DVec2>) -> Result<DAffine2, String> {
    let said = |name: &str| style.get(name).filter(|value| !value.is(&["none"]));
    if let Some((name, value)) = ["offset", "offset-path"].into_iter().find_map(|name| Some((name, said(name)?))) {
        return Err(format!("moved by the style {name}: {:?}; write the attribute transform", excerpt(value.text)));
    }
    let mut all = DAffine2::IDENTITY;
    for name in ["translate", "rotate", "scale", "transform"] {
        if let Some(value) = said(name) {
            all *=
                if value.css { css_transform::property(name, value.text, viewport)? } else { transform(value.text)? };
        }
    }
    let turned = all.matrix2 != DMat2::IDENTITY;
    match style.get("transform-origin").filter(|_| turned) {
        Some(origin) => {
            let origin = css_transform::origin(origin, &style.word("transform-box"), viewport)?;
            Ok(DAffine2::from_translation(origin) * all * DAffine2::from_translation(-origin))
        }
        None => Ok(all),
    }
}

/// The transform that the attribute `transform` describes.
pub(super) fn transform(text: &str) -> Result<DAffine2, String> {
    let mut all = DAffine2::IDENTITY;
    for token in TransformListParser::from(text) {
        let token = token.map_err(|e| format!("transform: {e}"))?;
        let columns = match token {
            TransformListToken::Matrix { a, b, c, d, e, f } => [a, b, c, d, e, f],
            TransformListToken::Translate { tx, ty } => [1.0, 0.0, 0.0, 1.0, tx, ty],
            TransformListToken::Scale { sx, sy } => [sx, 0.0, 0.0, sy, 0.0, 0.0],
            TransformListToken::Rotate { angle } => {
                let d = direction(angle);
                [d.x, d.y, -d.y, d.x, 0.0, 0.0]
            }
            TransformListToken::SkewX { angle } => [1.0, 0.0, libm::tan(angle.to_radians()), 1.0, 0.0, 0.0],
            TransformListToken::SkewY { angle } => [1.0, libm::tan(angle.to_radians()), 0.0, 1.0, 0.0, 0.0],
        };
        all *= DAffine2::from_cols_array(&columns);
    }
    Ok(all)
}

/// How the coordinates of a viewBox lie in a viewport of this size that begins at the origin.
pub(super) fn fitted(view: ViewBox, size: DVec2, aspect: AspectRatio) -> DAffine2 {
    let scale = size / DVec2::new(view.w, view.h);
    let (scale, room) = match aspect.align {
        Align::None => (scale, DVec2::ZERO),
        align => {
            let one = if aspect.slice { scale.max_element() } else { scale.min_element() };
            let left = size - DVec2::new(view.w, view.h) * one;
            (DVec2::splat(one), left * shares(align))
        }
    };
    DAffine2::from_translation(room)
        * DAffine2::from_scale(scale)
        * DAffine2::from_translation(-DVec2::new(view.x, view.y))
}

/// Which share of the room that is left lies before the drawing.
fn shares(align: Align) -> DVec2 {
    let [x, y] = match align {
        Align::None | Align::XMinYMin => [0.0, 0.0],
        Align::XMidYMin => [0.5, 0.0],
        Align::XMaxYMin => [1.0, 0.0],
        Align::XMinYMid => [0.0, 0.5],
        Align::XMidYMid => [0.5, 0.5],
        Align::XMaxYMid => [1.0, 0.5],
        Align::XMinYMax => [0.0, 1.0],
        Align::XMidYMax => [0.5, 1.0],
        Align::XMaxYMax => [1.0, 1.0],
    };
    DVec2::new(x, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_apply_from_the_right_and_quarter_turns_are_exact() {
        let at = |text: &str| transform(text).unwrap().transform_point2(DVec2::new(3.0, 5.0)).to_array();
        assert_eq!(at(""), [3.0, 5.0]);
        assert_eq!(at("translate(0.1,-1.5)"), [3.1, 3.5]);
        assert_eq!(at("translate(10) scale(2 -1)"), [16.0, -5.0]);
        assert_eq!(at("rotate(90)"), [-5.0, 3.0]);
        assert_eq!(at("rotate(-90 1 1)"), [5.0, -1.0]);
        assert_eq!(at("matrix(1 2 3 4 5 6)"), [23.0, 32.0]);
        let [x, y] = at("skewX(45)");
        assert!((x - 8.0).abs() < 1e-12 && y == 5.0);
        let [x, y] = at("skewY(45)");
        assert!(x == 3.0 && (y - 8.0).abs() < 1e-12);
        for wrong in ["rotate(", "turn(90)", "translate(a)", "matrix(1 2)"] {
            assert!(transform(wrong).unwrap_err().starts_with("transform: "), "{wrong}");
        }
    }

    #[test]
    fn a_view_box_is_fitted_as_its_aspect_says() {
        let at = |aspect: &str| {
            let fit = fitted(ViewBox::new(10.0, 20.0, 4.0, 2.0), DVec2::new(8.0, 8.0), aspect.parse().unwrap());
            [[10.0, 20.0], [14.0, 22.0]].map(|p| fit.transform_point2(p.into()).to_array())
        };
        assert_eq!(at("xMidYMid"), [[0.0, 2.0], [8.0, 6.0]]);
        assert_eq!(at("xMinYMax meet"), [[0.0, 4.0], [8.0, 8.0]]);
        assert_eq!(at("none"), [[0.0, 0.0], [8.0, 8.0]]);
        assert_eq!(at("xMaxYMin slice"), [[-8.0, 0.0], [8.0, 8.0]]);
    }
}
