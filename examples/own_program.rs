//! All that `tautline eval` and `tautline study run` do, from a program of one's own:
//!
//!     cargo run --release --example own_program -- eval plan.geojson drag.csv ropes.csv events.csv
//!     cargo run --release --example own_program -- study study.toml folder

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use tautline::engine::{Job, Options, open_best};
use tautline::scene::{Model, read_scene};
use tautline::session::{Computed, Folder, Session};
use tautline::stream::{Batches, Files, OnViolation, Source, evaluate};
use tautline::study::{Plan, Shard, Study};
use tautline::trace::TraceReader;
use tautline::trade::Terms;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(|arg| Path::new(arg.as_str())).collect::<Vec<_>>()[..] {
        [what, scene, traces, out, events] if what == "eval" => {
            let model = Arc::new(Model::new(read_scene(scene)?, None)?);
            let mut engine = open_best(model.clone(), &Options::default())?.engine;
            let source = Source::File(TraceReader::open(traces)?);
            let batches = Batches::start(source, Terms::exact(model.clone()), engine.batch());
            let files = Files::new(Some(out), Some(events), &model, Vec::new());
            evaluate(batches, &mut *engine, files, OnViolation::Error, &Job::new(), |stage| {
                println!("{} more traces are evaluated", stage.records().len());
            })?;
        }
        [what, file, out] if what == "study" => {
            let base = file.parent().filter(|base| *base != Path::new("")).unwrap_or(Path::new("."));
            let study = Arc::new(Study::open(Plan::read(file)?, base)?);
            let options = Options { precision: study.plan().run.precision, ..Options::default() };
            // One engine an anchor, all on the same device.
            let opened = open_best(study.models()[0].clone(), &options)?;
            let computed = Computed::by(&*opened.engine, &opened.on.to_string());
            let others = study.models()[1..].iter().map(|model| opened.another(model.clone()));
            let mut engines = others.collect::<Result<Vec<_>, _>>()?;
            engines.insert(0, opened.engine);
            let session = Session::begin(Arc::new(Folder::make(out)?), study, base, Shard::WHOLE)?;
            session.prepare(computed)?;
            let report = session.run(&mut engines, &Job::new())?;
            println!("{} traces are in the answer", session.conclude(&report)?.traces);
        }
        _ => return Err("give: eval SCENE TRACES RESULTS EVENTS, or: study FILE FOLDER".into()),
    }
    Ok(())
}
