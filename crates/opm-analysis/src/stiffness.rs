//! Stiffness, and the reactions in the legs of an overconstrained mechanism.
//!
//! Statics alone do not tell how an overconstrained mechanism shares a load among its legs: that depends on how much each
//! of them gives way. The *virtual joint method* (A. Pashkevich, D. Chablat, P. Wenger, *Stiffness analysis of
//! overconstrained parallel manipulators*, Mechanism and Machine Theory 44 (2009), arXiv 0904.0052, eqs. 11-17) puts
//! springs beside the joints of a leg: one in each actuator, and one with six freedoms in each link. The platform is rigid. With the compliance
//! `C = Jθ Kθ⁻¹ Jθᵀ` of all springs of a leg at the platform, and the screws `Jq` of its passive joints, which carry
//! nothing,
//!
//! ```text
//! | C    Jq | | F  |   | δt |
//! | Jqᵀ  0  | | δq | = | 0  |      so that F = K δt, K = C⁻¹ − C⁻¹ Jq (Jqᵀ C⁻¹ Jq)⁻¹ Jqᵀ C⁻¹
//! ```
//!
//! is the load `F` on the leg for a small displacement `δt` of the platform. The stiffness of the platform is the sum over
//! the legs. A load `W` displaces it by `δt = (Σ K)⁻¹ W`, and each leg carries its own `K δt`.

use crate::screws::Screws;
use crate::wrench::Wrench;
use nalgebra::{Cholesky, DMatrix, Matrix6, Point3, U6, Vector3, Vector6};
use opm_core::manipulator::{Manipulator, Solution};

/// A pivot below this share of the largest is rounding.
const SINGULAR: f64 = 1e-11;

/// How much a mechanism gives way. The passive joints do not resist along their freedoms, and nothing else gives way.
#[derive(Clone, Debug, PartialEq)]
pub struct Springs {
    /// The stiffness of each actuated coordinate, in the order of
    /// [`Manipulator::actuated`](opm_core::Manipulator::actuated); N/m and N m/rad, infinite for a rigid one.
    pub actuators: Vec<f64>,
    /// The stiffness of each link of a leg against translations of its end at the next joint, N/m.
    pub translation: f64,
    /// The stiffness of each link of a leg against rotations of that end, N m/rad.
    pub rotation: f64,
}

/// Why springs do not suit a manipulator.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpringError {
    /// The number of stiffnesses is not that of the actuated coordinates.
    #[error(
        "{given} stiffnesses of actuators, expected {expected}, one for each actuated coordinate"
    )]
    Count {
        /// The number that was given.
        given: usize,
        /// The number of actuated coordinates.
        expected: usize,
    },
    /// A stiffness is not a positive number.
    #[error("a stiffness is {0}, expected a positive number")]
    NotPositive(f64),
    /// A name is not that of an actuated joint.
    #[error("no actuated joint {name:?}, expected one of {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// The names of the actuated joints.
        known: Vec<String>,
    },
}

/// How a mechanism gives way at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Stiffness {
    /// The stiffness of the platform: the wrench `FX FY FZ MX MY MZ` at its reference point for unit translations along x,
    /// y and z and unit rotations about these axes, base directions; N/m, N/rad, N m/m and N m/rad. Symmetric.
    pub platform: Matrix6<f64>,
    /// The same of each leg; their sum is that of the platform.
    pub legs: Vec<Matrix6<f64>>,
}

/// How a load is shared at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Reactions {
    /// The displacement of the platform's reference point, metres, and its rotation vector, radians; base directions.
    pub displacement: Vector6<f64>,
    /// What each leg carries, as a wrench on the leg at the platform's reference point.
    pub legs: Vec<Wrench>,
    /// What passes through each joint, leg by leg from the base on: the same load as a wrench at the joint's point, on its
    /// side of the base.
    pub joints: Vec<Wrench>,
    /// The effort of every actuated coordinate; N and N m. Where statics determine it, it does not depend on the springs.
    pub efforts: Vec<f64>,
}

impl Springs {
    /// The springs of links against translations, N/m, and rotations, N m/rad, and of actuated joints by their names; those
    /// that are not among them are rigid.
    ///
    /// # Errors
    /// A name is unknown, or a stiffness is not positive.
    pub fn new(
        manipulator: &Manipulator,
        [translation, rotation]: [f64; 2],
        actuators: &[(String, f64)],
    ) -> Result<Self, SpringError> {
        let names = Self::names(manipulator);
        let mut each = vec![f64::INFINITY; names.len()];
        for (name, stiffness) in actuators {
            let Some(place) = names.iter().position(|known| known == name) else {
                let known = names.iter().map(|&name| name.to_owned()).collect();
                return Err(SpringError::Unknown { name: name.clone(), known });
            };
            each[place] = *stiffness;
        }
        let springs = Self { actuators: each, translation, rotation };
        springs.check(manipulator).map(|()| springs)
    }

    /// The names of the actuated joints, in the order of [`Springs::actuators`].
    pub fn names(manipulator: &Manipulator) -> Vec<&str> {
        let all = manipulator.coordinates();
        manipulator.actuated().iter().map(|&number| &*all[number].name).collect()
    }

    /// Checks that there is a positive stiffness for each actuated coordinate of a manipulator, and for the links.
    ///
    /// # Errors
    /// Which one is wrong.
    pub fn check(&self, manipulator: &Manipulator) -> Result<(), SpringError> {
        let (given, expected) = (self.actuators.len(), manipulator.actuated().len());
        if given != expected {
            return Err(SpringError::Count { given, expected });
        }
        let links = [self.translation, self.rotation];
        match self.actuators.iter().chain(&links).find(|k| k.is_nan() || **k <= 0.0) {
            Some(&odd) => Err(SpringError::NotPositive(odd)),
            None => match links.into_iter().find(|k| k.is_infinite()) {
                Some(odd) => Err(SpringError::NotPositive(odd)),
                None => Ok(()),
            },
        }
    }
}

/// Computes stiffnesses at solved poses of one manipulator.
///
/// ```
/// use opm_analysis::{Compliant, Springs, Wrench};
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let springs = Springs { actuators: vec![1e6; 5], translation: 1e7, rotation: 1e4 };
/// let mut compliant = Compliant::new(&manipulator, springs)?;
/// let (mut buffer, home) = (manipulator.solution(), manipulator.home_pose());
/// let at = manipulator.inverse(&home, manipulator.home_mode(), &mut buffer)?;
/// let at = at.expect("home is in reach");
/// let stiffness = compliant.stiffness(at).expect("a regular pose");
/// // A vertical load, which the actuators do not carry: the legs share it.
/// let load = Wrench::from_components([0.0, 0.0, -100.0, 0.0, 0.0, 0.0]);
/// let reactions = compliant.reactions(&stiffness, &load).expect("a regular pose");
/// let carried: f64 = reactions.legs.iter().map(|leg| leg.force.z).sum();
/// assert!((carried + 100.0).abs() < 1e-6 && reactions.displacement[2] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Compliant<'a> {
    manipulator: &'a Manipulator,
    springs: Springs,
    screws: Screws,
    /// The platform's reference point.
    reference: Point3<f64>,
    /// The unit of length, in which all numbers of a matrix are comparable.
    length: f64,
}

impl<'a> Compliant<'a> {
    /// For a manipulator with these springs.
    ///
    /// # Errors
    /// A stiffness is wrong.
    pub fn new(manipulator: &'a Manipulator, springs: Springs) -> Result<Self, SpringError> {
        springs.check(manipulator)?;
        Ok(Self {
            manipulator,
            springs,
            screws: Screws::new(manipulator),
            reference: manipulator.mechanism().platform,
            length: manipulator.characteristic_length(),
        })
    }

    /// The stiffness at a solved pose that is in reach. `None` where the passive joints of a leg are dependent, as at some
    /// serial singularities, and where a leg has no link: a single joint between base and platform.
    pub fn stiffness(&mut self, at: &Solution) -> Option<Stiffness> {
        self.screws.update(at);
        let platform = self.manipulator.platform_at(&at.displacement(self.manipulator));
        self.reference = Point3::from(platform.translation.vector);
        let count = self.screws.legs.len();
        let legs: Vec<Matrix6<f64>> = (0..count).map(|leg| self.leg(leg)).collect::<Option<_>>()?;
        Some(Stiffness { platform: legs.iter().sum(), legs })
    }

    /// The least stiffness against a force, N/m, and against a moment, N m/rad, of the platform at the pose of a stiffness: a
    /// force in the worst direction displaces the reference point by one over the first along that direction, a moment about
    /// the worst axis turns the platform by one over the second about it. Both are zero where it can move without resistance.
    pub fn least(&self, stiffness: &Stiffness) -> [f64; 2] {
        let unit = self.unit();
        let scaled = unit * stiffness.platform * unit;
        let Some(compliance) = inverse(&scaled) else { return [0.0; 2] };
        let compliance = unit * compliance * unit;
        [0, 3].map(|first| {
            let block = compliance.fixed_view::<3, 3>(first, first).into_owned();
            block.symmetric_eigenvalues().max().recip()
        })
    }

    /// How a load is shared at the pose of a stiffness, which is the last that was computed. `None` where the platform can
    /// move without resistance.
    pub fn reactions(&self, stiffness: &Stiffness, load: &Wrench) -> Option<Reactions> {
        let unit = self.unit();
        let scaled = unit * stiffness.platform * unit;
        let load = Vector6::from(load.components());
        let displacement = unit * solve(&scaled, &(unit * load))?;
        let legs: Vec<Wrench> = (stiffness.legs.iter())
            .map(|leg| Wrench::from_components((leg * displacement).into()))
            .collect();
        let leg_of = |number: usize| self.screws.legs.iter().position(|l| l.contains(&number));
        let actuated = self.manipulator.actuated().iter();
        let efforts = actuated.map(|&number| {
            let own = leg_of(number).map(|leg| Vector6::from(legs[leg].components()));
            0.0 - own.unwrap_or_default().dot(&self.twist(number))
        });
        let efforts = efforts.collect();
        let mut joints = Vec::new();
        for ((leg, own), wrench) in
            self.manipulator.mechanism().legs.iter().zip(&self.screws.legs).zip(&legs)
        {
            let mut number = own.start;
            for joint in &leg.joints {
                joints.push(wrench.moved(&self.reference, &self.screws.freedoms[number].point));
                number += joint.coordinates.len();
            }
        }
        Some(Reactions { displacement, legs, joints, efforts })
    }

    /// What lengths are multiplied by: rotations of one radian, and translations of the characteristic length, are
    /// comparable.
    fn unit(&self) -> Matrix6<f64> {
        let l = self.length;
        Matrix6::from_diagonal(&Vector6::new(l, l, l, 1.0, 1.0, 1.0))
    }

    /// The translation of the reference point and the rotation of the platform for a unit rate of a freedom.
    fn twist(&self, number: usize) -> Vector6<f64> {
        let screw = &self.screws.freedoms[number].screw;
        let linear = screw.linear + screw.angular.cross(&self.reference.coords);
        let angular = screw.angular;
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }

    /// The stiffness of a leg.
    fn leg(&self, leg: usize) -> Option<Matrix6<f64>> {
        let own = self.screws.legs[leg].clone();
        let mut compliance = Matrix6::zeros();
        let mut spring = |twist: &Vector6<f64>, stiffness: f64| {
            compliance += twist * twist.transpose() / stiffness;
        };
        let actuated = self.manipulator.actuated();
        let mut passive = Vec::new();
        for number in own.clone() {
            match actuated.iter().position(|&coordinate| coordinate == number) {
                Some(actuator) => spring(&self.twist(number), self.springs.actuators[actuator]),
                None => passive.push(number),
            }
        }
        for end in self.link_ends(leg, own) {
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                let translation = Vector6::new(axis.x, axis.y, axis.z, 0.0, 0.0, 0.0);
                spring(&translation, self.springs.translation);
                let moved = axis.cross(&(self.reference - end));
                let rotation = Vector6::new(moved.x, moved.y, moved.z, axis.x, axis.y, axis.z);
                spring(&rotation, self.springs.rotation);
            }
        }
        let unit = self.unit();
        let back = unit.map(|part| if part == 0.0 { 0.0 } else { part.recip() });
        let inverse = (back * compliance * back).cholesky()?.inverse();
        let columns: Vec<Vector6<f64>> =
            passive.iter().map(|&number| (back * self.twist(number)).normalize()).collect();
        let stiffness = match columns.is_empty() {
            true => inverse,
            false => {
                let q = DMatrix::from_fn(6, columns.len(), |i, j| columns[j][i]);
                let cq = inverse * &q;
                let square = regular_inverse(q.transpose() * &cq)?;
                let lost = &cq * square * cq.transpose();
                Matrix6::from_fn(|i, j| inverse[(i, j)] - lost[(i, j)])
            }
        };
        Some(back * stiffness * back)
    }

    /// The ends of a leg's links that give way: each at the next joint.
    fn link_ends(
        &self,
        leg: usize,
        own: std::ops::Range<usize>,
    ) -> impl Iterator<Item = Point3<f64>> + '_ {
        let joints = &self.manipulator.mechanism().legs[leg].joints;
        let mut first = own.start;
        let points = joints.iter().map(move |joint| {
            let at = self.screws.freedoms[first].point;
            first += joint.coordinates.len();
            at
        });
        // The first joint is on the base, and the last one carries the platform.
        points.skip(1)
    }
}

/// The inverse of a symmetric matrix; `None` if it is singular.
fn regular_inverse(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let largest = matrix.diagonal().amax();
    let decomposed = matrix.cholesky()?;
    let least = decomposed.l_dirty().diagonal().iter().copied().fold(f64::INFINITY, f64::min);
    (least * least > SINGULAR * largest).then(|| decomposed.inverse())
}

/// The solution of a symmetric system; `None` if it is singular.
fn solve(matrix: &Matrix6<f64>, right: &Vector6<f64>) -> Option<Vector6<f64>> {
    decomposed(matrix).map(|decomposed| decomposed.solve(right))
}

/// The inverse of a symmetric matrix; `None` if it is singular.
fn inverse(matrix: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    decomposed(matrix).map(|decomposed| decomposed.inverse())
}

fn decomposed(matrix: &Matrix6<f64>) -> Option<Cholesky<f64, U6>> {
    let largest = matrix.diagonal().amax();
    let decomposed = matrix.cholesky()?;
    let least = decomposed.l_dirty().diagonal().iter().copied().fold(f64::INFINITY, f64::min);
    (least * least > SINGULAR * largest).then_some(decomposed)
}
