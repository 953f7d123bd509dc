//! The namespaces of elements and attributes.

pub(super) const SVG: &str = "http://www.w3.org/2000/svg";
pub(super) const XLINK: &str = "http://www.w3.org/1999/xlink";
pub(super) const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
