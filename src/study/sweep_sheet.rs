//! What the studies of a sweep say, as a table with one row a point.

use super::estimate::Estimate;
use super::sweep::shown;
use super::sweep_answer::{PointAnswer, SweepAnswer};
use super::tally::{FrictionAnswer, TetherAnswer, scalar_names};
use crate::geometry::number;
use crate::output::{Column, Sheet};

impl SweepAnswer {
    /// One row a point: its folder, the values of the keys, how many traces and blocks it has, and then of each scalar
    /// the mean with its error and interval, the quantiles with their intervals and the difference of the mean, and of
    /// each limit the share of ropes within it and the difference of that; where there are tethers, how they held the
    /// walks back, and where there is friction, what that makes of the tension. What is not known is null.
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
            for share in self.quantiles() {
                let of = |point: &PointAnswer| point.scalar(name)?.quantile(share);
                let name = format!("{name}_q{}", hundredths(share));
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
        if self.points.iter().any(|point| point.tether.is_some()) {
            for (name, of) in TETHER {
                self.push(&mut sheet, name, |point| point.tether.as_ref().and_then(of));
            }
        }
        if self.points.iter().any(|point| point.friction.is_some()) {
            for (name, of) in FRICTION {
                self.push(&mut sheet, &format!("{name}_mean"), |point| point.friction.as_ref().map(of));
                self.push(&mut sheet, &format!("{name}_mean_difference"), |point| point.mean_difference(name));
            }
            for tension in self.tensions() {
                let name = format!("steps_above_tension_{}", number(tension));
                self.push(&mut sheet, &name, |point| point.steps_above(tension));
            }
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

    /// The shares of which quantiles are given, ascending: those of all points, since they may be swept too.
    fn quantiles(&self) -> Vec<f64> {
        let scalars = self.points.iter().filter_map(|point| point.scalars.first());
        let mut shares: Vec<f64> = scalars.flat_map(|scalar| scalar.quantiles.iter().map(|q| q.share)).collect();
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    /// Four columns: an estimate with its error and its interval.
    fn push(&self, sheet: &mut Sheet, name: &str, of: impl Fn(&PointAnswer) -> Option<Estimate>) {
        for (ending, part) in &PARTS {
            let values = self.points.iter().map(|point| of(point).and_then(|e| part(&e)));
            sheet.push(format!("{name}{ending}"), Column::Number(values.collect()));
        }
    }
}

/// Something that is told of a tether.
type Told = fn(&TetherAnswer) -> Option<Estimate>;

/// All of it.
const TETHER: [(&str, Told); 3] = [
    ("held_back", |tether| Some(tether.held_back)),
    ("never_held_back", |tether| Some(tether.never)),
    ("first_held_back_mean", |tether| tether.first),
];

/// Something that is told of friction.
type Strained = fn(&FrictionAnswer) -> Estimate;

/// All of it that every point has.
const FRICTION: [(&str, Strained); 2] =
    [("tension", |friction| friction.tension.mean), ("work", |friction| friction.work.mean)];

/// Part of an estimate.
type Taken = fn(&Estimate) -> Option<f64>;

/// How the columns of an estimate's parts end.
const PARTS: [(&str, Taken); 4] =
    [("", |e| Some(e.value)), ("_error", |e| e.error), ("_low", |e| e.low), ("_high", |e| e.high)];

/// A share between 0 and 1 in hundredths. Its point is moved in the text, since 100 times 0.29 is not 29.
fn hundredths(share: f64) -> String {
    let digits = format!("{share}");
    let digits = digits.trim_start_matches("0.");
    let (whole, rest) = digits.split_at(digits.len().min(2));
    let whole = format!("{whole:0<2}");
    let whole = if whole == "00" { "0" } else { whole.trim_start_matches('0') };
    if rest.is_empty() { whole.to_owned() } else { format!("{whole}.{rest}") }
}

#[cfg(test)]
mod tests {
    use super::hundredths;

    #[test]
    fn shares_are_named_by_their_hundredths() {
        let shares = [0.5, 0.05, 0.29, 0.999, 0.001, 0.07, 0.5000000000000001, 1e-7];
        let names = ["50", "5", "29", "99.9", "0.1", "7", "50.00000000000001", "0.00001"];
        assert_eq!(shares.map(hundredths), names);
    }
}
