//! The screws of all joints at a solved pose.
//!
//! A leg's joints displace each other from the base on: the screw of a joint is its screw at home, displaced by all
//! joints before it (the product of exponentials; R. Murray, Z. Li, S. Sastry, *A Mathematical Introduction to Robotic
//! Manipulation*, 1994, eq. 3.54).

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use opm_core::group::screw::Screw;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::joint::JointKind;
use std::ops::Range;

/// One freedom of a joint.
#[derive(Clone, Debug)]
pub struct Freedom {
    /// Its unit screw at home, base coordinates.
    home: Screw,
    /// The joint's point at home, metres.
    home_point: Point3<f64>,
    /// The value at home.
    home_value: f64,
    /// The value at the pose.
    value: f64,
    /// Its number among those of a spherical joint.
    pub of_ball: Option<usize>,
    /// Its unit screw at the pose, base coordinates.
    pub screw: Screw,
    /// The joint's point at the pose, metres.
    pub point: Point3<f64>,
    /// The displacement from home of what the freedom moves; of a ball's freedoms, only the last one has it.
    pub after: Isometry3<f64>,
}

/// The screws of all joints at a pose, in the order of the joint coordinates. The buffer is filled by
/// [`Screws::update`], which allocates nothing.
#[derive(Clone, Debug)]
pub struct Screws {
    /// One for each joint coordinate.
    pub freedoms: Vec<Freedom>,
    /// Those of each leg.
    pub legs: Vec<Range<usize>>,
    /// The displacement of each leg's end from home.
    ends: Vec<Isometry3<f64>>,
}

impl Screws {
    /// A buffer for a manipulator, at home.
    pub fn new(manipulator: &Manipulator) -> Self {
        let (mut freedoms, mut legs) = (Vec::new(), Vec::new());
        for leg in &manipulator.mechanism().legs {
            let first = freedoms.len();
            for joint in &leg.joints {
                let ball = joint.kind == JointKind::Spherical;
                let each = joint.screws().into_iter().zip(&joint.coordinates).enumerate();
                freedoms.extend(each.map(|(number, (screw, coordinate))| Freedom {
                    home: screw,
                    home_point: joint.point,
                    home_value: coordinate.home,
                    value: coordinate.home,
                    of_ball: ball.then_some(number),
                    screw,
                    point: joint.point,
                    after: Isometry3::identity(),
                }));
            }
            legs.push(first..freedoms.len());
        }
        let ends = vec![Isometry3::identity(); legs.len()];
        Self { freedoms, legs, ends }
    }

    /// Takes the joints of a solution.
    pub fn update(&mut self, at: &Solution) {
        let values = at.joints();
        for (leg, end) in self.legs.iter().zip(&mut self.ends) {
            let mut g = Isometry3::identity();
            for number in leg.clone() {
                let freedom = &mut self.freedoms[number];
                freedom.screw = freedom.home.transformed(&g);
                freedom.point = g * freedom.home_point;
                freedom.value = values[number];
                match freedom.of_ball {
                    None => g *= freedom.home.exp(freedom.value - freedom.home_value),
                    // The three values are one rotation vector.
                    Some(2) => {
                        let point = freedom.home_point.coords;
                        let vector = rotation_vector(&self.freedoms[number - 2..=number]);
                        let rotation = UnitQuaternion::from_scaled_axis(vector);
                        let shift = Translation3::from(point - rotation * point);
                        g *= Isometry3::from_parts(shift, rotation);
                    }
                    Some(_) => {}
                }
                self.freedoms[number].after = g;
            }
            *end = g;
        }
    }

    /// The rotation vector from home of a spherical joint, by the number of its first coordinate.
    pub fn rotation_vector(&self, first: usize) -> Vector3<f64> {
        rotation_vector(&self.freedoms[first..first + 3])
    }

    /// The displacement of the end of a leg, which is the platform, from home.
    pub fn end(&self, leg: usize) -> &Isometry3<f64> {
        &self.ends[leg]
    }
}

/// The rotation vector from home of a spherical joint with these three freedoms.
fn rotation_vector(freedoms: &[Freedom]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| freedoms[i].value - freedoms[i].home_value)
}
