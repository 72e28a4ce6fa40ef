//! The closure error of the legs: the products of exponentials of their joints, without any decomposition,
//! compared with the pose of the platform.

use crate::decomposition::mobility::frame;
use crate::group::screw::Screw;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointKind;
use nalgebra::{
    DMatrix, DVector, Isometry3, Point3, Translation3, UnitQuaternion, Vector3, Vector6,
};

/// The legs' joints, for products of exponentials.
#[derive(Clone, Debug)]
pub struct Closure {
    legs: Vec<Vec<LegJoint>>,
    platform: Point3<f64>,
    /// The characteristic length of the mechanism, metres.
    pub size: f64,
}

/// One joint and its values at home.
#[derive(Clone, Debug)]
enum LegJoint {
    Screw {
        screw: Screw,
        home: f64,
        actuated: bool,
    },
    /// A rotation vector about a point.
    Ball {
        point: Vector3<f64>,
        home: Vector3<f64>,
        actuated: bool,
    },
}

impl LegJoint {
    fn values(&self) -> usize {
        match self {
            Self::Screw { .. } => 1,
            Self::Ball { .. } => 3,
        }
    }

    fn displacement(&self, values: &[f64]) -> Isometry3<f64> {
        match self {
            Self::Screw { screw, home, .. } => screw.exp(values[0] - home),
            Self::Ball { point, home, .. } => {
                let vector = Vector3::new(values[0], values[1], values[2]) - home;
                let rotation = UnitQuaternion::from_scaled_axis(vector);
                Isometry3::from_parts(Translation3::from(point - rotation * point), rotation)
            }
        }
    }
}

impl Closure {
    pub fn new(mechanism: &Mechanism) -> Self {
        let legs = mechanism
            .legs
            .iter()
            .map(|leg| {
                let mut joints = Vec::new();
                for joint in &leg.joints {
                    let (actuated, c) = (joint.actuated, &joint.coordinates);
                    if joint.kind == JointKind::Spherical {
                        let home = Vector3::from_fn(|i, _| c[i].home);
                        joints.push(LegJoint::Ball { point: joint.point.coords, home, actuated });
                    } else {
                        joints.extend(
                            joint.screws().into_iter().zip(c).map(|(screw, c)| LegJoint::Screw {
                                screw,
                                home: c.home,
                                actuated,
                            }),
                        );
                    }
                }
                joints
            })
            .collect();
        Self { legs, platform: mechanism.platform, size: frame(mechanism).length }
    }

    /// The largest closure error of a leg, with the platform displaced from home by `target`: the angle in
    /// radians plus the distance of the reference point over the size.
    pub fn residual(&self, joints: &[f64], target: &Isometry3<f64>) -> f64 {
        let mut first = 0;
        self.legs.iter().fold(0.0, |largest, leg| {
            let end = self.end(leg, joints, &mut first);
            f64::max(largest, self.apart(&end, target))
        })
    }

    fn end(&self, leg: &[LegJoint], joints: &[f64], first: &mut usize) -> Isometry3<f64> {
        leg.iter().fold(Isometry3::identity(), |g, joint| {
            let g = g * joint.displacement(&joints[*first..]);
            *first += joint.values();
            g
        })
    }

    fn apart(&self, end: &Isometry3<f64>, target: &Isometry3<f64>) -> f64 {
        // The sine of half the angle, twice: acos would lose half of the digits.
        let rotation = end.rotation.rotation_to(&target.rotation).into_inner();
        let distance = (end * self.platform - target * self.platform).norm();
        2.0 * rotation.imag().norm() + distance / self.size
    }

    /// Moves the passive joints of every leg so that it closes, with the actuated joints held, by Newton's
    /// method with least squares. Near a serial singularity, joints that were computed from the pose have
    /// errors of the order of the root of the rounding, which this removes. Takes and returns the residual.
    pub fn settle(&self, joints: &mut [f64], target: &Isometry3<f64>, residual: f64) -> f64 {
        /// The number of steps: where the passive joints are singular, each only halves the error.
        const STEPS: usize = 40;
        let mut residual = residual;
        let mut tried = joints.to_vec();
        for _ in 0..STEPS {
            let mut first = 0;
            for leg in &self.legs {
                let values: usize = leg.iter().map(LegJoint::values).sum();
                self.step(leg, &mut tried[first..first + values], target);
                first += values;
            }
            let after = self.residual(&tried, target);
            if after.is_nan() || after >= residual {
                break;
            }
            residual = after;
            joints.copy_from_slice(&tried);
        }
        residual
    }

    fn step(&self, leg: &[LegJoint], joints: &mut [f64], target: &Isometry3<f64>) {
        /// Small enough that damping changes the solution by less than its rounding.
        const DAMPING: f64 = 1e-12;
        let mut g = Isometry3::identity();
        let (mut columns, mut passive) = (Vec::new(), Vec::new());
        let mut at = 0;
        // Lengths are divided by the size; screws are taken about the platform's point.
        let about = Translation3::from(-(target * self.platform).coords);
        let unit = |screw: Screw| {
            let moved =
                screw.transformed(&Isometry3::from_parts(about, UnitQuaternion::identity()));
            Screw { linear: moved.linear / self.size, ..moved }.to_vector()
        };
        for joint in leg {
            let moved = g * joint.displacement(&joints[at..]);
            match joint {
                LegJoint::Screw { screw, actuated: false, .. } => {
                    columns.push(unit(screw.transformed(&g)));
                    passive.push((at, joint, g.rotation));
                }
                LegJoint::Ball { point, actuated: false, .. } => {
                    let point = g * Point3::from(*point);
                    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
                    columns.extend(axes.map(|axis| unit(Screw::rotation(axis, point))));
                    passive.push((at, joint, g.rotation));
                }
                LegJoint::Screw { .. } | LegJoint::Ball { .. } => {}
            }
            g = moved;
            at += joint.values();
        }
        let error = {
            let rotation = (target.rotation * g.rotation.inverse()).scaled_axis();
            let translation = (target * self.platform - g * self.platform) / self.size;
            Vector6::new(
                rotation.x,
                rotation.y,
                rotation.z,
                translation.x,
                translation.y,
                translation.z,
            )
        };
        if columns.is_empty() {
            return;
        }
        let jacobian = DMatrix::from_fn(6, columns.len(), |i, j| columns[j][i]);
        let mut normal = jacobian.tr_mul(&jacobian);
        for i in 0..columns.len() {
            normal[(i, i)] += DAMPING;
        }
        let right: DVector<f64> = jacobian.tr_mul(&error);
        let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { return };
        let mut step = step.iter();
        let mut next = || step.next().copied().unwrap_or(0.0);
        for (at, joint, before) in passive {
            match joint {
                LegJoint::Screw { .. } => joints[at] += next(),
                LegJoint::Ball { home, .. } => {
                    let rotation = Vector3::from_fn(|_, _| next());
                    let rotation = UnitQuaternion::from_scaled_axis(before.inverse() * rotation);
                    let held = Vector3::from_column_slice(&joints[at..at + 3]) - home;
                    let vector = (rotation * UnitQuaternion::from_scaled_axis(held)).scaled_axis();
                    joints[at..at + 3].copy_from_slice((home + vector).as_slice());
                }
            }
        }
    }
}
