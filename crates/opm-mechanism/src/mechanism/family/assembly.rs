//! Placing a family's joints at home, and the problems that can occur.

use crate::chain::{ChainError, ReachDeficit};
use crate::group::JointDisplacement;
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::Joint;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use nalgebra::Isometry3;
use std::f64::consts::PI;
use std::fmt;

/// Tolerance for limits at home, metres or radians. Home values are computed, so a joint that is
/// meant to be on a limit may be this far outside and still counts as inside.
const ON_LIMIT: f64 = 1e-12;

/// Why a set of parameters does not assemble: a list of all problems, at least one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.describe())]
#[non_exhaustive]
pub struct AssemblyError {
    /// The problems, in the order of the legs.
    pub problems: Vec<AssemblyProblem>,
}

impl AssemblyError {
    fn describe(&self) -> String {
        self.problems.iter().map(AssemblyProblem::to_string).collect::<Vec<_>>().join("; ")
    }
}

/// One problem of a parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyProblem {
    /// The index of the leg in [`Mechanism::legs`](crate::mechanism::Mechanism::legs); `None` if
    /// the problem is with home or with the mechanism as a whole.
    pub leg: Option<usize>,
    /// The parameter that causes the problem, as files write it; `None` if it is the leg as a
    /// whole.
    pub parameter: Option<&'static str>,
    /// What is wrong.
    pub reason: AssemblyReason,
}

impl AssemblyProblem {
    /// Describes the problem with its numbers in the units of a file, without its location.
    pub fn describe(&self, units: FileUnits) -> String {
        let reason = self.reason.describe(units);
        match self.parameter {
            Some(parameter) => format!("`{parameter}` {reason}"),
            None => reason,
        }
    }
}

impl fmt::Display for AssemblyProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(leg) = self.leg {
            write!(f, "leg {}: ", leg + 1)?;
        }
        f.write_str(&self.describe(FileUnits::SI))
    }
}

/// What is wrong with a parameter or with a leg. Values are in SI units.
#[derive(Clone, Debug, PartialEq)]
pub enum AssemblyReason {
    /// The parameter is NaN or infinite.
    NotFinite,
    /// A length must be positive and is not; its value in metres.
    NotPositive(f64),
    /// A length must not be negative and is; its value in metres.
    Negative(f64),
    /// An arc must be above zero and below π and is not; its value in radians.
    NotAnArc(f64),
    /// A helical joint has no advance, so that it would be revolute.
    NoPitch,
    /// The number of legs of a kind is not the family's.
    LegCount {
        /// The number of legs found.
        found: usize,
        /// The number of legs that the family has.
        expected: usize,
    },
    /// No leg has a pitch, where exactly one leg must be helical.
    NoHelicalLeg,
    /// Several legs have a pitch, where exactly one leg must be helical; their number.
    HelicalLegs(usize),
    /// The leg's direction differs from the first leg's, where all legs must have the same one.
    Direction {
        /// Direction of this leg, radians.
        angle: f64,
        /// Direction of the first leg, radians.
        expected: f64,
    },
    /// Two legs have the same name.
    SameName(String),
    /// The joints of the leg are linearly dependent in every pose.
    Degenerate(ChainError),
    /// The leg does not reach its end position at home.
    OutOfReach {
        /// The links that are too short or too long.
        links: &'static str,
        /// The reach deficit: by how much the leg misses.
        deficit: ReachDeficit,
    },
    /// The value of a joint at home is outside its limits.
    OutsideLimits {
        /// The joint's name.
        joint: String,
        /// The joint's value at home.
        home: f64,
        /// The joint's lowest and highest value.
        limits: [f64; 2],
        /// Whether these values are angles or lengths.
        quantity: Quantity,
    },
}

impl AssemblyReason {
    fn describe(&self, units: FileUnits) -> String {
        use Quantity::{Angle, Length};
        match self {
            Self::NotFinite => "is not a finite number".into(),
            Self::NotPositive(value) => {
                format!("is {}, expected a length above 0", units.show(*value, Length))
            }
            Self::Negative(value) => {
                format!("is {}, expected a length of at least 0", units.show(*value, Length))
            }
            Self::NotAnArc(value) => format!(
                "is {}, expected an arc between 0 and {}",
                units.show(*value, Angle),
                units.show(PI, Angle)
            ),
            Self::NoPitch => "is 0, expected an advance per radian: a helical joint".into(),
            Self::LegCount { found, expected } => {
                let legs = if *found == 1 { "leg" } else { "legs" };
                format!("gives {found} {legs}, expected {expected}")
            }
            Self::NoHelicalLeg => {
                "has no `pitch`, expected it for exactly one leg, the helical one".into()
            }
            Self::HelicalLegs(count) => {
                format!("is given for {count} legs, expected it for exactly one, the helical leg")
            }
            Self::Direction { angle, expected } => format!(
                "gives the direction alpha + beta = {}, expected {}, as for the first leg: it is \
                 the common axis",
                units.show(*angle, Angle),
                units.show(*expected, Angle)
            ),
            Self::SameName(name) => {
                format!("is {name:?} for two legs, expected different names")
            }
            Self::Degenerate(error) => {
                format!("the joints of the leg are linearly dependent: {error}")
            }
            Self::OutOfReach { links, deficit } => format!(
                "home is out of this leg's reach by {}, expected {links} that reach it",
                units.show(deficit.excess, deficit.quantity)
            ),
            Self::OutsideLimits { joint, home, limits: [low, high], quantity } => format!(
                "exclude home: {joint} is {} there, expected it between {} and {}",
                units.show(*home, *quantity),
                units.show(*low, *quantity),
                units.show(*high, *quantity)
            ),
        }
    }
}

/// Collects the problems of one leg, or of home.
#[derive(Default)]
pub(super) struct Problems(Vec<(Option<&'static str>, AssemblyReason)>);

impl Problems {
    pub(super) fn add(&mut self, parameter: Option<&'static str>, reason: AssemblyReason) {
        self.0.push((parameter, reason));
    }

    /// Adds a problem if the number of legs of a kind is not the family's.
    pub(super) fn leg_count(&mut self, kind: &'static str, found: usize, expected: usize) {
        if found != expected {
            self.add(Some(kind), AssemblyReason::LegCount { found, expected });
        }
    }

    pub(super) fn finite(&mut self, parameters: &[(&'static str, f64)]) {
        self.check(parameters, |_| None);
    }

    pub(super) fn positive(&mut self, parameters: &[(&'static str, f64)]) {
        self.check(parameters, |v| (v <= 0.0).then_some(AssemblyReason::NotPositive(v)));
    }

    pub(super) fn not_negative(&mut self, parameters: &[(&'static str, f64)]) {
        self.check(parameters, |v| (v < 0.0).then_some(AssemblyReason::Negative(v)));
    }

    pub(super) fn arcs(&mut self, parameters: &[(&'static str, f64)]) {
        self.check(parameters, |v| (v <= 0.0 || v >= PI).then_some(AssemblyReason::NotAnArc(v)));
    }

    fn check(
        &mut self,
        parameters: &[(&'static str, f64)],
        wrong: impl Fn(f64) -> Option<AssemblyReason>,
    ) {
        for &(parameter, value) in parameters {
            let reason =
                if value.is_finite() { wrong(value) } else { Some(AssemblyReason::NotFinite) };
            if let Some(reason) = reason {
                self.add(Some(parameter), reason);
            }
        }
    }

    pub(super) fn none(self) -> Result<(), Self> {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }

    pub(super) fn of(self, leg: Option<usize>) -> impl Iterator<Item = AssemblyProblem> {
        self.0.into_iter().map(move |(parameter, reason)| AssemblyProblem {
            leg,
            parameter,
            reason,
        })
    }
}

impl From<ChainError> for Problems {
    fn from(error: ChainError) -> Self {
        Self(vec![(None, AssemblyReason::Degenerate(error))])
    }
}

/// Makes the problem of a leg that does not reach, given the links concerned.
pub(super) fn out_of_reach(links: &'static str) -> impl Fn(ReachDeficit) -> Problems {
    move |deficit| Problems(vec![(None, AssemblyReason::OutOfReach { links, deficit })])
}

/// Assembles all legs, or collects every problem of the legs and of home. Each leg comes with its
/// name, because its name is needed even if it does not assemble.
pub(super) fn all_legs<'a>(
    home: Problems,
    legs: impl IntoIterator<Item = (&'a str, Result<Leg, Problems>)>,
) -> Result<Vec<Leg>, AssemblyError> {
    let mut problems: Vec<_> = home.of(None).collect();
    let mut assembled = Vec::new();
    let mut names = Vec::new();
    for (index, (name, leg)) in legs.into_iter().enumerate() {
        let mut wrong = Problems::default();
        if names.contains(&name) {
            wrong.add(Some("name"), AssemblyReason::SameName(name.to_owned()));
        }
        names.push(name);
        match leg {
            Ok(leg) => assembled.push(leg),
            Err(others) => wrong.0.extend(others.0),
        }
        problems.extend(wrong.of(Some(index)));
    }
    if problems.is_empty() { Ok(assembled) } else { Err(AssemblyError { problems }) }
}

/// Carries one-degree-of-freedom joints, from base to platform, from the layout where every joint
/// is zero to the given values. Each joint moves with the joints before it (product of
/// exponentials). An angle is reported in `(-π, π]`, or within the joint's limits if it has some; then the joint's offset,
/// which is its value in the layout, is added.
pub(super) fn carried(
    reference: impl IntoIterator<Item = (Joint, JointDisplacement)>,
) -> Result<Vec<Joint>, Problems> {
    let mut g = Isometry3::identity();
    let mut joints = Vec::new();
    let mut problems = Problems::default();
    for (mut joint, displacement) in reference {
        let coordinate = &mut joint.coordinates[0];
        let offset = coordinate.home;
        let from_zero = coordinate.limits.map(|limits| limits.map(|limit| limit - offset));
        let home = home_value(displacement, from_zero) + offset;
        if let Some(limits @ [low, high]) = coordinate.limits
            && !(low - ON_LIMIT..=high + ON_LIMIT).contains(&home)
        {
            let (joint, quantity) = (coordinate.name.clone(), coordinate.quantity);
            let reason = AssemblyReason::OutsideLimits { joint, home, limits, quantity };
            problems.add(Some("limits"), reason);
        }
        let own = joint.moved_to(&[home]);
        joint.coordinates[0].home = home;
        joint.axis = g.rotation * joint.axis;
        joint.point = g * joint.point;
        joints.push(joint);
        g *= own;
    }
    problems.none().map(|()| joints)
}

fn home_value(displacement: JointDisplacement, limits: Option<[f64; 2]>) -> f64 {
    match (displacement, limits) {
        (JointDisplacement::Direction(_), Some([low, high])) => {
            displacement.nearest((low + high) / 2.0)
        }
        // atan2 gives -π for a rotation of -1 with a negative zero.
        _ if matches!(displacement, JointDisplacement::Direction(_))
            && displacement.value() <= -PI =>
        {
            PI
        }
        _ => displacement.value(),
    }
}
