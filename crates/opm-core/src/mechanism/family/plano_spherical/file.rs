//! `family = "plano-spherical"` in a mechanism file.

use super::{ArmLeg, Home, PlanoSpherical, SLIDER_LEGS, SliderLeg, SliderLimits};
use crate::chain::Branch;
use crate::joint::Quantity::{Angle, Length};
use crate::mechanism::Mechanism;
use crate::mechanism::family::Family;
use crate::mechanism::file::{
    Table, branches, home, leg_name, limits, point, quantity, report_problems,
};

const KEYS: &[&str] =
    &["format", "name", "units", "family", "home", "mode", "slider_leg", "arm_leg"];
const HOME_KEYS: &[&str] = &["x", "y", "zeta", "xi", "psi"];
const SLIDER_KEYS: &[&str] =
    &["name", "alpha", "h", "a1", "a2", "alpha1", "alpha2", "eta", "beta", "limits"];
const SLIDER_LIMIT_KEYS: &[&str] = &["S", "phi1", "phi2", "theta2", "theta3"];
const ARM_KEYS: &[&str] = &["name", "base", "b1", "b2", "limits"];
const ARM_LIMIT_KEYS: &[&str] = &["phi1", "phi2"];
/// Signs of each leg's choices in the working mode.
const CHOICES: &[usize] = &[2, 2, 2, 1];

/// The parameters and what they assemble to. What cannot be read is reported, and is NaN for the
/// others to be checked nevertheless.
pub(in crate::mechanism) fn read(root: &Table<'_>, name: &str) -> Option<(Family, Mechanism)> {
    root.allow(KEYS);
    let coordinate = home(root, HOME_KEYS);
    let mode = branches(root, CHOICES);
    let slider_legs = root.tables("slider_leg", SLIDER_KEYS);
    let arm_leg = root
        .require("arm_leg", "a table [arm_leg]: the RRS leg")
        .and_then(|value| value.table(ARM_KEYS));
    let family = PlanoSpherical {
        name: name.to_owned(),
        home: Home {
            x: coordinate("x", Length),
            y: coordinate("y", Length),
            zeta: coordinate("zeta", Angle),
            xi: coordinate("xi", Angle),
            psi: coordinate("psi", Angle),
        },
        slider_legs: slider_legs
            .iter()
            .enumerate()
            .map(|(i, leg)| slider_leg(leg, i, mode.get(2 * i..2 * i + 2)))
            .collect(),
        arm_leg: arm(arm_leg.as_ref(), mode.last().copied()),
    };
    match family.assemble() {
        Ok(mechanism) => Some((Family::PlanoSpherical(family), mechanism)),
        Err(error) => {
            let legs: Vec<_> = slider_legs.into_iter().chain(arm_leg).collect();
            report_problems(&error, root, &legs);
            None
        }
    }
}

fn slider_leg(leg: &Table<'_>, index: usize, mode: Option<&[Branch]>) -> SliderLeg {
    let [upper, slider] = match mode {
        Some(&[upper, slider]) => [upper, slider],
        _ => [Branch::Plus; 2],
    };
    let limit = limits(Some(leg), SLIDER_LIMIT_KEYS);
    SliderLeg {
        name: leg_name(leg, index),
        alpha: quantity(leg, "alpha", Angle, "the direction of the planar leg, an angle"),
        h: quantity(leg, "h", Length, "the slider's distance from the origin"),
        a1: quantity(leg, "a1", Length, "the length of the link on the slider"),
        a2: quantity(leg, "a2", Length, "the length of the link at the platform"),
        alpha1: quantity(leg, "alpha1", Angle, "the first arc, an angle"),
        alpha2: quantity(leg, "alpha2", Angle, "the second arc, an angle"),
        eta: quantity(leg, "eta", Angle, "the platform axis's angle about the platform's z"),
        beta: quantity(leg, "beta", Angle, "the platform axis's angle from the platform's z"),
        upper,
        slider,
        limits: SliderLimits {
            s: limit("S", Length),
            phi1: limit("phi1", Angle),
            phi2: limit("phi2", Angle),
            theta2: limit("theta2", Angle),
            theta3: limit("theta3", Angle),
        },
    }
}

fn arm(leg: Option<&Table<'_>>, elbow: Option<Branch>) -> ArmLeg {
    let limit = limits(leg, ARM_LIMIT_KEYS);
    let length = |key, expected| leg.map_or(f64::NAN, |leg| quantity(leg, key, Length, expected));
    ArmLeg {
        name: leg.map_or_else(String::new, |leg| leg_name(leg, SLIDER_LEGS)),
        base: leg.map_or([f64::NAN; 2], |leg| {
            point(leg, "base", "a point [x, y]: where the arm stands")
        }),
        b1: length("b1", "the length of the arm's first link"),
        b2: length("b2", "the length of the arm's second link"),
        elbow: elbow.unwrap_or(Branch::Plus),
        phi1: limit("phi1", Angle),
        phi2: limit("phi2", Angle),
    }
}
