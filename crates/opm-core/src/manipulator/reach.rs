//! Which poses are in reach, for those that share `b`: a slice of a sweep.
//!
//! `b` decides each leg's imaginary joint, once for the whole slice. What is left is whether the leg's
//! lower chain closes on `v · exp(I τ)` within its limits: a fixed shape in the plane of `v`, or a
//! question a pose.

use super::leg::{LegBranches, Section};
use super::{Manipulator, Mode};
use crate::chain::region::Region;
use crate::chain::{Amount, Chain};
use crate::limits::Limits;
use crate::task::Displacement;
use nalgebra::Complex;

/// One way in which a leg can follow a slice of poses that share `b`.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    pub(super) leg: usize,
    pub(super) branches: LegBranches,
    pub(super) b: Displacement,
    /// Found from `b`, where the leg's upper section takes the cut.
    pub(super) tau: Option<Amount>,
}

impl Manipulator {
    /// Number of legs.
    pub fn legs(&self) -> usize {
        self.legs.len()
    }

    /// The ways in which a leg can follow the slice of poses with this `b`: in one working mode, or
    /// (`None`) in any. At most four; none where its upper section does not close.
    pub fn follow(&self, leg: usize, b: &Displacement, mode: Option<Mode>, ways: &mut Vec<Follow>) {
        let compiled = &self.legs[leg];
        let mut solve = |branches: LegBranches| {
            let tau = match compiled.cut {
                Section::Lower => None,
                Section::Upper => {
                    let chain = &compiled.upper.chain;
                    let tau = if compiled.upper.limited {
                        let admitted = chain.inverse(b, branches.upper).ok();
                        let admitted =
                            admitted.filter(|amounts| compiled.upper.admits(&self.limits, amounts));
                        admitted.map(|amounts| amounts[0])
                    } else {
                        chain.first(b, branches.upper).ok()
                    };
                    match tau {
                        Some(tau) => Some(compiled.unwound(tau, 0.0)),
                        None => return,
                    }
                }
            };
            ways.push(Follow { leg, branches, b: *b, tau });
        };
        match mode {
            Some(mode) => solve(self.modes.branches(mode, leg)),
            None => {
                for mode in self.modes.leg_modes(leg) {
                    solve(self.modes.branches(mode, leg));
                }
            }
        }
    }

    /// The imaginary joint's number and value, for a leg that has one.
    pub fn imaginary_value(&self, way: &Follow) -> Option<(usize, f64)> {
        let number = self.legs[way.leg].imaginary?;
        let joint = &self.imaginary[number];
        Some((number, joint.value(way.tau?, joint.home)))
    }

    /// Whether a leg follows to `v`, within its limits.
    #[inline]
    pub fn follows(&self, way: &Follow, v: &Displacement) -> bool {
        let leg = &self.legs[way.leg];
        match way.tau {
            Some(tau) => leg
                .solve_lower(&self.task, v, tau, way.branches.lower)
                .is_ok_and(|amounts| leg.lower.admits(&self.limits, &amounts)),
            None if !leg.upper_decides => leg
                .lower
                .chain
                .inverse(v, way.branches.lower)
                .is_ok_and(|amounts| leg.lower.admits(&self.limits, &amounts)),
            None => leg.solve(&self.task, [v, &way.b], way.branches, 0.0).is_ok_and(|solution| {
                leg.lower.admits(&self.limits, &solution.lower)
                    && leg.upper.admits(&self.limits, &solution.upper)
            }),
        }
    }

    /// Where the leg follows to, as a region of the first two coordinates of `v`, when those after
    /// them are `others`: the same answer as [`Manipulator::follows`] gives, rounding apart. The
    /// first two are counted from `origin`, in units of `1 / scale`. `None` where `v` does not move a
    /// plane or the leg's limits leave no region of that shape.
    pub fn region(
        &self,
        way: &Follow,
        others: &[f64],
        origin: Complex<f64>,
        scale: f64,
    ) -> Option<Region> {
        let leg = &self.legs[way.leg];
        if way.tau.is_none() && leg.upper_decides {
            return None;
        }
        let limits = leg.lower.slots.map(|slot| match slot {
            Some(slot) => &self.limits[slot.coordinate],
            None => &Limits::Free,
        });
        // The first two coordinates of v translate it; home has none of that.
        let home = |i: usize| self.task.coordinates[i].home;
        let mut v = [0.0; 3];
        v[..2].copy_from_slice(&[home(0), home(1)]);
        v[2..2 + others.len()].copy_from_slice(others);
        let v = self.task.lower(&v);
        let target = match way.tau {
            Some(tau) => self.task.lower_cut.after(&v, tau),
            None => v,
        };
        let (region, at_home) = match (&leg.lower.chain, target) {
            (Chain::Planar(chain), Displacement::Planar(g)) => {
                (chain.region(g.rotation, way.branches.lower, limits)?, g.translation)
            }
            (Chain::Translational(chain), Displacement::Translational(t)) => {
                let range = |slider: usize| <[f64; 2]>::from(limits[slider].range());
                (chain.region([range(0), range(1)]), t)
            }
            _ => return None,
        };
        Some(region.placed(Complex::new(home(0), home(1)) - at_home - origin, scale))
    }
}
