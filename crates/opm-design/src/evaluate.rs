//! The measures of one mechanism.

use crate::measure::Measure;
use crate::problem::Problem;
use opm_analysis::{Index, Indices, Setup};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::Mechanism;
use opm_core::skeleton::{PartKind, Skeleton, Solid};
use opm_workspace::{
    Axis, Cancelled, Count, Grid, InscribedShape, Modes, Progress, Sections, SetError, Sweep,
    Visits, inscribed,
};
use rayon::prelude::*;

/// Poses that a thread works on at a time.
const PIECE: u64 = 256;

/// The lowest and the highest value of joints, by name; radians and metres.
pub type Ranges = Vec<(String, [f64; 2])>;

/// A measure of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value: a share, metres, radians.
    pub value: f64,
    /// From 0 to 1: how near a design is that reaches more. It decides between designs whose values are equal, so that a
    /// design that reaches nothing leads to one that does.
    pub guide: f64,
}

/// Evaluates the measures of a problem of the whole mechanism. `None` if its grid does not suit.
pub fn whole(
    problem: &Problem,
    measures: &[Measure],
    manipulator: &Manipulator,
    progress: &Progress,
) -> Result<Option<Vec<Value>>, Cancelled> {
    let (Some(grid), Some(mode)) = (problem.grid_of(manipulator), problem.mode_of(manipulator))
    else {
        return Ok(None);
    };
    let sweep = Sweep::new(manipulator, &grid, Modes::One(mode));
    let swept = Swept::new(&sweep, measures, problem.largest_radius(manipulator), progress)?;
    let Some(asked) = Asked::new(measures, manipulator) else { return Ok(None) };
    let found = asked.over(&grid, manipulator, mode, progress)?;
    Ok(Some(measures.iter().map(|measure| swept.value(measure, manipulator, &found)).collect()))
}

/// Evaluates the measures of a problem with the lower section alone, over the places and over all values of the imaginary
/// joints in `cuts`. Measures that are not of places are those of the whole mechanism.
pub fn lower(
    problem: &Problem,
    measures: &[Measure],
    manipulator: &Manipulator,
    cuts: &[Axis],
    progress: &Progress,
) -> Result<Option<Vec<Value>>, Cancelled> {
    let of_places = |m: &&Measure| matches!(m, Measure::Dexterous | Measure::Inscribed(_));
    let (places, others): (Vec<_>, Vec<_>) = measures.iter().partition(of_places);
    let others: Vec<Measure> = others.into_iter().cloned().collect();
    let others = match others.is_empty() {
        true => Vec::new(),
        false => match whole(problem, &others, manipulator, progress)? {
            Some(values) => others.into_iter().zip(values).collect(),
            None => return Ok(None),
        },
    };
    let [axes, _] = problem.divided_axes(manipulator);
    let axes = axes.into_iter().chain(cuts.iter().cloned()).collect();
    let Ok(grid) = Grid::of(Sections::Lower, manipulator, axes) else { return Ok(None) };
    let Some(mode) = problem.mode_of(manipulator) else { return Ok(None) };
    let sweep = Sweep::new(manipulator, &grid, Modes::One(mode));
    let places: Vec<Measure> = places.into_iter().cloned().collect();
    let swept = Swept::new(&sweep, &places, problem.largest_radius(manipulator), progress)?;
    let none = GridFindings::default();
    let value = |measure: &Measure| {
        let other = others.iter().find(|(known, _)| known == measure);
        other.map_or_else(|| swept.value(measure, manipulator, &none), |(_, value)| *value)
    };
    Ok(Some(measures.iter().map(value).collect()))
}

/// What the upper section alone reaches.
pub struct Upper {
    /// The share of the orientations that are in reach.
    pub reached: f64,
    /// The range of each imaginary joint over them, metres and radians.
    pub ranges: Vec<Option<[f64; 2]>>,
}

/// Evaluates the upper section of a mechanism over the orientations of a problem.
pub fn upper(
    problem: &Problem,
    manipulator: &Manipulator,
    progress: &Progress,
) -> Result<Option<Upper>, Cancelled> {
    let [_, axes] = problem.divided_axes(manipulator);
    let Ok(grid) = Grid::of(Sections::Upper, manipulator, axes) else { return Ok(None) };
    let Some(mode) = problem.mode_of(manipulator) else { return Ok(None) };
    let count = Sweep::new(manipulator, &grid, Modes::One(mode)).count(progress)?;
    Ok(Some(Upper { reached: share(&count), ranges: count.imaginary }))
}

fn share(count: &Count) -> f64 {
    count.reachable as f64 / count.poses.max(1) as f64
}

/// What a sweep says of measures.
struct Swept {
    count: Count,
    visits: Option<Visits>,
    radii: Vec<(InscribedShape, f64)>,
    largest: f64,
}

impl Swept {
    fn new(
        sweep: &Sweep<'_>,
        measures: &[Measure],
        largest: f64,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let of_sweep = |m: &Measure| !matches!(m, Measure::Size);
        let count = match measures.iter().any(of_sweep) {
            true => sweep.count(progress)?,
            false => Count { poses: 0, reachable: 0, imaginary: Vec::new() },
        };
        let of_places = |m: &Measure| {
            matches!(m, Measure::Reachable | Measure::Dexterous | Measure::Inscribed(_))
        };
        let visits = match measures.iter().any(of_places) {
            true => match Visits::new(sweep, progress) {
                Ok(visits) => Some(visits),
                Err(SetError::Cancelled(cancelled)) => return Err(cancelled),
                // More places than fit in memory.
                Err(_) => None,
            },
            false => None,
        };
        let shapes = measures.iter().filter_map(|measure| match measure {
            Measure::Inscribed(shape) => Some(*shape),
            _ => None,
        });
        let radius = |shape| {
            let set = visits.as_ref()?.dexterous().ok()?;
            Some(inscribed(&set, shape, None).ok()??.radii[0])
        };
        let radii = shapes.map(|shape| (shape, radius(shape).unwrap_or(0.0))).collect();
        Ok(Self { count, visits, radii, largest })
    }

    fn value(&self, measure: &Measure, manipulator: &Manipulator, found: &GridFindings) -> Value {
        let reached = share(&self.count);
        let places = |least: u64| {
            let Some(visits) = &self.visits else { return 0.0 };
            let counts = visits.counts();
            counts.iter().filter(|&&count| count >= least).count() as f64 / counts.len() as f64
        };
        let every = || places(self.visits.as_ref().map_or(1, Visits::orientations));
        match measure {
            Measure::Grid => Value { value: reached, guide: 0.0 },
            Measure::Reachable => Value { value: places(1), guide: reached },
            Measure::Dexterous => Value { value: every(), guide: reached },
            Measure::Inscribed(shape) => {
                let radius = self.radii.iter().find(|(known, _)| known == shape);
                // Beyond the grid nothing is known.
                let value = radius.map_or(0.0, |(_, radius)| radius.min(self.largest));
                Value { value, guide: 0.5 * (every() + reached) }
            }
            Measure::Worst(index) => {
                let worst = found.worst.iter().find(|(known, _)| known == index);
                let value = worst.map_or(f64::NAN, |(_, worst)| *worst);
                let value = if reached < 1.0 || value.is_nan() { measure.nothing() } else { value };
                Value { value, guide: reached }
            }
            Measure::Range(joint) => {
                let imaginary = manipulator.imaginary().iter().position(|i| i.name == *joint);
                let range = match imaginary {
                    Some(number) => self.count.imaginary.get(number).copied().flatten(),
                    None => found.ranges.iter().find(|(name, _)| name == joint).map(|(_, r)| *r),
                };
                let value = range.map_or(0.0, |[low, high]| (high - low).max(0.0));
                Value { value, guide: 0.0 }
            }
            Measure::Size => Value { value: size(manipulator.mechanism()), guide: 0.0 },
        }
    }
}

/// The lengths of the rods of all links at home together, metres.
fn size(mechanism: &Mechanism) -> f64 {
    let skeleton = Skeleton::new(mechanism, None);
    let parts = skeleton.bodies().iter().flat_map(|body| &body.parts);
    let rods = parts.filter_map(|part| match (part.kind, part.solid) {
        (PartKind::Rod, Solid::Cylinder { from, to, .. }) => Some((to - from).norm()),
        _ => None,
    });
    rods.sum()
}

/// What has to be computed pose by pose.
struct Asked {
    indices: Vec<Index>,
    /// Names and numbers of joint coordinates.
    joints: Vec<(String, usize)>,
    setup: Setup,
}

/// What was found over the poses in reach.
#[derive(Clone, Debug, Default)]
struct GridFindings {
    worst: Vec<(Index, f64)>,
    ranges: Ranges,
}

impl Asked {
    /// `None` if the mechanism does not have what is asked for.
    fn new(measures: &[Measure], manipulator: &Manipulator) -> Option<Self> {
        let mut asked = Self {
            indices: Vec::new(),
            joints: Vec::new(),
            setup: Setup::new(manipulator.characteristic_length()),
        };
        for measure in measures {
            match measure {
                Measure::Worst(index) => {
                    index.check(manipulator, &asked.setup).ok()?;
                    asked.indices.push(*index);
                }
                Measure::Range(name) if manipulator.imaginary().iter().all(|i| i.name != *name) => {
                    let mut all = manipulator.coordinates().iter();
                    asked.joints.push((name.clone(), all.position(|joint| joint.name == *name)?));
                }
                _ => {}
            }
        }
        Some(asked)
    }

    /// The worst values and the ranges over the poses of a grid that are in reach and within limits.
    fn over(
        &self,
        grid: &Grid,
        manipulator: &Manipulator,
        mode: Mode,
        progress: &Progress,
    ) -> Result<GridFindings, Cancelled> {
        if self.indices.is_empty() && self.joints.is_empty() {
            return Ok(GridFindings::default());
        }
        let pieces = (0..grid.poses().div_ceil(PIECE)).into_par_iter();
        let found = pieces.map(|piece| {
            let mut found = self.nothing();
            let mut buffer = manipulator.solution();
            let mut pose = manipulator.home_pose();
            let mut indices =
                Indices::new(manipulator, &self.setup, self.indices.iter().copied()).ok();
            for number in piece * PIECE..((piece + 1) * PIECE).min(grid.poses()) {
                grid.pose_into(number, &mut pose);
                let at = manipulator.inverse(&pose, mode, &mut buffer).ok().flatten();
                let Some(at) = at.filter(|at| at.within_limits()) else { continue };
                for ((_, [low, high]), (_, joint)) in found.ranges.iter_mut().zip(&self.joints) {
                    let value = at.joints()[*joint];
                    (*low, *high) = (low.min(value), high.max(value));
                }
                let values = indices.as_mut().map_or(&[][..], |indices| indices.evaluate(at));
                for ((index, worst), value) in found.worst.iter_mut().zip(values) {
                    *worst = worse(*index, *worst, *value);
                }
            }
            progress.advance(PIECE)?;
            Ok(found)
        });
        found.try_reduce(|| self.nothing(), |one, other| Ok(one.with(&other)))
    }

    fn nothing(&self) -> GridFindings {
        let best = |index: &Index| {
            let large = index.facts().large_is_good;
            (*index, if large { f64::INFINITY } else { f64::NEG_INFINITY })
        };
        let empty = [f64::INFINITY, f64::NEG_INFINITY];
        GridFindings {
            worst: self.indices.iter().map(best).collect(),
            ranges: self.joints.iter().map(|(name, _)| (name.clone(), empty)).collect(),
        }
    }
}

/// The worse of two values of an index; what is not known is the worst.
fn worse(index: Index, one: f64, other: f64) -> f64 {
    let known = |value: f64| match (value.is_nan(), index.facts().large_is_good) {
        (false, _) => value,
        (true, true) => f64::NEG_INFINITY,
        (true, false) => f64::INFINITY,
    };
    let (one, other) = (known(one), known(other));
    if index.facts().large_is_good { one.min(other) } else { one.max(other) }
}

impl GridFindings {
    fn with(mut self, other: &Self) -> Self {
        for ((index, own), (_, theirs)) in self.worst.iter_mut().zip(&other.worst) {
            *own = worse(*index, *own, *theirs);
        }
        for ((_, [low, high]), (_, [l, h])) in self.ranges.iter_mut().zip(&other.ranges) {
            (*low, *high) = (low.min(*l), high.max(*h));
        }
        self
    }
}
