//! The platform's twist at every pose of a block.

use crate::group::{
    Cylindrical, Planar, Spherical, Subgroup, SubspaceKind, TranslationalPlane, TranslationalSpace,
};
use crate::manipulator::batch::Block;
use crate::manipulator::batch::lanes::{Column, LANES, Lane, Lanes, repeat};
use crate::manipulator::{Manipulator, Section};
use crate::task::Height;
use crate::velocity::jacobian::{BaseTwist, Basis};
use nalgebra::Vector3;

/// A vector for every pose of a block.
pub type VectorColumns = [Column; 3];

/// The vector of one pose.
#[inline(always)]
pub fn vector(columns: &VectorColumns, lane: usize) -> Vector3<f64> {
    Vector3::new(columns[0][lane], columns[1][lane], columns[2][lane])
}

/// Stores the vector of one pose.
#[inline(always)]
pub fn store(columns: &mut VectorColumns, lane: usize, vector: Vector3<f64>) {
    (columns[0][lane], columns[1][lane], columns[2][lane]) = (vector.x, vector.y, vector.z);
}

/// Stores the same vector for every pose.
#[inline(always)]
pub fn fill(columns: &mut VectorColumns, vector: &Vector3<f64>) {
    for (column, value) in columns.iter_mut().zip(vector) {
        column.fill(*value);
    }
}

/// The velocities of the platform's reference point for each component of the section twist.
#[derive(Clone, Debug)]
pub struct PlatformColumns {
    point: VectorColumns,
    velocities: Vec<VectorColumns>,
}

impl PlatformColumns {
    pub fn new(freedoms: usize) -> Self {
        let none = [Lanes::all(0.0); 3];
        Self { point: none, velocities: vec![none; freedoms] }
    }

    /// Does what [`Manipulator::differentiate`] does for [`Jacobians::platform`](crate::velocity::Jacobians::platform).
    #[inline(always)]
    pub fn find(&mut self, manipulator: &Manipulator, basis: &Basis, block: &Block) {
        let task = manipulator.task();
        let Self { point, velocities } = self;
        let lanes = block.upper_lanes.min(LANES);
        macro_rules! each {
            ($group:ty) => {
                for lane in 0..lanes {
                    let b = Lane::load(&block.b, lane);
                    let moved = <$group>::act(&b, &basis.platform);
                    store(point, lane, task.upper.restored(&moved).coords);
                }
            };
        }
        match task.upper.kind {
            SubspaceKind::Identity => fill(point, &task.upper.restored(&basis.platform).coords),
            SubspaceKind::Planar => each!(Planar),
            SubspaceKind::Spherical => each!(Spherical),
            SubspaceKind::Cylindrical => each!(Cylindrical),
            SubspaceKind::TranslationalPlane => each!(TranslationalPlane),
            SubspaceKind::TranslationalSpace => each!(TranslationalSpace),
        }
        if let Some(Height { section: Section::Upper, up, coordinate, .. }) = &task.height {
            let home = task.coordinates[*coordinate].home;
            for lane in 0..lanes {
                let rise = block.pose[*coordinate][lane] - home;
                store(point, lane, vector(point, lane) + up * rise);
            }
        }
        for (velocities, twist) in velocities.iter_mut().zip(&basis.in_base) {
            let BaseTwist { angular, linear, origin } = twist;
            for lane in 0..lanes {
                let velocity = linear + angular.cross(&(vector(point, lane) - origin));
                store(velocities, lane, velocity);
            }
            if block.one_upper() {
                repeat(velocities);
            }
        }
    }

    /// The twists `(ω; v)` at the poses from `start` on.
    #[inline(always)]
    pub fn chunk<const N: usize, const L: usize>(
        &self,
        basis: &Basis,
        start: usize,
    ) -> [[[f64; L]; 6]; N] {
        let mut twists = [[[0.0; L]; 6]; N];
        for ((to, twist), velocity) in twists.iter_mut().zip(&basis.in_base).zip(&self.velocities) {
            for k in 0..3 {
                to[k] = [twist.angular[k]; L];
                to[3 + k].copy_from_slice(&velocity[k][start..start + L]);
            }
        }
        twists
    }
}
