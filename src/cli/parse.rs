//! Numbers and points of the command line.

use glam::DVec2;
use tautline::parse_number as number;

/// A number above 0.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    let number = number(text).filter(|&x| x > 0.0 && x.is_finite());
    number.ok_or_else(|| "give a number above 0, such as 0.01".to_owned())
}

/// Two numbers with a comma between them.
pub(crate) fn point(text: &str) -> Result<DVec2, String> {
    let wrong = || "give two numbers with a comma between them, such as 1.5,-2".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    Ok(DVec2::new(number(x).ok_or_else(wrong)?, number(y).ok_or_else(wrong)?))
}

/// A number of bytes.
pub(crate) fn memory(text: &str) -> Result<usize, String> {
    let wrong = || "give a number of bytes from 1 up, with a unit, such as 512M or 2G".to_owned();
    let (number, unit) = text.split_at(text.find(|c: char| !c.is_ascii_digit()).ok_or_else(wrong)?);
    let power = match unit.to_ascii_uppercase().trim_end_matches('B').trim_end_matches('I') {
        "K" => 10,
        "M" => 20,
        "G" => 30,
        "T" => 40,
        _ => return Err(wrong()),
    };
    let bytes = number.parse::<usize>().ok().and_then(|n| n.checked_mul(1 << power));
    bytes.filter(|&n| n > 0).ok_or_else(wrong)
}

/// A stride: of so many points one is used.
pub(crate) fn stride(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|&k| k > 0);
    number.ok_or_else(|| format!("give a whole number from 1 to {}, such as 4", u32::MAX))
}
