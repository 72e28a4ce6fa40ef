//! The height of a Schoenflies section, from the mechanism alone.

use opm_core::Section;
use opm_core::decomposition::{Freedom, LegSplit};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::JointKind;
use opm_core::mechanism::leg::Leg;
use opm_core::task::{CoordinateKind, TaskCoordinate};

/// A value on a limit is within it, whatever the rounding: metres.
const ROUNDING: f64 = 3e-12;

/// Whether every slider along the direction of a Schoenflies section is within its limits, for the values of the
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
    let part = |split: &LegSplit| match section {
        Section::Lower => split.lower.clone(),
        Section::Upper => split.upper.clone(),
    };
    m.mechanism().legs.iter().zip(&d.legs).all(|(leg, split)| {
        part(split).iter().filter(|freedom| is_lift(leg, **freedom, class)).all(|freedom| {
            let joint = &leg.joints[freedom.joint];
            let c = &joint.coordinates[0];
            let value = c.home + joint.axis.dot(&up).signum() * rise;
            let within =
                |[low, high]: [f64; 2]| (low - ROUNDING..=high + ROUNDING).contains(&value);
            c.limits.is_none_or(within)
        })
    })
}

/// Whether a joint of a section in a subspace carries the section's height.
pub fn is_lift(leg: &Leg, freedom: Freedom, class: &SubspaceClass) -> bool {
    let SubspaceClass::Schoenflies { axis } = class else { return false };
    let joint = &leg.joints[freedom.joint];
    joint.kind == JointKind::Prismatic && joint.axis.dot(axis).abs() > 0.5
}
