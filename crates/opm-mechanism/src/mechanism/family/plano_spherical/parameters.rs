//! The parameters of the family by name, by which files are read and written, and parameters changed.

use super::{ArmLeg, Home, PlanoSpherical, SliderLeg};
use crate::mechanism::family::{Group, Parameter, TableKey};
use crate::numeric::Quantity::{Angle, Length};

impl PlanoSpherical {
    /// Every parameter: first those of home, then those of the legs in order.
    pub(in crate::mechanism) fn groups(&mut self) -> Vec<Group<'_>> {
        let home = Group::home(self.home.parameters());
        let sliders = self.slider_legs.iter_mut().map(SliderLeg::group);
        [home].into_iter().chain(sliders).chain([self.arm_leg.group()]).collect()
    }
}

impl Home {
    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::length("x", &mut self.x, "P along x"),
            Parameter::length("y", &mut self.y, "P along y"),
            Parameter::angle("zeta", &mut self.zeta, "the first Euler angle"),
            Parameter::angle("xi", &mut self.xi, "the second Euler angle"),
            Parameter::angle("psi", &mut self.psi, "the third Euler angle"),
        ]
    }
}

impl SliderLeg {
    pub(super) fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Legs("slider_leg"), name, parameters: self.parameters() }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let limits = &mut self.limits;
        let own = vec![
            Parameter::angle("alpha", &mut self.alpha, "the direction of the planar leg, an angle"),
            Parameter::length("h", &mut self.h, "the slider's distance from the origin"),
            Parameter::length("a1", &mut self.a1, "the length of the link on the slider"),
            Parameter::length("a2", &mut self.a2, "the length of the link at the platform"),
            Parameter::angle("alpha1", &mut self.alpha1, "the first arc, an angle"),
            Parameter::angle("alpha2", &mut self.alpha2, "the second arc, an angle"),
            Parameter::angle(
                "eta",
                &mut self.eta,
                "the platform axis's angle about the platform's z",
            ),
            Parameter::angle(
                "beta",
                &mut self.beta,
                "the platform axis's angle from the platform's z",
            ),
        ];
        let joints = [
            ("S", Length, &mut limits.s),
            ("phi1", Angle, &mut limits.phi1),
            ("phi2", Angle, &mut limits.phi2),
            ("theta2", Angle, &mut limits.theta2),
            ("theta3", Angle, &mut limits.theta3),
        ];
        Parameter::with_limits(own, joints)
    }
}

impl ArmLeg {
    pub(super) fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Leg("arm_leg"), name, parameters: self.parameters() }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let own = vec![
            Parameter::point("base", &mut self.base, "a point [x, y]: where the arm stands"),
            Parameter::length("b1", &mut self.b1, "the length of the arm's first link"),
            Parameter::length("b2", &mut self.b2, "the length of the arm's second link"),
        ];
        let joints = [("phi1", Angle, &mut self.phi1), ("phi2", Angle, &mut self.phi2)];
        Parameter::with_limits(own, joints)
    }
}
