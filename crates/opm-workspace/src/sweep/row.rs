//! The reachable poses of one row.

use super::runs::{self, Run};

/// The row that is being decided.
#[derive(Default)]
pub struct DecidedRow {
    /// The reachable poses, as far as they were decided.
    pub reached: Vec<Run>,
    /// The next value of `reached`.
    next: Vec<Run>,
}

impl DecidedRow {
    /// Takes these poses for the reachable ones; returns how many they are.
    pub fn take(&mut self, runs: impl Iterator<Item = Run>) -> u64 {
        self.reached.clear();
        self.reached.extend(runs);
        self.count()
    }

    /// Keeps the reachable poses that are also `admitted`; returns how many they are.
    pub fn retain(&mut self, mut admitted: impl FnMut(u64) -> bool) -> u64 {
        self.next.clear();
        for number in runs::poses(&self.reached) {
            if admitted(number) {
                runs::push(&mut self.next, number);
            }
        }
        std::mem::swap(&mut self.reached, &mut self.next);
        self.count()
    }

    fn count(&self) -> u64 {
        self.reached.iter().map(|run| run.to - run.from).sum()
    }
}
