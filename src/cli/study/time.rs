//! Times as they are given: a number with its unit.

use std::time::Duration;

/// Reads 90s, 55m or 1.5h.
pub(super) fn time(text: &str) -> Result<Duration, String> {
    let wrong = || "give a time with its unit, such as 90s, 55m or 2h".to_owned();
    let unit = match text.chars().last() {
        Some('s') => 1.0,
        Some('m') => 60.0,
        Some('h') => 3600.0,
        _ => return Err(wrong()),
    };
    let number: f64 = text[..text.len() - 1].parse().map_err(|_| wrong())?;
    Duration::try_from_secs_f64(number * unit).map_err(|_| wrong())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_its_unit() {
        let seconds = |text| time(text).map(|time| time.as_secs_f64());
        assert_eq!([seconds("90s"), seconds("55m"), seconds("1.5h")], [Ok(90.0), Ok(3300.0), Ok(5400.0)]);
        for wrong in ["", "90", "s", "-1s", "1d", "1e999h", "nans", "infs", "5 µ"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }
}
