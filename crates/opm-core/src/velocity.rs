//! Velocities and accelerations of every joint, from those of the task coordinates.
//!
//! A leg's closure `exp(I τ) · U = b`, `L = v · exp(I τ)` (or, if it is split in its lower section,
//! `L · exp(-I τ) = v`, `U = exp(-I τ) · b`) is differentiated one section at a time. A section's chain
//! has as many joints as its subspace has dimensions, so that in the subspace's own frame its screws
//! are a square matrix of at most 3 × 3. The rows of its inverse are the reciprocal screws. Each of them
//! gives the rate of one joint, and is reciprocal to all the others (Eq. 6 of the paper multiplies by one
//! of them, `v × w`). Nothing is solved by least squares.
//!
//! * The upper section, `V_b = ḃ b⁻¹ = I τ̇ + Σ s q̇`, gives the imaginary rate (Eqs. 5-9).
//! * The lower section, `V_v + Ad(v) I τ̇ = Σ s q̇`, gives the other rates (Eqs. 17-23).
//!
//! Accelerations follow from the derivatives of these equations, `Σ s q̈ = V̇ − Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`,
//! with the Lie brackets of the screws at the present configuration.
//!
//! A rate is the time derivative of the coordinate as it is reported. The rates of a spherical joint are
//! the derivatives of its rotation vector, and that of an imaginary joint has the joint's sign.
//!
//! In the paper's first manipulator the screws of a leg's upper section are `s₁ = u`, `s₂ = v` and `s₃ = w`.
//! The first reciprocal screw is `(v × w) / u · (v × w)`, and
//!
//! * `J_s` ([`Jacobians::upper`]) is `J_q,s⁻¹ J_x,s`: `θ̇ = J_s ω` (Eqs. 6-9);
//! * `J_p` ([`Jacobians::lower`]) is `J_q,p⁻¹ J_x,p`: `q̇ = J_p [θ̇; Ṗ]` (Eqs. 17-23), where the reciprocal
//!   screw of a slider is the force along link a1, and the arm's two are its Jacobian's inverse;
//! * together `q̇ = J_p [J_s ω; Ṗ]`.
//!
//! In the second manipulator `J_s = [p]` (Eqs. 24-25), and `J_p` has the rows `[sin βᵢ, −sin αᵢ, cos αᵢ]`. The
//! first column is zero except for the leg with the helical joint (Eq. 29, without the divisor that is
//! printed there).
//!
//! ```
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! let (mut buffer, mut motion) = (manipulator.solution(), manipulator.joint_motion());
//! let pose = [0.01, 0.0, 0.0, 0.26, 0.0]; // x y zeta xi psi
//! let mode = manipulator.home_mode();
//! let at = manipulator.inverse(&pose, mode, &mut buffer)?.expect("a pose in reach");
//! // x at 10 mm/s, zeta at 1 rad/s, everything at constant speed.
//! let regular = manipulator.velocity(at, &[0.01, 0.0, 1.0, 0.0, 0.0], &[0.0; 5], &mut motion)?;
//! assert!(regular && (motion.imaginary_rates[0] - 1.0).abs() < 1e-12); // theta11 follows zeta
//!
//! // How far this pose is from singular: no measure is zero, and the condition number is finite.
//! let (mut jacobians, mut measured) = (manipulator.jacobians(), manipulator.singularities());
//! manipulator.differentiate(at, &mut jacobians)?;
//! manipulator.measure_singularities(&jacobians, &mut measured);
//! assert!(measured.whole.serial != 0.0 && measured.whole.parallel != Some(0.0));
//! let length = manipulator.characteristic_length();
//! assert!(manipulator.conditioning(&jacobians, length).condition.is_finite());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod closure;
mod condition;
mod dependent;
mod jacobian;
mod many;
mod mirror;
mod pose;
pub(crate) mod rotation_vector;
mod screws;
mod section;
mod serial;
mod singularity;
mod weighted;
mod whole;

pub use condition::Conditioning;
pub use jacobian::Jacobians;
pub(crate) use jacobian::Rows;
pub use many::{ConditionBatch, ConditionQuery};
pub use singularity::{Cause, Measures, Singularities};

use crate::group::{JointDisplacement, LocalTwist};
use crate::manipulator::{CompiledLeg, LARGEST, Lean, LegSolution, Manipulator, Section, Solution};
use nalgebra::Vector3;
use section::Differential;

/// A measure of singularity below this counts as zero, and there are no rates. At a singular pose, where two
/// solutions coincide, a chain takes the square root of a number that is zero up to rounding, some 1e-15 or
/// 1e-14. A measure of about the square root of that is noise, and so are rates that are divided by it.
pub const SINGULAR: f64 = 1e-6;

/// Why rates cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VelocityError {
    /// The number of rates or accelerations is not the number of task coordinates.
    #[error("{given} rates, expected {expected}, one for each task coordinate")]
    Length {
        /// The number of rates or accelerations that were given.
        given: usize,
        /// The number of task coordinates.
        expected: usize,
    },
    /// A rate or an acceleration is not a number, infinite, or too large.
    #[error(
        "the rate or acceleration of {name} is {value:?}, expected a number of at most {LARGEST:?}"
    )]
    NotFinite {
        /// The name of the task coordinate.
        name: &'static str,
        /// Its rate or acceleration.
        value: f64,
    },
    /// The pose is out of reach of some legs, so that there are no joint values.
    #[error("the pose is out of reach, so that joints have no rates")]
    OutOfReach,
    /// Rates or accelerations of a leg overflow.
    #[error("the rates or accelerations of leg number {leg}, counted from 0, overflow")]
    Overflow {
        /// The number of the leg, counted from zero.
        leg: usize,
    },
}

/// A leg with joints that have no rates; [`Manipulator::rateless`] lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SingularLeg {
    /// The number of the leg, counted from zero.
    pub leg: usize,
    /// The section of the leg that is singular; `None` for a leg that is solved whole.
    pub section: Option<Section>,
    /// Why its joints have no rates.
    pub cause: SingularCause,
}

/// Why joints have no rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum SingularCause {
    /// The screws of the section's joints are dependent: a serial singularity. The platform cannot move in
    /// every direction, and for the other directions the joints would have to be infinitely fast.
    Serial,
    /// A spherical joint has made a full revolution, where its rotation vector has no derivative. The
    /// mechanism is not singular there.
    RotationVector,
}

/// Rates and accelerations of every joint, for one motion of the platform. The buffer is made by
/// [`Manipulator::joint_motion`] and filled by [`Manipulator::velocity`].
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mut buffer, mut motion) = (manipulator.solution(), manipulator.joint_motion());
/// let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
/// let at = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
/// let at = at.expect("a pose in reach");
///
/// // x at 10 mm/s, the other coordinates at rest, without acceleration.
/// let rates = [0.01, 0.0, 0.0, 0.0, 0.0];
/// assert!(manipulator.velocity(at, &rates, &[0.0; 5], &mut motion)?);
///
/// // Joint rates are the Jacobian times the rates of the coordinates.
/// let mut jacobians = manipulator.jacobians();
/// manipulator.differentiate(at, &mut jacobians)?;
/// let expected = jacobians.joints_by_pose().column(0) * 0.01;
/// for (rate, expected) in motion.joint_rates.iter().zip(&expected) {
///     assert!((rate - expected).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct JointMotion {
    /// The rate of every joint coordinate, in the order of [`Manipulator::coordinates`]; rad/s and m/s.
    pub joint_rates: Vec<f64>,
    /// The acceleration of every joint coordinate, in the same order; rad/s² and m/s².
    pub joint_accelerations: Vec<f64>,
    /// The rate of every imaginary joint, in the order of [`Manipulator::imaginary`]; rad/s or m/s.
    pub imaginary_rates: Vec<f64>,
    /// The acceleration of every imaginary joint, in the same order; rad/s² or m/s².
    pub imaginary_accelerations: Vec<f64>,
    /// The rate of every dependent coordinate, in the order of [`Manipulator::dependent_coordinates`]; rad/s and
    /// m/s. NaN where they do not follow from the other rates; then no joint has a rate.
    pub dependent_rates: Vec<f64>,
    /// The acceleration of every dependent coordinate, in the same order; rad/s² and m/s².
    pub dependent_accelerations: Vec<f64>,
    /// The legs with joints that have no rates. For these joints the numbers above are zeros without a
    /// meaning.
    pub singular: Vec<SingularLeg>,
}

/// The motion of the two sections for a motion of the task coordinates. Each has its twist, and the twist's
/// derivative by time.
#[derive(Clone, Copy)]
struct SectionTwists {
    /// The twist `v̇ v⁻¹` of the lower section.
    v: [LocalTwist; 2],
    /// The twist `ḃ b⁻¹` of the upper section.
    b: [LocalTwist; 2],
    /// The rate of a height, and its derivative; zeros where there is none.
    rise: [f64; 2],
}

impl SectionTwists {
    /// The rate and the acceleration of the height of a leg's own section, for those along the intersection motion and the
    /// slope of the height.
    #[inline]
    fn rises(&self, slope: f64, [rate, acceleration]: [f64; 2]) -> [f64; 2] {
        [self.rise[0] + slope * rate, self.rise[1] + slope * acceleration]
    }
}

/// The motion of a leg: rates, then accelerations.
struct LegMotion {
    /// The joints of the lower section's chain.
    lower: [LocalTwist; 2],
    /// The joints of the upper section's chain.
    upper: [LocalTwist; 2],
    /// The displacement τ along the intersection motion.
    tau: [f64; 2],
}

/// The differentials of a leg's two sections at one configuration.
#[derive(Clone, Copy, Debug)]
struct LegDifferential {
    lower: Differential,
    upper: Differential,
}

impl LegDifferential {
    #[inline]
    fn section(&self, section: Section) -> &Differential {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::velocity`].
    pub fn joint_motion(&self) -> JointMotion {
        let (joints, imaginary) = (self.coordinates().len(), self.imaginary().len());
        let dependent = self.dependent_coordinates().len();
        JointMotion {
            joint_rates: vec![0.0; joints],
            joint_accelerations: vec![0.0; joints],
            imaginary_rates: vec![0.0; imaginary],
            imaginary_accelerations: vec![0.0; imaginary],
            dependent_rates: vec![0.0; dependent],
            dependent_accelerations: vec![0.0; dependent],
            singular: Vec::with_capacity(self.legs()),
        }
    }

    /// Rates and accelerations of every joint at a solved pose, for given first and second time derivatives
    /// of the task coordinates (rad/s and m/s, rad/s² and m/s²). Nothing is allocated.
    ///
    /// Returns `false` if some joints have no rates: `out.singular` lists the legs. All other joints have
    /// their rates in any case. `at` comes from [`Manipulator::inverse`] or one of its relatives; a new
    /// [`Manipulator::solution`] is home.
    ///
    /// # Errors
    /// If there are not as many rates and accelerations as task coordinates, if one is not a finite number,
    /// or if the solution is out of reach.
    pub fn velocity(
        &self,
        at: &Solution,
        rates: &[f64],
        accelerations: &[f64],
        out: &mut JointMotion,
    ) -> Result<bool, VelocityError> {
        self.check_rates(rates)?;
        self.check_rates(accelerations)?;
        if !at.unreachable.is_empty() {
            return Err(VelocityError::OutOfReach);
        }
        let all;
        let [rates, accelerations] = match &self.dependent {
            None => [rates, accelerations],
            Some(dependent) => {
                let found = self.all_rates(dependent, at, [rates, accelerations], out);
                let Some(found) = found else {
                    self.all_singular(&mut out.singular);
                    out.dependent_rates.fill(f64::NAN);
                    out.dependent_accelerations.fill(f64::NAN);
                    return Ok(false);
                };
                all = found;
                all.each_ref().map(|all| &all[..self.task().coordinates.len()])
            }
        };
        let twists = self.section_twists(&at.solved.pose, rates, accelerations);
        if self.is_whole() {
            return self.whole_velocity(at, &twists, out);
        }
        let raised = self.task().height.is_some();
        out.singular.clear();
        for number in 0..self.legs.len() {
            let leg = self.leg_differential(at, number);
            let motion = if self.note_singular(number, &leg, &mut out.singular) {
                self.leg_motion(at, number, &leg, &twists)
            } else {
                LegMotion::NONE
            };
            if !motion.is_finite() {
                return Err(VelocityError::Overflow { leg: number });
            }
            self.write_motion(number, &motion, out);
            if raised && let Some(lift) = &self.legs[number].lift {
                let rises = twists.rises(lift.slope, motion.tau);
                let [rate, acceleration] = rises.map(|rise| lift.displacement(rise));
                let number = lift.coordinate.number;
                (out.joint_rates[number], out.joint_accelerations[number]) = (rate, acceleration);
            }
        }
        Ok(out.singular.is_empty())
    }

    /// Checks that there is one finite rate for each task coordinate.
    fn check_rates(&self, rates: &[f64]) -> Result<(), VelocityError> {
        let coordinates = self.task_coordinates();
        if rates.len() != coordinates.len() {
            let (given, expected) = (rates.len(), coordinates.len());
            return Err(VelocityError::Length { given, expected });
        }
        for (coordinate, &value) in coordinates.iter().zip(rates) {
            if value.is_nan() || value.abs() > LARGEST {
                return Err(VelocityError::NotFinite { name: coordinate.name, value });
            }
        }
        Ok(())
    }

    /// The twists of `v` and `b`, and their derivatives, for rates and accelerations of the task
    /// coordinates.
    fn section_twists(&self, pose: &[f64], rates: &[f64], accelerations: &[f64]) -> SectionTwists {
        let task = self.task();
        let twists = |screws: &screws::Screws, section: Section| {
            let vector = |all: &[f64]| {
                let mut found = LocalTwist::zeros();
                let own = task.in_plane(section, &all[task.range(section)]);
                found.iter_mut().zip(own).for_each(|(to, value)| *to = *value);
                task.screw_rates(section, found)
            };
            let (rates, accelerations) = (vector(rates), vector(accelerations));
            [screws.twist(&rates), screws.twist(&accelerations) + screws.bias(&rates)]
        };
        SectionTwists {
            v: twists(&task.lower_screws(pose), Section::Lower),
            b: twists(&task.upper_screws(pose), Section::Upper),
            rise: task.height_rates([rates, accelerations]),
        }
    }

    /// Adds the sections of a leg in which joints have no rates to `singular`. Returns `false` if no joint of
    /// the leg has a rate, because the section that is solved first is singular.
    #[inline]
    fn note_singular(
        &self,
        leg: usize,
        differential: &LegDifferential,
        singular: &mut Vec<SingularLeg>,
    ) -> bool {
        for (position, section) in self.legs[leg].order().into_iter().enumerate() {
            let Some(cause) = differential.section(section).singular() else { continue };
            singular.push(SingularLeg { leg, section: Some(section), cause });
            if position == 0 && cause == SingularCause::Serial {
                return false;
            }
        }
        true
    }

    /// The numbers of the joint coordinates of a singular leg that have no rates: those of the singular
    /// section and, if that is solved first, those of the other section too, with a joint that carries a height if that
    /// depends on the imaginary joint. For a spherical joint after a full revolution these are its own coordinates.
    pub fn rateless(&self, singular: &SingularLeg) -> impl Iterator<Item = usize> + '_ {
        let leg = &self.legs[singular.leg];
        // All joints of a leg that is solved whole move together.
        let between = leg.whole.as_ref().and_then(|whole| whole.between);
        let whole_leg = leg.whole.is_some()
            || singular.cause == SingularCause::Serial
                && singular.section == Some(leg.split_section);
        let sections = [(&leg.lower, Section::Lower), (&leg.upper, Section::Upper)];
        let section = singular.section;
        let chains =
            sections.into_iter().filter(move |(_, other)| whole_leg || Some(*other) == section);
        // A lift that follows the imaginary joint has no rate where that has none.
        let lift = leg.lift.filter(|lift| whole_leg && lift.slope != 0.0);
        chains
            .flat_map(|(section, _)| section.coordinates.iter().flatten())
            .map(|coordinate| coordinate.number)
            .chain(lift.map(|lift| lift.coordinate.number))
            .chain(between.map(|joint| joint.number))
    }

    /// The number of the imaginary joint of a singular leg, if that has no rate either.
    pub fn rateless_imaginary(&self, singular: &SingularLeg) -> Option<usize> {
        let leg = &self.legs[singular.leg];
        let lost =
            singular.cause == SingularCause::Serial && singular.section == Some(leg.split_section);
        leg.imaginary.filter(|_| lost)
    }

    /// The differentials of a leg's sections at a solution.
    #[inline]
    fn leg_differential(&self, at: &Solution, number: usize) -> LegDifferential {
        self.differential_for(Rows::All, at, number)
    }

    /// The same for some rows of the Jacobian.
    #[inline(always)]
    fn differential_for(&self, rows: Rows, at: &Solution, number: usize) -> LegDifferential {
        let leg = &self.legs[number];
        match &leg.lean {
            None => self.differential_of(leg, rows, at, number),
            Some(lean) => self.raised_differential((leg, lean), rows, at, number),
        }
    }

    /// The same for a leg with a lift that leans.
    #[cold]
    #[inline(never)]
    fn raised_differential(
        &self,
        (leg, lean): (&CompiledLeg, &Lean),
        rows: Rows,
        at: &Solution,
        number: usize,
    ) -> LegDifferential {
        // A leg that is solved at a height has a closed form there.
        let raised = leg.raised(lean, self.leg_rise(at, number));
        self.differential_of(raised.as_ref().unwrap_or(leg), rows, at, number)
    }

    /// The differentials of the sections of a leg, which is `leg` at the height of a solution. A section of passive
    /// joints that does not have the imaginary joint adds nothing to the rows of the driven joints.
    #[inline(always)]
    fn differential_of(
        &self,
        leg: &CompiledLeg,
        rows: Rows,
        at: &Solution,
        number: usize,
    ) -> LegDifferential {
        let of = (leg, number);
        LegDifferential {
            lower: self.section_differential(of, Section::Lower, rows, at),
            upper: self.section_differential(of, Section::Upper, rows, at),
        }
    }

    /// The differential of a section of a leg, for some rows.
    #[inline(always)]
    fn section_differential(
        &self,
        (leg, number): (&CompiledLeg, usize),
        section: Section,
        rows: Rows,
        at: &Solution,
    ) -> Differential {
        let (task, coordinates) = (self.task(), self.coordinates());
        let compiled = leg.section(section);
        if rows == Rows::Driven && leg.split_section != section && !compiled.driven {
            return Differential::UNUSED;
        }
        let displacements = at.legs[number].section(section);
        // Revolutions that the joints' values count do not change the rates of actuated joints.
        let vector = |first: usize| match rows {
            Rows::All => {
                Vector3::from_fn(|i, _| at.joints[first + i] - coordinates[first + i].home)
            }
            Rows::Driven => Vector3::from_fn(|i, _| displacements[i].value()),
        };
        let kind = match section {
            Section::Lower => task.lower.kind,
            Section::Upper => task.upper.kind,
        };
        let length = self.characteristic_length();
        Differential::new(kind, compiled, displacements, vector, length)
    }

    /// Rates and accelerations of a leg's joints, for the twists of the two sections.
    #[inline]
    fn leg_motion(
        &self,
        at: &Solution,
        number: usize,
        differential: &LegDifferential,
        twists: &SectionTwists,
    ) -> LegMotion {
        match &self.legs[number].lean {
            None => self.chain_motion(at, number, differential, twists, |_, target, _| target),
            Some(lean) => self.raised_motion(at, number, differential, twists, lean),
        }
    }

    /// The same for a leg with a lift that leans.
    #[cold]
    #[inline(never)]
    fn raised_motion(
        &self,
        at: &Solution,
        number: usize,
        differential: &LegDifferential,
        twists: &SectionTwists,
        lean: &Lean,
    ) -> LegMotion {
        let (leg, displacements) = (&self.legs[number], at.legs[number].section(lean.section));
        let section = differential.section(lean.section);
        let slope = self.task().slope();
        self.chain_motion(at, number, differential, twists, |of, target, tau| {
            if of == lean.section {
                section.behind(leg, lean, displacements, target, twists.rises(slope, tau))
            } else {
                target
            }
        })
    }

    /// Rates and accelerations of the joints of a leg's chains. `left` gives the part of a section's twist, and of its
    /// derivative, that is left to them; it is told the rate and the acceleration along the intersection motion, which are
    /// zero for the section that is solved first.
    #[inline(always)]
    fn chain_motion(
        &self,
        at: &Solution,
        number: usize,
        LegDifferential { lower, upper }: &LegDifferential,
        twists: &SectionTwists,
        left: impl Fn(Section, [LocalTwist; 2], [f64; 2]) -> [LocalTwist; 2],
    ) -> LegMotion {
        let task = self.task();
        let (leg, solved): (_, &LegSolution) = (&self.legs[number], &at.legs[number]);
        let solve =
            |section: &Differential, of: Section, target: [LocalTwist; 2], tau: [f64; 2]| {
                let [twist, derivative] = left(of, target, tau);
                let rates = section.rates(&twist);
                [rates, section.accelerations(&twist, &derivative, &rates)]
            };
        match leg.split_section {
            Section::Upper => {
                let upper = solve(upper, Section::Upper, twists.b, [0.0; 2]);
                let tau = upper.map(|u| leg.imaginary_joint().map_or(0.0, |joint| u[joint]));
                let along = at.solved.v.adjoint(&task.lower_intersection.unit_twist());
                let [twist, derivative] = twists.v;
                let along_rate = task.lower.kind.bracket(&twist, &along);
                let target =
                    [twist + along * tau[0], derivative + along * tau[1] + along_rate * tau[0]];
                LegMotion { lower: solve(lower, Section::Lower, target, tau), upper, tau }
            }
            Section::Lower => {
                let lower = solve(lower, Section::Lower, twists.v, [0.0; 2]);
                let last = leg.lower.chain.freedoms() - 1;
                let along_rates = lower.map(|l| l[last]);
                let kind = task.upper.kind;
                let along = task.upper_intersection.unit_twist();
                let displacement: JointDisplacement = solved.tau.inverse();
                let [twist, derivative] =
                    twists.b.map(|twist| task.upper_intersection.adjoint(displacement, &twist));
                let twist_rate = kind.bracket(&along, &twist);
                let target = [
                    along * along_rates[0] + twist,
                    along * along_rates[1] + derivative + twist_rate * along_rates[0],
                ];
                let tau = along_rates.map(|c| -c);
                LegMotion { lower, upper: solve(upper, Section::Upper, target, tau), tau }
            }
        }
    }

    /// Writes the motion of a leg's joints into `out`.
    #[inline]
    fn write_motion(&self, number: usize, motion: &LegMotion, out: &mut JointMotion) {
        let leg = &self.legs[number];
        for (section, [rates, accelerations]) in
            [(&leg.lower, &motion.lower), (&leg.upper, &motion.upper)]
        {
            for (i, coordinate) in section.coordinates.iter().enumerate() {
                let Some(coordinate) = coordinate else { continue };
                out.joint_rates[coordinate.number] = rates[i];
                out.joint_accelerations[coordinate.number] = accelerations[i];
            }
        }
        if let Some(imaginary) = leg.imaginary {
            let sign = self.imaginary()[imaginary].sign;
            out.imaginary_rates[imaginary] = sign * motion.tau[0];
            out.imaginary_accelerations[imaginary] = sign * motion.tau[1];
        }
    }
}

impl LegMotion {
    /// No motion: zeros.
    const NONE: Self = {
        let zero = [LocalTwist::new(0.0, 0.0, 0.0); 2];
        Self { lower: zero, upper: zero, tau: [0.0; 2] }
    };

    /// Whether no rate or acceleration has overflowed.
    fn is_finite(&self) -> bool {
        let sections = self.lower.iter().chain(&self.upper).flatten();
        sections.chain(&self.tau).all(|value| value.is_finite())
    }
}
