//! The closure of all legs as equations in the passive joints, with bounds of their values and derivatives over a box of joints.

use super::bounds::{
    Bound, Matrix, Place, Vector, about, cross, difference, sum, times, vector_about,
};
use crate::manipulator::Manipulator;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{DMatrix, DVector, Isometry3, Quaternion, UnitQuaternion, Vector3};

/// What the parts of the quaternion of a rotation vector are wrong by, as it is computed.
const OF_QUATERNION: f64 = 1e-15;
/// The trace of a rotation by one radian: up to there its sine tells the rotation.
const ONE_RADIAN: f64 = 2.09;

/// One motion of a leg. Lengths are shares of the size.
#[derive(Clone, Debug)]
enum Motion {
    /// About an axis, perhaps with an advance of `pitch` for each radian.
    Turn {
        axis: Vector,
        point: Vector,
        pitch: f64,
    },
    Slide(Vector),
    /// A displacement that does not change.
    Fixed(Place),
}

/// A motion with its value, and the number of the unknown that adds to it.
#[derive(Clone, Debug)]
struct Part {
    motion: Motion,
    value: Bound,
    unknown: Option<usize>,
    /// Whether it is the second hinge of a parallelogram: the unknown is that of the first one, and is subtracted.
    back: bool,
}

/// The closure of an assembly's legs; unknown is how far passive joints are from their values in it, radians and sizes.
#[derive(Clone, Debug)]
pub struct Legs {
    legs: Vec<Vec<Part>>,
    /// For each leg, the numbers of its unknowns.
    pub unknowns: Vec<std::ops::Range<usize>>,
    /// The joint coordinate of each unknown, unless it is of a ball.
    pub coordinates: Vec<Option<usize>>,
    platform: Vector,
    /// Rotations are compared with the inverse of this one.
    back: Matrix,
    target: Place,
    /// What axes may be wrong by, radians and sizes.
    radius: f64,
}

/// The equations and their derivatives: centres and radii.
pub struct Values {
    pub values: [DVector<f64>; 2],
    pub jacobian: [DMatrix<f64>; 2],
    /// An upper bound of how far the end of a leg is from the platform: the angle in radians plus the distance over the size.
    pub off: f64,
    /// Whether rotations are near enough for their sines to tell them.
    pub near: bool,
}

impl Legs {
    /// Those of joints that should take the platform to `target`. Axes are within `radius` of those of the file.
    pub fn new(m: &Manipulator, joints: &[f64], target: &Isometry3<f64>, radius: f64) -> Self {
        let by_size = m.closure.size.recip();
        let point = |p: &Vector3<f64>| vector_about(&(p * by_size), 0.0);
        let back = target.rotation.inverse();
        let mut found = Self {
            legs: Vec::new(),
            unknowns: Vec::new(),
            coordinates: Vec::new(),
            platform: point(&m.mechanism().platform.coords),
            back: Matrix::of_quaternion(back.quaternion(), 0.0),
            target: Place {
                rotation: Matrix::of_quaternion(target.rotation.quaternion(), 0.0),
                translation: point(&target.translation.vector),
            },
            radius,
        };
        let mut at = 0;
        for leg in &m.mechanism().legs {
            let (mut parts, first) = (Vec::new(), found.coordinates.len());
            for joint in &leg.joints {
                found.add(joint, (&joints[at..], at), by_size, &mut parts);
                at += joint.coordinates.len();
            }
            found.unknowns.push(first..found.coordinates.len());
            found.legs.push(parts);
        }
        found
    }

    fn add(
        &mut self,
        joint: &Joint,
        (values, at): (&[f64], usize),
        by_size: f64,
        parts: &mut Vec<Part>,
    ) {
        let point = vector_about(&(joint.point.coords * by_size), self.radius);
        let from_home = |i: usize| about(values[i], 0.0) - joint.coordinates[i].home;
        let turn = |axis: &Vector3<f64>, pitch: f64| Motion::Turn {
            axis: vector_about(axis, self.radius),
            point,
            pitch: pitch * by_size,
        };
        let slide = || Motion::Slide(vector_about(&joint.axis, self.radius));
        if joint.kind == JointKind::Spherical {
            let vector = Vector3::from_fn(|i, _| values[i] - joint.coordinates[i].home);
            let turned: Quaternion<f64> = *UnitQuaternion::from_scaled_axis(vector);
            let turned = Matrix::of_quaternion(&turned, OF_QUATERNION);
            if !joint.actuated {
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    let unknown = Some(self.coordinates.len());
                    self.coordinates.push(None);
                    // The base's own axes are exact.
                    let axis = [axis.x, axis.y, axis.z].map(Bound::constant);
                    let motion = Motion::Turn { axis, point, pitch: 0.0 };
                    let value = Bound::constant(0.0);
                    parts.push(Part { motion, value, unknown, back: false });
                }
            }
            let motion = Motion::Fixed(Place::about(&point, turned));
            let value = Bound::constant(0.0);
            return parts.push(Part { motion, value, unknown: None, back: false });
        }
        if joint.turns_back {
            let unknown = parts.last().and_then(|first| first.unknown);
            let (motion, value) = (turn(&joint.axis, 0.0), from_home(0));
            return parts.push(Part { motion, value, unknown, back: true });
        }
        let motions = match joint.kind {
            JointKind::Revolute | JointKind::Spherical => vec![turn(&joint.axis, 0.0)],
            JointKind::Helical { pitch } => vec![turn(&joint.axis, pitch)],
            JointKind::Prismatic => vec![slide()],
            JointKind::Cylindrical => vec![turn(&joint.axis, 0.0), slide()],
            JointKind::Universal { second } => vec![turn(&joint.axis, 0.0), turn(&second, 0.0)],
        };
        for (i, motion) in motions.into_iter().enumerate() {
            let value = match motion {
                Motion::Slide(_) => from_home(i) * by_size,
                _ => from_home(i),
            };
            let unknown = (!joint.actuated).then_some(self.coordinates.len());
            self.coordinates.extend(unknown.map(|_| Some(at + i)));
            parts.push(Part { motion, value, unknown, back: false });
        }
    }

    /// The equations, six for each leg after the first: each ends where the first does. The unknowns are within `radii` of `centres`.
    pub fn at(&self, centres: &DVector<f64>, radii: &DVector<f64>) -> Values {
        let (rows, columns) = (6 * (self.legs.len() - 1), self.coordinates.len());
        let mut found = Values {
            values: [DVector::zeros(rows), DVector::zeros(rows)],
            jacobian: [DMatrix::zeros(rows, columns), DMatrix::zeros(rows, columns)],
            off: f64::INFINITY,
            near: true,
        };
        let mut first = [Bound::constant(0.0); 6];
        for (number, leg) in self.legs.iter().enumerate() {
            let end = self.end(leg, [centres, radii]);
            found.near &= end.near;
            found.off = found.off.min(end.off);
            if number == 0 {
                first = end.values;
            } else {
                for (i, first) in first.iter().enumerate() {
                    let value = end.values[i] - *first;
                    let row = 6 * (number - 1) + i;
                    found.values[0][row] = value.centre;
                    found.values[1][row] = value.rounding;
                }
            }
            for (column, rates) in end.rates {
                // The first leg is in the equations of all others.
                let legs = if number == 0 { 1..self.legs.len() } else { number..number + 1 };
                let sign = if number == 0 { -1.0 } else { 1.0 };
                for leg in legs {
                    for (i, rate) in rates.iter().enumerate() {
                        let place = (6 * (leg - 1) + i, column);
                        found.jacobian[0][place] = sign * rate.centre;
                        found.jacobian[1][place] = rate.rounding;
                    }
                }
            }
        }
        found
    }

    /// The rates of a leg's end in the middle of all values: a twist for each of its unknowns.
    pub fn twists(&self, leg: usize, centres: &DVector<f64>) -> DMatrix<f64> {
        let still = DVector::zeros(centres.len());
        let (_, twists) = walk(&self.legs[leg], [centres, &still]);
        DMatrix::from_fn(6, twists.len(), |i, j| twists[j].1[i / 3][i % 3].centre)
    }

    /// The joints, radians and metres, after the unknowns have moved from these.
    pub fn moved(&self, m: &Manipulator, joints: &[f64], by: &DVector<f64>) -> Vec<f64> {
        let mut joints = joints.to_vec();
        let (mut at, mut unknown) = (0, 0);
        let mut held = true;
        for joint in m.mechanism().joints() {
            let count = joint.coordinates.len();
            if joint.turns_back {
                joints[at] -= if held { 0.0 } else { by[unknown - 1] };
                at += 1;
                continue;
            }
            held = joint.actuated;
            if !joint.actuated && joint.kind == JointKind::Spherical {
                let home = Vector3::from_fn(|i, _| joint.coordinates[i].home);
                let vector = Vector3::from_column_slice(&joints[at..at + 3]) - home;
                let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
                let turns = axes.iter().enumerate();
                let turned = turns.fold(UnitQuaternion::identity(), |turned, (i, axis)| {
                    turned * UnitQuaternion::from_axis_angle(axis, by[unknown + i])
                });
                let turned = turned * UnitQuaternion::from_scaled_axis(vector);
                let vector = turned.scaled_axis() + home;
                joints[at..at + 3].copy_from_slice(vector.as_slice());
            } else if !joint.actuated {
                for i in 0..count {
                    joints[at + i] += by[unknown + i] / m.weight(at + i);
                }
            }
            unknown += if joint.actuated { 0 } else { count };
            at += count;
        }
        joints
    }

    fn end(&self, leg: &[Part], boxes: [&DVector<f64>; 2]) -> LegEnd {
        let (place, screws) = walk(leg, boxes);
        let at = place.moved(&self.platform);
        let turned = place.rotation.followed(&self.back);
        let (rate, sine) = (turned.sine_rate(), turned.sine());
        let way = difference(&at, &self.target.moved(&self.platform));
        let rates = screws.into_iter().map(|(unknown, [angular, linear])| {
            let ([a, b, c], moved) = (rate.applied(&angular), cross(&angular, &at));
            let [x, y, z] = sum(&moved, &linear);
            (unknown, [a, b, c, x, y, z])
        });
        let near = turned.trace().low() > ONE_RADIAN;
        let angle = super::bounds::length(&sine).high().min(1.0).asin();
        // Half an ulp of `asin`, with a margin.
        let off = angle * (1.0 + 1e-14) + super::bounds::length(&way).high();
        LegEnd {
            rates: rates.collect(),
            values: [sine[0], sine[1], sine[2], way[0], way[1], way[2]],
            off: if near { off } else { f64::INFINITY },
            near,
        }
    }
}

/// The displacement of a leg's end, and its twist at unit rate of each unknown: angular, and at the origin.
fn walk(leg: &[Part], [centres, radii]: [&DVector<f64>; 2]) -> (Place, Vec<(usize, [Vector; 2])>) {
    let mut place = Place::identity();
    let mut screws: Vec<(usize, [Vector; 2])> = Vec::new();
    let still = [Bound::constant(0.0); 3];
    for Part { motion, value, unknown, back } in leg {
        let value = match unknown.map(|unknown| about(centres[unknown], radii[unknown])) {
            Some(by) if *back => *value - by,
            Some(by) => *value + by,
            None => *value,
        };
        let (moved, screw) = match motion {
            Motion::Turn { axis, point, pitch } => {
                let mut moved = Place::about(point, Matrix::turned(axis, &value));
                let along = axis.map(|part| part * *pitch);
                moved.translation = sum(&moved.translation, &times(&along, &value));
                let angular = place.rotation.applied(axis);
                // The velocity at the origin.
                let linear = cross(&place.moved(point), &angular);
                let linear = sum(&linear, &place.rotation.applied(&along));
                (moved, [angular, linear])
            }
            Motion::Slide(axis) => {
                let moved =
                    Place { rotation: Matrix::identity(), translation: times(axis, &value) };
                (moved, [still, place.rotation.applied(axis)])
            }
            Motion::Fixed(moved) => (*moved, [still; 2]),
        };
        match screws.last_mut() {
            Some((_, first)) if *back && unknown.is_some() => {
                let [angular, linear] = screw;
                *first = [difference(&first[0], &angular), difference(&first[1], &linear)];
            }
            _ => screws.extend(unknown.map(|unknown| (unknown, screw))),
        }
        place = place.followed(&moved);
    }
    (place, screws)
}

/// The end of a leg.
struct LegEnd {
    /// What it is beside the target: the sine of the rotation, and the way of the platform's point.
    values: [Bound; 6],
    /// The same at unit rate of each unknown.
    rates: Vec<(usize, [Bound; 6])>,
    off: f64,
    near: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    /// Over boxes of joints, the equations and their derivatives at places inside are within their bounds; derivatives are those of
    /// differences.
    #[test]
    fn bounds_hold_over_boxes() {
        let mut rng = Rng::with_seed(74);
        for name in ["stewart", "delta", "translational-helical-3dof", "plano-cylindrical-4dof"] {
            let m = Manipulator::example(name).unwrap();
            let joints: Vec<f64> = m
                .coordinates()
                .iter()
                .enumerate()
                .map(|(i, c)| c.home + 0.2 * (2.0 * rng.f64() - 1.0) / m.weight(i))
                .collect();
            let legs = Legs::new(&m, &joints, &Isometry3::identity(), 0.0);
            let n = legs.coordinates.len();
            let mut number = || 2.0 * rng.f64() - 1.0;
            let centres = DVector::from_fn(n, |_, _| 0.1 * number());
            let radii = DVector::from_fn(n, |_, _| 1e-3 * number().abs());
            let still = DVector::zeros(n);
            let over = legs.at(&centres, &radii);
            for _ in 0..20 {
                let inside =
                    DVector::from_fn(n, |i, _| centres[i] + radii[i] * number().clamp(-1.0, 1.0));
                let at = legs.at(&inside, &still);
                let off = &at.values[0] - &over.values[0];
                let least = &over.values[1] + &at.values[1];
                assert!(off.iter().zip(least.iter()).all(|(off, most)| off.abs() <= *most));
                let off = &at.jacobian[0] - &over.jacobian[0];
                let least = &over.jacobian[1] + &at.jacobian[1];
                assert!(off.iter().zip(least.iter()).all(|(off, most)| off.abs() <= *most));
                let way = DVector::from_fn(n, |_, _| number());
                let [ahead, back] =
                    [1e-6, -1e-6].map(|h| legs.at(&(&inside + &way * h), &still).values[0].clone());
                let differences = (ahead - back) / 2e-6;
                assert!((&at.jacobian[0] * way - differences).amax() < 1e-7, "{name}");
            }
            assert!(over.values[1].amax() < 0.05 && over.jacobian[1].amax() < 0.05, "{name}");
        }
    }
}
