//! How long a tether must be: what most people want to know of a study.

use super::estimate::{Confidence, Estimate};
use super::summary::Summary;
use super::tally::Quantile;

/// A tether of some length, and which share of the walks it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// How long it is, in the scene's unit.
    pub length: f64,
    /// The share of the walks whose rope is never longer.
    pub share: Estimate,
}

impl Summary {
    /// The highest quantile of the greatest rope length: such a share of the walks needs at most that much. `None` if
    /// there are no traces.
    pub fn need(&self) -> Option<&Quantile> {
        let longest = self.scalars.iter().find(|scalar| scalar.name == "max_length")?;
        longest.quantiles.last().filter(|_| self.traces > 0)
    }

    /// Which share of the walks tethers of growing lengths hold, at the ends of the bins of the histogram of the
    /// greatest rope length: from one that holds none to one that holds all. Empty if there are no traces. The
    /// intervals are Wilson's, each for itself.
    pub fn held(&self) -> Vec<Held> {
        let Some(histogram) = self.histograms.iter().find(|histogram| histogram.name == "max_length") else {
            return Vec::new();
        };
        let confidence = Confidence::new(self.study.tallies.confidence);
        let all: u64 = histogram.bins.iter().map(|bin| bin.count).sum();
        let held =
            |end: u64, count: u64| Held { length: end as f64 * histogram.width, share: confidence.share(count, all) };
        let (mut points, mut count) = (Vec::new(), 0);
        for bin in &histogram.bins {
            let end = points.last().map(|&(end, _)| end);
            if end != Some(bin.bin) {
                points.push((bin.bin, count));
            }
            count += bin.count;
            points.push((bin.bin + 1, count));
        }
        points.into_iter().map(|(end, count)| held(end, count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::study::{EXAMPLE, Plan, Shard, State, Study};

    #[test]
    fn the_curve_rises_from_none_to_all_through_the_quantiles() {
        let plan = Plan::parse(&EXAMPLE.replace("traces = 10_000", "traces = 300")).unwrap();
        let study = std::sync::Arc::new(Study::open(plan, std::path::Path::new(".")).unwrap());
        let state = std::sync::Mutex::new(State::new(&study, Shard::WHOLE));
        let engine = crate::engine::Cpu::new(study.models()[0].clone());
        let mut engines: Vec<Box<dyn crate::engine::Engine>> = vec![Box::new(engine)];
        let job = crate::engine::Job::new();
        crate::study::run(&study, &mut engines, &state, &job, |_, _, _| Ok::<(), std::io::Error>(())).unwrap();
        let summary = state.into_inner().unwrap().summary(&study);
        let held = summary.held();
        assert!(held.is_sorted_by(|a, b| a.length < b.length && a.share.value <= b.share.value));
        assert_eq!([held[0], held[held.len() - 1]].map(|held| held.share.value), [0.0, 1.0]);
        let need = summary.need().unwrap();
        assert_eq!(need.share, 0.99);
        // No more walks are held by what is shorter than by the quantile, and no fewer by what is longer.
        for at in &held {
            assert!(at.length > need.value.value || at.share.value <= 0.99 + 1.0 / 300.0);
            assert!(at.length < need.value.value || at.share.value >= 0.99 - 1.0 / 300.0);
            assert!(at.share.low.unwrap() <= at.share.value && at.share.value <= at.share.high.unwrap());
        }
    }
}
