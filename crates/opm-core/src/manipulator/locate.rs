//! The task coordinates of a displacement of the platform, for every pair of subspaces.
//!
//! A displacement in the manipulator's motion is factored in closed form (`Task::factors`). For any other one
//! the nearest pose is found by least squares: damped Gauss-Newton (Levenberg and Marquardt) on the rotation vector and the
//! reference point's position.

use super::{Manipulator, Mode, PoseError};
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use nalgebra::{DMatrix, DVector, Isometry3, Translation3, Vector3, Vector6};
use std::f64::consts::TAU;
use std::fmt;

/// A displacement that is outside the motion by less than this counts as inside: a rotation in radians, or
/// a distance over the mechanism's size. It is far above the rounding of the solution and far below the
/// tolerances of a machine.
const ON: f64 = 1e-9;

/// A rotation in radians that is smaller than this fraction of the translation in metres, or vice versa, is
/// a residue of the least squares and is not reported.
const BESIDE: f64 = 1e-6;

/// The number of starts: home, then poses spread over the angles.
const STARTS: u32 = 24;

/// The number of steps from one start. Near a solution each step doubles the number of correct digits, but
/// where the Euler angles are singular it only halves the error.
const STEPS: usize = 200;

/// A displacement of the platform that is outside the manipulator's motion.
#[derive(Clone, Debug, PartialEq)]
pub struct OutsideMotion {
    /// The nearest pose. A rotation in radians is weighted by the mechanism's characteristic length.
    pub nearest: Vec<f64>,
    /// The rotation vector from that pose's orientation to the one given, base coordinates, radians.
    pub rotation: Vector3<f64>,
    /// The vector from that pose's platform point to the one given, base coordinates, metres.
    pub translation: Vector3<f64>,
}

impl OutsideMotion {
    /// The translation, the rotation, or both, by which it is outside the motion. A part that is only rounding
    /// compared to the other is left out.
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
    /// The platform's pose in SE(3): the position of its reference point, metres, and its orientation, in base
    /// coordinates.
    ///
    /// The orientation at home is the identity, unless the task coordinates are `zeta xi psi`, `azimuth tilt torsion`
    /// or `roll pitch yaw`: then it is that of their values at home about the upper frame's axes.
    ///
    /// Dependent coordinates are those of the home mode; [`Solution::displacement`](super::Solution::displacement)
    /// gives the displacement in the mode that was solved.
    ///
    /// # Errors
    /// The pose has the wrong length, or a coordinate that is not a finite number, or its dependent coordinates
    /// have no solution.
    pub fn platform_pose(&self, pose: &[f64]) -> Result<Isometry3<f64>, PoseError> {
        Ok(self.platform_at(&self.displacement(pose)?))
    }

    /// The platform's displacement from home at a pose, `g = v · b`, in base coordinates.
    ///
    /// # Errors
    /// As [`Manipulator::platform_pose`].
    pub fn displacement(&self, pose: &[f64]) -> Result<Isometry3<f64>, PoseError> {
        self.displacement_in(pose, self.home_mode)
    }

    /// The same in a working mode, on which dependent coordinates depend.
    ///
    /// # Errors
    /// As [`Manipulator::platform_pose`].
    pub fn displacement_in(&self, pose: &[f64], mode: Mode) -> Result<Isometry3<f64>, PoseError> {
        self.check_pose(pose)?;
        if self.dependent.is_none() {
            return Ok(self.task.displacement(pose));
        }
        let all = self.completed(pose, mode).map_err(|missed| PoseError::Constraint {
            leg: self.mechanism.legs[missed.leg].name.clone(),
            deficit: missed.deficit,
        })?;
        Ok(self.task.displacement(&all))
    }

    /// The task coordinates at which the platform has this pose: the inverse of
    /// [`Manipulator::platform_pose`].
    ///
    /// # Errors
    /// As [`Manipulator::locate`].
    pub fn locate_platform(&self, platform: &Isometry3<f64>) -> Result<Vec<f64>, OutsideMotion> {
        self.locate_platform_in(platform, self.home_mode)
    }

    /// The same with the angles of a working mode, if the platform gets there in that mode. Where coordinates are dependent,
    /// two triples of angles may give one orientation, each in modes of its own.
    ///
    /// # Errors
    /// As [`Manipulator::locate`].
    pub fn locate_platform_in(
        &self,
        platform: &Isometry3<f64>,
        mode: Mode,
    ) -> Result<Vec<f64>, OutsideMotion> {
        self.locate_in(&(platform * self.home_placement().inverse()), mode)
    }

    /// The platform's pose in SE(3) for its displacement from home: see [`Manipulator::platform_pose`].
    pub fn platform_at(&self, displacement: &Isometry3<f64>) -> Isometry3<f64> {
        displacement * self.home_placement()
    }

    fn home_placement(&self) -> Isometry3<f64> {
        let place = Translation3::from(self.mechanism.platform.coords);
        Isometry3::from_parts(place, self.task.home_orientation())
    }

    /// The pose whose displacement of the platform from home is `displacement` (base coordinates);
    /// angles are within π of home. The inverse of [`Manipulator::displacement`].
    ///
    /// # Errors
    /// The displacement is outside the motion `A · B`: by how much, in which direction, and the nearest pose.
    pub fn locate(&self, displacement: &Isometry3<f64>) -> Result<Vec<f64>, OutsideMotion> {
        self.locate_in(displacement, self.home_mode)
    }

    fn locate_in(
        &self,
        displacement: &Isometry3<f64>,
        mode: Mode,
    ) -> Result<Vec<f64>, OutsideMotion> {
        let Some(dependent) = &self.dependent else { return self.locate_all(displacement) };
        let all = self.locate_all(displacement).unwrap_or_else(|outside| outside.nearest);
        let length = self.characteristic_length();
        let off = |all: &[f64]| self.miss(displacement, all, 1.0 / length).norm();
        // The given mode, then the one in which the dependent coordinates come nearest.
        let others = (0..dependent.combinations()).map(|number| dependent.mode(number));
        let mut nearest: Option<(f64, Vec<f64>, Mode)> = None;
        for mode in std::iter::once(mode).chain(others) {
            let pose = self.independent_in(&all, mode);
            let Ok(completed) = self.completed(&pose, mode) else { continue };
            let off = off(&completed);
            if off < ON {
                return Ok(pose);
            }
            if nearest.as_ref().is_none_or(|(least, ..)| off < *least) {
                nearest = Some((off, completed, mode));
            }
        }
        let (nearest, mode) =
            nearest.map_or_else(|| (self.task.home(), mode), |(_, pose, mode)| (pose, mode));
        let miss = self.miss(displacement, &nearest, 1.0);
        Err(OutsideMotion {
            nearest: self.independent_in(&nearest, mode),
            rotation: miss.fixed_rows::<3>(0).into(),
            translation: miss.fixed_rows::<3>(3).into(),
        })
    }

    /// Whether the platform has this pose at a pose and in a working mode: see [`Manipulator::platform_pose`]. Only
    /// dependent coordinates depend on the mode.
    pub fn is_at(&self, pose: &[f64], mode: Mode, platform: &Isometry3<f64>) -> bool {
        let target = platform * self.home_placement().inverse();
        let all = match &self.dependent {
            None => Some(pose.to_vec()),
            Some(_) => self.completed(pose, mode).ok(),
        };
        let scale = 1.0 / self.characteristic_length();
        all.is_some_and(|all| self.miss(&target, &all, scale).norm() < ON)
    }

    /// As [`Manipulator::locate`], with all task coordinates, as if they were independent.
    fn locate_all(&self, displacement: &Isometry3<f64>) -> Result<Vec<f64>, OutsideMotion> {
        let length = self.characteristic_length();
        let ([v, b], rise) = self.task.factors(displacement);
        let pose = self.task.pose(&v, &b, rise);
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

    /// The same pose with angles within π of home, except angles that count revolutions.
    fn within_half_a_turn(&self, mut pose: Vec<f64>) -> Vec<f64> {
        for (q, c) in pose.iter_mut().zip(&self.task.coordinates) {
            if c.quantity == Quantity::Angle && !self.counts_turns(c.kind()) {
                *q = near(*q, c.home);
            }
        }
        self.task.make_tilt_positive(&mut pose);
        pose
    }

    /// A pose to start from: home, then angles by an additive recurrence, which covers them evenly.
    fn start(&self, number: u32) -> Vec<f64> {
        let n = f64::from(number);
        self.task
            .coordinates
            .iter()
            .enumerate()
            .map(|(i, c)| match c.quantity {
                Quantity::Length => c.home,
                // Irrational steps: the roots of successive primes.
                Quantity::Angle => {
                    let step = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0][i % 6].sqrt();
                    c.home + TAU * ((n * step).fract() - (n * step).fract().round())
                }
            })
            .collect()
    }

    /// Moves `pose` to a least-squares minimum and returns the norm of the residual.
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

    /// The displacement from the pose to the target: the rotation vector, and the translation of the platform
    /// point times `weight`.
    fn miss(&self, target: &Isometry3<f64>, pose: &[f64], weight: f64) -> Vector6<f64> {
        let here = self.task.displacement(pose);
        let rotation = (target.rotation * here.rotation.inverse()).scaled_axis();
        let translation =
            (target * self.mechanism.platform - here * self.mechanism.platform) * weight;
        Vector6::new(
            rotation.x,
            rotation.y,
            rotation.z,
            translation.x,
            translation.y,
            translation.z,
        )
    }

    /// The derivative of [`Manipulator::miss`] by the coordinates, by central differences. They are accurate
    /// enough: the derivative affects only the convergence, not the solution.
    fn sensitivity(&self, target: &Isometry3<f64>, weight: f64, pose: &[f64]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(6, pose.len());
        for (i, c) in self.task.coordinates.iter().enumerate() {
            // The miss is linear in lengths: for them any step gives the derivative.
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
