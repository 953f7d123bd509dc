//! The scene of a measurement: a name or a file.

use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use glam::DVec2;
use tautline::example::{BuiltIn, NameError};
use tautline::lab::bench::BenchScene;
use tautline::scene::{AnchorError, Model, read_scene_with};

use super::failure::Failure;
use super::input::{FileArgs, note, warn};

/// The scene called `name`, or the one in that file.
pub(super) fn open(name: &str, anchor: Option<DVec2>, file: &FileArgs) -> Result<BenchScene, Failure> {
    let path = Path::new(name);
    match name.parse::<BuiltIn>() {
        Ok(_) if anchor.is_some() => {
            Err(Failure::input(anyhow!("--anchor goes with a scene file; {name} has an anchor of its own")))
        }
        Ok(scene) => Ok(BenchScene::BuiltIn(scene)),
        Err(error @ NameError::Walls { .. }) if !path.exists() => Err(Failure::input(error.into())),
        Err(error @ NameError::Unknown(_)) if !path.exists() && path.extension().is_none() => {
            Err(Failure::input(anyhow!("{error}; and there is no file of that name")))
        }
        Err(_) => {
            let scene = read_scene_with(path, &file.options())?;
            note(path, &scene);
            let model = Model::new(scene, anchor).map_err(|error| match error {
                AnchorError::Missing => Failure::input(anyhow!("{name}: no anchor; give --anchor X,Y")),
                other => Failure::input(anyhow!("{name}: {other}")),
            })?;
            warn(name, &model);
            Ok(BenchScene::Own { name: name.to_owned(), model: Arc::new(model) })
        }
    }
}
