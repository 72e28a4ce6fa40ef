//! Inputs of legs that are taken whole: where the legs' constraints tie both sections together, no section has an input for
//! each of its freedoms, but the mechanism has.

use super::{InputIndices, ZERO};
use crate::screws::{Freedom, Screws};
use nalgebra::{Matrix6, Point3, Vector3, Vector6};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::leg::Section;
use opm_core::velocity::Jacobians;

/// A joint's twist is dependent on others if less than this share of it is left without them: rounding.
const DEPENDENT: f64 = 1e-9;

/// The inputs of a mechanism, and what their indices are computed with.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    jacobians: Jacobians,
    /// The leg and the section of each actuated joint.
    inputs: Vec<(usize, Section)>,
    length: f64,
}

/// A force, and its moment about a point.
struct Wrench {
    force: Vector3<f64>,
    moment: Vector3<f64>,
    about: Point3<f64>,
}

impl Whole {
    /// For a mechanism with dependent coordinates, or with legs that are solved whole, and as many inputs as freedoms; `None`
    /// for others.
    pub fn new(manipulator: &Manipulator) -> Option<Self> {
        let freedoms = manipulator.task_coordinates().len();
        let tied = manipulator.is_whole() || !manipulator.dependent_coordinates().is_empty();
        if !tied || manipulator.actuated().len() != freedoms {
            return None;
        }
        let mut places = Vec::new();
        for (leg, split) in manipulator.decomposition().legs.iter().enumerate() {
            places.extend(split.lower.iter().map(|_| (leg, Section::Lower)));
            places.extend(split.upper.iter().map(|_| (leg, Section::Upper)));
        }
        let inputs = manipulator.actuated().iter().map(|&number| places[number]).collect();
        let length = manipulator.characteristic_length();
        Some(Self { jacobians: manipulator.jacobians(), inputs, length })
    }

    /// Adds the indices of all inputs at a solved pose.
    pub fn indices(
        &mut self,
        (manipulator, at): (&Manipulator, &Solution),
        screws: &Screws,
        found: &mut Vec<InputIndices>,
    ) {
        let outputs = self.outputs(manipulator, at);
        let reference = at.displacement(manipulator) * manipulator.mechanism().platform;
        let actuated = manipulator.actuated();
        for (column, (&number, &(leg, section))) in actuated.iter().zip(&self.inputs).enumerate() {
            let own = screws.legs[leg].clone();
            let leg_of = Leg {
                joints: &screws.freedoms[own.clone()],
                actuated: &actuated[actuated.partition_point(|&a| a < own.start)
                    ..actuated.partition_point(|&a| a < own.end)],
                first: own.start,
            };
            let place = number - own.start;
            let wrench = leg_of.wrench(place, self.length);
            let own = &leg_of.joints[place].screw;
            let beside = leg_of.axes().min_by_key(|&(i, _)| (i.abs_diff(place), i < place));
            let last = leg_of.axes().last();
            let input = wrench.as_ref().map_or(0.0, |wrench| {
                let at = wrench.beside(beside.map(|(_, joint)| joint));
                wrench.cosine(&at, &own.angular, &(own.linear + own.angular.cross(&at.coords)))
            });
            let output = match (&wrench, &outputs) {
                (Some(wrench), Some(outputs)) => {
                    let at = wrench.beside(last.map(|(_, joint)| joint));
                    let twist = outputs.column(column);
                    let angular = Vector3::new(twist[0], twist[1], twist[2]);
                    let linear = Vector3::new(twist[3], twist[4], twist[5]);
                    wrench.cosine(&at, &angular, &(linear + angular.cross(&(at - reference))))
                }
                _ => 0.0,
            };
            found.push(InputIndices { leg, section, coordinate: Some(number), input, output });
        }
    }

    /// The platform's twist `(ω; v)` of the reference point for a unit rate of each input alone, a column for each; `None`
    /// where the pose is singular. The joints that constraining legs lack do not move.
    fn outputs(&mut self, manipulator: &Manipulator, at: &Solution) -> Option<Matrix6<f64>> {
        if !manipulator.differentiate(at, &mut self.jacobians).unwrap_or(false) {
            return None;
        }
        let Jacobians { joints, locked, platform, .. } = &self.jacobians;
        let (inputs, count) = (manipulator.actuated(), platform.ncols());
        let rates = Matrix6::from_fn(|row, column| match (inputs.get(row), row < count) {
            _ if column >= count || row >= count => f64::from(u8::from(row == column)),
            (Some(&number), _) => joints[(number, column)],
            (None, _) => locked[(row - inputs.len(), column)],
        });
        let inverse = rates.try_inverse()?;
        let turn = at.lower_displacement(manipulator).rotation;
        let mut twists = Matrix6::zeros();
        for input in 0..inputs.len() {
            for part in [0, 3] {
                let sum = (0..count).map(|k| {
                    let of = platform.fixed_view::<3, 1>(part, k);
                    of * inverse[(k, input)]
                });
                let twist: Vector3<f64> = turn * sum.sum::<Vector3<f64>>();
                twists.fixed_view_mut::<3, 1>(part, input).copy_from(&twist);
            }
        }
        twists.iter().all(|entry| entry.is_finite()).then_some(twists)
    }
}

/// A leg at a pose.
struct Leg<'a> {
    joints: &'a [Freedom],
    /// The numbers of its actuated coordinates, among those of the mechanism.
    actuated: &'a [usize],
    /// The number of its first coordinate.
    first: usize,
}

impl Leg<'_> {
    /// The passive joints that turn about an axis, with their numbers.
    fn axes(&self) -> impl Iterator<Item = (usize, &Freedom)> + Clone {
        let passive = |i: &usize| !self.actuated.contains(&(self.first + i));
        let each = (0..self.joints.len()).filter(passive).map(|i| (i, &self.joints[i]));
        each.filter(|(_, joint)| turns(joint))
    }

    /// The wrench that is reciprocal to all joints but one, and perpendicular to those that are reciprocal to all, about the
    /// point in which most passive axes meet; `None` if there is none, at a serial singularity.
    ///
    /// It is what is left of the joint's twist, as a vector, without its parts along the others.
    fn wrench(&self, place: usize, length: f64) -> Option<Wrench> {
        let about = self.meeting(length);
        let row = |freedom: &Freedom| -> Vector6<f64> {
            let screw = &freedom.screw;
            let velocity = (screw.linear + screw.angular.cross(&about.coords)) / length;
            let (v, w) = (velocity, screw.angular);
            Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
        };
        let (mut basis, mut count) = ([Vector6::zeros(); 6], 0);
        let without = |basis: &[Vector6<f64>], row: Vector6<f64>| {
            // Twice is enough (G. Golub, C. Van Loan, *Matrix Computations*, section 5.2).
            let once = |row: Vector6<f64>| basis.iter().fold(row, |row, b| row - b * b.dot(&row));
            let left = once(once(row));
            (left.norm() > DEPENDENT * row.norm()).then(|| left.normalize())
        };
        for (_, joint) in self.joints.iter().enumerate().filter(|(i, _)| *i != place) {
            if let Some(left) = without(&basis[..count], row(joint)) {
                *basis.get_mut(count)? = left;
                count += 1;
            }
        }
        let left = without(&basis[..count], row(&self.joints[place]))?;
        let force = Vector3::new(left[0], left[1], left[2]);
        let moment = Vector3::new(left[3], left[4], left[5]) * length;
        Some(Wrench { force, moment, about })
    }

    /// The point in which most passive axes meet, the one next to the platform if several do; that of the last axis if none
    /// meet.
    fn meeting(&self, length: f64) -> Point3<f64> {
        /// Axes nearer than this share of the size meet.
        const NEAR: f64 = 1e-9;
        let on = |point: &Point3<f64>, axis: &Freedom| {
            (point - axis.point).cross(&axis.screw.angular).norm() < NEAR * length
        };
        let mut best: Option<(usize, Point3<f64>)> = None;
        for (i, one) in self.axes() {
            for (_, other) in self.axes().filter(|(k, _)| *k > i) {
                let Some(point) = nearest(one, &other.point, &other.screw.angular) else {
                    continue;
                };
                let count = self.axes().filter(|(_, axis)| on(&point, axis)).count();
                if count > 1 && best.is_none_or(|(most, _)| count >= most) {
                    best = Some((count, point));
                }
            }
        }
        let last = self.axes().last().map(|(_, joint)| joint).or(self.joints.last());
        best.map_or_else(|| last.map_or(Point3::origin(), |last| last.point), |(_, point)| point)
    }
}

/// Whether a joint turns about an axis.
fn turns(freedom: &Freedom) -> bool {
    let pitch = freedom.screw.linear.dot(&freedom.screw.angular);
    freedom.screw.angular.norm() > 0.5 && pitch.abs() < ZERO
}

/// The point of a joint's axis that is nearest to a line; `None` if they are parallel.
fn nearest(joint: &Freedom, point: &Point3<f64>, direction: &Vector3<f64>) -> Option<Point3<f64>> {
    let axis = joint.screw.angular;
    let across = axis.cross(direction);
    let square = across.norm_squared();
    if square < ZERO * direction.norm_squared() {
        return None;
    }
    let along = (point - joint.point).cross(direction).dot(&across) / square;
    Some(joint.point + axis * along)
}

impl Wrench {
    /// The characteristic point on a joint's axis: where it meets the force's line.
    fn beside(&self, joint: Option<&Freedom>) -> Point3<f64> {
        let Some(joint) = joint else { return self.about };
        if self.force.norm() < ZERO.sqrt() {
            return joint.point;
        }
        let on = self.about + self.force.cross(&self.moment) / self.force.norm_squared();
        nearest(joint, &on, &self.force).unwrap_or(joint.point)
    }

    /// The power on a twist, with the velocity of a point, over the most that a wrench of this strength there has.
    fn cosine(&self, at: &Point3<f64>, angular: &Vector3<f64>, velocity: &Vector3<f64>) -> f64 {
        let moment = self.moment + (self.about - at).cross(&self.force);
        let power = (self.force.dot(velocity) + moment.dot(angular)).abs();
        let most = self.force.norm() * velocity.norm() + moment.norm() * angular.norm();
        if most > 0.0 { (power / most).min(1.0) } else { 0.0 }
    }
}
