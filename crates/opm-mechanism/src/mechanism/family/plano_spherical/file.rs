//! `family = "plano-spherical"` in a mechanism file.

use super::{PlanoSpherical, SLIDER_LEGS, SliderLeg};
use crate::chain::Branch;
use crate::mechanism::Mechanism;
use crate::mechanism::family::{Family, FamilyForm};
use crate::mechanism::file::{
    Table, assembled, leg_name, read_home, read_leg, table_of, tables_of,
};

const KEYS: &[&str] =
    &["format", "name", "units", "family", "home", "mode", "slider_leg", "arm_leg"];
/// The number of signs of each leg in the working mode.
const CHOICES: &[usize] = &[2, 2, 2, 1];

/// The form of the family's files.
pub(in crate::mechanism) const FORM: FamilyForm = FamilyForm {
    read,
    keys: KEYS,
    choices: CHOICES,
    blank: || {
        Family::PlanoSpherical(PlanoSpherical {
            slider_legs: vec![SliderLeg::default(); SLIDER_LEGS],
            ..PlanoSpherical::default()
        })
    },
};

/// Reads the parameters and assembles the mechanism. A value that cannot be read is reported and
/// becomes NaN, so that the others are checked too.
fn read(root: &Table<'_>, name: &str, mode: &[Branch]) -> Option<(Family, Mechanism)> {
    let mut family = PlanoSpherical { name: name.to_owned(), ..PlanoSpherical::default() };
    read_home(root, family.home.parameters());

    let mut legs = tables_of(root, "slider_leg", &SliderLeg::default().parameters());
    for (index, table) in legs.iter().enumerate() {
        let mut leg = SliderLeg { name: leg_name(table, index), ..SliderLeg::default() };
        if let Some(&[upper, slider]) = mode.get(2 * index..2 * index + 2) {
            (leg.upper, leg.slider) = (upper, slider);
        }
        read_leg(Some(table), leg.parameters());
        family.slider_legs.push(leg);
    }
    let arm = &mut family.arm_leg;
    let table = table_of(root, "arm_leg", "a table [arm_leg]: the RRS leg", &arm.parameters());
    arm.name = table.map_or_else(String::new, |table| leg_name(&table, SLIDER_LEGS));
    arm.elbow = mode.last().copied().unwrap_or_default();
    read_leg(table.as_ref(), arm.parameters());
    legs.extend(table);
    assembled(Family::PlanoSpherical(family), root, &legs)
}
