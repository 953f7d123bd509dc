//! What the studies of a sweep say, as a table with one row a point.

use super::estimate::Estimate;
use super::sweep::shown;
use super::sweep_answer::{PointAnswer, SweepAnswer};
use super::tally::scalar_names;
use crate::geometry::number;
use crate::output::{Column, Sheet};

impl SweepAnswer {
    /// One row a point: its folder, the values of the keys, how many traces and blocks it has, and then of each scalar
    /// the mean with its error and interval, the quantiles with their intervals and the difference of the mean, and of
    /// each limit the share of ropes within it and the difference of that. What is not known is null.
    pub fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::default();
        sheet.push("point", Column::Text(self.points.iter().map(|point| Some(point.folder.clone())).collect()));
        for (place, key) in self.keys.iter().enumerate() {
            sheet.push(key, self.column(place));
        }
        sheet.push("traces", Column::Count(self.points.iter().map(|point| Some(point.traces)).collect()));
        sheet.push("blocks", Column::Count(self.points.iter().map(|point| Some(point.blocks)).collect()));
        for name in scalar_names() {
            let mean = |point: &PointAnswer| point.scalar(name).map(|scalar| scalar.mean);
            self.push(&mut sheet, &format!("{name}_mean"), mean);
            self.push(&mut sheet, &format!("{name}_mean_difference"), |point| point.mean_difference(name));
            for (place, share) in self.quantiles() {
                let of = |point: &PointAnswer| point.scalar(name)?.quantiles.get(place).map(|q| q.value);
                let name = format!("{name}_q{}", number(100.0 * share));
                for (ending, part) in &PARTS[..] {
                    // Quantiles have no standard error.
                    if *ending != "_error" {
                        let values = self.points.iter().map(|point| of(point).and_then(|e| part(&e)));
                        sheet.push(format!("{name}{ending}"), Column::Number(values.collect()));
                    }
                }
            }
        }
        for limit in self.limits() {
            let name = format!("within_{}", number(limit));
            self.push(&mut sheet, &name, |point| point.within(limit));
            self.push(&mut sheet, &format!("{name}_difference"), |point| point.share_difference(limit));
        }
        sheet
    }

    /// The values of the key at this place: numbers where all are.
    fn column(&self, place: usize) -> Column {
        let values = || self.points.iter().map(|point| &point.values[place]);
        if let Some(counts) = values().map(serde_json::Value::as_u64).collect::<Option<Vec<u64>>>() {
            return Column::Count(counts.into_iter().map(Some).collect());
        }
        match values().map(serde_json::Value::as_f64).collect::<Option<Vec<f64>>>() {
            Some(numbers) => Column::Number(numbers.into_iter().map(Some).collect()),
            None => Column::Text(values().map(|value| Some(shown(value))).collect()),
        }
    }

    /// The shares of which quantiles are given, with their places.
    fn quantiles(&self) -> Vec<(usize, f64)> {
        let scalar = self.points.iter().find_map(|point| point.scalars.first());
        scalar.map_or(Vec::new(), |scalar| scalar.quantiles.iter().map(|q| q.share).enumerate().collect())
    }

    /// Four columns: an estimate with its error and its interval.
    fn push(&self, sheet: &mut Sheet, name: &str, of: impl Fn(&PointAnswer) -> Option<Estimate>) {
        for (ending, part) in &PARTS {
            let values = self.points.iter().map(|point| of(point).and_then(|e| part(&e)));
            sheet.push(format!("{name}{ending}"), Column::Number(values.collect()));
        }
    }
}

/// Part of an estimate.
type Taken = fn(&Estimate) -> Option<f64>;

/// How the columns of an estimate's parts end.
const PARTS: [(&str, Taken); 4] =
    [("", |e| Some(e.value)), ("_error", |e| e.error), ("_low", |e| e.low), ("_high", |e| e.high)];
