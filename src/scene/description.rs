//! What a scene is made of.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::{Inside, Scene};

/// What a scene is made of.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Description {
    /// How many walls it has.
    pub walls: usize,
    /// How many wall ends.
    pub vertices: usize,
    /// How many walls of zero length were dropped.
    pub dropped: usize,
    /// How many walls belong to something solid.
    pub solid: usize,
    /// Two corners of the box round all walls; null where there are none.
    #[serde(rename = "box")]
    pub bounds: Option<[[f64; 2]; 2]>,
    /// What the reader says a unit is; null where it says nothing.
    pub unit: Option<String>,
    /// Whether y points `up` or `down`.
    pub y: &'static str,
    /// Each layer, and how many walls lie in it, in the order of the alphabet.
    pub layers: Vec<Layer>,
    /// Each label, and how many walls it stands for, in the order of the alphabet.
    pub labels: Vec<Label>,
    /// What the reader has to say.
    pub notes: Vec<String>,
}

/// A layer, and how many walls lie in it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// How many.
    pub walls: usize,
}

/// A label, and how many walls it stands for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Label {
    /// It.
    pub label: String,
    /// How many.
    pub walls: usize,
}

impl Scene {
    /// What it is made of. O(walls log walls).
    ///
    /// ```
    /// use tautline::example::floor_plan;
    /// let described = floor_plan().describe();
    /// assert_eq!((described.walls, described.y), (467, "up"));
    /// ```
    pub fn describe(&self) -> Description {
        let (mut solid, mut labels) = (0, BTreeMap::<&str, usize>::new());
        for wall in 0..self.walls().len() {
            let object = &self.objects()[self.object_of(wall)];
            solid += usize::from(object.inside != Inside::Free);
            object.label.iter().for_each(|label| *labels.entry(label).or_default() += 1);
        }
        let unit = self.notes().iter().find_map(|note| note.strip_prefix("a unit is "));
        Description {
            walls: self.walls().len(),
            vertices: self.vertices().len(),
            dropped: self.dropped(),
            solid,
            bounds: self.bounds().map(|(low, high)| [low, high].map(|corner| corner.to_array())),
            unit: unit.map(|unit| unit.split(';').next().unwrap_or(unit).to_owned()),
            y: if self.y_down() { "down" } else { "up" },
            layers: self.layers().into_iter().map(|(name, walls)| Layer { name: name.to_owned(), walls }).collect(),
            labels: labels.into_iter().map(|(label, walls)| Label { label: label.to_owned(), walls }).collect(),
            notes: self.notes().to_vec(),
        }
    }
}
