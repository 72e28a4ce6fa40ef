//! Inputs of legs that are taken whole: where the legs' constraints tie both sections together, no section has an input for
//! each of its freedoms, but the mechanism has.

use super::{InputIndices, ZERO};
use crate::screws::{Freedom, Screws};
use nalgebra::{DMatrix, Point3, Vector3, Vector6};
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
    /// For a mechanism with dependent coordinates and as many inputs as freedoms; `None` for others.
    pub fn new(manipulator: &Manipulator) -> Option<Self> {
        let freedoms = manipulator.task_coordinates().len();
        let tied = !manipulator.dependent_coordinates().is_empty();
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
            let chain = &screws.freedoms[screws.legs[leg].clone()];
            let place = number - screws.legs[leg].start;
            let passive = |i: &usize| !actuated.contains(&(screws.legs[leg].start + i));
            let passive: Vec<usize> = (0..chain.len()).filter(passive).collect();
            let wrench = self.wrench(chain, place, &passive);
            let own = &chain[place].screw;
            let next = passive.iter().copied().filter(|&i| turns(&chain[i]));
            let beside = next.clone().min_by_key(|&i| (i.abs_diff(place), i < place));
            let input = wrench.as_ref().map_or(0.0, |wrench| {
                let at = wrench.beside(beside.map(|i| &chain[i]));
                wrench.cosine(&at, &own.angular, &(own.linear + own.angular.cross(&at.coords)))
            });
            let output = match (&wrench, &outputs) {
                (Some(wrench), Some(outputs)) => {
                    let at = wrench.beside(next.last().map(|i| &chain[i]));
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

    /// The platform's twist `(ω; v)` of the reference point for a unit rate of each input alone; `None` where the pose is
    /// singular.
    fn outputs(&mut self, manipulator: &Manipulator, at: &Solution) -> Option<DMatrix<f64>> {
        if !manipulator.differentiate(at, &mut self.jacobians).unwrap_or(false) {
            return None;
        }
        let joints = self.jacobians.joints_by_pose();
        let rates = DMatrix::from_fn(self.inputs.len(), joints.ncols(), |row, column| {
            joints[(manipulator.actuated()[row], column)]
        });
        let twists = manipulator.twist_by_pose(&self.jacobians) * rates.try_inverse()?;
        twists.iter().all(|entry| entry.is_finite()).then_some(DMatrix::from_column_slice(
            6,
            twists.ncols(),
            twists.as_slice(),
        ))
    }

    /// The wrench that is reciprocal to all joints of a leg but one, and perpendicular to those that are reciprocal to all,
    /// about the point in which most passive axes meet; `None` if there is none, at a serial singularity.
    ///
    /// It is what is left of the joint's twist, as a vector, without its parts along the others.
    fn wrench(&self, chain: &[Freedom], place: usize, passive: &[usize]) -> Option<Wrench> {
        let about = meeting(chain, passive, self.length);
        let row = |freedom: &Freedom| -> Vector6<f64> {
            let screw = &freedom.screw;
            let velocity = (screw.linear + screw.angular.cross(&about.coords)) / self.length;
            let (v, w) = (velocity, screw.angular);
            Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
        };
        let mut basis: Vec<Vector6<f64>> = Vec::with_capacity(chain.len());
        let without = |basis: &[Vector6<f64>], row: Vector6<f64>| {
            // Twice is enough (G. Golub, C. Van Loan, *Matrix Computations*, section 5.2).
            let once = |row: Vector6<f64>| basis.iter().fold(row, |row, b| row - b * b.dot(&row));
            let left = once(once(row));
            (left.norm() > DEPENDENT * row.norm()).then_some(left)
        };
        for (_, freedom) in chain.iter().enumerate().filter(|(i, _)| *i != place) {
            basis.extend(without(&basis, row(freedom)).map(|left| left.normalize()));
        }
        let left = without(&basis, row(&chain[place]))?.normalize();
        let force = Vector3::new(left[0], left[1], left[2]);
        let moment = Vector3::new(left[3], left[4], left[5]) * self.length;
        Some(Wrench { force, moment, about })
    }
}

/// Whether a joint turns about an axis.
fn turns(freedom: &Freedom) -> bool {
    let pitch = freedom.screw.linear.dot(&freedom.screw.angular);
    freedom.screw.angular.norm() > 0.5 && pitch.abs() < ZERO
}

/// The point in which most passive axes of a leg meet, the one next to the platform if several do; that of the last axis if
/// none meet.
fn meeting(chain: &[Freedom], passive: &[usize], length: f64) -> Point3<f64> {
    /// Axes nearer than this share of the size meet.
    const NEAR: f64 = 1e-9;
    let axes: Vec<&Freedom> = passive.iter().map(|&i| &chain[i]).filter(|f| turns(f)).collect();
    let off = |point: &Point3<f64>, axis: &Freedom| {
        (point - axis.point).cross(&axis.screw.angular).norm() < NEAR * length
    };
    let mut best: Option<(usize, Point3<f64>)> = None;
    for (i, one) in axes.iter().enumerate() {
        for other in &axes[i + 1..] {
            let Some(point) = nearest(one, &other.point, &other.screw.angular) else { continue };
            let count = axes.iter().filter(|axis| off(&point, axis)).count();
            if count > 1 && best.is_none_or(|(most, _)| count >= most) {
                best = Some((count, point));
            }
        }
    }
    let last = axes.last().copied().or(chain.last()).map_or(Point3::origin(), |last| last.point);
    best.map_or(last, |(_, point)| point)
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
