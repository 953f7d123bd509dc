//! Extreme cases: families of scenes and traces at the ends of what is taken, where most signs are ties or as good as,
//! and where there is very much or very little of something.
//!
//! Every trace keeps to the rules, so exact engines must give the right ropes for all of them, or say why they cannot.

mod anchors;
mod crowds;
mod extreme;
mod lines;
mod magnitudes;
mod rays;
mod steps;
mod tools;
mod touching;

pub use extreme::Extreme;

/// Cases that are extreme in one way.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// A short name, in words with `_` between.
    pub name: &'static str,
    /// What is extreme in it.
    pub what: &'static str,
    cases: fn() -> Vec<Extreme>,
}

impl Family {
    /// Its cases, the same whenever they are made. Some hold a million traces, or one of millions of points.
    pub fn cases(&self) -> Vec<Extreme> {
        (self.cases)()
    }
}

/// All families.
pub const FAMILIES: [Family; 14] = [
    Family { name: "scales", what: "2^-450 to 2^500, in x and y alike or not", cases: magnitudes::scales },
    Family {
        name: "offsets",
        what: "1 to 10^12 times the scene's size away from the origin",
        cases: magnitudes::offsets,
    },
    Family {
        name: "near_lines",
        what: "three wall ends 1 to 2^40 units in the last place off a line",
        cases: lines::near_lines,
    },
    Family {
        name: "needles",
        what: "walls 10^3 to 10^15 times as long as they and the gaps are wide",
        cases: lines::needles,
    },
    Family { name: "lattices", what: "walls and trace points on one lattice of whole numbers", cases: rays::lattices },
    Family { name: "rays", what: "points on the rays of wall ends, and to and fro over one", cases: rays::rays },
    Family { name: "touching", what: "along walls, through their ends, standing on them", cases: touching::touching },
    Family { name: "anchors", what: "tied to a wall's end, and coming back there", cases: anchors::anchors },
    Family { name: "steps", what: "steps across the scene and of one unit in the last place", cases: steps::steps },
    Family { name: "windings", what: "up to 100,000 turns round a pillar, and back", cases: steps::windings },
    Family { name: "long_and_many", what: "10^6 steps of a trace, 10^6 traces of a step", cases: steps::long_and_many },
    Family { name: "sizes", what: "1 to 100,000 walls", cases: crowds::sizes },
    Family { name: "piles", what: "thousands of walls through one point or on each other", cases: crowds::piles },
    Family { name: "degenerate", what: "hardly a scene, hardly a trace", cases: crowds::degenerate },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_the_same_whenever_they_are_made() {
        for family in &FAMILIES[..6] {
            for (case, again) in family.cases().iter().zip(family.cases()) {
                assert_eq!((&case.name, &case.walls, case.anchor), (&again.name, &again.walls, again.anchor));
                assert!(case.traces == again.traces, "{}, {}", family.name, case.name);
            }
        }
    }
}
