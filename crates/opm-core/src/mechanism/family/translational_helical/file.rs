//! `family = "translational-helical"` in a mechanism file.

use super::{TranslationalHelical, TranslationalLeg};
use crate::mechanism::Mechanism;
use crate::mechanism::family::Family;
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
