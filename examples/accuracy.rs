//! Makes the tables and diagrams of docs/accuracy.md anew, from measurements on this machine:
//!
//!     cargo run --release --example accuracy
//!
//! Everything between `<!-- NAME -->` and `<!-- end -->` in that file is replaced. Takes some minutes; the times are
//! worth something only if nothing else runs meanwhile.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;
use tautline::candidates::Simd;
use tautline::engine::{Cpu, Engine, Job};
use tautline::example::{BuiltIn, Walker, settled_walks};
use tautline::gpu::{AdapterChoice, Device};
use tautline::lab::astray::{HEAD, errors};
use tautline::lab::bench::BenchScene;
use tautline::lab::filter::{Filter, Trial};
use tautline::lab::{NoteErrors, note_errors};
use tautline::scene::{Model, Scene, read_scene};
use tautline::trace::{Trace, settle};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Where the page is, and its diagrams.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/accuracy.md");

/// The scenes of the trade-off: the name of their diagram, and what the program is told of them.
const SCENES: [(&str, &str); 3] = [
    ("rooms", "--scene rooms"),
    ("aegean", "--scene tests/scenes/aegean.geojson --step 0.5"),
    ("arena", "--scene tests/scenes/arena.map --anchor 20.5,10.5 --step 0.4"),
];

fn main() -> Result<()> {
    let mut page = std::fs::read_to_string(PAGE)?;
    for (name, args) in SCENES {
        eprintln!("tradeoff: {name}");
        replace(&mut page, &format!("tradeoff {name}"), &tradeoff(name, args)?)?;
    }
    eprintln!("the note");
    replace(&mut page, "note", &note()?)?;
    eprintln!("extremes");
    replace(&mut page, "extremes", &extremes()?)?;
    eprintln!("what is not worth trading");
    replace(&mut page, "depth", &depth()?)?;
    eprintln!("the filter");
    replace(&mut page, "filter", &filter()?)?;
    std::fs::write(PAGE, page)?;
    Ok(())
}

/// Puts `text` between the marks of that name.
fn replace(page: &mut String, name: &str, text: &str) -> Result<()> {
    let mark = format!("<!-- {name} -->\n");
    let start = page.find(&mark).ok_or_else(|| format!("{PAGE}: there is no {mark}"))? + mark.len();
    let end = page[start..].find("<!-- end -->").ok_or_else(|| format!("{PAGE}: {mark} has no end"))?;
    page.replace_range(start..start + end, &format!("\n{text}\n"));
    Ok(())
}

/// The table and the diagram of a scene, by the program itself.
fn tradeoff(name: &str, args: &str) -> Result<String> {
    let picture = format!("accuracy/{name}.svg");
    let out = Path::new(PAGE).with_file_name(&picture);
    std::fs::create_dir_all(out.parent().ok_or("no folder")?)?;
    let command = format!("tradeoff {args} --seconds 0.4 --adapter software");
    let mut program = Command::new(env!("CARGO"));
    program.current_dir(env!("CARGO_MANIFEST_DIR")).args(["run", "--release", "--quiet", "--"]);
    let output = program.args(command.split_whitespace()).arg("--out").arg(&out).output()?;
    if !output.status.success() {
        return Err(format!("{command}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let table = String::from_utf8(output.stdout)?;
    Ok(format!("    tautline {command}\n\n![Time against error: {name}]({picture})\n\n```text\n{table}```\n"))
}

/// A scene of the tests.
fn file(name: &str, anchor: Option<[f64; 2]>) -> Result<Arc<Model>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes").join(name);
    Ok(Arc::new(Model::new(read_scene(&path)?, anchor.map(Into::into))?))
}

/// How often the note's listing goes wrong, by the length of a step.
fn note() -> Result<String> {
    let built_in = |scene: BuiltIn| -> Result<(Arc<Model>, f64)> {
        Ok((Arc::new(Model::new(scene.scene(1), None)?), BenchScene::BuiltIn(scene).step()))
    };
    let (random, random_step) = built_in(BuiltIn::Random(500))?;
    let (lattice, lattice_step) = built_in(BuiltIn::Lattice(500))?;
    let (rooms, rooms_step) = built_in(BuiltIn::Rooms)?;
    let scenes = [
        ("random-500", random, random_step),
        ("lattice-500", lattice, lattice_step),
        ("rooms", rooms, rooms_step),
        ("aegean", file("aegean.geojson", None)?, 0.5),
        ("arena", file("arena.map", Some([20.5, 10.5]))?, 0.4),
    ];
    let (traces, steps) = (60, 300);
    let mut text = format!(
        "{traces} walks of {steps} steps each. Shares of steps after which the rope is wrong, of traces in which it ever is, and of \
         those that end with a wrong one: listing 1, then with the remedy.\n\n\
         | scene | step | steps: listing | remedy | ever: listing | remedy | end: listing | remedy |\n\
         |---|---|---|---|---|---|---|---|\n"
    );
    for (name, model, usual) in &scenes {
        for times in [0.1, 0.3, 1.0, 3.0, 10.0] {
            let step = usual * times;
            let errors = note_errors(model, Walker { step, steps, seed: 1 }, traces)?;
            write!(text, "| {name} | {} |", (step * 1e6).round() / 1e6)?;
            let all_steps = traces * steps as u64;
            let shares = |e: NoteErrors| [(e.steps, all_steps), (e.traces, traces), (e.ends, traces)];
            for (listing, remedy) in shares(errors[0]).into_iter().zip(shares(errors[1])) {
                for (wrong, all) in [listing, remedy] {
                    write!(text, " {:.1} % |", 100.0 * wrong as f64 / all as f64)?;
                }
            }
            text.push('\n');
        }
    }
    Ok(text)
}

/// How far precision fast and the note are off in extreme cases.
fn extremes() -> Result<String> {
    let mut text = format!("{HEAD}\n");
    for line in errors(&Device::open(&AdapterChoice::Software)?, &Job::new())? {
        writeln!(text, "{line}")?;
    }
    Ok(text)
}

/// What a step costs while the rope has few contacts, and while it has very many.
fn depth() -> Result<String> {
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(DVec2::from);
    let pillar = Scene::new((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]))?;
    let model = Arc::new(Model::new(pillar, Some([0.0, -3.0].into()))?);
    let mut engine = Cpu::new(model.clone());
    let mut text = String::from("| times round the pillar | greatest depth | ns a step |\n|---|---|---|\n");
    for turns in [1, 10, 100, 1000, 10_000, 100_000] {
        // There and back, 8 steps a turn.
        let place = |i: i32| DVec2::from_angle(std::f64::consts::TAU * (f64::from(i) / 8.0 - 0.25)) * 3.0;
        let points = (0..=8 * turns).chain((0..8 * turns).rev()).map(place).collect();
        let trace = [settle(&model, &Trace { id: 0, points })];
        let mut best = f64::INFINITY;
        let mut contacts = 0;
        for _ in 0..5 {
            let times = 100_000 / turns;
            let start = std::time::Instant::now();
            for _ in 0..times {
                contacts = engine.evaluate(&trace, &Job::new())?[0].max_depth;
            }
            best = best.min(start.elapsed().as_nanos() as f64 / f64::from(times) / f64::from(16 * turns));
        }
        writeln!(text, "| {turns} | {contacts} | {best:.0} |")?;
    }
    Ok(text)
}

/// What the candidate pass names, and what of that is in vain.
fn filter() -> Result<String> {
    let trials: Vec<Filter> = (0..8192).into_par_iter().map(|i| Trial::new(20, i).swept(Simd::detected())).collect();
    let random = Arc::new(Model::new(BuiltIn::Random(500).scene(1), None)?);
    let walks = |model: &Arc<Model>, step| {
        Filter::of_walks(model, &settled_walks(model, Walker { step, steps: 500, seed: 1 }, 2000))
    };
    let rows = [
        ("near-degenerate", trials.into_iter().sum()),
        ("walks in random-500", walks(&random, 0.01)?),
        ("walks along the Aegean coast", walks(&file("aegean.geojson", None)?, 0.5)?),
    ];
    let mut text = String::from(
        "| queries | | vertices tried | named | of those in vain | in a swept triangle | missed |\n|---|---|---|---|---|---|---|\n",
    );
    for (name, filter) in rows {
        let (Filter { queries, tried, named, inside, missed, .. }, share) = (filter, 100.0 * filter.false_share());
        writeln!(text, "| {name} | {queries} | {tried} | {named} | {share:.3} % | {inside} | {missed} |")?;
    }
    Ok(text)
}
