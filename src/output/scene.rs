//! Scenes as GeoJSON and as well-known text.

use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use glam::DVec2;
use serde_json::json;

use super::text::number;
use super::{WholeFile, WriteError};
use crate::read_error::extension;
use crate::scene::{MEMBER, Scene};

/// A format in which scenes are written.
pub struct WrittenScene {
    extensions: &'static [&'static str],
    lacks: &'static str,
    write: fn(&mut WholeFile, &Scene) -> io::Result<()>,
}

/// All formats in which scenes are written.
const FORMATS: [WrittenScene; 2] = [
    WrittenScene { extensions: &[".geojson", ".json"], lacks: "", write: geojson },
    WrittenScene {
        extensions: &[".wkt"],
        lacks: "well-known text has no place for labels, layers and what is solid; GeoJSON has",
        write: wkt,
    },
];

impl WrittenScene {
    /// All formats in which scenes are written.
    pub fn all() -> &'static [WrittenScene] {
        &FORMATS
    }

    /// The format that a file's extension names, in whatever case.
    pub fn of(path: &Path) -> Option<&'static WrittenScene> {
        let extension = format!(".{}", extension(path));
        FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }

    /// The extensions of its files, each with its dot and in lower case.
    pub fn extensions(&self) -> &'static [&'static str] {
        self.extensions
    }

    /// What it has no place for of a scene that is not [bare](Scene::is_bare), as a sentence without a full stop; empty
    /// if it keeps all.
    pub fn lacks(&self) -> &'static str {
        self.lacks
    }
}

/// Writes `scene` to `path`: `.geojson` or `.json` as GeoJSON, `.wkt` as well-known text.
///
/// Reading the file gives the same walls in the same order and direction, the same vertex numbers and the same anchor,
/// bit for bit. GeoJSON keeps whether y points down, too, as a member of its own, and of each object its label, its
/// layers and what of it is solid: in the member `tautline` of its features. Walls that follow each other are one line
/// string. What the scene's reader noted is not written. The file is whole or not there at all.
///
/// # Errors
///
/// Another extension, a path that cannot be written to, and what the operating system refuses.
///
/// ```
/// use tautline::output::write_scene;
/// use tautline::scene::{Scene, read_scene};
/// let scene = Scene::new([[[0.1, 0.0].into(), [1.0, 1e-7].into()]])?.with_anchor([0.5, -1.0].into());
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("scene.wkt");
/// write_scene(&path, &scene)?;
/// let same = read_scene(&path)?;
/// assert_eq!((same.ends(0), same.anchor()), (scene.ends(0), scene.anchor()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_scene(path: &Path, scene: &Scene) -> Result<(), WriteError> {
    super::check_place(path)?;
    let Some(format) = WrittenScene::of(path) else {
        let extensions = FORMATS.iter().flat_map(|format| format.extensions).copied().collect();
        return Err(WriteError::SceneExtension { path: path.into(), extensions });
    };
    let mut file = WholeFile::create(path)?;
    (format.write)(&mut file, scene).map_err(|cause| file.error(cause))?;
    file.finish()
}

/// These walls as few lines: each goes on as long as the next wall begins where the last one ends.
fn lines(scene: &Scene, walls: Range<usize>) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    let mut end = None;
    for wall in walls {
        let [from, to] = scene.walls()[wall];
        let [a, b] = scene.ends(wall);
        match lines.last_mut() {
            Some(line) if end == Some(from) => line.push(b),
            _ => lines.push(vec![a, b]),
        }
        end = Some(to);
    }
    lines
}

fn geojson(out: &mut WholeFile, scene: &Scene) -> io::Result<()> {
    let y = if scene.y_down() { "\"y\":\"down\"," } else { "" };
    writeln!(out, "{{\"type\":\"FeatureCollection\",{y}\"features\":[")?;
    let is_bare = scene.is_bare();
    let mut parts = parts(scene, is_bare);
    if parts.is_empty() {
        parts.push(0..0);
    }
    for (i, walls) in parts.into_iter().enumerate() {
        out.write_all(if i == 0 { b"" } else { b",\n" })?;
        part(out, scene, walls, is_bare)?;
    }
    if let Some(anchor) = scene.anchor() {
        out.write_all(b",\n{\"type\":\"Feature\",\"properties\":{\"role\":\"anchor\"},")?;
        out.write_all(b"\"geometry\":{\"type\":\"Point\",\"coordinates\":[")?;
        point(out, anchor, b",")?;
        out.write_all(b"]}}")?;
    }
    out.write_all(b"\n]}\n")
}

/// The walls, cut where another object begins or the direction of its outline changes.
fn parts(scene: &Scene, is_bare: bool) -> Vec<Range<usize>> {
    let mut parts: Vec<Range<usize>> = Vec::new();
    let of = |wall: usize| (!is_bare).then(|| (scene.object_of(wall), scene.is_reversed(wall)));
    for wall in 0..scene.walls().len() {
        match parts.last_mut() {
            Some(part) if of(part.start) == of(wall) => part.end = wall + 1,
            _ => parts.push(wall..wall + 1),
        }
    }
    parts
}

/// A feature of walls that are an object or a part of one.
fn part(out: &mut WholeFile, scene: &Scene, walls: Range<usize>, is_bare: bool) -> io::Result<()> {
    let mut properties = serde_json::Map::new();
    let mut member = String::new();
    if !is_bare {
        let number = scene.object_of(walls.start);
        let object = &scene.objects()[number];
        properties.extend(object.label.iter().map(|label| ("label".to_owned(), json!(label))));
        properties.extend(object.layers.first().map(|layer| ("layer".to_owned(), json!(layer))));
        let kept = json!({
            "object": number, "inside": object.inside.name(), "reversed": scene.is_reversed(walls.start),
            "layers": object.layers,
        });
        member = format!("\"{MEMBER}\":{kept},");
    }
    write!(out, "{{\"type\":\"Feature\",{member}\"properties\":")?;
    serde_json::to_writer(&mut *out, &properties)?;
    out.write_all(b",\"geometry\":{\"type\":\"MultiLineString\",\"coordinates\":[")?;
    for (i, line) in lines(scene, walls).iter().enumerate() {
        out.write_all(if i == 0 { b"\n[" } else { b",\n[" })?;
        for (k, p) in line.iter().enumerate() {
            out.write_all(if k == 0 { b"[" } else { b",[" })?;
            point(out, *p, b",")?;
            out.write_all(b"]")?;
        }
        out.write_all(b"]")?;
    }
    out.write_all(b"]}}")
}

fn wkt(out: &mut WholeFile, scene: &Scene) -> io::Result<()> {
    for line in lines(scene, 0..scene.walls().len()) {
        for (i, p) in line.iter().enumerate() {
            out.write_all(if i == 0 { b"LINESTRING (" } else { b", " })?;
            point(out, *p, b" ")?;
        }
        out.write_all(b")\n")?;
    }
    if let Some(anchor) = scene.anchor() {
        out.write_all(b"POINT (")?;
        point(out, anchor, b" ")?;
        out.write_all(b")\n")?;
    } else if scene.walls().is_empty() {
        // A file without any geometry would be none.
        out.write_all(b"GEOMETRYCOLLECTION EMPTY\n")?;
    }
    Ok(())
}

fn point(out: &mut WholeFile, p: DVec2, between: &[u8]) -> io::Result<()> {
    number(out, p.x)?;
    out.write_all(between)?;
    number(out, p.y)
}
