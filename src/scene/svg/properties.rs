//! The properties that matter for walls.

/// The properties that matter, and whether an attribute of the same name says the same.
pub(super) const PROPERTIES: [(&str, bool); 34] = [
    ("clip-path", true),
    ("cx", true),
    ("cy", true),
    ("d", true),
    ("display", true),
    ("fill", true),
    ("fill-opacity", true),
    ("fill-rule", true),
    ("height", true),
    ("marker", false),
    ("marker-end", true),
    ("marker-mid", true),
    ("marker-start", true),
    ("mask", true),
    ("offset", false),
    ("offset-path", false),
    ("opacity", true),
    ("overflow", true),
    ("r", true),
    ("rotate", false),
    ("rx", true),
    ("ry", true),
    ("scale", false),
    ("stroke", true),
    ("stroke-opacity", true),
    ("stroke-width", true),
    ("transform", true),
    ("transform-box", true),
    ("transform-origin", true),
    ("translate", false),
    ("visibility", true),
    ("width", true),
    ("x", true),
    ("y", true),
];

/// The property of this name, in any case, if it matters.
pub(super) fn property(name: &str) -> Option<&'static str> {
    PROPERTIES.iter().map(|p| p.0).find(|p| p.eq_ignore_ascii_case(name))
}
