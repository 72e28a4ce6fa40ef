//! What is probably a mistake in a mechanism that can be read and solved: units, links in line, motors that were forgotten.

use super::{check_actuators, mobility::Mobility, mobility::mobility};
use crate::mechanism::Mechanism;
use crate::mechanism::file::{AngleUnit, FileUnits, LengthUnit};
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use nalgebra::{Point3, Unit, Vector3};

/// Limits of angles that are all within so many degrees were probably written in radians.
const NARROW: f64 = 2.0;
/// The sine of the angle by which links miss a line, below which they are nearly in line: some three degrees.
const IN_LINE: f64 = 0.05;
/// Joints that are nearer than this share of the mechanism's size are in one place.
const SAME: f64 = 1e-6;

/// What is probably a mistake in a mechanism, in a sentence each; nothing in most.
///
/// * In a file in degrees, the limits of some angles, or cones, are at most 2: radians.
/// * In a file in millimetres, centimetres or inches, the whole mechanism is smaller than a few of them: metres.
/// * Two links are nearly in line at home, stretched or folded: home is next to a serial singularity.
pub fn doubts(mechanism: &Mechanism) -> Vec<String> {
    let mut found = Vec::new();
    found.extend(narrow_limits(mechanism));
    found.extend(small_sizes(mechanism));
    found.extend(mechanism.legs.iter().filter_map(|leg| in_line(mechanism, leg)));
    found
}

/// Names of joints, of which there may be many.
fn listed(names: &[&str]) -> String {
    const SHOWN: usize = 6;
    match names.get(SHOWN..) {
        Some(rest) if !rest.is_empty() => {
            format!("{} and {} more", names[..SHOWN].join(", "), rest.len())
        }
        _ => names.join(", "),
    }
}

/// Limits of angles in degrees that look like radians.
fn narrow_limits(mechanism: &Mechanism) -> Option<String> {
    if mechanism.units.angle != AngleUnit::Degree {
        return None;
    }
    let narrow = |ends: &[f64]| ends.iter().all(|end| end.abs().to_degrees() <= NARROW);
    let (mut names, mut largest) = (Vec::new(), 0.0_f64);
    for joint in mechanism.joints() {
        let limits = joint.coordinates.iter().filter(|c| c.quantity == Quantity::Angle);
        let limits = limits.filter_map(|c| c.limits).map(|limits| limits.to_vec());
        let cone = joint.cone.map(|cone| vec![cone.half_angle]);
        let ends: Vec<f64> = limits.chain(cone).filter(|ends| narrow(ends)).flatten().collect();
        if !ends.is_empty() {
            names.push(&*joint.name);
            largest = ends.iter().fold(largest, |largest, end| largest.max(end.abs()));
        }
    }
    let shown = mechanism.units.show(largest, Quantity::Angle);
    (!names.is_empty()).then(|| {
        format!(
            "the limits of {} are at most {shown} from zero; the file's angles are degrees: if these are radians, write \
             units.angle = \"rad\", or the limits in degrees",
            listed(&names)
        )
    })
}

/// A mechanism that is suspiciously small for the unit of its file.
fn small_sizes(mechanism: &Mechanism) -> Option<String> {
    let least = match mechanism.units.length {
        LengthUnit::Millimetre => 5.0,
        LengthUnit::Centimetre => 2.0,
        LengthUnit::Inch => 1.0,
        LengthUnit::Metre | LengthUnit::Micrometre => return None,
    };
    let size = size(mechanism);
    let shown = mechanism.units.show(size, Quantity::Length);
    (size > 0.0 && size < least * mechanism.units.length.factor()).then(|| {
        format!(
            "all joints are within {shown}; the file's lengths are {}: if these are metres, write units.length = \"m\"",
            match mechanism.units.length {
                LengthUnit::Centimetre => "centimetres",
                LengthUnit::Inch => "inches",
                _ => "millimetres",
            }
        )
    })
}

/// The largest distance of a joint or of the platform's point from the first joint, metres.
fn size(mechanism: &Mechanism) -> f64 {
    let points = || mechanism.joints().map(|joint| joint.point).chain([mechanism.platform]);
    let Some(first) = points().next() else { return 0.0 };
    points().map(|point| (point - first).norm()).fold(0.0, f64::max)
}

/// A place of a leg in which it can bend: one revolute joint, or several about one point.
struct Bend<'a> {
    name: &'a str,
    point: Point3<f64>,
    /// `None` where it bends in more than one direction.
    axis: Option<Unit<Vector3<f64>>>,
}

/// The bends of a leg; `None` in place of a joint that slides.
fn bends(leg: &Leg, near: f64) -> Vec<Option<Bend<'_>>> {
    let mut found: Vec<Option<Bend<'_>>> = Vec::new();
    for joint in &leg.joints {
        let Joint { name, point, .. } = joint;
        let axis = match joint.kind {
            JointKind::Revolute => Some(joint.axis),
            JointKind::Universal { .. } | JointKind::Spherical => None,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Cylindrical => {
                found.push(None);
                continue;
            }
        };
        match found.last_mut() {
            Some(Some(last)) if (last.point - point).norm() <= near => last.axis = None,
            _ => found.push(Some(Bend { name, point: *point, axis })),
        }
    }
    found
}

/// Two links of a leg that are nearly stretched or folded at home: the end of the first can then only move across the second.
fn in_line(mechanism: &Mechanism, leg: &Leg) -> Option<String> {
    let near = SAME * size(mechanism);
    for three in bends(leg, near).windows(3) {
        let [Some(first), Some(middle), Some(last)] = three else { continue };
        let Some(axis) = first.axis.map(Unit::into_inner) else { continue };
        let parallel = |bend: &Bend<'_>| bend.axis.map(|a| a.cross(&axis).norm() <= SAME);
        let across = |v: Vector3<f64>| v - axis * axis.dot(&v);
        let one = across(middle.point - first.point);
        let other = match [parallel(middle), parallel(last)] {
            // A plane: where the points stand on their axes does not matter.
            [Some(true), Some(true)] => across(last.point - middle.point),
            [Some(true) | None, None] => last.point - middle.point,
            _ => continue,
        };
        let lengths = one.norm() * other.norm();
        let sine = axis.cross(&one).dot(&other).abs() / lengths;
        if lengths > near * near && sine < IN_LINE {
            let off = FileUnits { angle: AngleUnit::Degree, ..mechanism.units };
            let off = off.show(sine.asin(), Quantity::Angle);
            return Some(format!(
                "{}: the links {}-{} and {}-{} are within {off} of stretched or folded at home, next to a serial \
                 singularity, where rates and limits of joints say little; is home meant to be there?",
                leg.name, first.name, middle.name, middle.name, last.name
            ));
        }
    }
    None
}

/// The joints whose motors would complete the set, in a sentence, where the actuators do not control the platform. `report` is the
/// mechanism's mobility.
pub fn missing_motors(mechanism: &Mechanism, report: &Mobility) -> Option<String> {
    check_actuators(report).err()?;
    // A single loop with one freedom needs no motor: it is a linkage, with any joint as its input.
    if mechanism.legs.len() == 2 && report.mobility == 1 {
        return None;
    }
    let mut completed = mechanism.clone();
    let mut controlled = report.controlled;
    let mut names = Vec::new();
    // The joints next to the base first: motors stand there if they can.
    let longest = mechanism.legs.iter().map(|leg| leg.joints.len()).max().unwrap_or(0);
    let places = (0..longest).flat_map(|at| (0..mechanism.legs.len()).map(move |leg| (leg, at)));
    for (leg, at) in places {
        let Some(joint) = completed.legs[leg].joints.get_mut(at) else { continue };
        if joint.actuated || joint.freedoms() > 1 {
            continue;
        }
        joint.actuated = true;
        match mobility(&completed) {
            Ok(now) if now.controlled > controlled => {
                controlled = now.controlled;
                names.push(&*mechanism.legs[leg].joints[at].name);
                if check_actuators(&now).is_ok() {
                    let (verb, word) = if names.len() == 1 {
                        ("completes", "a motor")
                    } else {
                        ("complete", "motors")
                    };
                    return Some(format!(
                        "too few motors: {word} at {} {verb} the set; write actuated = true there, or at others",
                        names.join(", ")
                    ));
                }
            }
            _ => completed.legs[leg].joints[at].actuated = false,
        }
    }
    None
}
