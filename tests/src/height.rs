//! The height of a Schoenflies section, from the mechanism alone, and the joints that carry it.

use crate::random::beside;
use fastrand::Rng;
use nalgebra::{Unit, Vector3};
use opm_core::Section;
use opm_core::decomposition::{Decomposition, Freedom, LegSplit};
use opm_core::group::JointDisplacement;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::task::{CoordinateKind, TaskCoordinate};

/// Whether every joint that carries the height of a Schoenflies section is within its limits, for the values of the
/// section's coordinates. All other sections have no height.
pub fn within(m: &Manipulator, section: Section, values: &[f64]) -> bool {
    let d = m.decomposition();
    let (class, first) = match section {
        Section::Lower => (&d.lower, 0),
        Section::Upper => (&d.upper, m.task().lower_count),
    };
    let SubspaceClass::Schoenflies { axis } = class else { return true };
    let coordinates = &m.task().coordinates[first..];
    let is_height = |c: &TaskCoordinate| matches!(c.kind(), CoordinateKind::Z | CoordinateKind::H);
    let place = coordinates.iter().position(is_height).unwrap();
    let frame = if section == Section::Lower { &m.task().lower } else { &m.task().upper };
    let up = frame.axes.column(2).into_owned();
    assert!(up.cross(axis).norm() < 1e-9);
    let rise = values[place] - coordinates[place].home;
    m.mechanism().legs.iter().zip(&d.legs).all(|(leg, split)| {
        part(split, section).iter().filter(|freedom| is_lift(leg, **freedom, class)).all(
            |freedom| {
                let joint = &leg.joints[freedom.joint];
                let c = &joint.coordinates[0];
                let advance = match joint.kind {
                    JointKind::Helical { pitch } => pitch * joint.axis.dot(&up),
                    _ => joint.axis.dot(&up),
                };
                // Limits include what rounding may change.
                let limits = c.displacement_limits(m.characteristic_length());
                limits.admits(JointDisplacement::Value(rise / advance))
            },
        )
    })
}

/// Whether a joint of a section in a subspace carries the section's height.
pub fn is_lift(leg: &Leg, freedom: Freedom, class: &SubspaceClass) -> bool {
    let SubspaceClass::Schoenflies { axis } = class else { return false };
    let joint = &leg.joints[freedom.joint];
    let carries = matches!(joint.kind, JointKind::Prismatic | JointKind::Helical { .. });
    carries && joint.axis.dot(axis).abs() > 0.5
}

/// The freedoms of a section of a leg.
fn part(split: &LegSplit, section: Section) -> &[Freedom] {
    match section {
        Section::Lower => &split.lower,
        Section::Upper => &split.upper,
    }
}

/// The Schoenflies section of a mechanism whose sections share a translation that is inclined to its direction.
pub fn inclined(decomposition: &Decomposition) -> Option<Section> {
    let SubspaceClass::Translation { axis: along } = decomposition.intersection else {
        return None;
    };
    let sections = [(&decomposition.lower, Section::Lower), (&decomposition.upper, Section::Upper)];
    let inclined = |class: &SubspaceClass| match class {
        SubspaceClass::Schoenflies { axis } => axis.dot(&along).abs() > 1e-9,
        _ => false,
    };
    sections.into_iter().find(|(class, _)| inclined(class)).map(|(_, section)| section)
}

/// The joint of a leg that carries a height, and its direction; `None` without a height.
fn lift<'a>(
    leg: &'a mut Leg,
    split: &LegSplit,
    decomposition: &Decomposition,
) -> Option<(&'a mut Joint, Unit<Vector3<f64>>)> {
    let sections = [(&decomposition.lower, &split.lower), (&decomposition.upper, &split.upper)];
    sections
        .into_iter()
        .find_map(|(class, freedoms)| {
            let SubspaceClass::Schoenflies { axis } = class else { return None };
            Some((freedoms.iter().find(|freedom| is_lift(leg, **freedom, class))?.joint, *axis))
        })
        .map(|(joint, axis)| (&mut leg.joints[joint], axis))
}

/// Replaces a joint by one of another kind, about or along `axis`.
fn replace(joint: &mut Joint, kind: JointKind, axis: Unit<Vector3<f64>>) {
    let mut other = Joint::new(joint.name.clone(), kind, axis, joint.point);
    other.actuated = joint.actuated;
    for (new, old) in other.coordinates.iter_mut().zip(&joint.coordinates) {
        (new.home, new.limits) = (old.home, old.limits);
    }
    *joint = other;
}

/// Puts an inclined slider or a screw in the place of most joints that carry a height.
pub fn lean(rng: &mut Rng, mechanism: &mut Mechanism, decomposition: &Decomposition) {
    for (leg, split) in mechanism.legs.iter_mut().zip(&decomposition.legs) {
        let inclined = inclined(decomposition);
        let Some((joint, up)) = lift(leg, split, decomposition) else { continue };
        // Beside an inclined imaginary joint, only a slider along the direction has closed forms.
        if inclined.is_some_and(|section| part(split, section).len() < 4) {
            continue;
        }
        // A smaller inclination would be taken for rounding.
        let aside = beside(&up).0 * (0.05 + 0.95 * rng.f64());
        let pitch = (0.2 + rng.f64()) * if rng.bool() { 1.0 } else { -1.0 };
        match rng.usize(..3) {
            0 => {}
            1 => joint.axis = Unit::new_normalize(joint.axis.into_inner() + aside),
            _ => replace(joint, JointKind::Helical { pitch }, joint.axis),
        }
    }
}

/// The mechanism with sliders along the direction in the place of all joints that carry a height. Its other joints are a
/// chain in the plane.
pub fn straight(mut mechanism: Mechanism, decomposition: &Decomposition) -> Mechanism {
    for (leg, split) in mechanism.legs.iter_mut().zip(&decomposition.legs) {
        straighten(leg, split, decomposition);
    }
    mechanism
}

/// A slider along the direction in the place of a leg's joint that carries a height.
pub fn straighten(leg: &mut Leg, split: &LegSplit, decomposition: &Decomposition) {
    if let Some((joint, up)) = lift(leg, split, decomposition) {
        replace(joint, JointKind::Prismatic, up);
    }
}
