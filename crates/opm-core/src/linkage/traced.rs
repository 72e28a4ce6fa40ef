//! Loops without sections: traced.
//!
//! A loop with one freedom moves along curves in the space of its joints. They are [traced](curve) by steps along the tangent, and
//! corrected onto the loop's equations of closure, whatever its joints are: what is traced is closed in finite motion, which is the
//! certificate of an overconstrained loop (Bennett, Goldberg, Myard, Bricard, Altmann). The curve through home is traced
//! from home; others from [every assembly](assemblies) at some values of each revolute.

mod arcs;
mod assemblies;
mod closed_loop;
mod curve;
mod dual_quaternion;
mod homotopy;
mod input;

pub use arcs::{ArcEnd, Arcs};
pub use curve::Stuck;
pub use input::TracedInput;

use crate::group::JointDisplacement;
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use crate::numeric::angle::unit;
use assemblies::Assemblies;
use closed_loop::{ClosedLoop, FreedomKind, Motions, Posture};
use curve::{Curve, Knot, SAME};
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// At so many values of each revolute all assemblies are looked for.
const SAMPLES: usize = 12;
/// Where they begin: at no symmetric value.
const FIRST_SAMPLE: f64 = 0.1357;

/// A loop with one freedom, and the curves that it moves along.
#[derive(Clone, Debug)]
pub struct Traced {
    closed: ClosedLoop,
    curves: Vec<Curve>,
    /// The arcs of each joint as the input, made when they are first asked for.
    arcs: Vec<OnceLock<Option<Arcs>>>,
    /// The number of complex solutions with the first revolute held; `None` if only home's curve is known.
    solutions: Option<usize>,
}

/// Whether the second hinge of each parallelogram turns back what the first one turns, all along a curve.
fn keeps_parallelograms(mechanism: &Mechanism, curve: &Curve) -> bool {
    let back: Vec<bool> = mechanism.legs.iter().flat_map(Leg::turn_back).collect();
    curve.knots.iter().all(|Knot { at, .. }| {
        (1..back.len()).filter(|&freedom| back[freedom]).all(|freedom| {
            let sum = at.values[freedom - 1] + at.values[freedom];
            (sum - TAU * (sum / TAU).round()).abs() < SAME
        })
    })
}

impl Traced {
    /// Traces the loop of a mechanism of two legs.
    ///
    /// # Errors
    /// It is rigid, or has several freedoms.
    pub fn new(mechanism: &Mechanism) -> Result<Self, Stuck> {
        let closed = ClosedLoop::new(mechanism);
        let linked = mechanism.parallelograms().next().is_some();
        let start = Knot::new(&closed, closed.home(), None).map_err(|stuck| match stuck {
            Stuck::Several(_) if linked => Stuck::Parallelogram,
            stuck => stuck,
        })?;
        let mut curves = vec![Curve::through(&closed, start)?];
        if linked && !keeps_parallelograms(mechanism, &curves[0]) {
            return Err(Stuck::Parallelogram);
        }
        let mut solutions = None;
        for held in 0..closed.count() {
            if closed.freedoms[held].kind != FreedomKind::Turn || closed.is_ball(held) {
                continue;
            }
            let Some(all) = Assemblies::new(&closed, held) else { break };
            solutions = solutions.or(Some(all.count()));
            for sample in 0..SAMPLES {
                let at = FIRST_SAMPLE + sample as f64 * TAU / SAMPLES as f64;
                for found in all.at(at) {
                    let known = |curve| passes(&closed, curve, &found);
                    let knots: usize = curves.iter().map(|curve| curve.knots.len()).sum();
                    let too_far = closed.farthest(&found) > curve::FAR;
                    if too_far || knots > curve::MOST_KNOTS || curves.iter().any(known) {
                        continue;
                    }
                    // A single position, or where curves cross, is on no curve of its own.
                    let start = Knot::new(&closed, found, None);
                    curves.extend(start.and_then(|start| Curve::through(&closed, start)));
                }
            }
        }
        if linked {
            curves.retain(|curve| keeps_parallelograms(mechanism, curve));
        }
        let arcs = vec![OnceLock::new(); closed.count()];
        Ok(Self { closed, curves, arcs, solutions })
    }

    /// The number of complex assemblies with the first revolute held; `None` if only home's curve is known.
    pub fn solutions(&self) -> Option<usize> {
        self.solutions
    }

    /// The arcs with this coordinate as the input. `None` if it stands still, or is a ball's.
    pub fn arcs(&self, input: usize) -> Option<&Arcs> {
        let make = || {
            if self.closed.is_ball(input) {
                return None;
            }
            Arcs::new(&self.closed, &self.curves, input)
        };
        self.arcs[input].get_or_init(make).as_ref()
    }

    /// Whether a coordinate is a rotation without an advance.
    pub fn turns(&self, coordinate: usize) -> bool {
        self.closed.freedoms[coordinate].kind == FreedomKind::Turn
    }

    /// The displacement of a freedom for a displacement of its coordinate, radians or metres.
    pub fn inward(&self, coordinate: usize, displacement: f64) -> f64 {
        displacement / self.unit(coordinate)
    }

    /// The unit of a freedom, radians or metres.
    pub fn unit(&self, coordinate: usize) -> f64 {
        self.closed.unit(coordinate)
    }

    /// The displacements of all coordinates in an arc, radians and metres.
    pub fn position(
        &self,
        arcs: &Arcs,
        arc: usize,
        displacement: f64,
    ) -> Option<Vec<JointDisplacement>> {
        let x = arcs.position(&self.closed, arc, displacement)?;
        let all = self.closed.displacements(&x).into_iter().enumerate();
        let displacement = |(i, value)| {
            if self.turns(i) && !self.closed.is_ball(i) {
                JointDisplacement::Direction(unit(value))
            } else {
                JointDisplacement::Value(value)
            }
        };
        Some(all.map(displacement).collect())
    }

    /// The rates of all coordinates for a unit rate of the input. `None` at a fold.
    pub fn rates(
        &self,
        arcs: &Arcs,
        arc: usize,
        (input, displacement): (usize, f64),
    ) -> Option<Vec<f64>> {
        let x = arcs.position(&self.closed, arc, displacement)?;
        let Motions::One(motion) = self.closed.motions(&x) else { return None };
        let own = motion[input];
        if own.abs() < SAME {
            return None;
        }
        let rates = self.closed.rates(&x, &(motion / own));
        let unit = self.unit(input);
        Some(rates.into_iter().map(|rate| rate / unit).collect())
    }
}

/// Whether a curve passes through a position.
fn passes(of: &ClosedLoop, curve: &Curve, at: &Posture) -> bool {
    let far = 2.0 * curve::LONGEST * of.farthest(at).max(1.0);
    curve.knots.iter().any(|knot| {
        let ahead = of.nearest_step(&knot.at, at);
        if ahead.norm() > far {
            return false;
        }
        knot.towards(of, at).is_some_and(|(_, off)| off <= SAME)
    })
}
