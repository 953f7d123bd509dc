//! What the user brings as the plane: walls, their ends, and the anchor.

mod cells;
mod curves;
mod description;
mod dxf;
mod extent;
mod flattened;
mod format;
mod geographic;
mod geojson;
mod grid;
#[cfg(feature = "read-ros")]
mod image;
mod index;
mod islands;
mod layers;
mod lines;
mod model;
mod movingai;
mod object;
mod obstacles;
mod options;
mod outlines;
mod pen;
mod pivot;
mod read;
#[cfg(feature = "read-ros")]
mod ros_map;
mod sectors;
#[cfg(feature = "read-svg")]
mod svg;
mod wkt;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;

use crate::geometry::{CoordinateFault, check_point};

pub use description::{Description, Label, Layer};
pub use format::{SceneFormat, alternatives};
pub use index::WallIndex;
pub(crate) use islands::{Island, all_islands, roots};
pub use model::{AnchorError, Model};
pub use movingai::GridMap;
pub(crate) use object::MEMBER;
pub use object::{Inside, Object, Wall};
pub use obstacles::{Centre, UnknownObstacle};
pub use options::{Ros, SceneOptions, Unknown};
pub use pivot::Pivot;
pub use read::{map_image, read_scene, read_scene_with};
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

    /// The same scene with other walls between its vertices in place of its own: each with the number of a wall of this
    /// scene for which it stands, and whether it goes the other way.
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

    /// The lowest and highest x and y of all walls; `None` if there are none. O(walls).
    pub fn bounds(&self) -> Option<(DVec2, DVec2)> {
        let &first = self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
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

    /// For each layer that an object lies in, in the order of the alphabet: how many walls its objects have.
    pub fn layers(&self) -> BTreeMap<&str, usize> {
        let mut layers = BTreeMap::new();
        let mut walls = vec![0; self.objects.len()];
        self.drawn.iter().for_each(|&(object, _)| walls[object as usize] += 1);
        for (object, walls) in self.objects.iter().zip(walls) {
            // A layer may be named twice where groups lie in each other.
            let names: BTreeSet<&str> = object.layers.iter().map(String::as_str).collect();
            names.into_iter().for_each(|name| *layers.entry(name).or_default() += walls);
        }
        layers
    }

    /// The label of each vertex: that of the first wall that names it, if that wall's object has one. Empty if no
    /// object with walls has a label. O(walls).
    pub fn labels(&self) -> Vec<Option<&str>> {
        let label = |wall: usize| self.objects[self.object_of(wall)].label.as_deref();
        if (0..self.walls.len()).all(|wall| label(wall).is_none()) {
            return Vec::new();
        }
        let mut labels = Vec::with_capacity(self.vertices.len());
        for (wall, &ends) in self.walls.iter().enumerate() {
            // Vertices are numbered in the order in which walls name them.
            for end in ends {
                if end as usize == labels.len() {
                    labels.push(label(wall));
                }
            }
        }
        labels
    }

    /// The same scene with the walls only of the objects for which `is_kept` holds.
    fn of_objects(&self, is_kept: impl Fn(&Object) -> bool) -> Self {
        let mut numbers = vec![None; self.objects.len()];
        let mut objects = Vec::new();
        for (number, object) in numbers.iter_mut().zip(&self.objects).filter(|(_, object)| is_kept(object)) {
            *number = Some(objects.len() as u32);
            objects.push(object.clone());
        }
        let kept = self.drawn.iter().enumerate().filter_map(|(wall, &(object, reversed))| {
            Some(Wall { ends: self.ends(wall), object: numbers[object as usize]?, reversed })
        });
        let Scene { vertices, walls, objects, drawn, .. } = Scene::of(objects, kept).expect("its vertices are sound");
        Scene { vertices, walls, objects, drawn, notes: self.notes.clone(), ..*self }
    }

    /// Whether the outline of wall `wall`'s object goes from its second end to its first.
    pub(crate) fn is_reversed(&self, wall: usize) -> bool {
        self.drawn[wall].1
    }

    /// Whether all walls are thin, in no layer and without labels.
    pub fn is_bare(&self) -> bool {
        (0..self.walls.len()).all(|wall| self.objects[self.object_of(wall)] == Object::default())
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

    /// What the reader of the scene's file has to say to its user: what a unit is, what was passed over, how closely
    /// walls follow curves, and that degrees are no lengths. Sentences without a full stop.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What a unit is called, such as `mm`, where the scene's file says that it is one of those; of a drawing without a
    /// size, `px`.
    ///
    /// ```
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("a.svg");
    /// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60"/>"#;
    /// std::fs::write(&path, svg)?;
    /// assert_eq!(tautline::scene::read_scene(&path)?.unit(), Some("mm"));
    /// assert_eq!(tautline::example::floor_plan().unit(), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unit(&self) -> Option<&str> {
        let unit = self.notes.iter().find_map(|note| note.strip_prefix("a unit is "))?;
        match unit.strip_prefix("1 ") {
            Some(unit) => unit.split([';', '(']).next().map(str::trim),
            None => unit.starts_with("a pixel").then_some("px"),
        }
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

/// Whether `name` looks as if it was to mark the anchor, such as `Anchor`, `anchors` and `anchor 2`, but for the right
/// one.
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
