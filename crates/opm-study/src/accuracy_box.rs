//! The worst pose error over a box of poses, with a guaranteed bound.

use opm_accuracy::{Budget, Model, Unbounded};
use opm_core::Quantity;
use opm_core::enclosure::{BoxQuery, Side};
use opm_core::manipulator::{Manipulator, Mode};
use opm_workspace::measure::{CoordinateRange, RangeError};
use opm_workspace::{Cancelled, Progress, Sections, in_order};

/// The most boxes that are bounded if nothing else is said: some ten seconds.
pub const BOX_BUDGET: u64 = 20_000;

/// What is asked of the accuracy over a box.
#[derive(Clone, Copy, Debug)]
pub struct BoxRequest<'a> {
    /// The errors.
    pub model: &'a Model<'a>,
    /// The size of each error, radians and metres, in the order of the model's sources.
    pub sizes: &'a [f64],
    /// The working mode.
    pub mode: Mode,
    /// The ranges of task coordinates. Others stay at home.
    pub over: &'a [CoordinateRange],
    /// The share by which a bound may exceed the largest error that was found at a pose.
    pub gap: f64,
    /// The most boxes that are bounded.
    pub most: u64,
}

/// A number with a guaranteed bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded {
    /// The largest value at a pose; not a number if no pose was in reach.
    pub found: f64,
    /// That pose, radians and metres.
    pub pose: Vec<f64>,
    /// The value is not larger at any pose of the box that is in reach; infinite if nothing is known, zero if no pose is in
    /// reach.
    pub bound: f64,
}

/// The worst pose errors over a box.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxErrors {
    /// The lowest and the highest value of each task coordinate, radians and metres.
    pub over: Vec<[f64; 2]>,
    /// The displacement of the platform's reference point, metres.
    pub length: Bounded,
    /// The rotation of the platform, radians.
    pub angle: Bounded,
    /// How many boxes were bounded.
    pub boxes: u64,
    /// Whether both bounds are within the gap that was asked for.
    pub tight: bool,
}

/// A part of the box.
struct BoxPart {
    ends: Vec<[f64; 2]>,
    /// Bounds of the displacement and of the rotation: those of a larger part until its own are known.
    bounds: [f64; 2],
}

/// What was found of a part that has poses in reach.
struct Seen {
    part: BoxPart,
    /// The number of the side to bisect; `None` if it is a single pose.
    split: Option<usize>,
    /// Displacement and rotation at poses.
    found: Vec<([f64; 2], Vec<f64>)>,
}

impl BoxRequest<'_> {
    /// Searches the worst errors, and bounds them (branch and bound). Parts of the box whose bounds are within the gap above
    /// the largest errors that were found are done with; others are bisected. The result does not depend on the number of
    /// threads.
    ///
    /// # Errors
    /// A range is wrong, the errors have no bounds over boxes, or the work was cancelled.
    pub fn errors(&self, progress: &Progress) -> Result<BoxErrors, BoxError> {
        let over = CoordinateRange::of_each(self.model.manipulator(), Sections::Whole, self.over)?;
        self.model.check_boxes(self.sizes)?;
        let none = || Bounded { found: f64::NAN, pose: Vec::new(), bound: 0.0 };
        let mut worst = [none(), none()];
        let mut parts = vec![BoxPart { ends: over.clone(), bounds: [f64::INFINITY; 2] }];
        let mut boxes = 0;
        while !parts.is_empty() && (boxes == 0 || boxes + parts.len() as u64 <= self.most) {
            boxes += parts.len() as u64;
            let mut seen = Vec::new();
            in_order(
                parts.into_iter().map(Ok::<_, Cancelled>),
                || (),
                |(), part| {
                    progress.advance(1)?;
                    Ok(self.look(part))
                },
                |one| {
                    seen.extend(one);
                    Ok(())
                },
            )?;
            for (values, pose) in seen.iter().flat_map(|one| &one.found) {
                for (own, value) in worst.iter_mut().zip(values) {
                    if own.found.is_nan() || *value > own.found {
                        (own.found, own.pose) = (*value, pose.clone());
                    }
                }
            }
            parts = Vec::new();
            for Seen { part, split, .. } in seen {
                let done = worst.iter().zip(part.bounds);
                let done = done.map(|(own, bound)| bound <= own.found * (1.0 + self.gap));
                match split.filter(|_| !done.into_iter().all(|done| done)) {
                    Some(side) => parts.extend(part.bisected(side)),
                    None => part.count(&mut worst),
                }
            }
        }
        parts.iter().for_each(|part| part.count(&mut worst));
        let tight = worst.iter().all(|own| own.bound <= own.found * (1.0 + self.gap));
        let [length, angle] = worst;
        Ok(BoxErrors { over, length, angle, boxes, tight })
    }

    /// Bounds the errors in a part, and computes them at a pose where they are large. `None` if no pose is in reach.
    fn look(&self, mut part: BoxPart) -> Option<Seen> {
        let manipulator = self.model.manipulator();
        let sides: Vec<Side> = part.sides().collect();
        if manipulator.enclose(BoxQuery::Whole, Some(self.mode), &sides).upper <= 0.0 {
            return None;
        }
        let bounded = self.model.over_box(self.mode, &part.ends, self.sizes);
        let middle: Vec<f64> = sides.iter().map(|side| side.middle).collect();
        let mut poses = vec![middle];
        let mut weights = None;
        if let Some(budget) = bounded {
            part.bounds = [budget.length.min(part.bounds[0]), budget.angle.min(part.bounds[1])];
            poses.extend(budget.corners);
            weights = Some(budget.change);
        }
        let found = poses.into_iter().filter_map(|pose| Some((self.at(manipulator, &pose)?, pose)));
        let found = found.collect();
        // Without bounds, the longest side.
        let length = self.model.length();
        let width = |number: usize| {
            let [low, high] = part.ends[number];
            let unit = match manipulator.task_coordinates()[number].quantity {
                Quantity::Length => length,
                Quantity::Angle => 1.0,
            };
            (high - low) / unit
        };
        let weight = |number: usize| weights.as_ref().map_or_else(|| width(number), |w| w[number]);
        let wide = (0..part.ends.len()).filter(|&number| width(number) > 0.0);
        let split = wide.max_by(|&one, &other| weight(one).total_cmp(&weight(other)));
        Some(Seen { part, split, found })
    }

    /// The worst displacement and rotation at a pose, if it is in reach and within limits.
    fn at(&self, manipulator: &Manipulator, pose: &[f64]) -> Option<[f64; 2]> {
        let mut buffer = manipulator.solution();
        let at = manipulator.inverse(pose, self.mode, &mut buffer).ok()??;
        let response = at.within_limits().then(|| self.model.at(at).ok())??;
        let Budget { length, angle, .. } = Budget::new(&response, self.sizes);
        (length.worst.is_finite() && angle.worst.is_finite()).then_some([length.worst, angle.worst])
    }
}

impl BoxPart {
    fn sides(&self) -> impl Iterator<Item = Side> + '_ {
        self.ends.iter().map(|[low, high]| Side {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
            half_turn: None,
        })
    }

    /// Its halves along a side.
    fn bisected(self, side: usize) -> [Self; 2] {
        let [low, high] = self.ends[side];
        let middle = 0.5 * (low + high);
        let half = |ends: [f64; 2]| {
            let mut part = Self { ends: self.ends.clone(), bounds: self.bounds };
            part.ends[side] = ends;
            part
        };
        [half([low, middle]), half([middle, high])]
    }

    /// Counts its bounds among those of the whole.
    fn count(&self, worst: &mut [Bounded; 2]) {
        for (own, bound) in worst.iter_mut().zip(self.bounds) {
            own.bound = own.bound.max(bound);
        }
    }
}

/// Why there are no bounds.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BoxError {
    /// A coordinate is unknown or repeated, or its ends are not finite numbers in their order.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The errors have no bounds over boxes.
    #[error(transparent)]
    Unbounded(#[from] Unbounded),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
