//! Numbers in words, as people read them.

use glam::DVec2;
use tautline::geometry::number;

/// Four significant digits, in the plain way where that is short.
pub(super) fn short(x: f64) -> String {
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
pub(super) fn place(point: DVec2) -> String {
    format!("({}, {})", number(point.x), number(point.y))
}

/// So many of what one and several are called.
pub(super) fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { several })
}

/// The same with plain digits.
pub(super) fn plainly(count: u64, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// What is said of walls that were dropped.
pub(super) fn dropped(walls: usize) -> String {
    counted(walls as u64, "wall of zero length was dropped", "walls of zero length were dropped")
}

/// A count with commas between its thousands.
pub(super) fn grouped(count: u64) -> String {
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
