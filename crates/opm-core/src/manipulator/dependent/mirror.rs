//! Dependent coordinates of a symmetric platform: every leg is its own mirror image in a plane between base and platform.
//!
//! The platform is the image of the base, so that its displacement is a product of two reflections: one in the mid-plane of home,
//! one in the mid-plane now (Canfield's joint, Omni-Wrist III). With `z` across the plane of home, `n` the normal now and `e` and
//! `d` the distances of the planes from the reference point at home,
//!
//! ```text
//! R z + z ∥ n,    P = 2 e z − 2 (2 e n·z − d) n
//! ```
//!
//! and `R` has no torsion: for roll φ, pitch θ and yaw ψ
//!
//! ```text
//! tan ψ = sin θ sin φ / (cos θ + cos φ),    n ∥ (sin θ, -sin φ cos θ, 1 + cos θ cos φ)
//! ```
//!
//! Three freedoms are the roll, the pitch and the height; of two, the mid-plane is tangent to a sphere about a point `o`, `d = n · o + δ`.

use super::form::{MirrorForm, UPRIGHT};
use crate::chain::ReachDeficit;
use crate::decomposition::whole::mirrored;
use crate::mechanism::OrientationCoordinates;
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use crate::numeric::svd::Svd;
use crate::task::Task;
use nalgebra::{DMatrix, DVector, Isometry3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Coordinates are found again to within this, in radians or sizes.
const HOLDS: f64 = 1e-9;
/// A sine below this is that of an axis at home along another one.
const LEVEL: f64 = 1e-6;
/// Singular values below this share of the largest are zero.
const RANK: f64 = 1e-12;

/// How coordinates follow from the mid-plane.
#[derive(Clone, Debug)]
pub(crate) struct Mirror {
    /// The legs that constrain.
    pub legs: Vec<usize>,
    /// The numbers.
    pub form: MirrorForm,
}

impl Mirror {
    /// That of a mechanism with so many freedoms, of whose platform these are displacements, and the independent coordinates. `None` if
    /// its mid-plane at home is not across the third axis of the coordinates, or these are others.
    pub fn new(
        task: &Task,
        reference: Point3<f64>,
        (legs, freedoms): (Vec<usize>, usize),
        motions: &[Isometry3<f64>],
        size: f64,
    ) -> Option<(Vec<usize>, Self)> {
        let first_angle = task.lower_count;
        let home = task.home();
        let (axes, up) = (task.lower.axes, task.lower.axes.column(2).into_owned());
        let (normal, distance) = mirrored(motions)?;
        let along = normal.dot(&up);
        if task.angles != OrientationCoordinates::RollPitchYaw
            || home[first_angle..].iter().any(|angle| *angle != 0.0)
            || along.abs() < 1.0 - LEVEL
        {
            return None;
        }
        let height = distance * along.signum() - up.dot(&reference.coords);
        let planes = motions.iter().map(|g| {
            // n · x = d, from the reference point at home.
            let n = axes.transpose() * (g.rotation * up + up).normalize();
            let p = axes.transpose() * (g * reference - reference);
            (n, 0.5 * n.dot(&p) + height * n.z)
        });
        let planes: Vec<(Vector3<f64>, f64)> = planes.collect();
        let sphere = match freedoms {
            3 => None,
            2 => {
                let matrix = DMatrix::from_fn(planes.len(), 4, |i, j| match j {
                    3 => 1.0,
                    j => planes[i].0[j],
                });
                let distances = DVector::from_fn(planes.len(), |i, _| planes[i].1);
                let found = Svd::new(matrix).solve(&distances, RANK);
                Some((Vector3::new(found[0], found[1], found[2]), found[3]))
            }
            _ => return None,
        };
        let form = MirrorForm { leg: legs[0], first_angle, height, sphere };
        let mirror = Self { legs, form };
        let independent = match freedoms {
            3 => vec![2, first_angle, first_angle + 1],
            _ => vec![first_angle, first_angle + 1],
        };
        let holds = motions.iter().all(|g| mirror.holds(task, &independent, g, size));
        holds.then_some((independent, mirror))
    }

    /// Whether the coordinates of a displacement are found again from the independent ones.
    fn holds(&self, task: &Task, independent: &[usize], g: &Isometry3<f64>, size: f64) -> bool {
        let ([v, b], rise) = task.factors(g);
        let all = task.pose(&v, &b, rise);
        let mut pose = task.home();
        independent.iter().for_each(|&i| pose[i] = all[i]);
        let same = |((a, b), c): ((&f64, &f64), &crate::task::TaskCoordinate)| {
            let unit = if c.quantity == Quantity::Length { size } else { 1.0 };
            (a - b).abs() < HOLDS * unit
        };
        self.complete(task, &mut pose).is_ok()
            && pose.iter().zip(&all).zip(&task.coordinates).all(same)
    }

    /// Writes the dependent coordinates of a pose. The yaw is that nearest to what `pose` holds.
    ///
    /// # Errors
    /// The platform is upside down: its mid-plane is then any upright one.
    pub fn complete(&self, task: &Task, pose: &mut [f64]) -> Result<(), ReachDeficit> {
        let first = self.form.first_angle;
        let home = |i: usize| task.coordinates[i].home;
        let found = self.form.follow([pose[first], pose[first + 1]], pose[2] - home(2));
        let Some((yaw, moved)) = (found.upright > UPRIGHT).then_some((found.yaw, found.moved))
        else {
            return Err(ReachDeficit::angle(FRAC_PI_2));
        };
        pose[first + 2] = near(yaw.im.atan2(yaw.re), pose[first + 2]);
        let kept = if self.form.sphere.is_some() { 3 } else { 2 };
        (0..kept).for_each(|i| pose[i] = home(i) + moved[i]);
        Ok(())
    }
}
