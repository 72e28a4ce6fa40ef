//! Grids of poses, or of the coordinates of one section alone: one axis for each coordinate, with both ends on
//! the grid.

use opm_core::Quantity;
use opm_core::group::SubspaceKind;
use opm_core::manipulator::{FollowingCoordinate, ImaginaryJoint, LARGEST, Manipulator};
use opm_core::numeric::number::readable;
use opm_core::task::CoordinateKind;
use std::f64::consts::TAU;
use std::ops::Range;

/// Most poses of a grid: larger numbers are not exact in double precision, which JSON readers use.
const MOST_POSES: u64 = 1 << 53;

/// An angle's values cover a full revolution if their range is that to within this, radians.
const WHOLE: f64 = 1e-9;

/// Equally spaced values of one coordinate.
///
/// ```
/// use opm_workspace::Axis;
///
/// let axis = Axis::new("x", -0.1, 0.1, 5);
/// assert_eq!((axis.value(0), axis.value(2), axis.value(4)), (-0.1, 0.0, 0.1));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The coordinate's name.
    pub name: String,
    /// The first value, radians or metres.
    pub min: f64,
    /// The last value, radians or metres.
    pub max: f64,
    /// The number of values, at least one.
    pub count: u64,
}

/// Why axes do not make a grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// The grid is of the upper section, but all legs move in one subspace.
    #[error("the mechanism has no upper section: all its legs move in one subspace")]
    NoUpperSection,
    /// The grid is of one section alone, but one section depends on the other.
    #[error(
        "the sections of this mechanism have no grids of their own: its legs tie its coordinates together, joints have \
         cones or limits of their differences, or the sections share an inclined translation"
    )]
    NotAlone,
    /// No coordinate has the name of the axis.
    #[error("grid axis {name}: no such {}, expected one of {expected}", section.coordinate())]
    Unknown {
        /// The name of the axis.
        name: String,
        /// The sections that the grid is of.
        section: Sections,
        /// The names of all coordinates, separated by commas.
        expected: String,
    },
    /// The coordinate of the axis follows from the others.
    #[error(transparent)]
    Follows(#[from] FollowingCoordinate),
    /// Two axes have the same name.
    #[error("grid axis {0}: given twice")]
    Twice(String),
    /// An end of an axis is not a finite number, or the ends are reversed.
    #[error(
        "grid axis {name}: {} to {}, expected {}",
        readable(*min),
        readable(*max),
        if min > max { "the smaller one first".to_owned() } else { format!("numbers up to {LARGEST:e}") }
    )]
    Range {
        /// The name of the axis.
        name: String,
        /// The first value, as given.
        min: f64,
        /// The last value, as given.
        max: f64,
    },
    /// The number of values does not fit the ends of an axis.
    #[error(
        "grid axis {name}: {count} values from {} to {}, expected {expected}",
        readable(*min),
        readable(*max)
    )]
    Count {
        /// The name of the axis.
        name: String,
        /// The number of values, as given.
        count: u64,
        /// The first value, as given.
        min: f64,
        /// The last value, as given.
        max: f64,
        /// The number of values that was expected.
        expected: &'static str,
    },
    /// The grid has too many poses.
    #[error("grid of {given} poses, expected at most 2^53, some 9e15")]
    Size {
        /// The number of poses, as a number or a product.
        given: String,
    },
}

impl Axis {
    /// `count` values from `min` to `max`, radians or metres, of the coordinate `name`.
    pub fn new(name: impl Into<String>, min: f64, max: f64, count: u64) -> Self {
        Self { name: name.into(), min, max, count }
    }

    /// The single value of a coordinate, radians or metres.
    pub fn fixed(name: impl Into<String>, value: f64) -> Self {
        Self::new(name, value, value, 1)
    }

    /// Value number `i`, from 0 on. Both ends are met exactly.
    #[inline]
    pub fn value(&self, i: u64) -> f64 {
        if self.count == 1 {
            return self.min;
        }
        let share = i as f64 / (self.count - 1) as f64;
        self.min * (1.0 - share) + self.max * share
    }

    fn check(&self) -> Result<(), GridError> {
        let Self { name, min, max, count } = self.clone();
        if !(min <= max && min.abs().max(max.abs()) <= LARGEST) {
            return Err(GridError::Range { name, min, max });
        }
        let expected = match count {
            0 => "at least 1",
            1 if min < max => "at least 2, or one value alone",
            2.. if min == max => "1 value where the ends are the same",
            _ => return Ok(()),
        };
        Err(GridError::Count { name, count, min, max, expected })
    }
}

/// The sections of the mechanism that a grid is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sections {
    /// Both sections: the grid's points are poses of the platform.
    Whole,
    /// The upper section alone: the grid's points are its displacements `b`.
    Upper,
    /// The lower section alone: the grid's points are its displacements `v`, together with the
    /// displacements of the imaginary joints of the legs that are split in the upper section
    /// ([`Reach::intersection_joints`](opm_core::reach::Reach::intersection_joints)).
    Lower,
}

impl Sections {
    /// What a coordinate of such a grid is called in messages.
    pub fn coordinate(self) -> &'static str {
        match self {
            Self::Whole => "task coordinate",
            Self::Upper => "task coordinate of the upper section",
            Self::Lower => "task coordinate of the lower section or imaginary joint",
        }
    }
}

/// A coordinate of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// The name of the coordinate.
    pub name: String,
    /// What it measures; `None` for the value of an imaginary joint.
    pub kind: Option<CoordinateKind>,
    /// Whether it is an angle or a length.
    pub quantity: Quantity,
    /// The value at home, radians or metres.
    pub home: f64,
    /// Whether it is an angle whose full revolutions matter, because a helical joint follows them.
    pub counts_turns: bool,
}

impl Sections {
    /// The coordinates of grids of these sections, the lower section's first.
    pub fn coordinates(self, manipulator: &Manipulator) -> Vec<Coordinate> {
        let task = manipulator.task_coordinates().iter().map(|c| Coordinate {
            name: c.name.to_owned(),
            kind: Some(c.kind()),
            quantity: c.quantity,
            home: c.home,
            counts_turns: manipulator.counts_turns(c.kind()),
        });
        let lower = manipulator.lower_coordinates();
        let cuts = || {
            manipulator.reach().intersection_joints().into_iter().map(|joint| Coordinate {
                name: joint.name,
                kind: None,
                quantity: joint.quantity,
                home: joint.home,
                counts_turns: manipulator.reach().intersection_counts_turns(),
            })
        };
        match self {
            Self::Whole => task.collect(),
            Self::Upper => task.skip(lower).collect(),
            Self::Lower => task.take(lower).chain(cuts()).collect(),
        }
    }
}

/// A grid of poses: one axis for every coordinate of a manipulator's pose, or of one section alone, in their
/// order. Poses are numbered from 0 on, with the first coordinate fastest.
///
/// A *row* are the poses that differ in the first coordinate alone. A *slice* are the poses that share all
/// coordinates of the upper section, or, in a grid of the lower section alone, the displacements of all
/// imaginary joints.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, Grid};
///
/// // Coordinates without an axis stay at home.
/// let axes = vec![Axis::new("x", -0.3, 0.3, 61), Axis::new("xi", 0.0, 0.5, 11)];
/// let grid = Grid::new(&manipulator, axes)?;
/// assert_eq!((grid.poses(), grid.row(), grid.slices()), (61 * 11, 61, 11));
/// assert_eq!(grid.pose(60)[0], 0.3);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    coordinates: Vec<Coordinate>,
    sections: Sections,
    /// In a grid of the lower section alone, the imaginary joints whose displacements are its last axes.
    cuts: Vec<ImaginaryJoint>,
    /// The number of coordinates that vary within a slice.
    lower: usize,
    /// The numbers of the coordinates that are the place.
    places: Range<usize>,
    poses: u64,
}

impl Grid {
    /// A grid of poses over these axes, in any order. A task coordinate without an axis stays at its home
    /// value.
    ///
    /// # Errors
    /// [`GridError`]: unknown or repeated axes, ends that are not finite numbers or reversed, counts that
    /// cannot hold both ends, or more than 2^53 poses.
    pub fn new(manipulator: &Manipulator, given: Vec<Axis>) -> Result<Self, GridError> {
        Self::of(Sections::Whole, manipulator, given)
    }

    /// A grid of the whole mechanism or of one section alone, as [`Grid::new`]. A pose of it has a value for
    /// each of [`Sections::coordinates`].
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn of(
        sections: Sections,
        manipulator: &Manipulator,
        given: Vec<Axis>,
    ) -> Result<Self, GridError> {
        let coordinates = sections.coordinates(manipulator);
        let mut axes: Vec<Option<Axis>> = vec![None; coordinates.len()];
        let one_subspace = manipulator.task().upper.kind == SubspaceKind::Identity;
        if coordinates.is_empty() && one_subspace {
            return Err(GridError::NoUpperSection);
        }
        let alone = manipulator.dependent_coordinates().is_empty()
            && !manipulator.shares_limits()
            && !manipulator.task().shares_height();
        if sections != Sections::Whole && !alone {
            return Err(GridError::NotAlone);
        }
        for axis in given {
            let Some(number) = coordinates.iter().position(|c| c.name == axis.name) else {
                manipulator.refuse_following(&axis.name)?;
                let names: Vec<_> = coordinates.iter().map(|c| &*c.name).collect();
                let expected = names.join(", ");
                return Err(GridError::Unknown { name: axis.name, section: sections, expected });
            };
            axis.check()?;
            if axes[number].is_some() {
                return Err(GridError::Twice(axis.name));
            }
            axes[number] = Some(axis);
        }
        let axes: Vec<Axis> = axes
            .into_iter()
            .zip(&coordinates)
            .map(|(axis, c)| axis.unwrap_or_else(|| Axis::fixed(&*c.name, c.home)))
            .collect();
        let poses = axes.iter().try_fold(1_u64, |poses, axis| poses.checked_mul(axis.count));
        let lower = match sections {
            // A row needs a coordinate.
            Sections::Whole => manipulator.lower_coordinates().max(1),
            Sections::Lower => manipulator.lower_coordinates(),
            Sections::Upper => 0,
        };
        let places = match sections {
            Sections::Whole => manipulator.place_coordinates(),
            Sections::Lower | Sections::Upper => 0..lower,
        };
        let cuts = match sections {
            Sections::Lower => manipulator.reach().intersection_joints(),
            Sections::Whole | Sections::Upper => vec![],
        };
        match poses {
            Some(poses) if poses <= MOST_POSES => {
                Ok(Self { axes, coordinates, sections, cuts, lower, places, poses })
            }
            _ => {
                let counts: Vec<_> = axes.iter().map(|axis| axis.count.to_string()).collect();
                Err(GridError::Size { given: counts.join(" x ") })
            }
        }
    }

    /// The sections that it is a grid of.
    pub fn sections(&self) -> Sections {
        self.sections
    }

    /// The coordinates of its axes, in their order.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Whether the values of axis number `axis` come full circle: the first and the last value are the same
    /// place, or a step from each other.
    ///
    /// # Panics
    /// There is no axis of this number.
    pub fn is_circle(&self, axis: usize) -> bool {
        let Coordinate { quantity, counts_turns, .. } = self.coordinates[axis];
        let Axis { min, max, count, .. } = self.axes[axis];
        if quantity != Quantity::Angle || counts_turns || count < 3 {
            return false;
        }
        let width = max - min;
        let step = width / (count - 1) as f64;
        [width, width + step].iter().any(|width| (width - TAU).abs() <= WHOLE)
    }

    /// The axes, in the order of the coordinates.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The number of poses.
    pub fn poses(&self) -> u64 {
        self.poses
    }

    /// The number of poses in a row, which differ in the first coordinate alone. In a grid of the upper
    /// section alone every pose is a row, and a slice.
    pub fn row(&self) -> u64 {
        if self.lower == 0 { 1 } else { self.axes[0].count }
    }

    /// In a grid of the lower section alone: a leg's displacement along the intersection motion, in the slice
    /// with these values of the imaginary joints.
    pub(crate) fn cut(&self, leg: usize, values: &[f64]) -> f64 {
        let cut = self.cuts.iter().zip(values).find(|(cut, _)| cut.leg == leg);
        cut.map_or(0.0, |(cut, value)| cut.displacement(*value))
    }

    /// The number of slices: sets of poses that share all coordinates but those of [`Grid::lower`].
    pub fn slices(&self) -> u64 {
        self.points_of(self.lower..self.axes.len())
    }

    /// The number of the lower section's task coordinates, which vary within a slice. It is zero in a grid
    /// of the upper section alone.
    pub fn lower(&self) -> usize {
        self.lower
    }

    /// The numbers of the axes whose coordinates are the platform's *place*
    /// ([`Manipulator::place_coordinates`]), or those of the lower section in a grid of one section alone.
    pub fn places(&self) -> Range<usize> {
        self.places.clone()
    }

    /// The numbers of the other axes, whose coordinates are the platform's *orientation*.
    pub fn orientations(&self) -> Range<usize> {
        let Range { start, end } = self.places;
        if start > 0 { 0..start } else { end..self.axes.len() }
    }

    /// The number of points that some axes have together.
    pub(crate) fn points_of(&self, axes: Range<usize>) -> u64 {
        self.axes[axes].iter().map(|axis| axis.count).product()
    }

    /// The number of orientations: combinations of values of the orientation's coordinates.
    pub fn orientation_count(&self) -> u64 {
        self.points_of(self.orientations())
    }

    /// The pose with this number, radians and metres, one value for each axis.
    pub fn pose(&self, index: u64) -> Vec<f64> {
        let mut pose = vec![0.0; self.axes.len()];
        self.pose_into(index, &mut pose);
        pose
    }

    /// Puts the pose with this number into `pose`, one value for each axis. Further values of `pose` stay as
    /// they are; a shorter `pose` takes the first values.
    pub fn pose_into(&self, index: u64, pose: &mut [f64]) {
        fill(&self.axes, index, pose);
    }
}

/// Puts the values of the axes at a mixed-radix number into `values`, the first axis fastest.
pub(crate) fn fill(axes: &[Axis], mut number: u64, values: &mut [f64]) {
    for (value, axis) in values.iter_mut().zip(axes) {
        *value = axis.value(number % axis.count);
        number /= axis.count;
    }
}
