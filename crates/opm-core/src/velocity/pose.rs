//! Twists of `v` and `b` from the rates of the task coordinates.
//!
//! Both are products of exponentials of their coordinates about home, in the order of the table in
//! [`crate::task`]: `(x, y, theta)` two translations and a rotation, `(zeta, xi, psi)` rotations
//! about z, y and z, `(mu, nu)` about x and y. Their derivatives are those of [`Screws`].

use super::local::Local;
use super::screws::Screws;
use crate::chain::unit;
use crate::task::{Cut, SubspaceKind, Task};

impl Task {
    /// The screws of `v`'s coordinates at a pose, as they have moved.
    pub(crate) fn lower_screws(&self, pose: &[f64]) -> Screws {
        let q = |i: usize| pose[i] - self.coordinates[i].home;
        let zero = Local::zeros();
        let kind = self.lower.kind;
        let moved = match (kind, self.lower_cut) {
            (SubspaceKind::Planar, Cut::Turn) => [Local::y(), Local::z(), zero],
            (SubspaceKind::Planar, _) => planar(q(0), q(1)),
            (SubspaceKind::Spherical, _) => {
                let e = unit(q(0));
                [Local::x(), Local::new(0.0, e.re, e.im), zero]
            }
            (SubspaceKind::Cylindrical, Cut::Turn) => [Local::y(), zero, zero],
            (SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane, _) => {
                [Local::x(), Local::y(), zero]
            }
        };
        Screws { kind, moved }
    }

    /// The screws of `b`'s coordinates at a pose, whole, as they have moved.
    pub(crate) fn upper_screws(&self, pose: &[f64]) -> Screws {
        let at = |i: usize| pose[self.lower_count + i];
        let q = |i: usize| at(i) - self.coordinates[self.lower_count + i].home;
        let zero = Local::zeros();
        let kind = self.upper.kind;
        let moved = match (kind, self.upper_cut) {
            (SubspaceKind::Spherical, _) => {
                let (zeta, xi) = (unit(at(0)), unit(at(1)));
                let third = Local::new(zeta.re * xi.im, zeta.im * xi.im, xi.re);
                [Local::z(), Local::new(-zeta.im, zeta.re, 0.0), third]
            }
            (SubspaceKind::Planar, Cut::Turn) => planar(q(0), q(1)),
            (SubspaceKind::Planar, _) => {
                let [_, second, third] = planar(0.0, q(0));
                [second, third, zero]
            }
            (SubspaceKind::Cylindrical, Cut::Turn) => [Local::x(), Local::y(), zero],
            (SubspaceKind::Cylindrical, _) => [Local::x(), zero, zero],
            (SubspaceKind::TranslationalPlane, _) => [Local::y(), zero, zero],
        };
        Screws { kind, moved }
    }
}

/// Along the plane's directions, then about the point that was moved there.
fn planar(x: f64, y: f64) -> [Local; 3] {
    [Local::y(), Local::z(), Local::new(1.0, y, -x)]
}
