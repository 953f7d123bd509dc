//! Scenes as SVG drawings: what is drawn is a wall, along its outline.
//!
//! Coordinates are those of the outermost viewBox, y downwards as in the file. The crates that read XML, style sheets
//! and SVG's own notations are those that `usvg` stands on. `usvg` itself computes in f32 and passes over what it
//! cannot read, so the tree is walked here.

mod bounds;
mod comments;
mod css_transform;
mod label;
mod length;
mod namespaces;
mod notes;
mod page;
mod paint;
mod path;
mod properties;
mod shapes;
mod sheet;
mod style;
mod transform;
mod used;

use std::collections::HashMap;

use glam::{DAffine2, DVec2};
use roxmltree::{Document, Node, ParsingOptions};

use super::format::SceneFormat;
use super::outlines::Outlines;
use super::{Object, Scene, excerpt, nearly_anchor};
use crate::geometry::check_point;
use crate::read_error::{Fault, Place};
use crate::read_file::{SCENE_MAX, read_text};
use comments::Comments;
use namespaces::{INKSCAPE, SVG};
use notes::Counts;
use page::viewport_of;
use paint::Paint;
use shapes::{SHAPES, Shape};
use style::{Style, Styles};

/// How deep elements may lie in each other, those that they use included.
const DEPTH_MAX: usize = 128;

/// How many elements and lines there may be beyond those that the file itself has room for: by `use`.
const USED_MAX: usize = 1 << 22;

/// What is never drawn where it stands.
const DEFINITIONS: [&str; 20] = [
    "animate",
    "animateMotion",
    "animateTransform",
    "clipPath",
    "color-profile",
    "cursor",
    "defs",
    "desc",
    "filter",
    "font",
    "linearGradient",
    "marker",
    "mask",
    "metadata",
    "pattern",
    "radialGradient",
    "script",
    "set",
    "style",
    "title",
];

/// Drawings in SVG.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".svg"],
    files: ".svg",
    anchor: "give an element the id \"anchor\"",
    read: |path, options| parse(&read_text(path, SCENE_MAX)?, options.flatten).map_err(|fault| fault.in_file(path)),
};

/// Reads a drawing.
///
/// path, line, polyline, polygon, rect, circle and ellipse are walls, in groups and used ones too. What is hidden or
/// not painted is none; texts and images are none and are counted. The element with the id or the Inkscape label
/// `anchor` marks the anchor by its middle, painted or not.
fn parse(text: &str, flatten: Option<f64>) -> Result<Scene, Fault> {
    bounds::check_entities(text)?;
    bounds::check_tags(text)?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| syntax_fault(&e))?;
    if let Some((node, what)) = bounds::vanishing(&document) {
        return Err(fault_at(node, &what));
    }
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let what = format!("not SVG: the outermost element is <{}>, not <svg>", root.tag_name().name());
        return Err(fault_at(root, &what));
    }
    let comments = Comments::of(&document);
    let mut reader = Reader::new(&document, &comments, text.len());
    let (viewport, unit) = viewport_of(root, &reader.styles.of_element(root)).map_err(|what| fault_at(root, &what))?;
    let outer = Context { transform: DAffine2::IDENTITY, paint: Paint::default(), viewport, depth: 0, user: None };
    if let Some((context, _)) = reader.context(root, &outer)? {
        reader.children(root, &context)?;
    }
    reader.scene(flatten, &unit)
}

/// Moves the place out of the parser's message to where all messages have it.
fn syntax_fault(e: &roxmltree::Error) -> Fault {
    let at = e.pos();
    let message = e.to_string();
    let message = message.strip_suffix(&format!(" at {at}")).unwrap_or(&message);
    Fault::new(Place::line(u64::from(at.row)).then("column", at.col), format!("not SVG: {message}"))
}

/// A fault of an element.
fn fault_at(node: Node<'_, '_>, what: &str) -> Fault {
    let line = node.document().text_pos_at(node.range().start).row;
    let id = node.attribute("id").map_or(String::new(), |id| format!(" id={id:?}"));
    Fault::new(Place::line(u64::from(line)), format!("<{}{id}>: {what}", node.tag_name().name()))
}

/// What an element inherits.
#[derive(Clone, Copy)]
struct Context<'a, 'i> {
    transform: DAffine2,
    paint: Paint,
    viewport: Option<DVec2>,
    depth: usize,
    /// The `use` that draws just this element.
    user: Option<Node<'a, 'i>>,
}

/// Walks the tree.
struct Reader<'a, 'i> {
    styles: Styles<'a>,
    ids: HashMap<&'a str, Node<'a, 'i>>,
    outlines: Outlines,
    /// The layers and groups round what is drawn now.
    layers: Vec<String>,
    /// Where the anchor is, and the element that marks it.
    anchor: Option<(DVec2, Node<'a, 'i>)>,
    /// Whether what is drawn now marks the anchor.
    in_anchor: bool,
    counts: Counts<'a>,
    visited: usize,
    /// How many elements and lines there may be.
    most: usize,
}

impl<'a, 'i> Reader<'a, 'i> {
    fn new(document: &'a Document<'i>, comments: &'a Comments<'a>, length: usize) -> Self {
        // Where two elements have one id, it is that of the first.
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Reader {
            styles: Styles::of(document, comments),
            ids,
            outlines: Outlines::default(),
            layers: Vec::new(),
            anchor: None,
            in_anchor: false,
            counts: Counts::default(),
            visited: 0,
            most: length + USED_MAX,
        }
    }

    fn scene(self, flatten: Option<f64>, unit: &str) -> Result<Scene, Fault> {
        let side = self.outlines.bounds().map_or(0.0, |[low, high]| (high - low).max_element());
        let mut flat = self.outlines.flatten(flatten).map_err(|what| Fault::new(Place::default(), what))?;
        if let Some((anchor, _)) = self.anchor {
            flat.free_round(anchor);
        }
        let note = flat.note();
        let mut scene = Scene::of(flat.objects, flat.walls)?.with_y_down();
        scene.dropped += self.counts.dropped;
        if let Some((anchor, _)) = self.anchor {
            scene = scene.with_anchor(anchor);
        }
        scene.note(format!("{unit}; y points down, as in the file"));
        note.into_iter().for_each(|note| scene.note(note));
        self.styles.unread.note().into_iter().for_each(|note| scene.note(note));
        self.counts.tell(&mut scene, side);
        Ok(scene)
    }

    fn children(&mut self, node: Node<'a, 'i>, context: &Context<'a, 'i>) -> Result<(), Fault> {
        node.children().filter(Node::is_element).try_for_each(|child| self.element(child, context))
    }

    /// What the insides of `node` inherit, and its own style; `None` if they are hidden.
    fn context(
        &mut self,
        node: Node<'a, 'i>,
        outer: &Context<'a, 'i>,
    ) -> Result<Option<(Context<'a, 'i>, Style<'a>)>, Fault> {
        let style = self.styles.of_element(node);
        if self.styles.is_spent() {
            return Err(fault_at(node, "the style sheets have too many rules for so many elements, or too deep ones"));
        }
        if style.word("display") == "none" {
            self.counts.hidden += 1;
            return Ok(None);
        }
        let cut = |name| style.get(name).is_some_and(|value| !value.is(&["none"]));
        self.counts.clipped += usize::from(cut("clip-path") || cut("mask"));
        let own = transform::own(&style, outer.viewport).map_err(|what| fault_at(node, &what))?;
        // What is pressed flat is not drawn.
        if own.matrix2.determinant() == 0.0 {
            self.counts.hidden += 1;
            return Ok(None);
        }
        let (paint, unread) = outer.paint.within(&style, outer.viewport, |id| self.ids.contains_key(id));
        unread.iter().for_each(|what| self.styles.unread.add(what));
        let context = Context { transform: outer.transform * own, paint, depth: outer.depth + 1, ..*outer };
        Ok(Some((context, style)))
    }

    fn element(&mut self, node: Node<'a, 'i>, outer: &Context<'a, 'i>) -> Result<(), Fault> {
        let name = node.tag_name();
        let foreign = name.namespace().is_some_and(|namespace| namespace != SVG);
        if foreign || DEFINITIONS.contains(&name.name()) || name.name() == "symbol" {
            return Ok(());
        }
        self.visited += 1;
        if self.visited + self.outlines.len() > self.most {
            return Err(fault_at(node, "with all that is used again and again, the drawing is too large"));
        }
        if outer.depth >= DEPTH_MAX {
            return Err(fault_at(node, &format!("elements lie in or use each other more than {DEPTH_MAX} deep")));
        }
        let Some((context, style)) = self.context(node, outer)? else { return Ok(()) };
        let marks = node.attribute("id") == Some("anchor") || node.attribute((INKSCAPE, "label")) == Some("anchor");
        if marks && !self.in_anchor {
            return self.mark(node, &style, &context);
        }
        if !self.in_anchor && self.counts.nearly.is_none() && label::is_called(node, nearly_anchor) {
            let line = node.document().text_pos_at(node.range().start).row;
            let called = label::label(node).unwrap_or_default();
            let called = format!("<{}> in line {line} is called {:?}", node.tag_name().name(), excerpt(&called));
            self.counts.nearly = Some(called);
        }
        self.insides(node, &style, &context)
    }

    /// Takes the middle of what `node` draws for the anchor.
    fn mark(&mut self, node: Node<'a, 'i>, style: &Style<'a>, context: &Context<'a, 'i>) -> Result<(), Fault> {
        let walls = std::mem::take(&mut self.outlines);
        self.in_anchor = true;
        self.insides(node, style, context)?;
        self.in_anchor = false;
        let mark = std::mem::replace(&mut self.outlines, walls);
        let centre =
            Shape { node, style, viewport: context.viewport }.centre().map_err(|what| fault_at(node, &what))?;
        let at = match (centre, mark.bounds()) {
            (Some(centre), _) => context.transform.transform_point2(centre),
            (None, Some([low, high])) => low + (high - low) / 2.0,
            (None, None) => return Err(fault_at(node, "marks the anchor but draws nothing; mark it by a circle")),
        };
        let at = check_point(at).map_err(|fault| fault_at(node, &fault.to_string()))?;
        if let Some((_, first)) = self.anchor {
            let first = fault_at(first, "");
            let what =
                format!("a second anchor; that of {} marks one already, and a scene has one at most", first.place);
            return Err(fault_at(node, &what));
        }
        self.anchor = Some((at, node));
        Ok(())
    }

    /// Draws `node` itself, or what is in it.
    fn insides(&mut self, node: Node<'a, 'i>, style: &Style<'a>, context: &Context<'a, 'i>) -> Result<(), Fault> {
        let within = Context { user: None, ..*context };
        match node.tag_name().name() {
            "g" | "a" | "svg" | "switch" => {
                let named = label::layer(node);
                self.layers.extend(named.clone());
                match node.tag_name().name() {
                    "svg" => self.viewport(node, style, None, &within)?,
                    "switch" => {
                        let usual = |n: &Node<'_, '_>| {
                            n.is_element()
                                && !n.has_attribute("requiredExtensions")
                                && !n.has_attribute("systemLanguage")
                        };
                        node.children().find(usual).map_or(Ok(()), |child| self.element(child, &within))?;
                    }
                    _ => self.children(node, &within)?,
                }
                self.layers.truncate(self.layers.len() - usize::from(named.is_some()));
                Ok(())
            }
            "use" => self.used(node, style, &within),
            _ if !context.paint.visible => {
                self.counts.hidden += 1;
                Ok(())
            }
            name if !SHAPES.contains(&name) => {
                *self.counts.passed.entry(name).or_default() += 1;
                Ok(())
            }
            name if !self.in_anchor && !context.paint.shows(name == "line") => {
                self.counts.unpainted += 1;
                Ok(())
            }
            _ => self.shape(node, style, context),
        }
    }

    /// Draws a shape that is seen.
    fn shape(&mut self, node: Node<'a, 'i>, style: &Style<'a>, context: &Context<'a, 'i>) -> Result<(), Fault> {
        let label = context.user.and_then(label::label).or_else(|| label::label(node));
        // Names take room too where something is used again and again.
        let names = label.iter().chain(&self.layers).map(String::len).sum::<usize>();
        self.visited += names / 16;
        self.outlines.begin(Object { label, layers: self.layers.clone(), ..Object::default() });
        let from = self.outlines.len();
        let shape = Shape { node, style, viewport: context.viewport };
        let drawn = shape.draw(&mut self.outlines.pen(context.transform));
        drawn.map_err(|what| fault_at(node, &what))?;
        let drawn = self.outlines.since(from);
        if let Some(object) = self.outlines.objects.last_mut() {
            object.inside = context.paint.inside(drawn.closed);
        }
        if !self.in_anchor {
            self.counts.dropped += usize::from(drawn.lines == 0);
            let bears = matches!(node.tag_name().name(), "line" | "path" | "polygon" | "polyline");
            self.counts.marked += usize::from(bears && context.paint.marked());
            let scale = context.transform.matrix2.determinant().abs().sqrt();
            self.counts.widths.push(context.paint.width() * scale);
        }
        Ok(())
    }
}

#[cfg(test)]
mod looks_tests;
#[cfg(test)]
mod tests;
