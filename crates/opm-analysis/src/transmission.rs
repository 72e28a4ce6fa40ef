//! Transmission indices: how well motion and force pass from the actuators to the platform.
//!
//! J. Wang, C. Wu, X.-J. Liu, *Performance evaluation of parallel manipulators: motion/force transmissibility and its
//! index*, Mechanism and Machine Theory 45 (2010). An input of a section, which is an actuated joint or an imaginary
//! joint of the upper section, acts on the section through its *transmission wrench*: the wrench that is reciprocal to
//! all other joints of the leg's section. In a subspace of the section's dimension there is one, up to a factor.
//!
//! * The input index compares the power of that wrench on the input's own twist with the most that it could be.
//! * The output index does so for the twist of the leg's last link while all other inputs are locked.
//! * The local index is the least of both, over all inputs.
//!
//! *The most that it could be* is the power of a wrench of the same strength through the same *characteristic point*, in
//! the best direction. With a force `f` at the point `C`, which moves with the velocity `v`, that makes both indices the
//! cosine of the pressure angle, `|f · v| / (|f| |v|)`. The characteristic point is a joint on the wrench's axis: for the
//! input index the joint next to the input in the chain (that on the platform's side, if both are), for the output index
//! the joint next to the platform. In a spherical section the point is anywhere on the axis of that joint; in a
//! translational section, and for a couple in a plane, no point is needed.

mod section;

use crate::screws::Screws;
use nalgebra::{Isometry3, Vector3};
use opm_core::group::screw::Screw;
use opm_core::group::{Subspace, SubspaceKind};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::leg::Section;
use section::Mechanism;

/// A determinant, or a length over the characteristic length, below this counts as zero: rounding.
const ZERO: f64 = 1e-12;

/// A twist or a wrench in the subspace of a section, lengths over the characteristic length. In a plane: the rotation
/// about the normal, then the velocity of the frame's origin.
type Local = Vector3<f64>;

/// The indices of one input of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputIndices {
    /// The number of its leg.
    pub leg: usize,
    /// Its section.
    pub section: Section,
    /// The number of its joint coordinate; `None` for the leg's imaginary joint, which is an input of the upper section.
    pub coordinate: Option<usize>,
    /// The input transmission index, 0 to 1.
    pub input: f64,
    /// The output transmission index, 0 to 1.
    pub output: f64,
}

/// The least indices of the inputs of a section, or of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// The least input transmission index.
    pub input: f64,
    /// The least output transmission index.
    pub output: f64,
}

impl Transmission {
    /// The local transmission index: the least of both.
    pub fn local(&self) -> f64 {
        self.input.min(self.output)
    }

    fn least(self, other: Self) -> Self {
        Self { input: self.input.min(other.input), output: self.output.min(other.output) }
    }
}

/// Why a manipulator has no transmission indices.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoTransmission {
    /// A section has another number of inputs than freedoms.
    #[error(
        "the {section} section needs an input for each freedom; freedoms: {freedoms}, inputs: {inputs}"
    )]
    Inputs {
        /// The section.
        section: Section,
        /// The number of its inputs.
        inputs: usize,
        /// The number of its freedoms.
        freedoms: usize,
    },
    /// A leg with an input constrains the platform, so that its transmission wrench is not unique.
    #[error(
        "leg {leg} constrains the platform in its {section} section, so that its transmission wrench is not unique"
    )]
    Constrains {
        /// The name of the leg.
        leg: String,
        /// The section.
        section: Section,
    },
    /// A leg moves along the intersection motion in its lower section, and its upper section has an input.
    #[error("leg {leg} has inputs in both sections, which share the intersection motion")]
    Shared {
        /// The name of the leg.
        leg: String,
    },
    /// A joint changes the height of its section, and moves in the plane too.
    #[error(
        "joint {joint} raises its section and moves in its plane; such a section has no transmission indices"
    )]
    Leans {
        /// The name of the joint.
        joint: String,
    },
    /// The intersection motion changes the height of a section.
    #[error(
        "the intersection motion raises the {section} section; such a section has no transmission indices"
    )]
    Inclined {
        /// The section.
        section: Section,
    },
}

/// Transmission indices at poses. The buffer is filled by [`Transmissions::update`], which allocates nothing.
///
/// ```
/// use opm_analysis::Transmissions;
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let mut transmissions = Transmissions::new(&manipulator)?;
/// let mut buffer = manipulator.solution();
/// let home = manipulator.home_pose();
/// let at = manipulator.inverse(&home, manipulator.home_mode(), &mut buffer)?;
/// transmissions.update(at.expect("home is in reach"));
/// let whole = transmissions.whole();
/// assert!(whole.local() > 0.0 && whole.input <= 1.0 && whole.output <= 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Transmissions<'a> {
    manipulator: &'a Manipulator,
    length: f64,
    screws: Screws,
    sections: Vec<Mechanism>,
    found: Vec<InputIndices>,
}

impl<'a> Transmissions<'a> {
    /// A buffer for a manipulator.
    ///
    /// # Errors
    /// Why the manipulator has no such indices.
    pub fn new(manipulator: &'a Manipulator) -> Result<Self, NoTransmission> {
        if let Some(joint) = manipulator.leaning_joints().next() {
            return Err(NoTransmission::Leans { joint: joint.to_owned() });
        }
        let mut sections = Vec::new();
        for section in [Section::Lower, Section::Upper] {
            sections.extend(Mechanism::new(manipulator, section)?);
        }
        Ok(Self {
            manipulator,
            length: manipulator.characteristic_length(),
            screws: Screws::new(manipulator),
            found: Vec::with_capacity(sections.iter().map(|section| section.inputs).sum()),
            sections,
        })
    }

    /// Computes the indices at a solved pose that is in reach.
    pub fn update(&mut self, at: &Solution) {
        self.screws.update(at);
        self.found.clear();
        let task = self.manipulator.task();
        let v = at.lower_displacement(self.manipulator);
        let along = task.intersection.as_ref().map(|axis| match axis.point {
            Some(point) => Screw::rotation(axis.direction, point),
            None => Screw::translation(axis.direction),
        });
        for section in &mut self.sections {
            // The lower section is seen from the base, the upper one from the frame that moves with the lower.
            let (subspace, to_frame, along) = match section.section {
                Section::Lower => {
                    (&task.lower, Isometry3::identity(), along.map(|screw| screw.transformed(&v)))
                }
                Section::Upper => (&task.upper, v.inverse(), along),
            };
            let view = View { subspace, to_frame, length: self.length };
            section.place(&self.screws, &view, along.map(|screw| view.in_frame(&screw)));
            section.indices(&mut self.found);
        }
    }

    /// The indices of every input, those of the lower section first, leg by leg.
    pub fn inputs(&self) -> &[InputIndices] {
        &self.found
    }

    /// The least indices of a section; `None` if it has no inputs.
    pub fn section(&self, section: Section) -> Option<Transmission> {
        let own = self.found.iter().filter(|found| found.section == section);
        own.map(|found| Transmission { input: found.input, output: found.output })
            .reduce(Transmission::least)
    }

    /// The least indices of all inputs of both sections.
    pub fn whole(&self) -> Transmission {
        let all = self.found.iter();
        all.map(|found| Transmission { input: found.input, output: found.output })
            .fold(Transmission { input: 1.0, output: 1.0 }, Transmission::least)
    }
}

/// The frame of a section, and its unit of length.
struct View<'a> {
    subspace: &'a Subspace,
    /// From base coordinates to those in which the section's frame is at home.
    to_frame: Isometry3<f64>,
    length: f64,
}

impl View<'_> {
    /// A screw in base coordinates as a twist of the subspace.
    fn of(&self, screw: &Screw) -> Local {
        self.in_frame(&screw.transformed(&self.to_frame))
    }

    /// The same for a screw that is in the frame's coordinates.
    fn in_frame(&self, screw: &Screw) -> Local {
        let origin = self.subspace.origin.coords;
        let angular = self.subspace.direction(&screw.angular);
        let linear = screw.linear + screw.angular.cross(&origin);
        let linear = self.subspace.direction(&linear) / self.length;
        match self.subspace.kind {
            SubspaceKind::Identity => Local::zeros(),
            SubspaceKind::Planar => Local::new(angular.z, linear.x, linear.y),
            SubspaceKind::Spherical => angular,
            SubspaceKind::Cylindrical => Local::new(angular.z, linear.z, 0.0),
            SubspaceKind::TranslationalPlane => Local::new(linear.x, linear.y, 0.0),
            SubspaceKind::TranslationalSpace => linear,
        }
    }
}
