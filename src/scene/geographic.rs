//! Whether coordinates are longitude and latitude, in which no length is a length.

use glam::DVec2;

/// What is said of them.
pub(super) const WARNING: &str = "these coordinates look like longitude and latitude; a length in degrees is no \
    length: project the scene and its traces to metres first (to a UTM zone, for one)";

/// Whether these points look like places on earth in decimal degrees, where the file does not say.
///
/// They do where all lie within 180 and 90, where three of four coordinates have more than three decimals, and where
/// the box round them is no larger than its distance from the origin. Whole numbers and plans drawn to the centimetre
/// do not; neither does anything drawn about or beside an origin of its own. Maps of more than a continent and places
/// in the Gulf of Guinea are missed.
pub(super) fn looks_so(points: &[DVec2]) -> bool {
    let Some(box_) = points.iter().map(|&p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) else {
        return false;
    };
    let [low, high] = box_;
    let within = low.x >= -180.0 && high.x <= 180.0 && low.y >= -90.0 && high.y <= 90.0;
    let nearest = DVec2::ZERO.clamp(low, high);
    let apart = nearest.length() >= (high - low).max_element();
    within && apart && decimals(points)
}

fn decimals(points: &[DVec2]) -> bool {
    let fine = |c: &f64| {
        let thousands = c * 1000.0;
        (thousands - thousands.round()).abs() > 1e-6
    };
    let count = points.iter().flat_map(|p| [p.x, p.y]).filter(fine).count();
    count * 4 >= points.len() * 2 * 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn towns_are_recognised_and_plans_are_not() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let berlin = [p(13.37771, 52.51628), p(13.40952, 52.52083), p(13.40110, 52.51907)];
        let london = [p(-0.12462, 51.50072), p(-0.07539, 51.50548)];
        let germany = [p(5.8663, 47.2701), p(15.0419, 55.0581)];
        for places in [&berlin[..], &london, &germany] {
            assert!(looks_so(places), "{places:?}");
        }
        let unit_square = [p(0.12345, 0.45678), p(0.91234, 0.05671), p(-0.51237, 0.77777)];
        let plan = [p(12.25, 40.5), p(12.75, 40.5), p(12.75, 41.125)];
        let metres = [p(390123.4567, 5820123.4567), p(390130.1234, 5820125.4321)];
        let far = [p(13.37771, 152.51628), p(13.40952, 152.52083)];
        let room = [p(2.12345, 3.45678), p(12.12345, 9.45678)];
        for places in [&unit_square[..], &plan, &metres, &far, &room, &[]] {
            assert!(!looks_so(places), "{places:?}");
        }
    }
}
