//! Readers of scenes: what they take can be written down, read back, tied a rope in and dragged through.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use tautline::geometry::check_point;
use tautline::output::write_scene;
use tautline::scene::{Model, Ros, Scene, SceneOptions, Unknown, read_scene, read_scene_with};
use tautline::trace::{Trace, settle};

use super::engines::agree;

/// With more walls a scene is not dragged through, and with many more not written down: that takes time and finds
/// nothing that smaller ones do not.
const DRAGGED_MAX: usize = 200;
const WRITTEN_MAX: usize = 20_000;

/// Reads `input` as the file `name`.
pub(super) fn read(name: &str, input: &[u8], folder: &Path) {
    fs::write(folder.join(name), input).expect("the folder can be written to");
    let other = SceneOptions { flatten: Some(0.01), unknown: Unknown::Blocked, ros: Ros::One, ..Default::default() };
    for options in [SceneOptions::default(), other] {
        match read_scene_with(&folder.join(name), &options) {
            Ok(scene) => survives(&scene, folder),
            Err(error) => assert!(error.to_string().contains(folder.to_str().unwrap()), "{error} names no file"),
        }
    }
}

/// Reads `input` as the two files of a map: the text up to the first zero, then the image, which the text should call
/// `image`.
pub(super) fn read_ros_map(input: &[u8], folder: &Path) {
    let text = input.split(|&b| b == 0).next().unwrap_or_default();
    let image = input.get(text.len() + 1..).unwrap_or_default();
    fs::write(folder.join("image"), image).expect("the folder can be written to");
    read("map.yaml", text, folder);
}

fn survives(scene: &Scene, folder: &Path) {
    if scene.walls().len() > WRITTEN_MAX {
        return;
    }
    for name in ["again.geojson", "again.wkt"] {
        let path = folder.join(name);
        write_scene(&path, scene).expect("what was read can be written");
        let again = read_scene(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(same(scene, &again), "{name} differs: {:?}", fs::read_to_string(&path));
    }
    let anchor = scene.anchor().or(scene.vertices().first().copied());
    let Ok(model) = Model::new(scene.clone(), anchor) else { return };
    if scene.walls().len() <= DRAGGED_MAX {
        drag(&Arc::new(model));
    }
}

/// Through the corners of the scene, and over some of its vertices.
fn drag(model: &Arc<Model>) {
    let (low, high) = model.bounds();
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let around = corners.iter().map(|&p| p * 2.0 - model.anchor()).filter(|&p| check_point(p).is_ok());
    let over = model.vertices().iter().copied().take(20);
    let points: Vec<DVec2> = std::iter::once(model.anchor()).chain(around).chain(over).collect();
    agree(model, &[settle(model, &Trace { id: 0, points })]);
}

/// Whether the scenes have the same vertices, walls and anchor, bit for bit.
pub(crate) fn same(a: &Scene, b: &Scene) -> bool {
    let bits = |s: &Scene| s.vertices().iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
    let anchor = |s: &Scene| s.anchor().map(|p| p.to_array().map(f64::to_bits));
    bits(a) == bits(b) && a.walls() == b.walls() && anchor(a) == anchor(b)
}
