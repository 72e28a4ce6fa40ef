//! Mechanisms from nothing but the screws of their joints.

use super::{Mechanism, TaskHints};
use crate::group::screw::Screw;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::Leg;
use nalgebra::{Point3, Unit, Vector3};

/// A joint of one freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct ScrewJoint {
    /// Name.
    pub name: String,
    /// Its twist at the assembled home for any rate but zero: only its direction counts.
    pub screw: Screw,
    /// Driven by a motor.
    pub actuated: bool,
    /// Its value at home, radians or metres.
    pub home: f64,
    /// Lowest and highest value.
    pub limits: Option<[f64; 2]>,
}

/// A screw that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ScrewError {
    /// Nothing moves.
    #[error("all six components are zero, expected (omega; v) of a joint")]
    Zero,
    /// Not a number, or too large to compute with.
    #[error("{0} is among its components, expected numbers of a size of at most 1e9")]
    Component(f64),
}

/// Larger than the place of any machine, metres: an axis that is further away is a translation, and
/// its angular part is what rounding has left.
const FARTHEST: f64 = 1e9;

/// Pitches over the mechanism's size that rounding may leave of none. Far below what the
/// decomposition still takes for none ([`TOLERANCE`](crate::group::subspace::TOLERANCE)).
const ROUNDING: f64 = 1e-9;

impl Screw {
    /// Advance along the axis, metres a radian: `ω·v / ω²`.
    fn pitch(&self) -> f64 {
        self.angular.dot(&self.linear) / self.angular.norm_squared()
    }

    /// The point of the axis that is nearest to the origin: `ω × v / ω²`.
    fn foot(&self) -> Vector3<f64> {
        self.angular.cross(&self.linear) / self.angular.norm_squared()
    }

    /// With a unit vector along the axis; `Err` where there is none.
    fn normalized(&self) -> Result<Self, ScrewError> {
        let components = self.to_vector();
        if let Some(&odd) = components.iter().find(|c| c.is_nan() || c.abs() > FARTHEST) {
            return Err(ScrewError::Component(odd));
        }
        let largest = components.amax();
        if largest == 0.0 {
            return Err(ScrewError::Zero);
        }
        // First to numbers near one, whose squares neither vanish nor overflow.
        let Self { angular, linear } = Self::from_vector(&(components / largest));
        let (angle, slide) = (angular.norm(), linear.norm());
        Ok(if angle * FARTHEST < slide {
            Self { angular: Vector3::zeros(), linear: linear / slide }
        } else {
            Self { angular: angular / angle, linear: linear / angle }
        })
    }
}

impl Mechanism {
    /// A mechanism whose legs have joints of one freedom, named each, base first. What a screw does
    /// not tell is the point of its axis: the one nearest to the origin; of a prismatic joint the
    /// platform's.
    ///
    /// # Errors
    /// The number of the leg and of its joint of which the screw is none.
    pub fn from_screws(
        name: impl Into<String>,
        legs: impl IntoIterator<Item = (String, Vec<ScrewJoint>)>,
        platform: Point3<f64>,
    ) -> Result<Self, (usize, usize, ScrewError)> {
        let mut legs: Vec<_> = legs.into_iter().collect();
        let mut size: f64 = 0.0;
        for (leg, (_, joints)) in legs.iter_mut().enumerate() {
            for (number, joint) in joints.iter_mut().enumerate() {
                joint.screw = joint.screw.normalized().map_err(|error| (leg, number, error))?;
                if joint.screw.angular != Vector3::zeros() {
                    size = size.max(joint.screw.linear.norm());
                }
            }
        }
        let build = |joint: ScrewJoint| {
            let ScrewJoint { name, screw, actuated, home, limits } = joint;
            let (axis, kind, point) = if screw.angular == Vector3::zeros() {
                (screw.linear, JointKind::Prismatic, platform)
            } else {
                let pitch = screw.pitch();
                let kind = match pitch.abs() <= ROUNDING * size {
                    true => JointKind::Revolute,
                    false => JointKind::Helical { pitch },
                };
                (screw.angular, kind, Point3::from(screw.foot()))
            };
            let built = Joint::new(name, kind, Unit::new_unchecked(axis), point);
            let built = built.at(home).within(limits);
            if actuated { built.actuated() } else { built }
        };
        let legs = legs
            .into_iter()
            .map(|(name, joints)| Leg::new(name, joints.into_iter().map(build).collect()))
            .collect();
        Ok(Self { name: name.into(), legs, platform, task: TaskHints::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{examples, file};

    /// Pitches and places of shipped mechanisms are up to a metre.
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
    fn screws_of_any_length_are_the_joints_that_they_came_from() {
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
    fn what_rounding_leaves_is_no_pitch_and_no_rotation() {
        let (axis, point) = (Vector3::new(1.0, 2.0, -0.5), Vector3::new(0.1, -0.2, 0.3));
        let noise = Vector3::new(1e-17, -2e-17, 3e-17);
        let turn = Screw { angular: axis, linear: point.cross(&axis) + axis * 1e-16 };
        let slide = Screw { angular: noise, linear: axis };
        let built = from(&[turn, slide]).unwrap();
        let kinds: Vec<_> = built.joints().map(|joint| joint.kind).collect();
        assert_eq!(kinds, [JointKind::Revolute, JointKind::Prismatic]);
    }

    #[test]
    fn a_screw_that_is_none_is_named() {
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
