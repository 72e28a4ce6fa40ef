//! `family = "planar-planar"` in a mechanism file.

use super::{PlanarPlanar, SLIDER_LEGS, SliderLeg};
use crate::chain::Branch;
use crate::mechanism::Mechanism;
use crate::mechanism::family::{Family, FamilyForm};
use crate::mechanism::file::{
    Table, assembled, leg_name, read_home, read_leg, table_of, tables_of,
};

const KEYS: &[&str] =
    &["format", "name", "units", "family", "home", "mode", "slider_leg", "arm_leg"];
/// The number of signs of each leg in the working mode.
const CHOICES: &[usize] = &[2, 2, 2, 2];

/// The form of the family's files.
pub(in crate::mechanism) const FORM: FamilyForm = FamilyForm {
    read,
    keys: KEYS,
    choices: CHOICES,
    blank: || {
        Family::PlanarPlanar(PlanarPlanar {
            slider_legs: vec![SliderLeg::default(); SLIDER_LEGS],
            ..PlanarPlanar::default()
        })
    },
};

/// Reads the parameters and assembles the mechanism. A value that cannot be read is reported and
/// becomes NaN, so that the others are checked too.
fn read(root: &Table<'_>, name: &str, mode: &[Branch]) -> Option<(Family, Mechanism)> {
    let mut family = PlanarPlanar { name: name.to_owned(), ..PlanarPlanar::default() };
    read_home(root, family.home.parameters());
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
