//! Gathers rows into traces, and traces into batches.

use std::collections::VecDeque;
use std::ops::Range;

use glam::DVec2;

use super::{EndsTrace, Trace};
use crate::geometry::{check_point, check_points};

/// The most points for which room is made ahead in a trace whose end is not known yet.
const AHEAD: usize = 1 << 16;

/// The column that may say which step of its trace a row is.
pub(super) const STEP: &str = "step";

/// The columns that may say where the anchor is.
pub(super) const ANCHOR: [&str; 2] = ["bx", "by"];

/// What is said where columns have the names of the anchor's in other letters: passed over, ropes would be tied that
/// are not.
pub(super) fn meant(names: &[impl AsRef<str>]) -> Option<String> {
    let like = |column: &str| names.iter().map(AsRef::as_ref).find(|name| name.eq_ignore_ascii_case(column));
    let [bx, by] = [like(ANCHOR[0])?, like(ANCHOR[1])?];
    Some(format!(
        "the columns {bx} and {by}: write bx and by if they say where the rope's anchor is, and give them other names \
         if not"
    ))
}

/// Rows on their way into traces.
#[derive(Default)]
pub(super) struct Gatherer {
    /// The same rows on their way into the anchors' paths, where they say where the anchor is.
    anchors: Option<Box<Gatherer>>,
    /// In order; rows to come may belong to the last.
    traces: VecDeque<Trace>,
    /// How many points they have together.
    points: usize,
    /// The trace of the last row, also when it was given away.
    last: Option<u64>,
    /// The step of the last row, if rows have steps.
    last_step: Option<u64>,
}

impl Gatherer {
    /// Adds rows: the numbers of their traces, their steps if they have any, and what gives the points of some of them.
    /// A fault comes with its row.
    pub(super) fn extend<I>(
        &mut self,
        ids: &[u64],
        steps: Option<&[u64]>,
        points: impl Fn(Range<usize>) -> I,
    ) -> Result<(), (usize, String)>
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
                self.last_step = None;
            }
            let out_of_order = steps.and_then(|steps| self.out_of_order(&steps[first..end]));
            let trace = self.traces.back_mut().expect("the last row's trace is kept");
            let old = trace.points.len();
            // Adding zero turns negative zeros into positive ones.
            trace.points.extend(points(first..end).map(|p| p + DVec2::ZERO));
            self.points += end - first;
            let wrong = check_points(&trace.points[old..]).err().map(|(i, _)| i);
            match (wrong, out_of_order) {
                (Some(i), other) if other.as_ref().is_none_or(|(j, _)| i <= *j) => {
                    return Err((first + i, fault(trace.points[old + i]).unwrap_or_default()));
                }
                (_, Some((i, what))) => return Err((first + i, what)),
                _ => {}
            }
            first = end;
        }
        Ok(())
    }

    /// [`extend`](Self::extend) with rows that say where the anchor is, too.
    pub(super) fn extend_both<I>(
        &mut self,
        ids: &[u64],
        steps: Option<&[u64]>,
        points: impl Fn(Range<usize>) -> I,
        anchors: impl Fn(Range<usize>) -> I,
    ) -> Result<(), (usize, String)>
    where
        I: Iterator<Item = DVec2>,
    {
        self.extend(ids, steps, points)?;
        let named = |(row, what): (usize, String)| match what.strip_prefix("column ") {
            Some(what) => (row, format!("column b{what}")),
            None => (row, what),
        };
        self.anchors.get_or_insert_default().extend(ids, None, anchors).map_err(named)
    }

    /// The first of the next steps of the last trace that does not come after the one before it, and what is wrong with
    /// it.
    fn out_of_order(&mut self, steps: &[u64]) -> Option<(usize, String)> {
        for (i, &step) in steps.iter().enumerate() {
            if let Some(last) = self.last_step.replace(step).filter(|&last| step <= last) {
                let id = self.last.unwrap_or_default();
                let rule = "the rows of one trace must stand in the order of their steps, each once";
                return Some((i, format!("trace {id}: step {step} after step {last}; {rule}")));
            }
        }
        None
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

    /// Gives away the first traces that are whole, as many as fit a batch but at least one; `ended` says that the last
    /// one is whole too.
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

    /// The same with the points of each trace's anchor, of rows that say where that is.
    pub(super) fn take_both(&mut self, traces: usize, points: usize, ended: bool) -> Option<Vec<EndsTrace>> {
        // As many rows in the one as in the other, so as many traces.
        let anchors = self.anchors.as_mut()?.take(traces, points, ended)?;
        let free = self.take(traces, points, ended)?;
        let both = |(free, anchor): (Trace, Trace)| EndsTrace { free, anchor: anchor.points };
        Some(free.into_iter().zip(anchors).map(both).collect())
    }
}

/// The traces whose points are the rows of a table in memory: as those of a file, they follow each other, and their
/// numbers increase, as the steps of one trace do where rows have steps. `ids` are the rows' traces, and `points` gives
/// the points of some of them. O(rows).
///
/// # Errors
///
/// The first row that will not do, counted from 0, and what is wrong with it.
///
/// # Panics
///
/// If there are fewer steps or points than `ids`.
///
/// ```
/// use tautline::trace::traces_of_rows;
/// let rows = [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]];
/// let points = |some: std::ops::Range<usize>| rows[some].iter().map(|&p| p.into());
/// let traces = traces_of_rows(&[0, 0, 7], None, points).unwrap();
/// assert_eq!((traces.len(), traces[1].id, traces[1].points.len()), (2, 7, 1));
/// assert_eq!(traces_of_rows(&[7, 7, 0], None, points).unwrap_err().0, 2);
/// ```
pub fn traces_of_rows<I>(
    ids: &[u64],
    steps: Option<&[u64]>,
    points: impl Fn(Range<usize>) -> I,
) -> Result<Vec<Trace>, (usize, String)>
where
    I: Iterator<Item = DVec2>,
{
    let mut gatherer = Gatherer::default();
    gatherer.extend(ids, steps, points)?;
    Ok(gatherer.traces.into())
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
        gatherer.extend(ids, None, |rows| xs[rows].iter().map(|&x| DVec2::new(x, 0.5)))
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
        let e = gatherer.extend(&[7], None, |_| std::iter::once(DVec2::new(1.0, f64::NAN))).unwrap_err();
        assert_eq!(e.1, "column y: NaN is not a finite number");
        let traces = gatherer.take(9, 99, true).unwrap();
        assert_eq!(traces[0].points[1].x.to_bits(), 0);
    }

    #[test]
    fn steps_may_not_go_back_within_a_trace() {
        let rows = |parts: &[(&[u64], &[u64])]| {
            let mut gatherer = Gatherer::default();
            parts.iter().try_for_each(|(ids, steps)| {
                gatherer.extend(ids, Some(steps), |rows| {
                    rows.map(|i| DVec2::new(if steps[i] == 99 { f64::NAN } else { 0.5 }, 0.0))
                })
            })
        };
        rows(&[(&[0, 0, 0, 1, 1, 2], &[0, 1, 7, 0, 1, 5]), (&[2, 2, 3], &[6, 8, 0])]).unwrap();
        let rule = "the rows of one trace must stand in the order of their steps, each once";
        let e = rows(&[(&[0, 1, 1, 1], &[0, 3, 5, 4])]).unwrap_err();
        assert_eq!(e, (3, format!("trace 1: step 4 after step 5; {rule}")));
        // A row that is there twice, across what is read at a time.
        let e = rows(&[(&[4], &[2]), (&[4], &[2])]).unwrap_err();
        assert_eq!(e, (0, format!("trace 4: step 2 after step 2; {rule}")));
        // The first fault is named, and of one row that of its point.
        assert!(rows(&[(&[0, 0, 0], &[1, 0, 99])]).unwrap_err().1.contains("step 0 after step 1"));
        assert!(rows(&[(&[0, 0, 0], &[1, 99, 0])]).unwrap_err().1.contains("NaN"));
        assert!(rows(&[(&[0, 0], &[100, 99])]).unwrap_err().1.contains("NaN"));
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
