//! The equations of motion in task coordinates, and the accelerations that efforts give: forward dynamics.
//!
//! ```text
//! M(x) ẍ + c(x, ẋ) + g(x) + f(x, ẋ) = Jᵀ τ + w
//! ```
//!
//! with the mass matrix `M`, Coriolis and centrifugal forces `c`, gravity `g`, the friction `f` of joints, the efforts `τ` of the
//! actuators, whose rates are `J ẋ`, and the load `w` on the platform. All of it comes from the inverse dynamics, which is
//! affine in the accelerations: a column of `M` is what a unit acceleration needs of a mechanism without weight that does
//! not move (M. Walker, D. Orin, *Efficient dynamic computer simulation of robotic mechanisms*, J. Dynamic Systems, Measurement
//! and Control 104, 1982, method 1). The virtual work of the inverse dynamics is that for independent velocities of the
//! platform; `E` gives these for rates of the task coordinates, so that the forces are `Eᵀ` times the work.

use crate::efforts::Efforts;
use crate::setup::{Loads, Setup};
use crate::statics::{Statics, Velocity};
use crate::weights::{JointMotion, Part};
use nalgebra::{DMatrix, DVector, Vector6};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::velocity::{self, JointMotion as Buffer, Singularities, VelocityError};

/// A square of a pivot below this share of its diagonal is rounding.
const SINGULAR: f64 = 1e-11;

/// Whether dry friction counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DryFriction {
    Counts,
    LeftOut,
}

/// The dynamics at one pose after the other. Forces are those on the task coordinates: N for lengths, N m for angles.
///
/// ```
/// use nalgebra::DVector;
/// use opm_analysis::{Dynamics, Setup};
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("delta")?;
/// let mut dynamics = Dynamics::new(&manipulator, &Setup::new(1.0));
/// assert!(dynamics.update(&manipulator.solution())?); // home
/// // Motors that hold the mechanism up leave it at rest, and without them it falls.
/// let rest = DVector::zeros(3);
/// let holding = dynamics.inverse(&rest, &rest).expect("efforts");
/// assert!(dynamics.forward(&rest, &holding).expect("accelerations").amax() < 1e-9);
/// let falling = dynamics.forward(&rest, &DVector::zeros(3)).expect("accelerations");
/// assert!(falling[2] < -1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dynamics<'a> {
    manipulator: &'a Manipulator,
    loads: Loads<'a>,
    statics: Statics<'a>,
    at: Solution,
    motion: Buffer,
    /// The independent velocities for rates of the task coordinates; `None` where the pose is singular.
    velocities: Option<DMatrix<f64>>,
    /// What says whether the coordinates are singular.
    measured: Singularities,
    /// The rates of the actuated joints for rates of the task coordinates.
    actuated: DMatrix<f64>,
}

impl<'a> Dynamics<'a> {
    /// The dynamics of a manipulator with the gravity of a setup ([`Gravity::default`](crate::Gravity) if it has none) and its load.
    pub fn new(manipulator: &'a Manipulator, setup: &Setup) -> Self {
        let setup = setup.heavy();
        let (count, actuated) =
            (manipulator.task_coordinates().len(), manipulator.actuated().len());
        Self {
            manipulator,
            loads: Loads::of(manipulator, &setup),
            statics: Statics::new(manipulator, setup.length),
            at: manipulator.solution(),
            motion: manipulator.joint_motion(),
            velocities: None,
            measured: manipulator.singularities(),
            actuated: DMatrix::zeros(actuated, count),
        }
    }

    /// The number of task coordinates.
    pub fn freedoms(&self) -> usize {
        self.actuated.ncols()
    }

    /// Takes a solved pose. Returns `false` at a serial singularity, and where dependent coordinates do not follow from the
    /// others: then nothing is known.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn update(&mut self, at: &Solution) -> Result<bool, VelocityError> {
        self.velocities = None;
        self.at.clone_from(at);
        if !self.statics.update(at)? {
            return Ok(false);
        }
        let statics = &self.statics;
        let by_pose = self.manipulator.twist_by_pose(&statics.jacobians);
        let joints = statics.jacobians.joints_by_pose();
        if by_pose.iter().chain(&joints).any(|entry| !entry.is_finite()) {
            return Ok(false);
        }
        self.manipulator.measure_singularities(&statics.jacobians, &mut self.measured);
        self.actuated = joints.select_rows(self.manipulator.actuated());
        let length = statics.length();
        self.velocities = Some(DMatrix::from_fn(statics.free, by_pose.ncols(), |k, j| {
            let t = by_pose.column(j);
            let l = length.recip();
            let twist = Vector6::new(t[0], t[1], t[2], t[3] * l, t[4] * l, t[5] * l);
            statics.twists.column(k).dot(&twist)
        }));
        Ok(true)
    }

    /// The rates of the actuated joints for unit rates of the task coordinates at the pose: a row for each joint.
    pub fn actuated_by_pose(&self) -> &DMatrix<f64> {
        &self.actuated
    }

    /// The mass matrix, symmetric; kg, kg m and kg m². `None` at a singular pose. It is singular where the coordinates are (an
    /// Euler angle at 0).
    pub fn mass_matrix(&mut self) -> Option<DMatrix<f64>> {
        let n = self.freedoms();
        let (rest, mut unit) = (DVector::zeros(n), DVector::zeros(n));
        let mut columns = Vec::with_capacity(n);
        for j in 0..n {
            unit[j] = 1.0;
            columns.push(self.part(&rest, &unit, Part::Inertia)?);
            unit[j] = 0.0;
        }
        Some(DMatrix::from_columns(&columns))
    }

    /// Coriolis and centrifugal forces for rates of the task coordinates. `None` at a singular pose.
    pub fn bias(&mut self, rates: &DVector<f64>) -> Option<DVector<f64>> {
        self.part(rates, &DVector::zeros(rates.len()), Part::Inertia)
    }

    /// What the weight of all bodies needs. `None` at a singular pose.
    pub fn gravity(&mut self) -> Option<DVector<f64>> {
        let rest = DVector::zeros(self.freedoms());
        self.part(&rest, &rest, Part::Weight)
    }

    /// What the friction of joints needs, for rates of the task coordinates. A joint at rest has none. `None` at a singular pose.
    pub fn friction(&mut self, rates: &DVector<f64>) -> Option<DVector<f64>> {
        let rest = DVector::zeros(rates.len());
        Some(self.part(rates, &rest, Part::Viscous)? + self.part(rates, &rest, Part::Coulomb)?)
    }

    /// The efforts of the actuators for rates and accelerations of the task coordinates. `None` where one is not determined: at
    /// singular poses, and with redundant actuators.
    pub fn inverse(
        &mut self,
        rates: &DVector<f64>,
        accelerations: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let found = self.efforts(rates, accelerations);
        found.actuated.into_iter().collect::<Option<Vec<f64>>>().map(DVector::from_vec)
    }

    /// The same, with what is known of every joint.
    pub fn efforts(&mut self, rates: &DVector<f64>, accelerations: &DVector<f64>) -> Efforts {
        match self.work(rates, accelerations, Part::All) {
            Some(work) => self.statics.efforts_for(&work),
            None => Efforts::singular(self.manipulator),
        }
    }

    /// The accelerations of the task coordinates for efforts of the actuators and rates. `None` at a singular pose, and where
    /// the coordinates are singular. Friction that holds a joint at rest is not considered.
    pub fn forward(
        &mut self,
        rates: &DVector<f64>,
        efforts: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        self.forward_with(rates, efforts, DryFriction::Counts)
    }

    /// The same with dry friction, or without.
    pub(crate) fn forward_with(
        &mut self,
        rates: &DVector<f64>,
        efforts: &DVector<f64>,
        dry: DryFriction,
    ) -> Option<DVector<f64>> {
        if self.measured.coordinates.abs() < velocity::SINGULAR {
            return None;
        }
        let rest = DVector::zeros(rates.len());
        let work = self.work(rates, &rest, Part::All)?;
        let mut missing = self.actuated.tr_mul(efforts) + self.on_coordinates(&work)?;
        if dry == DryFriction::LeftOut {
            missing += self.part(rates, &rest, Part::Coulomb)?;
        }
        solve(&self.mass_matrix()?, &missing)
    }

    /// The manipulator.
    pub fn manipulator(&self) -> &'a Manipulator {
        self.manipulator
    }

    /// What a task coordinate is compared by: the characteristic length, or a radian.
    pub(crate) fn units(&self) -> Vec<f64> {
        let length = self.statics.length();
        let of = |quantity| if quantity == Quantity::Length { length } else { 1.0 };
        self.manipulator.task_coordinates().iter().map(|c| of(c.quantity)).collect()
    }

    /// One part of the forces that a motion needs on the task coordinates.
    fn part(
        &mut self,
        rates: &DVector<f64>,
        accelerations: &DVector<f64>,
        part: Part,
    ) -> Option<DVector<f64>> {
        let work = self.work(rates, accelerations, part)?;
        // Not -0.
        Some(self.on_coordinates(&work)?.map(|force| 0.0 - force))
    }

    /// The forces on the task coordinates that do this work.
    fn on_coordinates(&self, work: &Velocity) -> Option<DVector<f64>> {
        let velocities = self.velocities.as_ref()?;
        let work = DVector::from_column_slice(&work[..velocities.nrows()]);
        Some(velocities.tr_mul(&work))
    }

    /// The work of what acts in a motion, or of one part, for each independent velocity.
    fn work(
        &mut self,
        rates: &DVector<f64>,
        accelerations: &DVector<f64>,
        part: Part,
    ) -> Option<Velocity> {
        self.velocities.as_ref()?;
        let Self { manipulator, loads, statics, at, motion, .. } = self;
        let (rates, accelerations) = (rates.as_slice(), accelerations.as_slice());
        if !manipulator.velocity(at, rates, accelerations, motion).ok()? {
            return None;
        }
        let motion =
            JointMotion { rates: &motion.joint_rates, accelerations: &motion.joint_accelerations };
        match part {
            Part::All => loads.work_in(statics, at, Some(motion)),
            part => loads.work_of(statics, at, Some(motion), part),
        }
    }
}

/// The solution of a symmetric system whose rows have units of their own; `None` if it is singular.
fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let unit = matrix.diagonal().map(|entry| entry.sqrt().recip());
    let scaled =
        DMatrix::from_fn(unit.len(), unit.len(), |i, j| matrix[(i, j)] * unit[i] * unit[j]);
    let decomposed = scaled.cholesky()?;
    let least = decomposed.l_dirty().diagonal().min();
    let found = decomposed.solve(&right.component_mul(&unit)).component_mul(&unit);
    (least * least > SINGULAR && found.iter().all(|entry| entry.is_finite())).then_some(found)
}
