//! Reads a scene from a file, in the format that its extension names.

use std::path::{Path, PathBuf};

use super::format::SceneFormat;
#[cfg(feature = "read-ros")]
use super::ros_map;
#[cfg(feature = "read-svg")]
use super::svg;
use super::{Scene, SceneOptions, dxf, geojson, layers, movingai, wkt};
use crate::read_error::{ReadError, extension};

/// All formats in which scenes are read.
const FORMATS: &[SceneFormat] = &[
    geojson::FORMAT,
    wkt::FORMAT,
    #[cfg(feature = "read-svg")]
    svg::FORMAT,
    dxf::FORMAT,
    movingai::FORMAT,
    #[cfg(feature = "read-ros")]
    ros_map::FORMAT,
];

impl SceneFormat {
    /// All formats in which scenes are read.
    ///
    /// ```
    /// use tautline::scene::SceneFormat;
    /// let extensions: Vec<&str> = SceneFormat::all().iter().flat_map(|format| format.extensions()).copied().collect();
    /// assert_eq!(extensions, [".geojson", ".json", ".wkt", ".svg", ".dxf", ".map", ".yaml", ".yml"]);
    /// ```
    pub fn all() -> &'static [SceneFormat] {
        FORMATS
    }

    /// The format that a file's extension names, in whatever case.
    pub fn of(path: &Path) -> Option<&'static SceneFormat> {
        let extension = format!(".{}", extension(path));
        FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }
}

/// Reads the scene in `path` with the usual [`SceneOptions`].
///
/// # Errors
///
/// As [`read_scene_with`].
pub fn read_scene(path: &Path) -> Result<Scene, ReadError> {
    read_scene_with(path, &SceneOptions::default())
}

/// Reads the scene in `path`, in the format that its extension names, one of [`SceneFormat::all`].
///
/// The extension's case does not matter. Coordinates are taken as planar, in the file's own unit. A scene may be
/// without walls and without an anchor. Time and memory are linear in the file, but for what a drawing uses many times:
/// that is bounded.
///
/// # Errors
///
/// A file that cannot be opened, an extension of another format, contents that are not a scene, with their place, and a
/// layer that is not there.
///
/// ```
/// use tautline::scene::{SceneOptions, read_scene_with};
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("room.svg");
/// std::fs::write(&path, r#"<svg xmlns="http://www.w3.org/2000/svg"><circle id="anchor" cx="2" cy="1" r=".1"/>
///     <rect width="4" height="3"/><path d="M1,0 Q1,2 3,2"/></svg>"#)?;
/// let scene = read_scene_with(&path, &SceneOptions { flatten: Some(0.1), ..Default::default() })?;
/// assert_eq!((scene.walls().len(), scene.anchor()), (4 + 3, Some([2.0, 1.0].into())));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_scene_with(path: &Path, options: &SceneOptions) -> Result<Scene, ReadError> {
    let Some(format) = SceneFormat::of(path) else {
        let extensions = FORMATS.iter().flat_map(|format| format.extensions).copied().collect();
        return Err(ReadError::Extension { path: path.into(), what: "scenes", extensions });
    };
    layers::choose((format.read)(path, options)?, options).map_err(|fault| fault.in_file(path))
}

/// The image that a map of ROS's `map_server` names; `None` of other files, of maps that cannot be read, and in a build
/// without the feature `read-ros`.
#[cfg(feature = "read-ros")]
pub fn map_image(path: &Path) -> Option<PathBuf> {
    ros_map::image_of(path)
}

/// `None`: this build reads no such maps.
#[cfg(not(feature = "read-ros"))]
pub fn map_image(_: &Path) -> Option<PathBuf> {
    None
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
            let rest = "the extension does not name a format; scenes are read from .geojson, .json, .wkt, .svg, .dxf, \
                .map, .yaml, .yml";
            assert_eq!(e, format!("{name}: {rest}"));
        }
    }

    #[test]
    fn the_page_of_scenes_names_every_extension() {
        let page = include_str!("../../docs/scenes.md");
        for extension in SceneFormat::all().iter().flat_map(SceneFormat::extensions) {
            assert!(page.contains(&format!("`{extension}`")), "docs/scenes.md says nothing of {extension}");
        }
    }
}
