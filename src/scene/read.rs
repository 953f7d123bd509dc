//! Reads a scene from a file, in the format that its extension names.

use std::path::Path;

use super::{Scene, geojson, movingai};
use crate::read_error::{ReadError, extension, read_text};

/// Reads the scene in `path`: `.geojson` or `.json` as GeoJSON, `.map` as a MovingAI grid map.
///
/// The extension's case does not matter. Coordinates are taken as planar, in the file's own unit. A scene may be
/// without walls and without an anchor.
///
/// # Errors
///
/// A file that cannot be opened, an extension of another format, and contents that are not a scene, with their place.
pub fn read_scene(path: &Path) -> Result<Scene, ReadError> {
    let parse = match extension(path).as_str() {
        "geojson" | "json" => geojson::parse,
        "map" => movingai::parse,
        _ => {
            let extensions = &[".geojson", ".json", ".map"];
            return Err(ReadError::Extension { path: path.into(), what: "scenes", extensions });
        }
    };
    parse(&read_text(path)?).map_err(|fault| fault.in_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let line = r#"{"type":"LineString","coordinates":[[0,0],[1,0]]}"#;
        for name in ["a.geojson", "a.JSON"] {
            assert_eq!(read_scene(&write(name, line)).unwrap().walls().len(), 1);
        }
        let map = write("a.Map", "type octile\nheight 1\nwidth 2\nmap\n.@\n");
        assert_eq!(read_scene(&map).unwrap().walls().len(), 1);
        let e = read_scene(&write("b.map", line)).unwrap_err().to_string();
        assert!(e.contains("b.map: line 1: "), "{e}");
    }

    #[test]
    fn other_extensions_are_told_what_is_read() {
        for name in ["scene.txt", "scene"] {
            let e = read_scene(Path::new(name)).unwrap_err().to_string();
            let rest = "the extension does not name a format; scenes are read from .geojson, .json, .map";
            assert_eq!(e, format!("{name}: {rest}"));
        }
    }
}
