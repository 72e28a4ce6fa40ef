//! `family = "translational-helical"` in a mechanism file.

use super::{LEGS, TranslationalHelical, TranslationalLeg};
use crate::chain::Branch;
use crate::mechanism::Mechanism;
use crate::mechanism::family::{Family, FamilyForm};
use crate::mechanism::file::{Table, assembled, leg_name, read_home, read_leg, tables_of};

const KEYS: &[&str] = &["format", "name", "units", "family", "home", "mode", "leg"];

/// The form of the family's files.
pub(in crate::mechanism) const FORM: FamilyForm = FamilyForm {
    read,
    keys: KEYS,
    choices: &[],
    blank: || {
        Family::TranslationalHelical(TranslationalHelical {
            legs: vec![TranslationalLeg::default(); LEGS],
            ..TranslationalHelical::default()
        })
    },
};

/// Reads the parameters and assembles the mechanism. A value that cannot be read is reported and
/// becomes NaN, so that the others are checked too.
fn read(root: &Table<'_>, name: &str, _: &[Branch]) -> Option<(Family, Mechanism)> {
    let mut family =
        TranslationalHelical { name: name.to_owned(), ..TranslationalHelical::default() };
    read_home(root, family.home.parameters());
    let legs = tables_of(root, "leg", &TranslationalLeg::default().parameters());
    for (index, table) in legs.iter().enumerate() {
        let name = leg_name(table, index);
        let mut leg = TranslationalLeg { name, ..TranslationalLeg::default() };
        read_leg(Some(table), leg.parameters());
        family.legs.push(leg);
    }
    assembled(Family::TranslationalHelical(family), root, &legs)
}
