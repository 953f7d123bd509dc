//! How long a tether does a wandering robot need? A study, run from a program:
//!
//!     cargo run --release --example tether_study

use std::convert::Infallible;
use std::error::Error;
use std::path::Path;
use std::sync::Mutex;

use tautline::engine::{Cpu, Engine, Job};
use tautline::study::{Plan, Shard, State, Study, run};

/// What `tautline study run` reads from a file. All that is not said has a value of its own.
const PLAN: &str = r#"
[scene]
built_in = "rooms"

[walk]
kind = "persistent"
step = 0.25
steps = 400

[run]
traces = 4000
block = 500
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let study = Study::open(Plan::parse(PLAN)?, Path::new("."))?;
    // One for each anchor; here there is but one.
    let mut engines: Vec<Box<dyn Engine>> = study.models().iter().map(|m| Box::new(Cpu::new(m.clone())) as _).collect();
    let state = Mutex::new(State::new(&study, Shard::WHOLE));
    run(&study, &mut engines, &state, &Job::new(), |state, _, _| {
        eprintln!("{} blocks are done", state.done());
        Ok::<(), Infallible>(())
    })?;

    let summary = state.into_inner()?.summary(&study);
    let longest = summary.scalars.iter().find(|s| s.name == "max_length").ok_or("lengths are always told")?;
    println!("the mean of the greatest length: {:.2}", longest.mean.value);
    for quantile in &longest.quantiles {
        println!("{:>4} % of the walks need no more than {:.1}", 100.0 * quantile.share, quantile.value.value);
    }
    Ok(())
}
