//! The transitions of a leg along a row of a sweep: where it may begin or cease to reach the pose.
//!
//! In a row all coordinates except the first are fixed, and the target of the leg's lower chain moves along
//! a [`Path`](crate::group::Path). Feasibility changes only where the path meets the [`Surface`]s of the
//! chain: where a joint is at its limit, or two branches meet. A leg may be split in its lower section, with
//! an upper section that constrains it. In a slice only the imaginary joint moves the upper section's
//! target, so that the upper section allows intervals of that joint's displacement. Their ends are limits of
//! the imaginary joint, the last joint of the lower chain.

use super::{LegBranch, Reach};
use crate::chain::equation::Span;
use crate::chain::limits::Limits;
use crate::chain::surface::{Surface, Uncertainty};
use crate::group::{Displacement, JointDisplacement, MotionType};
use crate::manipulator::{CompiledSection, Manipulator};
use crate::numeric::Quantity;
use crate::numeric::angle::unit;
use std::f64::consts::PI;

/// The largest translation of the imaginary joint for which transitions are computed, in sizes of the leg:
/// beyond it, the rounding is larger than that of the leg's lengths.
const FAR: f64 = 1e4;

/// The targets at which a leg's feasibility can change within a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct Transitions {
    /// Those at which the lower chain leaves a convex set of the plane in which it closes, or what its middle joint leaves of
    /// a sphere.
    outer: Vec<Surface>,
    /// The others at which the lower chain's branches meet, or a joint of it is at an end of its limits.
    inner: Vec<Surface>,
    /// The targets at which the imaginary joint is at an end of what the upper section allows, each with the
    /// uncertainty of that end.
    tau_limits: Vec<(Surface, f64)>,
    /// An upper bound of the leg's lengths, metres.
    size: f64,
    /// The largest translation of the imaginary joint for which the surfaces are complete, metres; `None`
    /// where it is not limited.
    largest_tau: Option<f64>,
}

impl Transitions {
    /// The surfaces, each with the uncertainty of where it is; with or without the outer ones.
    pub(super) fn surfaces(&self, outer: bool) -> impl Iterator<Item = (&Surface, f64)> {
        let outer = self.outer.iter().filter(move |_| outer);
        let known = outer.chain(&self.inner).map(|surface| (surface, 0.0));
        known.chain(self.tau_limits.iter().map(|(surface, blur)| (surface, *blur)))
    }

    /// An upper bound of the leg's lengths, metres.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Whether the surfaces are all that matter for targets of this size, metres: a translation of the imaginary joint is
    /// no longer than the target's and the leg's lengths together.
    pub(super) fn are_complete(&self, size: f64) -> bool {
        self.largest_tau.is_none_or(|largest| self.size + size <= largest)
    }
}

impl CompiledSection {
    /// The surfaces at which the branches of the section's chain meet within its limits, with their numbers.
    fn folds(&self) -> Vec<(usize, Surface)> {
        let middle = self.coordinates[1].as_ref();
        self.chain.folds(middle.map_or(&Limits::Free, |middle| &middle.limits))
    }

    /// The surfaces at which the section's chain enters and leaves its limits, each with the number of the joint; `None`
    /// where they have no closed form.
    fn ends(&self) -> Option<Vec<(usize, Surface)>> {
        let mut surfaces = Vec::new();
        for (joint, coordinate) in self.coordinates.iter().enumerate() {
            let Some(coordinate) = coordinate else { continue };
            for end in self.chain.ends(joint, &coordinate.limits).into_iter().flatten() {
                surfaces.push((joint, self.chain.held(joint, end)?));
            }
        }
        Some(surfaces)
    }

    /// The sum of the section's lengths, limits included, metres.
    fn size(&self, manipulator: &Manipulator) -> f64 {
        let limit = |coordinate: usize| {
            let (low, high) = manipulator.limits()[coordinate].range();
            let length = manipulator.coordinates()[coordinate].quantity == Quantity::Length;
            if length && low.is_finite() { low.abs().max(high.abs()) } else { 0.0 }
        };
        let limits: f64 =
            self.coordinates.iter().flatten().map(|coordinate| limit(coordinate.number)).sum();
        self.chain.size() + limits
    }
}

impl Reach<'_> {
    /// The transitions of a leg within a slice. `None` where they have no closed form: with limits on the
    /// rotation vector of a spherical joint, and along an azimuth.
    pub fn transitions(self, branch: &LegBranch) -> Option<Transitions> {
        let manipulator = self.manipulator;
        if !manipulator.task().rows_are_paths() {
            return None;
        }
        let leg = &manipulator.legs[branch.leg];
        let size = manipulator.characteristic_length() + leg.lower.size(manipulator);
        let spherical = leg.shell(branch.branches.lower).is_some();
        let (folds, ends) = (leg.lower.folds(), leg.lower.ends()?);
        let is_outer = |fold: usize| spherical || leg.lower.chain.is_convex_fold(fold);
        let of_folds = folds.into_iter().map(|(fold, surface)| (is_outer(fold), surface));
        let of_ends = ends.into_iter().map(|(joint, surface)| (spherical && joint == 1, surface));
        let (outer, inner): (Vec<_>, Vec<_>) =
            of_folds.chain(of_ends).partition(|(outer, _)| *outer);
        let surfaces =
            |of: Vec<(bool, Surface)>| of.into_iter().map(|(_, surface)| surface).collect();
        let mut transitions = Transitions {
            outer: surfaces(outer),
            inner: surfaces(inner),
            tau_limits: Vec::new(),
            size,
            largest_tau: None,
        };
        if let Some(b) = &branch.with_upper {
            self.add_tau_limits(branch, b, &mut transitions)?;
        }
        Some(transitions)
    }

    /// Adds the ends of what the upper section allows, as limits of the imaginary joint.
    fn add_tau_limits(
        self,
        branch: &LegBranch,
        b: &Displacement,
        transitions: &mut Transitions,
    ) -> Option<()> {
        let (leg, task) = (&self.manipulator.legs[branch.leg], self.manipulator.task());
        let last = leg.lower.chain.freedoms() - 1;
        transitions.size += leg.upper.size(self.manipulator) + b.size();
        let rotation = task.shared() == Some(MotionType::Rotation);
        let largest_tau = if rotation { PI } else { FAR * transitions.size };
        transitions.largest_tau = (!rotation).then_some(largest_tau);
        let span = Span { from: -largest_tau, to: largest_tau, step: 0.0 };
        let b = leg.upper.of_chain(b);
        let Some(path) = task.upper_intersection.path(&b) else { return Some(()) };
        let hold = |at: f64| {
            let displacement = if rotation {
                JointDisplacement::Direction(unit(at))
            } else {
                JointDisplacement::Value(at)
            };
            leg.lower.chain.held(last, displacement)
        };
        let size = transitions.size;
        let tau_limits = &mut transitions.tau_limits;
        let (folds, ends) = (leg.upper.folds(), leg.upper.ends()?);
        for (_, surface) in folds.iter().chain(&ends) {
            surface.meet(&path, &span, Uncertainty { size, blur: 0.0 }, &mut |[from, to]| {
                let blur = 0.5 * (to - from);
                let share = if rotation { blur } else { blur / size };
                tau_limits.extend(hold(0.5 * (from + to)).map(|surface| (surface, share)));
            });
        }
        if leg.unwinds {
            // The angle within π of home jumps there.
            tau_limits.extend(hold(PI).map(|surface| (surface, 0.0)));
        }
        Some(())
    }
}
