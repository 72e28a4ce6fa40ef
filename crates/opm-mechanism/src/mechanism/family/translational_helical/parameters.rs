//! The parameters of the family by name, by which files are read and written, and parameters changed.

use super::{Home, TranslationalHelical, TranslationalLeg};
use crate::mechanism::family::{Group, Parameter, TableKey};
use crate::numeric::Quantity::{Angle, Length};

impl TranslationalHelical {
    /// Every parameter: first those of home, then those of the legs in order.
    pub(in crate::mechanism) fn groups(&mut self) -> Vec<Group<'_>> {
        let home = Group::home(self.home.parameters());
        [home].into_iter().chain(self.legs.iter_mut().map(TranslationalLeg::group)).collect()
    }
}

impl Home {
    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::length("x", &mut self.x, "P along x"),
            Parameter::length("y", &mut self.y, "P along y"),
            Parameter::angle("phi", &mut self.phi, "the platform's angle"),
        ]
    }
}

impl TranslationalLeg {
    pub(super) fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Legs("leg"), name, parameters: self.parameters() }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let limits = &mut self.limits;
        let own = vec![
            Parameter::angle("alpha", &mut self.alpha, "the direction of the planar leg, an angle"),
            Parameter::angle("beta", &mut self.beta, "the angle from it to the common axis"),
            Parameter::length("k", &mut self.k, "the distance along the common axis"),
            Parameter::pitch("pitch", &mut self.pitch, "the advance per radian"),
        ];
        let joints = [
            ("S", Length, &mut limits.s),
            ("r", Length, &mut limits.r),
            ("phi", Angle, &mut limits.phi),
        ];
        Parameter::with_limits(own, joints)
    }
}
