//! `tautline check`.

use std::path::PathBuf;

use anyhow::anyhow;
use serde_json::json;
use tautline::picture::Drawing;
use tautline::scene::{Description, Model, Scene};
use tautline::stream::Batches;
use tautline::study::anchor_warnings;
use tautline::trace::{Violation, ViolationKind};
use tautline::trade::Terms;

use super::failure::Failure;
use super::input::{InputArgs, dropped};
use super::look::{Look, Target, save};
use super::paths::keep_apart;
use super::words::{counted, place, plainly};
use super::{print, print_json};

/// How many traces are checked at a time.
const TRACES: usize = 8192;

/// How many layers, and how many labels, a table has at the most.
const LISTED: usize = 40;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Draw the scene, all of it: .svg or .png
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    keep_apart(&args.input.named(), &[("--picture", args.picture.as_deref())])?;
    let look = Look::of_scene();
    let target = args.picture.as_deref().map(|path| Target::new(path, &look)).transpose()?;
    let is_page =
        |path: &PathBuf| path.extension().is_some_and(|e| e.to_ascii_lowercase().to_string_lossy().starts_with("htm"));
    if let Some(path) = args.picture.as_ref().filter(|path| is_page(path)) {
        let shown = path.display();
        return Err(Failure::input(anyhow!("--picture: {shown}: a scene is drawn as .svg or .png; pages play traces")));
    }
    let scene = args.input.walls()?;
    let has_anchor = args.input.anchor.or(scene.anchor()).is_some();
    // Without traces, a scene is described whether it says where the rope is tied or not.
    let wants_traces = args.input.traces.is_some() || args.input.scene.is_none();
    if !has_anchor && !wants_traces {
        save_picture(target.as_ref(), &Drawing::of_scene(&scene), &look)?;
        return report(args, &scene, None, None);
    }
    let terms = Terms::exact(args.input.tie(scene)?);
    let model = &terms.given;
    let counts = if wants_traces { Some(count(args, &terms)?) } else { None };
    save_picture(target.as_ref(), &Drawing::new(model), &look)?;
    report(args, model.scene(), Some(model), counts.as_ref())
}

fn save_picture(target: Option<&Target>, drawing: &Drawing<'_>, look: &Look) -> Result<(), Failure> {
    target.map_or(Ok(()), |target| save(target, drawing, look))
}

/// Says what there is.
fn report(args: &Args, scene: &Scene, model: Option<&Model>, counts: Option<&Counts>) -> Result<(), Failure> {
    let described = scene.describe();
    if args.json {
        let mut scene = json!(described);
        scene["name"] = json!(args.input.name());
        scene["anchor"] = json!(model.map(|m| m.anchor().to_array()));
        scene["warnings"] = json!(model.map_or(Vec::new(), anchor_warnings));
        let traces = counts.map(|c| {
            let violations: Vec<_> = c.violations.iter().map(violation).collect();
            json!({"traces": c.traces, "steps": c.steps, "violations": violations})
        });
        return print_json(&json!({"scene": scene, "traces": traces}));
    }
    let mut text = table(&described, &args.input, model);
    if let Some(Counts { traces, steps, crossing, .. }) = counts {
        text +=
            &format!("traces  {traces}, {}; {crossing} of the traces cross walls\n", plainly(*steps, "step", "steps"));
    }
    if let Some(path) = &args.picture {
        text += &format!("picture {}\n", path.display());
    }
    print(&text)
}

fn table(scene: &Description, input: &InputArgs, model: Option<&Model>) -> String {
    let anchor = model.map_or("no anchor".to_owned(), |m| format!("anchor {}", place(m.anchor())));
    let vertices = counted(scene.vertices as u64, "vertex", "vertices");
    let mut text = format!("scene   {}: {}, {vertices}, {anchor}\n", input.name(), walls(scene.walls));
    if model.is_none() {
        text += &format!("        to tie a rope, {}\n", input.how_to_tie());
    }
    if scene.dropped > 0 {
        text += &format!("        {}\n", dropped(scene.dropped));
    }
    if let Some([low, high]) = scene.bounds {
        text += &format!("box     {} to {}; y points {}\n", place(low.into()), place(high.into()), scene.y);
    }
    text += &format!("unit    {}\n", scene.unit.as_deref().unwrap_or("the file's own"));
    if scene.solid > 0 {
        text += &format!("solid   {} of the walls are the border of something solid\n", scene.solid);
    }
    let layers = scene.layers.iter().map(|layer| (&layer.name, layer.walls)).collect();
    let labels = scene.labels.iter().map(|label| (&label.label, label.walls)).collect();
    text + &list("layers", layers) + &list("labels", labels)
}

/// Names of one kind and how many walls each has, as many as a table takes.
fn list(kind: &str, names: Vec<(&String, usize)>) -> String {
    let mut text = String::new();
    for (i, (name, count)) in names.iter().take(LISTED).enumerate() {
        text += &format!("{:8}{name}: {}\n", if i == 0 { kind } else { "" }, walls(*count));
    }
    if let Some(more @ 1..) = names.len().checked_sub(LISTED) {
        text += &format!("        and {more} more {kind}\n");
    }
    text
}

fn walls(count: usize) -> String {
    counted(count as u64, "wall", "walls")
}

/// What there is in a file of traces.
#[derive(Default)]
struct Counts {
    traces: usize,
    steps: u64,
    crossing: usize,
    /// All of them, where they are to be listed.
    violations: Vec<Violation>,
}

/// Reads all traces, batch by batch.
fn count(args: &Args, terms: &Terms) -> Result<Counts, Failure> {
    let mut batches = Batches::start(args.input.source()?, terms.clone(), TRACES);
    let mut violations = args.input.violations();
    let mut counts = Counts::default();
    while let Some(batch) = batches.next()? {
        let found = violations.take(&batch.settled)?;
        counts.traces += batch.settled.len();
        counts.steps += batch.settled.iter().map(|t| t.steps() as u64).sum::<u64>();
        if args.json {
            counts.violations.extend(found);
        }
    }
    counts.crossing = violations.finish();
    Ok(counts)
}

fn violation(v: &Violation) -> serde_json::Value {
    let kind = match v.kind {
        ViolationKind::Crosses => "crosses",
        ViolationKind::EntersSolid => "enters a solid",
        ViolationKind::SlipsThrough => "slips through",
    };
    json!({
        "trace": v.trace, "step": v.step, "kind": kind, "wall": v.wall, "ends": v.ends.map(|p| p.to_array()),
        "from": v.from.to_array(), "to": v.to.to_array(),
    })
}
