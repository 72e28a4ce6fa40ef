//! The joint screws of a leg's part at an assembled pose near home.
//!
//! A part moves in its group wherever its joints are, but its screws at home may span less than the group: two axes
//! through the centre of a sphere that lie in a plane with those of all other legs, for instance.

use super::Freedom;
use super::mobility::Mobility;
use crate::group::screw::Screw;
use crate::group::subspace::{Fit, Frame, fit};
use crate::mechanism::Mechanism;
use nalgebra::{Isometry3, Vector6};

/// The normalised screws of all freedoms at home, and their coordinates at a pose nearby.
pub(super) struct NearbyPose {
    /// By leg, joint and index.
    legs: Vec<Vec<Vec<(Screw, f64)>>>,
}

/// The part of a leg at the pose, seen from its end towards the platform.
pub(super) struct NearbyPart {
    /// Its unit screws.
    pub screws: Vec<Vector6<f64>>,
    /// The inverse of its displacement.
    inverse: Isometry3<f64>,
}

impl NearbyPose {
    /// The pose of a mechanism's report; home if it has none.
    pub fn new(mechanism: &Mechanism, frame: &Frame, report: &Mobility) -> Self {
        Self::at(mechanism, frame, report.nearby.iter().flatten().copied())
    }

    /// Home.
    pub fn home(mechanism: &Mechanism, frame: &Frame) -> Self {
        Self::at(mechanism, frame, std::iter::empty())
    }

    /// The pose with these coordinates; those that are missing are zero.
    fn at(
        mechanism: &Mechanism,
        frame: &Frame,
        mut coordinates: impl Iterator<Item = f64>,
    ) -> Self {
        let mut legs = vec![];
        for leg in &mechanism.legs {
            let mut joints = vec![];
            for joint in &leg.joints {
                let mut with = |screw: &Screw| {
                    (frame.normalised(screw), coordinates.next().unwrap_or_default())
                };
                joints.push(joint.screws().iter().map(&mut with).collect());
            }
            legs.push(joints);
        }
        Self { legs }
    }

    /// Some freedoms of a leg, from base to platform.
    pub fn part(&self, leg: usize, freedoms: &[Freedom]) -> NearbyPart {
        let mut inverse = Isometry3::identity();
        let mut screws = vec![];
        for freedom in freedoms.iter().rev() {
            let (screw, coordinate) = &self.legs[leg][freedom.joint][freedom.index];
            screws.push(screw.transformed(&inverse).to_vector().normalize());
            inverse *= screw.exp(-coordinate);
        }
        screws.reverse();
        NearbyPart { screws, inverse }
    }
}

impl NearbyPart {
    /// A unit screw at the part's end towards the base, as [`screws`](Self::screws) are seen.
    pub fn seen(&self, screw: &Vector6<f64>) -> Vector6<f64> {
        Screw::from_vector(screw).transformed(&self.inverse).to_vector().normalize()
    }
}

/// The group of some parts, with these screws at home. Those nearby count only where those at home span no group.
pub(super) fn group_of(
    home: &[Vector6<f64>],
    nearby: impl Fn() -> Vec<Vector6<f64>>,
) -> Option<Fit> {
    fit(home).or_else(|| fit(&[home, &nearby()].concat()))
}
