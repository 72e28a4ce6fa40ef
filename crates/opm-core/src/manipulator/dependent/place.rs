//! The orientation of a platform that several legs constrain, from its position.
//!
//! Where one of the [rows](super::rows) is that an axis `m` of the platform keeps its angle with an axis `u` of the base, the
//! orientation from home is `R = Ru(α) Rm(β)`: the first rotation takes `m` to where it is, and the second one is about it. The
//! other two rows are harmonic in either angle, and one of them is in one angle alone. It tells that angle, the other row
//! tells the other one: `A cos + B sin + C = 0` both times, four poses together. So it is for an Exechon, whose first
//! two legs lie in one plane through `u`.

use super::rows::{HOLDS, LEVEL, Row};
use super::zeros::Function;
use crate::chain::ReachDeficit;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, Matrix3, Rotation3, Unit, Vector3};

/// Axes whose sine is smaller are one.
const APART: f64 = 0.1;
/// Angles and positions, over the size, by which it is tried what a row depends on.
const TRIED: [([f64; 2], [f64; 3]); 4] = [
    ([0.3, -0.4], [0.2, 0.1, -0.3]),
    ([-0.5, 0.2], [-0.1, 0.3, 0.2]),
    ([0.9, 0.7], [0.4, -0.2, 0.1]),
    ([-0.2, -1.1], [-0.3, -0.4, -0.2]),
];

/// The two angles, and which rows tell them.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// The axes of the base and of the platform, at home.
    axes: [Unit<Vector3<f64>>; 2],
    /// Which of the angles is found first, and the numbers of the rows that tell the first and the second one.
    first: usize,
    rows: [usize; 2],
    functions: [Function; 2],
}

impl Place {
    /// That of three rows, the first of which is about directions alone. `None` where none of the others has one angle alone,
    /// or where they do not tell the angles at home.
    pub fn new(rows: &[Row]) -> Option<Self> {
        let [couple, others @ ..] = rows else { return None };
        let none = |row: &Row| row.direction == Vector3::zeros();
        if others.len() != 2 || !none(couple) || others.iter().any(none) {
            return None;
        }
        let svd = Svd::new(DMatrix::from_fn(3, 3, |i, j| couple.turn[(i, j)]));
        let [largest, second, ..] = svd.values[..] else { return None };
        if second > HOLDS * largest {
            return None;
        }
        // ⟨u mᵀ, R⟩ = u · R m.
        let m = Unit::new_normalize(Vector3::from_fn(|i, _| svd.right[(i, 0)]));
        let u = Unit::new_normalize(couple.turn * m.into_inner());
        if u.cross(&m).norm() < APART {
            return None;
        }
        let axes = [u, m];
        let value = |row: &Row, angles: [f64; 2], p: [f64; 3]| {
            row.value(&turned(&axes, angles), &Vector3::from(p))
        };
        // Whether a row does not change with an angle.
        let is_free = |row: &Row, of: usize| {
            TRIED.iter().all(|&(angles, p)| {
                [0.7, 2.1].into_iter().all(|by| {
                    let mut moved = angles;
                    moved[of] += by;
                    (value(row, moved, p) - value(row, angles, p)).abs() <= HOLDS
                })
            })
        };
        let (first, alone) = [(0, 0), (0, 1), (1, 0), (1, 1)]
            .into_iter()
            .find(|&(first, row)| is_free(&others[row], 1 - first))?;
        let rows = [1 + alone, 2 - alone];
        let mut found = Self { axes, first, rows, functions: [Function::harmonic(0.0, 1.0); 2] };
        let all = [couple.clone(), others[0].clone(), others[1].clone()];
        for step in 0..2 {
            let values = found.values(&all, step, [0.0; 2], &Vector3::zeros());
            let unit = found.functions[step].amplitude(values);
            if unit < LEVEL {
                return None;
            }
            found.functions[step].unit = unit;
        }
        Some(found)
    }

    /// The angle that a step finds.
    fn angle(&self, step: usize) -> usize {
        if step == 0 { self.first } else { 1 - self.first }
    }

    /// The values of the row of a step at the places of its function.
    fn values(&self, rows: &[Row], step: usize, angles: [f64; 2], p: &Vector3<f64>) -> [f64; 3] {
        let row = &rows[self.rows[step]];
        self.functions[step].places().map(|at| {
            let mut tried = angles;
            tried[self.angle(step)] = at;
            row.value(&turned(&self.axes, tried), p)
        })
    }

    /// The orientation from home at a position from home, over the size, where the rows rise or fall as `signs` say.
    ///
    /// # Errors
    /// By how much no angle satisfies a row.
    pub fn orientation(
        &self,
        rows: &[Row],
        p: &Vector3<f64>,
        signs: [f64; 2],
    ) -> Result<Matrix3<f64>, ReachDeficit> {
        let mut angles = [0.0; 2];
        for step in 0..2 {
            let (values, function) = (self.values(rows, step, angles, p), &self.functions[step]);
            angles[self.angle(step)] = function
                .zero(values, signs[step], 0.0)
                .map_err(|value| ReachDeficit::angle((value / function.unit).abs()))?;
        }
        Ok(turned(&self.axes, angles))
    }
}

/// The rotation about the base's axis behind that about the platform's.
fn turned([u, m]: &[Unit<Vector3<f64>>; 2], [alpha, beta]: [f64; 2]) -> Matrix3<f64> {
    (Rotation3::from_axis_angle(u, alpha) * Rotation3::from_axis_angle(m, beta)).into_inner()
}
