//! A pose as it is given: by name or as a list, and what is wrong with one.

use super::Manipulator;
use crate::chain::ReachDeficit;

/// The largest absolute value of a coordinate of a pose, radians or metres: the fourth power of a larger one,
/// which intermediate results contain, would overflow.
pub const LARGEST: f64 = 1e75;

/// Why a pose is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The number of coordinates is not that of the manipulator.
    #[error("{given} coordinate{}, expected {expected}", if *given == 1 { "" } else { "s" })]
    Length {
        /// The number of coordinates given.
        given: usize,
        /// The number of task coordinates.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or larger than [`LARGEST`].
    #[error("{name} is {value:?}, expected a number of at most {LARGEST:?}")]
    NotFinite {
        /// The name of the coordinate.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The dependent coordinates of the pose have no solution.
    #[error(
        "no value of the dependent coordinates satisfies the constraint of leg {leg}, by {:.3e} {}",
        deficit.excess, deficit.quantity.unit()
    )]
    Constraint {
        /// The name of the leg.
        leg: String,
        /// By how much its constraint is missed.
        deficit: ReachDeficit,
    },
    /// A coordinate is given that follows from those of the pose.
    #[error(transparent)]
    Follows(#[from] FollowingCoordinate),
    /// There is no task coordinate with this name.
    #[error("no task coordinate is called {name}, expected {expected}")]
    Unknown {
        /// The name that was given.
        name: String,
        /// The names of the task coordinates, separated by commas.
        expected: String,
    },
}

/// A dependent coordinate where one of the pose was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} {}", self.problem())]
pub struct FollowingCoordinate {
    /// The name of the dependent coordinate.
    pub name: String,
    /// The names of the coordinates of a pose, which it follows from.
    pub independent: Vec<&'static str>,
}

impl FollowingCoordinate {
    /// The problem, without the name of the coordinate.
    pub(crate) fn problem(&self) -> String {
        format!("follows from {}; give these instead", self.independent.join(", "))
    }
}

impl Manipulator {
    /// The pose at home, radians and metres.
    pub fn home_pose(&self) -> Vec<f64> {
        self.task_coordinates().iter().map(|c| c.home).collect()
    }

    /// Refuses the name of a dependent coordinate, where a coordinate of the pose is expected.
    ///
    /// # Errors
    /// [`FollowingCoordinate`]
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let five_bar = Manipulator::example("five-bar")?;
    /// assert_eq!(five_bar.refuse_following("x"), Ok(()));
    /// let error = five_bar.refuse_following("theta").unwrap_err();
    /// assert_eq!(error.to_string(), "theta follows from x, y; give these instead");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refuse_following(&self, name: &str) -> Result<(), FollowingCoordinate> {
        match self.dependent_coordinates().iter().any(|c| c.name == name) {
            false => Ok(()),
            true => Err(FollowingCoordinate {
                name: name.to_owned(),
                independent: self.task_coordinates().iter().map(|c| c.name).collect(),
            }),
        }
    }

    /// The pose with these values of task coordinates by name (radians and metres); the others have
    /// their values at home.
    ///
    /// # Errors
    /// A name is not that of a task coordinate, or a value is not a finite number.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
    /// assert_eq!(pose, [0.01, 0.0, 0.0, 15_f64.to_radians(), 0.0]); // x y zeta xi psi
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Vec<f64>, PoseError> {
        let coordinates = self.task_coordinates();
        let mut pose = self.home_pose();
        for (name, value) in values {
            let Some(number) = coordinates.iter().position(|c| c.name == name) else {
                self.refuse_following(name)?;
                let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
                return Err(PoseError::Unknown {
                    name: name.to_owned(),
                    expected: names.join(", "),
                });
            };
            pose[number] = value;
        }
        self.check_pose(&pose)?;
        Ok(pose)
    }

    /// Returns an error for a pose with a wrong number of coordinates, or with one that is not a finite number.
    #[inline]
    pub(crate) fn check_pose(&self, pose: &[f64]) -> Result<(), PoseError> {
        let coordinates = self.task_coordinates();
        if pose.len() != coordinates.len() {
            return Err(PoseError::Length { given: pose.len(), expected: coordinates.len() });
        }
        for (coordinate, &value) in coordinates.iter().zip(pose) {
            if value.is_nan() || value.abs() > LARGEST {
                return Err(PoseError::NotFinite { name: coordinate.name, value });
            }
        }
        Ok(())
    }
}
