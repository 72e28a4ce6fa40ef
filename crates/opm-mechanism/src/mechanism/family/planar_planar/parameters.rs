//! The parameters of the family by name, by which files are read and written, and parameters changed.

use super::{ArmLeg, Home, PlanarPlanar, SliderLeg};
use crate::mechanism::family::{Group, Parameter, TableKey};
use crate::numeric::Quantity::{Angle, Length};

impl PlanarPlanar {
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
            Parameter::length("x", &mut self.x, "O along x"),
            Parameter::length("y", &mut self.y, "O along y"),
            Parameter::length("w", &mut self.w, "the platform's height"),
            Parameter::angle("phi", &mut self.phi, "the platform's angle"),
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
            Parameter::angle("alpha", &mut self.alpha, "the direction of the leg, an angle"),
            Parameter::length("h", &mut self.h, "the slider's distance from the origin"),
            Parameter::length("a1", &mut self.a1, "the length of the link on the slider"),
            Parameter::length("c", &mut self.c, "the carriage's distance from the vertical plane"),
            Parameter::length("g", &mut self.g, "the height of the rod's lower end"),
            Parameter::length("l", &mut self.l, "the length of the rod"),
            Parameter::point(
                "platform",
                &mut self.platform,
                "a point [u, z]: where the rod ends in the platform",
            ),
        ];
        let joints = [
            ("S", Length, &mut limits.s),
            ("phi1", Angle, &mut limits.phi1),
            ("phi2", Angle, &mut limits.phi2),
            ("rod", Angle, &mut limits.rod),
            ("hinge", Angle, &mut limits.hinge),
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
        let limits = &mut self.limits;
        let own = vec![
            Parameter::point("base", &mut self.base, "a point [x, y]: where the arm stands"),
            Parameter::length("b1", &mut self.b1, "the length of the arm's first link"),
            Parameter::length("c", &mut self.c, "the elbow's distance from the vertical plane"),
            Parameter::length(
                "f",
                &mut self.f,
                "the distance from the elbow to the support, along the vertical plane",
            ),
            Parameter::length("g", &mut self.g, "the height of the support's lower end"),
            Parameter::length("d1", &mut self.d1, "the length of the support's lower link"),
            Parameter::length("d2", &mut self.d2, "the length of the support's upper link"),
            Parameter::point(
                "platform",
                &mut self.platform,
                "a point [u, z]: where the support ends in the platform",
            ),
        ];
        let joints = [
            ("phi1", Angle, &mut limits.phi1),
            ("phi2", Angle, &mut limits.phi2),
            ("fold1", Angle, &mut limits.fold1),
            ("fold2", Angle, &mut limits.fold2),
            ("hinge", Angle, &mut limits.hinge),
        ];
        Parameter::with_limits(own, joints)
    }
}
