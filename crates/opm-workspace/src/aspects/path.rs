//! Paths between two poses without a singularity.

use super::Aspects;
use super::levels::Levels;
use super::search::Search;
use super::step::{is_clear, violation};
use crate::progress::{Cancelled, Progress};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::FileUnits;
use opm_core::motion::{Ends, Spline};
use std::f64::consts::TAU;

/// Samples of a path between two of its poses, when it is watched.
const SAMPLES: f64 = 4.0;

/// Samples of a whole path at least, when it is watched: on a coarse grid its poses are far apart.
const LEAST_SAMPLES: f64 = 500.0;

/// How often the poses of a path are doubled until the spline through them is clear.
const DOUBLINGS: u32 = 6;

/// A shortcut leaves at least this share of the clearance of what it cuts off.
const CLEARANCE: f64 = 0.5;

/// A path of the platform that passes no singularity. The cubic splines through its poses, at rest at both ends, are in
/// reach, within all limits of joints and without a singularity: they were watched as a motion with four samples
/// between two poses or more, and 500 in all or more ([`opm_core::trajectory`]).
#[derive(Clone, Debug, PartialEq)]
pub struct AspectPath {
    /// The times of the poses, seconds, from 0 on.
    pub times: Vec<f64>,
    /// The poses: a value for each task coordinate, radians and metres. Angles are continuous, so that the last pose may
    /// differ from the one that was asked for by full turns.
    pub poses: Vec<Vec<f64>>,
    /// The smallest measure of singularity at the poses, parallel or serial, without dimension.
    pub clearance: f64,
}

/// Why there is no path between two poses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoPath {
    /// A pose cannot be used.
    #[error("{end} is {problem}")]
    End {
        /// `the start` or `the goal`.
        end: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// Joints are beyond their limits at a pose.
    #[error("{end} is beyond the limits of joints: {}", in_si(.joints))]
    Limits {
        /// `the start` or `the goal`.
        end: &'static str,
        /// Those joints.
        joints: Vec<BeyondLimits>,
    },
    /// No pose of the grid around a pose can be reached from it without a singularity.
    #[error(
        "{end} cannot go straight to any pose of the grid around it without a singularity; a finer grid, or one \
         that reaches around it, may help"
    )]
    Lost {
        /// `the start` or `the goal`.
        end: &'static str,
    },
    /// The poses are in different aspects, as far as the grid tells.
    #[error(
        "the poses are in different aspects, {from} and {to}: on this grid every path between them is singular"
    )]
    Apart {
        /// The number of the aspect of the start, from 1 on.
        from: u32,
        /// The number of the aspect of the goal.
        to: u32,
    },
    /// Steps that were taken to be clear are not.
    #[error("no path on this grid is clear between its poses; a finer grid may help")]
    Narrow,
    /// The path is one of straight lines, and no spline near it is clear.
    #[error(
        "the poses are in one aspect, but the way is too narrow for a smooth path; a finer grid may help"
    )]
    Rough,
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A joint coordinate that is beyond its limits.
#[derive(Clone, Debug, PartialEq)]
pub struct BeyondLimits {
    /// Its name.
    pub name: String,
    /// What its value measures.
    pub quantity: Quantity,
    /// Its value, radians or metres.
    pub value: f64,
    /// Its limits.
    pub limits: [f64; 2],
}

fn in_si(joints: &[BeyondLimits]) -> String {
    let joint = |BeyondLimits { name, quantity, value, limits: [low, high] }: &BeyondLimits| {
        let [value, low, high] =
            [value, low, high].map(|value| FileUnits::SI.show(*value, *quantity));
        format!("{name} is {value}, expected {low} to {high}")
    };
    joints.iter().map(joint).collect::<Vec<_>>().join("; ")
}

/// A path from one pose to another in one working mode, which takes `duration` seconds: straight if that is
/// possible, else by the grid of `aspects`, far from singularities and shortened where that stays so. The aspects have to be
/// those of this manipulator in this mode.
///
/// # Errors
/// [`NoPath`]: there is none, or none was found.
pub fn find_path(
    manipulator: &Manipulator,
    mode: Mode,
    aspects: &Aspects,
    ends: [&[f64]; 2],
    duration: f64,
    progress: &Progress,
) -> Result<AspectPath, NoPath> {
    let search = Search { manipulator, mode, aspects, progress };
    let finder =
        Finder { levels: Levels::new(manipulator, mode), values: vec![], search, duration };
    finder.find(ends)
}

/// The number of the aspect that any pose is in, on the grid or not, from 1 on: that of the nearest pose of the grid to
/// which it can go straight without a singularity. `None` if there is none around it, or if the pose is in no aspect. The
/// aspects have to be those of this manipulator in this mode.
pub fn aspect_at(
    manipulator: &Manipulator,
    mode: Mode,
    aspects: &Aspects,
    pose: &[f64],
) -> Option<u32> {
    let progress = Progress::default();
    let search = Search { manipulator, mode, aspects, progress: &progress };
    let levels = Levels::new(manipulator, mode);
    let mut finder = Finder { levels, values: vec![], search, duration: 1.0 };
    finder.check("the pose", pose).ok()?;
    finder.anchors(pose).first().map(|anchor| anchor.label)
}

struct Finder<'a> {
    search: Search<'a>,
    levels: Levels<'a>,
    values: Vec<f64>,
    duration: f64,
}

impl Finder<'_> {
    fn find(mut self, [from, to]: [&[f64]; 2]) -> Result<AspectPath, NoPath> {
        self.check("the start", from)?;
        self.check("the goal", to)?;
        let straight = vec![from.to_vec(), self.within_half_a_turn(from, to)];
        if self.is_clear(&straight[0], &straight[1])
            && let Some(path) = self.smooth(&straight)?
        {
            return Ok(path);
        }
        let [starts, goals] = [from, to].map(|pose| self.anchors(pose));
        let (Some(start), Some(goal)) = (starts.first(), goals.first()) else {
            let end = if starts.is_empty() { "the start" } else { "the goal" };
            return Err(NoPath::Lost { end });
        };
        let apart = NoPath::Apart { from: start.label, to: goal.label };
        let alike = |start: &Anchor| goals.iter().find(|goal| goal.label == start.label);
        let Some((start, goal)) = starts.iter().find_map(|start| Some((start, alike(start)?)))
        else {
            return Err(apart);
        };
        let mut way = self.search.way(start.number, goal.number)?.ok_or(NoPath::Narrow)?;
        // The way has angles of the grid. The path begins at the start and ends full turns from the goal.
        let turned = |pose: &[f64], from: &[f64], to: &[f64]| -> Vec<f64> {
            pose.iter().zip(from).zip(to).map(|((value, from), to)| value + (to - from)).collect()
        };
        let first = way[0].clone();
        way.iter_mut().for_each(|pose| *pose = turned(pose, &first, &start.pose));
        let last = turned(to, &goal.pose, &way[way.len() - 1]);
        let poses = [vec![from.to_vec()], way, vec![last]].concat();
        let poses = self.shortened(&poses)?;
        self.smooth(&poses)?.ok_or(NoPath::Rough)
    }

    /// Refuses a pose that is in no aspect.
    fn check(&mut self, end: &'static str, pose: &[f64]) -> Result<(), NoPath> {
        let manipulator = self.search.manipulator;
        let wrong = |problem: &str| Err(NoPath::End { end, problem: problem.to_owned() });
        let mut solution = manipulator.solution();
        match manipulator.inverse(pose, self.search.mode, &mut solution) {
            Err(error) => wrong(&format!("no pose of this mechanism: {error}")),
            Ok(None) => wrong("out of reach in this working mode"),
            Ok(Some(at)) if !at.within_limits() => {
                if let Some(number) = manipulator.beyond_differences(at.joints()).next() {
                    let name = &manipulator.differences()[number].name;
                    return wrong(&format!("{name} is beyond its limits"));
                }
                let beyond = manipulator.beyond_limits(at).filter_map(|number| {
                    let c = &manipulator.coordinates()[number];
                    let (name, quantity) = (c.name.clone(), c.quantity);
                    let (value, limits) = (at.joints()[number], c.limits?);
                    Some(BeyondLimits { name, quantity, value, limits })
                });
                let joints: Vec<_> = beyond.collect();
                // At the very end of a range, its value may be within it, to rounding.
                if joints.is_empty() {
                    return wrong("beyond the limits of joints");
                }
                Err(NoPath::Limits { end, joints })
            }
            Ok(Some(_)) => match self.levels.at(pose, &mut self.values) {
                true if !self.levels.singular(&self.values) => Ok(()),
                _ => wrong("singular"),
            },
        }
    }

    /// The same pose, with each angle that may make full revolutions within π of that of another pose.
    fn within_half_a_turn(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let manipulator = self.search.manipulator;
        let coordinates = manipulator.task_coordinates().iter().zip(from).zip(to);
        let nearest = coordinates.map(|((c, from), to)| {
            if c.quantity == Quantity::Angle && !manipulator.counts_turns(c.kind()) {
                to - TAU * ((to - from) / TAU).round()
            } else {
                *to
            }
        });
        nearest.collect()
    }

    /// The poses of the grid around a pose that it can go straight to, the nearest first.
    fn anchors(&self, pose: &[f64]) -> Vec<Anchor> {
        let axes = self.search.aspects.axes();
        let mut corners = vec![(0, 1, Vec::new(), 0.0)];
        for (axis, &value) in axes.iter().zip(pose) {
            let (axis, circle) = (&axis.axis, axis.circle);
            let step = (axis.max - axis.min) / (axis.count - 1).max(1) as f64;
            let turns = if circle { ((value - axis.min) / TAU).floor() } else { 0.0 };
            let place = if axis.count > 1 { (value - TAU * turns - axis.min) / step } else { 0.0 };
            let low = place.floor().clamp(0.0, (axis.count - 1) as f64);
            let mut places = vec![low as u64];
            if axis.count > 1 && place > low {
                // Behind the last value of a circle comes the first.
                let next = low as u64 + 1;
                if next < axis.count {
                    places.push(next);
                } else if circle {
                    places.push(0);
                }
            }
            let mut more = Vec::new();
            for (number, stride, at, distance) in &corners {
                for &place_on in &places {
                    let turned = if place_on == 0 && low > 0.0 { turns + 1.0 } else { turns };
                    let at_axis = axis.value(place_on) + TAU * turned;
                    let off = if step > 0.0 { (value - at_axis) / step } else { 0.0 };
                    let mut at: Vec<f64> = Vec::clone(at);
                    at.push(at_axis);
                    more.push((number + stride * place_on, *stride, at, distance + off * off));
                }
            }
            corners = more;
            corners.iter_mut().for_each(|corner| corner.1 *= axis.count);
        }
        corners.sort_by(|a, b| a.3.total_cmp(&b.3).then(a.0.cmp(&b.0)));
        let anchor = |(number, _, at, _): (u64, u64, Vec<f64>, f64)| {
            let label = self.search.aspects.label(number).filter(|label| *label > 0)?;
            self.is_clear(pose, &at).then_some(Anchor { number, label, pose: at })
        };
        corners.into_iter().filter_map(anchor).collect()
    }

    fn is_clear(&self, from: &[f64], to: &[f64]) -> bool {
        is_clear(self.search.manipulator, self.search.mode, from, to)
    }

    /// The smallest clearance at poses; zero if one is out of reach.
    fn clearance<'p>(&mut self, poses: impl Iterator<Item = &'p [f64]>) -> f64 {
        let mut least = f64::INFINITY;
        for pose in poses {
            let at = self.levels.at(pose, &mut self.values);
            least = least.min(if at { self.levels.clearance(&self.values) } else { 0.0 });
        }
        least
    }

    /// The same way with straight lines instead of detours, where these keep away from singularities.
    fn shortened(&mut self, poses: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, NoPath> {
        let mut kept = vec![poses[0].clone()];
        let mut here = 0;
        while here + 1 < poses.len() {
            let mut reach = poses.len() - 1 - here;
            while reach > 1 && !self.is_shortcut(&poses[here..=here + reach]) {
                self.search.progress.advance(0)?;
                reach = reach.div_ceil(2).min(reach - 1);
            }
            here += reach;
            kept.push(poses[here].clone());
        }
        Ok(kept)
    }

    fn is_shortcut(&mut self, poses: &[Vec<f64>]) -> bool {
        let [first, .., last] = poses else { return false };
        let least = self.clearance(poses.iter().map(|pose| &**pose));
        let line = self.divided(&[first.clone(), last.clone()], 1.0);
        self.clearance(line.iter().map(|pose| &**pose)) >= CLEARANCE * least
            && line.windows(2).all(|step| self.is_clear(&step[0], &step[1]))
    }

    /// The length of a step in steps of the grid.
    fn length(&self, from: &[f64], to: &[f64]) -> f64 {
        let axes = self.search.aspects.axes().iter();
        let coordinates =
            axes.zip(self.search.manipulator.task_coordinates()).zip(from.iter().zip(to));
        let parts = coordinates.map(|((axis, c), (from, to))| {
            let step = match axis.axis.count {
                // An axis with one value has no step: a hundredth of the mechanism or of a radian.
                1 if c.quantity == Quantity::Length => {
                    0.01 * self.search.manipulator.characteristic_length()
                }
                1 => 0.01,
                count => (axis.axis.max - axis.axis.min) / (count - 1) as f64,
            };
            let part = (to - from) / step;
            part * part
        });
        parts.sum::<f64>().sqrt()
    }

    /// The same lines with poses on them that are at most `step` steps of the grid apart.
    fn divided(&self, poses: &[Vec<f64>], step: f64) -> Vec<Vec<f64>> {
        let mut divided = vec![poses[0].clone()];
        for ends in poses.windows(2) {
            let parts = (self.length(&ends[0], &ends[1]) / step).ceil().max(1.0) as u64;
            divided.extend((1..=parts).map(|part| {
                let share = part as f64 / parts as f64;
                let between = |(a, b): (&f64, &f64)| a * (1.0 - share) + b * share;
                ends[0].iter().zip(&ends[1]).map(between).collect::<Vec<f64>>()
            }));
        }
        divided
    }

    /// The path of splines through poses on these lines, as close together as is needed for it to be clear; `None` if it
    /// never is.
    fn smooth(&mut self, lines: &[Vec<f64>]) -> Result<Option<AspectPath>, NoPath> {
        for doubling in 0..=DOUBLINGS {
            self.search.progress.advance(0)?;
            let mut poses = self.divided(lines, 0.5_f64.powi(doubling as i32));
            poses.dedup();
            if poses.len() < 2 {
                poses = vec![lines[0].clone(), lines[lines.len() - 1].clone()];
            }
            let lengths: Vec<f64> =
                poses.windows(2).map(|step| self.length(&step[0], &step[1]).max(1e-3)).collect();
            let whole: f64 = lengths.iter().sum();
            let mut along = 0.0;
            let mut times: Vec<f64> = vec![0.0];
            for length in &lengths {
                along += length;
                times.push(self.duration * (along / whole));
            }
            // Rounding of the sum must not change the duration.
            times[lengths.len()] = self.duration;
            let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min) / whole;
            let columns = (0..poses[0].len()).map(|i| poses.iter().map(|pose| pose[i]).collect());
            let Ok(spline) = Spline::new(times.clone(), columns.collect(), Ends::Rest) else {
                return Ok(None);
            };
            let rate = (SAMPLES / shortest).max(LEAST_SAMPLES) / self.duration;
            let Search { manipulator, mode, .. } = self.search;
            if matches!(violation(manipulator, mode, spline, rate), Ok(None)) {
                let clearance = self.clearance(poses.iter().map(|pose| &**pose));
                return Ok(Some(AspectPath { times, poses, clearance }));
            }
        }
        Ok(None)
    }
}

/// A pose of the grid that a pose beside it can go straight to.
struct Anchor {
    number: u64,
    label: u32,
    /// The pose, with angles near to those of the pose beside it.
    pose: Vec<f64>,
}
