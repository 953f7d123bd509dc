//! The built-in scenes and their names.

use std::fmt;
use std::str::FromStr;

use super::{floor_plan, lattice_walls, random_walls};
use crate::scene::Scene;

/// The most walls that a built-in scene may have; [`NameError`] says so.
const MOST_WALLS: u32 = 1_000_000;

/// A scene that needs no file.
///
/// ```
/// use tautline::example::BuiltIn;
/// assert_eq!("random-500".parse(), Ok(BuiltIn::Random(500)));
/// assert_eq!(BuiltIn::Random(500).scene(1).walls().len(), 500);
/// assert!("random-0".parse::<BuiltIn>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BuiltIn {
    /// `random-M`: M disjoint [random walls](random_walls()).
    Random(u32),
    /// `lattice-M`: M [walls on whole numbers](lattice_walls()).
    Lattice(u32),
    /// `rooms`: the [floor plan](floor_plan()).
    Rooms,
}

impl BuiltIn {
    /// The scene with its anchor. `seed` decides where random walls lie.
    pub fn scene(self, seed: u64) -> Scene {
        match self {
            BuiltIn::Random(walls) => random_walls(walls as usize, seed),
            BuiltIn::Lattice(walls) => lattice_walls(walls as usize, seed),
            BuiltIn::Rooms => floor_plan(),
        }
    }

    /// The length of a step, about, that suits the scene, in the scene's unit.
    pub fn step(self) -> f64 {
        match self {
            BuiltIn::Random(_) => 0.01,
            BuiltIn::Lattice(_) => 0.1,
            BuiltIn::Rooms => 0.25,
        }
    }
}

impl fmt::Display for BuiltIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BuiltIn::Random(walls) => write!(f, "random-{walls}"),
            BuiltIn::Lattice(walls) => write!(f, "lattice-{walls}"),
            BuiltIn::Rooms => f.write_str("rooms"),
        }
    }
}

/// Why a name names no built-in scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NameError {
    /// It is none of them.
    #[error("no built-in scene is called {0:?}; there are random-M and lattice-M, with M walls, and rooms")]
    Unknown(String),
    /// It names a kind of scene, but no number of walls for it.
    #[error("{name}: {number:?} is no number of walls; give a whole number from 1 to 1,000,000, such as {kind}-500")]
    Walls {
        /// The whole name.
        name: String,
        /// `random` or `lattice`.
        kind: &'static str,
        /// What stands where the number should.
        number: String,
    },
}

impl FromStr for BuiltIn {
    type Err = NameError;

    fn from_str(name: &str) -> Result<Self, NameError> {
        if name == "rooms" {
            return Ok(BuiltIn::Rooms);
        }
        let random: (_, fn(u32) -> BuiltIn) = ("random", BuiltIn::Random);
        for (kind, make) in [random, ("lattice", BuiltIn::Lattice)] {
            let Some(number) = name.strip_prefix(kind).and_then(|rest| rest.strip_prefix('-')) else { continue };
            // `parse` would take a plus sign.
            let walls = number.parse().ok().filter(|w| (1..=MOST_WALLS).contains(w) && !number.starts_with('+'));
            let wrong = || NameError::Walls { name: name.to_owned(), kind, number: number.to_owned() };
            return walls.map(make).ok_or_else(wrong);
        }
        Err(NameError::Unknown(name.to_owned()))
    }
}
