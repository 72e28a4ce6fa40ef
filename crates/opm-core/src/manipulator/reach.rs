//! Which poses are in reach, for those that share `b`: a slice of a sweep.
//!
//! `b` decides each leg's imaginary joint, once for the whole slice. What is left is whether the leg's
//! lower chain closes on `v · exp(I τ)` within its limits: a fixed shape in the plane of `v`, or a
//! question a pose.
//!
//! One section alone is asked in the same way: the upper one whether `b` leaves every leg that is cut
//! there a way ([`Manipulator::upper_closes`]), the lower one with the displacements τ of its cuts given
//! ([`Manipulator::lower_leg_branches`]). A pose is in reach where `b` is in that of the upper section and
//! `v` with `τ(b)` in that of the lower one. A leg that is cut in its lower section is the lower
//! section's alone, if its upper joints always close and neither drive nor limit it
//! ([`Manipulator::workspace_factorises`]); if they do, too, the whole reaches less than its two sections
//! have in common.

use super::leg::{CompiledLeg, LegBranches, Section};
use super::{ImaginaryJoint, Manipulator, Mode};
use crate::chain::region::Region;
use crate::group::{Displacement, JointDisplacement};
use nalgebra::Complex;

/// One way in which a leg can follow a slice of poses that share `b`.
#[derive(Clone, Copy, Debug)]
pub struct LegBranch {
    pub(super) leg: usize,
    pub(super) branches: LegBranches,
    /// Found from `b`, where the leg's upper section takes the cut.
    pub(super) tau: Option<JointDisplacement>,
    /// `b`, where the leg takes the cut in its lower section, and its upper one has a say at every pose.
    pub(super) with_upper: Option<Displacement>,
}

impl LegBranch {
    /// The leg's displacement along the intersection motion, radians (in `(-π, π]` where whole turns
    /// do not matter) or metres; `None` of a leg that is cut in its lower section.
    pub fn intersection_displacement(&self) -> Option<f64> {
        self.tau.map(JointDisplacement::value)
    }

    /// Whether the leg follows alike in every slice: `b` makes no difference to it.
    pub fn is_independent_of_slice(&self) -> bool {
        self.tau.is_none() && self.with_upper.is_none()
    }

    /// Number of the leg.
    pub fn leg(&self) -> usize {
        self.leg
    }

    /// The displacement as the direction of a vector, where it is a turn of which whole turns do not matter.
    pub fn direction(&self) -> Option<Complex<f64>> {
        match self.tau {
            Some(JointDisplacement::Direction(direction)) => Some(direction),
            Some(JointDisplacement::Value(_)) | None => None,
        }
    }
}

impl Manipulator {
    /// Number of legs.
    pub fn legs(&self) -> usize {
        self.legs.len()
    }

    /// The ways in which a leg can follow the slice of poses with this `b`: in one working mode, or
    /// (`None`) in any. At most four; none where its upper section does not close.
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
                    let chain = &compiled.upper.chain;
                    let tau = if compiled.upper.limited {
                        let admitted = chain.inverse(b, branches.upper).ok();
                        let admitted = admitted.filter(|displacements| {
                            compiled.upper.admits(&self.limits, displacements)
                        });
                        admitted.map(|displacements| displacements[0])
                    } else {
                        chain.first(b, branches.upper).ok()
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

    /// What the lower section alone may choose beside `v`: the displacement along the intersection
    /// motion of every leg that is cut in its upper section, as an imaginary joint. Those that
    /// [`Manipulator::imaginary`] has are among them; the others follow from these, or stay at home.
    pub fn intersection_joints(&self) -> Vec<ImaginaryJoint> {
        let legs = self.mechanism.legs.iter().enumerate();
        legs.filter(|&(number, _)| self.legs[number].split_section == Section::Upper)
            .map(|(number, leg)| ImaginaryJoint::new(leg, number, &self.task))
            .collect()
    }

    /// Whether whole turns of the cuts matter: a helical joint follows them.
    pub fn intersection_counts_turns(&self) -> bool {
        let counts =
            |leg: &CompiledLeg| leg.lower.chain.counts_turns() || leg.upper.chain.counts_turns();
        self.legs.iter().any(counts)
    }

    /// The ways in which a leg's lower section alone can follow where its cut is at the displacement
    /// `tau` along the intersection motion ([`ImaginaryJoint::displacement`]), radians or metres, in
    /// one working mode, or (`None`) in any. A leg that is cut in its lower section has no use for it.
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
            // Choices of the upper section make no difference.
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

    /// Whether the upper section alone closes at `b` within its limits, in one working mode, or
    /// (`None`) in any: all that legs cut there ask of `b`. `ways` is working memory.
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

    /// Whether the two sections alone decide on every pose: no leg that is cut in its lower section
    /// has upper joints that are limited, actuated, or may be out of reach.
    pub fn workspace_factorises(&self) -> bool {
        self.legs.iter().all(|leg| leg.split_section == Section::Upper || !leg.upper_constrains)
    }

    /// The imaginary joint's number and value, for a leg that has one.
    pub fn imaginary_value(&self, branch: &LegBranch) -> Option<(usize, f64)> {
        let number = self.legs[branch.leg].imaginary?;
        let joint = &self.imaginary[number];
        Some((number, joint.value(branch.tau?, joint.home)))
    }

    /// Whether a leg follows to `v`, within its limits.
    #[inline]
    pub fn reaches(&self, branch: &LegBranch, v: &Displacement) -> bool {
        let leg = &self.legs[branch.leg];
        match (branch.tau, &branch.with_upper) {
            (Some(tau), _) => leg
                .solve_lower(&self.task, v, tau, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&self.limits, &displacements)),
            (None, None) => leg
                .lower
                .chain
                .inverse(v, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&self.limits, &displacements)),
            (None, Some(b)) => {
                leg.solve(&self.task, [v, b], branch.branches, 0.0).is_ok_and(|solution| {
                    leg.lower.admits(&self.limits, &solution.lower)
                        && leg.upper.admits(&self.limits, &solution.upper)
                })
            }
        }
    }

    /// Where the leg follows to, as a region of the plane: of the translations that may be added to the
    /// displacement `v`, in units of `1 / scale`. The same answer as [`Manipulator::reaches`] gives,
    /// rounding apart. `None` where `v` does not move a plane or the leg's limits leave no region of that
    /// shape.
    #[inline(always)]
    pub fn region(&self, branch: &LegBranch, v: &Displacement, scale: f64) -> Option<Region> {
        if branch.with_upper.is_some() {
            return None;
        }
        let shape = self.legs[branch.leg].shape(branch.branches.lower)?;
        let target = match branch.tau {
            Some(tau) => &self.task.lower_intersection.after(v, tau),
            None => v,
        };
        match target {
            Displacement::Planar(g) => shape.at(g.rotation, -g.translation, scale),
            Displacement::Translational(t) => shape.at(Complex::ONE, -t, scale),
            Displacement::Spherical(_) | Displacement::Cylindrical { .. } => None,
        }
    }
}
