//! Gathers rows into traces, and traces into batches.

use std::collections::VecDeque;
use std::ops::Range;

use glam::DVec2;

use super::Trace;
use crate::geometry::{check_point, check_points};

/// The most points for which room is made ahead in a trace whose end is not known yet.
const AHEAD: usize = 1 << 16;

/// Rows on their way into traces.
#[derive(Default)]
pub(super) struct Gatherer {
    /// In order; rows to come may belong to the last.
    traces: VecDeque<Trace>,
    /// How many points they have together.
    points: usize,
    /// The trace of the last row, also when it was given away.
    last: Option<u64>,
}

impl Gatherer {
    /// Adds rows: the numbers of their traces, and what gives the points of some of them. A fault comes with its row.
    pub(super) fn extend<I>(&mut self, ids: &[u64], points: impl Fn(Range<usize>) -> I) -> Result<(), (usize, String)>
    where
        I: Iterator<Item = DVec2>,
    {
        let mut first = 0;
        while first < ids.len() {
            let id = ids[first];
            let end = first + equal(&ids[first..]);
            if self.last != Some(id) {
                if let Some(last) = self.last.filter(|&last| last > id) {
                    let rule = "the rows of one trace must follow each other, and the numbers increase";
                    let what = points(first..first + 1).next().and_then(fault);
                    return Err((first, what.unwrap_or_else(|| format!("trace {id} after trace {last}; {rule}"))));
                }
                // Traces of one file tend to be equally long.
                let ahead = self.traces.back().map_or(0, |t| t.points.len().min(AHEAD));
                let room = (end - first).max(if end < ids.len() { 0 } else { ahead });
                self.traces.push_back(Trace { id, points: Vec::with_capacity(room) });
                self.last = Some(id);
            }
            let trace = self.traces.back_mut().expect("the last row's trace is kept");
            let old = trace.points.len();
            // Adding zero turns negative zeros into positive ones.
            trace.points.extend(points(first..end).map(|p| p + DVec2::ZERO));
            if let Err((i, _)) = check_points(&trace.points[old..]) {
                return Err((first + i, fault(trace.points[old + i]).unwrap_or_default()));
            }
            self.points += end - first;
            first = end;
        }
        Ok(())
    }

    /// How many points are held.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        assert_eq!(self.points, self.traces.iter().map(|t| t.points.len()).sum::<usize>());
        self.points
    }

    /// Whether a batch of that size can be taken without more rows.
    pub(super) fn is_full(&self, traces: usize, points: usize) -> bool {
        let Some(last) = self.traces.back() else { return false };
        self.traces.len() > traces || self.points - last.points.len() > points
    }

    /// Gives away the first traces that are whole, as many as fit a batch but at least one; `ended` says that the last one
    /// is whole too.
    pub(super) fn take(&mut self, traces: usize, points: usize, ended: bool) -> Option<Vec<Trace>> {
        let whole = if ended { self.traces.len() } else { self.traces.len().saturating_sub(1) };
        let mut sum = 0usize;
        let fits = |(i, trace): &(usize, &Trace)| {
            sum = sum.saturating_add(trace.points.len());
            *i == 0 || (*i < traces && sum <= points)
        };
        let count = self.traces.iter().take(whole).enumerate().take_while(fits).count();
        let batch: Vec<Trace> = self.traces.drain(..count).collect();
        self.points -= batch.iter().map(|t| t.points.len()).sum::<usize>();
        (!batch.is_empty()).then_some(batch)
    }
}

/// How many numbers from the first on are the same.
fn equal(ids: &[u64]) -> usize {
    // Blocks are compared without branches, so that several numbers are looked at in one instruction.
    let block = |block: &&[u64]| block.iter().fold(true, |same, &id| same & (id == ids[0]));
    let start = 64 * ids.chunks(64).take_while(block).count();
    if start >= ids.len() {
        return ids.len();
    }
    start + ids[start..].iter().take_while(|&&id| id == ids[0]).count()
}

/// What is wrong with a point, and in which column.
fn fault(p: DVec2) -> Option<String> {
    let column = if check_point(DVec2::new(p.x, 0.0)).is_err() { "x" } else { "y" };
    check_point(p).err().map(|fault| format!("column {column}: {fault}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(gatherer: &mut Gatherer, ids: &[u64], xs: &[f64]) -> Result<(), (usize, String)> {
        gatherer.extend(ids, |rows| xs[rows].iter().map(|&x| DVec2::new(x, 0.5)))
    }

    fn shape(batch: Option<Vec<Trace>>) -> Vec<(u64, usize)> {
        batch.unwrap_or_default().iter().map(|t| (t.id, t.points.len())).collect()
    }

    #[test]
    fn rows_are_gathered_by_number() {
        let mut gatherer = Gatherer::default();
        push(&mut gatherer, &[0, 0], &[1.0, -0.0]).unwrap();
        push(&mut gatherer, &[0, 7], &[1.0, 3.0]).unwrap();
        let rule = "the rows of one trace must follow each other, and the numbers increase";
        let e = push(&mut gatherer, &[7, 0], &[1.0, 1.0]).unwrap_err();
        assert_eq!(e, (1, format!("trace 0 after trace 7; {rule}")));
        let e = push(&mut gatherer, &[7, 7, 6], &[1.0, f64::NAN, f64::NAN]).unwrap_err();
        assert_eq!(e, (1, "column x: NaN is not a finite number".into()));
        // What is wrong with the row itself is said before its place.
        assert!(push(&mut gatherer, &[6], &[f64::NAN]).unwrap_err().1.starts_with("column x"));
        let e = gatherer.extend(&[7], |_| std::iter::once(DVec2::new(1.0, f64::NAN))).unwrap_err();
        assert_eq!(e.1, "column y: NaN is not a finite number");
        let traces = gatherer.take(9, 99, true).unwrap();
        assert_eq!(traces[0].points[1].x.to_bits(), 0);
    }

    #[test]
    fn batches_are_whole_traces_and_no_larger_than_asked_for() {
        let mut gatherer = Gatherer::default();
        for (id, points) in [(0, 3), (2, 200), (3, 1), (4, 1), (5, 1)] {
            push(&mut gatherer, &vec![id; points], &vec![0.0; points]).unwrap();
        }
        assert!(gatherer.is_full(4, 1000) && !gatherer.is_full(5, 205) && gatherer.is_full(5, 204));
        assert_eq!(shape(gatherer.take(9, 100, false)), [(0, 3)]);
        // Longer than a batch by itself.
        assert_eq!(shape(gatherer.take(9, 100, false)), [(2, 200)]);
        assert_eq!(shape(gatherer.take(1, 100, false)), [(3, 1)]);
        // More rows of the last may come.
        assert_eq!(shape(gatherer.take(9, 100, false)), [(4, 1)]);
        assert_eq!(shape(gatherer.take(9, 100, false)), []);
        push(&mut gatherer, &[5, 5], &[0.0; 2]).unwrap();
        assert_eq!(shape(gatherer.take(9, 100, true)), [(5, 3)]);
        assert_eq!(shape(gatherer.take(9, 100, true)), []);
        // The order is kept across batches.
        assert!(push(&mut gatherer, &[4], &[0.0]).is_err());
    }

    #[test]
    fn runs_of_equal_numbers_are_counted() {
        for n in [1, 63, 64, 65, 128, 200] {
            for rest in [0, 1, 100] {
                assert_eq!(equal(&[vec![4; n], vec![5; rest]].concat()), n);
            }
        }
    }
}
