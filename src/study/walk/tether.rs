//! Tethers that hold the free end back.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What becomes of a step at whose end the rope would be longer than the tether.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AtTether {
    /// The free end stays where it is for that step.
    #[default]
    Stay,
    /// The free end goes along the border of what the tether lets it reach, as far as the step leads: to where the rope
    /// to the step's end is as long as the tether.
    Slide,
    /// The step is drawn again.
    Turn,
}

/// A tether that holds the free end back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tether {
    /// How long it is, in the scene's unit: the rope is never longer.
    pub length: f64,
    /// What becomes of a step at whose end it would be.
    pub at: AtTether,
}
