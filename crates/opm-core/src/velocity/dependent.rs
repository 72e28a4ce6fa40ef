//! The rates of dependent coordinates: those at which no locked joint moves.
//!
//! A section that constrains the platform is completed by locked joints (see
//! [`chain::partial`](crate::chain::partial)). Their rates are linear in those of all task coordinates, and zero.
//! That is one equation for each dependent coordinate. The same holds for accelerations.

use super::{JointMotion, SINGULAR, SingularCause, SingularLeg};
use crate::manipulator::{Dependent, Manipulator, Section, Solution};
use crate::numeric::Quantity;
use nalgebra::{LU, Matrix6, U6, Vector6};

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
            dependent.spread(given, all);
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
        let system = System::new(&matrix, self.dependent_units(), dependent.coordinates.len());
        for part in 0..2 {
            let moved = self.locked_motion(dependent, at, [&all[0][..n], &all[1][..n]])[part];
            let found = system.solve(moved.map(|rate| -rate))?;
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
        if dependent.whole().is_some() {
            return self.held_motion(at, &twists);
        }
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
            section: compiled.named(compiled.split_section),
            cause: SingularCause::Serial,
        }));
    }
}

/// The rates of the locked joints by those of the dependent coordinates, and their units; ready to be solved.
pub(super) struct System {
    lu: LU<f64, U6, U6>,
    units: [f64; MOST],
}

impl System {
    /// `rates` has a row for each locked joint and a column for each dependent coordinate, of which there are
    /// `count`.
    pub fn new(rates: &Square, units: [f64; MOST], count: usize) -> Self {
        let entry = |i: usize, j: usize| match i < count && j < count {
            true => rates[i][j] * units[j],
            false => f64::from(u8::from(i == j)),
        };
        Self { lu: Matrix6::from_fn(entry).lu(), units }
    }

    /// The determinant, dimensionless.
    pub fn determinant(&self) -> f64 {
        self.lu.determinant()
    }

    /// The rates of the dependent coordinates at which the locked joints have these rates. `None` where they are not
    /// determined.
    pub fn solve(&self, rates: [f64; MOST]) -> Option<[f64; MOST]> {
        if self.lu.u().diagonal().iter().any(|pivot| pivot.abs() < SINGULAR) {
            return None;
        }
        let found = self.lu.solve(&Vector6::from(rates))?;
        Some(found.component_mul(&Vector6::from(self.units)).into())
    }
}
