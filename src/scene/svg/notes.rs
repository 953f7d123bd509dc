//! What is said of a drawing: what is no wall of it, and what is taken in another way than it looks.

use std::collections::BTreeMap;

use super::super::{Scene, listed};

/// Counts of elements.
#[derive(Default)]
pub(super) struct Counts<'a> {
    /// Passed over, by name.
    pub(super) passed: BTreeMap<&'a str, usize>,
    pub(super) hidden: usize,
    pub(super) unpainted: usize,
    pub(super) clipped: usize,
    /// In nested viewports, and reaching beyond them.
    pub(super) beyond: usize,
    /// With markers.
    pub(super) marked: usize,
    /// The widths of strokes, in the scene's unit.
    pub(super) widths: Vec<f64>,
    /// Shapes without length.
    pub(super) dropped: usize,
    /// The first element that is nearly called anchor.
    pub(super) nearly: Option<String>,
}

/// From which part of the drawing's longer side on a stroke is said to be wide.
const WIDE: f64 = 0.01;

impl Counts<'_> {
    /// Adds the notes to the scene; its longer side is `side`.
    pub(super) fn tell(&self, scene: &mut Scene, side: f64) {
        let mut count = |count: usize, what: &str| {
            if count > 0 {
                scene.note(format!("{what}: {count}"));
            }
        };
        count(self.hidden, "hidden elements, which are no walls");
        count(self.unpainted, "shapes neither filled nor stroked, or of opacity 0, which are no walls");
        count(self.clipped, "clip paths and masks cut no walls; elements taken whole");
        count(
            self.beyond,
            "nested drawings and symbols are not cut at their edges; elements that reach beyond, taken whole",
        );
        count(
            self.marked,
            "markers such as arrow heads are no walls, but the lines that bear them are; lines with markers",
        );
        let wide = self.widths.iter().filter(|&&width| width > side * WIDE);
        let widest = wide.clone().copied().fold(0.0, f64::max);
        let widest: f64 = format!("{widest:.2e}").parse().unwrap_or(widest);
        count(wide.count(), &format!("walls are the middle of strokes, whose widest is {widest} wide; wide strokes"));
        if let Some(nearly) = self.nearly.as_ref().filter(|_| scene.anchor().is_none()) {
            scene.note(format!(
                "{nearly} and is taken for what it draws; the id or label that marks the anchor is \"anchor\""
            ));
        }
        if !self.passed.is_empty() {
            scene.note(format!("passed over: {}", listed(&self.passed)));
        }
    }
}
