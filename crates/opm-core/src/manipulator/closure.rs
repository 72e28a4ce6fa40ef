//! The closure error of the legs: the products of exponentials of their joints, without any decomposition,
//! compared with the pose of the platform.

use crate::decomposition::mobility::frame;
use crate::group::screw::Screw;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointKind;
use crate::numeric::angle::sin_cos;
use nalgebra::{
    Isometry3, Matrix6, Point3, Quaternion, Translation3, UnitQuaternion, Vector3, Vector6,
};

/// The legs' joints, for products of exponentials.
#[derive(Clone, Debug)]
pub struct Closure {
    legs: Vec<Vec<LegJoint>>,
    platform: Point3<f64>,
    /// The characteristic length of the mechanism, metres.
    pub size: f64,
}

/// The products of exponentials of the joint values that were given last: where the first joints of a leg still
/// have these, their product is not computed again.
#[derive(Clone, Debug)]
pub struct Products {
    joints: Vec<f64>,
    /// For each joint, the product of the exponentials up to it in its leg.
    upto: Vec<Isometry3<f64>>,
    /// A buffer for joint values.
    tried: Vec<f64>,
}

/// One joint and its values at home.
#[derive(Clone, Debug)]
enum LegJoint {
    Screw {
        screw: Screw,
        path: Path,
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

    /// The displacement `g`, followed towards the platform by that of the joint.
    #[inline(always)]
    fn after(&self, g: &Isometry3<f64>, values: &[f64]) -> Isometry3<f64> {
        match self {
            Self::Screw { path: Path::Line(direction), home, .. } => {
                let moved = g.rotation * (direction * (values[0] - home));
                Isometry3::from_parts((g.translation.vector + moved).into(), g.rotation)
            }
            Self::Screw { path: Path::Helix(helix), home, .. } => g * helix.exp(values[0] - home),
            Self::Ball { point, home, .. } => {
                let vector = Vector3::new(values[0], values[1], values[2]) - home;
                let rotation = UnitQuaternion::from_scaled_axis(vector);
                g * Isometry3::from_parts(Translation3::from(point - rotation * point), rotation)
            }
        }
    }
}

/// What a joint's screw moves along.
#[derive(Clone, Debug)]
enum Path {
    /// A translation with this velocity.
    Line(Vector3<f64>),
    Helix(Helix),
}

/// A rotation about a line, with or without an advance.
#[derive(Clone, Debug)]
struct Helix {
    /// The axis `a`, a unit vector.
    axis: Vector3<f64>,
    /// The velocity `v` at the origin.
    linear: Vector3<f64>,
    /// `a × v`.
    across: Vector3<f64>,
    /// `a (a · v)`, the advance.
    advance: Vector3<f64>,
}

impl Path {
    fn new(screw: &Screw) -> Self {
        let Screw { angular: axis, linear } = *screw;
        if axis == Vector3::zeros() {
            return Self::Line(linear);
        }
        let (across, advance) = (axis.cross(&linear), axis * axis.dot(&linear));
        Self::Helix(Helix { axis, linear, across, advance })
    }
}

impl Helix {
    /// The displacement by an angle: [`Screw::exp`] for a unit axis.
    #[inline(always)]
    fn exp(&self, angle: f64) -> Isometry3<f64> {
        let (sin, cos) = sin_cos(0.5 * angle);
        let (sine, versine) = (2.0 * sin * cos, 2.0 * sin * sin);
        let translation =
            self.linear * sine + self.across * versine + self.advance * (angle - sine);
        let rotation = Quaternion::from_parts(cos, self.axis * sin);
        Isometry3::from_parts(translation.into(), UnitQuaternion::new_unchecked(rotation))
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
                        joints.extend(joint.screws().into_iter().zip(c).map(|(screw, c)| {
                            LegJoint::Screw {
                                screw,
                                path: Path::new(&screw),
                                home: c.home,
                                actuated,
                            }
                        }));
                    }
                }
                joints
            })
            .collect();
        Self { legs, platform: mechanism.platform, size: frame(mechanism).length }
    }

    /// A buffer for [`Closure::residual`].
    pub fn products(&self) -> Products {
        let joints = self.legs.iter().flatten();
        let values = joints.clone().map(LegJoint::values).sum();
        Products {
            // No value is equal to it.
            joints: vec![f64::NAN; values],
            upto: vec![Isometry3::identity(); joints.count()],
            tried: vec![0.0; values],
        }
    }

    /// The largest closure error of a leg, with the platform displaced from home by `target`: the angle in
    /// radians plus the distance of the reference point over the size.
    pub fn residual(
        &self,
        joints: &[f64],
        target: &Isometry3<f64>,
        products: &mut Products,
    ) -> f64 {
        let aim = target * self.platform;
        let (mut first, mut number) = (0, 0);
        let mut largest = 0.0;
        for leg in &self.legs {
            let mut end = Isometry3::identity();
            let mut known = true;
            for joint in leg {
                let values = &joints[first..first + joint.values()];
                let before = &mut products.joints[first..first + values.len()];
                known = known && before == values;
                if known {
                    end = products.upto[number];
                } else {
                    end = joint.after(&end, values);
                    products.upto[number] = end;
                    before.copy_from_slice(values);
                }
                first += values.len();
                number += 1;
            }
            largest = f64::max(largest, self.apart(&end, target, &aim));
        }
        largest
    }

    fn apart(&self, end: &Isometry3<f64>, target: &Isometry3<f64>, aim: &Point3<f64>) -> f64 {
        // The sine of half the angle, twice: acos would lose half of the digits.
        let rotation = end.rotation.rotation_to(&target.rotation).into_inner();
        let distance = (end * self.platform - aim).norm();
        2.0 * rotation.imag().norm() + distance / self.size
    }

    /// Moves the passive joints of every leg so that it closes, with the actuated joints held, by Newton's
    /// method with least squares. Near a serial singularity, joints that were computed from the pose have
    /// errors of the order of the root of the rounding, which this removes. Takes and returns the residual.
    pub fn settle(
        &self,
        joints: &mut [f64],
        target: &Isometry3<f64>,
        residual: f64,
        products: &mut Products,
    ) -> f64 {
        /// The number of steps: where the passive joints are singular, each only halves the error.
        const STEPS: usize = 40;
        let mut residual = residual;
        let mut tried = std::mem::take(&mut products.tried);
        tried.copy_from_slice(joints);
        for _ in 0..STEPS {
            let mut first = 0;
            for leg in &self.legs {
                let values: usize = leg.iter().map(LegJoint::values).sum();
                self.step(leg, &mut tried[first..first + values], target);
                first += values;
            }
            let after = self.residual(&tried, target, products);
            if after.is_nan() || after >= residual {
                break;
            }
            residual = after;
            joints.copy_from_slice(&tried);
        }
        products.tried = tried;
        residual
    }

    fn step(&self, leg: &[LegJoint], joints: &mut [f64], target: &Isometry3<f64>) {
        /// Small enough that damping changes the solution by less than its rounding.
        const DAMPING: f64 = 1e-12;
        // A leg has at most six freedoms. The columns after those of its passive joints are zeros.
        let mut jacobian = Matrix6::zeros();
        let mut columns = jacobian.column_iter_mut();
        let mut before = [UnitQuaternion::identity(); 6];
        let mut g = Isometry3::identity();
        let mut at = 0;
        // Lengths are divided by the size; screws are taken about the platform's point.
        let about = Translation3::from(-(target * self.platform).coords);
        let mut add = |screw: Screw| {
            let moved =
                screw.transformed(&Isometry3::from_parts(about, UnitQuaternion::identity()));
            let unit = Screw { linear: moved.linear / self.size, ..moved }.to_vector();
            columns.next().into_iter().for_each(|mut column| column.copy_from(&unit));
        };
        for (joint, before) in leg.iter().zip(&mut before) {
            *before = g.rotation;
            match joint {
                LegJoint::Screw { screw, actuated: false, .. } => add(screw.transformed(&g)),
                LegJoint::Ball { point, actuated: false, .. } => {
                    let point = g * Point3::from(*point);
                    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
                    axes.into_iter().for_each(|axis| add(Screw::rotation(axis, point)));
                }
                LegJoint::Screw { .. } | LegJoint::Ball { .. } => {}
            }
            g = joint.after(&g, &joints[at..]);
            at += joint.values();
        }
        let rotation = (target.rotation * g.rotation.inverse()).scaled_axis();
        let translation = (target * self.platform - g * self.platform) / self.size;
        let [[x, y, z], [u, v, w]] = [rotation, translation].map(<[f64; 3]>::from);
        let error = Vector6::new(x, y, z, u, v, w);
        let normal = jacobian.tr_mul(&jacobian) + Matrix6::identity() * DAMPING;
        let Some(cholesky) = normal.cholesky() else { return };
        let step = cholesky.solve(&jacobian.tr_mul(&error));
        let mut step = step.iter();
        let mut next = || step.next().copied().unwrap_or(0.0);
        let mut at = 0;
        for (joint, before) in leg.iter().zip(&before) {
            match joint {
                LegJoint::Screw { actuated: false, .. } => joints[at] += next(),
                LegJoint::Ball { home, actuated: false, .. } => {
                    let rotation = Vector3::from_fn(|_, _| next());
                    let rotation = UnitQuaternion::from_scaled_axis(before.inverse() * rotation);
                    let held = Vector3::from_column_slice(&joints[at..at + 3]) - home;
                    let vector = (rotation * UnitQuaternion::from_scaled_axis(held)).scaled_axis();
                    joints[at..at + 3].copy_from_slice((home + vector).as_slice());
                }
                LegJoint::Screw { .. } | LegJoint::Ball { .. } => {}
            }
            at += joint.values();
        }
    }
}
