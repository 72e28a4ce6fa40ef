//! The seam between a compiled mechanism and sweeps through its workspace: what a leg, a slice, a row or many poses at once
//! are asked, without the values of joints.
//!
//! A pose is `g = v · b`, and `b` determines each leg's displacement τ along the intersection motion, once for all poses
//! that share it, a *slice*. It remains to decide whether the leg's lower chain closes at `v · exp(I τ)` within its
//! limits: that is a fixed region in the plane of `v`, or is computed pose by pose. In a *row* only the first coordinate
//! changes, and what a leg reaches of it changes only at its ends.
//!
//! [`Manipulator::reach`] gives a [`Reach`], which borrows the manipulator, and whose methods are the questions:
//!
//! | about | question | method |
//! |---|---|---|
//! | a slice | on which branches may a leg reach its poses? | [`leg_branches`](Reach::leg_branches), a [`LegBranch`] each |
//! | | what is the imaginary joint's value on a branch? | [`imaginary_value`](Reach::imaginary_value) |
//! | a section alone | do the upper sections close? | [`upper_closes`](Reach::upper_closes) |
//! | | on which branches may a lower section close, with a given τ? | [`lower_leg_branches`](Reach::lower_leg_branches) |
//! | | which τ are there, and do their revolutions matter? | [`intersection_joints`](Reach::intersection_joints), [`intersection_counts_turns`](Reach::intersection_counts_turns) |
//! | a height | do the lifts admit it? which manipulator is that of this height? | [`lifts_admit`](Reach::lifts_admit), [`raised`](Reach::raised) |
//! | a pose | does a leg reach it on a branch? | [`reaches`](Reach::reaches) |
//! | many poses | does a leg reach each of them on a branch? | [`reaches_many`](Reach::reaches_many) |
//! | | which of them are in reach? are they decided together? | [`decide_many`](Reach::decide_many), [`decides_many`](Reach::decides_many) |
//! | | which in reach is nearest to one that is not? | [`nearest`](Reach::nearest) |
//! | the plane | which translations does a leg reach on a branch? | [`region`](Reach::region), [`link_regions`](Reach::link_regions) |
//! | | are these regions the whole answer? | [`regions_decide`](Reach::regions_decide) |
//! | rows | what does a leg not reach of them, on a sphere? | [`row_arcs`](Reach::row_arcs), if it [`has_arcs`](Reach::has_arcs) |
//! | | near which of their poses may a leg's answer change? | [`row_ends`](Reach::row_ends), by its [`transitions`](Reach::transitions) |
//!
//! A leg is asked for by its number. A displacement `v` or `b` is in the frame of its subspace, as [`Task::lower`] and
//! [`Task::upper`] make them; coordinates are in the order of [`Manipulator::task_coordinates`], those of `v` first. All is in
//! radians and metres. A pose on a limit, or on the boundary of reach, is in reach.
//!
//! Two kinds of mechanism need care. With lifts that lean ([`Manipulator::lifts_straight`]) legs are asked about at a
//! height: ask [`Reach::raised`]'s manipulator, which is that of the height. And with coordinates that depend on those of a
//! pose, `v` and `b` are those of a completed pose, or [`Reach::decide_many`] is asked.
//!
//! Legs that are solved whole ([`Manipulator::is_whole`]) have no sections: only [`Reach::decide_many`] is asked about them.
//!
//! Each section can be examined alone: the upper one by whether every leg that is split there closes at `b`, the lower one
//! with the displacements τ given. If the workspace factorises ([`Manipulator::workspace_factorises`]), a pose is in reach
//! exactly where `b` is in reach of the upper section, and `v` with `τ(b)` in reach of the lower one. It does not factorise
//! where a leg that is split in its lower section has upper joints that are limited, actuated or may be out of reach.
//!
//! ```
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! let (task, reach) = (manipulator.task(), manipulator.reach());
//! let mode = Some(manipulator.home_mode());
//!
//! // The slice xi = 15°: one branch for each leg in a working mode, each with its τ.
//! let b = task.upper(&[0.0, 15_f64.to_radians(), 0.0]); // zeta xi psi
//! let mut branches = Vec::new();
//! for leg in 0..manipulator.legs() {
//!     reach.leg_branches(leg, &b, mode, &mut branches);
//! }
//! let (joint, value) = reach.imaginary_value(&branches[0]).expect("a reported imaginary joint");
//! assert_eq!(manipulator.imaginary()[joint].name, "theta11");
//! assert!((value.to_degrees() - 11.86).abs() < 0.005);
//!
//! // One pose of it, leg by leg.
//! let v = task.lower(&[0.01, 0.0]); // x y
//! assert!(branches.iter().all(|branch| reach.reaches(branch, &v)));
//! // The translations, in metres, that can be added for leg 1: at x = 0.01 the range of y has zero in it.
//! let region = reach.region(&branches[0], &v, 1.0).expect("a displacement in the plane");
//! let [from, to] = region.whole.rows([0.0, 0.0]);
//! assert!(from <= 0.0 && 0.0 <= to);
//!
//! // Many poses at once, in any working mode.
//! let poses = [0.01, 0.0, 0.0, 0.26, 0.0, /* the second one: */ 9.0, 0.0, 0.0, 0.26, 0.0];
//! let mut reached = [false; 2];
//! reach.decide_many(&poses, None, &mut manipulator.batch(), &mut reached, &mut |_, _| {});
//! assert_eq!(reached, [true, false]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Task::lower`]: crate::task::Task::lower
//! [`Task::upper`]: crate::task::Task::upper

mod decide;
mod nearest;
mod rows;
mod transitions;

pub use nearest::NearestPose;
pub use rows::{RowArcs, RowEnds, SheetRows};
pub use transitions::Transitions;

use crate::chain::region::Region;
use crate::chain::shape::Shape;
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::batch::lanes::LANES;
use crate::manipulator::{CompiledLeg, ImaginaryJoint, LegBranches, Manipulator, Mode, Section};
use nalgebra::Complex;

/// The most poses, or rows, that a question about many is asked for.
pub const AT_ONCE: usize = LANES;

/// What sweeps ask of a manipulator, which it borrows; made by [`Manipulator::reach`]. The [module](self) has a table of the
/// questions, and an example.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    manipulator: &'a Manipulator,
}

/// One branch of a leg's solutions over a slice of poses that share `b`.
#[derive(Clone, Copy, Debug)]
pub struct LegBranch {
    leg: usize,
    branches: LegBranches,
    /// The displacement along the intersection motion, where the leg is split in its upper section.
    tau: Option<JointDisplacement>,
    /// The displacement `b`, where the leg is split in its lower section and its upper section constrains it.
    with_upper: Option<Displacement>,
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
    /// What sweeps ask of it.
    #[inline]
    pub fn reach(&self) -> Reach<'_> {
        Reach { manipulator: self }
    }
}

impl<'a> Reach<'a> {
    /// Adds to `found` the branches of a leg over the slice of poses with this `b`, in one working mode, or
    /// (`None`) in all of them. There are at most four, and none where the leg is split in its upper section
    /// and that does not close.
    pub fn leg_branches(
        self,
        leg: usize,
        b: &Displacement,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) {
        let compiled = &self.manipulator.legs[leg];
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
            Some(mode) => solve(self.manipulator.branches(mode, leg)),
            None => {
                for mode in self.manipulator.leg_modes(leg) {
                    solve(self.manipulator.branches(mode, leg));
                }
            }
        }
    }

    /// The free displacements of the lower section alone, other than `v`: the displacement along the
    /// intersection motion of every leg that is split in its upper section, as an imaginary joint. They include
    /// the joints of [`Manipulator::imaginary`] of those legs; the others depend on these, or stay at home.
    pub fn intersection_joints(self) -> Vec<ImaginaryJoint> {
        let legs = self.manipulator.mechanism().legs.iter().enumerate();
        legs.filter(|&(number, _)| self.manipulator.legs[number].bridge() == Some(Section::Upper))
            .map(|(number, leg)| ImaginaryJoint::new(leg, number, self.manipulator.task()))
            .collect()
    }

    /// Whether the full revolutions of these displacements matter, since a helical joint turns with them.
    pub fn intersection_counts_turns(self) -> bool {
        let counts =
            |leg: &CompiledLeg| leg.lower.chain.counts_turns() || leg.upper.chain.counts_turns();
        self.manipulator.legs.iter().any(counts)
    }

    /// Adds to `found` the branches of a leg's lower section alone, with the leg displaced by `tau` along the
    /// intersection motion ([`ImaginaryJoint::displacement`]), radians or metres, in one working mode, or
    /// (`None`) in all of them. For a leg that is split in its lower section, `tau` is ignored.
    pub fn lower_leg_branches(
        self,
        leg: usize,
        tau: f64,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) {
        let compiled = &self.manipulator.legs[leg];
        let tau =
            (compiled.split_section == Section::Upper).then_some(JointDisplacement::Value(tau));
        let mut push = |branches: LegBranches| {
            // The choices of the upper section do not affect the lower one.
            if found.iter().all(|branch| branch.branches.lower != branches.lower) {
                found.push(LegBranch { leg, branches, tau, with_upper: None });
            }
        };
        match mode {
            Some(mode) => push(self.manipulator.branches(mode, leg)),
            None => {
                for mode in self.manipulator.leg_modes(leg) {
                    push(self.manipulator.branches(mode, leg));
                }
            }
        }
    }

    /// Whether every leg that is split in its upper section closes there at `b` within its limits, in one
    /// working mode, or (`None`) in any. `found` is working memory.
    pub fn upper_closes(
        self,
        b: &Displacement,
        mode: Option<Mode>,
        found: &mut Vec<LegBranch>,
    ) -> bool {
        (0..self.manipulator.legs.len()).all(|leg| {
            found.clear();
            self.leg_branches(leg, b, mode, found);
            !found.is_empty()
        })
    }

    /// The number and the value (radians or metres) of the imaginary joint of a branch; `None` where its leg
    /// has no reported one.
    pub fn imaginary_value(self, branch: &LegBranch) -> Option<(usize, f64)> {
        let number = self.manipulator.legs[branch.leg].imaginary?;
        let joint = &self.manipulator.imaginary()[number];
        Some((number, joint.value(branch.tau?, joint.home)))
    }

    /// Whether all lifts are within their limits at a height above home, metres.
    #[inline]
    pub fn lifts_admit(self, rise: f64) -> bool {
        self.manipulator.lifts().all(|lift| self.manipulator.lifted(lift, rise).1)
    }

    /// The manipulator for poses at a height above home, metres, of which no lift leans: its legs' chains are those of that
    /// height. `None` where a leg has no closed form there.
    pub fn raised(self, rise: f64) -> Option<Manipulator> {
        let mut raised = self.manipulator.clone();
        for (leg, of_height) in self.manipulator.legs.iter().zip(&mut raised.legs) {
            if let Some(lean) = &leg.lean {
                *of_height = leg.raised(lean, rise).ok()?;
                of_height.shapes = of_height.lower.shapes();
                of_height.bounds = of_height.lower.bounds();
            }
        }
        Some(raised)
    }

    /// Whether a leg closes at `v` on a branch within its limits.
    #[inline]
    pub fn reaches(self, branch: &LegBranch, v: &Displacement) -> bool {
        let leg = &self.manipulator.legs[branch.leg];
        match (branch.tau, &branch.with_upper) {
            (Some(tau), _) => leg
                .solve_lower(self.manipulator.task(), v, tau, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&displacements)),
            (None, None) => leg
                .lower
                .inverse(v, branch.branches.lower)
                .is_ok_and(|displacements| leg.lower.admits(&displacements)),
            (None, Some(b)) => leg
                .solve(self.manipulator.task(), [v, b], 0.0, branch.branches, 0.0)
                .is_ok_and(|solution| {
                    leg.lower.admits(&solution.lower) && leg.upper.admits(&solution.upper)
                }),
        }
    }

    /// Translations that can be added to the displacement `v`, in units of `1 / scale`: where the lower section of a leg closes
    /// on a branch. With [`Reach::link_regions`], where it also is within its limits, but for limits on angles that make
    /// the translations more than a convex set with a convex hole: these are left aside. `None` where `v` is not a
    /// displacement of a plane.
    #[inline(always)]
    pub fn region(self, branch: &LegBranch, v: &Displacement, scale: f64) -> Option<Region> {
        let (shape, rotation, shift) = self.shape_at(branch, v)?;
        shape.at(rotation, shift, scale)
    }

    /// Whether the regions of a branch, or its arcs ([`Reach::row_arcs`]), leave nothing aside: they agree with
    /// [`Reach::reaches`] up to rounding.
    pub fn regions_decide(self, branch: &LegBranch) -> bool {
        let leg = &self.manipulator.legs[branch.leg];
        let shell = leg.shell(branch.branches.lower).is_some();
        let free = |joint: usize| {
            leg.lower.coordinates[joint].as_ref().is_none_or(|joint| joint.limits.arc().is_none())
        };
        branch.with_upper.is_none()
            && (leg.shape(branch.branches.lower).is_some() || shell && free(0) && free(2))
    }

    /// Whether [`Reach::row_arcs`] can be used for a branch.
    pub fn has_arcs(self, branch: &LegBranch) -> bool {
        self.manipulator.legs[branch.leg].shell(branch.branches.lower).is_some()
    }

    /// Calls `found` with regions as [`Reach::region`], which limits on a link that slides leave: a leg closes for
    /// the translations that all of them have in common.
    #[inline]
    pub fn link_regions(
        self,
        branch: &LegBranch,
        v: &Displacement,
        scale: f64,
        found: impl FnMut(Region),
    ) {
        let shape = self.manipulator.legs[branch.leg].shape(branch.branches.lower);
        if shape.is_some_and(Shape::limits_link)
            && let Some((shape, rotation, shift)) = self.shape_at(branch, v)
        {
            shape.link_regions(rotation, shift, scale, found);
        }
    }

    /// The shape in which a leg closes, the rotation of its target, and what is added to its points to be translations.
    #[inline(always)]
    fn shape_at(
        self,
        branch: &LegBranch,
        v: &Displacement,
    ) -> Option<(&'a Shape, Complex<f64>, Complex<f64>)> {
        let leg = &self.manipulator.legs[branch.leg];
        let shape = leg.shape_or_bounds(branch.branches.lower)?;
        let mut target = match branch.tau {
            Some(tau) => &self.manipulator.task().lower_intersection.after(v, tau),
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
