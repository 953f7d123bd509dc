//! Comments of style sheets, which stand wherever spaces may.

use std::collections::HashMap;

use roxmltree::Document;

/// The texts of a document that have comments, without these.
#[derive(Default)]
pub(super) struct Comments<'a>(HashMap<&'a str, String>);

impl<'a> Comments<'a> {
    /// Those of all attributes and style sheets. O(length).
    pub(super) fn of(document: &'a Document<'_>) -> Self {
        let sheets = document.descendants().filter(|node| node.tag_name().name() == "style");
        let sheets = sheets.flat_map(|node| node.children()).filter_map(|node| node.text());
        let attributes = document.descendants().flat_map(|node| node.attributes()).map(|attribute| attribute.value());
        let all = sheets.chain(attributes).filter(|text| text.contains("/*"));
        Comments(all.map(|text| (text, without(text))).collect())
    }

    /// `text`, one of the document's, without comments.
    pub(super) fn strip<'s>(&'s self, text: &'s str) -> &'s str {
        if text.contains("/*") { self.0.get(text).map_or(text, String::as_str) } else { text }
    }
}

/// `text` with a space for each comment outside strings and addresses; in selectors, where spaces
/// mean something, nothing. O(length).
fn without(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    // The spaces that stand for comments since the last mark.
    let mut spaces: Vec<usize> = Vec::new();
    let (mut from, mut quote) = (0, None);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let mut length = c.len_utf8();
        match (quote, c) {
            (_, '\\') => length += rest[length..].chars().next().map_or(0, char::len_utf8),
            (Some(mark), _) => quote = quote.filter(|_| c != mark),
            (None, '"' | '\'') => quote = Some(c),
            (None, '/') if rest.starts_with("/*") => {
                spaces.push(out.len());
                out.push(' ');
                rest = rest[2..].split_once("*/").map_or("", |(_, rest)| rest);
                continue;
            }
            (None, '(') if is_address(&out, &rest[1..]) => length = rest.find(')').unwrap_or(rest.len()),
            (None, '{' | ';' | '}') => {
                let is_selector = c == '{' && !out[from..].trim_start().starts_with('@');
                let head = out.split_off(from);
                let gone = |at: usize| is_selector && spaces.binary_search(&(from + at)).is_ok();
                out.extend(head.char_indices().filter(|&(at, _)| !gone(at)).map(|(_, c)| c));
                spaces.clear();
                from = out.len() + 1;
            }
            _ => {}
        }
        out += &rest[..length];
        rest = &rest[length..];
    }
    out
}

/// Whether an address without quotes begins here.
fn is_address(before: &str, inside: &str) -> bool {
    let name = before.len().checked_sub(3).and_then(|at| before.get(at..));
    name.is_some_and(|name| name.eq_ignore_ascii_case("url")) && !inside.trim_start().starts_with(['"', '\''])
}

#[cfg(test)]
mod tests {
    use super::without;

    #[test]
    fn comments_are_spaces_and_in_selectors_nothing() {
        for (text, expected) in [
            ("display:none/*x*/", "display:none "),
            ("display/*y*/:/**/none", "display : none"),
            ("a/*x*/.b/* { */{r:1px/* } */;}", "a.b{r:1px ;}"),
            ("@media/**/all{a/**/{r:/**/1px}}", "@media all{a{r: 1px}}"),
            ("fill:url(/*x*/)", "fill:url(/*x*/)"),
            ("fill:url( '/*' )/**/red", "fill:url( '/*' ) red"),
            ("d:'/*'\\/*/", "d:'/*'\\/*/"),
            ("r:1px/* never ends", "r:1px "),
            ("é/*é*/é", "é é"),
        ] {
            assert_eq!(without(text), expected, "{text}");
        }
    }
}
