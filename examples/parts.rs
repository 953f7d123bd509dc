//! Makes very many parts of one study, to see what merging them costs:
//!
//!     cargo run --release --example parts -- 10000 DIR
//!     /usr/bin/time -v tautline study merge DIR/part-* --out all

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use tautline::engine::{Cpu, Engine, Job};
use tautline::session::{Folder, Session};
use tautline::study::{Plan, PlanError, Shard, State, Study, run};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let parts: u32 = args.next().ok_or("say how many parts")?.parse()?;
    let room = PathBuf::from(args.next().ok_or("say in which folder")?);
    let plan = format!(
        "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
         [run]\ntraces = {}\nblock = 20\n[outputs]\npictures = false\n",
        u64::from(parts) * 20
    );
    let study = Arc::new(Study::open(Plan::parse(&plan)?, ".".as_ref())?);
    let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(Cpu::new(study.models()[0].clone()))];
    for part in 0..parts {
        let folder = room.join(format!("part-{part}"));
        if folder.join("state.bin").exists() {
            continue;
        }
        let shard = Shard::new(part, parts).expect("it is one of them");
        if part == 0 {
            // The others are of the same study.
            let folder = Arc::new(Folder::make(&folder)?);
            Session::begin(folder, study.clone(), ".".as_ref(), shard)?;
        }
        let state = Mutex::new(State::new(&study, shard));
        run(&study, &mut engines, &state, &Job::new(), |_, _, _| Ok::<(), PlanError>(()))?;
        std::fs::create_dir_all(&folder)?;
        state.into_inner().expect("nobody panicked").save(&folder.join("state.bin"))?;
    }
    println!("{parts} parts of 20 traces each");
    Ok(())
}
