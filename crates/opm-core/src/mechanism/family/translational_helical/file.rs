//! `family = "translational-helical"` in a mechanism file, and its parameters by name.

use super::{Home, TranslationalHelical, TranslationalLeg};
use crate::mechanism::Mechanism;
use crate::mechanism::family::{Family, Group, Parameter, TableKey};
use crate::mechanism::file::{
    Table, assembled, branches, leg_name, read_home, read_leg, tables_of,
};

const KEYS: &[&str] = &["format", "name", "units", "family", "home", "mode", "leg"];

/// Reads the parameters and assembles the mechanism. A value that cannot be read is reported and
/// becomes NaN, so that the others are checked too.
pub(in crate::mechanism) fn read(root: &Table<'_>, name: &str) -> Option<(Family, Mechanism)> {
    root.allow(KEYS);
    let mut family =
        TranslationalHelical { name: name.to_owned(), ..TranslationalHelical::default() };
    read_home(root, family.home.parameters());
    branches(root, &[]);
    let legs = tables_of(root, "leg", &TranslationalLeg::default().parameters());
    for (index, table) in legs.iter().enumerate() {
        let name = leg_name(table, index);
        let mut leg = TranslationalLeg { name, ..TranslationalLeg::default() };
        read_leg(Some(table), leg.parameters());
        family.legs.push(leg);
    }
    assembled(Family::TranslationalHelical(family), root, &legs)
}

impl TranslationalHelical {
    /// Every parameter: first those of home, then those of the legs in order.
    pub(in crate::mechanism) fn groups(&mut self) -> Vec<Group<'_>> {
        let home = Group::home(self.home.parameters());
        [home].into_iter().chain(self.legs.iter_mut().map(TranslationalLeg::group)).collect()
    }
}

impl Home {
    fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::length("x", &mut self.x, "P along x"),
            Parameter::length("y", &mut self.y, "P along y"),
            Parameter::angle("phi", &mut self.phi, "the platform's angle"),
        ]
    }
}

impl TranslationalLeg {
    fn group(&mut self) -> Group<'_> {
        let name = self.name.clone();
        Group { table: TableKey::Legs("leg"), name, parameters: self.parameters() }
    }

    fn parameters(&mut self) -> Vec<Parameter<'_>> {
        let limits = &mut self.limits;
        vec![
            Parameter::angle("alpha", &mut self.alpha, "the direction of the planar leg, an angle"),
            Parameter::angle("beta", &mut self.beta, "the angle from it to the common axis"),
            Parameter::length("k", &mut self.k, "the distance along the common axis"),
            Parameter::pitch("pitch", &mut self.pitch, "the advance per radian"),
            Parameter::length_limits("S", &mut limits.s),
            Parameter::length_limits("r", &mut limits.r),
            Parameter::angle_limits("phi", &mut limits.phi),
        ]
    }
}
