//! The closed forms of a manipulator as plain data, for programs that write them as code.

pub use super::dependent::OBEYED;
pub use super::dependent::form::{
    CheckForm, MirrorForm, Mirrored, RowForm, RowsForm, StemForm, StemPart, StepForm, StepKind,
    UPRIGHT, WholeStep,
};
pub use super::dependent::one_joint::SectionMotion;
use super::leg::{CompiledLeg, Section};
use super::section::CompiledSection;
use super::{Dependent, Manipulator};
use crate::chain::Chain;
use crate::chain::whole::WholeLeg;
use crate::group::LocalTwist;
use nalgebra::Matrix3;

/// How the pose of a manipulator gives its joints.
#[derive(Clone, Debug)]
pub struct ClosedForms {
    /// How dependent coordinates follow from the others, in the order of solution.
    pub steps: Vec<StepForm>,
    /// How they follow where legs that are solved whole constrain the platform; then there are no other steps.
    pub whole: Option<WholeStep>,
    /// Constraints that the platform obeys already, and that are only checked.
    pub checks: Vec<CheckForm>,
    /// The choices on which the dependent coordinates depend, as bits of a mode, ascending.
    pub step_bits: Vec<u32>,
    /// The numbers of the coordinates of a pose among all task coordinates.
    pub independent: Vec<usize>,
    /// The legs, in the order of the mechanism.
    pub legs: Vec<LegForm>,
    /// The inverse of the platform's orientation at home, which turns an orientation into a displacement from
    /// home; `None` for the identity.
    pub home_orientation_inverse: Option<Matrix3<f64>>,
    /// The height of a Schoenflies section; `None` where there is none.
    pub height: Option<HeightForm>,
    /// The size of the mechanism, with which lengths are compared, metres.
    pub size: f64,
}

/// The height of a Schoenflies section.
#[derive(Clone, Copy, Debug)]
pub struct HeightForm {
    /// The section.
    pub section: Section,
    /// The number of its task coordinate.
    pub coordinate: usize,
    /// What a unit of a leg's displacement along the intersection motion adds to the height of the leg's section.
    pub slope: f64,
}

/// One leg.
#[derive(Clone, Debug)]
pub struct LegForm {
    /// The section that is solved first.
    pub first: Section,
    /// Whether the subspaces share a motion, along which the leg has an imaginary joint. It belongs to the section that
    /// is solved first: it is the first joint of the upper chain, or the last of the lower one.
    pub bridged: bool,
    /// The number of the imaginary joint among those that are reported; `None` where it is not reported.
    pub imaginary: Option<usize>,
    /// Whether the imaginary joint rotates about an axis on which full revolutions are counted.
    pub unwinds: bool,
    /// The lower section.
    pub lower: SectionForm,
    /// The upper section.
    pub upper: SectionForm,
    /// The joint that carries the height of a Schoenflies section.
    pub lift: Option<LiftForm>,
    /// Its closed form, if it is solved whole. Then its sections only say what signs the choices have, and which coordinates
    /// are those of spherical joints.
    pub whole: Option<WholeForm>,
}

/// A leg that is solved whole.
#[derive(Clone, Debug)]
pub struct WholeForm {
    /// The closed form.
    pub leg: WholeLeg,
    /// The number of its first joint coordinate. The others follow in the order of the freedoms.
    pub first: usize,
}

/// One section of a leg.
#[derive(Clone, Debug)]
pub struct SectionForm {
    /// Its chain; where the section has fewer freedoms than its subspace has dimensions, completed by locked joints.
    pub chain: Chain,
    /// Which joints of the chain are locked; `None` for a whole chain.
    pub locked: Option<[bool; 3]>,
    /// The numbers of the joint coordinates of the chain's joints, base first; `None` for the imaginary joint, and for
    /// locked ones.
    pub coordinates: [Option<usize>; 3],
    /// The bit of its choice in a mode, if it has two solutions.
    pub bit: Option<u32>,
    /// The slider of the chain that is the part in the plane of an inclined imaginary joint, and its displacement for a
    /// unit of the imaginary joint's.
    pub slider: Option<(usize, f64)>,
}

/// The joint that carries the height of a Schoenflies section.
#[derive(Clone, Copy, Debug)]
pub struct LiftForm {
    /// The number of its joint coordinate.
    pub coordinate: usize,
    /// Its displacement for a unit of height.
    pub rate: f64,
    /// What it does in the plane, where it leans.
    pub lean: Option<LeanForm>,
}

/// The motion of a lift in the plane.
#[derive(Clone, Copy, Debug)]
pub struct LeanForm {
    /// The section.
    pub section: Section,
    /// The number of joints before the lift in the section's chain.
    pub before: usize,
    /// Its screw at home for a unit of height, in the plane's frame: the rotation, and the velocity of the point at the
    /// origin.
    pub screw: LocalTwist,
}

impl LegForm {
    /// A section.
    pub fn section(&self, section: Section) -> &SectionForm {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }

    /// The number of the imaginary joint in the chain of a section, if it belongs to it.
    pub fn imaginary_in(&self, section: Section) -> Option<usize> {
        (self.bridged && self.first == section).then(|| match section {
            Section::Upper => 0,
            Section::Lower => self.lower.chain.freedoms() - 1,
        })
    }
}

impl Manipulator {
    /// Its closed forms as plain data.
    pub fn closed_forms(&self) -> ClosedForms {
        let dependent = self.dependent.as_ref();
        ClosedForms {
            steps: dependent.map_or_else(Vec::new, Dependent::step_forms),
            whole: dependent.and_then(Dependent::whole_step),
            checks: dependent.map_or_else(Vec::new, |d| d.check_forms(&self.task, &self.legs)),
            step_bits: dependent.map_or_else(Vec::new, |d| d.bits().to_vec()),
            independent: match dependent {
                Some(dependent) => dependent.independent.clone(),
                None => (0..self.task.coordinates.len()).collect(),
            },
            legs: (0..self.legs.len()).map(|number| self.leg_form(number)).collect(),
            home_orientation_inverse: self.task.home_orientation_inverse().copied(),
            height: self.task.height.as_ref().map(|height| HeightForm {
                section: height.section,
                coordinate: height.coordinate,
                slope: height.slope,
            }),
            size: self.length,
        }
    }

    fn leg_form(&self, number: usize) -> LegForm {
        let leg: &CompiledLeg = &self.legs[number];
        let section = |section: Section| {
            let compiled: &CompiledSection = leg.section(section);
            SectionForm {
                chain: compiled.chain,
                locked: compiled.partial.map(|partial| partial.locked()),
                coordinates: compiled.coordinates.map(|coordinate| Some(coordinate?.number)),
                bit: self.modes.section_bit(number, section),
                slider: compiled.slider.map(|slider| (slider.joint, slider.rate)),
            }
        };
        LegForm {
            first: leg.split_section,
            bridged: leg.bridge().is_some(),
            imaginary: leg.imaginary,
            unwinds: leg.unwinds,
            lower: section(Section::Lower),
            upper: section(Section::Upper),
            whole: leg.whole.as_ref().map(|whole| {
                let before = &self.mechanism.legs[..number];
                let first = before.iter().map(|leg| leg.coordinates().count()).sum();
                WholeForm { leg: whole.leg.clone(), first }
            }),
            lift: leg.lift.as_ref().map(|lift| LiftForm {
                coordinate: lift.coordinate.number,
                rate: lift.rate,
                lean: leg.lean.as_ref().map(|lean| LeanForm {
                    section: lean.section,
                    before: lean.before,
                    screw: lean.screw,
                }),
            }),
        }
    }
}
