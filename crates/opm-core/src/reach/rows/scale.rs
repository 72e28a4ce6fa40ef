//! How the poses of a row follow from the displacement along it.

use super::SheetRows;

/// How near to the end of what a leg reaches a pose may be, in steps, and still be decided by another pose.
pub const TIE: f64 = 1e-6;

/// How the poses of a row follow from the displacement along it.
#[derive(Clone, Copy)]
pub struct RowScale {
    /// The displacement at the first pose, radians or metres.
    pub first: f64,
    /// The number of poses in a unit of it.
    pub per_step: f64,
    /// The displacement from the first to the last pose.
    pub length: f64,
    /// The number of poses.
    pub count: f64,
    /// How far an end may be off, in steps.
    pub tie: f64,
}

impl RowScale {
    /// That of some rows whose first pose is displaced by `first`, radians or metres.
    pub fn new(rows: &SheetRows<'_>, first: f64) -> Self {
        Self {
            first,
            per_step: rows.step.recip(),
            length: rows.step * (rows.count - 1) as f64,
            count: rows.count as f64,
            tie: TIE.max(rows.extent * 1e-12),
        }
    }

    /// The numbers of the poses in an interval.
    #[inline(always)]
    pub fn inside(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let first = ((from - self.first) * self.per_step).ceil();
        let after = ((to - self.first) * self.per_step).floor() + 1.0;
        let first = if first > 0.0 { first } else { 0.0 };
        let first = if first < self.count { first } else { self.count };
        let after = if after < self.count { after } else { self.count };
        [first, if after > first { after } else { first }]
    }

    /// The numbers of the poses near an interval.
    #[inline(always)]
    pub fn poses(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let first = ((from - self.first) * self.per_step - self.tie).ceil();
        let after = ((to - self.first) * self.per_step + self.tie).floor() + 1.0;
        // What is not a number is beyond all poses.
        let first = if first > 0.0 { first } else { 0.0 };
        let first = if first < self.count { first } else { self.count };
        let after = if after < self.count { after } else { self.count };
        let after = if after > first { after } else { first };
        let empty = to < from;
        [if empty { 0.0 } else { first }, if empty { 0.0 } else { after }]
    }
}
