//! The closure error of the legs: the products of exponentials of their joints, without any decomposition,
//! compared with the pose of the platform.

mod products;

use crate::chain::whole::MOST_FREEDOMS;
use crate::decomposition::mobility::frame;
use crate::group::screw::Screw;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointKind;
use crate::numeric::four_wide::FourWide;
use nalgebra::{Isometry3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use products::{Displacements, Exponents, Targets};
use pulp::{Arch, Simd, WithSimd};

/// The legs' joints, for products of exponentials.
#[derive(Clone, Debug)]
pub struct Closure {
    legs: Vec<Vec<LegJoint>>,
    platform: Point3<f64>,
    /// The characteristic length of the mechanism, metres.
    pub size: f64,
    /// The rounding of a residual. Products of exponentials lose more digits, the farther away the axes are from the origin.
    pub rounding: f64,
    /// The instructions for one set of joint values, and those for many.
    arch: FourWide,
    arch_of_many: Arch,
}

/// The buffer of [`Closure::residual`] and [`Closure::settle`].
#[derive(Clone, Debug)]
pub struct ClosureBuffer {
    /// Joint values that are tried.
    tried: Vec<f64>,
}

/// One joint and its values at home.
#[derive(Clone, Debug)]
enum LegJoint {
    Screw {
        screw: Screw,
        exponent: Exponents<1>,
        home: f64,
        actuated: bool,
        turns_back: bool,
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

    /// The distance of its axis or point from the origin, metres; zero where it only slides.
    fn away(&self) -> f64 {
        match self {
            Self::Screw { screw, .. } => screw.angular.cross(&screw.linear).norm(),
            Self::Ball { point, .. } => point.norm(),
        }
    }

    /// The displacement `g`, followed towards the platform by that of the joint.
    fn after(&self, g: &Isometry3<f64>, values: &[f64]) -> Isometry3<f64> {
        match self {
            Self::Screw { screw, home, .. } => g * screw.exp(values[0] - home),
            Self::Ball { point, home, .. } => {
                let vector = Vector3::new(values[0], values[1], values[2]) - home;
                let rotation = UnitQuaternion::from_scaled_axis(vector);
                g * Isometry3::from_parts(Translation3::from(point - rotation * point), rotation)
            }
        }
    }
}

impl Closure {
    pub fn new(mechanism: &Mechanism) -> Self {
        /// The rounding of some ten products as a share of the longest distance, with a margin.
        const ROUNDING: f64 = 256.0 * f64::EPSILON;
        let legs: Vec<_> = mechanism
            .legs
            .iter()
            .map(|leg| {
                let mut joints = Vec::new();
                let mut held = false;
                for joint in &leg.joints {
                    let (actuated, c) = (joint.actuated, &joint.coordinates);
                    if joint.kind == JointKind::Spherical {
                        let home = Vector3::from_fn(|i, _| c[i].home);
                        joints.push(LegJoint::Ball { point: joint.point.coords, home, actuated });
                    } else {
                        joints.extend(joint.screws().into_iter().zip(c).map(|(screw, c)| {
                            LegJoint::Screw {
                                screw,
                                exponent: Exponents::of_screw(&screw),
                                home: c.home,
                                // Where the first hinge of a parallelogram has a motor, neither is passive.
                                actuated: actuated || joint.turns_back && held,
                                turns_back: joint.turns_back,
                            }
                        }));
                    }
                    held = actuated;
                }
                joints
            })
            .collect();
        let platform = mechanism.platform;
        let away = legs.iter().flatten().map(LegJoint::away);
        let farthest = away.fold(platform.coords.norm(), f64::max);
        let size = frame(mechanism).length;
        Self {
            legs,
            platform,
            size,
            rounding: ROUNDING * farthest / size,
            arch: FourWide::new(),
            arch_of_many: Arch::new(),
        }
    }

    /// The largest closure error of a leg, with the platform displaced from home by `target`: the angle in
    /// radians plus the distance of the reference point over the size.
    pub fn residual(&self, joints: &[f64], target: &Isometry3<f64>) -> f64 {
        self.arch.dispatch(Residual { closure: self, joints, target })
    }

    /// The same for many sets of joint values, row after row, each with a displacement of the platform: `out` gets one
    /// number for each.
    pub fn write_residuals(&self, joints: &[f64], targets: &[Isometry3<f64>], out: &mut Vec<f64>) {
        out.clear();
        self.arch_of_many.dispatch(Residuals { closure: self, joints, targets, out });
    }

    /// The largest distances of legs' ends from the targets, for some sets of joint values.
    #[inline(always)]
    fn largest<const N: usize>(
        &self,
        joints: [&[f64]; N],
        targets: [&Isometry3<f64>; N],
    ) -> [f64; N] {
        let targets = Targets::new(targets, &self.platform);
        let (mut largest, mut first) = ([0.0; N], 0);
        for leg in &self.legs {
            let mut ends = Displacements::<N>::IDENTITY;
            for joint in leg {
                match joint {
                    LegJoint::Screw { exponent, home, .. } => {
                        let by = std::array::from_fn(|i| joints[i][first] - home);
                        ends = ends.followed(&exponent.repeated(), &by);
                    }
                    LegJoint::Ball { point, home, .. } => {
                        let component =
                            |k: usize| std::array::from_fn(|i| joints[i][first + k] - home[k]);
                        let vectors = [component(0), component(1), component(2)];
                        let (exponents, angles) = Exponents::of_ball(point, &vectors);
                        ends = ends.followed(&exponents, &angles);
                    }
                }
                first += joint.values();
            }
            let distances = ends.apart(&targets, &self.platform, self.size);
            for i in 0..N {
                largest[i] = f64::max(largest[i], distances[i]);
            }
        }
        largest
    }

    /// A buffer for the closure errors.
    pub fn buffer(&self) -> ClosureBuffer {
        let values = self.legs.iter().flatten().map(LegJoint::values).sum();
        ClosureBuffer { tried: Vec::with_capacity(values) }
    }

    /// Moves the passive joints of every leg so that it closes, with the actuated joints held, by Newton's
    /// method with least squares. Near a serial singularity, joints that were computed from the pose have
    /// errors of the order of the root of the rounding, which this removes. Takes and returns the residual.
    pub fn settle(
        &self,
        joints: &mut [f64],
        target: &Isometry3<f64>,
        residual: f64,
        buffer: &mut ClosureBuffer,
    ) -> f64 {
        /// The number of steps: where the passive joints are singular, each only halves the error.
        const STEPS: usize = 40;
        let mut residual = residual;
        buffer.tried.clear();
        buffer.tried.extend_from_slice(joints);
        for _ in 0..STEPS {
            let mut first = 0;
            for leg in &self.legs {
                let values: usize = leg.iter().map(LegJoint::values).sum();
                self.step(leg, &mut buffer.tried[first..first + values], target);
                first += values;
            }
            let after = self.residual(&buffer.tried, target);
            if after.is_nan() || after >= residual {
                break;
            }
            residual = after;
            joints.copy_from_slice(&buffer.tried);
        }
        residual
    }

    fn step(&self, leg: &[LegJoint], joints: &mut [f64], target: &Isometry3<f64>) {
        /// Small enough that damping changes the solution by less than its rounding.
        const DAMPING: f64 = 1e-12;
        // At most six freedoms of a leg are passive and move by themselves. The columns after theirs are zeros.
        let mut jacobian = Matrix6::zeros();
        let mut count = 0;
        let mut before = [UnitQuaternion::identity(); MOST_FREEDOMS];
        let mut g = Isometry3::identity();
        let mut at = 0;
        // Lengths are divided by the size; screws are taken about the platform's point.
        let about = Translation3::from(-(target * self.platform).coords);
        let column = |screw: Screw| {
            let moved =
                screw.transformed(&Isometry3::from_parts(about, UnitQuaternion::identity()));
            Screw { linear: moved.linear / self.size, ..moved }.to_vector()
        };
        let mut add = |screw: Screw, turns_back: bool| {
            if turns_back {
                let mut first = jacobian.column_mut(count - 1);
                first -= column(screw);
            } else if count < 6 {
                jacobian.set_column(count, &column(screw));
                count += 1;
            }
        };
        for (joint, before) in leg.iter().zip(&mut before) {
            *before = g.rotation;
            match joint {
                LegJoint::Screw { screw, actuated: false, turns_back, .. } => {
                    add(screw.transformed(&g), *turns_back);
                }
                LegJoint::Ball { point, actuated: false, .. } => {
                    let point = g * Point3::from(*point);
                    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
                    axes.into_iter().for_each(|axis| add(Screw::rotation(axis, point), false));
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
        let (mut at, mut last) = (0, 0.0);
        for (joint, before) in leg.iter().zip(&before) {
            match joint {
                LegJoint::Screw { actuated: false, turns_back, .. } => {
                    last = if *turns_back { -last } else { next() };
                    joints[at] += last;
                }
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

/// A closure error, with the instructions of the processor at hand.
struct Residual<'a> {
    closure: &'a Closure,
    joints: &'a [f64],
    target: &'a Isometry3<f64>,
}

impl WithSimd for Residual<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let [residual] = self.closure.largest([self.joints], [self.target]);
        residual
    }
}

/// Many closure errors, with the instructions of the processor at hand.
struct Residuals<'a> {
    closure: &'a Closure,
    joints: &'a [f64],
    targets: &'a [Isometry3<f64>],
    out: &'a mut Vec<f64>,
}

impl WithSimd for Residuals<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        /// One vector of every processor, or more.
        const TOGETHER: usize = 8;
        /// Fewer are computed one by one.
        const FEW: usize = 3;
        let Self { closure, joints, targets, out } = self;
        let rows = targets.len();
        let width = joints.len() / rows.max(1);
        for first in (0..rows).step_by(TOGETHER) {
            if rows - first < FEW {
                for row in first..rows {
                    let joints = &joints[row * width..][..width];
                    out.extend(closure.largest([joints], [&targets[row]]));
                }
                break;
            }
            // The last ones are computed as often as there is room.
            let row = |i: usize| (first + i).min(rows - 1);
            let largest = closure.largest::<TOGETHER>(
                std::array::from_fn(|i| &joints[row(i) * width..][..width]),
                std::array::from_fn(|i| &targets[row(i)]),
            );
            out.extend(largest.into_iter().take(rows - first));
        }
    }
}
