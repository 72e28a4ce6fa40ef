//! The actuated joints' Jacobian in units in which its singular values have a meaning, of many poses at once.
//!
//! The velocity of the platform's reference point and the rates of sliders are divided by the characteristic length.
//! Columns become orthonormal components of the platform's twist: with the metric `L Lᵀ` of the section twist's
//! components, these are multiplied by `Lᵀ`.

#![expect(clippy::needless_range_loop, reason = "a loop over the lanes is one for all columns")]

use super::Conditioning;
use crate::numeric::Quantity;
use crate::numeric::extremes::{Extremes, Matrices, Reflection, extremes};

/// The metric of the platform's twist at `L` poses, with `N` degrees of freedom.
pub(super) struct Metric<const N: usize, const L: usize> {
    /// One over the characteristic length, 1/m.
    scale: f64,
    /// The triangular factor `Lᵀ`.
    factor: Matrices<N, L>,
    /// One over each number of its diagonal.
    inverse: [[f64; L]; N],
}

/// The Jacobians of `L` poses, with `N` degrees of freedom.
pub(super) struct Weighted<'m, const N: usize, const L: usize> {
    metric: &'m Metric<N, L>,
    /// The joints' rates for each component of the section twist, or a triangular matrix with the same singular values.
    joints: Matrices<N, L>,
    /// The number of joints.
    count: usize,
}

impl<const N: usize, const L: usize> Metric<N, L> {
    /// The metric for the platform's twists `(ω; v)` for each component of the section twist. Its factor is found by
    /// Cholesky's method. The columns are far from dependent, so that squaring them loses few digits.
    #[inline(always)]
    pub fn new(platform: &[[[f64; L]; 6]; N], scale: f64) -> Self {
        let square = scale * scale;
        let (mut r, mut inverse) = ([[[0.0; L]; N]; N], [[0.0; L]; N]);
        for i in 0..N {
            for j in i..N {
                let (a, b) = (&platform[i], &platform[j]);
                for lane in 0..L {
                    let of = |k: usize| a[k][lane] * b[k][lane];
                    r[j][i][lane] = of(0) + of(1) + of(2) + square * (of(3) + of(4) + of(5));
                }
            }
        }
        for i in 0..N {
            for k in 0..i {
                for j in i..N {
                    for lane in 0..L {
                        r[j][i][lane] -= r[i][k][lane] * r[j][k][lane];
                    }
                }
            }
            for lane in 0..L {
                inverse[i][lane] = r[i][i][lane].sqrt().recip();
            }
            for column in &mut r[i..] {
                for lane in 0..L {
                    column[i][lane] *= inverse[i][lane];
                }
            }
        }
        Self { scale, factor: r, inverse }
    }

    /// Divides the rates of some joints by the factor. Each column has a row for each joint.
    #[inline(always)]
    fn divide<const ROWS: usize>(&self, columns: &mut [[[f64; L]; ROWS]; N]) {
        for j in 0..N {
            let (before, column) = columns.split_at_mut(j);
            let column = &mut column[0];
            for (k, before) in before.iter().enumerate() {
                let factor = self.factor[j][k];
                for (row, before) in column.iter_mut().zip(before) {
                    // What is loaded before anything is stored is done in vectors.
                    let mut rest = *row;
                    for lane in 0..L {
                        rest[lane] -= before[lane] * factor[lane];
                    }
                    *row = rest;
                }
            }
            for row in column {
                for lane in 0..L {
                    row[lane] *= self.inverse[j][lane];
                }
            }
        }
    }
}

impl<'m, const N: usize, const L: usize> Weighted<'m, N, L> {
    #[inline(always)]
    pub fn new(metric: &'m Metric<N, L>) -> Self {
        Self { metric, joints: [[[0.0; L]; N]; N], count: 0 }
    }

    /// Adds an actuated joint, with its rates for the components of the section twist.
    #[inline(always)]
    pub fn push(&mut self, mut rates: [[f64; L]; N], quantity: Quantity) {
        if quantity == Quantity::Length {
            for rate in rates.as_flattened_mut() {
                *rate *= self.metric.scale;
            }
        }
        if self.count < N {
            for (column, rate) in self.joints.iter_mut().zip(rates) {
                column[self.count] = rate;
            }
        } else {
            // There are more rows than columns. Their triangular factor has the same singular values. First it takes the rows
            // that were added before; the one call for all of them is compiled once.
            let before = if self.count == N { N } else { 0 };
            let rows = self.joints;
            if before > 0 {
                self.joints = [[[0.0; L]; N]; N];
            }
            for row in 0..=before {
                let last = row == before;
                let next = std::array::from_fn(|j| if last { rates[j] } else { rows[j][row] });
                self.rotate_in(next);
            }
        }
        self.count += 1;
    }

    /// Adds a row to the triangular factor, by Givens rotations.
    #[inline(always)]
    fn rotate_in(&mut self, mut next: [[f64; L]; N]) {
        for i in 0..N {
            let (mut cos, mut sin) = ([1.0; L], [0.0; L]);
            for lane in 0..L {
                let (above, below) = (self.joints[i][i][lane], next[i][lane]);
                let length = (above * above + below * below).sqrt();
                let any = length > 0.0;
                cos[lane] = if any { above / length } else { 1.0 };
                sin[lane] = if any { below / length } else { 0.0 };
            }
            for j in i..N {
                for lane in 0..L {
                    let (above, below) = (self.joints[j][i][lane], next[j][lane]);
                    self.joints[j][i][lane] = cos[lane] * above + sin[lane] * below;
                    next[j][lane] = cos[lane] * below - sin[lane] * above;
                }
            }
        }
    }

    /// The conditioning at each pose, where constraining legs lack joints that would have the rates `locked`.
    #[inline(always)]
    pub fn conditioning(
        &mut self,
        locked: impl ExactSizeIterator<Item = [[f64; L]; N]>,
    ) -> [Conditioning; L] {
        let free = N - locked.len();
        self.metric.divide(&mut self.joints);
        self.restrict(locked);
        let Extremes { largest, smallest, product } = extremes(&mut self.joints, [N, free]);
        std::array::from_fn(|lane| {
            Conditioning::of_values(largest[lane], smallest[lane], product[lane])
        })
    }

    /// Turns the components of the platform's twist so that the last ones are those that constraining legs prevent.
    #[inline(always)]
    fn restrict(&mut self, locked: impl ExactSizeIterator<Item = [[f64; L]; N]>) {
        let count = locked.len();
        if count == 0 {
            return;
        }
        // A reflection leaves the first component of what it is made from: columns are counted backwards.
        let mut turned: [Reflection<N, L>; N] = std::array::from_fn(|_| Reflection::NONE);
        for (number, row) in locked.enumerate() {
            let mut columns = row.map(|rate| [rate]);
            self.metric.divide(&mut columns);
            let mut row = columns.map(|[rate]| rate);
            row.reverse();
            for (before, reflection) in turned[..number].iter().enumerate() {
                reflection.apply(&mut row, before, N);
            }
            turned[number] = Reflection::new(row, number, N);
        }
        self.joints.reverse();
        for row in 0..N {
            for (number, reflection) in turned[..count].iter().enumerate() {
                reflection.apply_to_row(&mut self.joints, row, number, N);
            }
        }
        self.joints.reverse();
    }
}
