//! What scene files leave open.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a file leaves open and its reader needs to know.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneOptions {
    /// How far a wall may lie from the curve that it stands for, in the scene's unit: above 0. `None` is a 2000th of
    /// the drawing's longer side. For `.svg` and `.dxf`.
    pub flatten: Option<f64>,
    /// What cells are of which the map does not know whether they are free. For `.yaml`.
    pub unknown: Unknown,
    /// Whose `map_server` says which cells are occupied. For `.yaml`.
    pub ros: Ros,
    /// The layers whose walls are taken; all if it is empty. A layer of a GeoJSON feature is what its property `layer`
    /// says, and for a name `KEY=VALUE` what its property `KEY` does.
    pub layers: Vec<String>,
    /// The layers whose walls are left out.
    pub without_layers: Vec<String>,
}

/// Whose `map_server` a map is read like.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Ros {
    /// That of ROS 1.
    One,
    /// nav2's, of ROS 2.
    #[default]
    Two,
}

/// What a cell is of which a map does not know whether it is free.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// No obstacle: only what the map knows to be occupied is one.
    #[default]
    Free,
    /// An obstacle, as what is occupied.
    Blocked,
}
