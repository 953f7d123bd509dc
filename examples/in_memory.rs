//! A scene and traces made in memory, evaluated on all cores:
//!
//!     cargo run --release --example in_memory

use std::error::Error;
use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Cpu, Engine, Job};
use tautline::scene::{Model, Scene};
use tautline::trace::{Trace, settle};

fn main() -> Result<(), Box<dyn Error>> {
    // A square pillar, and the anchor west of it.
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from);
    let walls = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]);
    let model = Arc::new(Model::new(Scene::new(walls)?, Some(DVec2::new(-3.0, 0.0)))?);

    // Trace k goes k quarters of a turn about it, counter-clockwise, as a circle of radius 2.
    let point = |i: usize| DVec2::from_angle(std::f64::consts::PI * (1.0 + i as f64 / 16.0)) * 2.0;
    let traces: Vec<_> = (0..=8).map(|k| Trace { id: k as u64, points: (0..=8 * k).map(point).collect() }).collect();
    let settled: Vec<_> = traces.iter().map(|trace| settle(&model, trace)).collect();
    if let Some(violation) = settled.iter().find_map(|trace| trace.violation()) {
        return Err((*violation).into());
    }

    for record in Cpu::new(model.clone()).evaluate(&settled, &Job::new())? {
        let corners: Vec<String> = record.wraps.iter().map(|(at, _)| format!("({}, {})", at.x, at.y)).collect();
        println!("{} quarters: {:.3} long, round {}", record.trace, record.length, corners.join(" "));
    }
    Ok(())
}
