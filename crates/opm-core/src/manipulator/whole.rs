//! A leg that is solved whole: which of its freedoms are where in a [`LegSolution`].
//!
//! A solution has room for three joints of a lower section, three of an upper one, and what is between them. A whole leg
//! has six freedoms at most, or seven if one of them is idle (a strut that spins between two balls). Its balls come first: each
//! takes a section of its own. The other freedoms fill the rest, from the base on, the place between the sections at last.

use super::leg::{CompileContext, CompiledLeg, LegBranches, LegSolution};
use super::section::{ChainCoordinate, CompiledSection};
use super::{Choices, Manipulator, Mode};
use crate::chain::limits::Limits;
use crate::chain::whole::{LegReach, MOST_FREEDOMS, WholeLeg};
use crate::chain::{Chain, Part, ReachDeficit};
use crate::decomposition::Freedom;
use crate::group::JointDisplacement;
use crate::group::screw::Screw;
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::{Leg, Section};
use nalgebra::{Isometry3, Point3, Vector3};

/// The number of the place between the sections.
const BETWEEN: usize = 6;

/// A leg that is solved whole.
#[derive(Clone, Debug)]
pub(crate) struct Whole {
    pub leg: WholeLeg,
    /// What decides on many poses, and on boxes of them; `None` where that takes all joints.
    pub reach: Option<LegReach>,
    /// For each freedom, from base to platform, its place: 0 to 2 in the lower section, 3 to 5 in the upper one, or
    /// between them.
    places: Vec<usize>,
    /// The freedoms that are limited, and the numbers of their joint coordinates.
    limited: Vec<(usize, usize)>,
    /// The joint between the sections.
    pub between: Option<ChainCoordinate>,
    /// Its joints, from base to platform: those of one freedom each, and balls.
    pub joints: Vec<WholeJoint>,
}

/// A joint of a whole leg at home, in base coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WholeJoint {
    /// One freedom.
    Screw(Screw),
    /// The second hinge of a parallelogram, which turns back what the one before it turns.
    Back(Screw),
    /// A spherical joint: its centre, and its rotation vector at home.
    Ball(Point3<f64>, Vector3<f64>),
}

impl Whole {
    /// Solves the leg for a displacement of the platform.
    pub fn solve(
        &self,
        target: &Isometry3<f64>,
        branches: LegBranches,
        out: &mut LegSolution,
    ) -> Result<(), (Section, ReachDeficit)> {
        let mut found = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
        let branches = [branches.lower, branches.upper];
        // A whole leg has no sections; it is named by its first one.
        self.leg
            .solve(target, branches, &mut found)
            .map_err(|deficit| (Section::Lower, deficit))?;
        for (&place, displacement) in self.places.iter().zip(found) {
            *out.place_mut(place) = displacement;
        }
        Ok(())
    }

    /// The displacement of a freedom, counted from the base.
    pub fn displacement(&self, solution: &LegSolution, freedom: usize) -> JointDisplacement {
        match self.places[freedom] {
            place @ 0..3 => solution.lower[place],
            place @ 3..BETWEEN => solution.upper[place - 3],
            _ => solution.tau,
        }
    }

    /// The freedoms whose joint coordinates are limited, with their limits.
    #[inline(always)]
    pub fn limited<'a>(
        &'a self,
        manipulator: &'a Manipulator,
    ) -> impl Iterator<Item = (usize, &'a Limits)> {
        let limits = self.limited.iter();
        limits.map(|&(freedom, number)| (freedom, &manipulator.limits[number]))
    }

    /// Whether the joint between the sections is within its limits.
    #[inline]
    pub fn admits(&self, solution: &LegSolution) -> bool {
        self.between.is_none_or(|joint| joint.limits.admits(solution.tau))
    }
}

impl Manipulator {
    /// Whether all legs, which are solved whole, reach a pose within their limits, in one working mode, or (`None`) in any. Legs
    /// share no choices.
    pub(crate) fn whole_reaches(&self, pose: &[f64], mode: Option<Mode>) -> bool {
        let mut all = self.home.clone();
        self.completions(mode).any(|choices| {
            let completed = match &self.dependent {
                None => pose,
                Some(dependent) => {
                    let found = dependent.complete_from_home(self, choices.chosen, pose, &mut all);
                    if found.is_err() {
                        return false;
                    }
                    &all
                }
            };
            self.legs_reach(completed, choices)
        })
    }

    /// The displacement of a freedom of a leg that is solved whole, for a displacement of the platform in a mode, metres or radians;
    /// `None` where the leg is out of reach.
    pub(in crate::manipulator) fn slid(
        &self,
        leg: usize,
        freedom: usize,
        target: &Isometry3<f64>,
        mode: Mode,
    ) -> Option<f64> {
        let whole = self.legs[leg].whole.as_ref()?;
        let mut found = LegSolution::HOME;
        whole.solve(target, self.modes.branches(mode, leg), &mut found).ok()?;
        match whole.displacement(&found, freedom) {
            JointDisplacement::Value(value) => Some(value),
            JointDisplacement::Direction(_) => None,
        }
    }

    /// The same for all coordinates of a pose.
    fn legs_reach(&self, pose: &[f64], choices: Choices) -> bool {
        let (v, b) = self.task.sections(pose);
        let rise = self.task.rise(pose);
        let target = self.task.raised(rise, self.task.isometry(&v, &b));
        let mut found = LegSolution::HOME;
        self.legs.iter().enumerate().all(|(number, leg)| {
            let Some(whole) = &leg.whole else { return false };
            let mut reaches = |mode: Mode| {
                let branches = self.modes.branches(mode, number);
                whole.solve(&target, branches, &mut found).is_ok() && self.admits(leg, &found, rise)
            };
            self.modes.chosen_leg_modes(choices, number).any(|(_, mode)| reaches(mode))
        })
    }
}

impl LegSolution {
    fn place_mut(&mut self, place: usize) -> &mut JointDisplacement {
        match place {
            0..3 => &mut self.lower[place],
            3..BETWEEN => &mut self.upper[place - 3],
            _ => &mut self.tau,
        }
    }
}

impl CompiledLeg {
    /// Compiles a leg that is solved whole, whose first joint coordinate has the number `first` in the mechanism.
    pub(super) fn whole(
        leg: &Leg,
        whole: WholeLeg,
        first: usize,
        context: CompileContext<'_>,
    ) -> Self {
        let freedoms = Freedom::of_leg(leg);
        let of_ball = |freedom: &Freedom| leg.joints[freedom.joint].kind == JointKind::Spherical;
        let places = places(&freedoms.iter().map(of_ball).collect::<Vec<_>>());
        let mut coordinates: [Option<ChainCoordinate>; BETWEEN + 1] = [None; BETWEEN + 1];
        for (number, &place) in places.iter().enumerate() {
            coordinates[place] = Some(context.coordinates[first + number]);
        }
        let balls: Vec<bool> = (0..=BETWEEN)
            .map(|place| {
                let freedom = places.iter().position(|&of_freedom| of_freedom == place);
                freedom.is_some_and(|number| of_ball(&freedoms[number]))
            })
            .collect();
        let section = |start: usize, choice: bool| {
            let own: [Option<ChainCoordinate>; 3] = std::array::from_fn(|i| coordinates[start + i]);
            let joints = || own.iter().flatten();
            let part = Part { freedoms: joints().count(), ball: balls[start], choice };
            CompiledSection {
                chain: Chain::Part(part),
                screws: [Vector3::zeros(); 3],
                scale: 1.0,
                coordinates: own,
                limited: joints().any(|joint| joint.limits.any()),
                driven: joints().any(|joint| joint.actuated.is_some()),
                partial: None,
                offset: None,
                slider: None,
            }
        };
        let choices = whole.choices();
        let limited = places.iter().enumerate().filter_map(|(freedom, &place)| {
            coordinates[place].filter(|c| c.limits.any()).map(|c| (freedom, c.number))
        });
        let limited: Vec<(usize, usize)> = limited.collect();
        let reach = whole.reach(|freedom| limited.iter().any(|&(of_limit, _)| of_limit == freedom));
        let between = coordinates[BETWEEN];
        Self {
            lower: section(0, choices > 0),
            upper: section(3, choices > 1),
            split_section: Section::Lower,
            bridged: false,
            imaginary: None,
            shapes: [None; 2],
            bounds: [None; 2],
            shells: [None; 2],
            upper_constrains: true,
            unwinds: false,
            lift: None,
            lean: None,
            whole: Some(Box::new({
                let joints = joints(leg);
                Whole { leg: whole, reach, places, limited, between, joints }
            })),
            cones: Vec::new(),
        }
    }
}

/// The joints of a leg, those of several freedoms but balls one after the other.
fn joints(leg: &Leg) -> Vec<WholeJoint> {
    let each = leg.joints.iter().flat_map(|joint| match joint.kind {
        JointKind::Spherical => {
            let home = Vector3::from_fn(|i, _| joint.coordinates[i].home);
            vec![WholeJoint::Ball(joint.point, home)]
        }
        JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Helical { .. }
        | JointKind::Cylindrical
        | JointKind::Universal { .. } => {
            let kind = if joint.turns_back { WholeJoint::Back } else { WholeJoint::Screw };
            joint.screws().into_iter().map(kind).collect()
        }
    });
    each.collect()
}

/// The place of each freedom of a leg, where `balls` says which are those of spherical joints, three each.
fn places(balls: &[bool]) -> Vec<usize> {
    let mut free: Vec<usize> = (0..=BETWEEN).rev().collect();
    let mut places = vec![BETWEEN; balls.len()];
    let count = balls.iter().filter(|ball| **ball).count() / 3;
    // A ball alone is in the section at its end of the leg.
    let alone = balls.iter().take(3).all(|ball| *ball);
    let mut start = if count == 1 && !alone { 3 } else { 0 };
    let mut taken = 0;
    for (place, _) in places.iter_mut().zip(balls).filter(|(_, ball)| **ball) {
        *place = start + taken;
        free.retain(|free| free != place);
        taken += 1;
        if taken == 3 {
            (start, taken) = (3, 0);
        }
    }
    for (place, _) in places.iter_mut().zip(balls).filter(|(_, ball)| !**ball) {
        *place = free.pop().unwrap_or(BETWEEN);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::places;

    #[test]
    fn every_freedom_has_a_place_of_its_own() {
        let (s, r) = ([true; 3].as_slice(), [false].as_slice());
        assert_eq!(places(&[s, r, s].concat()), [0, 1, 2, 6, 3, 4, 5]);
        assert_eq!(places(&[r, s, s].concat()), [6, 0, 1, 2, 3, 4, 5]);
        assert_eq!(places(&[r, r, r, s].concat()), [0, 1, 2, 3, 4, 5]);
        assert_eq!(places(&[s, r].concat()), [0, 1, 2, 3]);
        assert_eq!(places(&[r, s, r].concat()), [0, 3, 4, 5, 1]);
        assert_eq!(places(&[false; 5]), [0, 1, 2, 3, 4]);
    }
}
