//! The actuated joints' Jacobian in units in which its singular values have a meaning, of many poses at once.
//!
//! The velocity of the platform's reference point and the rates of sliders are divided by the characteristic length.
//! Columns become orthonormal components of the platform's twist: with the metric `L Lᵀ` of the section twist's
//! components, these are multiplied by `Lᵀ`.

use super::Conditioning;
use crate::numeric::Quantity;
use crate::numeric::extremes::{Extremes, Matrices, Reflection, extremes};

/// The Jacobians of `L` poses, with room for `N` degrees of freedom.
pub(super) struct Weighted<const N: usize, const L: usize> {
    /// The number of degrees of freedom.
    freedoms: usize,
    /// One over the characteristic length, 1/m.
    scale: f64,
    /// The platform's twist `(ω; v)` for each component of the section twist.
    pub platform: [[[f64; L]; 6]; N],
    /// The joints' rates for each component of the section twist, or a triangular matrix with the same singular values.
    joints: Matrices<N, L>,
    /// The number of joints.
    count: usize,
}

impl<const N: usize, const L: usize> Weighted<N, L> {
    #[inline(always)]
    pub fn new(freedoms: usize, scale: f64) -> Self {
        let platform = [[[0.0; L]; 6]; N];
        Self { freedoms, scale, platform, joints: [[[0.0; L]; N]; N], count: 0 }
    }

    /// Adds an actuated joint, with its rates for the components of the section twist.
    #[inline(always)]
    pub fn push(&mut self, mut rates: [[f64; L]; N], quantity: Quantity) {
        if quantity == Quantity::Length {
            for rate in rates.as_flattened_mut() {
                *rate *= self.scale;
            }
        }
        let n = self.freedoms;
        if self.count == n {
            // There are more rows than columns. Their triangular factor has the same singular values.
            let rows = std::mem::replace(&mut self.joints, [[[0.0; L]; N]; N]);
            for row in 0..n {
                self.rotate_in(std::array::from_fn(|column| rows[column][row]));
            }
        }
        if self.count < n {
            for (column, rate) in self.joints.iter_mut().zip(rates) {
                column[self.count] = rate;
            }
        } else {
            self.rotate_in(rates);
        }
        self.count += 1;
    }

    /// Adds a row to the triangular factor, by Givens rotations.
    #[inline(always)]
    fn rotate_in(&mut self, mut next: [[f64; L]; N]) {
        for i in 0..self.freedoms {
            let (mut cos, mut sin) = ([1.0; L], [0.0; L]);
            for lane in 0..L {
                let (above, below) = (self.joints[i][i][lane], next[i][lane]);
                let length = (above * above + below * below).sqrt();
                let any = length > 0.0;
                cos[lane] = if any { above / length } else { 1.0 };
                sin[lane] = if any { below / length } else { 0.0 };
            }
            for j in i..self.freedoms {
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
        mut self,
        locked: impl ExactSizeIterator<Item = [[f64; L]; N]>,
    ) -> [Conditioning; L] {
        let (n, free) = (self.freedoms, self.freedoms - locked.len());
        let metric = self.metric();
        for row in 0..n {
            let mut rates = std::array::from_fn(|column| self.joints[column][row]);
            divide(&mut rates, &metric, n);
            for (column, rate) in self.joints.iter_mut().zip(rates) {
                column[row] = rate;
            }
        }
        self.restrict(locked, &metric);
        let Extremes { largest, smallest, product } = extremes(&mut self.joints, [n, free]);
        std::array::from_fn(|lane| {
            Conditioning::of_values(largest[lane], smallest[lane], product[lane])
        })
    }

    /// Turns the components of the platform's twist so that the last ones are those that constraining legs prevent.
    #[inline(always)]
    fn restrict(
        &mut self,
        locked: impl ExactSizeIterator<Item = [[f64; L]; N]>,
        metric: &Matrices<N, L>,
    ) {
        let (n, count) = (self.freedoms, locked.len());
        if count == 0 {
            return;
        }
        // A reflection leaves the first component of what it is made from: columns are counted backwards.
        let mut turned: [Reflection<N, L>; N] = std::array::from_fn(|_| Reflection::NONE);
        for (number, mut row) in locked.enumerate() {
            divide(&mut row, metric, n);
            row[..n].reverse();
            for (before, reflection) in turned[..number].iter().enumerate() {
                reflection.apply(&mut row, before, n);
            }
            turned[number] = Reflection::new(row, number, n);
        }
        self.joints[..n].reverse();
        for row in 0..n {
            for (number, reflection) in turned[..count].iter().enumerate() {
                reflection.apply_to_row(&mut self.joints, row, number, n);
            }
        }
        self.joints[..n].reverse();
    }

    /// The triangular factor `Lᵀ` of the metric of the platform's twist, by Cholesky's method. The columns are far from
    /// dependent, so that squaring them loses few digits.
    #[inline(always)]
    fn metric(&self) -> Matrices<N, L> {
        let n = self.freedoms;
        let square = self.scale * self.scale;
        let mut r = [[[0.0; L]; N]; N];
        for i in 0..n {
            for j in i..n {
                let (a, b) = (&self.platform[i], &self.platform[j]);
                for lane in 0..L {
                    let of = |k: usize| a[k][lane] * b[k][lane];
                    r[j][i][lane] = of(0) + of(1) + of(2) + square * (of(3) + of(4) + of(5));
                }
            }
        }
        for i in 0..n {
            for k in 0..i {
                for j in i..n {
                    for lane in 0..L {
                        r[j][i][lane] -= r[i][k][lane] * r[j][k][lane];
                    }
                }
            }
            let mut inverse = [0.0; L];
            for lane in 0..L {
                inverse[lane] = r[i][i][lane].sqrt().recip();
            }
            for column in &mut r[i..n] {
                for lane in 0..L {
                    column[i][lane] *= inverse[lane];
                }
            }
        }
        r
    }
}

/// Computes `row · R⁻¹` in place.
#[inline(always)]
fn divide<const N: usize, const L: usize>(
    row: &mut [[f64; L]; N],
    r: &Matrices<N, L>,
    n: usize,
) {
    for j in 0..n {
        for k in 0..j {
            for lane in 0..L {
                row[j][lane] -= row[k][lane] * r[j][k][lane];
            }
        }
        for lane in 0..L {
            row[j][lane] /= r[j][j][lane];
        }
    }
}
