//! Reading and checking a study's file.

use std::path::Path;

use super::file_places::{explain, line_of, vanishing};
use super::plan::{AnchorPlan, Plan};
use super::plan_error::{PlanError, PlanFault};
use super::tally::Tallies;
use crate::engine::Precision;
use crate::geometry::number;
use crate::read_file::{SETTINGS_MAX, read_text};

/// The study that is run when no file is given, and the template of new ones.
pub const EXAMPLE: &str = include_str!("example.toml");

/// The most blocks that a study can have.
const MOST_BLOCKS: u64 = 1 << 20;

/// How many points the traces of a block may have: some 4 GB, with all that belongs to them.
const MOST_POINTS: u64 = 1 << 27;

impl Plan {
    /// Reads a study's file (TOML) and checks everything that can be checked without its scene.
    ///
    /// # Errors
    ///
    /// What is wrong, with its line; for an unknown key, the one that it is most like.
    pub fn read(path: &Path) -> Result<Plan, PlanError> {
        let text = read_text(path, SETTINGS_MAX)?;
        Plan::parse(&text).map_err(|e| e.at(path))
    }

    /// The study that `text` describes.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read), without the file's name.
    ///
    /// ```
    /// use tautline::study::{EXAMPLE, Plan};
    /// let plan = Plan::parse(EXAMPLE)?;
    /// assert_eq!(plan.run.traces, Some(10_000));
    /// let wrong = EXAMPLE.replace("block", "blok");
    /// assert!(Plan::parse(&wrong).unwrap_err().what().contains("did you mean `block`?"));
    /// # Ok::<(), tautline::study::PlanError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Plan, PlanError> {
        let plan: Plan = toml::from_str(text).map_err(|e| explain(text, &e))?;
        let checked = vanishing(text).map_or_else(|| plan.checked(), |what| Err(PlanError::new(what)));
        checked.map_err(|e| PlanError { line: e.key.as_deref().and_then(|key| line_of(text, key)), ..e })
    }

    /// The plan, if it can be carried out as far as can be told without its scene.
    ///
    /// # Errors
    ///
    /// The first key whose value will not do, and what would.
    pub fn checked(self) -> Result<Plan, PlanError> {
        self.check().map(|()| self)
    }

    /// The JSON Schema of the file.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Plan).to_value()
    }

    fn check(&self) -> Result<(), PlanError> {
        let err = |what: String| Err(PlanError::new(what));
        match (&self.scene.built_in, &self.scene.file) {
            (Some(_), Some(_)) => return err("scene: give `built_in` or `file`, not both".into()),
            (None, None) => return err("scene: give `file = \"...\"` or `built_in = \"rooms\"`".into()),
            _ => {}
        }
        let scene = &self.scene;
        if !(1..=2).contains(&scene.ros) {
            return err(format!("scene.ros: there is no ROS {}; give 1 or 2", scene.ros));
        }
        if let Some(bad) = scene.flatten.filter(|t| !(t.is_finite() && *t > 0.0)) {
            return err(format!(
                "scene.flatten: {} is no tolerance; give a length above 0, or leave it out",
                number(bad)
            ));
        }
        if scene.built_in.is_some() && !(scene.layers.is_empty() && scene.without_layers.is_empty()) {
            return err("scene: `layers` and `without_layers` go with a `file`; built-in scenes have none".into());
        }
        match &self.scene.anchor {
            Some(AnchorPlan::Several(anchors)) if anchors.is_empty() || anchors.len() > 1024 => {
                return err(format!("scene.anchor: give 1 to 1024 points, not {}", anchors.len()));
            }
            Some(AnchorPlan::Sampled(s)) if !(1..=1024).contains(&s.sample) => {
                return err(format!("scene.anchor: sample 1 to 1024 points, not {}", s.sample));
            }
            _ => {}
        }
        let one = matches!(self.scene.anchor, None | Some(AnchorPlan::One(_)));
        if self.is_given() && !one {
            return err("scene.anchor: given traces go by one anchor".into());
        }
        self.walk.check()?;
        let run = &self.run;
        if run.traces == Some(0) || run.block == 0 {
            return err("run: `traces` and `block` must be at least 1".into());
        }
        if run.stride == 0 {
            return err("run.stride: must be at least 1, which uses every point".into());
        }
        if let Some(bad) = run.simplify.filter(|t| !(t.is_finite() && *t > 0.0)) {
            return err(format!(
                "run.simplify: {} is no tolerance; give a length above 0, or leave it out",
                number(bad)
            ));
        }
        if self.blocks() > MOST_BLOCKS {
            let least = run.count().div_ceil(MOST_BLOCKS);
            let most = MOST_BLOCKS * u64::from(u32::MAX);
            return err(match u32::try_from(least) {
                Ok(least) => format!("run.block: {} traces need blocks of at least {least}", run.count()),
                Err(_) => format!("run.traces: {} are too many; at most {most} will do", run.count()),
            });
        }
        if let Some(steps) = self.walk.steps() {
            let most = MOST_POINTS / (u64::from(steps) + 1);
            if most == 0 {
                let most = MOST_POINTS - 1;
                return err(format!(
                    "walk.steps: a trace of {steps} steps takes too much memory; at most {most} will do"
                ));
            }
            if u64::from(run.block) > most {
                return err(format!(
                    "run.block: blocks of {} traces of {steps} steps take too much memory; at most {most} will do",
                    run.block
                ));
            }
        }
        Tallies::check(&self.tallies)?;
        let (outputs, count) = (&self.outputs, (!self.is_given()).then(|| run.count()));
        for (key, chosen) in [("outputs.steps", &outputs.steps), ("outputs.points", &outputs.points)] {
            chosen.as_ref().map_or(Ok(()), |chosen| chosen.check(key, count))?;
        }
        if outputs.steps.is_some() && run.precision == Precision::Fast {
            return err("outputs.steps: are those of exact ropes; leave it out where run.precision is \"fast\"".into());
        }
        for (name, value) in [("relative_error", self.until.relative_error), ("seconds", self.until.seconds)] {
            if value.is_some_and(|v| !(v.is_finite() && v > 0.0)) {
                return err(format!("until.{name}: must be above 0"));
            }
        }
        Ok(())
    }

    /// Refuses to share out a study that ends by the clock: how far that is depends on the machine, so its parts would
    /// make no study that another run gives again.
    ///
    /// # Errors
    ///
    /// A plan with `until.seconds`.
    pub fn check_shared(&self) -> Result<(), PlanError> {
        match self.until.seconds {
            None => Ok(()),
            Some(_) => Err(PlanError::at_key(
                "until.seconds",
                PlanFault::Value(
                    "how far a study comes in a time depends on the machine, so it cannot be shared out; leave it out, \
                     and have each part stop in time by --stop-after, or end the study by until.relative_error"
                        .to_owned(),
                ),
            )),
        }
    }

    /// How many blocks it has. O(1).
    pub fn blocks(&self) -> u64 {
        self.run.count().div_ceil(u64::from(self.run.block))
    }

    /// Whether its traces come from a file.
    pub fn is_given(&self) -> bool {
        self.walk.given().is_some()
    }
}

impl PlanError {
    /// The same of the study's file at `path`: with its name and, where a key of it is at fault, the line. What is
    /// wrong with other files stays as it is.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        let text = read_text(path, SETTINGS_MAX).unwrap_or_default();
        let line = self.key.as_deref().and_then(|key| line_of(&text, key));
        if self.is_placed() || line.is_none() { self } else { PlanError { path: Some(path.into()), line, ..self } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn fault(from: &str, to: &str) -> String {
        assert!(EXAMPLE.contains(from), "{from}");
        Plan::parse(&EXAMPLE.replacen(from, to, 1)).unwrap_err().what()
    }

    #[test]
    fn faults_are_named_with_their_place() {
        assert!(fault("[tallies]", "[talies]").contains("did you mean `tallies`?"));
        assert!(fault("steps = ", "stpes = ").contains("did you mean `steps`?"));
        assert!(fault("kind = \"persistent\"", "kind = \"persistant\"").contains("did you mean `persistent`?"));
        assert!(fault("traces = 10_000", "traces = 0").contains("at least 1"));
        assert!(fault("traces = 10_000", "traces = -1").contains("line "));
        assert!(fault("built_in = \"rooms\"", "anchor = \"here\"\nbuilt_in = \"rooms\"").contains("[x, y]"));
        assert!(fault("built_in = \"rooms\"", "").contains("scene"));
        assert!(fault("built_in", "ros = 3\nbuilt_in").contains("scene.ros: there is no ROS 3; give 1 or 2"));
        assert!(fault("built_in", "layers = [\"a\"]\nbuilt_in").contains("go with a `file`"));
        assert!(fault("block = 1000", "block = 1\ntraces = 9_000_000").contains("line "));
    }

    #[test]
    fn programs_can_tell_faults_apart() {
        let line = |key: &str| EXAMPLE.lines().position(|line| line.trim_start().starts_with(key)).unwrap() + 1;
        let wrong = Plan::parse(&EXAMPLE.replacen("stride = 1", "stride = 0", 1)).unwrap_err();
        assert_eq!((wrong.key.as_deref(), wrong.line), (Some("run.stride"), Some(line("stride"))));
        assert!(
            matches!(&*wrong.fault, PlanFault::Value(what) if what == "must be at least 1, which uses every point")
        );
        assert_eq!(wrong.what(), format!("line {}: run.stride: {}", line("stride"), wrong.fault));

        let form = Plan::parse(&EXAMPLE.replacen("built_in", "anchor = 3\nbuilt_in", 1)).unwrap_err();
        assert_eq!(form.key.as_deref(), Some("scene.anchor"));
        assert!(matches!(*form.fault, PlanFault::AnchorForm));

        let folder = Path::new("/nowhere");
        let plan = |scene: &str| Plan::parse(&EXAMPLE.replacen("built_in = \"rooms\"", scene, 1)).unwrap();
        let missing = Study::open(plan("file = \"a.wkt\""), folder).err().unwrap();
        assert!(
            matches!((missing.key.as_deref(), &*missing.fault), (Some("scene.file"), PlanFault::Read(_))),
            "{missing:?}"
        );
        let unknown = Study::open(plan("built_in = \"halls\""), folder).err().unwrap();
        assert!(matches!((unknown.key.as_deref(), &*unknown.fault), (Some("scene.built_in"), PlanFault::BuiltIn(_))));
        assert!(unknown.to_string().starts_with("scene.built_in: no built-in scene is called \"halls\""), "{unknown}");
    }

    #[test]
    fn a_plan_written_is_read_back() {
        let plan = Plan::parse(EXAMPLE).unwrap();
        assert_eq!(Plan::parse(&toml::to_string(&plan).unwrap()).unwrap(), plan);
        let json = serde_json::to_string(&plan).unwrap();
        assert_eq!(serde_json::from_str::<Plan>(&json).unwrap(), plan);
        assert!(Plan::schema()["properties"]["walk"].is_object());
    }
}
