//! Which poses of a block a leg reaches that is solved whole.

use super::Block;
use super::lanes::{Column, Displacements, LANES};
use crate::group::{
    CylindricalDisplacement, Displacement, IdentityDisplacement, JointDisplacement, Placed,
    PlanarDisplacement, SubspaceKind,
};
use crate::manipulator::Manipulator;
use crate::manipulator::leg::LegBranches;
use crate::manipulator::whole::Whole;
use crate::numbers::Real;
use crate::numbers::pack::{Pack, PackJoint, PackPlane, PackRotation};
use nalgebra::Complex;

/// The numbers of some lanes of a column.
#[inline(always)]
fn pack(column: &Column, from: usize) -> Pack {
    let mut all = [0.0; Pack::POSES];
    for (i, to) in all.iter_mut().enumerate() {
        *to = column[(from + i) % LANES];
    }
    Pack(all)
}

/// The displacement of a section at some lanes.
#[inline(always)]
fn displacement(kind: SubspaceKind, of: &Displacements, from: usize) -> Displacement<Pack> {
    let at = |i: usize| pack(&of[i], from);
    let plane = |i: usize| PackPlane { re: at(i), im: at(i + 1) };
    match kind {
        SubspaceKind::Identity => Displacement::Identity(IdentityDisplacement),
        SubspaceKind::Planar => {
            Displacement::Planar(PlanarDisplacement { rotation: plane(0), translation: plane(2) })
        }
        SubspaceKind::Spherical => {
            let row = |i: usize| [at(i), at(i + 1), at(i + 2)];
            Displacement::Spherical(PackRotation([row(0), row(3), row(6)]))
        }
        SubspaceKind::Cylindrical => {
            Displacement::Cylindrical(CylindricalDisplacement { angle: at(0), advance: at(1) })
        }
        SubspaceKind::TranslationalPlane => Displacement::Translational(plane(0)),
        SubspaceKind::TranslationalSpace => Displacement::Spatial([at(0), at(1), at(2)]),
    }
}

impl Block {
    /// Where the platform is at some lanes.
    #[inline(always)]
    fn placed(&self, manipulator: &Manipulator, from: usize) -> Placed<Pack> {
        let task = &manipulator.task;
        let v = displacement(task.lower.kind, &self.v, from);
        let b = displacement(task.upper.kind, &self.b, from);
        let rise = task.height.as_ref().map(|height| {
            let home = task.coordinates[height.coordinate].home;
            pack(&self.pose[height.coordinate], from) - home
        });
        task.placed(&v, &b, rise.unwrap_or(Pack::constant(0.0)))
    }

    /// Computes where the platform is.
    #[inline(always)]
    pub fn place(&mut self, manipulator: &Manipulator) {
        for number in 0..LANES / Pack::POSES {
            self.places[number] = self.placed(manipulator, number * Pack::POSES).parts();
        }
    }

    /// Finds which poses a branch of a leg reaches within the limits of its joints.
    #[inline(always)]
    pub fn reach_whole(&mut self, manipulator: &Manipulator, whole: &Whole, branches: LegBranches) {
        let Some(reach) = &whole.reach else { return };
        let signs = [branches.lower.sign(), branches.upper.sign()];
        let Self { places, found, status, .. } = self;
        for (number, (rotation, translation)) in places.iter().enumerate() {
            reach.decide((rotation, translation), signs, found);
            let from = number * Pack::POSES;
            for i in 0..Pack::POSES {
                let (holds, beyond) = (found.holds(i), found.is_beyond(i));
                status.note_lane(from + i, u64::from(holds), u64::from(beyond));
            }
            for (freedom, limits) in whole.limited(manipulator) {
                let within = &mut status.within_limits[from..from + Pack::POSES];
                match found.displacement(freedom) {
                    PackJoint::Value(value) => {
                        for (within, &value) in within.iter_mut().zip(&value.0) {
                            *within &= u64::from(limits.admits(JointDisplacement::Value(value)));
                        }
                    }
                    PackJoint::Direction(PackPlane { re, im }) => {
                        for (i, within) in within.iter_mut().enumerate() {
                            let e = Complex::new(re.0[i], im.0[i]);
                            *within &= u64::from(limits.admits(JointDisplacement::Direction(e)));
                        }
                    }
                }
            }
        }
    }
}

/// The rotation and the translation of the platform at some lanes.
pub type PackPlace = (PackRotation, [Pack; 3]);

/// So many times at home.
pub fn at_home() -> [PackPlace; LANES / Pack::POSES] {
    let [zero, one] = [0.0, 1.0].map(Pack::constant);
    let identity = PackRotation([[one, zero, zero], [zero, one, zero], [zero, zero, one]]);
    [(identity, [zero; 3]); LANES / Pack::POSES]
}
