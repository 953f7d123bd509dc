//! Ropes after steps, column by column.

use super::{EndsSteps, RopeStep, Steps, Strain};

/// Ropes after steps as columns, one entry a step: all of the same length but `windings`, which has such a column for
/// each centre, and `bx` and `by`, which are empty where the anchor does not move. What is [`RopeStep`]'s, in the
/// scene's unit.
///
/// ```
/// use std::sync::Arc;
/// use tautline::engine::{Cpu, Engine, Job};
/// use tautline::example::{Walker, floor_plan, walks};
/// use tautline::rope::{StepColumns, Steps};
/// use tautline::scene::Model;
/// use tautline::trace::settle;
///
/// let model = Arc::new(Model::new(floor_plan(), None)?);
/// let traces: Vec<_> = walks(&model, Walker { step: 0.25, steps: 500, seed: 1 }, 20);
/// let settled: Vec<_> = traces.iter().map(|trace| settle(&model, trace)).collect();
/// let records = Cpu::new(model.clone()).evaluate(&settled, &Job::new())?;
/// let mut columns = StepColumns::new(0);
/// for (trace, record) in settled.iter().zip(&records) {
///     columns.take(record.trace, &mut Steps::new(&model, trace, record, &[]), usize::MAX);
/// }
/// let longest = columns.length.iter().copied().fold(0.0, f64::max);
/// assert_eq!((columns.len(), longest), (20 * 501, records.iter().map(|r| r.max_length).fold(0.0, f64::max)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StepColumns {
    /// The trace's number.
    pub trace: Vec<u64>,
    /// The step's.
    pub step: Vec<u64>,
    /// Where the free end is.
    pub x: Vec<f64>,
    /// And how high.
    pub y: Vec<f64>,
    /// Where the anchor is, if it moves; empty if it does not.
    pub bx: Vec<f64>,
    /// And how high.
    pub by: Vec<f64>,
    /// The taut rope's length.
    pub length: Vec<f64>,
    /// The number of its contacts.
    pub contacts: Vec<u32>,
    /// The number of its turns.
    pub turns: Vec<u32>,
    /// The unit vector of its pull; 0 for a rope of no length.
    pub pull_x: Vec<f64>,
    /// And upwards.
    pub pull_y: Vec<f64>,
    /// Whether the rope has a length, so that it pulls.
    pub pulls: Vec<bool>,
    /// Where friction is asked for, else empty: what [`Strain`] says.
    pub strain: StrainColumns,
    /// For each centre: how often the free end has gone all the way round.
    pub windings: Vec<Vec<i64>>,
}

/// What [`Strain`] says after steps, as columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StrainColumns {
    /// The unit vector of the rope's pull on the anchor; 0 for a rope of no length.
    pub anchor_pull_x: Vec<f64>,
    /// And upwards.
    pub anchor_pull_y: Vec<f64>,
    /// By which angle the rope turns in all.
    pub turned: Vec<f64>,
    /// The tension at the free end when it is hauled.
    pub tension: Vec<f64>,
    /// The work of the free end.
    pub work: Vec<f64>,
}

impl StrainColumns {
    fn push(&mut self, strain: &Strain) {
        let pull = strain.anchor_pull.unwrap_or_default();
        self.anchor_pull_x.push(pull.x);
        self.anchor_pull_y.push(pull.y);
        self.turned.push(strain.turned);
        self.tension.push(strain.tension);
        self.work.push(strain.work);
    }
}

impl StepColumns {
    /// Empty columns, with windings about so many centres.
    pub fn new(centres: usize) -> Self {
        StepColumns { windings: vec![Vec::new(); centres], ..StepColumns::default() }
    }

    /// How many steps they hold.
    pub fn len(&self) -> usize {
        self.trace.len()
    }

    /// Whether they hold none.
    pub fn is_empty(&self) -> bool {
        self.trace.is_empty()
    }

    /// Adds the next steps of the trace of that number until they hold `most`; whether all of its steps are told.
    /// O(steps).
    ///
    /// # Panics
    ///
    /// If the steps have windings about another number of centres; and as [`Steps::next`].
    pub fn take(&mut self, trace: u64, steps: &mut Steps<'_>, most: usize) -> bool {
        while self.len() < most {
            let Some(step) = steps.next() else { return true };
            self.push(trace, &step, steps.strain(), steps.windings());
        }
        false
    }

    /// The same where the anchor moves; columns are of traces of the one kind or of the other.
    ///
    /// # Panics
    ///
    /// As [`take`](Self::take).
    pub fn take_ends(&mut self, trace: u64, steps: &mut EndsSteps<'_>, most: usize) -> bool {
        while self.len() < most {
            let Some((step, anchor)) = steps.next() else { return true };
            self.bx.push(anchor.x);
            self.by.push(anchor.y);
            self.push(trace, &step, steps.strain(), steps.windings());
        }
        false
    }

    fn push(&mut self, trace: u64, step: &RopeStep, strain: Option<Strain>, windings: impl Iterator<Item = i64>) {
        let pull = step.pull.unwrap_or_default();
        self.trace.push(trace);
        self.step.push(step.step);
        self.x.push(step.at.x);
        self.y.push(step.at.y);
        self.length.push(step.length);
        self.contacts.push(step.contacts);
        self.turns.push(step.turns);
        self.pull_x.push(pull.x);
        self.pull_y.push(pull.y);
        self.pulls.push(step.pull.is_some());
        strain.iter().for_each(|strain| self.strain.push(strain));
        let mut columns = self.windings.iter_mut();
        for rounds in windings {
            columns.next().expect("a column for each centre").push(rounds);
        }
        assert!(columns.next().is_none(), "a centre for each column");
    }
}
