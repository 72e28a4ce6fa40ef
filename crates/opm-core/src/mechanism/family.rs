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

pub(in crate::mechanism) use parameter::{Group, Parameter, ParameterRef, TableKey};

use super::Mechanism;

/// The parameters of a mechanism of one family.
#[derive(Clone, Debug, PartialEq)]
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
