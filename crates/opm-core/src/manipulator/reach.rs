//! Which poses of a row are in reach: the inner loop of a sweep.
//!
//! `b` decides, once for a whole slice of a grid, each leg's imaginary joint; what is left per pose
//! is whether the leg's lower chain closes on `v · exp(I τ)` within its limits. Along a row of `v`
//! that differ in their first coordinate, that is a square root a leg.

use super::leg::{LegBranches, Section};
use super::{Manipulator, Mode};
use crate::chain::planar::{PlanarChain, Rrr};
use crate::chain::{Amount, Chain};
use crate::limits::Limits;
use crate::task::{Cut, Displacement, SubspaceKind};
use nalgebra::Complex;

/// One way in which a leg can follow a slice of poses that share `b`.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    leg: usize,
    branches: LegBranches,
    b: Displacement,
    /// Found from `b`, where the leg's upper section takes the cut.
    tau: Option<Amount>,
}

/// One where a pose is marked, else zero: as wide as the numbers that decide it, so that the loop over
/// a row is vectorised without packing.
pub type Mark = u64;

/// Poses of a slice that differ in their first coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Values of the first coordinate.
    pub first: &'a [f64],
    /// The other coordinates of `v`.
    pub others: &'a [f64],
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

    /// Marks pose `i` in `mask[i]` where the leg follows to it: the same answer as
    /// [`Manipulator::follows`], bit for bit.
    ///
    /// # Panics
    /// If the mask is not as long as the row.
    pub fn mark(&self, way: &Follow, row: &Row<'_>, mask: &mut [Mark]) {
        assert_eq!(mask.len(), row.first.len(), "mask and row");
        if let Some(chain) = self.plain_planar(way) {
            return self.mark_planar(way, chain, row, mask);
        }
        let mut pose = [0.0; 3];
        pose[1..=row.others.len()].copy_from_slice(row.others);
        for (marked, &first) in mask.iter_mut().zip(row.first) {
            if *marked == 0 {
                pose[0] = first;
                *marked = Mark::from(self.follows(way, &self.task.lower(&pose)));
            }
        }
    }

    /// The lower chain, where nothing but it decides: `v` is a translation in a plane, and no limit
    /// on an angle nor the upper section has a say.
    fn plain_planar(&self, way: &Follow) -> Option<&PlanarChain> {
        let leg = &self.legs[way.leg];
        let Chain::Planar(chain) = &leg.lower.chain else { return None };
        let translation =
            self.task.lower.kind == SubspaceKind::Planar && self.task.lower_cut == Cut::Turn;
        let upper_decides = way.tau.is_none() && leg.upper_decides;
        let free = |slot: usize| {
            leg.lower.slots[slot].is_none_or(|s| self.limits[s.coordinate] == Limits::Free)
        };
        let plain = match chain {
            PlanarChain::Rrr(_) => free(0) && free(1) && free(2),
            PlanarChain::Prr(_) => free(1) && free(2),
            _ => false,
        };
        (translation && !upper_decides && plain).then_some(chain)
    }

    fn mark_planar(&self, way: &Follow, chain: &PlanarChain, row: &Row<'_>, mask: &mut [Mark]) {
        let leg = &self.legs[way.leg];
        let rotation = way.tau.map_or(Complex::new(1.0, 0.0), Amount::turn);
        let home = self.task.coordinates[0].home;
        let y = row.others[0] - self.task.coordinates[1].home;
        // The arithmetic of PlanarDisplacement::apply, its constant half taken out of the loop.
        let moved = |point: Complex<f64>| {
            let turned = rotation * point;
            move |x: f64| turned + Complex::new(x - home, y)
        };
        match chain {
            PlanarChain::Rrr(chain) => {
                let wrist = moved(chain.wrist());
                set(mask, row, |x| Rrr::closes(chain.elbow_cosine(wrist(x))));
            }
            PlanarChain::Prr(chain) => {
                let outer = moved(chain.outer());
                let sign = way.branches.lower.sign();
                let limits =
                    leg.lower.slots[0].map_or(&Limits::Free, |s| &self.limits[s.coordinate]);
                let (low, high) = limits.range();
                set(mask, row, |x| {
                    let (along, square) = chain.triangle(outer(x));
                    let slider = along + sign * square.max(0.0).sqrt();
                    chain.closes(square) & (slider >= low) & (slider <= high)
                });
            }
            _ => unreachable!("plain_planar gives only RRR and PRR"),
        }
    }
}

/// Sets `mask` where the predicate holds; free of branches, so that it is vectorised.
#[inline]
fn set(mask: &mut [Mark], row: &Row<'_>, predicate: impl Fn(f64) -> bool) {
    for (marked, &x) in mask.iter_mut().zip(row.first) {
        *marked |= Mark::from(predicate(x));
    }
}
