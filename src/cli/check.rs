//! `tautline check`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::anyhow;
use serde_json::{Value, json};
use tautline::picture::Drawing;
use tautline::scene::{Inside, Model, Scene};
use tautline::stream::Batches;
use tautline::study::anchor_warnings;
use tautline::trace::{Violation, ViolationKind};
use tautline::trade::Terms;

use super::failure::Failure;
use super::input::{InputArgs, dropped};
use super::look::{Look, Target, save};
use super::paths::keep_apart;
use super::words::{counted, place};
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
    let described = Described::new(scene);
    if args.json {
        return print_json(&json!({
            "scene": described.json(&args.input.name(), scene, model),
            "traces": counts.map(|c| {
                let violations: Vec<_> = c.violations.iter().map(violation).collect();
                json!({"traces": c.traces, "steps": c.steps, "violations": violations})
            }),
        }));
    }
    let mut text = described.table(&args.input, scene, model);
    if let Some(Counts { traces, steps, crossing, .. }) = counts {
        text += &format!("traces  {traces}, {steps} steps; {crossing} of the traces cross walls\n");
    }
    if let Some(path) = &args.picture {
        text += &format!("picture {}\n", path.display());
    }
    print(&text)
}

/// What a scene is made of.
struct Described<'a> {
    /// How many walls belong to something solid.
    solid: usize,
    layers: BTreeMap<&'a str, usize>,
    /// For each label, how many walls it stands for.
    labels: BTreeMap<&'a str, usize>,
    /// What the reader says a unit is.
    unit: Option<&'a str>,
}

impl<'a> Described<'a> {
    fn new(scene: &'a Scene) -> Self {
        let (mut solid, mut labels) = (0, BTreeMap::new());
        for wall in 0..scene.walls().len() {
            let object = &scene.objects()[scene.object_of(wall)];
            solid += usize::from(object.inside != Inside::Free);
            object.label.iter().for_each(|label| *labels.entry(label.as_str()).or_default() += 1);
        }
        let unit = scene.notes().iter().find_map(|note| note.strip_prefix("a unit is "));
        let unit = unit.map(|unit| unit.split(';').next().unwrap_or(unit));
        Described { solid, layers: scene.layers(), labels, unit }
    }

    fn json(&self, name: &str, scene: &Scene, model: Option<&Model>) -> Value {
        let named = |names: &BTreeMap<&str, usize>, key: &str| -> Vec<Value> {
            names.iter().map(|(name, walls)| json!({key: name, "walls": walls})).collect()
        };
        json!({
            "name": name, "walls": scene.walls().len(), "vertices": scene.vertices().len(), "dropped": scene.dropped(),
            "solid": self.solid, "box": scene.bounds().map(|(low, high)| [low.to_array(), high.to_array()]),
            "unit": self.unit, "y": if scene.y_down() { "down" } else { "up" },
            "layers": named(&self.layers, "name"), "labels": named(&self.labels, "label"),
            "anchor": model.map(|m| m.anchor().to_array()), "warnings": model.map_or(Vec::new(), anchor_warnings),
            "notes": scene.notes(),
        })
    }

    fn table(&self, input: &InputArgs, scene: &Scene, model: Option<&Model>) -> String {
        let anchor = model.map_or("no anchor".to_owned(), |m| format!("anchor {}", place(m.anchor())));
        let mut text = format!(
            "scene   {}: {}, {}, {anchor}\n",
            input.name(),
            counted(scene.walls().len() as u64, "wall", "walls"),
            counted(scene.vertices().len() as u64, "vertex", "vertices"),
        );
        if model.is_none() {
            text += &format!("        to tie a rope, {}\n", input.how_to_tie());
        }
        if scene.dropped() > 0 {
            text += &format!("        {}\n", dropped(scene.dropped()));
        }
        if let Some((low, high)) = scene.bounds() {
            text += &format!("box     {} to {}", place(low), place(high));
            text += &format!("; y points {}\n", if scene.y_down() { "down" } else { "up" });
        }
        text += &format!("unit    {}\n", self.unit.unwrap_or("the file's own"));
        if self.solid > 0 {
            text += &format!("solid   {} of the walls are the border of something solid\n", self.solid);
        }
        let mut list = |name: &str, what: &str, names: &BTreeMap<&str, usize>| {
            for (i, (label, walls)) in names.iter().take(LISTED).enumerate() {
                let walls = counted(*walls as u64, "wall", "walls");
                text += &format!("{:8}{label}: {walls}\n", if i == 0 { name } else { "" });
            }
            if let Some(more @ 1..) = names.len().checked_sub(LISTED) {
                text += &format!("        and {more} more {what}\n");
            }
        };
        list("layers", "layers", &self.layers);
        list("labels", "labels", &self.labels);
        text
    }
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
