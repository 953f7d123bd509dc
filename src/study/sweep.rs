//! A sweep: studies that differ in the values of some keys.

use std::collections::HashMap;
use std::ops::Range;

use toml::{Table, Value};

use super::assignment::{assign, covers};
use super::file_places::order_of;
use super::plan::Plan;
use super::plan_error::{PlanError, PlanFault};
use super::study_file::{SWEEP, StudyFile};
use crate::geometry::number;

/// The key in it that is none of the study's: the number of the point with which all are compared.
const AGAINST: &str = "against";

/// The most points that a sweep can have.
const MOST_POINTS: usize = 10_000;

/// Studies that differ in the values of some keys: of each key every value, with every one of each other key.
#[derive(Debug, Clone)]
pub struct Sweep {
    file: StudyFile,
    keys: Vec<SweptKey>,
    points: Vec<SweepPoint>,
    against: usize,
}

/// A key with the values that it takes one after the other.
#[derive(Debug, Clone)]
struct SweptKey {
    name: String,
    values: Vec<Value>,
}

/// One study of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPoint {
    /// The values of the keys, in their order.
    pub values: Vec<serde_json::Value>,
    /// The study.
    pub plan: Plan,
}

impl StudyFile {
    /// The sweep that the file describes; `None` where it describes a single study. O(points * size of the file).
    ///
    /// # Errors
    ///
    /// A list of values that is none or empty, too many points, two that are one study, and what is wrong with any of
    /// the studies: which value of which key is at fault.
    ///
    /// ```
    /// use tautline::study::{EXAMPLE, StudyFile};
    /// let file = StudyFile::parse(EXAMPLE, &["sweep.walk.step=[0.2, 0.4]".parse()?])?;
    /// let sweep = file.sweep()?.unwrap();
    /// assert_eq!(sweep.keys().collect::<Vec<_>>(), ["walk.step"]);
    /// assert_eq!(sweep.points()[1].plan.walk.step(), Some(0.4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sweep(&self) -> Result<Option<Sweep>, PlanError> {
        let mut file = self.clone();
        match file.table.remove(SWEEP) {
            None => Ok(None),
            Some(Value::Table(swept)) => Sweep::new(file, swept).map(Some).map_err(|e| self.located(e)),
            Some(_) => Err(self.located(at(SWEEP, "give a table of keys, each with a list of values".into()))),
        }
    }
}

impl StudyFile {
    /// The JSON Schema of the file: that of a [`Plan`], and of what makes it a sweep.
    pub fn schema() -> serde_json::Value {
        let mut schema = Plan::schema();
        let whole = serde_json::json!({ "type": "integer", "minimum": 0, "maximum": MOST_POINTS - 1 });
        schema["properties"][SWEEP] = serde_json::json!({
            "description": "Keys of the study, each with a list of values: a study for each of them. Names of keys may \
                be written with dots, or nested as tables are.",
            "type": "object",
            "properties": { AGAINST: whole },
        });
        schema["properties"][SWEEP]["properties"][AGAINST]["description"] =
            "The number of the study with which all are compared, counted from 0; the first without it.".into();
        schema
    }
}

fn at(key: &str, what: String) -> PlanError {
    PlanError::at_key(key, PlanFault::Value(what))
}

/// What the file calls one of the keys.
fn in_file(name: &str) -> String {
    format!("{SWEEP}.{name}")
}

impl Sweep {
    fn new(file: StudyFile, mut swept: Table) -> Result<Sweep, PlanError> {
        let against = swept.remove(AGAINST);
        let mut keys = Vec::new();
        gather(swept, "", &mut keys)?;
        // As they stand in the file; those that were given elsewhere come last, by their names.
        let order = order_of(file.text());
        keys.sort_by_key(|key| order.iter().position(|name| *name == in_file(&key.name)).unwrap_or(usize::MAX));
        if keys.is_empty() {
            return Err(at(SWEEP, "it names no key; give some with lists, such as walk.step = [0.2, 0.4]".into()));
        }
        for (i, key) in keys.iter().enumerate() {
            if let Some(other) = keys[..i].iter().find(|other| covers(&other.name, &key.name)) {
                return Err(at(&in_file(&key.name), format!("{} is swept too, and one holds the other", other.name)));
            }
            if file.assigns(&key.name) {
                let what = "it is set by --set too; leave one of them out".to_owned();
                return Err(at(&in_file(&key.name), what));
            }
        }
        let count = keys.iter().try_fold(1usize, |count, key| count.checked_mul(key.values.len()));
        let Some(count) = count.filter(|&count| count <= MOST_POINTS) else {
            let sizes: Vec<String> = keys.iter().map(|key| key.values.len().to_string()).collect();
            let what = format!("{} points are too many; at most {MOST_POINTS} will do", sizes.join(" times "));
            return Err(at(SWEEP, what));
        };
        let against = match against {
            None => 0,
            Some(Value::Integer(n)) if usize::try_from(n).is_ok_and(|n| n < count) => n as usize,
            Some(other) => {
                let last = count - 1;
                let what = format!("{other} is the number of no point; they are 0 to {last}");
                return Err(at(&in_file(AGAINST), what));
            }
        };
        let mut sweep = Sweep { file, keys, points: Vec::new(), against };
        for point in 0..count {
            let plan = sweep.plan(point).map_err(|e| sweep.located(e, point))?;
            let values = sweep.places(point).map(|(key, place)| json(&key.values[place])).collect();
            sweep.points.push(SweepPoint { values, plan });
        }
        sweep.check_differ()?;
        Ok(sweep)
    }

    /// The names of the keys, in the order of the file.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().map(|key| key.name.as_str())
    }

    /// All studies: with the first values of all keys, then with the second one of the last key, and so on.
    pub fn points(&self) -> &[SweepPoint] {
        &self.points
    }

    /// The number of the point with which all are compared.
    pub fn against(&self) -> usize {
        self.against
    }

    /// Has something of each study be otherwise, as an option of a command says.
    pub fn change(&mut self, change: impl Fn(&mut Plan)) {
        self.points.iter_mut().for_each(|point| change(&mut point.plan));
    }

    /// Whether the values of a key, or of one in it or round it, differ from point to point.
    pub fn sweeps(&self, key: &str) -> bool {
        self.keys.iter().any(|swept| covers(&swept.name, key))
    }

    /// What is wrong with the study of a point, with its place: the value of a key, or what the file says of all.
    #[must_use]
    pub fn located(&self, error: PlanError, point: usize) -> PlanError {
        if error.is_placed() {
            return error;
        }
        let key = error.key.as_deref().unwrap_or_default();
        let of = self.places(point).find(|(swept, _)| covers(&swept.name, key));
        let Some((swept, place)) = of else {
            // What is wrong with the first one is most often so with all.
            let what = if point == 0 { String::new() } else { format!(" (with {})", self.words(point)) };
            let fault = Box::new(PlanFault::Value(format!("{}{what}", error.fault)));
            return self.file.located(PlanError { fault, ..error });
        };
        let what = if swept.name == key { error.fault.to_string() } else { error.what() };
        let what = format!("value {} of {}: {what}", place + 1, swept.values.len());
        self.file.located(at(&in_file(&swept.name), what))
    }

    /// The values of a point in words: `walk.step = 0.2, walk.steps = 100`.
    pub fn words(&self, point: usize) -> String {
        let pairs =
            self.places(point).map(|(key, place)| format!("{} = {}", key.name, shown(&json(&key.values[place]))));
        pairs.collect::<Vec<_>>().join(", ")
    }

    /// Which value of each key a point has. The last key's changes the fastest.
    fn places(&self, point: usize) -> impl Iterator<Item = (&SweptKey, usize)> {
        let all: usize = self.keys.iter().map(|key| key.values.len()).product();
        self.keys.iter().scan(all, move |size, key| {
            let outer = *size;
            *size /= key.values.len();
            Some((key, point % outer / *size))
        })
    }

    fn plan(&self, point: usize) -> Result<Plan, PlanError> {
        let mut table = self.file.table.clone();
        for (key, place) in self.places(point) {
            assign(&mut table, &key.name, key.values[place].clone())?;
        }
        self.file.plan_of(&table)
    }

    /// Refuses points that are one study.
    fn check_differ(&self) -> Result<(), PlanError> {
        let mut seen = HashMap::new();
        for (number, point) in self.points.iter().enumerate() {
            let plan = serde_json::to_string(&point.plan).map_err(|e| at(SWEEP, e.to_string()))?;
            if let Some(other) = seen.insert(plan, number) {
                let (one, two) = (self.words(other), self.words(number));
                let what = format!("points {other} ({one}) and {number} ({two}) are one study; give each value once");
                return Err(at(SWEEP, what));
            }
        }
        Ok(())
    }
}

/// All keys of a table with their lists, whether the file nests them or writes their names with dots.
fn gather(table: Table, outer: &str, keys: &mut Vec<SweptKey>) -> Result<(), PlanError> {
    for (name, value) in table {
        let name = format!("{outer}{name}");
        match value {
            Value::Table(inner) => gather(inner, &format!("{name}."), keys)?,
            Value::Array(values) if !values.is_empty() => match values.iter().position(|value| !is_finite(value)) {
                None => keys.push(SweptKey { name, values }),
                Some(place) => {
                    let what = format!("value {} of {}: it is not finite", place + 1, values.len());
                    return Err(at(&in_file(&name), what));
                }
            },
            Value::Array(_) => return Err(at(&in_file(&name), "the list is empty; give one value or more".into())),
            other => return Err(at(&in_file(&name), format!("give a list of values, such as [{other}]"))),
        }
    }
    Ok(())
}

fn is_finite(value: &Value) -> bool {
    match value {
        Value::Float(x) => x.is_finite(),
        Value::Array(all) => all.iter().all(is_finite),
        Value::Table(table) => table.values().all(is_finite),
        _ => true,
    }
}

fn json(value: &Value) -> serde_json::Value {
    serde_json::to_value(value).unwrap_or_default()
}

/// A value as people read it.
///
/// ```
/// use serde_json::json;
/// let shown = [json!(0.5), json!("uniform"), json!([1.0, 2])].map(|value| tautline::study::shown(&value));
/// assert_eq!(shown, ["0.5", "uniform", "[1, 2]"]);
/// ```
pub fn shown(value: &serde_json::Value) -> String {
    use serde_json::Value;
    match value {
        Value::String(text) => text.clone(),
        Value::Number(n) if n.is_f64() => number(n.as_f64().unwrap_or_default()),
        Value::Array(all) => format!("[{}]", all.iter().map(shown).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

/// The numbers of points as names of folders that sort: as many digits as all need, three at the least.
pub(crate) fn names(points: Range<usize>) -> impl Iterator<Item = String> {
    let width = points.end.saturating_sub(1).to_string().len().max(3);
    points.map(move |point| format!("point-{point:0width$}"))
}
