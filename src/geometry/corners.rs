//! Corners of boxes along the axes.

use glam::DVec2;

/// The lower of two coordinates in x and in y: the corner of the box that holds both points.
///
/// What [`DVec2::min`] gives for numbers, in one instruction a coordinate: none is spent on NaNs, which no point holds
/// that [`check_point`](super::check_point) lets pass.
#[inline]
pub fn lower(p: DVec2, q: DVec2) -> DVec2 {
    let less = |a: f64, b: f64| if a < b { a } else { b };
    DVec2::new(less(p.x, q.x), less(p.y, q.y))
}

/// The higher of two coordinates in x and in y; see [`lower`].
#[inline]
pub fn higher(p: DVec2, q: DVec2) -> DVec2 {
    let more = |a: f64, b: f64| if a > b { a } else { b };
    DVec2::new(more(p.x, q.x), more(p.y, q.y))
}
