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
//!
//! The weights of links act on springs and joints of their leg that are nearer to the base. With the wrench `w` of all that
//! is behind a spring or a joint, each at the reference point of the platform, springs give way by `d = Σ Jθ Kθ⁻¹ Jθᵀ w`, and
//! passive joints carry `p = Jqᵀ w` that the platform has to balance. The second row is then `Jqᵀ F = −p`, so that
//!
//! ```text
//! F = K δt + F₀,    F₀ = −K d − C⁻¹ Jq (Jqᵀ C⁻¹ Jq)⁻¹ p
//! ```
//!
//! and `δt = (Σ K)⁻¹ (W − Σ F₀)`. A link's centre of mass is on its rigid part, in front of the spring at its end.
//!
//! In a motion, `-m a` and `-I α - ω × I ω` act beside the weights (d'Alembert), and rotors and friction of a joint need an effort `r` along
//! it: its spring gives way by that less, and a passive joint carries `p - r`.

use crate::screws::Screws;
use crate::springs::{SpringError, Springs};
use crate::weights::{Acting, Gravity, JointMotion, Weights};
use crate::wrench::Wrench;
use nalgebra::{Cholesky, DMatrix, DVector, Isometry3, Matrix6, Point3, U6, Vector3, Vector6};
use opm_core::manipulator::{Manipulator, Solution};
use std::ops::Range;

/// A pivot below this share of the largest is rounding.
const SINGULAR: f64 = 1e-11;

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
    /// What the platform does to each leg, as a wrench at the platform's reference point: what the leg carries besides its own
    /// weight.
    pub legs: Vec<Wrench>,
    /// What passes through each joint, leg by leg from the base on: that load, and the weight (in a motion also what resists the
    /// acceleration) of the leg's links behind the joint, as a wrench at the joint's point on its side of the base.
    pub joints: Vec<Wrench>,
    /// The effort of every actuated coordinate; N and N m. Where statics determine it, it does not depend on the springs.
    pub efforts: Vec<f64>,
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
    pub(crate) manipulator: &'a Manipulator,
    springs: Springs,
    pub(crate) weights: Option<Weights<'a>>,
    pub(crate) screws: Screws,
    /// The platform's displacement from home.
    pub(crate) displacement: Isometry3<f64>,
    /// The platform's reference point.
    pub(crate) reference: Point3<f64>,
    /// The weights of links at the pose, at the reference point, and the coordinates that move each.
    heavy: Vec<(Range<usize>, Vector6<f64>)>,
    /// The platform's own weight, at the reference point.
    platform: Vector6<f64>,
    /// What rotors and friction of each freedom need; nothing at rest.
    resisting: Vec<f64>,
    /// What the platform does to each leg under the leg's own weight, if the platform is held.
    held: Vec<Vector6<f64>>,
    /// The unit of length, in which all numbers of a matrix are comparable.
    length: f64,
}

/// A spring of a leg.
struct Spring {
    /// The first joint coordinate that moves what is behind it.
    behind: usize,
    /// What its displacement moves, as [`Compliant::twist`].
    twist: Vector6<f64>,
    /// N/m or N m/rad.
    stiffness: f64,
    of: Sprung,
}

/// What gives way.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sprung {
    Actuator,
    Link,
}

/// How a leg moves for displacements of the platform.
pub(crate) struct LegRates {
    /// For each spring and each passive joint: the first joint coordinate behind it, and by what it displaces what is behind.
    pub each: Vec<(usize, Matrix6<f64>)>,
    /// The rates of joint coordinates.
    pub drives: Vec<(usize, Vector6<f64>)>,
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
            weights: None,
            screws: Screws::new(manipulator),
            displacement: Isometry3::identity(),
            reference: manipulator.mechanism().platform,
            heavy: Vec::new(),
            platform: Vector6::zeros(),
            resisting: Vec::new(),
            held: Vec::new(),
            length: manipulator.characteristic_length(),
        })
    }

    /// The same with heavy links and a heavy platform: their weights are part of every load.
    #[must_use]
    pub fn with_gravity(self, gravity: &Gravity) -> Self {
        Self { weights: Some(Weights::new(self.manipulator, gravity)), ..self }
    }

    /// The stiffness at a solved pose that is in reach. `None` where the passive joints of a leg are dependent, as at some
    /// serial singularities, and where a leg has no link: a single joint between base and platform.
    pub fn stiffness(&mut self, at: &Solution) -> Option<Stiffness> {
        self.stiffness_in(at, None)
    }

    /// The same in a motion: with heavy bodies ([`Compliant::with_gravity`]), [`Compliant::reactions`] then has what resists their
    /// accelerations, rotors, and the friction of joints, too. Springs are at rest: they do not swing.
    pub fn stiffness_in(
        &mut self,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
    ) -> Option<Stiffness> {
        self.screws.update(at);
        self.displacement = at.displacement(self.manipulator);
        let platform = self.manipulator.platform_at(&self.displacement);
        self.reference = Point3::from(platform.translation.vector);
        let reference = self.reference;
        let at_reference = |[force, moment]: Acting, point: &Point3<f64>| {
            Vector6::from(Wrench { force, moment }.moved(point, &reference).components())
        };
        if let Some(weights) = &mut self.weights {
            let (acting, point) = weights.act_at(at, motion);
            self.platform = at_reference(acting, &point);
            let links = weights.on_links();
            self.heavy =
                links.map(|(own, acting, point)| (own, at_reference(*acting, &point))).collect();
            self.resisting = weights.resisting();
        }
        let count = self.screws.legs.len();
        let legs: Vec<_> = (0..count).map(|leg| self.leg(leg)).collect::<Option<_>>()?;
        let (legs, held): (Vec<Matrix6<f64>>, _) = legs.into_iter().unzip();
        self.held = held;
        Some(Stiffness { platform: legs.iter().sum(), legs })
    }

    /// The least stiffness against a force, N/m, and against a moment, N m/rad, of the platform at the pose of a stiffness: a
    /// force in the worst direction displaces the reference point by one over the first along that direction, a moment about
    /// the worst axis turns the platform by one over the second about it. Both are zero where it can move without resistance.
    pub fn least(&self, stiffness: &Stiffness) -> [f64; 2] {
        let unit = self.unit();
        let Some(decomposed) = self.decomposed_stiffness(stiffness) else { return [0.0; 2] };
        let compliance = unit * decomposed.inverse() * unit;
        [0, 3].map(|first| {
            let block = compliance.fixed_view::<3, 3>(first, first).into_owned();
            block.symmetric_eigenvalues().max().recip()
        })
    }

    /// How a load on the platform, with the weights of all bodies if these are heavy, is shared at the pose of a stiffness,
    /// which is the last that was computed. `None` where the platform can move without resistance.
    pub fn reactions(&self, stiffness: &Stiffness, load: &Wrench) -> Option<Reactions> {
        let unit = self.unit();
        let held: Vector6<f64> = self.held.iter().sum();
        let load = Vector6::from(load.components()) + self.platform - held;
        let displacement = unit * self.decomposed_stiffness(stiffness)?.solve(&(unit * load));
        let each = stiffness.legs.iter().zip(&self.held);
        let legs: Vec<Vector6<f64>> = each.map(|(leg, held)| leg * displacement + held).collect();
        let leg_of = |number: usize| self.screws.legs.iter().position(|l| l.contains(&number));
        let actuated = self.manipulator.actuated().iter();
        let efforts = actuated.map(|&number| {
            let own = leg_of(number).map_or(Vector6::zeros(), |leg| legs[leg]);
            0.0 - own.dot(&self.twist(number)) - self.along(number)
        });
        let efforts = efforts.collect();
        let mut joints = Vec::new();
        for ((leg, own), wrench) in
            self.manipulator.mechanism().legs.iter().zip(&self.screws.legs).zip(&legs)
        {
            let mut number = own.start;
            for joint in &leg.joints {
                let through = Wrench::from_components((wrench + self.behind(number)).into());
                joints.push(through.moved(&self.reference, &self.screws.freedoms[number].point));
                number += joint.coordinates.len();
            }
        }
        let legs = legs.into_iter().map(|leg| Wrench::from_components(leg.into())).collect();
        Some(Reactions { displacement, legs, joints, efforts })
    }

    /// What lengths are multiplied by: rotations of one radian, and translations of the characteristic length, are
    /// comparable.
    pub(crate) fn unit(&self) -> Matrix6<f64> {
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

    /// The weights of links that a joint coordinate moves, as a wrench at the reference point.
    fn behind(&self, number: usize) -> Vector6<f64> {
        let moved = self.heavy.iter().filter(|(moved_by, _)| moved_by.contains(&number));
        moved.map(|(_, weight)| weight).sum()
    }

    /// What the joint of a coordinate carries along it: the weights behind it, less what its rotor and its friction need.
    fn along(&self, number: usize) -> f64 {
        let resisting = self.resisting.get(number).copied().unwrap_or_default();
        self.twist(number).dot(&self.behind(number)) - resisting
    }

    /// The stiffness of a leg, and what the platform does to it under its own weight, if the platform is held.
    fn leg(&self, leg: usize) -> Option<(Matrix6<f64>, Vector6<f64>)> {
        let (mut compliance, mut sag) = (Matrix6::zeros(), Vector6::zeros());
        for Spring { behind, twist, stiffness, of } in self.springs_of(leg) {
            compliance += twist * twist.transpose() / stiffness;
            let pressed = match of {
                Sprung::Actuator => self.along(behind),
                Sprung::Link => twist.dot(&self.behind(behind)),
            };
            sag += twist * (pressed / stiffness);
        }
        let back = self.per_unit();
        let inverse = (back * compliance * back).cholesky()?.inverse();
        let (mut stiffness, mut balancing) = (inverse, Vector6::zeros());
        let passive = self.passive(leg);
        if !passive.is_empty() {
            let twists: Vec<_> = passive.iter().map(|&number| back * self.twist(number)).collect();
            let q = DMatrix::from_fn(6, twists.len(), |i, j| twists[j][i] / twists[j].norm());
            let carried = DVector::from_fn(twists.len(), |j, _| {
                let number = passive[j];
                self.along(number) / twists[j].norm()
            });
            let cq = inverse * &q;
            let square = regular_inverse(q.transpose() * &cq)?;
            let lost = &cq * &square * cq.transpose();
            stiffness -= Matrix6::from_fn(|i, j| lost[(i, j)]);
            let balance = &cq * &square * carried;
            balancing = Vector6::from_fn(|i, _| balance[i]);
        }
        let held = -(back * (stiffness * (back * sag) + balancing));
        Some((back * stiffness * back, held))
    }

    /// How the joints and springs of a leg move for displacements of the platform.
    ///
    /// The least energy of the springs: `C F + Jq δq = δt` and `Jqᵀ F = 0`, with `F = K δt`.
    pub(crate) fn leg_rates(&self, leg: usize, stiffness: &Matrix6<f64>) -> Option<LegRates> {
        let mut rates = LegRates { each: Vec::new(), drives: Vec::new() };
        let mut left = Matrix6::identity();
        for Spring { behind, twist, stiffness: own, of } in self.springs_of(leg) {
            let row = stiffness.tr_mul(&twist) / own;
            let map = twist * row.transpose();
            left -= map;
            rates.each.push((behind, map));
            if of == Sprung::Actuator {
                rates.drives.push((behind, row));
            }
        }
        // What the springs leave is that of the passive joints: their screws are independent.
        let passive = self.passive(leg);
        if passive.is_empty() {
            return Some(rates);
        }
        let back = self.per_unit();
        let twists: Vec<_> = passive.iter().map(|&number| back * self.twist(number)).collect();
        let q = DMatrix::from_fn(6, twists.len(), |i, j| twists[j][i] / twists[j].norm());
        let square = regular_inverse(q.tr_mul(&q))?;
        let found = square * q.transpose() * back * left;
        for (j, &number) in passive.iter().enumerate() {
            let row = Vector6::from_fn(|i, _| found[(j, i)] / twists[j].norm());
            rates.each.push((number, self.twist(number) * row.transpose()));
            rates.drives.push((number, row));
        }
        Some(rates)
    }

    /// The springs of a leg.
    fn springs_of(&self, leg: usize) -> Vec<Spring> {
        let own = self.screws.legs[leg].clone();
        let actuated = self.manipulator.actuated().iter().enumerate();
        let mut springs: Vec<Spring> = actuated
            .filter(|(_, number)| own.contains(number))
            .map(|(actuator, &behind)| {
                let stiffness = self.springs.actuators[actuator];
                Spring { behind, twist: self.twist(behind), stiffness, of: Sprung::Actuator }
            })
            .collect();
        springs.sort_by_key(|spring| spring.behind);
        for (behind, end) in self.link_ends(leg, own) {
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                let twist = Vector6::new(axis.x, axis.y, axis.z, 0.0, 0.0, 0.0);
                let stiffness = self.springs.translation;
                springs.push(Spring { behind, twist, stiffness, of: Sprung::Link });
                let moved = axis.cross(&(self.reference - end));
                let twist = Vector6::new(moved.x, moved.y, moved.z, axis.x, axis.y, axis.z);
                let stiffness = self.springs.rotation;
                springs.push(Spring { behind, twist, stiffness, of: Sprung::Link });
            }
        }
        springs
    }

    /// The passive joint coordinates of a leg.
    fn passive(&self, leg: usize) -> Vec<usize> {
        let actuated = self.manipulator.actuated();
        self.screws.legs[leg].clone().filter(|number| !actuated.contains(number)).collect()
    }

    /// One over [`Compliant::unit`].
    fn per_unit(&self) -> Matrix6<f64> {
        self.unit().map(|part| if part == 0.0 { 0.0 } else { part.recip() })
    }

    /// A stiffness in comparable numbers; `None` where the platform can move without resistance.
    pub(crate) fn decomposed_stiffness(&self, stiffness: &Stiffness) -> Option<Cholesky<f64, U6>> {
        let unit = self.unit();
        let scaled = unit * stiffness.platform * unit;
        let largest = scaled.diagonal().amax();
        let decomposed = scaled.cholesky()?;
        let least = decomposed.l_dirty().diagonal().iter().copied().fold(f64::INFINITY, f64::min);
        (least * least > SINGULAR * largest).then_some(decomposed)
    }

    /// The ends of a leg's links that give way, each at the next joint: the number of that joint's first coordinate, and its
    /// point.
    fn link_ends(
        &self,
        leg: usize,
        own: Range<usize>,
    ) -> impl Iterator<Item = (usize, Point3<f64>)> + '_ {
        let joints = &self.manipulator.mechanism().legs[leg].joints;
        let mut first = own.start;
        let points = joints.iter().map(move |joint| {
            let at = (first, self.screws.freedoms[first].point);
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
