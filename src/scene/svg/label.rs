//! What elements are called.

use roxmltree::Node;

use super::namespaces::INKSCAPE;

/// How many characters of a label are kept.
const LENGTH_MAX: usize = 200;

/// What programs make up ids of, with a number behind.
const MADE_UP: [&str; 24] = [
    "SVGID", "XMLID", "a", "circle", "ellipse", "flowRoot", "g", "group", "id", "image", "layer", "line", "path",
    "polygon", "polyline", "rect", "spiral", "star", "svg", "switch", "symbol", "text", "tspan", "use",
];

/// What people call the element: its label in Inkscape, in Illustrator, its title, or an id that no program made up.
pub(super) fn label(node: Node<'_, '_>) -> Option<String> {
    let [label, data, title, id] = names(node).map(|name| name.filter(|name| !name.is_empty()));
    label.or(data).or(title).or(id.filter(|id| !made_up(id))).map(short)
}

/// Whether something that the element is called passes `test`.
pub(super) fn is_called(node: Node<'_, '_>, test: impl Fn(&str) -> bool) -> bool {
    names(node).into_iter().flatten().any(test)
}

/// What a layer is called: one that people have not named has an id.
pub(super) fn layer(node: Node<'_, '_>) -> Option<String> {
    let is_layer = node.attribute((INKSCAPE, "groupmode")) == Some("layer");
    label(node).or_else(|| node.attribute("id").filter(|_| is_layer).map(short))
}

/// Labels, title and id, without spaces round them.
fn names<'a>(node: Node<'a, '_>) -> [Option<&'a str>; 4] {
    let title = node.children().find(|child| child.tag_name().name() == "title").and_then(|title| title.text());
    [node.attribute((INKSCAPE, "label")), node.attribute("data-name"), title, node.attribute("id")]
        .map(|name| name.map(str::trim))
}

fn short(text: &str) -> String {
    let text: String = text.chars().take(LENGTH_MAX).collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a program made the id up, such as `rect123` and `path45-6`.
fn made_up(id: &str) -> bool {
    let letters = id.trim_matches('_').trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, '-' | '_' | '.'));
    letters.is_empty() || (letters.len() < id.len() && MADE_UP.contains(&letters))
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;

    #[test]
    fn labels_are_those_of_people() {
        let of = |attributes: &str, inside: &str| {
            let text = format!("<g xmlns:inkscape='{INKSCAPE}' {attributes}>{inside}</g>");
            let document = Document::parse(&text).unwrap();
            (label(document.root_element()), layer(document.root_element()))
        };
        let both = |name: &str| (Some(name.to_string()), Some(name.to_string()));
        assert_eq!(of("id='pillar'", ""), both("pillar"));
        assert_eq!(of("id='pillar3'", ""), both("pillar3"));
        assert_eq!(of("id='x' inkscape:label=' a  hall '", "<title>t</title>"), both("a hall"));
        assert_eq!(of("id='x'", "<title>the\n door</title>"), both("the door"));
        assert_eq!(of("id='_x31_' data-name='1'", ""), both("1"));
        for id in
            ["rect123", "path45-6", "g77", "use12-3-4", "layer1", "XMLID_1_", "SVGID_00001_", "123", "_7_", "id-3"]
        {
            assert_eq!(of(&format!("id='{id}'"), "").0, None, "{id}");
        }
        assert_eq!(of("", ""), (None, None));
        assert_eq!(of("id='layer1' inkscape:groupmode='layer'", "").1.as_deref(), Some("layer1"));
        assert_eq!(of(&format!("id='{}'", "é".repeat(300)), "").0.unwrap().chars().count(), 200);
    }
}
