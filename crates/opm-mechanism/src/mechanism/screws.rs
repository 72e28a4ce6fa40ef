//! Mechanisms built from the screws of their joints alone.

use super::{BodyMasses, Mechanism, Shapes, TaskHints};
use crate::group::screw::Screw;
use crate::group::subspace::{Frame, TOLERANCE};
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::{Leg, placed};
use nalgebra::{Point3, Unit, Vector3};

/// A joint with one freedom, given by its screw at home.
#[derive(Clone, Debug, PartialEq)]
pub struct ScrewJoint {
    /// The joint's name.
    pub name: String,
    /// The joint's twist `(ω; v)` at the assembled home, in base coordinates, for any nonzero rate:
    /// its length does not matter.
    pub screw: Screw,
    /// Whether a motor drives the joint.
    pub actuated: bool,
    /// The joint's value at home, radians or metres.
    pub home: f64,
    /// Lowest and highest value, radians or metres; `None` without limits.
    pub limits: Option<[f64; 2]>,
}

/// Why six numbers are not the screw of a joint.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScrewError {
    /// All six components are zero.
    #[error("all six components are zero, expected the twist (omega; v) of a joint")]
    Zero,
    /// A component is not a number, or too large to compute with.
    #[error("{0} is among its components, expected numbers between -1e9 and 1e9")]
    Component(f64),
}

/// The largest component, metres.
const FARTHEST: f64 = 1e9;

/// Farther than the axis of any real joint, metres. A screw whose axis is farther away is a
/// translation, and its angular part is left over from rounding, of numbers in single precision too.
const AWAY: f64 = 1e6;

/// The advance along the axis in metres per radian: `ω·v / ω²`.
fn pitch(screw: &Screw) -> f64 {
    screw.angular.dot(&screw.linear) / screw.angular.norm_squared()
}

/// The point of the axis nearest to the origin: `ω × v / ω²`.
fn foot(screw: &Screw) -> Point3<f64> {
    Point3::from(screw.angular.cross(&screw.linear) / screw.angular.norm_squared())
}

/// The screw scaled so that its axis has unit length.
///
/// # Errors
/// [`ScrewError`] if the screw has no axis or cannot be computed with.
fn normalized(screw: &Screw) -> Result<Screw, ScrewError> {
    let components = screw.to_vector();
    if let Some(&odd) = components.iter().find(|c| c.is_nan() || c.abs() > FARTHEST) {
        return Err(ScrewError::Component(odd));
    }
    let largest = components.amax();
    if largest == 0.0 {
        return Err(ScrewError::Zero);
    }
    // Scaled to numbers near one first: their squares neither vanish nor overflow.
    let Screw { angular, linear } = Screw::from_vector(&(components / largest));
    let (angle, slide) = (angular.norm(), linear.norm());
    Ok(if angle * AWAY < slide {
        Screw { angular: Vector3::zeros(), linear: linear / slide }
    } else {
        Screw { angular: angular / angle, linear: linear / angle }
    })
}

impl Mechanism {
    /// Builds a mechanism from named legs, each a list of joints of one freedom from base to platform.
    ///
    /// A screw does not say where on its axis the joint is: it is put at the axis's point nearest to
    /// the origin. A prismatic joint is put where the next joint of its leg is that is none, or else where the one before is;
    /// in a leg of prismatic joints alone, at the platform's reference point. A pitch that the decomposition
    /// takes for zero ([`TOLERANCE`] of the mechanism's size) is rounding: that joint is revolute.
    ///
    /// # Errors
    /// The index of the leg, the index of the joint in it, and why its screw is not one of a joint.
    pub fn from_screws(
        name: impl Into<String>,
        legs: impl IntoIterator<Item = (String, Vec<ScrewJoint>)>,
        platform: Point3<f64>,
    ) -> Result<Self, (usize, usize, ScrewError)> {
        let mut legs: Vec<_> = legs.into_iter().collect();
        let mut axes = Vec::new();
        for (leg, (_, joints)) in legs.iter_mut().enumerate() {
            for (number, joint) in joints.iter_mut().enumerate() {
                joint.screw = normalized(&joint.screw).map_err(|error| (leg, number, error))?;
                if joint.screw.angular != Vector3::zeros() {
                    axes.push((joint.screw, foot(&joint.screw)));
                }
            }
        }
        let least = TOLERANCE * Frame::of(&axes).length;
        let build = |joint: ScrewJoint| {
            let ScrewJoint { name, screw, actuated, home, limits } = joint;
            let slides = screw.angular == Vector3::zeros();
            let (axis, kind, point) = if slides {
                (screw.linear, JointKind::Prismatic, platform)
            } else {
                let pitch = pitch(&screw);
                let kind = match pitch.abs() <= least {
                    true => JointKind::Revolute,
                    false => JointKind::Helical { pitch },
                };
                (screw.angular, kind, foot(&screw))
            };
            let built = Joint::new(name, kind, Unit::new_unchecked(axis), point);
            let built = built.at(home).within(limits);
            (if actuated { built.actuated() } else { built }, !slides)
        };
        let legs = legs
            .into_iter()
            .map(|(name, joints)| Leg::new(name, placed(joints.into_iter().map(build).collect())))
            .collect();
        let (task, bodies) = (TaskHints::default(), BodyMasses::default());
        let shapes = Shapes::default();
        let units = FileUnits::SI;
        Ok(Self {
            name: name.into(),
            legs,
            platform,
            differences: Vec::new(),
            task,
            bodies,
            shapes,
            units,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{examples, file};

    /// Pitches and positions in the shipped mechanisms are up to a metre.
    const CLOSE: f64 = 1e-14;

    fn from(screws: &[Screw]) -> Result<Mechanism, (usize, usize, ScrewError)> {
        let joint = |(i, &screw): (usize, &Screw)| ScrewJoint {
            name: format!("q{i}"),
            screw,
            actuated: i == 0,
            home: 0.0,
            limits: None,
        };
        let joints = screws.iter().enumerate().map(joint).collect();
        Mechanism::from_screws("test", [("leg1".to_owned(), joints)], Point3::origin())
    }

    #[test]
    fn joints_are_recovered_from_screws_of_any_length() {
        for example in examples::EXAMPLES {
            let mechanism = file::read(example.text).unwrap().mechanism;
            let joints: Vec<_> = mechanism.joints().filter(|j| j.freedoms() == 1).collect();
            for scale in [1.0, -3.0, 1e-8] {
                let screws: Vec<_> = joints
                    .iter()
                    .map(|j| Screw::from_vector(&(j.screws()[0].to_vector() * scale)))
                    .collect();
                let built = from(&screws).unwrap();
                for (built, joint) in built.joints().zip(&joints) {
                    let (a, b) = (built.screws()[0].to_vector(), joint.screws()[0].to_vector());
                    assert!((a - b * scale.signum()).amax() < CLOSE, "{}", joint.name);
                    match (built.kind, joint.kind) {
                        (JointKind::Helical { .. }, JointKind::Helical { .. }) => {}
                        (built, kind) => assert_eq!(built, kind),
                    }
                }
            }
        }
    }

    #[test]
    fn rounding_makes_neither_a_pitch_nor_a_rotation() {
        let (axis, point) = (Vector3::new(1.0, 2.0, -0.5), Vector3::new(0.1, -0.2, 0.3));
        let noise = Vector3::new(1e-17, -2e-17, 3e-17);
        let revolute = Screw { angular: axis, linear: point.cross(&axis) + axis * 1e-16 };
        let prismatic = Screw { angular: noise, linear: axis };
        let built = from(&[revolute, prismatic]).unwrap();
        let kinds: Vec<_> = built.joints().map(|joint| joint.kind).collect();
        assert_eq!(kinds, [JointKind::Revolute, JointKind::Prismatic]);
    }

    /// Screws in single precision, and with six digits: joints keep their kinds, and pitches are deliberate ones.
    #[test]
    fn rounded_screws_keep_their_kinds() {
        for example in examples::EXAMPLES {
            let mechanism = file::read(example.text).unwrap().mechanism;
            let joints: Vec<_> = mechanism.joints().filter(|j| j.freedoms() == 1).collect();
            let single = |c: f64| f64::from(c as f32);
            let six_digits = |c: f64| format!("{c:.5e}").parse().unwrap();
            for round in [single as fn(f64) -> f64, six_digits] {
                let screws = joints.iter().map(|j| {
                    // Of no particular length, so that all numbers are rounded.
                    Screw::from_vector(&(j.screws()[0].to_vector() * 0.7).map(round))
                });
                let built = from(&screws.collect::<Vec<_>>()).unwrap();
                for (built, joint) in built.joints().zip(&joints) {
                    let kinds = [built.kind, joint.kind].map(|kind| std::mem::discriminant(&kind));
                    assert_eq!(kinds[0], kinds[1], "{}: {}", example.name, joint.name);
                }
            }
        }
    }

    #[test]
    fn an_invalid_screw_is_reported_by_leg_and_joint() {
        let good = Screw::translation(Vector3::x_axis());
        let of = |linear| Screw { angular: Vector3::zeros(), linear };
        let zero = from(&[good, of(Vector3::zeros())]).unwrap_err();
        assert_eq!(zero, (0, 1, ScrewError::Zero));
        for odd in [f64::NAN, f64::INFINITY, -2e9] {
            let (leg, joint, error) =
                from(&[good, good, of(Vector3::new(1.0, odd, 0.0))]).unwrap_err();
            assert_eq!((leg, joint), (0, 2));
            assert!(error.to_string().starts_with(&odd.to_string()), "{error}");
        }
    }
}
