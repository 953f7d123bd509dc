//! What is refused before a drawing is walked: text that entities blow up, and numbers that would be rounded to 0.

use std::collections::HashMap;

use roxmltree::{Document, Node};

use super::super::excerpt;
use crate::number::{self, VANISHES};
use crate::read_error::{Fault, Place};

/// How many bytes longer than the file its text may be once all entities are written out.
const BLOWN_UP_MAX: u64 = 1 << 22;

/// How many entities a file may declare; every reference is looked for among all of them.
const ENTITIES_MAX: usize = 1 << 10;

/// How deep entities lie in each other that the parser takes.
const DEPTH_MAX: usize = 10;

/// The attributes whose numbers say where something is.
const PLACES: [&str; 22] = [
    "cx",
    "cy",
    "d",
    "height",
    "patternTransform",
    "points",
    "r",
    "rx",
    "ry",
    "transform",
    "transform-origin",
    "viewBox",
    "width",
    "x",
    "x1",
    "x2",
    "y",
    "y1",
    "y2",
    "dx",
    "dy",
    "refX",
];

/// Refuses a file whose entities would make its text much longer: some bytes can stand for gigabytes. O(length).
///
/// Whether a reference stands in a comment is not asked, nor is which of two declarations counts: the longer one does
/// here.
pub(super) fn check_entities(text: &str) -> Result<(), Fault> {
    let declared: Vec<(&str, &str)> = text.split("<!ENTITY").skip(1).filter_map(declaration).collect();
    if declared.len() > ENTITIES_MAX {
        let what = format!("the file declares {} entities; {ENTITIES_MAX} are the most", declared.len());
        return Err(Fault::new(Place::default(), what));
    }
    let mut entities: HashMap<&str, Vec<&str>> = HashMap::new();
    declared.iter().for_each(|&(name, value)| entities.entry(name).or_default().push(value));
    if entities.is_empty() {
        return Ok(());
    }
    let (mut lengths, mut sum) = (HashMap::new(), 0u64);
    for (at, name) in references(text) {
        sum = sum.saturating_add(length(name, &entities, &mut lengths, DEPTH_MAX));
        if sum > BLOWN_UP_MAX {
            let line = text[..at].matches('\n').count() as u64 + 1;
            let what = format!("with &{}; the entities, written out, are too long for a drawing", excerpt(name));
            return Err(Fault::new(Place::line(line), what));
        }
    }
    Ok(())
}

/// The name and the value that follow `<!ENTITY`.
fn declaration(text: &str) -> Option<(&str, &str)> {
    let (name, rest) = text.trim_start().split_once(|c: char| c.is_ascii_whitespace())?;
    let rest = rest.trim_start();
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    Some((name, rest[1..].split(quote).next()?))
}

/// The names of the entities that `text` refers to, and where.
fn references(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.match_indices('&').filter_map(|(at, _)| {
        let rest = &text[at + 1..];
        let end = rest.find(|c: char| matches!(c, ';' | '<' | '&' | '"' | '\'') || c.is_ascii_whitespace())?;
        (rest.as_bytes()[end] == b';' && !rest.starts_with('#')).then(|| (at, &rest[..end]))
    })
}

/// How long the entity `name` is, written out.
fn length<'a>(
    name: &'a str,
    entities: &HashMap<&'a str, Vec<&'a str>>,
    lengths: &mut HashMap<&'a str, u64>,
    depth: usize,
) -> u64 {
    if let Some(&length) = lengths.get(name) {
        return length;
    }
    // What refers to itself is the parser's to refuse.
    let (Some(values), 1..) = (entities.get(name), depth) else { return 0 };
    let written = |value: &&'a str| {
        let inner = references(value).map(|(_, name)| length(name, entities, lengths, depth - 1));
        inner.fold(value.len() as u64, u64::saturating_add)
    };
    let longest = values.iter().map(written).max().unwrap_or(0);
    lengths.insert(name, longest);
    longest
}

/// How many attributes an element may have: the parser compares each with all others.
const ATTRIBUTES_MAX: usize = 1 << 10;

/// How much may be done about namespaces: where elements declare some, their number with all that they inherit,
/// squared.
const NAMESPACES_MAX: u64 = 1 << 28;

/// Refuses tags about which the parser would think for hours: of very many attributes, or namespaces within namespaces.
/// O(length).
pub(super) fn check_tags(text: &str) -> Result<(), Fault> {
    let fault = |at: usize, what: String| {
        let line = text[..at].matches('\n').count() as u64 + 1;
        Err(Fault::new(Place::line(line), what))
    };
    // How many namespaces each open element knows, from the outermost on.
    let mut known = vec![1u64];
    let (mut at, mut spent) = (0, 0u64);
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        let passed =
            [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")].into_iter().find(|(open, _)| rest.starts_with(open));
        if let Some((_, close)) = passed {
            at = start + rest.find(close).map_or(rest.len(), |end| end + close.len());
        } else if rest.starts_with("</") {
            if known.len() > 1 {
                known.pop();
            }
            at = start + 2;
        } else if rest.starts_with("<!") {
            at = start + 2;
        } else {
            let tag = Tag::of(rest);
            if tag.attributes > ATTRIBUTES_MAX {
                return fault(
                    start,
                    format!("an element of {} attributes; {ATTRIBUTES_MAX} are the most", tag.attributes),
                );
            }
            let names = known.last().copied().unwrap_or(1) + tag.namespaces;
            if tag.namespaces > 0 {
                spent = spent.saturating_add(names * names);
            }
            if spent > NAMESPACES_MAX {
                return fault(start, "too many namespaces declared within each other".to_owned());
            }
            if !tag.closed {
                known.push(names);
            }
            at = start + tag.length;
        }
    }
    Ok(())
}

/// What is in a tag.
struct Tag {
    attributes: usize,
    namespaces: u64,
    /// Whether nothing is in the element.
    closed: bool,
    length: usize,
}

impl Tag {
    /// The tag with which `text` begins, or what there is of it.
    fn of(text: &str) -> Self {
        let mut tag = Tag { attributes: 0, namespaces: 0, closed: false, length: 1 };
        while let Some(next) = text[tag.length..].find(['"', '\'', '>', '<']) {
            let (name, end) = (&text[tag.length..tag.length + next], tag.length + next);
            match text.as_bytes()[end] {
                b'>' => {
                    tag.closed = name.ends_with('/');
                    tag.length = end + 1;
                    return tag;
                }
                b'<' => {
                    tag.length = end;
                    return tag;
                }
                quote => {
                    tag.attributes += 1;
                    tag.namespaces += u64::from(name.contains("xmlns"));
                    let value = text[end + 1..].find(char::from(quote));
                    tag.length = value.map_or(text.len(), |length| end + 1 + length + 1);
                }
            }
        }
        tag.length = text.len();
        tag
    }
}

/// The first element with a number that would be rounded to 0, and what is wrong with it. O(length of the attributes).
pub(super) fn vanishing<'a, 'i>(document: &'a Document<'i>) -> Option<(Node<'a, 'i>, String)> {
    document.descendants().find_map(|node| {
        let placed = node.attributes().filter(|a| PLACES.contains(&a.name()));
        let (name, value) = placed.map(|a| (a.name(), a.value())).find(|(_, v)| number::vanishing(v).is_some())?;
        let digits = &value[number::vanishing(value)?];
        Some((node, format!("{name}: {} is {VANISHES}", excerpt(digits))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(entities: &str, body: &str) -> String {
        format!("<!DOCTYPE svg [\n{entities}]>\n<svg xmlns=\"http://www.w3.org/2000/svg\">{body}</svg>")
    }

    #[test]
    fn entities_as_programs_write_them_are_taken() {
        let entities = "<!ENTITY ns_svg \"http://www.w3.org/2000/svg\">\n<!ENTITY both '&ns_svg;&ns_svg;'>\n";
        check_entities(&drawing(entities, "<g a='&both;'>&ns_svg; &amp; &#38; &</g>")).unwrap();
        let line = "<!ENTITY w '<line x2=\"5\"/>'>";
        let scene = super::super::parse(&drawing(line, &"&w;".repeat(1000)), None).unwrap();
        assert_eq!(scene.walls().len(), 1000);
    }

    #[test]
    fn entities_that_blow_up_are_refused() {
        let fault = |entities: &str, body: &str| {
            let fault = super::super::parse(&drawing(entities, body), None).unwrap_err();
            format!("{}: {}", fault.place, fault.what)
        };
        // A thousand times a million, then ten to the power of ten.
        let long = format!("<!ENTITY a '{}'>", "x".repeat(1_000_000));
        let e = fault(&long, &format!("\n{}", "&a;".repeat(1000)));
        assert_eq!(e, "line 4: with &a; the entities, written out, are too long for a drawing");
        let nested: String =
            (1..10).map(|i| format!("<!ENTITY l{i} '{}'>\n", format!("&l{};", i - 1).repeat(10))).collect();
        assert!(fault(&format!("<!ENTITY l0 'laugh'>{nested}"), "&l9;").contains("are too long for a drawing"));
        // In quotes of the other kind, in a comment before the true one, and in an attribute.
        let hidden = format!("<!-- <!ENTITY a ''> -->{}", long.replace('\'', "\""));
        assert!(fault(&hidden, &format!("<g id='{}'/>", "&a;".repeat(9))).contains("with &a; the entities"));
        let e = fault("<!ENTITY a '&b;'><!ENTITY b '&a;'>", "&a;");
        assert!(e.contains("not SVG: "), "{e}");
        let many: String = (0..2000).map(|i| format!("<!ENTITY e{i} 'x'>")).collect();
        assert_eq!(fault(&many, "&e1;"), ": the file declares 2000 entities; 1024 are the most");
    }

    #[test]
    fn tags_that_take_hours_are_refused() {
        let fault = |body: &str| super::super::parse(&drawing("", body), None).unwrap_err();
        let attributes = |count: usize| (0..count).map(|i| format!(" a{i}='>'")).collect::<String>();
        let e = fault(&format!("\n<g a=\"'\"{}/>", attributes(5000)));
        assert_eq!((e.place, &*e.what), (Place::line(4), "an element of 5001 attributes; 1024 are the most"));
        let nested: String = (0..20_000).map(|i| format!("<g xmlns:a{i}='u{i}'>")).collect();
        assert_eq!(fault(&nested).what, "too many namespaces declared within each other");
        // Side by side they are as programs write them.
        let side: String = (0..20_000).map(|i| format!("<g xmlns:a='u{}'></g><g xmlns='{i}'/>", i % 9)).collect();
        let comment = format!("<!-- <g {} --><![CDATA[<g>]]>", attributes(2000));
        super::super::parse(&drawing("", &format!("{comment}{side}<g{}/>", attributes(1000))), None).unwrap();
    }

    #[test]
    fn numbers_that_would_be_0_are_refused() {
        for (body, expected) in [
            ("<path d=\"M0,0L1e-400,1\"/>", "line 4: <path>: d: 1e-400 is too small"),
            ("<g transform=\"translate(1e-320)\"/>", "line 4: <g>: transform: 1e-320 is too small"),
            ("<rect id=\"r\" width=\"1e-400mm\"/>", "line 4: <rect id=\"r\">: width: 1e-400 is too small"),
        ] {
            let fault = super::super::parse(&drawing("", &format!("\n{body}")), None).unwrap_err();
            let what = format!("{}: {}", fault.place, fault.what);
            assert!(what.starts_with(expected), "{what}");
        }
        assert!(super::super::parse(&drawing("", "<path id=\"M1e-400\" d=\"M++1,0\"/>"), None).is_err());
    }
}
