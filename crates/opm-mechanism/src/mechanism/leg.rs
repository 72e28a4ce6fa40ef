//! A leg: joints in series from the base to the platform.

use crate::group::screw::Screw;
use crate::mechanism::joint::{Joint, JointCoordinate, ValueCountError};
use nalgebra::{Isometry3, Point3, Vector3};
use std::fmt;

/// Name, origin and sign of a leg's imaginary joint, where the mechanism has a convention for them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ImaginaryLabel {
    /// The joint's name, such as `theta11`.
    pub name: String,
    /// The joint's value at home, radians or metres.
    pub home: f64,
    /// Motion along this direction, or right-handed rotation about it, counts as positive.
    pub positive: Vector3<f64>,
}

/// A leg: joints in series from the base to the platform, at the assembled home pose.
///
/// ```
/// use opm_core::nalgebra::{Point3, Vector3};
/// use opm_core::{Joint, JointKind, Leg};
///
/// // A crank that rotates about z, and carries a slider along the crank.
/// let crank = Joint::new("r1", JointKind::Revolute, Vector3::z_axis(), Point3::origin());
/// let slider = Joint::new("S1", JointKind::Prismatic, Vector3::x_axis(), Point3::origin());
/// let leg = Leg::new("leg1", vec![crank.actuated(), slider]);
///
/// let moved = leg.displacement(&[90_f64.to_radians(), 0.2])? * Point3::origin();
/// assert!((moved - Point3::new(0.0, 0.2, 0.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Leg {
    /// The leg's name, unique in its mechanism.
    pub name: String,
    /// The joints, from base to platform.
    pub joints: Vec<Joint>,
    /// The convention for the imaginary joint. Without one, the joint is called `tau.NAME` and is
    /// zero at home.
    pub imaginary: Option<ImaginaryLabel>,
}

/// Puts sliders that have no place of their own on their leg: where the next joint is that has one, or else the one before. In
/// a leg without such a joint they stay at the platform. Each joint comes with whether it has a place.
pub(crate) fn placed(joints: Vec<(Joint, bool)>) -> Vec<Joint> {
    let place = |joint: &(Joint, bool)| joint.1.then_some(joint.0.point);
    let places: Vec<Option<Point3<f64>>> = (0..joints.len())
        .map(|i| {
            let after = joints[i..].iter().find_map(place);
            after.or_else(|| joints[..i].iter().rev().find_map(place))
        })
        .collect();
    let moved = joints.into_iter().zip(places);
    moved
        .map(|((joint, _), place)| Joint { point: place.unwrap_or(joint.point), ..joint })
        .collect()
}

impl Leg {
    /// Builds a leg whose imaginary joint, if it gets one, has the default name.
    pub fn new(name: impl Into<String>, joints: Vec<Joint>) -> Self {
        Self { name: name.into(), joints, imaginary: None }
    }

    /// The name of the leg's imaginary joint, if it gets one.
    pub fn imaginary_name(&self) -> String {
        match &self.imaginary {
            Some(label) => label.name.clone(),
            None => format!("tau.{}", self.name),
        }
    }

    /// The unit screws of the leg at home, one per freedom, from base to platform.
    pub fn screws(&self) -> Vec<Screw> {
        self.joints.iter().flat_map(Joint::screws).collect()
    }

    /// The screws of the leg at home that can move independently of each other, from base to platform: as [`Leg::screws`], but
    /// one for the two hinges of a parallelogram, a translation.
    pub fn independent_screws(&self) -> Vec<Screw> {
        let mut screws: Vec<Screw> = Vec::new();
        for joint in &self.joints {
            let own = joint.screws();
            match (joint.turns_back, screws.last_mut(), &own[..]) {
                (true, Some(first), [back]) => *first = *first - *back,
                _ => screws.extend(own),
            }
        }
        screws
    }

    /// The first hinges of its [parallelograms](Joint::parallelogram).
    pub fn parallelograms(&self) -> impl Iterator<Item = &Joint> {
        self.joints.windows(2).filter(|two| two[1].turns_back).map(|two| &two[0])
    }

    /// Of each freedom, whether it turns back what the one before it turned.
    pub fn turn_back(&self) -> Vec<bool> {
        let of = |joint: &Joint| std::iter::repeat_n(joint.turns_back, joint.freedoms());
        self.joints.iter().flat_map(of).collect()
    }

    /// Makes the second hinge of each parallelogram turn back what the first one turns, in displacements of the leg's freedoms.
    ///
    /// ```
    /// use opm_core::nalgebra::{Point3, Vector3};
    /// use opm_core::{Joint, Leg};
    ///
    /// let ends = [Point3::origin(), Point3::new(0.2, 0.0, 0.0)];
    /// let leg = Leg::new("leg1", Joint::parallelogram("p1", Vector3::z_axis(), ends).to_vec());
    /// let mut displacements = [0.3, 0.7];
    /// leg.hold_parallelograms(&mut displacements);
    /// assert_eq!(displacements, [0.3, -0.3]);
    /// ```
    pub fn hold_parallelograms(&self, displacements: &mut [f64]) {
        for (freedom, back) in self.turn_back().into_iter().enumerate() {
            if back {
                displacements[freedom] = -displacements[freedom - 1];
            }
        }
    }

    /// Every coordinate of every joint, from base to platform. [`Leg::displacement`] takes its
    /// values in this order.
    pub fn coordinates(&self) -> impl Iterator<Item = &JointCoordinate> {
        self.joints.iter().flat_map(|joint| &joint.coordinates)
    }

    /// The platform's displacement from home for the joint coordinates of this leg. It is the
    /// product of exponentials of the leg's joints and uses no decomposition.
    ///
    /// # Errors
    /// There are not as many values as [`Leg::coordinates`].
    pub fn displacement(&self, values: &[f64]) -> Result<Isometry3<f64>, ValueCountError> {
        ValueCountError::check(&self.name, values, self.coordinates().count())?;
        let mut rest = values;
        Ok(self.joints.iter().fold(Isometry3::identity(), |g, joint| {
            let (own, after) = rest.split_at(joint.coordinates.len());
            rest = after;
            g * joint.moved_to(own)
        }))
    }
}

/// One of the two sections into which a leg is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Section {
    /// The section on the base side, which moves in the group `A`.
    Lower,
    /// The section on the platform side, which moves in the group `B`.
    Upper,
}

impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::joint::JointKind;
    use nalgebra::Point3;

    /// Too few and too many values are an error that names the leg.
    #[test]
    fn a_displacement_needs_a_value_for_each_coordinate() {
        let ball = Joint::new("s", JointKind::Spherical, Vector3::z_axis(), Point3::origin());
        let leg = Leg { name: "leg1".to_owned(), joints: vec![ball], imaginary: None };
        assert_eq!(leg.displacement(&[0.0; 3]), Ok(Isometry3::identity()));
        for given in [0, 2, 4] {
            let error = leg.displacement(&vec![0.0; given]).unwrap_err().to_string();
            let expected = format!(
                "leg1: the number of values is {given}, expected 3, one for each coordinate"
            );
            assert_eq!(error, expected);
            assert!(leg.joints[0].displacement(&vec![0.0; given]).is_err());
        }
    }
}
