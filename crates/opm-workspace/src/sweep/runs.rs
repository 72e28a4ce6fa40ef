//! The poses of a row as runs of their numbers, ascending and apart.

/// The numbers from `from` up to, not including, `to`. It is not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The first number.
    pub from: u64,
    /// One more than the last number.
    pub to: u64,
}

/// The numbers in some runs.
pub fn poses(runs: &[Run]) -> impl Iterator<Item = u64> {
    runs.iter().flat_map(|run| run.from..run.to)
}

/// Adds a number that is greater than all others.
pub fn push(runs: &mut Vec<Run>, pose: u64) {
    append(runs, Run { from: pose, to: pose + 1 });
}

/// Adds a run whose numbers are greater than all others.
pub fn append(runs: &mut Vec<Run>, run: Run) {
    match runs.last_mut() {
        Some(last) if last.to == run.from => last.to = run.to,
        _ => runs.push(run),
    }
}

/// Whether two runs have a number in common.
pub fn overlap(run: Run, other: Run) -> bool {
    other.from < run.to && run.from < other.to
}

/// The union of `parts`, which come in any order and may overlap.
pub fn union(parts: impl Iterator<Item = Run>, out: &mut Vec<Run>) {
    out.clear();
    out.extend(parts);
    out.sort_unstable_by_key(|run| run.from);
    out.dedup_by(|next, run| {
        let joined = next.from <= run.to;
        if joined {
            run.to = run.to.max(next.to);
        }
        joined
    });
}

/// The intersection of two sets of runs.
pub fn intersection(a: &[Run], b: &[Run], out: &mut Vec<Run>) {
    out.clear();
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let (from, to) = (a[i].from.max(b[j].from), a[i].to.min(b[j].to));
        if from < to {
            out.push(Run { from, to });
        }
        if a[i].to < b[j].to { i += 1 } else { j += 1 }
    }
}
