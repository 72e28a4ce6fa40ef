//! `family = "planar-planar"` in a mechanism file, and its parameters by name.

use super::{ArmLeg, Home, PlanarPlanar, SLIDER_LEGS, SliderLeg};
use crate::chain::Branch;
use crate::mechanism::Mechanism;
use crate::mechanism::family::{Family, Group, Parameter, TableKey};
use crate::mechanism::file::{
    Table, assembled, branches, leg_name, read_home, read_leg, table_of, tables_of,
};

const KEYS: &[&str] =
    &["format", "name", "units", "family", "home", "mode", "slider_leg", "arm_leg"];
/// The number of signs of each leg in the working mode.
const CHOICES: &[usize] = &[2, 2, 2, 2];

/// Reads the parameters and assembles the mechanism. A value that cannot be read is reported and
/// becomes NaN, so that the others are checked too.
pub(in crate::mechanism) fn read(root: &Table<'_>, name: &str) -> Option<(Family, Mechanism)> {
    root.allow(KEYS);
    let mut family = PlanarPlanar { name: name.to_owned(), ..PlanarPlanar::default() };
    read_home(root, family.home.parameters());
    let mode = branches(root, CHOICES);
    let signs = |i: usize| match mode.get(2 * i..2 * i + 2) {
        Some(&[first, second]) => (first, second),
        _ => (Branch::Plus, Branch::Plus),
    };

    let mut legs = tables_of(root, "slider_leg", &SliderLeg::default().parameters());
    for (index, table) in legs.iter().enumerate() {
        let mut leg = SliderLeg { name: leg_name(table, index), ..SliderLeg::default() };
        (leg.upper, leg.slider) = signs(index);
        read_leg(Some(table), leg.parameters());
        family.slider_legs.push(leg);
    }
    let arm = &mut family.arm_leg;
    let table = table_of(root, "arm_leg", "a table [arm_leg]: the RR(RRR) leg", &arm.parameters());
    arm.name = table.map_or_else(String::new, |table| leg_name(&table, SLIDER_LEGS));
    (arm.lower, arm.fold) = signs(SLIDER_LEGS);
    read_leg(table.as_ref(), arm.parameters());
    legs.extend(table);
    assembled(Family::PlanarPlanar(family), root, &legs)
}

impl PlanarPlanar {
    /// Every parameter: first those of home, then those of the legs in order.
    pub(in crate::mechanism) fn groups(&mut self) -> Vec<Group<'_>> {
        let home = Group::home(self.home.parameters());
        let sliders = self.slider_legs.iter_mut().map(SliderLeg::group);
        [home].into_iter().chain(sliders).chain([self.arm_leg.group()]).collect()
    }
}

impl Home {
    fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::length("x", &mut self.x, "O along x"),
            Parameter::length("y", &mut self.y, "O along y"),
            Parameter::length("w", &mut self.w, "the platform's height"),
            Parameter::angle("phi", &mut self.phi, "the platform's angle"),
        ]
    }
}

impl SliderLeg {
    fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Legs("slider_leg"), name, parameters: self.parameters() }
    }

    fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let limits = &mut self.limits;
        vec![
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
            Parameter::length_limits("S", &mut limits.s),
            Parameter::angle_limits("phi1", &mut limits.phi1),
            Parameter::angle_limits("phi2", &mut limits.phi2),
            Parameter::angle_limits("rod", &mut limits.rod),
            Parameter::angle_limits("hinge", &mut limits.hinge),
        ]
    }
}

impl ArmLeg {
    fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Leg("arm_leg"), name, parameters: self.parameters() }
    }

    fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let limits = &mut self.limits;
        vec![
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
            Parameter::angle_limits("phi1", &mut limits.phi1),
            Parameter::angle_limits("phi2", &mut limits.phi2),
            Parameter::angle_limits("fold1", &mut limits.fold1),
            Parameter::angle_limits("fold2", &mut limits.fold2),
            Parameter::angle_limits("hinge", &mut limits.hinge),
        ]
    }
}
