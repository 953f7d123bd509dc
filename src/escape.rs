//! Text from outside as people get to see it: without characters that a terminal obeys.
//!
//! A layer's name, a string in JSON or the name of a file may hold escape sequences, which change colours, move the
//! cursor over what was printed before or type into the terminal. All that is printed goes through here.

use std::borrow::Cow;
use std::path::Path;

/// Whether a terminal obeys `c` instead of showing it: control characters, and those that turn the direction of
/// writing.
fn is_obeyed(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns
}

/// `text` with every character that a terminal obeys written as `\u{1b}`, line ends as `\n`. O(length); most text is
/// not copied.
///
/// ```
/// use tautline::escape::escaped;
/// assert_eq!(escaped("walls\n\x1b[31m"), r"walls\n\u{1b}[31m");
/// assert_eq!(escaped("Wände, 壁"), "Wände, 壁");
/// ```
pub fn escaped(text: &str) -> Cow<'_, str> {
    escape(text, is_obeyed, |c| c.escape_default().to_string())
}

/// [`escaped`] for text of several lines: line ends stay, and tabulators.
pub fn escaped_lines(text: &str) -> Cow<'_, str> {
    escape(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'), |c| c.escape_default().to_string())
}

/// [`escaped_lines`] for a JSON document, which means the same afterwards: such characters can only stand in strings.
pub fn escaped_json(document: &str) -> Cow<'_, str> {
    // All of them lie below U+10000, so one escape is enough.
    escape(document, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'), |c| format!("\\u{:04x}", u32::from(c)))
}

/// The name of a file, [`escaped`].
pub fn escaped_path(path: &Path) -> String {
    escaped(&path.to_string_lossy()).into_owned()
}

fn escape(text: &str, which: impl Fn(char) -> bool, how: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(&which) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if which(c) { shown += &how(c) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn nothing_is_left_to_obey() {
        assert_eq!(escaped("a\r\nb\t\u{7f}\u{9b}31m\u{202e}"), r"a\r\nb\t\u{7f}\u{9b}31m\u{202e}");
        assert_eq!(escaped_lines("a\r\nb\tc\x07"), "a\\r\nb\tc\\u{7}");
        assert!(matches!(escaped_lines("Wände\n壁"), Cow::Borrowed(_)));
        assert_eq!(escaped_path(Path::new("a\nb\x1b.csv")), r"a\nb\u{1b}.csv");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn json_means_the_same_afterwards(text in "\\PC*[\u{0}-\u{9f}\u{2028}\u{202e}]*\\PC*") {
            let document = serde_json::to_string_pretty(&[&text]).unwrap();
            let shown = escaped_json(&document);
            prop_assert!(!shown.contains(|c| is_obeyed(c) && c != '\n'));
            prop_assert_eq!(serde_json::from_str::<[String; 1]>(&shown).unwrap(), [text]);
        }
    }
}
