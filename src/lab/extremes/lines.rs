//! Wall ends all but on one line, and walls all but parallel.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{around, case, model, nudged, p, way};

/// How many steps there are from 1 to 2^40 units in the last place.
const POWERS: usize = 41;

/// Fans of rays, each with three wall ends that would lie on it but for 1 to 2^40 units in the last place. The trace
/// goes over the far end of each, back and forth, and onto it.
pub(super) fn near_lines() -> Vec<Extreme> {
    let mut cases = Vec::new();
    for (centre, shift) in [(p(0.0, 0.0), 0), (p(0.1, 0.2), 7), (p(1000.0 / 3.0, -1e-3), 19)] {
        for (off, how) in [([1, 2], "off to one side"), ([1, -1], "off to both sides"), ([0, 1], "the last one off")] {
            cases.push(fan(centre, shift, off, format!("{how}, about {centre}")));
        }
    }
    cases
}

fn fan(centre: DVec2, shift: usize, off: [i64; 2], name: String) -> Extreme {
    let ray = |i: usize| square(i as f64 / POWERS as f64 + 1e-3);
    let mut walls = Vec::new();
    let mut tips = Vec::new();
    for i in 0..POWERS {
        let (way, ulps) = (ray(i), 1i64 << ((i + shift) % POWERS));
        let aside = |end: DVec2, by: i64| p(nudged(end.x, ulps * by), nudged(end.y, -ulps * by));
        let ends = [centre + way, aside(centre + 2.0 * way, off[0]), aside(centre + 3.0 * way, off[1])];
        walls.extend(ends.map(|end| [end, end + 0.02 * way.perp()]));
        tips.push(ends[2]);
    }
    let model = model(&walls, centre);
    // On the right of the ray, on it or nearly, and on the left.
    let stops = (0..POWERS).flat_map(|i| {
        let way = ray(i);
        let at = |far: f64, left: f64| centre + far * way + left * way.perp();
        let near = |ulps: i64| p(nudged(at(4.0, 0.0).x, ulps), at(4.0, 0.0).y);
        let over = [at(4.0, 0.05), at(4.0, -0.05), near(0), near(2), near(-2), near(0), at(4.0, -0.05)];
        let onto = [tips[i], at(4.0, 0.05), at(4.0, -0.05)];
        [at(0.3, -0.05), at(4.0, -0.05)].into_iter().chain(over).chain(onto).chain([at(0.3, -0.05)])
    });
    let mut stops: Vec<DVec2> = stops.collect();
    let forth = way(&model, stops.len(), next_of(&stops));
    stops.reverse();
    let back = way(&model, stops.len(), next_of(&stops));
    case(name, walls, centre, [forth, back])
}

/// One stop after the other.
fn next_of(stops: &[DVec2]) -> impl FnMut(DVec2) -> DVec2 {
    let mut stops = stops.iter().copied();
    move |here| stops.next().unwrap_or(here)
}

/// The point after `share` of the way round the square from (-1, -1) to (1, 1).
fn square(share: f64) -> DVec2 {
    let side = 4.0 * share;
    let along = p(1.0, 2.0 * (side - side.floor()) - 1.0);
    (0..side as usize % 4).fold(along, |way, _| way.perp())
}

/// Thin boxes on top of each other with gaps as thin between them, through which the trace winds there and back; level
/// and tilted, and two walls that point at each other.
pub(super) fn needles() -> Vec<Extreme> {
    let mut cases = Vec::new();
    for k in 3..=15 {
        let thin = 10f64.powi(-k);
        for (base, slope) in [(0.0, 0.0), (1.0, 0.0), (0.0, 0.3), (1.0, 1.0 / 3.0)] {
            // A tilt rounds off as much as the gaps are wide.
            if slope == 0.0 || base == 0.0 || k < 15 {
                cases.push(stack(
                    thin,
                    base,
                    slope,
                    format!("10^{k} times as long as wide, at {base}, slope {slope:.1}"),
                ));
            }
        }
        cases.push(points(thin, format!("a gap of 10^-{k} between two points")));
    }
    cases
}

fn stack(thin: f64, base: f64, slope: f64, name: String) -> Extreme {
    let at = |x: f64, layer: f64| p(x, base + layer * thin + slope * x);
    let walls: Vec<_> = (0..5)
        .flat_map(|k| {
            let [low, high] = [2 * k, 2 * k + 1].map(f64::from);
            around(&[at(0.0, low), at(1.0, low), at(1.0, high), at(0.0, high)])
        })
        .collect();
    let anchor = p(-0.5, base - 0.5);
    // Through the gaps, to the right and to the left in turns, then back through some of them.
    let ends = |gap: i32| {
        let layer = f64::from(2 * gap) + 1.5;
        let ends = [at(-0.25, layer), at(1.25, layer)];
        if gap % 2 == 0 { ends } else { [ends[1], ends[0]] }
    };
    let mut stops: Vec<DVec2> = (0..4).flat_map(ends).collect();
    let back: Vec<DVec2> = stops.iter().rev().copied().collect();
    stops.extend_from_slice(&back);
    // Along the walls of the gaps, from end to end.
    let corners = [at(0.0, 1.0), at(1.0, 1.0), at(1.0, 2.0), at(0.0, 2.0), at(0.0, 3.0), at(1.0, 3.0)];
    let slides = corners.iter().chain(corners.iter().rev()).copied().chain([anchor]);
    let model = model(&walls, anchor);
    let slid: Vec<DVec2> = slides.collect();
    let traces = [way(&model, stops.len(), next_of(&stops)), way(&model, slid.len(), next_of(&slid))];
    case(name, walls, anchor, traces)
}

/// Two walls that all but touch, one a little higher; the trace goes through between them, again and again, and round
/// one.
fn points(thin: f64, name: String) -> Extreme {
    let walls = vec![[p(-1.0, 0.0), p(-thin, 0.0)], [p(thin, thin / 8.0), p(1.0, thin)]];
    let anchor = p(0.25, -1.0);
    let (below, above) = (p(-0.25, -1.0), p(0.125, 1.0));
    let through = [p(0.0, -thin), p(0.0, thin)];
    let once = [below, through[0], through[1], above, p(2.0, 0.5), p(2.0, -1.0)];
    let traces = [once.repeat(6), [through[0], through[1]].repeat(20)];
    let model = model(&walls, anchor);
    let traces = traces.map(|stops| way(&model, stops.len(), next_of(&stops)));
    case(name, walls, anchor, traces)
}
