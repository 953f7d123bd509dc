//! A study's chosen traces, drawn or read.

use super::chosen::Chosen;
use super::opened::Study;
use super::run_error::RunError;
use crate::trace::SettledTrace;

/// About how many points are held at a time.
const POINTS: u64 = 1 << 20;

impl Study {
    /// Hands the chosen ones among the traces of these blocks, which are in order, to `each`: some at a time, in order,
    /// as they were drawn or given, before anything is left out of them for speed. Memory is that of a block, or of a
    /// million points.
    ///
    /// # Errors
    ///
    /// A file of traces that cannot be read, or that is too short, and those of `each`.
    pub fn choose<E>(
        &self,
        chosen: &Chosen,
        blocks: impl IntoIterator<Item = u64>,
        mut each: impl FnMut(Vec<SettledTrace>) -> Result<(), RunError<E>>,
    ) -> Result<(), RunError<E>> {
        let at_once = (POINTS / (self.plan().walk.steps().map_or(1024, u64::from) + 1)).max(1);
        let mut source = None;
        for block in blocks {
            let numbers = chosen.of_block(self.block(block));
            let mut next = numbers.start;
            while next < numbers.end {
                let some = match chosen {
                    // What is drawn need not be passed over.
                    Chosen::These(list) if !self.plan().is_given() => {
                        match list.iter().filter(|&&number| (next..numbers.end).contains(&number)).min() {
                            Some(&number) => number..number + 1,
                            None => break,
                        }
                    }
                    _ => next..numbers.end.min(next + at_once),
                };
                next = some.end;
                let source = match &mut source {
                    Some(source) => source,
                    None => source.insert(self.source(some.start)?),
                };
                let traces: Vec<SettledTrace> =
                    source.take_whole(some)?.into_iter().filter(|trace| chosen.has(trace.id())).collect();
                if !traces.is_empty() {
                    each(traces)?;
                }
            }
        }
        Ok(())
    }
}
