//! Scenes as DXF drawings: lines, polylines, arcs, circles, ellipses and splines are walls, in blocks too.
//!
//! The file is read here: it is pairs of lines, and what is wrong in it, or no wall, is to be named with its line.

mod entity;
mod shapes;
mod spline;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use glam::{DAffine2, DVec2};

use super::curves::{Outlines, direction};
use super::{Scene, listed};
use crate::geometry::check_point;
use crate::read_error::{Fault, Place};
use entity::{Entities, Entity};
use shapes::{Corner, point, polyline, upside};

/// How deep blocks may lie in each other.
const DEPTH_MAX: usize = 64;

/// How many entities and lines there may be beyond those that the file itself has room for: by INSERT.
const USED_MAX: usize = 1 << 22;

/// The layer whose POINT is the anchor.
const ANCHOR: &str = "anchor";

/// Reads a drawing in ASCII DXF. Its coordinates are x and y of the model space; z is passed over.
///
/// What lies on a layer that is off or frozen, what is invisible and what lies in the paper space is no wall. Entities of
/// other kinds are counted.
pub(super) fn parse(bytes: &[u8], flatten: Option<f64>) -> Result<Scene, Fault> {
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
            (_, "ENTITIES") => reader.entity(&entity, &Context::default())?,
            _ => {}
        }
    }
    reader.scene(flatten)
}

/// A part of a drawing that is inserted by its name.
struct Block<'a> {
    base: DVec2,
    entities: Vec<Entity<'a>>,
}

/// What an entity gets from the block in which it lies.
#[derive(Clone, Copy)]
struct Context<'a> {
    transform: DAffine2,
    /// The layer of what lies on layer 0 of the block.
    layer: &'a str,
    depth: usize,
}

impl Default for Context<'_> {
    fn default() -> Self {
        Context { transform: DAffine2::IDENTITY, layer: "0", depth: 0 }
    }
}

/// What the file holds so far.
#[derive(Default)]
struct Reader<'a> {
    unit: Option<String>,
    /// By their names in capitals.
    blocks: HashMap<String, Rc<Block<'a>>>,
    hidden_layers: HashSet<String>,
    outlines: Outlines,
    /// Where the anchor is, and in which line.
    anchor: Option<(DVec2, u64)>,
    passed: BTreeMap<&'a str, usize>,
    hidden: usize,
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
        if layer.flags(70)? & 1 == 1 || layer.flags(62)? < 0 {
            self.hidden_layers.insert(layer.text(2).unwrap_or_default().to_uppercase());
        }
        Ok(())
    }

    fn block(&mut self, head: &Entity<'a>, entities: &mut Entities<'a>) -> Result<(), Fault> {
        let mut block = Block { base: DVec2::new(head.or(10, 0.0)?, head.or(20, 0.0)?), entities: Vec::new() };
        while let Some(entity) = entities.next()? {
            match entity.kind {
                "ENDBLK" => break,
                "ENDSEC" | "BLOCK" => return Err(head.fault("has no ENDBLK")),
                _ => block.entities.push(entity),
            }
        }
        self.blocks.insert(head.text(2).unwrap_or_default().to_uppercase(), Rc::new(block));
        Ok(())
    }

    fn scene(self, flatten: Option<f64>) -> Result<Scene, Fault> {
        let flat = self.outlines.flatten(flatten).map_err(|what| Fault::new(Place::default(), what))?;
        let note = flat.note();
        let mut scene = Scene::of(flat.objects, flat.walls)?;
        if let Some((anchor, _)) = self.anchor {
            scene = scene.with_anchor(anchor);
        }
        scene.note(self.unit.unwrap_or_else(|| "the drawing does not say what a unit is (no $INSUNITS)".into()));
        note.into_iter().for_each(|note| scene.note(note));
        if self.hidden > 0 {
            scene.note(format!("hidden entities, which are no walls: {}", self.hidden));
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
        let hidden = self.hidden_layers.contains(&layer.to_uppercase());
        if hidden || entity.flags(60)? == 1 || entity.flags(67)? == 1 {
            self.hidden += 1;
            return Ok(());
        }
        let context = Context { layer, ..*outer };
        match entity.kind {
            "POINT" if layer.eq_ignore_ascii_case(ANCHOR) => return self.mark(entity, &context),
            "POINT" => return Ok(()),
            "INSERT" => return self.insert(entity, &context),
            _ => {}
        }
        // These have coordinates of their own, seen along their normal.
        let mut transform = context.transform;
        if matches!(entity.kind, "ARC" | "CIRCLE" | "LWPOLYLINE" | "POLYLINE") && upside(entity)? < 0.0 {
            transform *= MIRRORED;
        }
        let pen = &mut self.outlines.pen(transform);
        let drawn = if entity.kind == "POLYLINE" {
            let (corners, closed) = corners(entity)?;
            polyline(entity, &corners, closed, pen).map(|()| true)
        } else {
            shapes::draw(entity, pen)
        };
        if !drawn? {
            *self.passed.entry(entity.kind).or_default() += 1;
        } else if layer.eq_ignore_ascii_case(ANCHOR) {
            return Err(entity.fault(format_args!("lies on the layer {layer}, which is for one POINT, the anchor")));
        }
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

    /// Draws a block once, or in columns and rows.
    fn insert(&mut self, insert: &Entity<'a>, context: &Context<'_>) -> Result<(), Fault> {
        let name = insert.text(2).unwrap_or_default();
        let Some(block) = self.blocks.get(&name.to_uppercase()).cloned() else {
            return Err(insert.fault(format_args!("the drawing has no block {name:?}")));
        };
        if context.depth >= DEPTH_MAX {
            return Err(insert.fault(format_args!("blocks lie in each other more than {DEPTH_MAX} deep")));
        }
        let way = direction(insert.or(50, 0.0)?);
        let turn = DAffine2::from_cols(way, way.perp(), DVec2::ZERO);
        let scale = DVec2::new(insert.or(41, 1.0)?, insert.or(42, 1.0)?);
        let spacing = DVec2::new(insert.or(44, 0.0)?, insert.or(45, 0.0)?);
        let mut outer = context.transform;
        if upside(insert)? < 0.0 {
            outer *= MIRRORED;
        }
        outer *= DAffine2::from_translation(point(insert, 10)?) * turn;
        for row in 0..insert.flags(71)?.max(1) {
            for column in 0..insert.flags(70)?.max(1) {
                self.count(insert)?;
                let by = spacing * DVec2::new(column as f64, row as f64);
                let place = DAffine2::from_translation(by) * DAffine2::from_scale(scale);
                let transform = outer * place * DAffine2::from_translation(-block.base);
                let inner = Context { transform, depth: context.depth + 1, ..*context };
                block.entities.iter().try_for_each(|entity| self.entity(entity, &inner))?;
            }
        }
        Ok(())
    }
}

/// From the coordinates of what is seen from below to those of the drawing.
const MIRRORED: DAffine2 = DAffine2::from_cols(DVec2::NEG_X, DVec2::Y, DVec2::ZERO);

/// The corners of a POLYLINE, and whether it is closed.
fn corners(entity: &Entity<'_>) -> Result<(Vec<Corner>, bool), Fault> {
    let flags = entity.flags(70)?;
    if flags & (16 | 64) != 0 {
        return Err(entity.fault("is a mesh in space; explode it into lines"));
    }
    let mut corners = Vec::new();
    for vertex in &entity.parts {
        // Control points of a fitted curve; the curve's own points follow.
        if vertex.kind == "VERTEX" && vertex.flags(70)? & 16 == 0 {
            corners.push((point(vertex, 10)?, vertex.or(42, 0.0)?));
        }
    }
    Ok((corners, flags & 1 == 1))
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
mod tests;
