//! Which points are worth taking.

use super::point::Point;

/// Marks the points than which no other is better in one respect and as good in the rest.
pub(super) fn mark(points: &mut [Point]) {
    let costs: Vec<[f64; 4]> = points.iter().map(costs).collect();
    for (i, point) in points.iter_mut().enumerate() {
        point.pareto = !costs.iter().any(|other| is_better(other, &costs[i]));
    }
}

/// What is to be small. A method that keeps no events has all of them wrong.
fn costs(point: &Point) -> [f64; 4] {
    let events = point.event_mismatch.map_or(f64::INFINITY, |count| point.share(count));
    [point.ns_per_step.median, events, point.share(point.final_mismatch), point.length_error.mean]
}

fn is_better(one: &[f64; 4], other: &[f64; 4]) -> bool {
    one.iter().zip(other).all(|(a, b)| a <= b) && one != other
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_gives_way_to_one_that_is_nowhere_worse() {
        let exact_but_slow = [30.0, 0.0, 0.0, 0.0];
        assert!(is_better(&[20.0, 0.0, 0.0, 0.0], &exact_but_slow));
        assert!(!is_better(&exact_but_slow, &[20.0, 0.0, 0.0, 0.0]));
        // One without events takes no place of one that has them.
        assert!(!is_better(&[20.0, f64::INFINITY, 0.0, 0.0], &exact_but_slow));
        // Each has something for itself.
        let fast_but_wrong = [10.0, 0.5, 0.2, 1e-3];
        assert!(!is_better(&fast_but_wrong, &exact_but_slow) && !is_better(&exact_but_slow, &fast_but_wrong));
        // Equal ones both stay.
        assert!(!is_better(&fast_but_wrong, &fast_but_wrong));
        assert!(is_better(&[10.0, 0.5, 0.1, 1e-3], &fast_but_wrong));
    }
}
