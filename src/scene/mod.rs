//! What the user brings as the plane: walls, their ends, and the anchor.

mod geojson;
mod grid;
mod index;
mod model;
mod movingai;
mod read;

use std::collections::HashMap;

use glam::DVec2;

use crate::geometry::{CoordinateFault, check_point};

pub use index::WallIndex;
pub use model::{AnchorError, Model};
pub use read::read_scene;

/// Walls and their ends. Coordinates are planar f64 in the user's own unit and frame.
///
/// Equal endpoints are one vertex. Walls may share endpoints, touch, cross and overlap.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    vertices: Vec<DVec2>,
    walls: Vec<[u32; 2]>,
    anchor: Option<DVec2>,
    dropped: usize,
}

impl Scene {
    /// A scene of the given walls, each a pair of endpoints; walls of zero length are dropped and counted.
    ///
    /// Vertices are numbered in the order in which their first wall names them. O(walls).
    ///
    /// # Errors
    ///
    /// The first coordinate that exact arithmetic cannot take.
    ///
    /// ```
    /// use tautline::scene::Scene;
    /// let scene = Scene::new([
    ///     [[0.0, 0.0].into(), [1.0, 0.0].into()],
    ///     [[1.0, 0.0].into(), [1.0, 2.0].into()],
    /// ])?;
    /// assert_eq!((scene.walls().len(), scene.vertices().len()), (2, 3));
    /// # Ok::<(), tautline::geometry::CoordinateFault>(())
    /// ```
    pub fn new(walls: impl IntoIterator<Item = [DVec2; 2]>) -> Result<Self, CoordinateFault> {
        let mut scene = Scene::default();
        let mut numbers = HashMap::new();
        for ends in walls {
            let ends = [check_point(ends[0])?, check_point(ends[1])?];
            if ends[0] == ends[1] {
                scene.dropped += 1;
                continue;
            }
            let numbered = ends.map(|p| {
                *numbers.entry((p.x.to_bits(), p.y.to_bits())).or_insert_with(|| {
                    scene.vertices.push(p);
                    scene.vertices.len() as u32 - 1
                })
            });
            scene.walls.push(numbered);
        }
        Ok(scene)
    }

    /// The same scene with the anchor that its file marks.
    #[must_use]
    pub fn with_anchor(mut self, anchor: DVec2) -> Self {
        self.anchor = Some(anchor);
        self
    }

    /// The ends of all walls, each once.
    pub fn vertices(&self) -> &[DVec2] {
        &self.vertices
    }

    /// The walls, as pairs of indices into [`vertices`](Self::vertices).
    pub fn walls(&self) -> &[[u32; 2]] {
        &self.walls
    }

    /// The endpoints of wall `wall`.
    pub fn ends(&self, wall: usize) -> [DVec2; 2] {
        self.walls[wall].map(|v| self.vertices[v as usize])
    }

    /// The anchor that the scene's file marks, if it marks one.
    pub fn anchor(&self) -> Option<DVec2> {
        self.anchor
    }

    /// How many walls of zero length were dropped.
    pub fn dropped(&self) -> usize {
        self.dropped
    }
}
