//! Where along a row of a sweep a leg may begin or cease to follow.
//!
//! In a row all coordinates but the first are fixed, and the target of the leg's lower chain moves along
//! a [`Path`](crate::group::Path). What the leg does changes only where the path meets the [`Surface`]s of
//! its chain: a joint at its limit, two branches that meet. A leg may take the cut in its lower section,
//! with an upper section that constrains it. In a slice only the cut moves the upper section's target, so
//! that what the upper section allows is arcs of the cut's displacement. Their ends are limits of the cut,
//! the last joint of the lower chain.

use super::leg::CompiledSection;
use super::{LegBranch, Manipulator};
use crate::chain::equation::Span;
use crate::chain::limits::Limits;
use crate::chain::surface::Surface;
use crate::group::{Displacement, JointDisplacement};
use crate::numeric::Quantity;
use crate::numeric::angle::unit;
use std::f64::consts::PI;

/// How far a cut may slide, in sizes of the leg, and its upper section still be asked for: beyond, its
/// rounding is no longer that of a number of that size.
const FAR: f64 = 1e4;

/// What can change a leg's mind within a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct Transitions {
    surfaces: Vec<Surface>,
    /// Ends of what the upper section allows, each known to within a share.
    tau_limits: Vec<(Surface, f64)>,
    /// No number of the leg is larger, metres.
    size: f64,
    /// How far the cut may slide for the above to hold, metres.
    largest_tau: Option<f64>,
}

impl CompiledSection {
    /// Where the section's chain enters and leaves its limits, and where its branches meet; `None` where
    /// there is no closed form for that.
    fn surfaces(&self, limits: &[Limits]) -> Option<Vec<Surface>> {
        let mut surfaces = self.chain.folds();
        for (joint, coordinate) in self.coordinates.iter().enumerate() {
            let Some(coordinate) = coordinate else { continue };
            for end in self.chain.ends(joint, &limits[coordinate.number]).into_iter().flatten() {
                surfaces.push(self.chain.held(joint, end)?);
            }
        }
        Some(surfaces)
    }

    /// The sum of its lengths, limits included.
    fn size(&self, manipulator: &Manipulator) -> f64 {
        let limit = |coordinate: usize| {
            let (low, high) = manipulator.limits[coordinate].range();
            let length = manipulator.coordinates[coordinate].quantity == Quantity::Length;
            if length && low.is_finite() { low.abs().max(high.abs()) } else { 0.0 }
        };
        let limits: f64 =
            self.coordinates.iter().flatten().map(|coordinate| limit(coordinate.number)).sum();
        self.chain.size() + limits
    }
}

impl Manipulator {
    /// What can change a leg's mind within the slice. `None` where no closed form tells: limits on
    /// the rotation vector of a spherical joint.
    pub fn transitions(&self, branch: &LegBranch) -> Option<Transitions> {
        let leg = &self.legs[branch.leg];
        let size = self.length + leg.lower.size(self);
        let mut transitions = Transitions {
            surfaces: leg.lower.surfaces(&self.limits)?,
            tau_limits: Vec::new(),
            size,
            largest_tau: None,
        };
        if let Some(b) = &branch.with_upper {
            self.add_tau_limits(branch, b, &mut transitions)?;
        }
        Some(transitions)
    }

    /// What the upper section allows, as limits of the cut.
    fn add_tau_limits(
        &self,
        branch: &LegBranch,
        b: &Displacement,
        transitions: &mut Transitions,
    ) -> Option<()> {
        let leg = &self.legs[branch.leg];
        let last = leg.lower.chain.freedoms() - 1;
        transitions.size += leg.upper.size(self) + b.size();
        let rotation = self.task.intersection_point.is_some();
        let largest_tau = if rotation { PI } else { FAR * transitions.size };
        transitions.largest_tau = (!rotation).then_some(largest_tau);
        let span = Span { from: -largest_tau, to: largest_tau, step: 0.0 };
        let path = self.task.upper_intersection.path(b);
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
        for surface in leg.upper.surfaces(&self.limits)? {
            surface.meet(&path, &span, [size, 0.0], &mut |[from, to]| {
                let blur = 0.5 * (to - from);
                let share = if rotation { blur } else { blur / size };
                tau_limits.extend(hold(0.5 * (from + to)).map(|surface| (surface, share)));
            });
        }
        if leg.unwinds {
            // Where it is unwound to the other side.
            tau_limits.extend(hold(PI).map(|surface| (surface, 0.0)));
        }
        Some(())
    }

    /// Gives the intervals of a span of the first coordinate in which the leg may change its mind, when
    /// the other coordinates of `v` are `others`: outside of them, it follows everywhere between two or
    /// nowhere, as [`Manipulator::reaches`] says.
    pub fn changes(
        &self,
        (branch, transitions): (&LegBranch, &Transitions),
        others: &[f64],
        span: &Span,
        found: &mut impl FnMut([f64; 2]),
    ) {
        let leg = &self.legs[branch.leg];
        let home = self.task.coordinates[0].home;
        let moved = Span { from: span.from - home, to: span.to - home, step: span.step };
        let mut found = |[from, to]: [f64; 2]| found([from + home, to + home]);
        let at = |first: f64| {
            let mut pose = [first, 0.0, 0.0];
            pose[1..=others.len()].copy_from_slice(others);
            self.task.lower(&pose)
        };
        let start = match branch.tau {
            Some(tau) => self.task.lower_intersection.after(&at(home), tau),
            None => at(home),
        };
        let path = self.task.row(&start);
        let size = transitions.size + path.size(moved.reach());
        for surface in &transitions.surfaces {
            surface.meet(&path, &moved, [size, 0.0], &mut found);
        }
        // A cut that slides farther than the leg is long is linear along the row: most at one of its ends.
        let beyond = |most: f64| {
            [span.from, span.to].into_iter().any(|first| {
                let displacements = leg.lower.chain.inverse(&at(first), branch.branches.lower);
                let last = leg.lower.chain.freedoms() - 1;
                displacements.is_ok_and(|displacements| displacements[last].value().abs() > most)
            })
        };
        if transitions.largest_tau.is_some_and(beyond) {
            found([moved.from, moved.to]);
        }
        for (surface, blur) in &transitions.tau_limits {
            surface.meet(&path, &moved, [size, *blur], &mut found);
        }
    }
}
