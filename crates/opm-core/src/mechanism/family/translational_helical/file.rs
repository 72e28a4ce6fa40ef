//! `family = "translational-helical"` in a mechanism file.

use super::{Home, LegLimits, TranslationalHelical, TranslationalLeg};
use crate::joint::Quantity::{Angle, Length};
use crate::mechanism::Mechanism;
use crate::mechanism::family::Family;
use crate::mechanism::file::{Table, branches, home, leg_name, limits, quantity, report_problems};

const KEYS: &[&str] = &["format", "name", "units", "family", "home", "mode", "leg"];
const HOME_KEYS: &[&str] = &["x", "y", "phi"];
const LEG_KEYS: &[&str] = &["name", "alpha", "beta", "k", "pitch", "limits"];
const LIMIT_KEYS: &[&str] = &["S", "r", "phi"];

/// The parameters and what they assemble to. What cannot be read is reported, and is NaN for the
/// others to be checked nevertheless.
pub(in crate::mechanism) fn read(root: &Table<'_>, name: &str) -> Option<(Family, Mechanism)> {
    root.allow(KEYS);
    let coordinate = home(root, HOME_KEYS);
    branches(root, &[]);
    let legs = root.tables("leg", LEG_KEYS);
    let family = TranslationalHelical {
        name: name.to_owned(),
        home: Home {
            x: coordinate("x", Length),
            y: coordinate("y", Length),
            phi: coordinate("phi", Angle),
        },
        legs: legs.iter().enumerate().map(|(i, leg)| read_leg(leg, i)).collect(),
    };
    match family.assemble() {
        Ok(mechanism) => Some((Family::TranslationalHelical(family), mechanism)),
        Err(error) => {
            report_problems(&error, root, &legs);
            None
        }
    }
}

fn read_leg(leg: &Table<'_>, index: usize) -> TranslationalLeg {
    let limit = limits(Some(leg), LIMIT_KEYS);
    TranslationalLeg {
        name: leg_name(leg, index),
        alpha: quantity(leg, "alpha", Angle, "the direction of the planar leg, an angle"),
        beta: quantity(leg, "beta", Angle, "the angle from it to the common axis"),
        k: quantity(leg, "k", Length, "the distance along the common axis"),
        pitch: leg.get("pitch").map(|value| value.length().unwrap_or(f64::NAN)),
        limits: LegLimits {
            s: limit("S", Length),
            r: limit("r", Length),
            phi: limit("phi", Angle),
        },
    }
}
