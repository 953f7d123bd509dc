//! The rope after each step, from a trace's events:
//!
//!     cargo run --release --example rope_at_every_step

use std::error::Error;
use std::sync::Arc;

use tautline::engine::{Engine, Job, Reference};
use tautline::example::{BuiltIn, Walker, walks};
use tautline::rope::replay;
use tautline::scene::Model;
use tautline::trace::settle;

fn main() -> Result<(), Box<dyn Error>> {
    let model = Arc::new(Model::new(BuiltIn::Rooms.scene(1), None)?);
    let trace = walks(&model, Walker { step: 0.5, steps: 60, seed: 3 }, 1).remove(0);
    let record = Reference::new(model.clone()).evaluate(&[settle(&model, &trace)], &Job::new())?.remove(0);

    println!("step      x      y  length  contacts");
    replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |step, rope| {
        let end = trace.points[step];
        let contacts: Vec<u32> = rope.taut(end).iter().map(|contact| contact.vertex).collect();
        println!("{step:>4} {:>6.2} {:>6.2} {:>7.3}  {contacts:?}", end.x, end.y, rope.length(end));
    });
    Ok(())
}
