//! Aspects: the parts of a workspace in which the platform moves about without a singularity.
//!
//! Within one working mode, the poses in reach are divided by their singularities. An *aspect* is a largest connected
//! part without any (P. Wenger, D. Chablat, *Definition sets for the direct kinematics of parallel manipulators*, 1997;
//! D. Chablat, P. Wenger, *Working modes and aspects in fully parallel manipulators*, 1998). Two poses are in one
//! aspect if the platform can go from one to the other in this mode and without a singularity, parallel or serial.
//!
//! # How it is decided
//!
//! 1. Every pose of the grid is measured: the signed measures of [`opm_core::velocity`], parallel and serial. A pose
//!    where one is zero is singular, and in no aspect.
//! 2. A row of the grid is cut where a measure changes its sign, and where a step between two neighbours is *doubtful*:
//!    the four measures around it let expect that one dips to less than half in between.
//! 3. Pieces of the same signs that touch, in a row or between neighbouring rows, belong together if one straight step
//!    between them is clear. That is watched as a motion is: changes of sign, dips, the reach of every leg and all
//!    limits of joints in between are found, if they come and go once.
//!
//! So two poses of one aspect are joined by steps of which each has the same signs at both ends and no doubtful values
//! around it, or is watched. Within a row, what comes and goes between two neighbours and leaves no trace in the four
//! poses around is not seen. Parts that are joined only by a passage narrower than a step of the grid come out as
//! several aspects: a finer grid finds more connections. [`find_path`] watches every step of the way that it gives.

mod curves;
mod home;
mod join;
mod levels;
mod path;
mod screen;
mod search;
mod step;

pub use curves::{SingularCurves, singular_curves};
pub use home::{HomeAspect, home_aspects};
pub use path::{AspectPath, BeyondLimits, NoPath, aspect_at, find_path};

use crate::boundary::{Outline, boundary};
use crate::forest::Forest;
use crate::ordered::in_order;
use crate::progress::Progress;
use crate::set::{GridSet, MOST, SetAxis, SetBuilder, SetError, point};
use crate::sweep::Run;
use join::{Joiner, Pieces};
use levels::Levels;
use opm_core::manipulator::{Manipulator, Mode};
use screen::Screen;
use std::collections::HashMap;
use std::ops::Range;

/// The number of poses that a thread measures at a time, at least.
const BLOCK: u64 = 1 << 12;

/// The number of rows that a thread joins at a time.
const ROWS: usize = 16;

/// One aspect.
#[derive(Clone, Debug, PartialEq)]
pub struct Aspect {
    /// The signs of the parallel measures, true for positive: of the lower and of the upper section, or one of the whole
    /// mechanism. Only whether two signs differ has a meaning.
    pub signs: Vec<bool>,
    /// The number of its poses.
    pub poses: u64,
    /// The lowest and the highest value of each coordinate, radians or metres. Of an angle that comes full circle these
    /// are values of the grid.
    pub extent: Vec<[f64; 2]>,
}

impl Aspect {
    /// Whether the parallel measure of the whole mechanism, which is the product of those of its sections, is positive.
    pub fn is_positive(&self) -> bool {
        self.signs.iter().filter(|positive| !**positive).count() % 2 == 0
    }
}

/// The aspects of a set of poses in one working mode, the largest first. Those of the same size are in the order of
/// their first poses. The result does not depend on the number of threads.
///
/// ```
/// use opm_workspace::opm_core::Manipulator;
/// use opm_workspace::{Aspects, Axis, Grid, GridSet, Modes, Progress, Sweep};
///
/// let manipulator = Manipulator::example("five-bar")?;
/// let axes = vec![Axis::new("x", -0.3, 0.3, 31), Axis::new("y", 0.1, 0.4, 31)];
/// let (grid, mode) = (Grid::new(&manipulator, axes)?, manipulator.home_mode());
/// let sweep = Sweep::new(&manipulator, &grid, Modes::One(mode));
/// let set = GridSet::reached(&sweep, &Progress::default())?;
/// let aspects = Aspects::new(&manipulator, mode, &set, &Progress::default())?;
///
/// let home = aspects.nearest(&manipulator.home_pose());
/// println!("{} aspects, home is in number {:?}", aspects.list().len(), aspects.label(home));
/// let poses: u64 = aspects.list().iter().map(|aspect| aspect.poses).sum();
/// assert_eq!(poses + aspects.singular(), set.count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Aspects {
    axes: Vec<SetAxis>,
    row: u64,
    pieces: Pieces,
    /// The number of the aspect of each piece, from 1 on; 0 for singular poses.
    labels: Vec<u32>,
    list: Vec<Aspect>,
    singular: u64,
}

impl Aspects {
    /// The aspects of a set of poses of a manipulator, which are in reach in this mode: a
    /// [`GridSet::reached`](crate::GridSet::reached) on a grid of the whole mechanism. This takes some microseconds for
    /// each pose. Poses that are not in reach in this mode count as singular, and so does every pose of a mechanism
    /// [without parallel measures](Self::exist).
    ///
    /// # Errors
    /// The pieces do not fit in memory ([`SetError::Size`]), or the work was cancelled.
    pub fn new(
        manipulator: &Manipulator,
        mode: Mode,
        set: &GridSet,
        progress: &Progress,
    ) -> Result<Self, SetError> {
        let (pieces, kinds) = measured(manipulator, mode, set, progress)?;
        let joiner = Joiner { manipulator, mode, set, pieces: &pieces };
        let mut forest = Forest::new(pieces.runs.len());
        in_order(
            blocks(set.rows(), ROWS).map(Ok),
            || (),
            |(), rows: Range<usize>| {
                let mut joined = Vec::new();
                for row in rows {
                    progress.advance(0)?;
                    joined.extend(joiner.row(row));
                }
                Ok(joined)
            },
            |joined| {
                joined.into_iter().for_each(|[a, b]| forest.join(a, b));
                Ok::<(), SetError>(())
            },
        )?;
        let parallel = Levels::new(manipulator, mode).parallel();
        Ok(Self::of_pieces(set, pieces, &kinds, parallel, &mut forest))
    }

    /// Whether a manipulator has parallel measures. It has none with fewer actuated joints than degrees of freedom: it is
    /// then loose at every pose.
    pub fn exist(manipulator: &Manipulator) -> bool {
        Levels::new(manipulator, manipulator.home_mode()).exist()
    }

    fn of_pieces(
        set: &GridSet,
        pieces: Pieces,
        kinds: &[Vec<bool>],
        parallel: usize,
        forest: &mut Forest,
    ) -> Self {
        let count = pieces.runs.len();
        let (mut sizes, mut singular) = (vec![0; count], 0);
        for (piece, run) in pieces.runs.iter().enumerate() {
            let to = if pieces.kinds[piece] == 0 {
                &mut singular
            } else {
                &mut sizes[forest.root(piece)]
            };
            *to += run.to - run.from;
        }
        // The root of an aspect is its first piece: a stable sort leaves ties in the order of the poses.
        let mut roots: Vec<usize> = (0..count).filter(|&piece| sizes[piece] > 0).collect();
        roots.sort_by_key(|&root| std::cmp::Reverse(sizes[root]));
        let mut of_roots = vec![0; count];
        for (number, &root) in roots.iter().enumerate() {
            of_roots[root] = number as u32 + 1;
        }
        let labels = (0..count).map(|piece| match pieces.kinds[piece] {
            0 => 0,
            _ => of_roots[forest.root(piece)],
        });
        let labels: Vec<u32> = labels.collect();
        let signs = |root: usize| kinds[pieces.kinds[root] as usize - 1][..parallel].to_vec();
        let list = roots.iter().map(|&root| Aspect {
            signs: signs(root),
            poses: sizes[root],
            extent: vec![[f64::INFINITY, f64::NEG_INFINITY]; set.axes().len()],
        });
        let (axes, row, list) = (set.axes().to_vec(), set.row(), list.collect());
        let mut aspects = Self { axes, row, pieces, labels, list, singular };
        aspects.find_extents();
        aspects
    }

    fn find_extents(&mut self) {
        for row in 0..self.pieces.ends.len() {
            for piece in self.pieces.span(row) {
                let Some(label) = (self.labels[piece] as usize).checked_sub(1) else { continue };
                let run = self.pieces.runs[piece];
                for place in [run.from, run.to - 1] {
                    let point = point(&self.axes, row as u64 * self.row + place);
                    for (range, value) in self.list[label].extent.iter_mut().zip(point) {
                        *range = [range[0].min(value), range[1].max(value)];
                    }
                }
            }
        }
    }

    /// The aspects. Number `i` from 1 on is at place `i - 1`.
    pub fn list(&self) -> &[Aspect] {
        &self.list
    }

    /// The number of poses that are singular, and so in no aspect.
    pub fn singular(&self) -> u64 {
        self.singular
    }

    /// The axes of the grid, the fastest first.
    pub fn axes(&self) -> &[SetAxis] {
        &self.axes
    }

    /// The number of the aspect that a pose of the grid is in, from 1 on. It is 0 if the pose is singular, and `None` if it
    /// is not in the set.
    pub fn label(&self, number: u64) -> Option<u32> {
        let row =
            usize::try_from(number / self.row).ok().filter(|row| *row < self.pieces.ends.len())?;
        Some(self.labels[self.pieces.find(row, number % self.row)?])
    }

    /// The number of the pose of the grid that is nearest to this one, coordinate by coordinate.
    pub fn nearest(&self, pose: &[f64]) -> u64 {
        let (mut number, mut stride) = (0, 1);
        for (SetAxis { axis, .. }, value) in self.axes.iter().zip(pose) {
            if axis.count > 1 {
                let share = (value - axis.min) / (axis.max - axis.min);
                // A cast saturates.
                let place = (share * (axis.count - 1) as f64).round() as u64;
                number += stride * place.min(axis.count - 1);
            }
            stride *= axis.count;
        }
        number
    }

    /// The runs of poses, by their numbers in the grid, ascending. Each comes with the number of its aspect, or with 0 if
    /// its poses are singular.
    pub fn runs(&self) -> impl Iterator<Item = (Run, u32)> + '_ {
        (0..self.pieces.ends.len()).flat_map(move |row| {
            let first = row as u64 * self.row;
            self.pieces.span(row).map(move |piece| {
                let run = self.pieces.runs[piece];
                (Run { from: first + run.from, to: first + run.to }, self.labels[piece])
            })
        })
    }

    /// The poses of each aspect as a set, in the order of the list.
    ///
    /// # Errors
    /// A set does not fit in memory.
    pub fn sets(&self) -> impl Iterator<Item = Result<GridSet, SetError>> + '_ {
        let mut runs: Vec<Vec<Run>> = vec![vec![]; self.list.len()];
        for (run, label) in self.runs() {
            if let Some(number) = (label as usize).checked_sub(1) {
                runs[number].push(run);
            }
        }
        runs.into_iter().map(|runs| {
            let mut set = SetBuilder::new(self.axes.clone())?;
            runs.into_iter().try_for_each(|run| set.push(run))?;
            Ok(set.finish())
        })
    }

    /// The boundaries of all aspects, as [`boundary`](crate::boundary()) has those of a set: in each slice the rings of the
    /// first aspect come first. `None` if fewer than two axes or more than three have several values.
    ///
    /// # Errors
    /// An aspect does not fit in memory as a set.
    pub fn boundary(&self) -> Result<Option<Vec<Outline>>, SetError> {
        let mut all: Option<Vec<Outline>> = None;
        for set in self.sets() {
            let Some(outlines) = boundary(&set?) else { return Ok(None) };
            match &mut all {
                None => all = Some(outlines),
                Some(all) => {
                    let slices = all.iter_mut().zip(outlines);
                    slices.for_each(|(all, more)| all.rings.extend(more.rings));
                }
            }
        }
        Ok(all)
    }
}

/// The pieces of all rows, and the signs of each kind, from kind 1 on.
fn measured(
    manipulator: &Manipulator,
    mode: Mode,
    set: &GridSet,
    progress: &Progress,
) -> Result<(Pieces, Vec<Vec<bool>>), SetError> {
    let (mut pieces, mut kinds) = (Pieces::default(), Vec::new());
    let mut numbers: HashMap<Vec<bool>, u32> = HashMap::new();
    let together = usize::try_from(BLOCK / set.row()).unwrap_or(1).max(1);
    in_order(
        blocks(set.rows(), together).map(Ok),
        || Screen::new(manipulator, mode),
        |screen, rows: Range<usize>| {
            let mut made = Vec::with_capacity(rows.len());
            for row in rows {
                made.push(screen.row(set, row));
                progress.advance(set.row())?;
            }
            Ok(made)
        },
        |made| {
            for row in made {
                pieces.push(row, |signs| {
                    *numbers.entry(signs).or_insert_with_key(|signs| {
                        kinds.push(signs.clone());
                        kinds.len() as u32
                    })
                });
                let given = pieces.runs.len() as u64;
                if given > MOST {
                    return Err(SetError::Size { what: "runs", given, most: MOST });
                }
            }
            Ok(())
        },
    )?;
    Ok((pieces, kinds))
}

/// Rows, some at a time.
fn blocks(rows: usize, together: usize) -> impl Iterator<Item = Range<usize>> {
    (0..rows.div_ceil(together)).map(move |i| i * together..((i + 1) * together).min(rows))
}
