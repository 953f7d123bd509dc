//! Numbers in words, as people read them, and tables of them.

use glam::DVec2;

use crate::geometry::number;

/// What stands in a table where there is no number.
pub const NONE: &str = "-";

/// Four significant digits, in the plain way where that is short.
///
/// ```
/// use tautline::words::short;
/// assert_eq!([0.0, 0.25, 1234.56, 2e7].map(short), ["0", "0.2500", "1235", "2.000e7"]);
/// ```
pub fn short(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.3e}")
    }
}

/// A point, with exponents where plain digits would be many.
///
/// ```
/// assert_eq!(tautline::words::place([1.5, -2.0].into()), "(1.5, -2)");
/// ```
pub fn place(point: DVec2) -> String {
    format!("({}, {})", number(point.x), number(point.y))
}

/// So many of what one and several are called.
///
/// ```
/// use tautline::words::counted;
/// assert_eq!(counted(1, "wall", "walls"), "1 wall");
/// assert_eq!(counted(12345, "wall", "walls"), "12,345 walls");
/// ```
pub fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { several })
}

/// [`counted`] with plain digits.
///
/// ```
/// assert_eq!(tautline::words::plainly(12345, "wall", "walls"), "12345 walls");
/// ```
pub fn plainly(count: u64, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// A count with commas between its thousands.
///
/// ```
/// assert_eq!([7, 1000, 1234567].map(tautline::words::grouped), ["7", "1,000", "1,234,567"]);
/// ```
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A share of a whole in percent, as [`short`] has it.
///
/// ```
/// assert_eq!(tautline::words::percent(0.125), "12.50 %");
/// ```
pub fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// Lines of as many cells, all columns as wide as they need be: the first `left` stand on the left, the others on the
/// right.
///
/// ```
/// let lines = [["name", "n"], ["a", "10"]].map(|line| line.map(str::to_owned).to_vec());
/// assert_eq!(tautline::words::aligned(1, &lines), "name   n\na     10\n");
/// ```
///
/// # Panics
///
/// If a line has fewer cells than the first.
pub fn aligned(left: usize, lines: &[Vec<String>]) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let padded = line.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column < left {
            true => format!("{cell:width$}"),
            false => format!("{cell:>width$}"),
        });
        text += padded.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}
