//! Ropes and studies' answers to look at, as SVG, PNG and pages.
//!
//! A [`Drawing`] shows traces in a scene and their ropes. The [gallery](Situation) has small ones of all that can
//! happen.
//!
//! The pictures of a study are made of a [`Summary`] and the [`Scene`] it is about, and of nothing else; [`page()`] has
//! all of them. Each stands on its own white ground, with names of what it shows and the unit.
//!
//! The same things give the same bytes. Colours stay apart for colour-blind eyes. Where a scene has y point down, so
//! have its pictures, and left and right are as one sees them.

mod chart;
mod colour;
mod drawing;
mod gallery;
mod histogram;
mod label;
mod map;
mod page;
mod picture_error;
mod plane;
#[cfg(feature = "png")]
mod raster;
#[cfg(not(feature = "png"))]
#[path = "no_raster.rs"]
mod raster;
mod ropes;
mod survival;
mod svg;
mod sweep;
mod sweep_axis;
mod tables;
mod tether;
mod ticks;
mod tradeoff;
mod unit;

use crate::scene::Scene;
use crate::study::{Summary, quantity};

pub use drawing::{DrawError, Drawing, MOST_FRAMES, Part, Theme};
pub use gallery::Situation;
pub use histogram::histogram;
pub use map::{length_map, map};
pub use page::page;
pub use picture_error::PictureError;
pub use raster::png;
pub use ropes::ropes;
pub use survival::{held_back, survival};
pub use sweep::sweep;
pub use tether::{sentence, tether};
pub use tradeoff::tradeoff;

/// All pictures that there are of a study: for each the name of its file without an extension, its title, and the SVG.
pub fn all(summary: &Summary, scene: &Scene) -> Vec<(String, String, String)> {
    let first = [
        ("held-back", "How many walks the tether has not held back yet, step by step", held_back(summary, scene)),
        ("tether", "How many walks a tether holds", tether(summary, scene)),
    ];
    let of = |(stem, title, svg): (&str, &str, Option<String>)| Some((stem.to_owned(), title.to_owned(), svg?));
    let mut all: Vec<(String, String, String)> = first.into_iter().filter_map(of).collect();
    for h in &summary.histograms {
        let title = match h.name.as_str() {
            "length" => "How long the ropes are at the end".to_string(),
            "max_length" => "How long the ropes are at their longest".to_string(),
            _ => format!("Histogram of the {}", quantity(&h.name)),
        };
        all.push((format!("histogram-{}", h.name.replace('_', "-")), title, histogram(summary, scene, &h.name)));
    }
    let others = [
        ("survival", "How many ropes stay short, step by step", survival(summary, scene)),
        ("map", "Where ropes touch walls", map(summary, scene)),
        ("length-map", "How long the rope is, by where its free end is", length_map(summary, scene)),
        ("ropes", "The commonest ropes at the end", ropes(summary, scene)),
    ];
    all.extend(others.into_iter().filter_map(of));
    all
}
