//! How much actuators and links give way.

use opm_core::manipulator::Manipulator;

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
    /// A leg has a parallelogram, whose bars are stretched where it bears a moment.
    #[error(
        "{joint:?} is a parallelogram, whose two bars bear moments by forces along them: its stiffness is not modelled; \
         a single bar between two universal joints has one"
    )]
    Parallelogram {
        /// The name of its first hinge.
        joint: String,
    },
    /// A name is not that of an actuated joint.
    #[error("no actuated joint {name:?}, expected one of {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// The names of the actuated joints.
        known: Vec<String>,
    },
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
        if let Some(joint) = manipulator.mechanism().parallelograms().next() {
            return Err(SpringError::Parallelogram { joint: joint.name.clone() });
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
