//! Numbers as people read them: no more digits than are known, and room for them.

use crate::study::Estimate;

/// The decimal exponent of `x`: 2 for 123. Exact, unlike a logarithm, and the same on every machine.
pub(super) fn exponent(x: f64) -> i32 {
    let text = format!("{:e}", x.abs());
    text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// Ten to the power of `n`.
pub(super) fn power(n: i32) -> f64 {
    format!("1e{n}").parse().unwrap_or(f64::INFINITY)
}

/// Ten to the power of `n`, as a text.
pub(super) fn power_text(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = n.unsigned_abs().to_string();
    let digits = digits.bytes().map(|d| DIGITS[usize::from(d - b'0')]);
    "10".chars().chain((n < 0).then_some('⁻')).chain(digits).collect()
}

/// `x` with that many decimals.
pub(super) fn fixed(x: f64, decimals: i32) -> String {
    let text = format!("{:.*}", decimals.clamp(0, 17) as usize, x);
    let digits = text.trim_start_matches('-');
    let zero = digits.bytes().all(|c| matches!(c, b'0' | b'.'));
    let (whole, rest) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    format!("{}{}{rest}", if zero || !text.starts_with('-') { "" } else { "−" }, grouped(whole))
}

/// A count.
pub(super) fn count(n: u64) -> String {
    grouped(&n.to_string())
}

/// So many of what one and several are called.
pub(super) fn counted(n: u64, one: &str, several: &str) -> String {
    format!("{} {}", count(n), if n == 1 { one } else { several })
}

/// Digits in groups of three if there are more than four of them.
fn grouped(digits: &str) -> String {
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && digits.len() > 4 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202F}');
        }
        out.push(c);
    }
    out
}

/// `x` where `resolution` is the least that matters; four digits where that is not known.
pub(super) fn number(x: f64, resolution: Option<f64>) -> String {
    if !x.is_finite() {
        return "?".into();
    }
    let decimals = match resolution {
        // Two digits of what matters if the first of them is low, else one.
        Some(r) if r > 0.0 && r.is_finite() => i32::from(r < 3.55 * power(exponent(r))) - exponent(r),
        _ if x == 0.0 => 0,
        _ => 3 - exponent(x),
    };
    let size = exponent(x);
    if x != 0.0 && !(-4..7).contains(&size) && decimals + size >= 0 {
        let mantissa = format!("{:e}", x).split_once('e').and_then(|(m, _)| m.parse().ok()).unwrap_or(x);
        return format!("{}×{}", fixed(mantissa, (decimals + size).min(8)), power_text(size));
    }
    let text = fixed(x, decimals.min(8));
    match resolution {
        Some(_) => text,
        // Nothing says that its last zeros are known.
        None if text.contains('.') => text.trim_end_matches('0').trim_end_matches('.').into(),
        None => text,
    }
}

/// What matters of an estimate: half its interval, else its standard error.
pub(super) fn resolution(e: &Estimate) -> Option<f64> {
    let half = e.low.zip(e.high).map(|(low, high)| (high - low) / 2.0);
    half.filter(|&h| h > 0.0).or(e.error.filter(|&s| s > 0.0))
}

/// An estimate and its interval: `12.3 (11.9–12.7)`.
pub(super) fn estimate(e: &Estimate) -> String {
    let value = number(e.value, resolution(e));
    interval(e).map_or(value.clone(), |interval| format!("{value} ({interval})"))
}

/// Only the interval: `11.9–12.7`.
pub(super) fn interval(e: &Estimate) -> Option<String> {
    let (low, high) = e.low.zip(e.high)?;
    let ends = [low, high].map(|x| number(x, resolution(e)));
    let dash = if ends.iter().any(|x| x.contains('−')) { " to " } else { "–" };
    Some(ends.join(dash))
}

/// A share and its interval in per cent: `12.3 % (11.9–12.7)`.
pub(super) fn percent(e: &Estimate) -> String {
    let e = scaled(e, 100.0);
    let value = number(e.value, resolution(&e));
    interval(&e).map_or(format!("{value} %"), |interval| format!("{value} % ({interval})"))
}

/// An estimate in another unit.
pub(super) fn scaled(e: &Estimate, by: f64) -> Estimate {
    let times = |x: Option<f64>| x.map(|x| x * by);
    Estimate { value: e.value * by, error: times(e.error), low: times(e.low), high: times(e.high) }
}

/// About how wide `text` is in letters of that size, rather too wide: letters of DejaVu Sans, the widest usual one.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|c| match c {
        '.' | ',' | ':' | ';' | '(' | ')' | 'i' | 'j' | 'l' | '|' | ' ' | '\'' | 'I' => 0.36,
        't' | 'f' | 'r' | '-' | '\u{202F}' | '⁰'..='⁹' | '¹' | '²' | '³' | '⁻' => 0.43,
        'm' | 'w' | 'M' | 'W' | '%' | '−' | '×' | '≤' | '≥' => 0.95,
        _ => 0.64,
    });
    ems.sum::<f64>() * size
}

/// `text` with as many of its letters as are about that wide at the usual size.
pub(super) fn shortened(text: &str, most: f64) -> String {
    if width(text, 12.0) <= most {
        return text.to_owned();
    }
    let mut letters: Vec<char> = text.chars().collect();
    while !letters.is_empty() && width(&letters.iter().chain(&['…']).collect::<String>(), 12.0) > most {
        letters.pop();
    }
    letters.into_iter().chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_as_long_as_there_is_room_for() {
        assert_eq!(shortened("short", 100.0), "short");
        let long = shortened("a very long name of something", 60.0);
        assert!(long.starts_with("a v") && long.ends_with('…') && width(&long, 12.0) <= 60.0, "{long}");
        assert_eq!(shortened("none", 0.0), "…");
    }

    #[test]
    fn numbers_show_what_is_known() {
        let estimate_of = |value, half: f64| {
            estimate(&Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) })
        };
        assert_eq!(estimate_of(12.345678, 0.41), "12.3 (11.9–12.8)");
        assert_eq!(estimate_of(-1.5, 2.0), "−1.5 (−3.5 to 0.5)");
        assert_eq!(estimate_of(1.5e9, 2e7), "1.500×10⁹ (1.480×10⁹–1.520×10⁹)");
        assert_eq!(estimate_of(31_415.9, 120.0), "31\u{202F}416 (31\u{202F}296–31\u{202F}536)");
        assert_eq!(number(0.5, None), "0.5");
        assert_eq!(number(100.0, None), "100");
        assert_eq!(number(2.5e-9, None), "2.500×10⁻⁹");
        assert_eq!(number(0.0, None), "0");
        assert_eq!(percent(&Estimate { value: 1.0, error: None, low: None, high: None }), "100 %");
    }
}
