//! The rates of dependent coordinates: those at which no locked joint moves.
//!
//! A section that constrains the platform is completed by locked joints (see
//! [`chain::partial`](crate::chain::partial)). Their rates are linear in those of all task coordinates, and zero.
//! That is one equation for each dependent coordinate. The same holds for accelerations.

use super::{JointMotion, SINGULAR, SingularCause, SingularLeg};
use crate::manipulator::{Dependent, Manipulator, Section, Solution};
use crate::numeric::Quantity;

/// The largest number of task coordinates.
const MOST: usize = 6;

/// As many rows and columns as there are dependent coordinates; the rest is unused.
pub(super) type Square = [[f64; MOST]; MOST];

/// Rates and accelerations of all task coordinates.
pub(super) type AllRates = [[f64; MOST]; 2];

impl Manipulator {
    /// The rates and accelerations of all task coordinates for those of the independent ones, and writes the
    /// dependent ones to `out`. `None` where the dependent ones are not determined.
    pub(super) fn all_rates(
        &self,
        dependent: &Dependent,
        at: &Solution,
        given: [&[f64]; 2],
        out: &mut JointMotion,
    ) -> Option<AllRates> {
        let mut all = [[0.0; MOST]; 2];
        for (all, given) in all.iter_mut().zip(given) {
            dependent.independent.iter().zip(given).for_each(|(&i, rate)| all[i] = *rate);
        }
        let n = self.task().coordinates.len();
        let still = [0.0; MOST];
        // The rates of the locked joints for a unit rate of each dependent coordinate.
        let mut matrix = [[0.0; MOST]; MOST];
        for (column, &i) in dependent.coordinates.iter().enumerate() {
            let mut unit = still;
            unit[i] = 1.0;
            let [rates, _] = self.locked_motion(dependent, at, [&unit[..n], &still[..n]]);
            (0..MOST).for_each(|row| matrix[row][column] = rates[row]);
        }
        let units = self.dependent_units();
        for part in 0..2 {
            let moved = self.locked_motion(dependent, at, [&all[0][..n], &all[1][..n]])[part];
            let found =
                solved(matrix, moved.map(|rate| -rate), &units[..dependent.coordinates.len()])?;
            for (&i, rate) in dependent.coordinates.iter().zip(found) {
                all[part][i] = rate;
            }
        }
        let values = |part: [f64; MOST]| dependent.coordinates.iter().map(move |&i| part[i]);
        out.dependent_rates.iter_mut().zip(values(all[0])).for_each(|(to, rate)| *to = rate);
        out.dependent_accelerations
            .iter_mut()
            .zip(values(all[1]))
            .for_each(|(to, rate)| *to = rate);
        Some(all)
    }

    /// One radian or the characteristic length for each dependent coordinate.
    pub(super) fn dependent_units(&self) -> [f64; MOST] {
        let mut units = [1.0; MOST];
        for (unit, coordinate) in units.iter_mut().zip(self.dependent_coordinates()) {
            if coordinate.quantity == Quantity::Length {
                *unit = self.characteristic_length();
            }
        }
        units
    }

    /// The rates and accelerations of the locked joints, for those of all task coordinates.
    fn locked_motion(&self, dependent: &Dependent, at: &Solution, given: [&[f64]; 2]) -> AllRates {
        let mut found = [[0.0; MOST]; 2];
        let twists = self.section_twists(&at.solved.pose, given[0], given[1]);
        for (row, (leg, section, joint)) in dependent.locked(&self.legs).enumerate().take(MOST) {
            let differential = self.leg_differential(at, leg);
            let motion = self.leg_motion(at, leg, &differential, &twists);
            let [rates, accelerations] = match section {
                Section::Lower => motion.lower,
                Section::Upper => motion.upper,
            };
            (found[0][row], found[1][row]) = (rates[joint], accelerations[joint]);
        }
        found
    }

    /// Every leg, as one without rates: where dependent coordinates are not determined, no joint has a rate.
    pub(super) fn all_singular(&self, singular: &mut Vec<SingularLeg>) {
        singular.clear();
        singular.extend(self.legs.iter().enumerate().map(|(leg, compiled)| SingularLeg {
            leg,
            section: compiled.split_section,
            cause: SingularCause::Serial,
        }));
    }
}

/// The determinant of a system of equations, whose unknowns have these units.
pub(super) fn determinant(mut m: Square, units: &[f64]) -> f64 {
    let n = units.len();
    let mut product: f64 = units.iter().product();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs())).unwrap_or(k);
        if m[pivot][k] == 0.0 {
            return 0.0;
        }
        if pivot != k {
            m.swap(k, pivot);
            product = -product;
        }
        let pivot = m[k];
        product *= pivot[k];
        for row in &mut m[k + 1..n] {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    product
}

/// The solution of a system of equations, by elimination with pivoting. `units` are those of the unknowns; there
/// are as many equations. `None` where the system is singular.
pub(super) fn solved(mut m: Square, mut right: [f64; MOST], units: &[f64]) -> Option<[f64; MOST]> {
    let n = units.len();
    for row in m.iter_mut().take(n) {
        row.iter_mut().zip(units).for_each(|(entry, unit)| *entry *= unit);
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs()))?;
        if m[pivot][k].abs() < SINGULAR {
            return None;
        }
        m.swap(k, pivot);
        right.swap(k, pivot);
        let pivot = m[k];
        for i in (0..n).filter(|&i| i != k) {
            let factor = m[i][k] / pivot[k];
            m[i].iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
            right[i] -= factor * right[k];
        }
    }
    Some(std::array::from_fn(|i| if i < n { right[i] / m[i][i] * units[i] } else { 0.0 }))
}
