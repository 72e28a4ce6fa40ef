//! Limits of the difference of two joints: coaxial motors whose arms meet, neighbouring sliders on one rail.

use super::Mechanism;
use crate::mechanism::joint::JointCoordinate;
use crate::numeric::Quantity;
use crate::numeric::angle::near;

/// What counts as rounding of a difference at its limit, as a share of the largest of the numbers, and of one.
const SLACK: f64 = 1e-12;

/// Limits of the difference of two joint coordinates, a limit of the mechanism as a whole.
///
/// ```
/// use opm_core::{Manipulator, mechanism::Difference};
///
/// // The motors of a five-bar do not turn further apart than half a radian from where they are at home.
/// let mut mechanism = Manipulator::example("five-bar")?.mechanism().clone();
/// let motors: Vec<_> = mechanism.joints().filter(|joint| joint.actuated).collect();
/// let joints = [0, 1].map(|i| motors[i].name.clone());
/// let home = motors[0].coordinates[0].home - motors[1].coordinates[0].home;
/// mechanism.differences.push(Difference { joints, limits: [home - 0.5, home + 0.5] });
///
/// let manipulator = Manipulator::new(mechanism)?;
/// let difference = &manipulator.differences()[0];
/// assert!((difference.room(manipulator.solution().joints()) - 0.5).abs() < 1e-9); // at home
/// let (mode, mut at) = (manipulator.home_mode(), manipulator.solution());
/// let near = manipulator.pose([("y", manipulator.home_pose()[1] + 0.01)])?;
/// assert!(manipulator.inverse(&near, mode, &mut at)?.is_some_and(|at| at.within_limits()));
/// let far = manipulator.pose([("y", 0.15)])?;
/// assert!(manipulator.inverse(&far, mode, &mut at)?.is_some_and(|at| !at.within_limits()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Difference {
    /// The names of the joint coordinates: the value of the second is taken from that of the first.
    pub joints: [String; 2],
    /// The lowest and the highest difference, radians or metres.
    pub limits: [f64; 2],
}

/// The difference of two coordinates of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDifference {
    /// What it is called: `a - b`.
    pub name: String,
    /// The numbers of the two among all joint coordinates.
    pub coordinates: [usize; 2],
    /// The numbers of their legs.
    pub legs: [usize; 2],
    /// Whether it is an angle or a length.
    pub quantity: Quantity,
    /// The lowest and the highest difference, radians or metres.
    pub limits: [f64; 2],
    /// Whether full turns do not count: it is an angle, and one of the joints has no limits and turns as often as it likes.
    pub turns: bool,
}

/// Why two coordinates have no limited difference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DifferenceError {
    /// There is no such coordinate.
    #[error("no joint is named {name:?}, expected two of the names of joints")]
    Unknown {
        /// The name.
        name: String,
    },
    /// Both are one coordinate.
    #[error("{name:?} is named twice, expected two joints")]
    Same {
        /// The name.
        name: String,
    },
    /// One is an angle and the other a length.
    #[error("one of {:?} and {:?} is an angle and the other a length, expected two of a kind", .joints[0], .joints[1])]
    Quantities {
        /// The names of the two.
        joints: [String; 2],
    },
    /// The limits are no range.
    #[error("{name} has the limits {:?} and {:?}, expected the lowest and the highest difference", .limits[0], .limits[1])]
    Range {
        /// What it is called.
        name: String,
        /// The limits.
        limits: [f64; 2],
    },
    /// Home is beyond the limits.
    #[error("{name} is {value} at home, expected a difference from {} to {}", .limits[0], .limits[1])]
    Home {
        /// What it is called.
        name: String,
        /// The difference at home, radians or metres.
        value: f64,
        /// The limits.
        limits: [f64; 2],
        /// Whether it is an angle or a length.
        quantity: Quantity,
    },
}

impl Mechanism {
    /// The limited differences of its joints, with the numbers of their coordinates.
    ///
    /// # Errors
    /// [`DifferenceError`]: the first of its [differences](Mechanism::differences) that is none, or excludes home.
    pub fn joint_differences(&self) -> Result<Vec<JointDifference>, DifferenceError> {
        self.differences.iter().map(|difference| difference.of(self)).collect()
    }
}

impl Difference {
    /// The difference in a mechanism.
    ///
    /// # Errors
    /// As [`Mechanism::joint_differences`].
    pub fn of(&self, mechanism: &Mechanism) -> Result<JointDifference, DifferenceError> {
        let [one, other] = self.coordinates(mechanism)?;
        let [first, second] = [one.2, other.2];
        let name = format!("{} - {}", first.name, second.name);
        let (limits, quantity) = (self.limits, first.quantity);
        if !(limits[0] <= limits[1] && limits.iter().all(|limit| limit.is_finite())) {
            return Err(DifferenceError::Range { name, limits });
        }
        let free = first.limits.is_none() || second.limits.is_none();
        let found = JointDifference {
            name,
            coordinates: [one.0, other.0],
            legs: [one.1, other.1],
            quantity,
            limits,
            turns: quantity == Quantity::Angle && free,
        };
        let value = first.home - second.home;
        match found.admits(value) {
            true => Ok(found),
            false => Err(DifferenceError::Home { name: found.name, value, limits, quantity }),
        }
    }

    /// The quantity of both.
    ///
    /// # Errors
    /// As [`Mechanism::joint_differences`], but for limits.
    pub fn quantity(&self, mechanism: &Mechanism) -> Result<Quantity, DifferenceError> {
        Ok(self.coordinates(mechanism)?[0].2.quantity)
    }

    /// The number, the leg and the coordinate of both.
    fn coordinates<'m>(
        &self,
        mechanism: &'m Mechanism,
    ) -> Result<[(usize, usize, &'m JointCoordinate); 2], DifferenceError> {
        let legs = mechanism.legs.iter().enumerate();
        let all = legs.flat_map(|(leg, own)| own.coordinates().map(move |c| (leg, c)));
        let all: Vec<_> = all.enumerate().collect();
        let find = |name: &String| {
            let found = all.iter().find(|(_, (_, c))| c.name == *name);
            let found = found.map(|&(number, (leg, c))| (number, leg, c));
            found.ok_or_else(|| DifferenceError::Unknown { name: name.clone() })
        };
        let [one, other] = [find(&self.joints[0])?, find(&self.joints[1])?];
        if one.0 == other.0 {
            return Err(DifferenceError::Same { name: self.joints[0].clone() });
        }
        if one.2.quantity != other.2.quantity {
            return Err(DifferenceError::Quantities { joints: self.joints.clone() });
        }
        Ok([one, other])
    }
}

impl JointDifference {
    /// The difference at these values of all joint coordinates, radians or metres: within π of the middle of the limits where
    /// full turns do not count.
    pub fn value(&self, joints: &[f64]) -> f64 {
        let [one, other] = self.coordinates;
        self.placed(joints[one] - joints[other])
    }

    /// How far the difference is inside its limits at these values of all joint coordinates; negative beyond them.
    pub fn room(&self, joints: &[f64]) -> f64 {
        let [one, other] = self.coordinates;
        self.room_of(joints[one] - joints[other])
    }

    /// Whether these values of all joint coordinates are within its limits.
    pub fn allows(&self, joints: &[f64]) -> bool {
        self.room(joints) >= 0.0
    }

    fn placed(&self, value: f64) -> f64 {
        let middle = 0.5 * (self.limits[0] + self.limits[1]);
        if self.turns { near(value, middle) } else { value }
    }

    /// With the slack for rounding.
    fn room_of(&self, value: f64) -> f64 {
        let [low, high] = self.limits;
        let value = self.placed(value);
        (value - low).min(high - value) + self.slack()
    }

    fn admits(&self, value: f64) -> bool {
        self.room_of(value) >= 0.0
    }

    /// What counts as rounding at a limit.
    pub fn slack(&self) -> f64 {
        SLACK * self.limits[0].abs().max(self.limits[1].abs()).max(1.0)
    }
}
