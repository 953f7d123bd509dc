//! Scenes as GeoJSON and as well-known text.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec2;

use super::text::number;
use super::{WholeFile, WriteError};
use crate::read_error::extension;
use crate::scene::Scene;

/// Writes `scene` to `path`: `.geojson` or `.json` as GeoJSON, `.wkt` as well-known text.
///
/// Reading the file gives the same walls in the same order and direction, the same vertex numbers and the same anchor, bit
/// for bit. GeoJSON keeps whether y points down, too, as a member of its own. Walls that follow each other are one line string. What the scene's reader noted is not written. The file is
/// whole or not there at all.
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
    let write = match extension(path).as_str() {
        "geojson" | "json" => geojson,
        "wkt" => wkt,
        _ => return Err(WriteError::SceneExtension { path: path.into() }),
    };
    let mut file = WholeFile::create(path)?;
    write(&mut file, scene).map_err(|cause| file.error(cause))?;
    file.finish()
}

/// The walls as few lines: each goes on as long as the next wall begins where the last one ends.
fn lines(scene: &Scene) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    let mut end = None;
    for wall in 0..scene.walls().len() {
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
    out.write_all(
        b"{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"MultiLineString\",\"coordinates\":[",
    )?;
    for (i, line) in lines(scene).iter().enumerate() {
        out.write_all(if i == 0 { b"\n[" } else { b",\n[" })?;
        for (k, p) in line.iter().enumerate() {
            out.write_all(if k == 0 { b"[" } else { b",[" })?;
            point(out, *p, b",")?;
            out.write_all(b"]")?;
        }
        out.write_all(b"]")?;
    }
    out.write_all(b"]}}")?;
    if let Some(anchor) = scene.anchor() {
        out.write_all(b",\n{\"type\":\"Feature\",\"properties\":{\"role\":\"anchor\"},")?;
        out.write_all(b"\"geometry\":{\"type\":\"Point\",\"coordinates\":[")?;
        point(out, anchor, b",")?;
        out.write_all(b"]}}")?;
    }
    out.write_all(b"\n]}\n")
}

fn wkt(out: &mut WholeFile, scene: &Scene) -> io::Result<()> {
    for line in lines(scene) {
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
