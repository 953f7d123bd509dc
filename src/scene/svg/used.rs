//! What is drawn elsewhere, or in a viewport of its own.

use std::str::FromStr;

use glam::{DAffine2, DVec2};
use roxmltree::Node;
use svgtypes::AspectRatio;

use super::super::curves::Piece;
use super::super::excerpt;
use super::super::extent::extent;
use super::length::Along;
use super::namespaces::XLINK;
use super::page::view_box;
use super::shapes::{SHAPES, Shape};
use super::style::Style;
use super::{Context, DEPTH_MAX, Reader, fault_at, label, transform};
use crate::read_error::Fault;

/// By which part of a viewport's size something may reach beyond it before that is told: roundings do.
const HAIR: f64 = 1e-9;

impl<'a, 'i> Reader<'a, 'i> {
    /// Draws what a `use` refers to.
    pub(super) fn used(
        &mut self,
        node: Node<'a, 'i>,
        style: &Style<'a>,
        context: &Context<'a, 'i>,
    ) -> Result<(), Fault> {
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
        let shape = Shape { node, style, viewport: context.viewport };
        let [x, y] = [shape.length("x", Along::X), shape.length("y", Along::Y)];
        let by = DVec2::new(x.map_err(fault)?.unwrap_or(0.0), y.map_err(fault)?.unwrap_or(0.0));
        let transform = context.transform * DAffine2::from_translation(by);
        // A shape that is used is called as its use is, what is more than one lies in it as in a group.
        let single = SHAPES.contains(&target.tag_name().name());
        let moved = Context { transform, user: single.then_some(node), ..*context };
        let named = if single { None } else { label::layer(node) };
        self.layers.extend(named.clone());
        let drawn = if matches!(target.tag_name().name(), "symbol" | "svg") {
            if context.depth >= DEPTH_MAX {
                return Err(fault(format!("elements lie in or use each other more than {DEPTH_MAX} deep")));
            }
            match self.context(target, &moved)? {
                Some((inner, own)) => self.viewport(target, &own, Some((node, style)), &inner),
                None => Ok(()),
            }
        } else {
            self.element(target, &moved)
        };
        self.layers.truncate(self.layers.len() - usize::from(named.is_some()));
        drawn
    }

    /// Draws what is in `node`, a viewport of its own; the size of what uses it comes first.
    pub(super) fn viewport(
        &mut self,
        node: Node<'a, 'i>,
        style: &Style<'a>,
        user: Option<(Node<'a, 'i>, &Style<'a>)>,
        context: &Context<'a, 'i>,
    ) -> Result<(), Fault> {
        let fault = |what: String| fault_at(node, &what);
        let shape = Shape { node, style, viewport: context.viewport };
        let user = user.map(|(node, style)| Shape { node, style, viewport: context.viewport });
        let size_of = |name: &str, along: Along| {
            let given = user.map_or(Ok(None), |user| user.size(name, along)).map_err(fault)?;
            if given.is_some() { Ok(given) } else { shape.size(name, along).map_err(fault) }
        };
        let [width, height] = [size_of("width", Along::X)?, size_of("height", Along::Y)?];
        if width == Some(0.0) || height == Some(0.0) {
            self.counts.hidden += 1;
            return Ok(());
        }
        let size = match (context.viewport, width, height) {
            (outer, Some(w), Some(h)) if outer.is_none() => Some(DVec2::new(w, h)),
            (Some(all), w, h) => Some(DVec2::new(w.unwrap_or(all.x), h.unwrap_or(all.y))),
            _ => None,
        };
        let at = match node.tag_name().name() {
            "svg" => DVec2::new(
                shape.length("x", Along::X).map_err(fault)?.unwrap_or(0.0),
                shape.length("y", Along::Y).map_err(fault)?.unwrap_or(0.0),
            ),
            _ => DVec2::ZERO,
        };
        let mut inner = Context { viewport: size, ..*context };
        inner.transform *= DAffine2::from_translation(at);
        let edges = inner.transform;
        if let Some(view) = view_box(node).map_err(fault)? {
            let aspect = node.attribute("preserveAspectRatio").unwrap_or("xMidYMid");
            let aspect = AspectRatio::from_str(aspect).map_err(|e| fault(format!("preserveAspectRatio: {e}")))?;
            let size = size.ok_or_else(|| fault("has a viewBox but no known size; give width and height".into()))?;
            inner.transform *= transform::fitted(view, size, aspect);
            inner.viewport = Some(DVec2::new(view.w, view.h));
        }
        let from = self.outlines.len();
        self.children(node, &inner)?;
        if let Some(size) = size.filter(|_| !matches!(style.word("overflow").as_str(), "visible" | "auto")) {
            self.counts.beyond += self.beyond(from, edges, size);
        }
        Ok(())
    }

    /// How many of the things drawn since there were `from` pieces reach beyond the viewport.
    fn beyond(&self, from: usize, edges: DAffine2, size: DVec2) -> usize {
        let back = edges.inverse();
        if !back.is_finite() {
            return 0;
        }
        let things = self.outlines.pieces[from..].split(|piece| matches!(piece, Piece::Object));
        let slack = size * HAIR;
        let reaches = |pieces: &&[Piece]| {
            extent(pieces, back).is_some_and(|[low, high]| low.cmplt(-slack).any() || high.cmpgt(size + slack).any())
        };
        things.filter(reaches).count()
    }
}
