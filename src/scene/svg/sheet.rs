//! The text of style sheets: rules that say something that matters, and what is not understood.

use std::collections::BTreeSet;
use std::rc::Rc;

use simplecss::Selector;

use super::super::excerpt;
use super::properties::property;

/// A rule for the elements that its selector matches.
pub(super) struct Rule<'a> {
    pub(super) selector: Selector<'a>,
    pub(super) declarations: Rc<[Declaration<'a>]>,
}

/// What a rule or the attribute `style` says of a property that matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Declaration<'a> {
    pub(super) property: &'static str,
    pub(super) value: &'a str,
    pub(super) important: bool,
}

/// What is not understood and may matter: how many things, and some of them.
#[derive(Default)]
pub(super) struct Unread {
    count: usize,
    some: BTreeSet<String>,
}

impl Unread {
    const NAMED: usize = 3;

    pub(super) fn add(&mut self, what: &str) {
        self.count += 1;
        if self.some.len() < Self::NAMED {
            self.some.insert(excerpt(what));
        }
    }

    /// A sentence about it, if there is any.
    pub(super) fn note(&self) -> Option<String> {
        let some: Vec<&str> = self.some.iter().map(String::as_str).collect();
        (self.count > 0)
            .then(|| format!("styles that are not understood and passed over: {} ({})", self.count, some.join(", ")))
    }
}

/// At-rules that never say where or whether a shape is drawn.
const HARMLESS: [&str; 4] = ["charset", "font-face", "namespace", "page"];

/// How deep rules for media may lie in each other.
const DEPTH_MAX: usize = 8;

/// Adds the rules of a style sheet to `rules`, in order. O(length).
pub(super) fn parse<'a>(text: &'a str, rules: &mut Vec<Rule<'a>>, unread: &mut Unread) {
    nested(text, rules, unread, 0);
}

fn nested<'a>(mut text: &'a str, rules: &mut Vec<Rule<'a>>, unread: &mut Unread, depth: usize) {
    loop {
        text = trimmed(text);
        if text.is_empty() {
            return;
        }
        let named = text.strip_prefix('@');
        let (head, end) = until(text, if named.is_some() { "{;" } else { "{" });
        let body = match end {
            Some('{') => {
                let rest = &text[head.len() + 1..];
                let (body, _) = until(rest, "}");
                text = rest.get(body.len() + 1..).unwrap_or_default();
                Some(body)
            }
            _ => {
                text = text.get(head.len() + 1..).unwrap_or_default();
                None
            }
        };
        match (named, body) {
            (Some(named), body) => {
                let name = &named[..named.find(|c: char| !c.is_alphanumeric() && c != '-').unwrap_or(named.len())];
                let media = head[1 + name.len()..].split(',').map(str::trim);
                match body {
                    Some(body)
                        if depth < DEPTH_MAX
                            && name.eq_ignore_ascii_case("media")
                            && media.into_iter().any(|m| matches!(m, "all" | "screen")) =>
                    {
                        nested(body, rules, unread, depth + 1);
                    }
                    _ if HARMLESS.iter().any(|harmless| name.eq_ignore_ascii_case(harmless)) => {}
                    _ => unread.add(&format!("@{name}")),
                }
            }
            (None, Some(body)) => {
                let declarations: Rc<[Declaration<'a>]> = declarations(body).collect();
                if declarations.is_empty() {
                    continue;
                }
                if pieces(head, ',').any(|selector| is_broken(selector.trim())) {
                    unread.add(head.trim());
                    continue;
                }
                for selector in pieces(head, ',') {
                    match Selector::parse(selector.trim()) {
                        Some(selector) => rules.push(Rule { selector, declarations: Rc::clone(&declarations) }),
                        None => unread.add(selector.trim()),
                    }
                }
            }
            (None, None) => unread.add(head),
        }
    }
}

/// Whether this is no selector of any kind, so that nobody heeds the rule.
fn is_broken(selector: &str) -> bool {
    let combines = ['>', '+', '~'];
    let is_name = |c: char| c.is_alphanumeric() || "-_\\".contains(c) || !c.is_ascii();
    let plain = selector.split(['[', '(', '"', '\'']).next().unwrap_or_default();
    let mut marks = plain.match_indices(['.', '#', ':']).map(|(at, _)| &plain[at + 1..]);
    selector.is_empty()
        || selector.starts_with(combines)
        || selector.ends_with(combines)
        || marks.any(|rest| !rest.starts_with(|c: char| is_name(c) || c == ':'))
}

/// The declarations of `text` that matter, in order.
pub(super) fn declarations(text: &str) -> impl Iterator<Item = Declaration<'_>> {
    pieces(text, ';').filter_map(|piece| {
        let (name, value) = trimmed(piece).split_once(':')?;
        let property = property(name.trim())?;
        let value = value.trim();
        let plain = value.rsplit_once('!').filter(|(_, word)| word.trim().eq_ignore_ascii_case("important"));
        let (value, important) = plain.map_or((value, false), |(value, _)| (value.trim_end(), true));
        (!value.is_empty()).then_some(Declaration { property, value, important })
    })
}

/// `text` cut at a mark outside brackets, strings and comments.
fn pieces(text: &str, mark: char) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    let mut buffer = [0; 4];
    let mark: String = mark.encode_utf8(&mut buffer).into();
    std::iter::from_fn(move || {
        let text = rest?;
        let (piece, end) = until(text, &mark);
        rest = end.map(|end| &text[piece.len() + end.len_utf8()..]);
        Some(piece)
    })
}

/// Without spaces and comments, those of HTML's kind too, before it.
fn trimmed(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        text = if let Some(comment) = text.strip_prefix("/*") {
            comment.split_once("*/").map_or("", |(_, rest)| rest)
        } else if let Some(rest) = text.strip_prefix("<!--").or(text.strip_prefix("-->")) {
            rest
        } else {
            return text;
        }
    }
}

/// `text` before the first of `marks` outside brackets, strings and comments, and which it is; all of it if there is
/// none.
fn until<'a>(text: &'a str, marks: &str) -> (&'a str, Option<char>) {
    let (mut open, mut quote) = (0usize, None);
    let mut chars = text.char_indices();
    while let Some((at, c)) = chars.next() {
        match (quote, c) {
            (_, '\\') => _ = chars.next(),
            (Some(mark), _) => quote = quote.filter(|_| c != mark),
            (None, '"' | '\'') => quote = Some(c),
            (None, '/') if text[at..].starts_with("/*") => {
                let end = text[at + 2..].find("*/").map_or(text.len(), |end| at + 2 + end + 2);
                while chars.clone().next().is_some_and(|(i, _)| i < end) {
                    chars.next();
                }
            }
            (None, c) if open == 0 && marks.contains(c) => return (&text[..at], Some(c)),
            (None, '(' | '[' | '{') => open += 1,
            (None, ')' | ']' | '}') => open = open.saturating_sub(1),
            _ => {}
        }
    }
    (text, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Vec<String>, Option<String>) {
        let (mut rules, mut unread) = (Vec::new(), Unread::default());
        parse(text, &mut rules, &mut unread);
        let of = |rule: &Rule<'_>| {
            let all = rule.declarations.iter();
            let all = all.map(|d| format!("{}:{}{}", d.property, d.value, if d.important { "!" } else { "" }));
            format!("{} {}", rule.selector, all.collect::<Vec<_>>().join(";"))
        };
        (rules.iter().map(of).collect(), unread.note())
    }

    #[test]
    fn rules_are_cut_where_they_end() {
        let text = "/* { */ <!-- .a, g > .b { Fill : none ;; color:red; stroke:url('a;}b') ! important } -->
            #c{d:path('M0 0;}');r:1px}.empty{font:x}";
        let (rules, note) = read(text);
        let both = "fill:none;stroke:url('a;}b')!";
        let expected = [format!("*[class~='a'] {both}"), format!("g > *[class~='b'] {both}")];
        assert_eq!(rules[..2], expected);
        assert_eq!(rules[2..], ["*[id='c'] d:path('M0 0;}');r:1px"]);
        assert_eq!(note, None);
        assert_eq!(read("a{r:1px /* } */ ; /* x */ cx:2px").0, ["a r:1px /* } */;cx:2px"]);
    }

    #[test]
    fn what_is_not_understood_is_counted() {
        let media = "@media screen{a{r:1px}} @media all, print {b{r:1px}} @media print{c{r:1px}}";
        assert_eq!(read(media).0, ["a r:1px", "b r:1px"]);
        let text = "@import 'x.css'; @font-face{src:x} d:not(.e), f{r:1px} g:nth-child(2){font:x} h ~ i{r:1px}";
        let (rules, note) = read(&[media, text].concat());
        assert_eq!(rules.len(), 3);
        let expected = "styles that are not understood and passed over: 4 (@import, @media, d:not(.e))";
        assert_eq!(note.as_deref(), Some(expected));
        for broken in ["a", "{", "}", "a{", "@", "@media", "a{r", "a{r:", "/*", "'", "a{}}b{r:1px}", "\\"] {
            read(broken);
        }
        for (list, names) in [(".b,,", ".b,,"), (".b,", ".b,"), ("a >, b", "a >, b"), ("a, .", "a, .")] {
            let note = format!("styles that are not understood and passed over: 1 ({names})");
            assert_eq!(read(&format!("{list}{{r:1px}}")), (Vec::new(), Some(note)), "{list}");
        }
    }
}
