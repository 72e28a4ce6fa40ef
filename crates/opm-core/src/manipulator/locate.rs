//! From a displacement of the platform to task coordinates, for every pair of subspaces.
//!
//! A displacement of the motion is taken apart in closed form (`Task::factors`). For any other one the nearest
//! pose is found by least squares: damped Gauss-Newton (Levenberg and Marquardt) on the rotation vector and the
//! reference point's position.

use super::{Manipulator, PoseError};
use crate::numeric::Quantity;
use crate::numeric::angle::whole_turns;
use nalgebra::{DMatrix, DVector, Isometry3, Translation3, Vector3, Vector6};
use std::f64::consts::TAU;
use std::fmt;

/// A rotation, radians, or a distance over the mechanism's size: a displacement that is off the
/// motion by less is on it. Far above the rounding of the solution, far below any tolerance of a
/// machine.
const ON: f64 = 1e-9;

/// A rotation in radians beside a translation in metres, or the other way round, that is no more
/// than what the least squares leave of it: machines are not a million times as large as they turn.
const BESIDE: f64 = 1e-6;

/// Starts: home, then poses spread over the angles.
const STARTS: u32 = 24;

/// Steps from one start. Near a solution each doubles the number of digits, but where the coordinates
/// are singular (an Euler angle on its pole) it only halves the error.
const STEPS: usize = 200;

/// A displacement of the platform that the manipulator's motion does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct OutsideMotion {
    /// The nearest pose that is in the motion: rotation counts by the mechanism's size.
    pub nearest: Vec<f64>,
    /// Rotation vector from that pose's orientation to the one given, base coordinates, radians.
    pub rotation: Vector3<f64>,
    /// From that pose's platform point to the one given, base coordinates, metres.
    pub translation: Vector3<f64>,
}

impl OutsideMotion {
    /// What it is outside by: a translation, a rotation, or both. A part that is rounding beside the
    /// other is left out.
    pub fn parts(&self) -> impl Iterator<Item = (Quantity, Vector3<f64>)> + use<> {
        let parts = [(Quantity::Length, self.translation), (Quantity::Angle, self.rotation)];
        let least = BESIDE * self.translation.norm().max(self.rotation.norm());
        parts.into_iter().filter(move |(_, v)| v.norm() > least)
    }
}

impl std::error::Error for OutsideMotion {}

impl fmt::Display for OutsideMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "outside the manipulator's motion")?;
        for (number, (quantity, v)) in self.parts().enumerate() {
            let unit = match quantity {
                Quantity::Length => "m along",
                Quantity::Angle => "rad about",
            };
            // Adding zero turns a rounded -0 into 0.
            let [x, y, z] = <[f64; 3]>::from(v.normalize()).map(|c| (c * 1e4).round() / 1e4 + 0.0);
            let by = if number == 0 { "by" } else { "and" };
            write!(f, " {by} {:.3e} {unit} ({x}, {y}, {z})", v.norm())?;
        }
        Ok(())
    }
}

impl Manipulator {
    /// Where the platform is at a pose, in SE(3): its reference point's position, metres, and its
    /// orientation, in base coordinates.
    ///
    /// The orientation is the turn from the base's directions that the platform has made, which at home
    /// is none; where `zeta xi psi` measure it, it is theirs, and home's values are home's orientation.
    ///
    /// # Errors
    /// A pose of the wrong length, or with a coordinate that is not a finite number.
    pub fn platform_pose(&self, pose: &[f64]) -> Result<Isometry3<f64>, PoseError> {
        Ok(self.displacement(pose)? * self.home_placement())
    }

    /// The platform's displacement from home at a pose, `g = v · b`, in base coordinates.
    ///
    /// # Errors
    /// As [`Manipulator::platform_pose`].
    pub fn displacement(&self, pose: &[f64]) -> Result<Isometry3<f64>, PoseError> {
        self.check_pose(pose)?;
        Ok(self.task.displacement(pose))
    }

    /// The task coordinates at which the platform is there: the inverse of
    /// [`Manipulator::platform_pose`].
    ///
    /// # Errors
    /// As [`Manipulator::locate`].
    pub fn locate_platform(&self, platform: &Isometry3<f64>) -> Result<Vec<f64>, OutsideMotion> {
        self.locate(&(platform * self.home_placement().inverse()))
    }

    fn home_placement(&self) -> Isometry3<f64> {
        let place = Translation3::from(self.mechanism.platform.coords);
        Isometry3::from_parts(place, self.task.home_orientation())
    }

    /// The pose whose displacement of the platform from home is `displacement` (base coordinates);
    /// angles within half a turn of home. The inverse of [`Manipulator::displacement`].
    ///
    /// # Errors
    /// A displacement outside the motion `A · B`: how far, in which direction, and the nearest pose.
    pub fn locate(&self, displacement: &Isometry3<f64>) -> Result<Vec<f64>, OutsideMotion> {
        let length = self.characteristic_length();
        let [v, b] = self.task.factors(displacement);
        let pose = self.task.pose(&v, &b);
        if self.miss(displacement, &pose, 1.0 / length).norm() < ON {
            return Ok(self.within_half_a_turn(pose));
        }
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in 0..STARTS {
            let mut pose = self.start(start);
            // The rotation alone first: it decides most angles, and has few false minima.
            self.approach(displacement, 0.0, &mut pose);
            let off = self.approach(displacement, 1.0 / length, &mut pose);
            // Later starts must be better by more than rounding.
            if best.as_ref().is_none_or(|(least, _)| off < 0.99 * least - ON * ON) {
                best = Some((off, pose));
            }
            if off < ON {
                break;
            }
        }
        let (off, pose) = best.unwrap_or_else(|| (f64::INFINITY, self.task.home()));
        let pose = self.within_half_a_turn(pose);
        if off < ON {
            return Ok(pose);
        }
        let miss = self.miss(displacement, &pose, 1.0);
        Err(OutsideMotion {
            nearest: pose,
            rotation: miss.fixed_rows::<3>(0).into(),
            translation: miss.fixed_rows::<3>(3).into(),
        })
    }

    /// The same pose with angles within half a turn of home, but those whose whole turns matter.
    fn within_half_a_turn(&self, mut pose: Vec<f64>) -> Vec<f64> {
        for (q, c) in pose.iter_mut().zip(self.task_coordinates()) {
            if c.quantity == Quantity::Angle && !self.counts_turns(c.kind()) {
                *q -= TAU * whole_turns(*q - c.home);
            }
        }
        pose
    }

    /// Home, then angles by an additive recurrence, which spreads over the torus.
    fn start(&self, number: u32) -> Vec<f64> {
        let n = f64::from(number);
        self.task_coordinates()
            .iter()
            .enumerate()
            .map(|(i, c)| match c.quantity {
                Quantity::Length => c.home,
                // Irrational steps: the roots of successive primes.
                Quantity::Angle => {
                    let step = [2.0_f64, 3.0, 5.0, 7.0, 11.0][i % 5].sqrt();
                    c.home + TAU * ((n * step).fract() - (n * step).fract().round())
                }
            })
            .collect()
    }

    /// Least squares from `pose`, which it moves; returns what is left.
    fn approach(&self, target: &Isometry3<f64>, weight: f64, pose: &mut [f64]) -> f64 {
        let mut miss = self.miss(target, pose, weight);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let jacobian = self.sensitivity(target, weight, pose);
            let normal = jacobian.tr_mul(&jacobian);
            let gradient = jacobian.tr_mul(&miss);
            let damped = &normal + DMatrix::identity(pose.len(), pose.len()) * damping;
            let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else {
                damping *= 10.0;
                continue;
            };
            let tried: Vec<f64> = pose.iter().zip(&step).map(|(q, s)| q - s).collect();
            let after = self.miss(target, &tried, weight);
            if after.norm() < miss.norm() {
                pose.copy_from_slice(&tried);
                miss = after;
                damping = (damping * 0.1).max(1e-15);
            } else {
                damping *= 10.0;
            }
            if miss.norm() < 1e-15 || damping > 1e6 {
                break;
            }
        }
        miss.norm()
    }

    /// From the pose to the target: rotation vector, and the platform point's way times `weight`.
    fn miss(&self, target: &Isometry3<f64>, pose: &[f64], weight: f64) -> Vector6<f64> {
        let here = self.task.displacement(pose);
        let turn = (target.rotation * here.rotation.inverse()).scaled_axis();
        let translation =
            (target * self.mechanism.platform - here * self.mechanism.platform) * weight;
        Vector6::new(turn.x, turn.y, turn.z, translation.x, translation.y, translation.z)
    }

    /// Derivative of the miss by the coordinates, central differences: exact enough, since what is
    /// solved is `miss = 0`, not the derivative.
    fn sensitivity(&self, target: &Isometry3<f64>, weight: f64, pose: &[f64]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(6, pose.len());
        for (i, c) in self.task_coordinates().iter().enumerate() {
            // Lengths enter linearly: for them any step will do.
            let h =
                1e-6 * if c.quantity == Quantity::Length { pose[i].abs().max(1.0) } else { 1.0 };
            let at = |q: f64| {
                let mut moved = DVector::from_column_slice(pose);
                moved[i] += q;
                self.miss(target, moved.as_slice(), weight)
            };
            jacobian.set_column(i, &((at(h) - at(-h)) / (2.0 * h)));
        }
        jacobian
    }
}
