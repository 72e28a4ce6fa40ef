//! The least change of the actuated joints with which a mechanism can be assembled.
//!
//! Where given actuated joints have no assembly, the nearest ones that have one are at a pose of the platform: they are what
//! inverse kinematics give there. So the sum of the squared changes is a function of the pose, for each working mode, and
//! Newton's method finds its minima (`least/descent.rs`). At such a minimum the platform is at a parallel singularity, unless
//! there are more actuated joints than freedoms.
//!
//! The starts are poses spread over the workspace, and assemblies on the way to the given joints from joints that have
//! some. What is found is tried: the joints must close there, and none may that are nearer in many directions. Otherwise
//! nothing is said.

mod descent;

use super::{ForwardBuffer, ForwardError};
use crate::manipulator::{Manipulator, Mode};
use crate::numeric::Quantity;
use descent::Descent;
use std::f64::consts::{PI, TAU};

/// Poses that are spread over the workspace.
const SPREAD: u32 = 60;
/// The most working modes of one of them.
const MODES: usize = 16;
/// So many of the best of these are starts, and so many are joined with the given joints by a straight way.
const BEST: usize = 16;
const WAYS: usize = 8;
/// How often nearer joints that close may be found before nothing is said.
const ROUNDS: usize = 6;
/// Shares of the least change at which no joints may close.
const NEARER: [f64; 3] = [0.999, 0.9, 0.5];
/// The joints are tried this share of their changes beyond these, because at a singularity rounding decides.
const MARGIN: f64 = 1e-6;
/// Changes below this are rounding, in radians and shares of the size.
const NONE: f64 = 1e-13;
/// What the other joints weigh where one is to change alone. Much more would lose digits.
const HELD: f64 = 1e3;
/// Steps of one joint: an angle makes half a revolution in so many, a length moves by the size in so many.
const STEPS: u32 = 180;
const STEPS_OF_SIZE: f64 = 64.0;
/// The farthest that one joint alone is moved, shares of the size.
const FARTHEST: f64 = 64.0;

/// The least changes of actuated joints with which the mechanism can be assembled: see [`Manipulator::least_change`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LeastChange {
    /// The change of every actuated joint, in the order of [`Manipulator::actuated`], radians and metres. The sum of their
    /// squares is least, with a length over the mechanism's size
    /// ([`characteristic_length`](Manipulator::characteristic_length)).
    pub together: Vec<f64>,
    /// The least change of each joint, with all others as they are given; `None` where none was found with which the
    /// mechanism can be assembled.
    pub alone: Vec<Option<f64>>,
}

impl Manipulator {
    /// The least change of the actuated joints with which the mechanism can be assembled, where it cannot with the given
    /// values (radians and metres, in the order of [`Manipulator::actuated`]). `None` where it can, where a section is
    /// loose, and where no answer was found that holds.
    ///
    /// This takes as long as thousands of calls of [`Manipulator::forward`].
    ///
    /// # Errors
    /// As [`Manipulator::forward`], and where there is no closed form.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// // Two telescopes are short, and the third is too long for them.
    /// let manipulator = Manipulator::example("planar-3rpr")?;
    /// let mut actuated = [0.01, 0.01, 0.5];
    /// assert!(manipulator.forward(&actuated)?.list.is_empty());
    /// let change = manipulator.least_change(&actuated)?.expect("it cannot be assembled");
    /// let alone = change.alone[2].expect("a shorter one closes");
    /// assert!(alone < change.together[2] && change.together[2] < 0.0);
    /// // A little beyond, so that rounding does not decide.
    /// for (value, change) in actuated.iter_mut().zip(&change.together) {
    ///     *value += 1.000_001 * change;
    /// }
    /// assert!(!manipulator.forward(&actuated)?.list.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn least_change(&self, actuated: &[f64]) -> Result<Option<LeastChange>, ForwardError> {
        self.plan.as_ref().map_err(|why| *why)?;
        let mut buffer = self.forward_buffer();
        let found = self.forward_into(actuated, &mut buffer)?;
        if !found.list.is_empty() || !found.loose.is_empty() {
            return Ok(None);
        }
        let descent = Descent::new(self, actuated);
        let mut search = Search { manipulator: self, given: actuated, buffer, descent };
        Ok(search.together().map(|(together, starts)| {
            let alone = match together[..] {
                [single] => vec![Some(single)],
                _ => (0..actuated.len()).map(|joint| search.alone(joint, &starts)).collect(),
            };
            LeastChange { together, alone }
        }))
    }

    /// Whether more joints are actuated than the platform has freedoms.
    pub(super) fn is_redundant(&self) -> bool {
        self.actuated().len() > self.task_coordinates().len()
    }
}

/// A pose in a working mode.
type Start = (Vec<f64>, Mode);

struct Search<'a> {
    manipulator: &'a Manipulator,
    given: &'a [f64],
    buffer: ForwardBuffer,
    descent: Descent<'a>,
}

impl Search<'_> {
    /// The assemblies with these changes of the joints; `None` if there are none. Where a section is loose, they are not
    /// listed.
    fn closed(&mut self, changes: &[f64]) -> Option<Vec<Start>> {
        let actuated: Vec<f64> = self.given.iter().zip(changes).map(|(q, c)| q + c).collect();
        let found = self.manipulator.forward_into(&actuated, &mut self.buffer).ok()?;
        let closes = !found.list.is_empty() || !found.loose.is_empty();
        closes.then(|| found.list.iter().map(|a| (a.pose.clone(), a.mode)).collect())
    }

    /// The least change of all joints, and poses near which it and others are.
    fn together(&mut self) -> Option<(Vec<f64>, Vec<Start>)> {
        self.descent.weigh(|_| 1.0);
        let mut starts = self.spread();
        if !self.manipulator.is_redundant() {
            let mut ways = Vec::new();
            for (pose, mode) in starts.iter().take(WAYS) {
                let Some(changes) = self.descent.changes(pose, *mode) else { continue };
                ways.push(changes);
            }
            for far in ways {
                starts.extend(self.on_the_way(&far));
            }
        }
        let mut best: Option<(f64, Vec<f64>, Mode)> = None;
        let mut ends = Vec::new();
        for round in 0..=ROUNDS {
            let before = best.as_ref().map_or(f64::INFINITY, |(sum, ..)| *sum);
            for (pose, mode) in std::mem::take(&mut starts) {
                let Some((sum, pose)) = self.descent.minimise(pose, mode) else { continue };
                ends.push((sum, pose.clone(), mode));
                if best.as_ref().is_none_or(|(least, ..)| sum < *least) {
                    best = Some((sum, pose, mode));
                }
            }
            let (sum, pose, mode) = best.as_ref()?;
            if *sum <= NONE * NONE || *sum >= before {
                return None;
            }
            let changes = self.descent.changes(pose, *mode)?;
            starts = match self.manipulator.is_redundant() {
                true => Vec::new(),
                false => self.nearer(&changes, sum.sqrt()),
            };
            if starts.is_empty() {
                let share = if self.manipulator.is_redundant() { 1.0 } else { 1.0 + MARGIN };
                let beyond: Vec<f64> = changes.iter().map(|change| share * change).collect();
                self.closed(&beyond)?;
                let changes = match self.manipulator.is_redundant() {
                    true => changes,
                    // To the last digit.
                    false => {
                        let share = self.edge(&changes, [0.0, share]);
                        changes.iter().map(|change| share * change).collect()
                    }
                };
                ends.sort_by(|a, b| a.0.total_cmp(&b.0));
                let ends = ends.into_iter().take(BEST).map(|(_, pose, mode)| (pose, mode));
                return Some((changes, ends.collect()));
            }
            if round == ROUNDS {
                return None;
            }
        }
        None
    }

    /// Poses of an additive recurrence, which covers the workspace evenly, in their working modes: those with the least
    /// changes.
    fn spread(&mut self) -> Vec<Start> {
        let m = self.manipulator;
        let mut all = m.all_modes();
        let mut found: Vec<(f64, Start)> = Vec::new();
        for number in 0..SPREAD {
            // Irrational steps: the roots of successive primes.
            let share = |i: usize| {
                let step = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0][i % 6].sqrt();
                let part = (f64::from(number) * step).fract();
                2.0 * (part - part.round())
            };
            let pose = m.task_coordinates().iter().enumerate().map(|(i, c)| match c.quantity {
                Quantity::Angle => c.home + PI * share(i),
                Quantity::Length => c.home + m.characteristic_length() * share(i),
            });
            let pose: Vec<f64> = pose.collect();
            if !matches!(m.inverse_all(&pose, &mut all), Ok(Some(_))) {
                continue;
            }
            for mode in all.modes(m).take(MODES) {
                if let Some(sum) = self.descent.sum(&pose, mode) {
                    found.push((sum, (pose.clone(), mode)));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().take(BEST).map(|(_, start)| start).collect()
    }

    /// The assemblies with the joints nearest to the given ones on the straight way from changes with which they close.
    fn on_the_way(&mut self, far: &[f64]) -> Vec<Start> {
        let (mut near, mut share) = (0.0, 1.0);
        let at = |share: f64| far.iter().map(|change| share * change).collect::<Vec<f64>>();
        let Some(mut found) = self.closed(&at(share)) else { return Vec::new() };
        while share - near > MARGIN {
            let middle = 0.5 * (near + share);
            match self.closed(&at(middle)) {
                Some(closed) => (share, found) = (middle, closed),
                None => near = middle,
            }
        }
        found
    }

    /// Assemblies with smaller changes than the least, in many directions.
    fn nearer(&mut self, changes: &[f64], least: f64) -> Vec<Start> {
        let count = changes.len();
        let units: Vec<f64> = (0..count).map(|joint| self.descent.unit(joint)).collect();
        let mut directions: Vec<Vec<f64>> =
            vec![changes.iter().zip(&units).map(|(change, unit)| change / unit).collect()];
        let signs = (0..3_usize.pow(count.min(4) as u32)).map(|number| {
            let mut rest = number;
            let digit = |joint: usize| {
                let digit = if joint < 4 { rest % 3 } else { number % 3 };
                rest /= 3;
                digit as f64 - 1.0
            };
            (0..count).map(digit).collect()
        });
        directions.extend(signs);
        for direction in directions {
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                continue;
            }
            for share in NEARER {
                let by = share * least / length;
                let tried: Vec<f64> =
                    direction.iter().zip(&units).map(|(x, unit)| by * x * unit).collect();
                if let Some(found) = self.closed(&tried)
                    && !found.is_empty()
                {
                    return found;
                }
            }
        }
        Vec::new()
    }

    /// The least change of one joint with which the mechanism can be assembled, all others as they are given.
    fn alone(&mut self, joint: usize, starts: &[Start]) -> Option<f64> {
        let stepped = if self.manipulator.is_redundant() { None } else { self.stepped(joint) };
        let mut best = stepped;
        self.descent.weigh(|other| if other == joint { 1.0 } else { HELD });
        let near: Vec<Start> = starts
            .iter()
            .filter_map(|(pose, mode)| Some((self.descent.minimise(pose.clone(), *mode)?.1, *mode)))
            .collect();
        // What the others still differ is taken away.
        self.descent.weigh(|other| if other == joint { 0.0 } else { 1.0 });
        for (pose, mode) in near {
            let Some((_, pose)) = self.descent.minimise(pose, mode) else { continue };
            let Some(changes) = self.descent.changes(&pose, mode) else { continue };
            let change = changes[joint];
            if best.is_some_and(|best| best.abs() <= change.abs() * (1.0 + MARGIN)) {
                continue;
            }
            match self.manipulator.is_redundant() {
                true if self.closes_alone(joint, change) => best = Some(change),
                false => {
                    let beyond = change * (1.0 + MARGIN);
                    if self.closes_alone(joint, beyond) {
                        best = Some(self.edge(&self.one(joint), [0.0, beyond]));
                    }
                }
                true => {}
            }
        }
        best
    }

    fn closes_alone(&mut self, joint: usize, change: f64) -> bool {
        let mut changes = vec![0.0; self.given.len()];
        changes[joint] = change;
        self.closed(&changes).is_some()
    }

    /// The least change of one joint that steps in both directions find.
    fn stepped(&mut self, joint: usize) -> Option<f64> {
        let m = self.manipulator;
        let size = m.characteristic_length();
        let quantity = m.coordinates()[m.actuated()[joint]].quantity;
        let next = |change: f64| match quantity {
            Quantity::Angle => change + PI / f64::from(STEPS),
            // Far away, steps grow with the distance.
            Quantity::Length => change + (size / STEPS_OF_SIZE).max(0.05 * change),
        };
        let most = match quantity {
            Quantity::Angle if self.descent.counts_modulo(joint) => PI,
            Quantity::Angle => 2.0 * TAU,
            Quantity::Length => FARTHEST * size,
        };
        let mut before = 0.0;
        while before < most {
            let change = next(before).min(most);
            let mut found: Option<f64> = None;
            for sign in [1.0, -1.0] {
                if self.closes_alone(joint, sign * change) {
                    let edge = self.edge(&self.one(joint), [sign * before, sign * change]);
                    found =
                        Some(found.map_or(edge, |f| if edge.abs() < f.abs() { edge } else { f }));
                }
            }
            if found.is_some() {
                return found;
            }
            before = change;
        }
        None
    }

    /// Between a share of some changes that does not close and one that does, the least that does.
    fn edge(&mut self, changes: &[f64], [mut open, mut closed]: [f64; 2]) -> f64 {
        loop {
            let middle = 0.5 * (open + closed);
            if middle == open || middle == closed {
                return closed;
            }
            let tried: Vec<f64> = changes.iter().map(|change| middle * change).collect();
            match self.closed(&tried).is_some() {
                true => closed = middle,
                false => open = middle,
            }
        }
    }

    /// A unit change of one joint alone.
    fn one(&self, joint: usize) -> Vec<f64> {
        (0..self.given.len()).map(|other| if other == joint { 1.0 } else { 0.0 }).collect()
    }
}
