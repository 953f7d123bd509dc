//! Numbers as text.
//!
//! What is read must be what was meant: the parsers of the formats round `1e-400` to 0 in silence, and one of them
//! drops a plus in front of a second one.

use std::ops::Range;

/// Why a text is no number that can be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberFault {
    /// Another text.
    NoNumber,
    /// Not zero, but nearer to it than f64 can tell apart with all its digits.
    Vanishes,
}

/// How small numbers are named that vanish.
pub(crate) const VANISHES: &str = "too small for a number of 64 bits, and not 0; write 0 if that is meant";

/// The number that `text` is: digits with an optional sign, point and exponent. Infinities and NaN, which have names,
/// are read too; whether they are allowed the caller knows.
pub(crate) fn parse(text: &str) -> Result<f64, NumberFault> {
    let number: f64 = text.parse().map_err(|_| NumberFault::NoNumber)?;
    if number.abs() < f64::MIN_POSITIVE && vanishes(text, number) { Err(NumberFault::Vanishes) } else { Ok(number) }
}

/// The number that `text` is, as on a command line: with white space around it, but nothing else. `None` too for a
/// number that is not 0 and so small that f64 cannot hold it with all its digits.
///
/// ```
/// use tautline::parse_number;
/// assert_eq!([" -2.5e3", "1e-400", "++1", "1,5"].map(parse_number), [Some(-2500.0), None, None, None]);
/// ```
pub fn parse_number(text: &str) -> Option<f64> {
    parse(text.trim()).ok()
}

/// Whether a number smaller than all normal ones is not meant to be zero.
#[cold]
fn vanishes(text: &str, number: f64) -> bool {
    let digits = text.split(['e', 'E']).next().unwrap_or_default();
    number != 0.0 || digits.bytes().any(|b| matches!(b, b'1'..=b'9'))
}

/// The first number in `text`, which has others and single letters between them, that vanishes.
pub(crate) fn vanishing(text: &str) -> Option<Range<usize>> {
    // Most text has no exponent, nor as many digits.
    if !text.contains(['e', 'E']) && text.len() < 300 {
        return None;
    }
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        at += numeral(&bytes[at..]);
        let number = &text[start..at];
        let may = number.len() >= 300 || number.contains(['e', 'E']);
        if may && parse(number) == Err(NumberFault::Vanishes) {
            return Some(start..at);
        }
        at = at.max(start + 1);
        while !text.is_char_boundary(at) {
            at += 1;
        }
    }
    None
}

/// How many bytes the number has with which `bytes` begin.
fn numeral(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut at = sign(0);
    at += digits(at);
    if bytes.get(at) == Some(&b'.') {
        at += 1 + digits(at + 1);
    }
    if let Some(b'e' | b'E') = bytes.get(at) {
        let start = at + 1 + sign(at + 1);
        if digits(start) > 0 {
            at = start + digits(start);
        }
    }
    at
}

/// The first word in `text` that begins as numbers do and is none, or vanishes.
pub(crate) fn wrong(text: &str) -> Option<(Range<usize>, NumberFault)> {
    // NaN and infinities may have a sign.
    let named = |at: &Range<usize>| {
        let next = text.as_bytes().get(at.end);
        matches!(&text[at.clone()], "+" | "-") && next.is_some_and(u8::is_ascii_alphabetic)
    };
    tokens(text).filter(|at| !named(at)).find_map(|at| parse(&text[at.clone()]).err().map(|fault| (at, fault)))
}

/// The words in `text` that begin with a digit, a sign or a point, and go on with such and exponents.
fn tokens(text: &str) -> impl Iterator<Item = Range<usize>> {
    let bytes = text.as_bytes();
    let numeral = |b: u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.');
    let word = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b >= 0x80;
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < bytes.len() {
            if numeral(bytes[at]) {
                let length = bytes[at..].iter().take_while(|&&b| numeral(b) || matches!(b, b'e' | b'E')).count();
                at += length;
                return Some(at - length..at);
            }
            // The rest of a name is no number, whatever digits it has.
            at += bytes[at..].iter().take_while(|&&b| word(b)).count().max(1);
        }
        None
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_is_read_is_what_was_meant() {
        for zero in ["0", "-0.000", "0e-400", "+.0e5", "0E9"] {
            assert_eq!(parse(zero), Ok(0.0), "{zero}");
        }
        let long = format!("0.{}1", "0".repeat(400));
        for small in ["1e-400", "-1E-324", "4.9e-324", "2.2250738585072009e-308", "0.00000000001e-320", &long] {
            assert_eq!(parse(small), Err(NumberFault::Vanishes), "{small}");
        }
        assert_eq!(parse("2.2250738585072014e-308"), Ok(f64::MIN_POSITIVE));
        for text in ["++1", "+-1", "1e", "1e5.5", "", "1,5", "1_000", "0x10", "--1", "1-2", "."] {
            assert_eq!(parse(text), Err(NumberFault::NoNumber), "{text}");
        }
        assert_eq!(parse("1e400"), Ok(f64::INFINITY));
    }

    #[test]
    fn numbers_are_found_among_other_text() {
        assert_eq!(vanishing("M1e-5,2L1e-400 3"), Some(8..14));
        assert_eq!(vanishing("M1-2-1e-400é"), Some(4..11));
        assert_eq!(vanishing("rotate(1e-5) ée 0e-400 1e 1em"), None);
        assert_eq!(wrong("LINESTRING(1 2, ++1 0)"), Some((16..19, NumberFault::NoNumber)));
        assert_eq!(wrong("POLYGON Z ((1 2 nan, 1e-400 0))"), Some((21..27, NumberFault::Vanishes)));
        assert_eq!(wrong("LINESTRING(1 -2.5e+3,.5 +7)"), None);
        assert_eq!(wrong("POINT ZM (1 2 -nan +Inf)"), None);
        assert_eq!(wrong("POINT (1 - 2)"), Some((9..10, NumberFault::NoNumber)));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn all_normal_numbers_are_taken(x in prop::num::f64::NORMAL | prop::num::f64::ZERO) {
            for text in [format!("{x}"), format!("{x:?}"), format!("{x:e}")] {
                prop_assert_eq!(parse(&text), Ok(x));
                prop_assert_eq!(wrong(&text), None);
            }
        }

        #[test]
        fn no_other_number_is_taken(x in prop::num::f64::SUBNORMAL) {
            let text = format!("({x:e})");
            prop_assert_eq!(vanishing(&text), Some(1..text.len() - 1));
        }
    }
}
