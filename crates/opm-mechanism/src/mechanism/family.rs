//! Families: mechanisms given by the geometric parameters that the literature uses for them.
//!
//! A family only assembles its joints. Each leg is first laid out with all joints at zero.
//! Closed-form chains then find the joint values at home, and the joints are carried there. From
//! then on the result is a [`Mechanism`] like any other, and no later step depends on its origin.

mod assembly;
mod parameter;
pub mod planar_planar;
pub mod plano_spherical;
mod slider;
pub mod translational_helical;

pub use assembly::{AssemblyError, AssemblyProblem, AssemblyReason};
pub use parameter::{ParameterErrors, ParameterValue};
pub use planar_planar::PlanarPlanar;
pub use plano_spherical::PlanoSpherical;
pub use translational_helical::TranslationalHelical;

pub(in crate::mechanism) use parameter::{Group, JointTable, Parameter, ParameterRef, TableKey};

use super::Mechanism;
#[cfg(feature = "files")]
use super::file::Table;
#[cfg(feature = "files")]
use crate::chain::Branch;

/// Reads the parameters of a mechanism with this name and these signs of its working mode, and assembles
/// it.
#[cfg(feature = "files")]
type ReadFamily = fn(&Table<'_>, &str, &[Branch]) -> Option<(Family, Mechanism)>;

/// The form of the files of one family, by which they are read and their schema is made.
#[cfg(feature = "files")]
#[derive(Clone, Copy)]
pub(in crate::mechanism) struct FamilyForm {
    /// Reads the parameters and assembles the mechanism.
    pub read: ReadFamily,
    /// The keys of the file.
    pub keys: &'static [&'static str],
    /// The number of signs of each leg in the working mode.
    pub choices: &'static [usize],
    /// A family without values, with as many legs as the family has.
    #[cfg_attr(not(feature = "schema"), expect(dead_code, reason = "only the schema uses it"))]
    pub blank: fn() -> Family,
}

/// The forms of all families, with their names in files.
#[cfg(feature = "files")]
pub(in crate::mechanism) const FORMS: [(&str, FamilyForm); 3] = [
    ("plano-spherical", plano_spherical::FORM),
    ("translational-helical", translational_helical::FORM),
    ("planar-planar", planar_planar::FORM),
];

/// The parameters of a mechanism of one family.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is one family for each mechanism")]
pub enum Family {
    /// The 5-DoF plano-spherical manipulator, 3-PRR(RR) + RRS.
    PlanoSpherical(PlanoSpherical),
    /// The 3-DoF manipulator with a helical leg, 2-PPR + PPH.
    TranslationalHelical(TranslationalHelical),
    /// The 5-DoF manipulator of two planar subspaces, 3-PRR(RR) + RR(RRR).
    PlanarPlanar(PlanarPlanar),
}

impl Family {
    /// Assembles the mechanism at its home pose.
    ///
    /// # Errors
    /// [`AssemblyError`] lists every parameter that is out of its range and every leg that does not
    /// reach home.
    pub fn assemble(&self) -> Result<Mechanism, AssemblyError> {
        match self {
            Self::PlanoSpherical(family) => family.assemble(),
            Self::TranslationalHelical(family) => family.assemble(),
            Self::PlanarPlanar(family) => family.assemble(),
        }
    }

    /// The working mode of the home pose: one group of signs for each leg that has choices, and an
    /// empty text if no leg has any.
    pub fn mode(&self) -> String {
        match self {
            Self::PlanoSpherical(family) => family.mode(),
            Self::TranslationalHelical(_) => String::new(),
            Self::PlanarPlanar(family) => family.mode(),
        }
    }

    /// The mechanism's name.
    pub fn name(&self) -> &str {
        match self {
            Self::PlanoSpherical(family) => &family.name,
            Self::TranslationalHelical(family) => &family.name,
            Self::PlanarPlanar(family) => &family.name,
        }
    }

    /// The family's name in mechanism files, such as `plano-spherical`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::PlanoSpherical(_) => "plano-spherical",
            Self::TranslationalHelical(_) => "translational-helical",
            Self::PlanarPlanar(_) => "planar-planar",
        }
    }
}
