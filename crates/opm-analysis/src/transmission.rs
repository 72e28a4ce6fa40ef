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
//!
//! A leg with fewer joints in a section than the section's dimension constrains it: `d − m` wrenches are reciprocal to all of
//! its joints. X.-J. Liu, X. Chen, M. Nahon, *Motion/force constrainability analysis of lower-mobility parallel
//! manipulators*, J. Mechanisms Robotics 6 (2014), and X. Chen, X.-J. Liu, F. Xie, *Screw theory based singularity analysis of
//! lower-mobility parallel robots considering the motion/force transmissibility and constrainability*, Mathematical Problems
//! in Engineering (2015): while all inputs are locked and one constraint is released, the platform has one twist, and the
//! *output constraint index* is the cosine of the pressure angle between the constraint wrench and that twist. Legs that
//! repeat the constraint of another are one group, which is released together. The wrench of an input in such a leg is
//! determined up to the leg's constraints; of these, it is the one that is perpendicular to them at the joint on its axis.
//!
//! If such a leg has one input and the only other leg with inputs has the other, as in a five-bar, the platform is a link
//! between both. Then both legs are seen alike: they meet at the passive joint of the other leg that is next to the
//! platform, and the wrench of the input passes through it (X.-J. Liu, J. Wang, G. Pritschow, *Performance atlases and
//! optimum design of planar 5R symmetrical parallel mechanisms*, Mechanism and Machine Theory 41 (2006); Wang, Wu, Liu
//! 2010). That joint is the characteristic point of the output index.
//!
//! Where the legs' constraints tie both sections together (dependent coordinates: 2-UPR-RPU, Sarrus' linkage), no section has an
//! input for each freedom. Then legs are taken whole, in space, and the same definitions hold with the platform's twist while
//! all other inputs are locked. The wrench of an input is determined up to the leg's constraints; it is the one that is
//! perpendicular to them at the point in which most of the leg's passive axes meet. In these mechanisms that is the force along
//! the leg.

mod section;
mod whole;

use crate::screws::Screws;
use nalgebra::{Isometry3, Vector3};
use opm_core::group::screw::Screw;
use opm_core::group::{Subspace, SubspaceKind};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::leg::Section;
use section::Mechanism;
use whole::Whole;

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

/// The index of the constraint of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstraintIndex<'a> {
    /// The numbers of the legs that constrain it, all in the same way.
    pub legs: &'a [usize],
    /// The section.
    pub section: Section,
    /// The output constraint index, 0 to 1; `None` if the legs impose more than one constraint.
    pub output: Option<f64>,
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
    /// A mechanism whose legs are solved whole has another number of inputs than freedoms.
    #[error("indices need an input for each freedom; freedoms: {freedoms}, inputs: {inputs}")]
    WholeInputs {
        /// The number of inputs.
        inputs: usize,
        /// The number of freedoms of the platform.
        freedoms: usize,
    },
    /// No leg constrains the platform within its section.
    #[error(
        "no leg constrains the platform within the motions of its section, so that no constraint can be released"
    )]
    NoConstraint,
    /// The legs' constraints tie both sections together.
    #[error(
        "the legs' constraints tie both sections together; only a constraint within a section has an index"
    )]
    Together,
    /// A leg imposes several constraints at once.
    #[error(
        "leg {leg} lacks {lacks} freedoms in its {section} section; only a single constraint has an index"
    )]
    Constraints {
        /// The name of the leg.
        leg: String,
        /// The section.
        section: Section,
        /// How many freedoms it lacks.
        lacks: usize,
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
    /// All inputs, where the sections have none of their own.
    whole: Option<Whole>,
    found: Vec<InputIndices>,
    /// The output constraint index of each section.
    constraints: Vec<f64>,
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
        let mut whole = None;
        if manipulator.is_whole() {
            let (inputs, freedoms) =
                (manipulator.actuated().len(), manipulator.task_coordinates().len());
            let refused = NoTransmission::WholeInputs { inputs, freedoms };
            whole = Some(Whole::new(manipulator).ok_or(refused)?);
        }
        let sections_of: &[Section] = match whole {
            None => &[Section::Lower, Section::Upper],
            Some(_) => &[],
        };
        for &section in sections_of {
            match Mechanism::new(manipulator, section) {
                Ok(found) => sections.extend(found),
                Err(why) => whole = Some(Whole::new(manipulator).ok_or(why)?),
            }
        }
        if whole.is_some() {
            sections.clear();
        }
        Ok(Self {
            manipulator,
            whole,
            length: manipulator.characteristic_length(),
            screws: Screws::new(manipulator),
            found: Vec::with_capacity(manipulator.actuated().len() + manipulator.imaginary().len()),
            constraints: vec![f64::NAN; sections.len()],
            sections,
        })
    }

    /// Whether there is an output constraint index.
    ///
    /// # Errors
    /// No leg constrains the platform within its section, or one does so in several ways.
    pub fn has_constraints(&self) -> Result<(), NoTransmission> {
        if self.manipulator.is_whole() {
            return Err(NoTransmission::NoConstraint);
        }
        if self.whole.is_some() {
            return Err(NoTransmission::Together);
        }
        let mut any = false;
        for section in self.sections.iter().filter(|section| section.lacks > 0) {
            if section.lacks > 1 {
                let leg = self.manipulator.mechanism().legs[section.constraining[0]].name.clone();
                let (section, lacks) = (section.section, section.lacks);
                return Err(NoTransmission::Constraints { leg, section, lacks });
            }
            any = true;
        }
        if any { Ok(()) } else { Err(NoTransmission::NoConstraint) }
    }

    /// Computes the indices at a solved pose that is in reach.
    pub fn update(&mut self, at: &Solution) {
        self.screws.update(at);
        self.found.clear();
        if let Some(whole) = &mut self.whole {
            whole.indices((self.manipulator, at), &self.screws, &mut self.found);
            return;
        }
        let task = self.manipulator.task();
        let v = at.lower_displacement(self.manipulator);
        let along = task.intersection.as_ref().map(|axis| match axis.point {
            Some(point) => Screw::rotation(axis.direction, point),
            None => Screw::translation(axis.direction),
        });
        for (section, constraint) in self.sections.iter_mut().zip(&mut self.constraints) {
            // The lower section is seen from the base, the upper one from the frame that moves with the lower.
            let (subspace, to_frame, along) = match section.section {
                Section::Lower => {
                    (&task.lower, Isometry3::identity(), along.map(|screw| screw.transformed(&v)))
                }
                Section::Upper => (&task.upper, v.inverse(), along),
            };
            let view = View { subspace, to_frame, length: self.length };
            section.place(&self.screws, &view, along.map(|screw| view.in_frame(&screw)));
            *constraint = section.indices(&mut self.found);
        }
    }

    /// The constraints of the sections that legs constrain, that of the lower section first.
    pub fn constraints(&self) -> impl Iterator<Item = ConstraintIndex<'_>> {
        let each = self.sections.iter().zip(&self.constraints).filter(|(own, _)| own.lacks > 0);
        each.map(|(own, &output)| ConstraintIndex {
            legs: &own.constraining,
            section: own.section,
            output: (own.lacks == 1).then_some(output),
        })
    }

    /// The least output constraint index of both sections; `None` as for [`Transmissions::has_constraints`].
    pub fn constraint(&self) -> Option<f64> {
        let least = |all: Option<f64>, next: ConstraintIndex<'_>| Some(all?.min(next.output?));
        self.has_constraints().ok()?;
        self.constraints().fold(Some(1.0), least)
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
