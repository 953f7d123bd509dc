//! What the user brings as the plane: walls, their ends, and the anchor.

mod cells;
mod curves;
mod dxf;
mod extent;
mod flattened;
mod geographic;
mod geojson;
mod grid;
mod image;
mod index;
mod lines;
mod model;
mod movingai;
mod object;
mod pen;
mod read;
mod ros_map;
mod sectors;
mod svg;
mod wkt;

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

use crate::geometry::{CoordinateFault, check_point};

pub use index::WallIndex;
pub use model::{AnchorError, Model};
pub use movingai::GridMap;
pub use object::{Inside, Object, Wall};
pub use read::{SceneOptions, Unknown, read_scene, read_scene_with};
pub(crate) use sectors::{Sectors, by_angle};

/// Walls and their ends. Coordinates are planar f64 in the user's own unit and frame.
///
/// Equal endpoints are one vertex. Walls may share endpoints, touch, cross and overlap.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    vertices: Vec<DVec2>,
    walls: Vec<[u32; 2]>,
    objects: Vec<Object>,
    /// Of each wall: the number of its object, and whether its outline goes from its second end to its first.
    drawn: Vec<(u32, bool)>,
    anchor: Option<DVec2>,
    dropped: usize,
    y_down: bool,
    notes: Vec<String>,
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
        let walls = walls.into_iter().map(|ends| Wall { ends, object: 0, reversed: false });
        Scene::of(vec![Object::default()], walls)
    }

    /// The same for the walls of several objects, in any order. O(walls).
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    ///
    /// # Panics
    ///
    /// If a wall names an object that is not there.
    pub fn of(objects: Vec<Object>, walls: impl IntoIterator<Item = Wall>) -> Result<Self, CoordinateFault> {
        let count = objects.len();
        let mut scene = Scene { objects, ..Scene::default() };
        let mut numbers = HashMap::new();
        for Wall { ends, object, reversed } in walls {
            assert!((object as usize) < count, "object {object} of {count}");
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
            scene.drawn.push((object, reversed));
        }
        Ok(scene)
    }

    /// The same scene with the anchor that its file marks.
    #[must_use]
    pub fn with_anchor(mut self, anchor: DVec2) -> Self {
        self.anchor = Some(anchor);
        self
    }

    /// The same scene, looked at with y pointing down. Its coordinates stay as they are.
    #[must_use]
    pub fn with_y_down(mut self) -> Self {
        self.y_down = true;
        self
    }

    /// The same scene with other walls between its vertices in place of its own: each with the number of a wall of this scene
    /// for which it stands, and whether it goes the other way.
    pub(crate) fn with_walls(&self, walls: impl IntoIterator<Item = ([u32; 2], usize, bool)>) -> Self {
        let stands = |(ends, wall, turned): ([u32; 2], usize, bool)| {
            let (object, reversed) = self.drawn[wall];
            Wall { ends: ends.map(|v| self.vertices[v as usize]), object, reversed: reversed != turned }
        };
        let objects = self.objects.clone();
        let Scene { vertices, walls, objects, drawn, .. } =
            Scene::of(objects, walls.into_iter().map(stands)).expect("its vertices are sound");
        Scene { vertices, walls, objects, drawn, notes: self.notes.clone(), ..*self }
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

    /// What the scene's file draws, each thing once; some of them may have no walls.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The number of the object to which wall `wall` belongs.
    pub fn object_of(&self, wall: usize) -> usize {
        self.drawn[wall].0 as usize
    }

    /// The endpoints of wall `wall`, in the direction of its object's outline.
    pub fn outline(&self, wall: usize) -> [DVec2; 2] {
        let [u, v] = self.ends(wall);
        if self.drawn[wall].1 { [v, u] } else { [u, v] }
    }

    /// The anchor that the scene's file marks, if it marks one.
    pub fn anchor(&self) -> Option<DVec2> {
        self.anchor
    }

    /// Whether y points down when the scene is looked at as its file means it: pictures show it so. Nothing is computed
    /// otherwise for it, but what is written for others names left, right and clockwise as the picture shows them
    /// ([`Side::shown`](crate::rope::Side::shown)).
    pub fn y_down(&self) -> bool {
        self.y_down
    }

    /// How many walls of zero length were dropped.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// What the reader of the scene's file has to say to its user: what a unit is, what was passed over, how closely walls
    /// follow curves, and that degrees are no lengths. Sentences without a full stop.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }
}

/// Names with their counts, such as `3 image, 1 text`.
fn listed(counts: &BTreeMap<&str, usize>) -> String {
    let all: Vec<String> = counts.iter().map(|(name, count)| format!("{count} {name}")).collect();
    all.join(", ")
}

/// Whether `name` looks as if it was to mark the anchor, such as `Anchor`, `anchors` and `anchor 2`, but for the right one.
fn nearly_anchor(name: &str) -> bool {
    let name = name.trim();
    if !name.get(..6).is_some_and(|start| start.eq_ignore_ascii_case("anchor")) {
        return false;
    }
    let rest = name[6..].to_lowercase();
    let rest = rest.strip_prefix('s').unwrap_or(&rest);
    rest.starts_with("point") || !rest.starts_with(char::is_alphabetic)
}

/// The start of `text`: a line of some other file may be very long.
fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(40).collect();
    if start.len() < text.len() { start + "..." } else { start }
}
