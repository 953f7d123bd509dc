//! Scenes as SVG drawings: what is drawn is a wall, along its outline.
//!
//! Coordinates are those of the outermost viewBox, y downwards as in the file. The crates that read XML, style sheets
//! and SVG's own notations are those that `usvg` stands on. `usvg` itself computes in f32 and passes over what it cannot
//! read, so the tree is walked here.

mod bounds;
mod page;
mod path;
mod shapes;
mod style;
mod transform;

use std::collections::{BTreeMap, HashMap};
use std::str::FromStr;

use glam::{DAffine2, DVec2};
use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::AspectRatio;

use super::curves::Outlines;
use super::{Scene, excerpt, listed};
use crate::geometry::check_point;
use crate::read_error::{Fault, Place};
use page::{view_box, viewport_of};
use shapes::{Along, Shape};
use style::Styles;

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

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

/// Reads a drawing.
///
/// path, line, polyline, polygon, rect, circle and ellipse are walls, in groups and used ones too, whatever their paint.
/// What is hidden is none; texts and images are none and are counted. The element with the id or the Inkscape label
/// `anchor` marks the anchor by its middle.
pub(super) fn parse(text: &str, flatten: Option<f64>) -> Result<Scene, Fault> {
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
    let mut reader = Reader::new(&document, text.len());
    let (viewport, unit) = viewport_of(root).map_err(|what| fault_at(root, &what))?;
    let context = Context { transform: DAffine2::IDENTITY, visible: true, viewport, depth: 0 };
    let context = reader.context(root, &context)?;
    if let Some(context) = context {
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
struct Context {
    transform: DAffine2,
    visible: bool,
    viewport: Option<DVec2>,
    depth: usize,
}

/// Walks the tree.
struct Reader<'a, 'i> {
    styles: Styles<'a>,
    ids: HashMap<&'a str, Node<'a, 'i>>,
    outlines: Outlines,
    /// Where the anchor is, and the element that marks it.
    anchor: Option<(DVec2, Node<'a, 'i>)>,
    /// Whether what is drawn now marks the anchor.
    in_anchor: bool,
    /// What is passed over, by name, and how many elements are hidden or cut.
    passed: BTreeMap<&'a str, usize>,
    hidden: usize,
    clipped: usize,
    visited: usize,
    /// How many elements and lines there may be.
    most: usize,
}

impl<'a, 'i> Reader<'a, 'i> {
    fn new(document: &'a Document<'i>, length: usize) -> Self {
        // Where two elements have one id, it is that of the first.
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Reader {
            styles: Styles::of(document),
            ids,
            outlines: Outlines::default(),
            anchor: None,
            in_anchor: false,
            passed: BTreeMap::new(),
            hidden: 0,
            clipped: 0,
            visited: 0,
            most: length + USED_MAX,
        }
    }

    fn scene(self, flatten: Option<f64>, unit: &str) -> Result<Scene, Fault> {
        let flat = self.outlines.flatten(flatten).map_err(|what| Fault::new(Place::default(), what))?;
        let note = flat.note();
        let mut scene = Scene::of(flat.objects, flat.walls)?.with_y_down();
        if let Some((anchor, _)) = self.anchor {
            scene = scene.with_anchor(anchor);
        }
        scene.note(format!("{unit}; y points down, as in the file"));
        note.into_iter().for_each(|note| scene.note(note));
        if self.hidden > 0 {
            scene.note(format!("hidden elements, which are no walls: {}", self.hidden));
        }
        if self.clipped > 0 {
            scene.note(format!("clip paths and masks cut no walls; elements taken whole: {}", self.clipped));
        }
        if !self.passed.is_empty() {
            scene.note(format!("passed over: {}", listed(&self.passed)));
        }
        Ok(scene)
    }

    fn children(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Fault> {
        node.children().filter(Node::is_element).try_for_each(|child| self.element(child, context))
    }

    /// What the insides of `node` inherit; `None` if they are hidden.
    fn context(&mut self, node: Node<'a, 'i>, outer: &Context) -> Result<Option<Context>, Fault> {
        let looks = self.styles.looks(node);
        if self.styles.is_spent() {
            return Err(fault_at(node, "the style sheets have too many rules for so many elements, or too deep ones"));
        }
        if looks.removed {
            self.hidden += 1;
            return Ok(None);
        }
        if looks.moved || node.has_attribute("transform-origin") {
            let what = "moved by a style (transform, transform-origin); write the attribute transform alone";
            return Err(fault_at(node, what));
        }
        self.clipped += usize::from(looks.clipped);
        let own = transform::transform(node.attribute("transform").unwrap_or_default());
        let own = own.map_err(|what| fault_at(node, &what))?;
        Ok(Some(Context {
            transform: outer.transform * own,
            visible: looks.visible.unwrap_or(outer.visible),
            viewport: outer.viewport,
            depth: outer.depth + 1,
        }))
    }

    fn element(&mut self, node: Node<'a, 'i>, outer: &Context) -> Result<(), Fault> {
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
        let Some(context) = self.context(node, outer)? else { return Ok(()) };
        let marks = node.attribute("id") == Some("anchor") || node.attribute((INKSCAPE, "label")) == Some("anchor");
        if marks && !self.in_anchor {
            return self.mark(node, &context);
        }
        self.insides(node, &context)
    }

    /// Takes the middle of what `node` draws for the anchor.
    fn mark(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Fault> {
        let walls = std::mem::take(&mut self.outlines);
        self.in_anchor = true;
        self.insides(node, context)?;
        self.in_anchor = false;
        let mark = std::mem::replace(&mut self.outlines, walls);
        let centre = Shape { node, viewport: context.viewport }.centre().map_err(|what| fault_at(node, &what))?;
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
    fn insides(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Fault> {
        match node.tag_name().name() {
            "g" | "a" => self.children(node, context),
            "svg" => self.viewport(node, node, context),
            "use" => self.used(node, context),
            "switch" => {
                let usual = |n: &Node<'_, '_>| {
                    n.is_element() && !n.has_attribute("requiredExtensions") && !n.has_attribute("systemLanguage")
                };
                node.children().find(usual).map_or(Ok(()), |child| self.element(child, context))
            }
            _ if !context.visible => {
                self.hidden += 1;
                Ok(())
            }
            name => {
                let shape = Shape { node, viewport: context.viewport };
                let drawn = shape.draw(&mut self.outlines.pen(context.transform));
                if !drawn.map_err(|what| fault_at(node, &what))? {
                    *self.passed.entry(name).or_default() += 1;
                }
                Ok(())
            }
        }
    }

    /// Draws what a `use` refers to.
    fn used(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Fault> {
        let fault = |what: String| fault_at(node, &what);
        let Some(href) = node.attribute("href").or(node.attribute((XLINK, "href"))) else {
            return Err(fault("names nothing to use; it needs href=\"#id\"".into()));
        };
        let Some(id) = href.strip_prefix('#') else {
            return Err(fault(format!("uses {:?} of another file; copy it into this one", excerpt(href))));
        };
        let Some(&target) = self.ids.get(id) else {
            return Err(fault(format!("uses the element {id:?}, which the file does not have")));
        };
        let shape = Shape { node, viewport: context.viewport };
        let [x, y] = [shape.length("x", Along::X), shape.length("y", Along::Y)];
        let by = DVec2::new(x.map_err(fault)?.unwrap_or(0.0), y.map_err(fault)?.unwrap_or(0.0));
        let moved = Context { transform: context.transform * DAffine2::from_translation(by), ..*context };
        if matches!(target.tag_name().name(), "symbol" | "svg") {
            if context.depth >= DEPTH_MAX {
                return Err(fault(format!("elements lie in or use each other more than {DEPTH_MAX} deep")));
            }
            match self.context(target, &moved)? {
                Some(inner) => self.viewport(target, node, &inner),
                None => Ok(()),
            }
        } else {
            self.element(target, &moved)
        }
    }

    /// Draws what is in `node`, a viewport of its own; `sized` says how large it is.
    fn viewport(&mut self, node: Node<'a, 'i>, sized: Node<'a, 'i>, context: &Context) -> Result<(), Fault> {
        let fault = |what: String| fault_at(node, &what);
        let size_of = |name: &str, along: Along| {
            let of = |node| Shape { node, viewport: context.viewport }.size(name, along);
            of(sized).and_then(|size| if size.is_some() { Ok(size) } else { of(node) }).map_err(fault)
        };
        let [width, height] = [size_of("width", Along::X)?, size_of("height", Along::Y)?];
        let size = width.zip(height).map(|(w, h)| DVec2::new(w, h)).or(context.viewport);
        let shape = Shape { node, viewport: context.viewport };
        let at = match node.tag_name().name() {
            "svg" => DVec2::new(
                shape.length("x", Along::X).map_err(fault)?.unwrap_or(0.0),
                shape.length("y", Along::Y).map_err(fault)?.unwrap_or(0.0),
            ),
            _ => DVec2::ZERO,
        };
        let mut inner = Context { viewport: size, ..*context };
        inner.transform *= DAffine2::from_translation(at);
        if let Some(view) = view_box(node).map_err(fault)? {
            let aspect = node.attribute("preserveAspectRatio").unwrap_or("xMidYMid");
            let aspect = AspectRatio::from_str(aspect).map_err(|e| fault(format!("preserveAspectRatio: {e}")))?;
            let size = size.ok_or_else(|| fault("has a viewBox but no known size; give width and height".into()))?;
            inner.transform *= transform::fitted(view, size, aspect);
            inner.viewport = Some(DVec2::new(view.w, view.h));
        }
        self.children(node, &inner)
    }
}

#[cfg(test)]
mod tests;
