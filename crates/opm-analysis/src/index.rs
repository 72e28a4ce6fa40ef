//! Named indices of a pose: one number each, for colours, columns and limits.
//!
//! Another index is a variant here, a row in [`Index::facts`] and an arm in [`Indices::evaluate`].

use crate::acceleration::Pure;
use crate::setup::{Loads, Setup};
use crate::springs::SpringError;
use crate::statics::{MOST, Statics, Velocity};
use crate::stiffness::Compliant;
use crate::transmission::{NoTransmission, Transmissions};
use crate::wrench::Load;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};
use opm_interference::{Distances, Interference};
use std::fmt;

/// A number that says how good a pose is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Index {
    /// The least input transmission index of both sections.
    Iti,
    /// The least output transmission index of both sections.
    Oti,
    /// The local transmission index: the least of both.
    Lti,
    /// The output constraint index: how well the legs that constrain the platform do so.
    Oci,
    /// The largest effort of an actuator for a unit force in the worst direction, sliders' efforts as they are, torques over
    /// the characteristic length.
    EffortPerForce,
    /// The largest effort of an actuator for a unit moment in the worst direction, sliders' efforts times the
    /// characteristic length, torques as they are.
    EffortPerMoment,
    /// The largest effort of an actuator under the load, sliders' efforts as they are, torques over the characteristic length.
    Effort,
    /// The largest share of its `max_effort` that an actuator needs under the load.
    EffortShare,
    /// The largest torque of an actuator that turns its joint, with which the mechanism is held at rest under its weight, its payload
    /// and the load.
    HoldingTorque,
    /// The largest force of an actuator that slides its joint, likewise.
    HoldingForce,
    /// The largest force that the actuators bear in every direction on top of the load, within their `max_effort`.
    Payload,
    /// The largest moment that they bear about every axis, likewise.
    PayloadMoment,
    /// The radius of the largest ball in the wrench polytope around the load.
    PayloadBall,
    /// The largest acceleration that the actuators give the platform in every direction from rest, within their `max_effort`.
    Acceleration,
    /// The largest angular acceleration that they give it about every axis, likewise.
    AngularAcceleration,
    /// The least force that displaces the reference point by a unit of length in its direction.
    Stiffness,
    /// The least moment that turns the platform by a unit of angle about its axis.
    RotationalStiffness,
    /// The lowest natural frequency.
    NaturalFrequency,
    /// The distance of the nearest two bodies.
    Clearance,
}

/// What is said of an index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Its name, on the command line, in tables and in recordings.
    pub name: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// Whether large values are good.
    pub large_is_good: bool,
    /// What it is, in a few words.
    pub about: &'static str,
}

/// Why a manipulator has no such index.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IndexError {
    /// It has no transmission indices.
    #[error("{index}: {reason}")]
    Transmission {
        /// The index.
        index: Index,
        /// The reason.
        reason: NoTransmission,
    },
    /// Loads do not determine the efforts of redundant actuators, and too few actuators do not hold the platform.
    #[error(
        "{index}: {actuators} actuated coordinates for {freedoms} degrees of freedom; efforts need as many"
    )]
    Efforts {
        /// The index.
        index: Index,
        /// The number of actuated coordinates.
        actuators: usize,
        /// The number of degrees of freedom.
        freedoms: usize,
    },
    /// No actuator has a largest effort.
    #[error("{0}: no actuated joint has a `max_effort`")]
    NoLimits(Index),
    /// Nothing acts on the mechanism.
    #[error("{0}: nothing acts on the mechanism; give a wrench or gravity")]
    NoLoad(Index),
    /// Nothing gives way.
    #[error("{0}: nothing gives way; give the stiffness of links")]
    Rigid(Index),
    /// The springs do not suit the manipulator.
    #[error("{index}: {reason}")]
    Springs {
        /// The index.
        index: Index,
        /// The reason.
        reason: SpringError,
    },
    /// No two bodies can interfere.
    #[error("{0}: no two bodies that could interfere")]
    NoBodies(Index),
    /// No actuator has such an effort.
    #[error("{index}: no actuated joint {what}")]
    NoActuator {
        /// The index.
        index: Index,
        /// What none does.
        what: &'static str,
    },
    /// The platform cannot be accelerated so.
    #[error("{index}: the platform {what}")]
    NoMotion {
        /// The index.
        index: Index,
        /// What it does not do.
        what: &'static str,
    },
}

impl Index {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::Iti,
        Self::Oti,
        Self::Lti,
        Self::Oci,
        Self::EffortPerForce,
        Self::EffortPerMoment,
        Self::Effort,
        Self::EffortShare,
        Self::HoldingTorque,
        Self::HoldingForce,
        Self::Payload,
        Self::PayloadMoment,
        Self::PayloadBall,
        Self::Acceleration,
        Self::AngularAcceleration,
        Self::Stiffness,
        Self::RotationalStiffness,
        Self::NaturalFrequency,
        Self::Clearance,
    ];

    /// What is said of it.
    pub const fn facts(self) -> Facts {
        match self {
            Self::Iti => good("iti", "", "input transmission index"),
            Self::Oti => good("oti", "", "output transmission index"),
            Self::Lti => good("lti", "", "local transmission index"),
            Self::Oci => good("oci", "", "output constraint index"),
            Self::EffortPerForce => bad("effort_per_force", "", "largest effort for a unit force"),
            Self::EffortPerMoment => {
                bad("effort_per_moment", "", "largest effort for a unit moment")
            }
            Self::Effort => bad("effort", "N", "largest effort under the load"),
            Self::EffortShare => bad("effort_share", "", "largest share of a max_effort"),
            Self::HoldingTorque => {
                bad("holding_torque", "N m", "largest torque of an actuator that holds it at rest")
            }
            Self::HoldingForce => {
                bad("holding_force", "N", "largest force of an actuator that holds it at rest")
            }
            Self::Payload => good("payload", "N", "largest force that is borne in every direction"),
            Self::PayloadMoment => {
                good("payload_moment", "N m", "largest moment that is borne about every axis")
            }
            Self::PayloadBall => {
                good("payload_ball", "N m", "radius of the largest ball of wrenches that is borne")
            }
            Self::Acceleration => {
                good("acceleration", "m/s^2", "largest acceleration in every direction, from rest")
            }
            Self::AngularAcceleration => good(
                "angular_acceleration",
                "rad/s^2",
                "largest angular acceleration about every axis, from rest",
            ),
            Self::Stiffness => good("stiffness", "N/m", "least stiffness against a force"),
            Self::RotationalStiffness => {
                good("rotational_stiffness", "N m/rad", "least stiffness against a moment")
            }
            Self::NaturalFrequency => good("natural_frequency", "Hz", "lowest natural frequency"),
            Self::Clearance => good("clearance", "m", "distance of the nearest two bodies"),
        }
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// The index of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|index| index.name() == name)
    }

    /// Whether a manipulator has this index in a setup.
    ///
    /// # Errors
    /// Why it does not.
    pub fn check(self, manipulator: &Manipulator, setup: &Setup) -> Result<(), IndexError> {
        Indices::new(manipulator, setup, [self]).map(drop)
    }

    /// The indices that a manipulator has in a setup.
    pub fn known(manipulator: &Manipulator, setup: &Setup) -> Vec<Self> {
        Self::ALL.into_iter().filter(|index| index.check(manipulator, setup).is_ok()).collect()
    }

    /// Whether its value depends on what acts on the mechanism.
    pub fn depends_on_load(self) -> bool {
        matches!(
            self,
            Self::Effort
                | Self::EffortShare
                | Self::HoldingTorque
                | Self::HoldingForce
                | Self::Payload
                | Self::PayloadMoment
                | Self::PayloadBall
                | Self::Acceleration
                | Self::AngularAcceleration
        )
    }

    /// Whether its value depends on how much the mechanism gives way.
    pub fn depends_on_springs(self) -> bool {
        matches!(self, Self::Stiffness | Self::RotationalStiffness | Self::NaturalFrequency)
    }

    /// Whether its value depends on the masses of bodies.
    pub fn depends_on_masses(self) -> bool {
        matches!(
            self,
            Self::NaturalFrequency
                | Self::Acceleration
                | Self::AngularAcceleration
                | Self::HoldingTorque
                | Self::HoldingForce
        )
    }

    /// What the actuators measure whose efforts at rest it is.
    fn held_by(self) -> Option<Quantity> {
        match self {
            Self::HoldingTorque => Some(Quantity::Angle),
            Self::HoldingForce => Some(Quantity::Length),
            _ => None,
        }
    }

    /// Whether a value is as good as a bound, or better. A value that is not a number is not.
    pub fn admits(self, value: f64, bound: f64) -> bool {
        if self.facts().large_is_good { value >= bound } else { value <= bound }
    }
}

/// An index of which large values are good.
const fn good(name: &'static str, unit: &'static str, about: &'static str) -> Facts {
    Facts { name, unit, large_is_good: true, about }
}

/// An index of which small values are good.
const fn bad(name: &'static str, unit: &'static str, about: &'static str) -> Facts {
    Facts { name, unit, large_is_good: false, about }
}

impl fmt::Display for Index {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Bounds of indices: the least value of one of which large values are good, the largest of another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IndexBounds([Option<f64>; Index::ALL.len()]);

impl IndexBounds {
    /// The same with a bound of an index.
    #[must_use]
    pub fn with(mut self, index: Index, bound: f64) -> Self {
        self.0[index as usize] = Some(bound);
        self
    }

    /// The indices that have bounds.
    pub fn iter(&self) -> impl Iterator<Item = (Index, f64)> + '_ {
        Index::ALL.into_iter().filter_map(|index| Some((index, self.0[index as usize]?)))
    }

    /// Whether no index has a bound.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }
}

/// Evaluates indices of solved poses. It holds the working memory, so that nothing is allocated for a pose, but for
/// stiffnesses.
///
/// ```
/// use opm_analysis::{Index, Indices, Setup};
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let setup = Setup::new(manipulator.characteristic_length());
/// let mut indices = Indices::new(&manipulator, &setup, [Index::Lti, Index::Iti])?;
/// let mut buffer = manipulator.solution();
/// let home = manipulator.home_pose();
/// let at = manipulator.inverse(&home, manipulator.home_mode(), &mut buffer)?;
/// let [lti, iti] = indices.evaluate(at.expect("home is in reach")) else { unreachable!() };
/// assert!(0.0 < *lti && lti <= iti && *iti <= 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Indices<'a> {
    manipulator: &'a Manipulator,
    indices: Vec<Index>,
    statics: Option<Statics<'a>>,
    loads: Option<Loads<'a>>,
    transmissions: Option<Transmissions<'a>>,
    compliant: Option<Compliant<'a>>,
    /// What acts on bodies that have masses.
    heavy: Option<Loads<'a>>,
    distances: Option<Distances<'static>>,
    values: Vec<f64>,
    /// The effort of each actuated and each imaginary joint under the load, if they are asked for.
    efforts: Vec<f64>,
}

impl<'a> Indices<'a> {
    /// A buffer for some indices of a manipulator in a setup.
    ///
    /// # Errors
    /// Which index it does not have, and why.
    pub fn new(
        manipulator: &'a Manipulator,
        setup: &Setup,
        indices: impl IntoIterator<Item = Index>,
    ) -> Result<Self, IndexError> {
        let indices: Vec<Index> = indices.into_iter().collect();
        let mut new = Self {
            manipulator,
            statics: None,
            loads: Loads::new(manipulator, setup),
            transmissions: None,
            compliant: None,
            heavy: None,
            distances: None,
            values: vec![f64::NAN; indices.len()],
            efforts: Vec::new(),
            indices: Vec::new(),
        };
        indices.iter().try_for_each(|&index| new.prepare(manipulator, setup, index))?;
        Ok(Self { indices, ..new })
    }

    /// The same with the effort of every actuated and every imaginary joint under the load of the setup:
    /// [`Indices::efforts`].
    ///
    /// # Panics
    /// If the setup has no load.
    #[must_use]
    pub fn with_efforts(mut self, setup: &Setup) -> Self {
        assert!(setup.has_load(), "efforts of a setup without a load");
        let count = self.manipulator.actuated().len() + self.manipulator.imaginary().len();
        self.efforts = vec![f64::NAN; count];
        self.statics.get_or_insert_with(|| Statics::new(self.manipulator, setup.length));
        self
    }

    /// Takes another load on the platform, if the setup has one.
    pub fn set_load(&mut self, load: Load) {
        for loads in self.loads.iter_mut().chain(&mut self.heavy) {
            loads.set_load(load);
        }
    }

    /// The effort of every actuated, then of every imaginary joint at the pose that was evaluated last, N and N m; not a
    /// number where it is not known. Empty unless asked for.
    pub fn efforts(&self) -> &[f64] {
        &self.efforts
    }

    /// Makes what an index is computed with.
    fn prepare(
        &mut self,
        manipulator: &'a Manipulator,
        setup: &Setup,
        index: Index,
    ) -> Result<(), IndexError> {
        let actuated = manipulator.actuated();
        let coordinates = manipulator.coordinates();
        let limited = |&c: &usize| coordinates[c].max_effort.is_some();
        let (actuators, freedoms) = (actuated.len(), manipulator.task_coordinates().len());
        match index {
            Index::Iti | Index::Oti | Index::Lti | Index::Oci => {
                let wrong = |reason| IndexError::Transmission { index, reason };
                let found = Transmissions::new(manipulator).map_err(wrong)?;
                if index == Index::Oci {
                    found.has_constraints().map_err(wrong)?;
                }
                self.transmissions = Some(found);
                return Ok(());
            }
            Index::Stiffness | Index::RotationalStiffness | Index::NaturalFrequency => {
                let springs = setup.springs.clone().ok_or(IndexError::Rigid(index))?;
                let found = Compliant::new(manipulator, springs);
                let found = found.map_err(|reason| IndexError::Springs { index, reason })?;
                // Weights do not change the stiffness.
                self.compliant = Some(found.with_gravity(&setup.gravity.unwrap_or_default()));
                return Ok(());
            }
            Index::Clearance => {
                let interference = Interference::new(manipulator.mechanism());
                if interference.pairs() == 0 {
                    return Err(IndexError::NoBodies(index));
                }
                self.distances = Some(Distances::owned(interference));
                return Ok(());
            }
            Index::HoldingTorque | Index::HoldingForce
                if !actuated.iter().any(|&c| Some(coordinates[c].quantity) == index.held_by()) =>
            {
                let what = if index == Index::HoldingTorque { "turns" } else { "slides" };
                return Err(IndexError::NoActuator { index, what });
            }
            Index::EffortPerForce
            | Index::EffortPerMoment
            | Index::Effort
            | Index::EffortShare
            | Index::HoldingTorque
            | Index::HoldingForce
                if actuators != freedoms =>
            {
                return Err(IndexError::Efforts { index, actuators, freedoms });
            }
            Index::EffortShare
            | Index::Payload
            | Index::PayloadMoment
            | Index::PayloadBall
            | Index::Acceleration
            | Index::AngularAcceleration
                if !actuated.iter().any(limited) =>
            {
                return Err(IndexError::NoLimits(index));
            }
            Index::HoldingTorque | Index::HoldingForce => {
                self.heavy = Some(Loads::of(manipulator, &setup.heavy()));
            }
            Index::Acceleration | Index::AngularAcceleration => {
                self.heavy = Some(Loads::of(manipulator, &setup.heavy()));
                let (pure, what) = match index {
                    Index::Acceleration => (Pure::Translations, "never moves without turning"),
                    _ => (Pure::Rotations, "never turns about its reference point alone"),
                };
                let new = || Statics::new(manipulator, setup.length);
                let statics = self.statics.get_or_insert_with(new);
                // Home stands for all poses.
                let regular = statics.update(&manipulator.solution()).unwrap_or(false);
                if regular && statics.pure(pure).1 == 0 {
                    return Err(IndexError::NoMotion { index, what });
                }
                return Ok(());
            }
            Index::Effort | Index::EffortShare if !setup.has_load() => {
                return Err(IndexError::NoLoad(index));
            }
            Index::EffortPerForce
            | Index::EffortPerMoment
            | Index::Effort
            | Index::EffortShare
            | Index::Payload
            | Index::PayloadMoment
            | Index::PayloadBall => {}
        }
        self.statics.get_or_insert_with(|| Statics::new(manipulator, setup.length));
        Ok(())
    }

    /// The indices, in the order of their values.
    pub fn indices(&self) -> &[Index] {
        &self.indices
    }

    /// The values at the pose that was evaluated last.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value of an index at the pose that was evaluated last; `None` if it is none of these indices.
    pub fn value(&self, index: Index) -> Option<f64> {
        let place = self.indices.iter().position(|&known| known == index)?;
        Some(self.values[place])
    }

    /// The values at a solved pose that is in reach. NaN where a pose has none: an effort or a stiffness at a serial
    /// singularity. At a parallel one, efforts are infinite.
    pub fn evaluate(&mut self, at: &Solution) -> &[f64] {
        let Self {
            manipulator,
            indices,
            statics,
            loads,
            transmissions,
            compliant,
            heavy,
            distances,
            values,
            efforts,
        } = self;
        if let Some(transmissions) = transmissions {
            transmissions.update(at);
        }
        let regular = statics.as_mut().is_some_and(|s| s.update(at).unwrap_or(false));
        let statics = statics.as_ref().filter(|_| regular);
        if let Some(loads) = loads.as_mut().filter(|_| !efforts.is_empty()) {
            let found = statics.map(|statics| loads.efforts(statics, at));
            let each = found.iter().flat_map(|found| found.actuated.iter().chain(&found.imaginary));
            efforts.fill(f64::NAN);
            efforts.iter_mut().zip(each).for_each(|(to, effort)| *to = effort.unwrap_or(f64::NAN));
        }
        // What acts, and what is left for a payload.
        let work = statics.and_then(|statics| match loads {
            Some(loads) => loads.work(statics, at),
            None => Some([0.0; MOST]),
        });
        let loaded = || statics.zip(work.as_ref());
        let capacity = || loaded().and_then(|(statics, work)| statics.capacity(work));
        let capacity = indices
            .iter()
            .any(|index| {
                matches!(index, Index::Payload | Index::PayloadMoment | Index::PayloadBall)
            })
            .then(capacity)
            .flatten();
        let held = indices.iter().any(|index| index.held_by().is_some());
        let held = statics.zip(heavy.as_mut().filter(|_| held));
        let held = held.and_then(|(statics, loads)| Some((statics, loads.work(statics, at)?)));
        let pushed =
            |index: &Index| matches!(index, Index::Acceleration | Index::AngularAcceleration);
        let radius = statics.zip(heavy.as_mut().filter(|_| indices.iter().any(pushed)));
        let radius = radius.and_then(|(statics, loads)| loads.acceleration_radius(statics, at));
        let stiffness = compliant.as_mut().and_then(|compliant| {
            let found = compliant.stiffness(at)?;
            let vibrates = indices.contains(&Index::NaturalFrequency);
            let frequency = vibrates.then(|| {
                // What moves without resistance swings infinitely slowly.
                compliant.vibrations(&found).map_or(0.0, |found| found[0].frequency)
            });
            Some((compliant.least(&found), frequency))
        });
        let nearest = distances.as_mut().and_then(|distances| {
            distances.place(manipulator, at);
            distances.nearest()
        });
        let transmission = transmissions.as_ref();
        for (index, value) in indices.iter().zip(values) {
            let found = match index {
                Index::Iti => transmission.map(|found| found.whole().input),
                Index::Oti => transmission.map(|found| found.whole().output),
                Index::Lti => transmission.map(|found| found.whole().local()),
                Index::Oci => transmission.and_then(Transmissions::constraint),
                Index::EffortPerForce => statics.map(|statics| statics.largest(false)),
                Index::EffortPerMoment => statics.map(|statics| statics.largest(true)),
                Index::Effort => loaded().map(|(statics, work)| statics.largest_under(work, false)),
                Index::EffortShare => {
                    loaded().map(|(statics, work)| statics.largest_under(work, true))
                }
                Index::HoldingTorque | Index::HoldingForce => {
                    held.as_ref().map(|(statics, work)| statics.largest_of(work, index.held_by()))
                }
                Index::Payload => capacity.map(|found| found.force),
                Index::PayloadMoment => capacity.map(|found| found.moment),
                Index::PayloadBall => capacity.map(|found| found.ball),
                Index::Acceleration => radius.and_then(|found| found.linear),
                Index::AngularAcceleration => radius.and_then(|found| found.angular),
                Index::Stiffness => stiffness.map(|([against_force, _], _)| against_force),
                Index::RotationalStiffness => {
                    stiffness.map(|([_, against_moment], _)| against_moment)
                }
                Index::NaturalFrequency => stiffness.and_then(|(_, frequency)| frequency),
                Index::Clearance => nearest.map(|found| found.distance),
            };
            *value = found.unwrap_or(f64::NAN);
        }
        &self.values
    }
}

impl Statics<'_> {
    /// The largest effort of any actuator for a unit force, or for a unit moment, in its worst direction, with sliders'
    /// efforts and torques made comparable by the characteristic length; infinite where the platform is not held.
    fn largest(&self, moment: bool) -> f64 {
        let each = (0..self.manipulator().actuated().len()).map(|row| {
            let Some(worst) = self.worst(row) else { return f64::INFINITY };
            match (moment, self.slides(row)) {
                (false, true) => worst.per_force,
                (false, false) => worst.per_force / self.length(),
                (true, true) => worst.per_moment * self.length(),
                (true, false) => worst.per_moment,
            }
        });
        each.fold(0.0, f64::max)
    }

    /// The largest effort of any actuator for a load, torques over the characteristic length, or the largest share of a
    /// `max_effort`; infinite where the load drives a motion, or none determines the effort.
    fn largest_under(&self, work: &Velocity, share: bool) -> f64 {
        let manipulator = self.manipulator();
        let each = manipulator.actuated().iter().enumerate().map(|(row, &coordinate)| {
            let Some(effort) = self.effort_under(row, work) else { return f64::INFINITY };
            let unit = match (share, manipulator.coordinates()[coordinate].max_effort) {
                (true, Some(most)) => most,
                // An actuator without a limit has enough.
                (true, None) => f64::INFINITY,
                (false, _) if self.slides(row) => 1.0,
                (false, _) => self.length(),
            };
            effort.abs() / unit
        });
        each.fold(0.0, f64::max)
    }

    /// The largest effort for a load of the actuators that measure something; infinite as above.
    fn largest_of(&self, work: &Velocity, quantity: Option<Quantity>) -> f64 {
        let slides = quantity == Some(Quantity::Length);
        let rows =
            (0..self.manipulator().actuated().len()).filter(|&row| self.slides(row) == slides);
        let each = rows.map(|row| self.effort_under(row, work).map_or(f64::INFINITY, f64::abs));
        each.fold(0.0, f64::max)
    }

    /// Whether an actuated coordinate is a length.
    fn slides(&self, actuated: usize) -> bool {
        let manipulator = self.manipulator();
        manipulator.coordinates()[manipulator.actuated()[actuated]].quantity == Quantity::Length
    }
}
