//! Why there is no drawing.

/// Why a drawing cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DrawError {
    /// What was asked for needs a trace.
    #[error("{what} needs a trace")]
    NoTrace {
        /// What was asked for.
        what: &'static str,
    },
    /// What was asked for shows one trace only.
    #[error("{what} shows one trace; {traces} were given")]
    OneTrace {
        /// What was asked for.
        what: &'static str,
        /// How many traces there are.
        traces: usize,
    },
    /// What was asked for has the anchor stay where it is.
    #[error("{what} is of a rope that is tied, and in trace {trace} the anchor moves: draw it after a step")]
    AnchorMoves {
        /// What was asked for.
        what: &'static str,
        /// The trace's number.
        trace: u64,
    },
    /// There are more traces than can be told apart.
    #[error("{traces} traces in one picture cannot be told apart; at most {most} can")]
    TooManyTraces {
        /// How many traces there are.
        traces: usize,
        /// How many there may be.
        most: usize,
    },
    /// The trace has no such step.
    #[error("trace {trace} ends with step {steps}, so there is no step {step}")]
    Step {
        /// The trace's number.
        trace: u64,
        /// Which step was asked for.
        step: usize,
        /// The trace's last step.
        steps: usize,
    },
    /// There is nothing to be shown event by event.
    #[error("trace {trace} has no events: its rope touches nothing")]
    NoEvents {
        /// The trace's number.
        trace: u64,
    },
    /// There are no such events.
    #[error("trace {trace} has events 1 to {events}, so there are no events {from} to {to}")]
    Events {
        /// The trace's number.
        trace: u64,
        /// The first that was asked for, counted from 1.
        from: usize,
        /// The last.
        to: usize,
        /// How many there are.
        events: usize,
    },
    /// More small pictures than one picture holds.
    #[error("events {from} to {to} are {}; one picture holds {most}", to - from + 1)]
    TooManyFrames {
        /// The first that was asked for, counted from 1.
        from: usize,
        /// The last.
        to: usize,
        /// How many there may be.
        most: usize,
    },
    /// The part of the plane that is to be shown is none.
    #[error("the part of the plane from ({}, {}) to ({}, {}) is empty or not finite",
        corners[0], corners[1], corners[2], corners[3])]
    Part {
        /// The corners, as they were given.
        corners: [String; 4],
    },
}
