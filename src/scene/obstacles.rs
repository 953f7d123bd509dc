//! Obstacles by the names that a scene's file gives them.

use std::collections::BTreeSet;

use super::{Scene, all_islands};

/// A point of an obstacle about which turns are counted, and what it is called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Centre {
    /// The obstacle's label, or `vertex N`; no two of a list are called alike.
    pub name: String,
    /// The number of the wall end about which the turns are counted.
    pub vertex: u32,
}

/// A name that no obstacle has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no obstacle is called {name:?}{hint}")]
pub struct UnknownObstacle {
    /// The name.
    pub name: String,
    /// What there is, or what else may be given.
    hint: String,
}

/// How many names are told of where another is asked for.
const TOLD: usize = 8;

impl Scene {
    /// The obstacles that have a label: walls that hang together by common ends, and of them the first wall end with a
    /// label. Those of the same label are numbered. In the order of these wall ends. O(walls).
    ///
    /// ```
    /// use tautline::scene::{Object, Scene, Wall};
    /// let pillar = Object { label: Some("pillar".into()), ..Object::default() };
    /// let walls = [[0.0, 1.0], [3.0, 4.0]].map(|[a, b]| [[a, 0.0].into(), [b, 0.0].into()]);
    /// let scene = Scene::of(vec![pillar], walls.map(|ends| Wall { ends, object: 0, reversed: false }))?;
    /// let names: Vec<_> = scene.labelled().into_iter().map(|centre| (centre.name, centre.vertex)).collect();
    /// assert_eq!(names, [("pillar".to_owned(), 0), ("pillar 2".to_owned(), 2)]);
    /// # Ok::<(), tautline::geometry::CoordinateFault>(())
    /// ```
    pub fn labelled(&self) -> Vec<Centre> {
        apart(self.all_labelled())
    }

    /// The obstacles that are called so: by a label, all that have it, or by the number of a wall end. In the order of
    /// the names. O(walls + names).
    ///
    /// # Errors
    ///
    /// The first name that neither is a label nor the number of a wall end.
    pub fn called(&self, names: &[String]) -> Result<Vec<Centre>, UnknownObstacle> {
        let all = self.all_labelled();
        let mut found = Vec::new();
        for name in names {
            let before = found.len();
            found.extend(all.iter().filter(|(label, _)| label == name).cloned());
            if found.len() == before {
                let vertex = name.parse().ok().filter(|&v: &u32| (v as usize) < self.vertices().len());
                let vertex = vertex.ok_or_else(|| self.unknown(name, &all))?;
                found.push((format!("vertex {vertex}"), vertex));
            }
        }
        let mut seen = BTreeSet::new();
        found.retain(|(_, vertex)| seen.insert(*vertex));
        Ok(apart(found))
    }

    fn all_labelled(&self) -> Vec<(String, u32)> {
        let labels = self.labels();
        let label = |v: u32| labels.get(v as usize).copied().flatten();
        let mut all: Vec<(String, u32)> = all_islands(self)
            .iter()
            .filter_map(|island| Some((label(island.named)?.to_owned(), island.named)))
            .collect();
        all.sort_by_key(|(_, vertex)| *vertex);
        all
    }

    fn unknown(&self, name: &str, all: &[(String, u32)]) -> UnknownObstacle {
        let names: BTreeSet<&str> = all.iter().map(|(label, _)| label.as_str()).collect();
        let nearest = names.iter().map(|known| (strsim::damerau_levenshtein(name, known), known)).min();
        let numbers = match self.vertices().len() {
            0 => String::new(),
            n => format!(", or the number of a wall end, 0 to {}", n - 1),
        };
        let hint = match nearest.filter(|(distance, known)| *distance <= 1 + known.len() / 3) {
            Some((_, nearest)) => format!("; did you mean {nearest:?}?"),
            None if names.is_empty() => format!("; the scene has no labels{numbers}"),
            None => {
                let told: Vec<String> = names.iter().take(TOLD).map(|name| format!("{name:?}")).collect();
                let more = if names.len() > TOLD { ", ..." } else { "" };
                format!("; give one of {}{more}{numbers}", told.join(", "))
            }
        };
        UnknownObstacle { name: name.to_owned(), hint }
    }
}

/// Each with a name of its own.
fn apart(all: Vec<(String, u32)>) -> Vec<Centre> {
    let mut taken = BTreeSet::new();
    let mut centre = |(name, vertex): (String, u32)| {
        let numbered = (2..).map(|n: u32| format!("{name} {n}"));
        let name = std::iter::once(name.clone()).chain(numbered).find(|name| !taken.contains(name));
        let name = name.expect("numbers do not end");
        taken.insert(name.clone());
        Centre { name, vertex }
    };
    all.into_iter().map(&mut centre).collect()
}
