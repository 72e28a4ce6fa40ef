//! Reachability of the poses that share `b`: a slice of a sweep.
//!
//! `b` determines each leg's displacement τ along the intersection motion, once for the whole slice. It
//! remains to decide whether the leg's lower chain closes at `v · exp(I τ)` within its limits. The answer is
//! a fixed region in the plane of `v`, or is computed pose by pose.
//!
//! Each section can be examined alone: the upper one by whether every leg that is split there closes at `b`
//! ([`Manipulator::upper_closes`]), the lower one with the displacements τ given
//! ([`Manipulator::lower_leg_branches`]). If the workspace factorises
//! ([`Manipulator::workspace_factorises`]), a pose is in reach exactly where `b` is in reach of the upper
//! section, and `v` with `τ(b)` in reach of the lower one. It does not factorise where a leg that is split
//! in its lower section has upper joints that are limited, actuated or may be out of reach.

use super::leg::{CompiledLeg, LegBranches, Section};
use super::{ImaginaryJoint, Manipulator, Mode};
use crate::chain::region::Region;
use crate::chain::shape::Shape;
use crate::group::{Displacement, JointDisplacement};
use nalgebra::Complex;

/// One branch of a leg's solutions over a slice of poses that share `b`.
#[derive(Clone, Copy, Debug)]
pub struct LegBranch {
    pub(super) leg: usize,
    pub(super) branches: LegBranches,
    /// The displacement along the intersection motion, where the leg is split in its upper section.
    pub(super) tau: Option<JointDisplacement>,
    /// The displacement `b`, where the leg is split in its lower section and its upper section constrains it.
    pub(super) with_upper: Option<Displacement>,
}

impl LegBranch {
    /// The leg's displacement along the intersection motion, radians (in `(-π, π]` where revolutions are not
    /// counted) or metres; `None` for a leg that is split in its lower section.
    pub fn intersection_displacement(&self) -> Option<f64> {
        self.tau.map(JointDisplacement::value)
    }

    /// Whether the leg's feasibility is the same in every slice: it does not depend on `b`.
    pub fn is_independent_of_slice(&self) -> bool {
        self.tau.is_none() && self.with_upper.is_none()
    }

    /// The number of the leg.
    pub fn leg(&self) -> usize {
        self.leg
    }

    /// The displacement along the intersection motion as the direction of a vector, which need not have unit
    /// length, where it is a rotation that does not count revolutions.
    pub fn direction(&self) -> Option<Complex<f64>> {
        match self.tau {
            Some(JointDisplacement::Direction(direction)) => Some(direction),
            Some(JointDisplacement::Value(_)) | None => None,
        }
    }
}

impl Manipulator {
    /// The number of legs.
    pub fn legs(&self) -> usize {
        self.legs.len()
    }

    /// Adds to `found` the branches of a leg over the slice of poses with this `b`, in one working mode, or
    /// (`None`) in all of them. There are at most four, and none where the leg is split in its upper section
    /// and that does not close.
    #[doc(hidden)]
    pub fn leg_branches(
        &self,
        leg: usize,
        b: &Displacement,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) {
        let compiled = &self.legs[leg];
        let mut solve = |branches: LegBranches| {
            let tau = match compiled.split_section {
                Section::Lower => None,
                Section::Upper => {
                    let tau = if compiled.upper.limited {
                        let admitted = compiled.upper.inverse(b, branches.upper).ok();
                        let admitted =
                            admitted.filter(|displacements| compiled.upper.admits(displacements));
                        admitted.map(|displacements| compiled.step(&displacements))
                    } else {
                        compiled.first_step(b, branches.upper).ok()
                    };
                    match tau {
                        Some(tau) => Some(compiled.unwound(tau, 0.0)),
                        None => return,
                    }
                }
            };
            let with_upper = (tau.is_none() && compiled.upper_constrains).then_some(*b);
            found.push(LegBranch { leg, branches, tau, with_upper });
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

    /// The free displacements of the lower section alone, other than `v`: the displacement along the
    /// intersection motion of every leg that is split in its upper section, as an imaginary joint. They include
    /// the joints of [`Manipulator::imaginary`] of those legs; the others depend on these, or stay at home.
    #[doc(hidden)]
    pub fn intersection_joints(&self) -> Vec<ImaginaryJoint> {
        let legs = self.mechanism.legs.iter().enumerate();
        legs.filter(|&(number, _)| self.legs[number].bridge() == Some(Section::Upper))
            .map(|(number, leg)| ImaginaryJoint::new(leg, number, &self.task))
            .collect()
    }

    /// Whether the full revolutions of these displacements matter, since a helical joint turns with them.
    #[doc(hidden)]
    pub fn intersection_counts_turns(&self) -> bool {
        let counts =
            |leg: &CompiledLeg| leg.lower.chain.counts_turns() || leg.upper.chain.counts_turns();
        self.legs.iter().any(counts)
    }

    /// Adds to `found` the branches of a leg's lower section alone, with the leg displaced by `tau` along the
    /// intersection motion ([`ImaginaryJoint::displacement`]), radians or metres, in one working mode, or
    /// (`None`) in all of them. For a leg that is split in its lower section, `tau` is ignored.
    #[doc(hidden)]
    pub fn lower_leg_branches(
        &self,
        leg: usize,
        tau: f64,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) {
        let compiled = &self.legs[leg];
        let tau =
            (compiled.split_section == Section::Upper).then_some(JointDisplacement::Value(tau));
        let mut push = |branches: LegBranches| {
            // The choices of the upper section do not affect the lower one.
            if found.iter().all(|branch| branch.branches.lower != branches.lower) {
                found.push(LegBranch { leg, branches, tau, with_upper: None });
            }
        };
        match mode {
            Some(mode) => push(self.modes.branches(mode, leg)),
            None => {
                for mode in self.modes.leg_modes(leg) {
                    push(self.modes.branches(mode, leg));
                }
            }
        }
    }

    /// Whether every leg that is split in its upper section closes there at `b` within its limits, in one
    /// working mode, or (`None`) in any. `found` is working memory.
    #[doc(hidden)]
    pub fn upper_closes(
        &self,
        b: &Displacement,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) -> bool {
        (0..self.legs.len()).all(|leg| {
            found.clear();
            self.leg_branches(leg, b, mode, found);
            !found.is_empty()
        })
    }

    /// Whether the two sections together decide the reachability of every pose: no leg that is split in its
    /// lower section has upper joints that are limited, actuated, or may be out of reach, and no imaginary joint has a part
    /// in a height.
    pub fn workspace_factorises(&self) -> bool {
        let free = |leg: &CompiledLeg| !leg.upper_constrains;
        !self.shares_height()
            && self.legs.iter().all(|leg| leg.split_section == Section::Upper || free(leg))
    }

    /// The number and the value (radians or metres) of the imaginary joint of a branch; `None` where its leg
    /// has no reported one.
    #[doc(hidden)]
    pub fn imaginary_value(&self, branch: &LegBranch) -> Option<(usize, f64)> {
        let number = self.legs[branch.leg].imaginary?;
        let joint = &self.imaginary[number];
        Some((number, joint.value(branch.tau?, joint.home)))
    }

    /// Whether a leg closes at `v` on a branch within its limits.
    #[doc(hidden)]
    #[inline]
    pub fn reaches(&self, branch: &LegBranch, v: &Displacement) -> bool {
        let leg = &self.legs[branch.leg];
        match (branch.tau, &branch.with_upper) {
            (Some(tau), _) => leg
                .solve_lower(&self.task, v, tau, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&displacements)),
            (None, None) => leg
                .lower
                .inverse(v, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&displacements)),
            (None, Some(b)) => {
                leg.solve(&self.task, [v, b], 0.0, branch.branches, 0.0).is_ok_and(|solution| {
                    leg.lower.admits(&solution.lower) && leg.upper.admits(&solution.upper)
                })
            }
        }
    }

    /// Translations that can be added to the displacement `v`, in units of `1 / scale`: where the lower section of a leg closes
    /// on a branch. With [`Manipulator::link_regions`], where it also is within its limits, but for limits on angles that make
    /// the translations more than a convex set with a convex hole: these are left aside. `None` where `v` is not a
    /// displacement of a plane.
    #[doc(hidden)]
    #[inline(always)]
    pub fn region(&self, branch: &LegBranch, v: &Displacement, scale: f64) -> Option<Region> {
        let (shape, rotation, shift) = self.shape_at(branch, v)?;
        shape.at(rotation, shift, scale)
    }

    /// Whether the regions of a branch, or its arcs ([`Manipulator::row_arcs`]), leave nothing aside: they agree with
    /// [`Manipulator::reaches`] up to rounding.
    #[doc(hidden)]
    pub fn regions_decide(&self, branch: &LegBranch) -> bool {
        let leg = &self.legs[branch.leg];
        let shell = leg.shell(branch.branches.lower).is_some();
        let free = |joint: usize| {
            leg.lower.coordinates[joint].as_ref().is_none_or(|joint| joint.limits.arc().is_none())
        };
        branch.with_upper.is_none()
            && (leg.shape(branch.branches.lower).is_some() || shell && free(0) && free(2))
    }

    /// Whether [`Manipulator::row_arcs`] can be used for a branch.
    #[doc(hidden)]
    pub fn has_arcs(&self, branch: &LegBranch) -> bool {
        self.legs[branch.leg].shell(branch.branches.lower).is_some()
    }

    /// Calls `found` with regions as [`Manipulator::region`], which limits on a link that slides leave: a leg closes for
    /// the translations that all of them have in common.
    #[doc(hidden)]
    #[inline]
    pub fn link_regions(
        &self,
        branch: &LegBranch,
        v: &Displacement,
        scale: f64,
        found: impl FnMut(Region),
    ) {
        let shape = self.legs[branch.leg].shape(branch.branches.lower);
        if shape.is_some_and(Shape::limits_link)
            && let Some((shape, rotation, shift)) = self.shape_at(branch, v)
        {
            shape.link_regions(rotation, shift, scale, found);
        }
    }

    /// The shape in which a leg closes, the rotation of its target, and what is added to its points to be translations.
    #[inline(always)]
    fn shape_at(
        &self,
        branch: &LegBranch,
        v: &Displacement,
    ) -> Option<(&Shape, Complex<f64>, Complex<f64>)> {
        let leg = &self.legs[branch.leg];
        let shape = leg.shape_or_bounds(branch.branches.lower)?;
        let mut target = match branch.tau {
            Some(tau) => &self.task.lower_intersection.after(v, tau),
            None => v,
        };
        let displaced;
        if leg.lower.offset.is_some() {
            displaced = leg.lower.of_chain(target);
            target = &displaced;
        }
        match target {
            Displacement::Planar(g) => Some((shape, g.rotation, -g.translation)),
            Displacement::Translational(t) => Some((shape, Complex::ONE, -t)),
            Displacement::Identity(_)
            | Displacement::Spherical(_)
            | Displacement::Cylindrical(_)
            | Displacement::Spatial(_) => None,
        }
    }
}
