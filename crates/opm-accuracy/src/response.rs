//! The response of the platform and of the joints to each error, to first order.

use crate::chain::{Chain, at_point, from_point, unit};
use crate::inverse::PseudoInverse;
use crate::source::{ErrorModel, Source, sources};
use nalgebra::{DMatrix, Isometry3, Matrix6, Matrix6xX, Vector6};
use opm_core::group::screw::Screw;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::file::MechanismFile;
use opm_core::velocity::VelocityError;

/// A manipulator with the sources of its errors.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    manipulator: &'a Manipulator,
    file: Option<MechanismFile>,
    errors: ErrorModel,
    length: f64,
    sources: Vec<Source>,
}

/// The closure of the legs at one pose, to first order: with the platform's twist `t`, each leg closes if the rates of its
/// joints and its errors give `t`, too. Six rows for each leg: the rotation, and the displacement of the platform's reference
/// point over the characteristic length, along the axes of the base.
#[derive(Clone, Debug)]
pub struct Closure {
    /// The twists for unit rates of the joint coordinates, a column for each, radians and metres.
    pub joints: DMatrix<f64>,
    /// The twists for units of the errors, a column for each source, radians and metres.
    pub errors: DMatrix<f64>,
    /// Of each leg, the displacement from home of what carries each of its axes; then that of the platform. A universal joint
    /// has two axes.
    pub carried: Vec<Vec<Isometry3<f64>>>,
    /// What takes a twist `(ω; v)` in base coordinates to the rows of a leg.
    pub weight: Matrix6<f64>,
}

/// What a unit of each error does at one pose: one radian or one metre, extrapolated from small errors.
#[derive(Clone, Debug)]
pub struct Response {
    /// The platform's twist: a column for each source. The rotation, radians, and the displacement of the reference point,
    /// metres, along the axes of the base. NaN if the actuators do not hold the platform.
    pub twists: Matrix6xX<f64>,
    /// The change of each task coordinate (rows) for each source (columns), radians and metres. NaN where coordinates are
    /// singular, and if the actuators do not hold the platform.
    pub coordinates: DMatrix<f64>,
    /// What is left of the platform's twist: displacements that the ideal mechanism does not have.
    pub parasitic: Matrix6xX<f64>,
    /// The play of each joint, leg by leg: a twist for each source, with the displacement of the joint's point. Of all plays
    /// with which the legs close, these are the smallest: the sum of the squares of all rotations and of all displacements
    /// over the characteristic length is least.
    pub plays: Vec<Matrix6xX<f64>>,
    /// The number of independent misfits: of closure conditions that no motion of the passive joints fulfils.
    pub overconstraints: usize,
    /// Whether the actuators hold the platform. If not, its error is not bounded.
    pub held: bool,
}

impl<'a> Model<'a> {
    /// The errors of all actuators and axes of a manipulator. With the file that it is of, also those of the dimensions that the
    /// file gives by name ([`MechanismFile::dimensions`]).
    pub fn new(
        manipulator: &'a Manipulator,
        file: Option<&MechanismFile>,
        errors: ErrorModel,
    ) -> Self {
        let sources = sources(manipulator, file, errors);
        let length = manipulator.characteristic_length();
        Self { manipulator, file: file.cloned(), errors, length, sources }
    }

    /// Compares lengths with angles by another characteristic length, metres.
    ///
    /// # Panics
    /// If the length is not a positive number.
    #[must_use]
    pub fn with_length(mut self, length: f64) -> Self {
        assert!(
            length > 0.0 && length.is_finite(),
            "the characteristic length is {length} m, expected a positive number"
        );
        self.length = length;
        self
    }

    /// The sources of errors: actuators, then dimensions of the file, then joint by joint.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// What errors of axes are.
    pub fn error_model(&self) -> ErrorModel {
        self.errors
    }

    /// The characteristic length, metres.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The file, if the errors of its dimensions are known.
    pub(crate) fn file(&self) -> Option<&MechanismFile> {
        self.file.as_ref()
    }

    /// The manipulator.
    pub fn manipulator(&self) -> &'a Manipulator {
        self.manipulator
    }

    /// The closure of the legs at a solved pose.
    pub fn closure(&self, at: &Solution) -> Closure {
        let chains = Chain::all(self.manipulator.mechanism(), at.joints());
        let weight = self.weight(at);
        let mut joints = DMatrix::zeros(6 * chains.len(), self.manipulator.coordinates().len());
        let mut number = 0;
        for (leg, chain) in chains.iter().enumerate() {
            for screw in chain.joints.iter().flat_map(|joint| &joint.screws) {
                let rates = weight * screw.to_vector();
                joints.fixed_view_mut::<6, 1>(6 * leg, number).copy_from(&rates);
                number += 1;
            }
        }
        let errors = self.errors(&chains, at, &weight);
        let carried = chains.into_iter().map(|chain| chain.carried).collect();
        Closure { joints, errors, carried, weight }
    }

    /// What takes twists to the platform's reference point, with lengths over the characteristic length.
    pub(crate) fn weight(&self, at: &Solution) -> Matrix6<f64> {
        let reference = at.displacement(self.manipulator) * self.manipulator.mechanism().platform;
        at_point(&reference, self.length)
    }

    /// The twists of the errors through each leg.
    fn errors(&self, chains: &[Chain], at: &Solution, weight: &Matrix6<f64>) -> DMatrix<f64> {
        let mut errors = DMatrix::zeros(6 * chains.len(), self.sources.len());
        for (column, source) in self.sources.iter().enumerate() {
            let twists = source.twists(self.errors, chains, at.joints());
            for (leg, twist) in twists.iter().enumerate() {
                errors.fixed_view_mut::<6, 1>(6 * leg, column).copy_from(&(weight * twist));
            }
        }
        errors
    }

    /// The responses at a solved pose.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn at(&self, at: &Solution) -> Result<Response, VelocityError> {
        let mut jacobians = self.manipulator.jacobians();
        // Legs without rates do not matter: what is used of them is the motion of the platform.
        self.manipulator.differentiate(at, &mut jacobians)?;
        let by_pose = self.manipulator.twist_by_pose(&jacobians);

        let mechanism = self.manipulator.mechanism();
        let chains = Chain::all(mechanism, at.joints());
        let weight = self.weight(at);
        let errors = self.errors(&chains, at, &weight);
        let moving = PseudoInverse::new(&self.moving(&chains, &weight));
        let play = self.play(&chains, &weight);
        let unmoved = moving.left_null_space();
        let plays = -PseudoInverse::new(&unmoved.tr_mul(&play)).solve(&unmoved.tr_mul(&errors));
        let moved = -moving.solve(&(errors + play * &plays));
        let held = (0..6).all(|component| moving.determines(component));
        let mut twists = moved.fixed_rows::<6>(0).into_owned();
        if !held {
            twists.fill(f64::NAN);
        }
        let (coordinates, parasitic) = self.coordinates(by_pose, &twists);
        let in_metres = |mut twists: Matrix6xX<f64>| {
            twists.rows_mut(3, 3).scale_mut(self.length);
            twists
        };
        let joints = plays.nrows() / 6;
        let of_joint = |joint: usize| in_metres(plays.fixed_rows::<6>(6 * joint).into_owned());
        Ok(Response {
            coordinates,
            parasitic: in_metres(parasitic),
            twists: in_metres(twists),
            plays: (0..joints).map(of_joint).collect(),
            overconstraints: unmoved.ncols(),
            held,
        })
    }

    /// The closure of all legs by what moves: the platform's six velocities, then every passive joint coordinate.
    fn moving(&self, chains: &[Chain], weight: &Matrix6<f64>) -> DMatrix<f64> {
        let coordinates = self.manipulator.coordinates();
        let actuated = self.manipulator.actuated();
        let columns = 6 + coordinates.len() - actuated.len();
        let mut moving = DMatrix::zeros(6 * chains.len(), columns);
        let (mut column, mut number) = (6, 0);
        for (leg, chain) in chains.iter().enumerate() {
            moving.fixed_view_mut::<6, 6>(6 * leg, 0).fill_with_identity();
            moving.fixed_view_mut::<6, 6>(6 * leg, 0).neg_mut();
            for screw in chain.joints.iter().flat_map(|joint| &joint.screws) {
                if !actuated.contains(&number) {
                    let unit = unit(coordinates[number].quantity, self.length);
                    let rates = weight * screw.to_vector() * unit;
                    moving.fixed_view_mut::<6, 1>(6 * leg, column).copy_from(&rates);
                    column += 1;
                }
                number += 1;
            }
        }
        moving
    }

    /// The closure of all legs by the play of every joint, six columns for each.
    fn play(&self, chains: &[Chain], weight: &Matrix6<f64>) -> DMatrix<f64> {
        let joints = chains.iter().map(|chain| chain.joints.len()).sum::<usize>();
        let mut play = DMatrix::zeros(6 * chains.len(), 6 * joints);
        let mut number = 0;
        for (leg, chain) in chains.iter().enumerate() {
            for joint in &chain.joints {
                let across = across(&joint.screws, &at_point(&joint.point, self.length));
                let columns = weight * from_point(&joint.point, self.length) * across;
                play.fixed_view_mut::<6, 6>(6 * leg, 6 * number).copy_from(&columns);
                number += 1;
            }
        }
        play
    }

    /// The changes of the task coordinates that come nearest to twists, and what is left of these. Lengths are over the
    /// characteristic length in twists.
    fn coordinates(
        &self,
        mut by_pose: Matrix6xX<f64>,
        twists: &Matrix6xX<f64>,
    ) -> (DMatrix<f64>, Matrix6xX<f64>) {
        by_pose.rows_mut(3, 3).scale_mut(self.length.recip());
        let coordinates = self.manipulator.task_coordinates();
        for (mut column, c) in by_pose.column_iter_mut().zip(coordinates) {
            column.scale_mut(unit(c.quantity, self.length));
        }
        let mut changes = DMatrix::from_element(coordinates.len(), twists.ncols(), f64::NAN);
        let by_pose = DMatrix::from_fn(6, by_pose.ncols(), |i, j| by_pose[(i, j)]);
        if by_pose.iter().chain(twists).any(|number| number.is_nan()) {
            return (changes, Matrix6xX::from_element(twists.ncols(), f64::NAN));
        }
        let columns = DMatrix::from_fn(6, twists.ncols(), |i, j| twists[(i, j)]);
        let inverse = PseudoInverse::new(&by_pose);
        let found = inverse.solve(&columns);
        let rest = columns - by_pose * &found;
        for (i, c) in coordinates.iter().enumerate().filter(|&(i, _)| inverse.determines(i)) {
            let unit = unit(c.quantity, self.length);
            changes.row_mut(i).copy_from(&(found.row(i) * unit));
        }
        (changes, Matrix6xX::from_fn(twists.ncols(), |i, j| rest[(i, j)]))
    }
}

/// The projection of twists at a joint's point to those that the joint does not allow.
pub(crate) fn across(screws: &[Screw], weight: &Matrix6<f64>) -> Matrix6<f64> {
    /// Below this a screw that is left depends on those before: a cylindrical joint's never do.
    const DEPENDENT: f64 = 1e-9;
    let mut projection = Matrix6::identity();
    for screw in screws {
        let own: Vector6<f64> = weight * screw.to_vector();
        let left = projection * own;
        if left.norm() > DEPENDENT * own.norm() {
            let direction = left.normalize();
            projection -= direction * direction.transpose();
        }
    }
    projection
}
