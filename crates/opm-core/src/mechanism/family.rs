//! Families: mechanisms given by the geometric parameters that their literature uses.
//!
//! A family only assembles: it places joints. Each leg is laid out where all its joints are zero,
//! its closed-form chains find the joint values at home, and the joints are carried there. From
//! then on a family is a [`Mechanism`] like any other, and nothing downstream knows where it came
//! from.

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

pub(in crate::mechanism) use parameter::{Group, Parameter, Slot, TableKey};

use super::Mechanism;

/// The parameters of one family.
#[derive(Clone, Debug, PartialEq)]
pub enum Family {
    /// 3-PRR(RR) + RRS, 5 freedoms.
    PlanoSpherical(PlanoSpherical),
    /// 2-PPR + PPH, 3 freedoms.
    TranslationalHelical(TranslationalHelical),
    /// 3-PRR(RR) + RR(RRR), 5 freedoms.
    PlanarPlanar(PlanarPlanar),
}

impl Family {
    /// The mechanism at its assembled home pose.
    ///
    /// # Errors
    /// Every parameter that is out of its range, and every leg that does not reach home.
    pub fn assemble(&self) -> Result<Mechanism, AssemblyError> {
        match self {
            Self::PlanoSpherical(family) => family.assemble(),
            Self::TranslationalHelical(family) => family.assemble(),
            Self::PlanarPlanar(family) => family.assemble(),
        }
    }

    /// The working mode of the home pose: a group of signs per leg with choices, empty without any.
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

    /// What files call the family.
    pub fn word(&self) -> &'static str {
        match self {
            Self::PlanoSpherical(_) => "plano-spherical",
            Self::TranslationalHelical(_) => "translational-helical",
            Self::PlanarPlanar(_) => "planar-planar",
        }
    }
}
