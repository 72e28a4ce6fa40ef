//! The curves that a loop with one freedom moves along, traced from a position by steps along its tangent.

use super::closed_loop::{ClosedLoop, Motions, Posture};
use nalgebra::DVector;

/// The longest step, in radians and sizes.
pub const LONGEST: f64 = 0.05;
/// The shortest step: where even this fails, the curve ends.
const SHORTEST: f64 = 1e-9;
/// The least cosine between the tangents at both ends of a step.
const STRAIGHT: f64 = 0.995;
/// A slider that is so many sizes from home goes to infinity.
pub const FAR: f64 = 1000.0;
pub const MOST_KNOTS: usize = 100_000;
const MOST_CORRECTIONS: usize = 8;
/// How near positions are the same, in radians and sizes.
pub const SAME: f64 = 1e-6;

/// A position on a curve, and the unit tangent there.
#[derive(Clone, Debug)]
pub struct Knot {
    pub at: Posture,
    pub tangent: DVector<f64>,
}

/// A curve. Angles are not reduced along it: a closed one ends at its start, turned by full revolutions.
#[derive(Clone, Debug)]
pub struct Curve {
    pub knots: Vec<Knot>,
    pub closed: bool,
}

/// Why a curve was not traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stuck {
    /// The loop is rigid.
    #[error("it does not move: no rates of its joints keep the loop closed")]
    Rigid,
    /// The loop has several motions.
    #[error("it has {0} freedoms at home, expected one")]
    Several(usize),
    /// The loop moves at first order only.
    #[error(
        "its joints have rates at home that keep the loop closed, but it closes nowhere near home: it is rigid"
    )]
    FirstOrder,
    /// A parallelogram would open.
    #[error(
        "the two hinges of its parallelogram could turn by different angles; a loop is traced where its other joints hold them \
         together"
    )]
    Parallelogram,
    /// The curve has more knots than are kept.
    #[error("its motion does not come back within {MOST_KNOTS} steps")]
    Long,
}

impl Knot {
    /// A position with its tangent, in the direction of `along` if that is given.
    pub fn new(of: &ClosedLoop, at: Posture, along: Option<&DVector<f64>>) -> Result<Self, Stuck> {
        let tangent = match (of.motions(&at), along) {
            (Motions::None, _) => return Err(Stuck::Rigid),
            (Motions::One(tangent), Some(along)) if tangent.dot(along) < 0.0 => -tangent,
            (Motions::One(tangent), _) => tangent,
            // Where curves cross, straight on.
            (Motions::Several(kernel), Some(along)) => {
                (&kernel * (kernel.transpose() * along)).normalize()
            }
            (Motions::Several(kernel), None) => return Err(Stuck::Several(kernel.ncols())),
        };
        Ok(Self { at, tangent })
    }

    /// The knot at `step` along the tangent.
    pub fn step(&self, of: &ClosedLoop, step: f64) -> Option<Self> {
        let ahead = of.moved(&self.at, &(&self.tangent * step));
        let at = of.close(&ahead, &self.tangent)?;
        if of.step(&ahead, &at).norm() > 0.2 * step.abs() + SAME {
            return None;
        }
        let knot = Self::new(of, at, Some(&self.tangent)).ok()?;
        (knot.tangent.dot(&self.tangent) >= STRAIGHT).then_some(knot)
    }
}

impl Knot {
    /// The knot near this one that is nearest to a position, and how far it is from there.
    pub fn towards(&self, of: &ClosedLoop, to: &Posture) -> Option<(Self, f64)> {
        let mut along = of.along(&self.at, &self.tangent, to);
        let mut met = self.clone();
        for _ in 0..MOST_CORRECTIONS {
            met = self.step(of, along)?;
            let more = of.along(&met.at, &met.tangent, to);
            along += more;
            if more.abs() <= 1e-10 {
                break;
            }
        }
        let off = of.nearest_step(&met.at, to).norm();
        Some((met, off))
    }
}

impl Curve {
    /// The curve through a closed position.
    pub fn through(of: &ClosedLoop, start: Knot) -> Result<Self, Stuck> {
        let (forward, closed) = walk(of, &start)?;
        if closed {
            return Ok(Self { knots: forward, closed });
        }
        let back = Knot { at: start.at, tangent: -start.tangent };
        let (backward, _) = walk(of, &back)?;
        let turned = |knot: Knot| Knot { at: knot.at, tangent: -knot.tangent };
        let knots = backward.into_iter().skip(1).rev().map(turned).chain(forward).collect();
        Ok(Self { knots, closed })
    }
}

/// The knots from one to the same position again, or to where a slider is far away.
fn walk(of: &ClosedLoop, start: &Knot) -> Result<(Vec<Knot>, bool), Stuck> {
    let mut knots = vec![start.clone()];
    let mut length = 0.2 * LONGEST;
    loop {
        let last = &knots[knots.len() - 1];
        if knots.len() > 3
            && let Some(end) = arrived(of, last, start, length)
        {
            knots.push(end);
            return Ok((knots, true));
        }
        let next = loop {
            match last.step(of, length) {
                Some(next) => break next,
                None if length > SHORTEST => length *= 0.5,
                // Second order alone would be taken for rounding so far.
                None if of.step(&start.at, &last.at).norm() < 1e-3 => {
                    return Err(Stuck::FirstOrder);
                }
                None => return Ok((knots, false)),
            }
        };
        let away = of.farthest(&next.at);
        knots.push(next);
        if away > FAR {
            return Ok((knots, false));
        }
        if knots.len() > MOST_KNOTS {
            return Err(Stuck::Long);
        }
        // Of a slider that is far away, a step is a share of its way.
        length = (1.5 * length).min(LONGEST * away.max(1.0));
    }
}

/// The start, if the next step passes it: with the revolutions that were made.
fn arrived(of: &ClosedLoop, last: &Knot, start: &Knot, length: f64) -> Option<Knot> {
    let ahead = of.nearest_step(&last.at, &start.at);
    let along = of.along(&last.at, &last.tangent, &start.at);
    if along < 0.0 || along > 1.5 * length || ahead.norm() > 2.0 * length {
        return None;
    }
    let (met, off) = last.towards(of, &start.at)?;
    let same_way =
        of.without_rods(met.tangent.clone()).dot(&of.without_rods(start.tangent.clone()));
    (off <= SAME && same_way > 0.0).then(|| {
        let mut end = Knot { at: start.at.clone(), tangent: met.tangent };
        of.turn_on(&mut end.at, &last.at);
        of.keep_rods(&mut end.at, &met.at);
        end
    })
}
