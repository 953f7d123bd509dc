//! Records as bytes, for pickles.

use serde::{Deserialize, Serialize};
use tautline::rope::{Event, EventKind, Side, Status, TraceRecord};

use crate::fault::Fault;

/// A record as it is written.
#[derive(Serialize, Deserialize)]
pub(crate) struct Stored {
    trace: u64,
    is_ok: bool,
    steps: u64,
    lengths: [f64; 2],
    depths: [u32; 2],
    wraps: Vec<([f64; 2], bool)>,
    pull: Option<[f64; 2]>,
    /// Step, whether it is a wrap, vertex, whether that lies on the left.
    events: Vec<(u32, bool, u32, bool)>,
}

impl From<&TraceRecord> for Stored {
    fn from(r: &TraceRecord) -> Self {
        let left = |side| side == Side::Left;
        Stored {
            trace: r.trace,
            is_ok: r.status == Status::Ok,
            steps: r.steps,
            lengths: [r.length, r.max_length],
            depths: [r.depth, r.max_depth],
            wraps: r.wraps.iter().map(|(at, side)| (at.to_array(), left(*side))).collect(),
            pull: r.pull.map(|pull| pull.to_array()),
            events: r.events.iter().map(|e| (e.step, e.kind == EventKind::Wrap, e.vertex, left(e.side))).collect(),
        }
    }
}

impl Stored {
    pub(crate) fn record(&self) -> TraceRecord {
        let side = |left: bool| if left { Side::Left } else { Side::Right };
        let event = |&(step, wrap, vertex, left): &(u32, bool, u32, bool)| Event {
            step,
            kind: if wrap { EventKind::Wrap } else { EventKind::Unwrap },
            vertex,
            side: side(left),
        };
        TraceRecord {
            trace: self.trace,
            status: if self.is_ok { Status::Ok } else { Status::Violation },
            steps: self.steps,
            length: self.lengths[0],
            max_length: self.lengths[1],
            depth: self.depths[0],
            max_depth: self.depths[1],
            wraps: self.wraps.iter().map(|&(at, left)| (at.into(), side(left))).collect(),
            pull: self.pull.map(Into::into),
            events: self.events.iter().map(event).collect(),
        }
    }
}

/// All of a pickle's contents.
#[derive(Serialize, Deserialize)]
pub(crate) struct Pickled {
    pub(crate) engine: String,
    /// The traces' points, flat; none where they were not kept.
    pub(crate) traces: Option<Vec<(u64, Vec<f64>)>>,
    pub(crate) ends: Vec<[f64; 2]>,
    pub(crate) records: Vec<Stored>,
    /// The table of results, where it cannot be made of the records any more.
    pub(crate) results: Option<Vec<u8>>,
    /// About what turns are counted, if that was said: names and wall ends.
    pub(crate) centres: Option<Vec<(String, u32)>>,
    pub(crate) friction: Option<f64>,
    /// The table of steps, where it cannot be made any more.
    pub(crate) steps: Option<Vec<u8>>,
}

impl Pickled {
    pub(crate) fn bytes(&self) -> Result<Vec<u8>, Fault> {
        postcard::to_stdvec(self).map_err(Fault::input)
    }

    pub(crate) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        postcard::from_bytes(bytes).map_err(|error| Fault::input(format!("no ropes that were pickled: {error}")))
    }
}
