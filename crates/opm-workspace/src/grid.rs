//! Grids of poses, or of what one section alone is asked for: one axis a coordinate, both ends on the
//! grid.

use opm_core::joint::Quantity;
use opm_core::manipulator::{ImaginaryJoint, LARGEST, Manipulator};
use opm_core::number::readable;
use std::f64::consts::TAU;

/// Most poses of a grid: indices beyond are not exact in double precision, which JSON readers use.
const MOST_POSES: u64 = 1 << 53;

/// An angle's values cover a whole turn if they do to within this, radians.
const WHOLE: f64 = 1e-9;

/// Equally spaced values of one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The coordinate's name.
    pub name: String,
    /// First value, radians or metres.
    pub min: f64,
    /// Last value, radians or metres.
    pub max: f64,
    /// Number of values, at least one.
    pub count: u64,
}

/// Why axes do not make a grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// No such coordinate.
    #[error("grid axis {name}: no such {}, expected one of {expected}", section.coordinate())]
    Unknown {
        /// As given.
        name: String,
        /// What the grid is of.
        section: Sections,
        /// Those that there are.
        expected: String,
    },
    /// One axis twice.
    #[error("grid axis {0}: given twice")]
    Twice(String),
    /// An end that is not a number, or the ends reversed.
    #[error(
        "grid axis {name}: {} to {}, expected {}",
        readable(*min),
        readable(*max),
        if min > max { "the smaller one first".to_owned() } else { format!("numbers up to {LARGEST:e}") }
    )]
    Range {
        /// The axis.
        name: String,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
    },
    /// A number of values that cannot hold both ends.
    #[error(
        "grid axis {name}: {count} values from {} to {}, expected {expected}",
        readable(*min),
        readable(*max)
    )]
    Count {
        /// The axis.
        name: String,
        /// As given.
        count: u64,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
        /// What would do.
        expected: &'static str,
    },
    /// Too many poses.
    #[error("grid of {given} poses, expected at most 2^53, some 9e15")]
    Size {
        /// As a number or a product.
        given: String,
    },
}

impl Axis {
    /// `count` values from `min` to `max`.
    pub fn new(name: impl Into<String>, min: f64, max: f64, count: u64) -> Self {
        Self { name: name.into(), min, max, count }
    }

    /// One value.
    pub fn fixed(name: impl Into<String>, value: f64) -> Self {
        Self::new(name, value, value, 1)
    }

    /// Value number `i`. Both ends are met exactly.
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

/// What a grid is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sections {
    /// Poses of the platform.
    Whole,
    /// `b`: the upper section alone.
    Upper,
    /// `v` and the cuts ([`Manipulator::cuts`]): the lower section alone.
    Lower,
}

impl Sections {
    /// What its coordinates are called.
    pub fn coordinate(self) -> &'static str {
        match self {
            Self::Whole => "task coordinate",
            Self::Upper => "task coordinate of the upper section",
            Self::Lower => "task coordinate of the lower section or imaginary joint",
        }
    }
}

/// What is known of a grid's coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Its name.
    pub name: String,
    /// Angle or length.
    pub quantity: Quantity,
    /// The value at home, radians or metres.
    pub home: f64,
    /// An angle of which whole turns matter: a helical joint follows them.
    pub counts_turns: bool,
}

impl Sections {
    /// The coordinates of grids of these sections, the lower section's first.
    pub fn coordinates(self, manipulator: &Manipulator) -> Vec<Coordinate> {
        let task = manipulator.task_coordinates().iter().map(|c| Coordinate {
            name: c.name.to_owned(),
            quantity: c.quantity,
            home: c.home,
            counts_turns: manipulator.counts_turns(c.name),
        });
        let lower = manipulator.task().lower_count;
        let cuts = || {
            manipulator.cuts().into_iter().map(|joint| Coordinate {
                name: joint.name,
                quantity: joint.quantity,
                home: joint.home,
                counts_turns: manipulator.cuts_count_turns(),
            })
        };
        match self {
            Self::Whole => task.collect(),
            Self::Upper => task.skip(lower).collect(),
            Self::Lower => task.take(lower).chain(cuts()).collect(),
        }
    }
}

/// One axis for every coordinate of a manipulator's pose, or of one section alone, in their order.
/// Poses are numbered with the first coordinate fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    coordinates: Vec<Coordinate>,
    sections: Sections,
    /// Of the lower section alone, what its axes after `v`'s are.
    cuts: Vec<ImaginaryJoint>,
    /// Number of coordinates that belong to a slice.
    lower: usize,
    poses: u64,
}

impl Grid {
    /// A grid over these axes; a task coordinate without one stays at its home value.
    ///
    /// # Errors
    /// Unknown or repeated axes, ends that are not numbers or reversed, counts that cannot hold
    /// both ends, more than 2^53 poses.
    pub fn new(manipulator: &Manipulator, given: Vec<Axis>) -> Result<Self, GridError> {
        Self::of(Sections::Whole, manipulator, given)
    }

    /// The same of one section alone. A pose of it is a value for each of its coordinates: see
    /// [`Sections::coordinates`].
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
        for axis in given {
            let Some(number) = coordinates.iter().position(|c| c.name == axis.name) else {
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
            Sections::Whole | Sections::Lower => manipulator.task().lower_count,
            Sections::Upper => 0,
        };
        let cuts = match sections {
            Sections::Lower => manipulator.cuts(),
            Sections::Whole | Sections::Upper => vec![],
        };
        match poses {
            Some(poses) if poses <= MOST_POSES => {
                Ok(Self { axes, coordinates, sections, cuts, lower, poses })
            }
            _ => {
                let counts: Vec<_> = axes.iter().map(|axis| axis.count.to_string()).collect();
                Err(GridError::Size { given: counts.join(" x ") })
            }
        }
    }

    /// What it is a grid of.
    pub fn sections(&self) -> Sections {
        self.sections
    }

    /// What its axes are values of, in their order.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Whether the values of axis number `axis` come full circle: the first and the last are the same
    /// place, or a step from one another.
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

    /// Number of poses.
    pub fn poses(&self) -> u64 {
        self.poses
    }

    /// Poses of a row: they differ in the first coordinate alone. In a grid of the upper section alone
    /// every pose is a row, and a slice.
    pub fn row(&self) -> u64 {
        if self.lower == 0 { 1 } else { self.axes[0].count }
    }

    /// The displacement along the intersection motion that a leg has in the slice of the lower section
    /// alone with these values of its cuts.
    pub(crate) fn cut(&self, leg: usize, values: &[f64]) -> f64 {
        let cut = self.cuts.iter().zip(values).find(|(cut, _)| cut.leg == leg);
        cut.map_or(0.0, |(cut, value)| cut.displacement(*value))
    }

    /// Number of slices: sets of poses that share all coordinates of the upper section, or all cuts.
    pub fn slices(&self) -> u64 {
        self.axes[self.lower..].iter().map(|axis| axis.count).product()
    }

    /// Number of the lower section's task coordinates: those that vary within a slice. None in a grid
    /// of the upper section alone.
    pub fn lower(&self) -> usize {
        self.lower
    }

    /// The pose with this number.
    pub fn pose(&self, index: u64) -> Vec<f64> {
        let mut pose = vec![0.0; self.axes.len()];
        self.pose_into(index, &mut pose);
        pose
    }

    /// Puts the pose with this number, a value an axis, into `pose`.
    pub fn pose_into(&self, index: u64, pose: &mut [f64]) {
        fill(&self.axes, index, pose);
    }
}

/// Values of the axes at a mixed-radix number, the first axis fastest.
pub(crate) fn fill(axes: &[Axis], mut number: u64, values: &mut [f64]) {
    for (value, axis) in values.iter_mut().zip(axes) {
        *value = axis.value(number % axis.count);
        number /= axis.count;
    }
}
