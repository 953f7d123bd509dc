//! Scenes as DXF drawings: lines, polylines, arcs, circles, ellipses, splines and the borders of painted areas are
//! walls, in blocks too.
//!
//! The file is read here: it is pairs of lines, and what is wrong in it, or no wall, is to be named with its line.

mod block;
mod entity;
mod hatch;
mod insert;
mod shapes;
mod spline;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use glam::{DAffine2, DVec2};

use super::format::SceneFormat;
use super::outlines::Outlines;
use super::{Inside, Object, Scene, excerpt, listed, nearly_anchor};
use crate::geometry::check_point;
use crate::read_error::{Fault, Place};
use crate::read_file::{SCENE_MAX, read_bytes};
use block::{Block, Clips};
use entity::{Entities, Entity};
use shapes::{point, upside, width};

/// Drawings in ASCII DXF.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".dxf"],
    files: ".dxf",
    anchor: "put a POINT on a layer called anchor",
    read: |path, options| parse(&read_bytes(path, SCENE_MAX)?, options.flatten).map_err(|fault| fault.in_file(path)),
};

/// How many entities and lines there may be beyond those that the file itself has room for: by INSERT.
const USED_MAX: usize = 1 << 22;

/// The layer whose POINT is the anchor.
const ANCHOR: &str = "anchor";

/// Reads a drawing in ASCII DXF. Its coordinates are x and y of the model space; z is passed over.
///
/// What lies on a layer that is off or frozen, what is invisible and what lies in the paper space is no wall; nor is
/// what is inserted on a frozen layer, whatever layer it is on itself. Entities of other kinds are counted.
fn parse(bytes: &[u8], flatten: Option<f64>) -> Result<Scene, Fault> {
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err(Fault::new(Place::default(), "binary DXF is not read; save the drawing as ASCII DXF"));
    }
    // Older files have names in other encodings; what matters here is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut entities = Entities::new(text.strip_prefix('\u{feff}').unwrap_or(&text))?;
    let mut reader = Reader { most: bytes.len() + USED_MAX, ..Reader::default() };
    let mut section = "";
    while let Some(entity) = entities.next()? {
        match (entity.kind, section) {
            ("SECTION", _) => {
                section = entity.text(2).unwrap_or_default();
                reader.header(&entity);
            }
            ("ENDSEC", _) => section = "",
            ("LAYER", "TABLES") => reader.layer(&entity)?,
            ("BLOCK", "BLOCKS") => reader.block(&entity, &mut entities)?,
            (_, "OBJECTS") => reader.clips.object(&entity)?,
            (_, "ENTITIES") => reader.entity(&entity, &Context::default())?,
            _ => {}
        }
    }
    reader.scene(flatten)
}

/// What an entity gets from the block in which it lies.
#[derive(Clone, Copy)]
struct Context<'a> {
    transform: DAffine2,
    /// The layer of what lies on layer 0 of the block.
    layer: &'a str,
    /// The block's name, if people gave it.
    label: Option<&'a str>,
    depth: usize,
}

impl Default for Context<'_> {
    fn default() -> Self {
        Context { transform: DAffine2::IDENTITY, layer: "0", label: None, depth: 0 }
    }
}

/// What the file holds so far.
#[derive(Default)]
struct Reader<'a> {
    unit: Option<String>,
    /// By their names in capitals.
    blocks: HashMap<String, Rc<Block<'a>>>,
    /// Layers by their names in capitals.
    off: HashSet<String>,
    frozen: HashSet<String>,
    outlines: Outlines,
    /// Where the anchor is, and in which line.
    anchor: Option<(DVec2, u64)>,
    passed: BTreeMap<&'a str, usize>,
    hidden: usize,
    /// Entities without length.
    dropped: usize,
    /// How many polylines have a width, and the greatest one.
    wide: (usize, f64),
    clips: Clips<'a>,
    /// The files of blocks that lie in others, and how often these are inserted.
    elsewhere: BTreeMap<String, usize>,
    /// What nearly marks the anchor.
    nearly: Option<String>,
    visited: usize,
    /// How many entities and lines there may be.
    most: usize,
}

impl<'a> Reader<'a> {
    /// Takes the unit from the header's variables.
    fn header(&mut self, section: &Entity<'a>) {
        let mut pairs = section.groups.windows(2);
        if let Some([_, (70, unit)]) = pairs.find(|pair| pair[0] == (9, "$INSUNITS")) {
            self.unit = Some(match unit_name(unit) {
                Some(name) => format!("a unit is 1 {name} ($INSUNITS {unit})"),
                None => format!("the drawing does not say what a unit is ($INSUNITS {unit})"),
            });
        }
    }

    fn layer(&mut self, layer: &Entity<'a>) -> Result<(), Fault> {
        let name = || layer.text(2).unwrap_or_default().to_uppercase();
        if layer.flags(70)? & 1 == 1 {
            self.frozen.insert(name());
        }
        if layer.flags(62)? < 0 {
            self.off.insert(name());
        }
        Ok(())
    }

    fn scene(self, flatten: Option<f64>) -> Result<Scene, Fault> {
        let mut flat = self.outlines.flatten(flatten).map_err(|what| Fault::new(Place::default(), what))?;
        if let Some((anchor, _)) = self.anchor {
            flat.free_round(anchor);
        }
        let note = flat.note();
        let mut scene = Scene::of(flat.objects, flat.walls)?;
        scene.dropped += self.dropped;
        if let Some((anchor, _)) = self.anchor {
            scene = scene.with_anchor(anchor);
        }
        scene.note(self.unit.unwrap_or_else(|| "the drawing does not say what a unit is (no $INSUNITS)".into()));
        note.into_iter().for_each(|note| scene.note(note));
        if self.hidden > 0 {
            scene.note(format!("hidden entities, which are no walls: {}", self.hidden));
        }
        let clipped = self.clips.count();
        if clipped > 0 {
            scene.note(format!("clips of inserted blocks (XCLIP) cut no walls; inserts taken whole: {clipped}"));
        }
        if !self.elsewhere.is_empty() {
            let files = self.elsewhere.iter().map(|(file, count)| (file.as_str(), *count)).collect();
            scene.note(format!(
                "what lies in other files is missing; inserts of external references: {}",
                listed(&files)
            ));
        }
        if let (1.., widest) = self.wide {
            let widest: f64 = format!("{widest:.2e}").parse().unwrap_or(widest);
            let what = format!("walls are the middle of polylines, whose widest is {widest} wide");
            scene.note(format!("{what}; polylines with a width: {}", self.wide.0));
        }
        if let Some(nearly) = self.nearly.filter(|_| self.anchor.is_none()) {
            scene.note(format!("{nearly}; what marks the anchor is a POINT on the layer \"anchor\""));
        }
        if !self.passed.is_empty() {
            scene.note(format!("passed over: {}", listed(&self.passed)));
        }
        Ok(scene)
    }

    /// Counts a thing; a drawing that inserts blocks in blocks again and again is refused before it fills the memory.
    fn count(&mut self, entity: &Entity<'a>) -> Result<(), Fault> {
        self.visited += 1;
        if self.visited + self.outlines.len() > self.most {
            return Err(entity.fault("with all that is inserted again and again, the drawing is too large"));
        }
        Ok(())
    }

    fn entity(&mut self, entity: &Entity<'a>, outer: &Context<'_>) -> Result<(), Fault> {
        self.count(entity)?;
        let own = entity.text(8).unwrap_or("0");
        let layer = if own == "0" { outer.layer } else { own };
        let name = layer.to_uppercase();
        // A layer that is off hides what lies on it, a frozen one also what is inserted there and lies on others.
        let hidden = self.frozen.contains(&name) || (self.off.contains(&name) && entity.kind != "INSERT");
        if hidden || entity.flags(60)? == 1 || entity.flags(67)? == 1 {
            self.hidden += 1;
            return Ok(());
        }
        let anchors = layer.eq_ignore_ascii_case(ANCHOR);
        if !anchors && self.nearly.is_none() && nearly_anchor(layer) {
            let (kind, line) = (entity.kind, entity.line);
            self.nearly = Some(format!("{kind} in line {line} lies on the layer {:?}", excerpt(layer)));
        }
        let context = Context { layer, ..*outer };
        match entity.kind {
            "POINT" if anchors => return self.mark(entity, &context),
            "POINT" => return Ok(()),
            "INSERT" => return self.insert(entity, &context),
            "HATCH" => {
                // Its paths take time where it is inserted again and again, even if nothing comes of them.
                self.visited += entity.groups.len() / 4;
                if let Some(other) = hatch::unpainted(entity)? {
                    return self.pass_over(other);
                }
            }
            _ => {}
        }
        // These have coordinates of their own, seen along their normal.
        let mut transform = context.transform;
        if matches!(entity.kind, "ARC" | "CIRCLE" | "HATCH" | "LWPOLYLINE" | "POLYLINE" | "SOLID" | "TRACE")
            && upside(entity)? < 0.0
        {
            transform *= MIRRORED;
        }
        // Names take room too where something is inserted again and again.
        self.visited += (layer.len() + context.label.map_or(0, str::len)) / 16;
        // The format does not say whether a closed line is the border of something solid; these are painted areas.
        let painted = matches!(entity.kind, "HATCH" | "SOLID" | "TRACE");
        let inside = if painted { Inside::EvenOdd } else { Inside::Free };
        let label = context.label.map(short);
        self.outlines.begin(Object { label, layers: vec![short(layer)], inside });
        let from = self.outlines.len();
        let pen = &mut self.outlines.pen(transform);
        let drawn = if entity.kind == "HATCH" { hatch::draw(entity, pen) } else { shapes::draw(entity, pen) };
        if let Some(other) = drawn? {
            self.outlines.take_back();
            return self.pass_over(other);
        }
        if anchors {
            return Err(entity.fault(format_args!("lies on the layer {layer}, which is for one POINT, the anchor")));
        }
        if self.outlines.since(from).lines == 0 {
            let unseen = entity.kind == "3DFACE" && entity.flags(70)? & 15 == 15;
            *if unseen { &mut self.hidden } else { &mut self.dropped } += 1;
        }
        let width = width(entity)? * transform.matrix2.determinant().abs().sqrt();
        if width > 0.0 {
            self.wide = (self.wide.0 + 1, self.wide.1.max(width));
        }
        Ok(())
    }

    /// Counts what is of a kind that is not read.
    fn pass_over(&mut self, name: &'a str) -> Result<(), Fault> {
        *self.passed.entry(name).or_default() += 1;
        Ok(())
    }

    fn mark(&mut self, entity: &Entity<'a>, context: &Context<'_>) -> Result<(), Fault> {
        let at = context.transform.transform_point2(point(entity, 10)?);
        let at = check_point(at).map_err(|fault| entity.fault(fault))?;
        if let Some((_, line)) = self.anchor {
            let what =
                format_args!("a second anchor; that of line {line} marks one already, and a scene has one at most");
            return Err(entity.fault(what));
        }
        self.anchor = Some((at, entity.line));
        Ok(())
    }
}

/// From the coordinates of what is seen from below to those of the drawing.
const MIRRORED: DAffine2 = DAffine2::from_cols(DVec2::NEG_X, DVec2::Y, DVec2::ZERO);

/// The start of a name, as it is kept.
fn short(name: &str) -> String {
    name.chars().take(200).collect()
}

fn unit_name(code: &str) -> Option<&'static str> {
    const NAMES: [&str; 20] = [
        "inch",
        "foot",
        "mile",
        "mm",
        "cm",
        "m",
        "km",
        "microinch",
        "mil",
        "yard",
        "angstrom",
        "nm",
        "µm",
        "dm",
        "dam",
        "hm",
        "Gm",
        "astronomical unit",
        "light year",
        "parsec",
    ];
    NAMES.get(code.parse::<usize>().ok()?.checked_sub(1)?).copied()
}

#[cfg(test)]
mod hatch_tests;
#[cfg(test)]
mod tests;
