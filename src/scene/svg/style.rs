//! What of an element's style matters for walls.

use std::cell::Cell;
use std::rc::Rc;

use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, Element, PseudoClass};

use super::comments::Comments;
use super::namespaces::SVG;
use super::properties::PROPERTIES;
use super::sheet::{self, Rule, Unread};

/// What a property is to be, and whether a style says so or an attribute: they are written differently.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Value<'a> {
    pub(super) text: &'a str,
    pub(super) css: bool,
}

impl Value<'_> {
    /// Whether it is one of these words, in any case.
    pub(super) fn is(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.text.eq_ignore_ascii_case(word))
    }
}

/// An element's own style, as far as it matters.
#[derive(Debug, Default)]
pub(super) struct Style<'a>(Vec<(&'static str, Value<'a>)>);

impl<'a> Style<'a> {
    /// What the element says of a property itself: `None` if nothing, or that it is what it is anyway.
    pub(super) fn get(&self, name: &str) -> Option<Value<'a>> {
        let value = self.0.iter().find(|v| v.0 == name)?.1;
        (!value.is(&["initial", "unset", "revert", "revert-layer"])).then_some(value)
    }

    /// Whether the element says that an inherited property is as if nothing round the element said anything.
    pub(super) fn is_initial(&self, name: &str) -> bool {
        self.0.iter().any(|(property, value)| *property == name && value.is(&["initial"]))
    }

    /// The word for a property, in small letters; none if nothing is said.
    pub(super) fn word(&self, name: &str) -> String {
        self.get(name).map(|value| value.text.to_ascii_lowercase()).unwrap_or_default()
    }

    fn set(&mut self, property: &'static str, value: Value<'a>) {
        match self.0.iter_mut().find(|v| v.0 == property) {
            Some(old) => old.1 = value,
            None => self.0.push((property, value)),
        }
        if property == "marker" {
            ["marker-start", "marker-mid", "marker-end"].into_iter().for_each(|marker| self.set(marker, value));
        }
    }
}

/// The rules of all style sheets in a document that say anything that matters, the more specific ones last.
pub(super) struct Styles<'a> {
    rules: Vec<Rule<'a>>,
    comments: &'a Comments<'a>,
    pub(super) unread: Unread,
    /// How many looks at elements are left for finding out which rules match.
    left: Cell<u64>,
}

/// How many looks at elements there may be: some seconds.
const LOOKS_MAX: u64 = 1 << 26;

/// How many bytes of an attribute are compared in the time of a look.
const BYTES_A_LOOK: usize = 64;

impl<'a> Styles<'a> {
    pub(super) fn of(document: &'a Document<'_>, comments: &'a Comments<'a>) -> Self {
        let (rules, unread, left) = (Vec::new(), Unread::default(), Cell::new(LOOKS_MAX));
        let mut styles = Styles { rules, comments, unread, left };
        // Drawings without a namespace have style sheets too.
        let of_svg = |node: &Node<'_, '_>| matches!(node.tag_name().namespace(), None | Some(SVG));
        for node in document.descendants().filter(|n| n.tag_name().name() == "style" && of_svg(n)) {
            let kind = node.attribute("type").map_or("", str::trim);
            if !kind.is_empty() && !kind.eq_ignore_ascii_case("text/css") {
                styles.unread.add(&format!("type=\"{kind}\""));
                continue;
            }
            match node.attribute("media").map(str::trim) {
                None | Some("" | "all" | "screen") => {
                    let texts = node.children().filter_map(|n| n.text()).map(|text| comments.strip(text));
                    texts.for_each(|text| sheet::parse(text, &mut styles.rules, &mut styles.unread));
                }
                Some(media) => styles.unread.add(&format!("media=\"{media}\"")),
            }
        }
        for instruction in document.root().children().filter_map(|node| node.pi()) {
            if instruction.target == "xml-stylesheet" {
                styles.unread.add("xml-stylesheet");
            }
        }
        styles.rules.sort_by_cached_key(|rule| rule.selector.specificity());
        styles
    }

    /// Whether there was more to look at than may be; what was said of elements then is of no use.
    pub(super) fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// An element's own style: its attributes, the rules that match it, and its attribute `style`.
    pub(super) fn of_element(&self, node: Node<'a, '_>) -> Style<'a> {
        let mut style = Style::default();
        for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
            if let Some((name, _)) = PROPERTIES.iter().find(|(name, presents)| *presents && *name == attribute.name()) {
                style.set(name, Value { text: self.comments.strip(attribute.value()).trim(), css: false });
            }
        }
        let matching = self.rules.iter().filter(|rule| rule.selector.matches(&Styled(node, &self.left)));
        let matching: Vec<_> = matching.map(|rule| Rc::clone(&rule.declarations)).collect();
        let inline = node.attribute("style").unwrap_or_default();
        let inline: Vec<_> = sheet::declarations(self.comments.strip(inline)).collect();
        // What is important comes last and so wins.
        for important in [false, true] {
            let all = matching.iter().flat_map(|declarations| declarations.iter()).chain(&inline);
            for d in all.filter(|d| d.important == important) {
                style.set(d.property, Value { text: d.value, css: true });
            }
        }
        style
    }
}

/// An element as style sheets select it, and how many looks are left.
struct Styled<'a, 'i, 'l>(Node<'a, 'i>, &'l Cell<u64>);

impl Styled<'_, '_, '_> {
    /// Counts a look; once none is left, nothing is found any more.
    fn may_look(&self) -> bool {
        self.charge(1);
        self.1.get() > 0
    }

    fn charge(&self, looks: usize) {
        self.1.set(self.1.get().saturating_sub(looks as u64));
    }
}

impl Element for Styled<'_, '_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().filter(|_| self.may_look()).map(|node| Styled(node, self.1))
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().filter(|_| self.may_look()).map(|node| Styled(node, self.1))
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.may_look() && self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        if !self.may_look() {
            return false;
        }
        let Some(value) = self.0.attribute(local_name) else { return false };
        self.charge(value.len() / BYTES_A_LOOK);
        operator.matches(value)
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cascade_decides() {
        let text = r##"<svg>
            <style>.off { display: none } #on { display: inline } g > .pale { visibility: hidden; fill: red }
                .cut { clip-path: url(#c) } .firm { display: none !important }
                .moved { transform: rotate(3deg) }</style>
            <style media="print">e { display: none }</style>
            <a class="off"/><b class="off" id="on"/><c class="off" style="fill:red;DISPLAY:inline"/>
            <g><d class="pale x"/></g><e class="cut"/><f class="firm" style="display:inline"/>
            <h display="none"/><i display="none" style="display:block"/><j style="visibility:visible" mask="none"/>
            <l class="moved" transform="scale(2)"/><m style="marker:none" marker-end="url(#m)"/>
            <n style="r:unset" r="1"/></svg>"##;
        let document = Document::parse(text).unwrap();
        let comments = Comments::of(&document);
        let styles = Styles::of(&document, &comments);
        let said = |name: &str| {
            let node = document.descendants().find(|n| n.tag_name().name() == name).unwrap();
            let style = styles.of_element(node);
            let properties = PROPERTIES.iter().filter_map(|p| Some(format!("{}={}", p.0, style.get(p.0)?.text)));
            properties.collect::<Vec<_>>().join(" ")
        };
        for (name, expected) in [
            ("a", "display=none"),
            ("b", "display=inline"),
            ("c", "display=inline fill=red"),
            ("d", "fill=red visibility=hidden"),
            ("e", "clip-path=url(#c)"),
            ("f", "display=none"),
            ("h", "display=none"),
            ("i", "display=block"),
            ("j", "mask=none visibility=visible"),
            ("l", "transform=rotate(3deg)"),
            ("m", "marker=none marker-end=none marker-mid=none marker-start=none"),
            ("n", ""),
        ] {
            assert_eq!(said(name), expected, "{name}");
        }
        assert!(styles.unread.note().unwrap().ends_with("1 (media=\"print\")"));
    }

    #[test]
    fn rules_times_elements_are_bounded() {
        let spent = |style: &str, body: &str| {
            let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\"><style>{style}</style>{body}</svg>");
            let fault = super::super::parse(&text, None).err();
            fault.is_some_and(|fault| fault.what.contains("too many rules for so many elements"))
        };
        let rules = |count: usize| (0..count).map(|i| format!(".c{i}{{display:none}}")).collect::<String>();
        assert!(!spent(&rules(1000), &"<g/>".repeat(10_000)));
        assert!(spent(&rules(10_000), &"<g/>".repeat(10_000)));
        // Which of its ancestors are meant by each of eight names can be tried in very many ways.
        let deep = format!("{}<path d=''/>{}", "<g>".repeat(100), "</g>".repeat(100));
        assert!(spent("a g g g g g g g g path {display:none}", &deep));
        let class = format!("<g class=\"{}\"/>", "x ".repeat(1_000_000));
        assert!(!spent(&rules(500), &class) && spent(&rules(5000), &class));
    }
}
