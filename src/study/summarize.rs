//! From counts to answers.

use std::collections::BTreeMap;

use super::estimate::Confidence;
use super::opened::Study;
use super::state::{Shard, State};
use super::summary::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Quantile, Scalar, Summary, Survival,
    SurvivalPoint,
};
use super::tally::{Counts, Moments, SCALARS, Setting, of_rank};
use crate::rope::Side;
use crate::trade::Traded;

/// Which quantiles are given.
const QUANTILES: [f64; 9] = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];

/// How many wall ends are listed at the most.
const CONTACTS: usize = 1000;

impl State {
    /// What the blocks done so far say. O(what was counted).
    pub fn summary(&self, study: &Study) -> Summary {
        let plan = study.plan();
        let (setting, counts) = (&study.setting, &self.tallies.counts);
        let confidence = Confidence::new(plan.tallies.confidence);
        let moments = self.tallies.scalars();
        let steps = counts.looks.sum - counts.traces.sum;
        Summary {
            study: plan.clone(),
            identity: self.identity.clone(),
            traces: counts.traces.sum,
            steps,
            still: share_of(counts.still, steps),
            at_walls: plan.walk.at_walls().and_then(|_| share_of(counts.met, steps)),
            events: counts.events,
            blocks: counts.traces.blocks,
            traded: plan.run.trade().is_any().then(|| Traded {
                vertices: study.vertices() as u64,
                vertices_left: study.models()[0].vertices().len() as u64,
                jumps: counts.jumps,
                crossing_traces: counts.crossing[0],
                crossing_steps: counts.crossing[1],
            }),
            shard: (self.shard != Shard::WHOLE).then(|| self.shard.to_string()),
            stopped: self.stopped,
            scalars: scalars(&confidence, &moments, counts),
            histograms: (0..2).map(|i| histogram(&confidence, setting, counts, i)).collect(),
            survival: survival(&confidence, setting, counts),
            obstacles: obstacles(&confidence, setting, counts),
            ropes: ropes(&confidence, setting, counts, plan.tallies.ropes as usize),
            contacts: contacts(&confidence, setting, counts),
            map: map(&confidence, setting, counts),
        }
    }
}

/// Which share of the steps so many are; `None` where there are no steps.
fn share_of(count: u64, steps: u64) -> Option<f64> {
    (steps > 0).then(|| count as f64 / steps as f64)
}

fn scalars(confidence: &Confidence, moments: &[Moments], counts: &Counts) -> Vec<Scalar> {
    let traces = counts.traces.sum;
    // The least number below or at which that share of them lies.
    let rank = |share: f64| ((share * traces as f64).ceil() as u64).max(1);
    let quantile = |i: usize, rank: u64| match i {
        // A length's class is known, and that no length is beyond the extremes.
        0 | 1 => counts.lengths[i].of_rank(rank).map(|x| x.clamp(moments[i].min, moments[i].max)),
        _ => [of_rank(&counts.values[i - 2], rank).unwrap_or(0) as f64; 2],
    };
    let ends = QUANTILES.map(|share| (share, confidence.ranks(share, traces)));
    let scalar = |(i, (name, moments)): (usize, (&&str, &Moments))| {
        let estimate = |share: f64, [low, high]: [Option<u64>; 2]| {
            let [value, above] = quantile(i, rank(share));
            Estimate {
                value: value + (above - value) / 2.0,
                error: None,
                low: low.map(|rank| quantile(i, rank)[0]),
                high: high.map(|rank| quantile(i, rank)[1]),
            }
        };
        Scalar {
            name: (*name).to_owned(),
            mean: confidence.mean(moments),
            deviation: moments.variance().map(f64::sqrt),
            min: moments.min,
            max: moments.max,
            quantiles: ends.map(|(share, ends)| Quantile { share, value: estimate(share, ends) }).to_vec(),
        }
    };
    SCALARS.iter().zip(moments).enumerate().map(scalar).collect()
}

fn histogram(confidence: &Confidence, setting: &Setting, counts: &Counts, i: usize) -> Histogram {
    let bin = |(&bin, &count): (&u64, &u64)| Bin { bin, count, share: confidence.share(count, counts.traces.sum) };
    Histogram { name: SCALARS[i].to_owned(), width: setting.bin, bins: counts.bins[i].iter().map(bin).collect() }
}

/// For each limit the share of ropes that were never longer up to a step, or up to their trace's end if that came before.
fn survival(confidence: &Confidence, setting: &Setting, counts: &Counts) -> Vec<Survival> {
    let traces = counts.traces.sum;
    let curve = |(&limit, exceeded): (&f64, &BTreeMap<u64, u64>)| {
        let still = |longer: u64| confidence.share(traces - longer, traces);
        let mut longer = 0;
        let point = |(i, &step): (usize, &u64)| {
            longer += exceeded.get(&(i as u64)).copied().unwrap_or(0);
            SurvivalPoint { step, share: still(longer) }
        };
        let before = setting.times.iter().enumerate().take_while(|&(_, &step)| step < counts.longest_trace);
        let mut curve: Vec<SurvivalPoint> = before.map(point).collect();
        // How long given traces are is only known in the end.
        curve.push(SurvivalPoint { step: counts.longest_trace, share: still(exceeded.values().sum()) });
        Survival { limit, curve }
    };
    setting.limits.iter().zip(&counts.exceeded).map(curve).collect()
}

fn obstacles(confidence: &Confidence, setting: &Setting, counts: &Counts) -> Vec<Obstacle> {
    let traces = counts.traces.sum;
    // As a picture shows it.
    let y_down = setting.models[0].scene().y_down();
    let obstacle = |(&vertex, wound): (&u32, &super::tally::Wound)| {
        let known = setting.obstacles.get(vertex)?;
        let n = traces as f64;
        let [left, right] = if y_down { [wound.right, wound.left] } else { [wound.left, wound.right] };
        let mean = if y_down { -wound.turns } else { wound.turns } as f64 / n;
        // In whole numbers, since the difference can be small beside what it is one of.
        let (turns, count) = (u128::from(wound.turns.unsigned_abs()), u128::from(traces));
        let spread = (count * u128::from(wound.squares)).saturating_sub(turns * turns) as f64 / n;
        let error = (traces > 1).then(|| (spread / (n - 1.0) / n).sqrt());
        Some(Obstacle {
            vertex,
            at: known.middle.into(),
            label: label(setting, known.named),
            walls: known.walls,
            wound: confidence.share(left + right, traces),
            left: confidence.share(left, traces),
            right: confidence.share(right, traces),
            mean: confidence.around(mean, error, traces),
        })
    };
    let mut all: Vec<Obstacle> = counts.wound.iter().filter_map(obstacle).collect();
    all.sort_by(|a, b| b.wound.value.total_cmp(&a.wound.value).then(a.vertex.cmp(&b.vertex)));
    all
}

/// What the scene's file calls the thing to which a wall end belongs.
fn label(setting: &Setting, vertex: u32) -> Option<String> {
    setting.labels.get(vertex as usize).cloned().flatten()
}

fn ropes(confidence: &Confidence, setting: &Setting, counts: &Counts, most: usize) -> Vec<CommonRope> {
    let (vertices, y_down) = (setting.models[0].vertices(), setting.models[0].scene().y_down());
    let rope = |(key, count, at_most): (&Vec<u32>, u64, u64)| {
        let (anchor, contacts) = key.split_first().expect("a rope has an anchor");
        let side = |&contact: &u32| if contact % 2 == 1 { Side::Right } else { Side::Left }.shown(y_down);
        let at_most = at_most.min(counts.traces.sum);
        // As low as the lower count may be, as high as the higher one.
        let [lower, higher] = [count, at_most].map(|count| confidence.share(count, counts.traces.sum));
        CommonRope {
            count,
            at_most,
            share: Estimate { high: higher.high, ..lower },
            anchor: setting.models[*anchor as usize].anchor().into(),
            wraps: contacts.iter().map(|c| vertices[*c as usize / 2].into()).collect(),
            sides: contacts.iter().map(|c| side(c).name().to_owned()).collect(),
            labels: match setting.labels.is_empty() {
                true => Vec::new(),
                false => contacts.iter().map(|c| label(setting, *c / 2)).collect(),
            },
        }
    };
    counts.ropes.top(most).into_iter().map(rope).collect()
}

fn contacts(confidence: &Confidence, setting: &Setting, counts: &Counts) -> Vec<Contact> {
    let blocks = counts.traces.blocks;
    let mut longest: Vec<_> = counts.touched.iter().collect();
    longest.sort_by(|a, b| b.1.steps.sum.cmp(&a.1.steps.sum).then(a.0.cmp(b.0)));
    longest.truncate(CONTACTS);
    let contact = |(&vertex, touched): (&u32, &super::tally::Touched)| {
        let (wraps, wraps_error) = touched.wraps.ratio(&counts.traces);
        let (share, share_error) = touched.steps.ratio(&counts.looks);
        Contact {
            vertex,
            at: setting.models[0].vertices()[vertex as usize].into(),
            label: label(setting, vertex),
            wraps: confidence.around(wraps, wraps_error, blocks),
            share: confidence.around(share, share_error, blocks),
        }
    };
    longest.into_iter().map(contact).collect()
}

fn map(confidence: &Confidence, setting: &Setting, counts: &Counts) -> Option<Map> {
    let grid = setting.cells?;
    let cell = |(&number, cell): (&u32, &super::tally::CellCounts)| {
        let (contacts, contacts_error) = cell.contacts.ratio(&counts.looks);
        let length = (cell.visits.sum > 0).then(|| {
            let (mean, error) = cell.lengths.ratio(&cell.visits);
            let (mean, error) = (mean * setting.unit, error.map(|e| e * setting.unit));
            confidence.around(mean, error, cell.visits.blocks)
        });
        Cell {
            cell: u64::from(number),
            visits: cell.visits.sum,
            length,
            contacts: confidence.around(contacts, contacts_error, counts.looks.blocks),
        }
    };
    Some(Map {
        low: grid.low.into(),
        cell: grid.cell,
        columns: grid.columns,
        rows: grid.rows,
        cells: counts.cells.iter().map(cell).collect(),
    })
}
