//! Grids of poses: one axis a task coordinate, both ends on the grid.

use opm_core::manipulator::{LARGEST, Manipulator};

/// Most poses of a grid: indices beyond are not exact in double precision, which JSON readers use.
const MOST_POSES: u64 = 1 << 53;

/// Equally spaced values of one task coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The task coordinate's name.
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
    /// No such task coordinate.
    #[error("grid axis {name}: no such task coordinate, expected one of {expected}")]
    Unknown {
        /// As given.
        name: String,
        /// Those that there are.
        expected: String,
    },
    /// One axis twice.
    #[error("grid axis {0}: given twice")]
    Twice(String),
    /// An end that is not a number, or the ends reversed.
    #[error(
        "grid axis {name}: {min} to {max}, expected numbers up to {LARGEST:e}, the smaller one first"
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
    #[error("grid axis {name}: {count} values from {min} to {max}, expected {expected}")]
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
    #[error("grid of {given} poses, expected at most {MOST_POSES} (2^53)")]
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

/// One axis for every task coordinate of a manipulator, in their order. Poses are numbered with the
/// first coordinate fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    /// Number of coordinates that belong to the lower section.
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
        let coordinates = manipulator.task_coordinates();
        let mut axes: Vec<Option<Axis>> = vec![None; coordinates.len()];
        for axis in given {
            let Some(number) = coordinates.iter().position(|c| c.name == axis.name) else {
                let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
                return Err(GridError::Unknown { name: axis.name, expected: names.join(", ") });
            };
            axis.check()?;
            if axes[number].is_some() {
                return Err(GridError::Twice(axis.name));
            }
            axes[number] = Some(axis);
        }
        let axes: Vec<Axis> = axes
            .into_iter()
            .zip(coordinates)
            .map(|(axis, c)| axis.unwrap_or_else(|| Axis::fixed(c.name, c.home)))
            .collect();
        let poses = axes.iter().try_fold(1_u64, |poses, axis| poses.checked_mul(axis.count));
        match poses {
            Some(poses) if poses <= MOST_POSES => {
                Ok(Self { axes, lower: manipulator.task().lower_count, poses })
            }
            _ => {
                let counts: Vec<_> = axes.iter().map(|axis| axis.count.to_string()).collect();
                Err(GridError::Size { given: counts.join(" x ") })
            }
        }
    }

    /// The axes, in the order of the task coordinates.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Number of poses.
    pub fn poses(&self) -> u64 {
        self.poses
    }

    /// Number of slices: sets of poses that share all coordinates of the upper section.
    pub fn slices(&self) -> u64 {
        self.axes[self.lower..].iter().map(|axis| axis.count).product()
    }

    /// Number of coordinates that belong to the lower section: those that vary within a slice.
    pub fn lower(&self) -> usize {
        self.lower
    }

    /// The pose with this number.
    pub fn pose(&self, index: u64) -> Vec<f64> {
        let mut pose = vec![0.0; self.axes.len()];
        fill(&self.axes, index, &mut pose);
        pose
    }
}

/// Values of the axes at a mixed-radix number, the first axis fastest.
pub(crate) fn fill(axes: &[Axis], mut number: u64, values: &mut [f64]) {
    for (value, axis) in values.iter_mut().zip(axes) {
        *value = axis.value(number % axis.count);
        number /= axis.count;
    }
}
