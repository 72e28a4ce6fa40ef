//! Named indices of a pose: one number each, for colours, columns and limits.
//!
//! Another index is a variant here, a row in [`Index::facts`] and an arm in [`Indices::evaluate`].

use crate::statics::{MOST, Statics};
use crate::transmission::{NoTransmission, Transmissions};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};
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
    /// The largest effort of an actuator for a unit force in the worst direction, sliders' efforts as they are, torques over
    /// the characteristic length.
    EffortPerForce,
    /// The largest effort of an actuator for a unit moment in the worst direction, sliders' efforts times the
    /// characteristic length, torques as they are.
    EffortPerMoment,
    /// The largest force that the actuators bear in every direction, within their `max_effort`.
    Payload,
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
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
}

impl Index {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Iti,
        Self::Oti,
        Self::Lti,
        Self::EffortPerForce,
        Self::EffortPerMoment,
        Self::Payload,
    ];

    /// What is said of it.
    pub const fn facts(self) -> Facts {
        match self {
            Self::Iti => share("iti", "input transmission index"),
            Self::Oti => share("oti", "output transmission index"),
            Self::Lti => share("lti", "local transmission index"),
            Self::EffortPerForce => load("effort_per_force", "largest effort for a unit force"),
            Self::EffortPerMoment => load("effort_per_moment", "largest effort for a unit moment"),
            Self::Payload => Facts {
                name: "payload",
                unit: "N",
                large_is_good: true,
                about: "largest force that is borne in every direction",
            },
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

    /// Whether a manipulator has this index.
    ///
    /// # Errors
    /// Why it does not.
    pub fn check(self, manipulator: &Manipulator) -> Result<(), IndexError> {
        Indices::new(manipulator, manipulator.characteristic_length(), [self]).map(drop)
    }

    /// Whether a value is as good as a bound, or better. A value that is not a number is not.
    pub fn admits(self, value: f64, bound: f64) -> bool {
        if self.facts().large_is_good { value >= bound } else { value <= bound }
    }
}

const fn share(name: &'static str, about: &'static str) -> Facts {
    Facts { name, unit: "", large_is_good: true, about }
}

const fn load(name: &'static str, about: &'static str) -> Facts {
    Facts { name, unit: "", large_is_good: false, about }
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

/// Evaluates indices of solved poses. It holds the working memory, so that nothing is allocated for a pose.
///
/// ```
/// use opm_analysis::{Index, Indices};
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let length = manipulator.characteristic_length();
/// let mut indices = Indices::new(&manipulator, length, [Index::Lti, Index::Iti])?;
/// let mut buffer = manipulator.solution();
/// let home = manipulator.home_pose();
/// let at = manipulator.inverse(&home, manipulator.home_mode(), &mut buffer)?;
/// let [lti, iti] = indices.evaluate(at.expect("home is in reach")) else { unreachable!() };
/// assert!(0.0 < *lti && lti <= iti && *iti <= 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Indices<'a> {
    indices: Vec<Index>,
    statics: Option<Statics<'a>>,
    transmissions: Option<Transmissions<'a>>,
    values: Vec<f64>,
}

impl<'a> Indices<'a> {
    /// A buffer for some indices of a manipulator, with this characteristic length, metres.
    ///
    /// # Errors
    /// Which index it does not have, and why.
    pub fn new(
        manipulator: &'a Manipulator,
        length: f64,
        indices: impl IntoIterator<Item = Index>,
    ) -> Result<Self, IndexError> {
        let indices: Vec<Index> = indices.into_iter().collect();
        let (mut statics, mut transmissions) = (None, None);
        for &index in &indices {
            let (actuators, freedoms) =
                (manipulator.actuated().len(), manipulator.task_coordinates().len());
            let limited = |&c: &usize| manipulator.coordinates()[c].max_effort.is_some();
            match index {
                Index::Iti | Index::Oti | Index::Lti => {
                    let new = Transmissions::new(manipulator);
                    transmissions =
                        Some(new.map_err(|reason| IndexError::Transmission { index, reason })?);
                }
                Index::EffortPerForce | Index::EffortPerMoment if actuators != freedoms => {
                    return Err(IndexError::Efforts { index, actuators, freedoms });
                }
                Index::Payload if !manipulator.actuated().iter().any(limited) => {
                    return Err(IndexError::NoLimits(index));
                }
                Index::EffortPerForce | Index::EffortPerMoment | Index::Payload => {
                    statics = Some(Statics::new(manipulator, length));
                }
            }
        }
        let values = vec![f64::NAN; indices.len()];
        Ok(Self { indices, statics, transmissions, values })
    }

    /// The indices, in the order of their values.
    pub fn indices(&self) -> &[Index] {
        &self.indices
    }

    /// The value of an index at the pose that was evaluated last; `None` if it is none of these indices.
    pub fn value(&self, index: Index) -> Option<f64> {
        let place = self.indices.iter().position(|&known| known == index)?;
        Some(self.values[place])
    }

    /// The values at a solved pose that is in reach. NaN where a pose has none: an effort at a serial singularity. At a
    /// parallel one, efforts are infinite.
    pub fn evaluate(&mut self, at: &Solution) -> &[f64] {
        let Self { indices, statics, transmissions, values } = self;
        if let Some(transmissions) = transmissions {
            transmissions.update(at);
        }
        let regular = statics.as_mut().is_some_and(|s| s.update(at).unwrap_or(false));
        let statics = statics.as_ref().filter(|_| regular);
        for (index, value) in indices.iter().zip(values) {
            let transmission = transmissions.as_ref().map(Transmissions::whole);
            let found = match index {
                Index::Iti => transmission.map(|whole| whole.input),
                Index::Oti => transmission.map(|whole| whole.output),
                Index::Lti => transmission.map(|whole| whole.local()),
                Index::EffortPerForce => statics.map(|statics| statics.largest(false)),
                Index::EffortPerMoment => statics.map(|statics| statics.largest(true)),
                Index::Payload => statics.and_then(|s| Some(s.capacity(&[0.0; MOST])?.force)),
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
        let manipulator = self.manipulator();
        let each = manipulator.actuated().iter().enumerate().map(|(row, &coordinate)| {
            let Some(worst) = self.worst(row) else { return f64::INFINITY };
            let slides = manipulator.coordinates()[coordinate].quantity == Quantity::Length;
            match (moment, slides) {
                (false, true) => worst.per_force,
                (false, false) => worst.per_force / self.length(),
                (true, true) => worst.per_moment * self.length(),
                (true, false) => worst.per_moment,
            }
        });
        each.fold(0.0, f64::max)
    }
}
