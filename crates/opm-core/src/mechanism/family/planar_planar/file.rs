//! `family = "planar-planar"` in a mechanism file.

use super::{ArmLeg, ArmLimits, Home, PlanarPlanar, SLIDER_LEGS, SliderLeg, SliderLimits};
use crate::chain::Branch;
use crate::joint::Quantity::{Angle, Length};
use crate::mechanism::Mechanism;
use crate::mechanism::family::Family;
use crate::mechanism::file::{
    Table, branches, home, leg_name, limits, point, quantity, report_problems,
};

const KEYS: &[&str] =
    &["format", "name", "units", "family", "home", "mode", "slider_leg", "arm_leg"];
const HOME_KEYS: &[&str] = &["x", "y", "w", "phi"];
const SLIDER_KEYS: &[&str] = &["name", "alpha", "h", "a1", "c", "g", "l", "platform", "limits"];
const SLIDER_LIMIT_KEYS: &[&str] = &["S", "phi1", "phi2", "rod", "hinge"];
const ARM_KEYS: &[&str] = &["name", "base", "b1", "c", "f", "g", "d1", "d2", "platform", "limits"];
const ARM_LIMIT_KEYS: &[&str] = &["phi1", "phi2", "fold1", "fold2", "hinge"];
/// Signs of each leg's choices in the working mode.
const CHOICES: &[usize] = &[2, 2, 2, 2];

/// The parameters and what they assemble to. What cannot be read is reported, and is NaN for the
/// others to be checked nevertheless.
pub(in crate::mechanism) fn read(root: &Table<'_>, name: &str) -> Option<(Family, Mechanism)> {
    root.allow(KEYS);
    let coordinate = home(root, HOME_KEYS);
    let mode = branches(root, CHOICES);
    let slider_legs = root.tables("slider_leg", SLIDER_KEYS);
    let arm_leg = root
        .require("arm_leg", "a table [arm_leg]: the RR(RRR) leg")
        .and_then(|value| value.table(ARM_KEYS));
    let signs = |i: usize| match mode.get(2 * i..2 * i + 2) {
        Some(&[first, second]) => [first, second],
        _ => [Branch::Plus; 2],
    };
    let sliders = slider_legs.iter().enumerate();
    let family = PlanarPlanar {
        name: name.to_owned(),
        home: Home {
            x: coordinate("x", Length),
            y: coordinate("y", Length),
            w: coordinate("w", Length),
            phi: coordinate("phi", Angle),
        },
        slider_legs: sliders.map(|(i, leg)| slider_leg(leg, i, signs(i))).collect(),
        arm_leg: arm(arm_leg.as_ref(), signs(SLIDER_LEGS)),
    };
    match family.assemble() {
        Ok(mechanism) => Some((Family::PlanarPlanar(family), mechanism)),
        Err(error) => {
            let legs: Vec<_> = slider_legs.into_iter().chain(arm_leg).collect();
            report_problems(&error, root, &legs);
            None
        }
    }
}

fn slider_leg(leg: &Table<'_>, index: usize, [upper, slider]: [Branch; 2]) -> SliderLeg {
    let limit = limits(Some(leg), SLIDER_LIMIT_KEYS);
    SliderLeg {
        name: leg_name(leg, index),
        alpha: quantity(leg, "alpha", Angle, "the direction of the leg, an angle"),
        h: quantity(leg, "h", Length, "the slider's distance from the origin"),
        a1: quantity(leg, "a1", Length, "the length of the link on the slider"),
        c: quantity(leg, "c", Length, "the carriage's distance from the vertical plane"),
        g: quantity(leg, "g", Length, "the height of the rod's lower end"),
        l: quantity(leg, "l", Length, "the length of the rod"),
        platform: point(leg, "platform", "a point [u, z]: where the rod ends in the platform"),
        upper,
        slider,
        limits: SliderLimits {
            s: limit("S", Length),
            phi1: limit("phi1", Angle),
            phi2: limit("phi2", Angle),
            rod: limit("rod", Angle),
            hinge: limit("hinge", Angle),
        },
    }
}

fn arm(leg: Option<&Table<'_>>, [lower, fold]: [Branch; 2]) -> ArmLeg {
    let limit = limits(leg, ARM_LIMIT_KEYS);
    let length = |key, expected| leg.map_or(f64::NAN, |leg| quantity(leg, key, Length, expected));
    let point = |key, expected| leg.map_or([f64::NAN; 2], |leg| point(leg, key, expected));
    ArmLeg {
        name: leg.map_or_else(String::new, |leg| leg_name(leg, SLIDER_LEGS)),
        base: point("base", "a point [x, y]: where the arm stands"),
        b1: length("b1", "the length of the arm's first link"),
        c: length("c", "the elbow's distance from the vertical plane"),
        f: length("f", "the distance from the elbow to the support, along the vertical plane"),
        g: length("g", "the height of the support's lower end"),
        d1: length("d1", "the length of the support's lower link"),
        d2: length("d2", "the length of the support's upper link"),
        platform: point("platform", "a point [u, z]: where the support ends in the platform"),
        lower,
        fold,
        limits: ArmLimits {
            phi1: limit("phi1", Angle),
            phi2: limit("phi2", Angle),
            fold1: limit("fold1", Angle),
            fold2: limit("fold2", Angle),
            hinge: limit("hinge", Angle),
        },
    }
}
