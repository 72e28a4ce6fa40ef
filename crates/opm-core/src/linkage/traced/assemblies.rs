//! Every assembly of a loop with one joint held.
//!
//! The other joints, at most six, are the inverse kinematics of a serial chain. They are found by
//! [continuation](super::homotopy): a generic loop of the same kinds of joints has a known number of complex solutions (16 for six
//! revolutes), found once by carrying one of them around in the space of all loops until no new one comes. Those of the loop at
//! hand are where these go. A loop of fewer joints is completed by lines in general position; its solutions are those that do not
//! turn about them.

use super::arcs::unit;
use super::closed_loop::{ClosedLoop, FreedomKind, LoopFreedom, Posture};
use super::dual_quaternion::{C, DualQuaternion, V};
use super::homotopy::{Axis, Before, Homotopy, Unknowns};
use fastrand::Rng;
use nalgebra::{DVector, Vector3};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Rounding of a solution: of joints that do not turn, of real ones, and of two that are one.
const SAME: f64 = 1e-6;
/// So often, in a row, nothing new may come before all are known.
const MOST_QUIET: usize = 4;
const MOST_ROUNDS: usize = 60;

/// A generic loop of six joints of given kinds, and its solutions.
struct Generic {
    homotopy: Homotopy,
    solutions: Vec<Unknowns>,
}

/// The assemblies of a loop, seen from one of its joints.
pub struct Assemblies<'a> {
    of: &'a ClosedLoop,
    /// The joints after the one that is held, in the order of the loop.
    others: Vec<usize>,
    held: usize,
    homotopy: Homotopy,
    solutions: Vec<Unknowns>,
}

fn number(rng: &mut Rng) -> C {
    C::new(2.0 * rng.f64() - 1.0, 2.0 * rng.f64() - 1.0)
}

fn vector(rng: &mut Rng) -> V {
    V::from_fn(|_, _| number(rng))
}

/// An axis in general position.
fn any_axis(rng: &mut Rng, slides: bool) -> Axis {
    if slides {
        let direction = vector(rng);
        Axis::Slide([direction; 2])
    } else {
        let points = [vector(rng), vector(rng)];
        Axis::Turn(points.map(|point| [point; 2]))
    }
}

/// How many solutions six joints have of which so many slide, in general position; `None` for more slides than a loop can have.
/// (Tsai and Morgan 1985; Raghavan and Roth 1993.)
fn expected(slides: usize) -> Option<usize> {
    [16, 16, 8, 2].get(slides).copied()
}

impl Generic {
    /// That of these kinds of joints, found when it is first needed.
    fn of(slides: [bool; 6]) -> Option<Arc<Self>> {
        static KNOWN: Mutex<BTreeMap<[bool; 6], Arc<Generic>>> = Mutex::new(BTreeMap::new());
        let mut known = KNOWN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(found) = known.get(&slides) {
            return Some(found.clone());
        }
        let count = expected(slides.iter().filter(|&&s| s).count())?;
        let found = Arc::new(Self::search(slides, count));
        // With fewer, nothing could be said of all assemblies.
        (found.solutions.len() == count).then(|| {
            known.insert(slides, found.clone());
            found
        })
    }

    fn search(slides: [bool; 6], count: usize) -> Self {
        let mut rng = Rng::with_seed(6);
        let axes = slides.map(|slides| any_axis(&mut rng, slides));
        let charts = slides.map(|_| [0; 2].map(|_| [0; 2].map(|_| number(&mut rng))));
        let still = Before::Free([([C::ONE; 4], V::zeros()); 2]);
        let mut homotopy = Homotopy { before: still, axes, charts };
        let start = Unknowns::from_fn(|_, _| number(&mut rng));
        let base = homotopy.joints_at_start(&start).reversed().parts();
        homotopy.before = Before::Free([base; 2]);
        let mut solutions = vec![start];
        let mut quiet = 0;
        for _ in 0..MOST_ROUNDS {
            if solutions.len() >= count || quiet > MOST_QUIET {
                break;
            }
            let mut corners = vec![(axes, base)];
            for _ in 0..2 {
                let q = [0; 4].map(|_| number(&mut rng));
                let corner = slides.map(|slides| any_axis(&mut rng, slides));
                corners.push((corner, (q, vector(&mut rng))));
            }
            let before = solutions.len();
            for number in 0..before {
                let mut at = Some(solutions[number]);
                for side in 0..3 {
                    let (from, to) = (&corners[side], &corners[(side + 1) % 3]);
                    let moving = Homotopy {
                        before: Before::Free([from.1, to.1]),
                        axes: std::array::from_fn(|i| from.0[i].towards(&to.0[i])),
                        charts,
                    };
                    at = at.and_then(|at| moving.follow(&at));
                }
                if let Some(found) = at {
                    add(&mut solutions, found);
                }
            }
            quiet = if solutions.len() > before { 0 } else { quiet + 1 };
        }
        Self { homotopy, solutions }
    }
}

/// Adds a solution unless it is known.
fn add(solutions: &mut Vec<Unknowns>, found: Unknowns) {
    let near = |other: &Unknowns| (other - found).norm() <= SAME * (1.0 + found.norm());
    if !solutions.iter().any(near) {
        solutions.push(found);
    }
}

/// The axis of a joint of the loop, with its sign.
fn axis(freedom: &LoopFreedom, sign: f64) -> Axis {
    let complex = |v: Vector3<f64>| v.map(C::from);
    let direction = freedom.screw.angular * sign;
    match freedom.kind {
        FreedomKind::Turn => {
            // The foot of the perpendicular from the origin, and a point further on.
            let foot = freedom.screw.angular.cross(&freedom.screw.linear);
            Axis::Turn([[complex(foot); 2], [complex(foot + direction); 2]])
        }
        FreedomKind::Slide | FreedomKind::Helix => {
            Axis::Slide([complex(freedom.screw.linear * sign); 2])
        }
    }
}

/// The ratio `b / a` of a factor at a joint's displacement.
fn ratio(kind: FreedomKind, displacement: f64) -> f64 {
    match kind {
        FreedomKind::Turn => (0.5 * displacement).tan(),
        FreedomKind::Slide | FreedomKind::Helix => 0.5 * displacement,
    }
}

impl<'a> Assemblies<'a> {
    /// Those with one freedom held. `None` where the equations are not algebraic, or the joints too many.
    pub fn new(of: &'a ClosedLoop, held: usize) -> Option<Self> {
        if of.freedoms.iter().any(|freedom| freedom.kind == FreedomKind::Helix) {
            return None;
        }
        let place = of.order.iter().position(|&(i, _)| i == held)?;
        let sign = of.order[place].1;
        let after = of.order[place + 1..].iter().chain(&of.order[..place]);
        let others: Vec<(usize, f64)> = after.copied().collect();
        if others.len() > 6 {
            return None;
        }
        let mut slides = [false; 6];
        for (slides, &(i, _)) in slides.iter_mut().zip(&others) {
            *slides = of.freedoms[i].kind == FreedomKind::Slide;
        }
        let generic = Generic::of(slides)?;
        let mut rng = Rng::with_seed(7);
        let own: [Axis; 6] = std::array::from_fn(|place| match others.get(place) {
            Some(&(i, sign)) => axis(&of.freedoms[i], sign),
            None => any_axis(&mut rng, false),
        });
        let [held_axis, _] = axis(&of.freedoms[held], sign).at(0.0);
        // A complex value of the joint that is held, so that no paths meet there.
        let value = C::new(0.37, 0.61);
        let factor = [C::ONE, value];
        let displaced = DualQuaternion::ONE + held_axis * value;
        let Before::Free([base, _]) = generic.homotopy.before else { return None };
        let to_own = Homotopy {
            before: Before::Free([base, displaced.parts()]),
            axes: std::array::from_fn(|i| generic.homotopy.axes[i].towards(&own[i])),
            charts: generic.homotopy.charts,
        };
        let homotopy = Homotopy {
            before: Before::Joint { axis: held_axis, factors: [factor; 2] },
            axes: own.map(|axis| axis.held(1)),
            charts: generic.homotopy.charts,
        };
        let mut solutions = Vec::new();
        for start in &generic.solutions {
            let Some(found) = to_own.follow(start) else { continue };
            let turns = |i: usize| {
                let [a, b] = homotopy.factor(i, found[i]);
                (b / a).norm() > SAME
            };
            if !(others.len()..6).any(turns) {
                add(&mut solutions, found);
            }
        }
        let others = others.into_iter().map(|(i, _)| i).collect();
        Some(Self { of, others, held, homotopy, solutions })
    }

    /// The real positions with the joint that is held displaced so.
    pub fn at(&self, displacement: f64) -> Vec<Posture> {
        let kind = self.of.freedoms[self.held].kind;
        let Before::Joint { axis, factors: [from, _] } = self.homotopy.before else {
            return Vec::new();
        };
        let to = [C::ONE, C::from(ratio(kind, displacement))];
        let moving = Homotopy {
            before: Before::Joint { axis, factors: [from, to] },
            ..self.homotopy.clone()
        };
        let row = unit(self.of, self.held);
        let found = self.solutions.iter().filter_map(|start| {
            let found = moving.follow(start)?;
            let mut x = DVector::zeros(self.of.count());
            x[self.held] = displacement;
            for (place, &i) in self.others.iter().enumerate() {
                let [a, b] = self.homotopy.factor(place, found[place]);
                let ratio = b / a;
                x[i] = match self.of.freedoms[i].kind {
                    FreedomKind::Turn => {
                        // With a and b of one complex direction, both can be made real.
                        let size = (a.norm_sqr() + b.norm_sqr()).sqrt();
                        if (a * b.conj()).im.abs() > SAME * size * size {
                            return None;
                        }
                        let real = a.norm() >= b.norm();
                        let direction = if real { a } else { b };
                        let turned = |c: C| (c * direction.conj()).re;
                        2.0 * turned(b).atan2(turned(a))
                    }
                    FreedomKind::Slide | FreedomKind::Helix => {
                        if ratio.im.abs() > SAME * (1.0 + ratio.norm()) {
                            return None;
                        }
                        2.0 * ratio.re
                    }
                };
            }
            self.of.close(&self.of.posture(x), &row)
        });
        found.collect()
    }

    /// The number of complex assemblies.
    pub fn count(&self) -> usize {
        self.solutions.len() / self.of.multiplicity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many solutions as are published, and no more when the search goes on.
    #[test]
    fn generic_loops_have_as_many_solutions_as_are_published() {
        for (slides, count) in [(0, 16), (1, 16), (2, 8), (3, 2)] {
            let mut kinds = [false; 6];
            (0..slides).for_each(|i| kinds[2 * i] = true);
            assert_eq!(
                Generic::search(kinds, usize::MAX).solutions.len(),
                count,
                "{slides} slides"
            );
        }
    }
}
