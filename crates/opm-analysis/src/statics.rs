//! The virtual work of a pose, in numbers without units.
//!
//! At a pose the platform moves with `f` independent velocities `z`. The Jacobians of both sections
//! ([`Jacobians`]) give the platform's twist `V = B z` and the rates of the actuated joints `q̇ = G z`. A mechanism
//! whose joints have no friction is at rest under a load if the load and the actuators do no work together, whatever
//! the velocity (principle of virtual work):
//!
//! ```text
//! Σ τᵢ q̇ᵢ + F · v + M · ω = 0  for all z,   so   Gᵀ τ = −Bᵀ W
//! ```
//!
//! Velocities of the reference point and rates of sliders are divided by the characteristic length, and the columns of
//! `B` are orthonormal. Then the singular values of `G` are those of which the
//! [condition number](opm_core::velocity::Conditioning) is the quotient, and what they decide does not depend on units.
//! A singular value that is zero is a motion that the actuators do not hold. More actuators than nonzero singular values
//! leave internal efforts, which no load determines.

use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::numeric::svd::orthogonalise;
use opm_core::velocity::{Jacobians, SINGULAR, SingularCause, SingularLeg, VelocityError};

/// The largest number of independent velocities of the platform.
pub(crate) const MOST: usize = 6;

/// Independent velocities, or the work that a load does for each of them; those beyond the last are zero.
pub type Velocity = [f64; MOST];

/// The virtual work at one pose. The buffer is filled by [`Statics::update`], which allocates nothing.
#[derive(Clone, Debug)]
pub struct Statics<'a> {
    manipulator: &'a Manipulator,
    /// The characteristic length, metres.
    length: f64,
    pub(crate) jacobians: Jacobians,
    /// The section twist of each velocity: a column for each.
    sections: DMatrix<f64>,
    /// The platform's twist `(ω; v / length)` of each velocity, base directions: orthonormal columns.
    pub(crate) twists: Matrix6xX<f64>,
    /// The number of velocities: the columns that are used.
    pub(crate) free: usize,
    /// The rates of the actuated joints for each velocity, those of sliders over the length.
    pub(crate) rates: DMatrix<f64>,
    /// The velocities that are the right singular vectors of the rates.
    pub(crate) right: DMatrix<f64>,
    /// What the rates are for these.
    pub(crate) image: DMatrix<f64>,
    /// The singular values; only the first `free` count.
    values: Velocity,
    /// Working memory: the rates of locked joints, and the columns before these are locked.
    locked: DMatrix<f64>,
    unlocked: (DMatrix<f64>, DMatrix<f64>, Matrix6xX<f64>),
    regular: bool,
}

impl<'a> Statics<'a> {
    /// A buffer for poses of a manipulator. The characteristic `length`, metres, is usually
    /// [`Manipulator::characteristic_length`].
    ///
    /// # Panics
    /// If the length is not a positive number.
    pub fn new(manipulator: &'a Manipulator, length: f64) -> Self {
        assert!(
            length > 0.0 && length.is_finite(),
            "the characteristic length is {length} m, expected a positive number"
        );
        let jacobians = manipulator.jacobians();
        let (n, actuated) = (jacobians.platform.ncols(), manipulator.actuated().len());
        let square = || DMatrix::zeros(n, n);
        Self {
            manipulator,
            length,
            sections: square(),
            twists: Matrix6xX::zeros(n),
            free: n,
            rates: DMatrix::zeros(actuated, n),
            right: square(),
            image: DMatrix::zeros(actuated, n),
            values: [0.0; MOST],
            locked: DMatrix::zeros(jacobians.locked.nrows(), n),
            unlocked: (square(), square(), Matrix6xX::zeros(n)),
            regular: false,
            jacobians,
        }
    }

    /// The manipulator.
    pub fn manipulator(&self) -> &'a Manipulator {
        self.manipulator
    }

    /// The characteristic length, metres.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Takes a solved pose. Returns `false` at a serial singularity, where joints have no rates: then nothing is known of
    /// efforts, and [`Statics::singular`] lists the legs.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn update(&mut self, at: &Solution) -> Result<bool, VelocityError> {
        self.regular = false;
        self.manipulator.differentiate(at, &mut self.jacobians)?;
        // The rotation vector of a spherical joint is singular after a full revolution, which does not matter unless the
        // joint is actuated.
        let actuated = self.manipulator.actuated();
        let serial = |singular: &SingularLeg| {
            singular.cause == SingularCause::Serial
                || self.manipulator.rateless(singular).any(|c| actuated.contains(&c))
        };
        if self.jacobians.singular.iter().any(serial) {
            return Ok(false);
        }
        self.orthonormal_twists(at);
        self.lock();
        self.actuated_rates();
        self.regular = true;
        Ok(true)
    }

    /// The legs with joints that have no rates at the pose.
    pub fn singular(&self) -> &[SingularLeg] {
        &self.jacobians.singular
    }

    /// Whether joints have rates at the pose, so that efforts are known.
    pub fn is_regular(&self) -> bool {
        self.regular
    }

    /// Whether the singular value of a velocity is not zero, so that the actuators hold it.
    pub(crate) fn holds(&self, k: usize) -> bool {
        let largest = self.values[..self.free].iter().copied().fold(0.0, f64::max);
        // Where no actuator moves at all, rounding is the largest.
        self.values[k] > SINGULAR * largest.max(SINGULAR)
    }

    /// The number of independent motions of the platform that the actuators do not hold: zero, but at parallel singularities
    /// and with fewer actuators than degrees of freedom.
    pub fn loose(&self) -> usize {
        (0..self.free).filter(|&k| !self.holds(k)).count()
    }

    /// The number of independent internal efforts, with which actuators work against each other: zero without redundant
    /// actuators.
    pub fn internal(&self) -> usize {
        self.manipulator.actuated().len() + self.loose() - self.free
    }

    /// The squares of singular values and their velocities that the actuators hold.
    pub(crate) fn held(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..self.free).filter(|&k| self.holds(k)).map(|k| (k, self.values[k] * self.values[k]))
    }

    /// The unit of an effort, of which those that are computed here are multiples: one newton metre over one radian, or over
    /// the characteristic length.
    pub(crate) fn effort_unit(&self, actuated: usize) -> f64 {
        match self.manipulator.coordinates()[self.manipulator.actuated()[actuated]].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => self.length.recip(),
        }
    }

    /// The rates of all joint coordinates for a velocity.
    pub(crate) fn joint_rate(&self, coordinate: usize, velocity: usize) -> f64 {
        let joints = &self.jacobians.joints;
        (0..joints.ncols()).map(|i| joints[(coordinate, i)] * self.sections[(i, velocity)]).sum()
    }

    /// Makes the platform's twists orthonormal (Gram and Schmidt, twice), and the section twists with them.
    fn orthonormal_twists(&mut self, at: &Solution) {
        let axes = at.lower_displacement(self.manipulator).rotation;
        let n = self.jacobians.platform.ncols();
        let (sections, _, twists) = &mut self.unlocked;
        sections.fill_with_identity();
        for i in 0..n {
            let column = self.jacobians.platform.column(i);
            let [angular, linear] =
                [0, 3].map(|k| axes * Vector3::new(column[k], column[k + 1], column[k + 2]));
            let linear = linear / self.length;
            let mut twist =
                Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z);
            for k in (0..i).chain(0..i) {
                let along = twists.column(k).dot(&twist);
                twist -= twists.column(k) * along;
                for row in 0..n {
                    sections[(row, i)] -= along * sections[(row, k)];
                }
            }
            let norm = twist.norm();
            twists.set_column(i, &(twist / norm));
            sections.column_mut(i).scale_mut(norm.recip());
        }
    }

    /// Keeps the velocities at which locked joints do not move.
    fn lock(&mut self) {
        let (sections, right, twists) = &mut self.unlocked;
        let n = sections.ncols();
        if self.locked.nrows() == 0 {
            self.sections.copy_from(sections);
            self.twists.copy_from(twists);
            self.free = n;
            return;
        }
        self.jacobians.locked.mul_to(sections, &mut self.locked);
        // A row has the unit of its joint.
        for mut row in self.locked.row_iter_mut() {
            let norm = row.norm();
            if norm > 0.0 {
                row /= norm;
            }
        }
        right.fill_with_identity();
        orthogonalise(&mut self.locked, Some(right));
        self.sections.fill(0.0);
        self.twists.fill(0.0);
        self.free = 0;
        for column in 0..n {
            if self.locked.column(column).norm() > SINGULAR {
                continue;
            }
            let direction = right.column(column);
            self.sections.column_mut(self.free).gemv(1.0, sections, &direction, 0.0);
            self.twists.column_mut(self.free).gemv(1.0, twists, &direction, 0.0);
            self.free += 1;
        }
    }

    /// Computes the rates of the actuated joints, and their singular values.
    fn actuated_rates(&mut self) {
        let actuated = self.manipulator.actuated();
        for (row, &coordinate) in actuated.iter().enumerate() {
            let unit = self.effort_unit(row);
            for k in 0..self.rates.ncols() {
                let rate = if k < self.free { self.joint_rate(coordinate, k) } else { 0.0 };
                self.rates[(row, k)] = rate * unit;
            }
        }
        self.image.copy_from(&self.rates);
        self.right.fill_with_identity();
        orthogonalise(&mut self.image, Some(&mut self.right));
        for k in 0..self.rates.ncols() {
            self.values[k] = self.image.column(k).norm();
        }
    }
}
