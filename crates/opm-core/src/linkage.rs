//! Linkages: single loops of two legs with one freedom, moved by one of their joints.
//!
//! Loops that divide into the loops of two sections are solved in closed form: see below. All others are traced: they move along
//! curves in the space of their joints, which steps along the tangent follow, corrected onto the equations of closure. The
//! positions with one revolute held are found, all of them, by continuation from a generic loop of the same kinds of joints
//! (Sommese and Wampler, "The numerical solution of systems of polynomials", 2005), and lie on all curves that there are.
//!
//! ## Two sections
//!
//! Input-output linkages by decomposition (Selvi, "Kinematic analysis of overconstrained manipulators with partial subspaces
//! using decomposition method", Robotica, on Bennett's double spherical 6R linkage of Fig. 1).
//!
//! Two legs form one loop, `L₁U₁ = L₂U₂`. The lower parts move in one subspace and the upper parts in
//! another one, and the two share a one-parameter group: a rotation or a translation. Then
//!
//! ```text
//! L₂⁻¹ L₁ = U₂ U₁⁻¹ = exp(I τ)
//! ```
//!
//! lies in both groups: it is the displacement of an imaginary joint. The loop divides into the
//! [loops](SectionLoop) of the two sections, which share this joint,
//! ```text
//! exp(-I τ) · L₂⁻¹ L₁ = 1      exp(-I τ) · U₂ U₁⁻¹ = 1
//! ```
//!
//! Each has one joint more than its subspace has dimensions, so it is a four-bar, a slider-crank or
//! another loop with one freedom:
//!
//! * Bennett's linkage consists of two spherical four-bars that share a revolute joint;
//! * Sarrus' linkage consists of two planar slider-cranks that share the slider: the platform moves
//!   along the line in which the two planes meet;
//! * a planar four-bar or slider-crank and a spherical four-bar share a revolute joint along the
//!   plane's normal through the centre;
//! * coaxial joints and a planar loop share a rotation, if the axis is perpendicular to the plane, or a
//!   translation, if it lies in the plane.
//!
//! The loop with the input joint determines `τ`, and `τ` determines the other one. Most loops have a
//! two-valued choice, so an input has up to four positions. Where a product passes a joint from its
//! platform side to its base side, the joint's axis is reversed, so that its displacement is always
//! the reported one.
//!
//! ```
//! use opm_core::linkage::Linkage;
//! use opm_core::mechanism::{examples, file};
//!
//! let text = examples::find("bennett-double-spherical-6r").unwrap().text;
//! let linkage = Linkage::new(&file::read(text)?.mechanism)?;
//! let crank = linkage.input("a1").unwrap();
//! assert!(crank.range().is_full_turn());
//! for position in crank.solve(30_f64.to_radians()) {
//!     println!("{}: {:?}, tau = {:?}", position.branch, position.joints, position.imaginary);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cycle;
mod input;
mod range;
mod sections;
mod traced;

pub use cycle::{Cycle, NoCycle};
pub use input::{Input, LinkageBranch, Position, Rates};
pub use range::InputRange;
pub use sections::{DeadPoint, DrivenLoop, SectionLoop, SectionSigns};
pub use traced::Stuck;

use crate::chain::limits::Limits;
use crate::decomposition::mobility::{frame, mobility};
use crate::decomposition::{DecomposeError, Decomposition, decompose};
use crate::group::JointDisplacement;
use crate::manipulator::ImaginaryJoint;
use crate::mechanism::joint::JointCoordinate;
use crate::mechanism::{DifferenceError, JointDifference, Mechanism};
use crate::task::TaskError;
use sections::Sections;
use traced::Traced;

/// Why a mechanism is not a linkage that this module can solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkageError {
    /// Not one loop.
    #[error("the mechanism has {0} legs, expected two, which form one loop")]
    Legs(usize),
    /// Legs, joints or motors are missing, or numbers are not finite.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// The loop has no freedom, or more than one.
    #[error("the loop cannot be moved by one joint: {0}")]
    Stuck(#[from] Stuck),
    /// The home value of a task coordinate is given that the mechanism does not have.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// Two joints have no difference, or it excludes home.
    #[error(transparent)]
    Difference(#[from] DifferenceError),
}

/// A single-loop linkage. It is immutable and can be shared between threads. See the example in the docs of
/// [`linkage`](crate::linkage).
#[derive(Clone, Debug)]
pub struct Linkage {
    mechanism: Mechanism,
    joints: Joints,
    solver: Solver,
}

/// The joints of a linkage.
#[derive(Clone, Debug)]
struct Joints {
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    differences: Vec<JointDifference>,
    /// The mechanism's size, metres.
    size: f64,
}

impl Joints {
    fn new(mechanism: &Mechanism) -> Result<Self, DifferenceError> {
        let coordinates: Vec<_> = mechanism.coordinates().cloned().collect();
        let size = frame(mechanism).length;
        let limits = coordinates.iter().map(|c| c.displacement_limits(size)).collect();
        let differences = mechanism.joint_differences()?;
        Ok(Self { coordinates, limits, differences, size })
    }

    /// Whether the differences of joints with limits are within them.
    fn differences_allow(&self, joints: &[f64]) -> bool {
        self.differences.iter().all(|difference| difference.allows(joints))
    }

    fn home(&self) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.home).collect()
    }

    /// The value of a coordinate for its displacement, near `held` if that is given, and whether it is within limits.
    fn value(&self, i: usize, displacement: JointDisplacement, held: Option<f64>) -> (f64, bool) {
        let home = self.coordinates[i].home;
        let (value, within) = self.limits[i].place(displacement, held.map(|held| held - home));
        (home + value, within)
    }
}

/// How positions are found.
#[derive(Clone, Debug)]
enum Solver {
    Sections(Box<Sections>),
    Traced(Box<Traced>),
}

impl Linkage {
    /// Prepares a loop: with the first of its decompositions into the loops of two sections, or, where there is none, traced.
    ///
    /// # Errors
    /// [`LinkageError`] if the mechanism is no loop of two legs with one freedom.
    pub fn new(mechanism: &Mechanism) -> Result<Self, LinkageError> {
        if mechanism.legs.len() != 2 {
            return Err(LinkageError::Legs(mechanism.legs.len()));
        }
        let ways = match decompose(mechanism) {
            Ok(ways) => ways,
            Err(
                DecomposeError::NoPartialSubspaces { .. }
                | DecomposeError::SingularHome { .. }
                | DecomposeError::Loose { .. },
            ) => Vec::new(),
            Err(error) => return Err(error.into()),
        };
        for way in ways {
            if let Some(sections) = Sections::new(mechanism, way)? {
                return Self::with(mechanism, Solver::Sections(Box::new(sections)));
            }
        }
        Self::traced(mechanism)
    }

    /// Traces a loop, whatever its joints.
    ///
    /// # Errors
    /// [`LinkageError`] if the mechanism is no loop of two legs with one freedom.
    pub fn traced(mechanism: &Mechanism) -> Result<Self, LinkageError> {
        if mechanism.legs.len() != 2 {
            return Err(LinkageError::Legs(mechanism.legs.len()));
        }
        // Says what is wrong with the joints first.
        mobility(mechanism).map_err(DecomposeError::from)?;
        Self::with(mechanism, Solver::Traced(Box::new(Traced::new(mechanism)?)))
    }

    fn with(mechanism: &Mechanism, solver: Solver) -> Result<Self, LinkageError> {
        let joints = Joints::new(mechanism)?;
        Ok(Self { mechanism: mechanism.clone(), joints, solver })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The decomposition into two sections; `None` of a loop that is traced.
    pub fn decomposition(&self) -> Option<&Decomposition> {
        match &self.solver {
            Solver::Sections(sections) => Some(&sections.decomposition),
            Solver::Traced(_) => None,
        }
    }

    /// Every joint coordinate, leg by leg. [`Position::joints`] has this order.
    pub fn coordinates(&self) -> &[JointCoordinate] {
        &self.joints.coordinates
    }

    /// The limits of every joint coordinate, in the order of [`Linkage::coordinates`].
    pub fn limits(&self) -> &[Limits] {
        &self.joints.limits
    }

    /// The imaginary joint: one that two sections share, none of a loop that is traced.
    pub fn imaginary(&self) -> &[ImaginaryJoint] {
        match &self.solver {
            Solver::Sections(sections) => std::slice::from_ref(&sections.imaginary),
            Solver::Traced(_) => &[],
        }
    }

    /// Whether one leg is the whole lower section and the other leg the whole upper one. The platform
    /// then moves as the imaginary joint does: along or about the intersection motion (Sarrus' linkage).
    pub fn platform_is_imaginary(&self) -> bool {
        match &self.solver {
            Solver::Sections(sections) => sections.platform_is_imaginary(),
            Solver::Traced(_) => false,
        }
    }

    /// Of a loop that is traced, the number of its assemblies with the first revolute held, complex ones included: so many were
    /// looked for. `None` where only the motion through home is known: of a loop with helical joints, or more than seven freedoms.
    pub fn assemblies(&self) -> Option<usize> {
        match &self.solver {
            Solver::Sections(_) => None,
            Solver::Traced(traced) => traced.solutions(),
        }
    }

    /// Whether positions are those of traced curves.
    pub fn is_traced(&self) -> bool {
        matches!(self.solver, Solver::Traced(_))
    }

    /// The linkage driven by the joint coordinate with this name; `None` if there is none, or if it cannot move the others: a
    /// coordinate of a ball, or a joint that stands still.
    pub fn input(&self, name: &str) -> Option<Input<'_>> {
        let coordinate = self.coordinates().iter().position(|c| c.name == name)?;
        Input::new(self, coordinate)
    }

    /// The names of the joints that can move the linkage.
    pub fn inputs(&self) -> impl Iterator<Item = &str> {
        let moves = |&i: &usize| Input::new(self, i).is_some();
        (0..self.coordinates().len()).filter(moves).map(|i| &*self.coordinates()[i].name)
    }
}
