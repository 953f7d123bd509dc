//! What of an element's style matters for walls: whether it is shown, and whether it is cut.

use std::cell::Cell;

use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, Declaration, DeclarationTokenizer, Element, PseudoClass, Rule, StyleSheet};

/// The properties that matter.
const PROPERTIES: [&str; 5] = ["display", "visibility", "clip-path", "mask", "transform"];

/// How an element looks, as far as that matters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Looks {
    /// Neither it nor anything in it is shown.
    pub(super) removed: bool,
    /// Whether it is shown, if it says so itself.
    pub(super) visible: Option<bool>,
    /// It has a clip path or a mask.
    pub(super) clipped: bool,
    /// A style sheet moves it.
    pub(super) moved: bool,
}

/// The rules of all style sheets in a document that say anything that matters, the more specific ones last.
pub(super) struct Styles<'a> {
    rules: Vec<Rule<'a>>,
    /// How many looks at elements are left for finding out which rules match.
    left: Cell<u64>,
}

/// How many looks at elements there may be: some seconds.
const LOOKS_MAX: u64 = 1 << 26;

/// How many bytes of text are passed over in the time of a look.
const BYTES_A_LOOK: usize = 64;

impl<'a> Styles<'a> {
    pub(super) fn of(document: &'a Document<'_>) -> Self {
        let mut sheet = StyleSheet::new();
        let left = Cell::new(LOOKS_MAX);
        for node in document.descendants().filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "style"))) {
            for text in node.children().filter_map(|n| n.text()) {
                charge(&left, reading(text));
                if left.get() == 0 {
                    break;
                }
                sheet.parse_more(text);
                // All rules are sorted again.
                charge(&left, sheet.rules.len());
            }
        }
        sheet.rules.retain(|rule| rule.declarations.iter().any(|d| PROPERTIES.contains(&d.name)));
        Styles { rules: sheet.rules, left }
    }

    /// Whether there was more to look at than may be; what was said of elements then is of no use.
    pub(super) fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    pub(super) fn looks(&self, node: Node<'_, '_>) -> Looks {
        let mut looks = Looks::default();
        for name in ["display", "visibility", "clip-path", "mask"] {
            if let Some(value) = node.attribute(name) {
                looks.set(name, value);
            }
        }
        let matching: Vec<&Declaration<'_>> = self
            .rules
            .iter()
            .filter(|rule| rule.selector.matches(&Styled(node, &self.left)))
            .flat_map(|rule| &rule.declarations)
            .collect();
        let inline = node.attribute("style").unwrap_or_default();
        charge(&self.left, reading(inline));
        let inline = if self.is_spent() { "" } else { inline };
        let inline: Vec<Declaration<'_>> = DeclarationTokenizer::from(inline).collect();
        // What is important comes last and so wins.
        for important in [false, true] {
            for d in matching.iter().copied().chain(&inline).filter(|d| d.important == important) {
                looks.set(d.name, d.value);
            }
        }
        looks
    }
}

/// Takes that many looks from those that are left.
fn charge(left: &Cell<u64>, looks: usize) {
    left.set(left.get().saturating_sub(looks as u64));
}

/// What reading declarations costs, in looks: with each, the parser goes through the text from its start.
fn reading(text: &str) -> usize {
    text.len().saturating_mul(text.bytes().filter(|&b| b == b':').count()) / BYTES_A_LOOK
}

impl Looks {
    fn set(&mut self, name: &str, value: &str) {
        let none = value.trim() == "none";
        match name {
            "display" => self.removed = none,
            "visibility" => {
                self.visible = match value.trim() {
                    "visible" => Some(true),
                    "hidden" | "collapse" => Some(false),
                    _ => None,
                }
            }
            "clip-path" | "mask" => self.clipped |= !none,
            "transform" => self.moved = !none,
            _ => {}
        }
    }
}

/// An element as style sheets select it, and how many looks are left.
struct Styled<'a, 'i, 'l>(Node<'a, 'i>, &'l Cell<u64>);

impl Styled<'_, '_, '_> {
    /// Counts a look; once none is left, nothing is found any more.
    fn may_look(&self) -> bool {
        charge(self.1, 1);
        self.1.get() > 0
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
        charge(self.1, value.len() / BYTES_A_LOOK);
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
        let text = r##"<svg xmlns="http://www.w3.org/2000/svg">
            <style>.off { display: none } #on { display: inline } g > .pale { visibility: hidden; fill: red }
                .cut { clip-path: url(#c) } .firm { display: none !important } .moved { transform: rotate(3deg) }</style>
            <a class="off"/><b class="off" id="on"/><c class="off" style="fill:red;display:inline"/>
            <g><d class="pale x"/></g><e class="cut"/><f class="firm" style="display:inline"/>
            <h display="none"/><i display="none" style="display:block"/><j style="visibility:visible" mask="none"/>
            <k mask="url(#m)"/><l class="moved"/><m style="visibility:inherit" class="pale"/></svg>"##;
        let document = Document::parse(text).unwrap();
        let styles = Styles::of(&document);
        let looks = |name: &str| {
            let node = document.descendants().find(|n| n.tag_name().name() == name).unwrap();
            styles.looks(node)
        };
        let plain = Looks::default();
        let removed = Looks { removed: true, ..plain };
        for (name, expected) in [
            ("a", removed),
            ("b", plain),
            ("c", plain),
            ("d", Looks { visible: Some(false), ..plain }),
            ("e", Looks { clipped: true, ..plain }),
            ("f", removed),
            ("h", removed),
            ("i", plain),
            ("j", Looks { visible: Some(true), ..plain }),
            ("k", Looks { clipped: true, ..plain }),
            ("l", Looks { moved: true, ..plain }),
            ("m", plain),
        ] {
            assert_eq!(looks(name), expected, "{name}");
        }
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
        // All rules are sorted again with each sheet, and all declarations read again with each.
        assert!(spent(&format!("</style>{}<style>", "<style>a{display:none}</style>".repeat(20_000)), ""));
        assert!(spent(&format!("a{{{}}}", "b:c;".repeat(100_000)), ""));
        assert!(spent("", &format!("<g style=\"{}\"/>", "b:c;".repeat(100_000))));
        let class = format!("<g class=\"{}\"/>", "x ".repeat(1_000_000));
        assert!(!spent(&rules(500), &class) && spent(&rules(5000), &class));
    }
}
