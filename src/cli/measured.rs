//! What `tautline bench` and `tautline tradeoff` have in common: the scene of a measurement, a name or a file, and the
//! GPU.

use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::DVec2;
use tautline::engine::EngineKind;
use tautline::example::{BuiltIn, NameError};
use tautline::gpu::{AdapterChoice, Device};
use tautline::lab::bench::BenchScene;

use super::engine::{named, notes};
use super::failure::Failure;
use super::input::{FileArgs, read, tie, warn};
use super::parse::point;

/// What is to be known of a scene that is a file.
#[derive(Debug, clap::Args)]
pub(super) struct SceneArgs {
    /// Where the rope is tied in a scene file; overrides what the file says
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    anchor: Option<DVec2>,
    #[command(flatten)]
    file: FileArgs,
}

impl SceneArgs {
    /// The scene called `name`, or the one in that file.
    pub(super) fn open(&self, name: &str) -> Result<BenchScene, Failure> {
        let path = Path::new(name);
        match name.parse::<BuiltIn>() {
            Ok(_) if self.anchor.is_some() => {
                Err(Failure::input(anyhow!("--anchor goes with a scene file; {name} has an anchor of its own")))
            }
            Ok(scene) => Ok(BenchScene::BuiltIn(scene)),
            Err(error @ NameError::Walls { .. }) if !path.exists() => Err(Failure::input(error.into())),
            Err(error @ NameError::Unknown(_)) if !path.exists() && path.extension().is_none() => {
                Err(Failure::input(anyhow!("{error}; and there is no file of that name")))
            }
            Err(_) => {
                let model = tie(read(path, &self.file)?, self.anchor, name, "give --anchor X,Y")?;
                warn(name, &model);
                Ok(BenchScene::Own { name: name.to_owned(), model: Arc::new(model) })
            }
        }
    }
}

/// A number above 0, neither so large nor so small that no clock and no walk could make anything of it.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| (1e-9..=1e9).contains(x));
    number.ok_or_else(|| "give a number from 1e-9 to 1e9, such as 0.01".to_owned())
}

/// Takes the names of engines that are measured, in this order.
pub(super) fn measured(
    engines: impl IntoIterator<Item = &'static EngineKind>,
) -> impl TypedValueParser<Value = &'static EngineKind> {
    let mut once: Vec<&EngineKind> = Vec::new();
    for kind in engines {
        if !once.contains(&kind) {
            once.push(kind);
        }
    }
    PossibleValuesParser::new(once.into_iter().map(|kind| kind.name))
        .map(|name| EngineKind::named(&name).expect("only names of engines are taken"))
}

/// The GPU called `adapter`, else the best, where one is needed. One that nobody asked for may be missing.
pub(super) fn device(is_needed: bool, adapter: Option<&str>, is_asked_for: bool) -> Result<Option<Device>, Failure> {
    if !is_needed {
        return match adapter {
            Some(_) => Err(Failure::input(anyhow!("--adapter goes with --engine gpu"))),
            None => Ok(None),
        };
    }
    let choice = adapter.map_or(AdapterChoice::Best, named);
    match Device::open(&choice) {
        Ok(device) => {
            say!("engine: gpu on {}", device.summary());
            notes(&choice, &device).iter().for_each(|note| say!("{note}"));
            Ok(Some(device))
        }
        Err(error) if adapter.is_some() || is_asked_for => Err(error.into()),
        Err(error) => {
            say!("note: {error}");
            Ok(None)
        }
    }
}
