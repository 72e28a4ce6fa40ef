//! What is measured: a range of every coordinate, and what a part of it weighs.

use super::cell::Cell;
use opm_core::enclosure::{Asked, MOST, Piece, Side};
use opm_core::joint::Quantity;
use opm_core::manipulator::{LARGEST, Manipulator};
use std::f64::consts::{FRAC_PI_2, PI};

/// Most first boxes: half turns of tilts.
const MOST_PIECES: usize = 4096;

/// A range of one coordinate, as it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Over {
    /// The coordinate's name.
    pub name: String,
    /// Lowest value, radians or metres.
    pub min: f64,
    /// Highest value, radians or metres; the same where the coordinate has one value.
    pub max: f64,
}

impl Over {
    /// From `min` to `max`.
    pub fn new(name: impl Into<String>, min: f64, max: f64) -> Self {
        Self { name: name.into(), min, max }
    }
}

/// One coordinate of a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainAxis {
    /// The coordinate's name.
    pub name: String,
    /// Angle or length.
    pub quantity: Quantity,
    /// Lowest value, radians or metres.
    pub min: f64,
    /// Highest value, radians or metres.
    pub max: f64,
    /// Of a tilt in a sphere: what to add to it for the angle `α` by whose `|sin α|` it is weighed.
    tilt: Option<f64>,
}

impl DomainAxis {
    fn has_width(&self) -> bool {
        self.min < self.max
    }

    /// The name of what it is weighed by, where that is not one.
    pub fn weight(&self) -> Option<&'static str> {
        let tilt = self.tilt.filter(|_| self.has_width())?;
        Some(if tilt == 0.0 { "sin xi" } else { "cos nu" })
    }

    /// Its parts: a middle, how far the ends are from it, and which half turn it is of.
    fn parts(&self) -> Vec<(Side, f64)> {
        let (min, max) = (self.min, self.max);
        let Some(tilt) = self.tilt.filter(|_| self.has_width()) else {
            let side = Side { middle: 0.5 * (min + max), half: 0.5 * (max - min), piece: None };
            return vec![(side, max - min)];
        };
        let [from, to] = [min + tilt, max + tilt];
        let last = Piece::of(to).number;
        (Piece::of(from).number..=last)
            .map(|number| {
                let piece = Piece { number };
                let low =
                    if number == Piece::of(from).number { piece.from_angle(from) } else { -1.0 };
                let high = if number == last { piece.from_angle(to) } else { 1.0 };
                let half = 0.5 * (high - low);
                (Side { middle: 0.5 * (low + high), half, piece: Some(piece) }, 2.0 * half)
            })
            .filter(|(side, _)| side.half > 0.0)
            .collect()
    }
}

/// Why ranges do not make a domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// No such coordinate.
    #[error("no coordinate {name}, expected one of {expected}")]
    Unknown {
        /// As given.
        name: String,
        /// Those that there are.
        expected: String,
    },
    /// One coordinate twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// An end that is not a number, or the ends reversed.
    #[error("{name}: {min} to {max}, expected numbers up to {LARGEST:e}, the smaller one first")]
    Range {
        /// The coordinate.
        name: String,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
    },
    /// A tilt over too many turns.
    #[error("{name}: {min} to {max}, expected at most {MOST_PIECES} half turns")]
    Turns {
        /// The coordinate.
        name: String,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
    },
    /// Too many coordinates with a range.
    #[error("{0} coordinates have a range, expected at most {MOST}, and one value for the others")]
    Axes(usize),
}

/// A range or a value for every coordinate of a manipulator's pose, or of one section alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    asked: Asked,
    axes: Vec<DomainAxis>,
    /// Numbers of the axes with a width.
    wide: Vec<usize>,
    /// The first boxes: a side an axis.
    first: Vec<Vec<Side>>,
    whole: f64,
}

impl Domain {
    /// A domain over these ranges; a coordinate without one stays at its home value.
    ///
    /// # Errors
    /// Unknown or repeated coordinates, ends that are not numbers or reversed, more than [`MOST`] ranges.
    pub fn new(
        manipulator: &Manipulator,
        asked: Asked,
        given: &[Over],
    ) -> Result<Self, DomainError> {
        let mut axes = axes(manipulator, asked);
        let mut seen = vec![false; axes.len()];
        for Over { name, min, max } in given {
            let Some(number) = axes.iter().position(|axis| axis.name == *name) else {
                let names: Vec<_> = axes.iter().map(|axis| &*axis.name).collect();
                let expected = names.join(", ");
                return Err(DomainError::Unknown { name: name.clone(), expected });
            };
            if std::mem::replace(&mut seen[number], true) {
                return Err(DomainError::Twice(name.clone()));
            }
            let (name, min, max) = (name.clone(), *min, *max);
            if !(min <= max && min.abs().max(max.abs()) <= LARGEST) {
                return Err(DomainError::Range { name, min, max });
            }
            let axis = &mut axes[number];
            (axis.min, axis.max) = (min, max);
            if axis.tilt.is_some() && (max - min) / PI > (MOST_PIECES - 2) as f64 {
                return Err(DomainError::Turns { name, min, max });
            }
        }
        let wide: Vec<usize> = (0..axes.len()).filter(|&i| axes[i].has_width()).collect();
        if wide.len() > MOST {
            return Err(DomainError::Axes(wide.len()));
        }
        let mut first = vec![vec![]];
        let mut whole = 1.0;
        for axis in &axes {
            let parts = axis.parts();
            if axis.has_width() {
                whole *= parts.iter().map(|(_, width)| width).sum::<f64>();
            }
            first = first
                .iter()
                .flat_map(|sides| {
                    parts.iter().map(move |(part, _)| [&sides[..], &[*part]].concat())
                })
                .collect();
        }
        Ok(Self { asked, axes, wide, first, whole })
    }

    /// What is asked of its poses.
    pub fn asked(&self) -> Asked {
        self.asked
    }

    /// Its axes, in the order of the coordinates.
    pub fn axes(&self) -> &[DomainAxis] {
        &self.axes
    }

    /// Its own measure, the product of its ranges; of a tilt `∫ |sin xi| dxi` or `∫ |cos nu| dnu`. One where
    /// no axis has a width.
    pub fn whole(&self) -> f64 {
        self.whole
    }

    /// The pose at these shares, from 0 to 1, of the axes with a width, in their order: drawn evenly, they
    /// give poses that are even in the measure, of orientations Haar's. In the order of the axes.
    ///
    /// # Panics
    /// If there is another number of shares than axes with a width.
    pub fn pose(&self, shares: &[f64]) -> Vec<f64> {
        assert_eq!(shares.len(), self.wide.len(), "a share for every axis with a width");
        let mut pose: Vec<f64> = self.axes.iter().map(|axis| axis.min).collect();
        for (&axis, &share) in self.wide.iter().zip(shares) {
            let DomainAxis { min, max, tilt, .. } = self.axes[axis];
            let parts = self.axes[axis].parts();
            let mut left = share * parts.iter().map(|(_, width)| width).sum::<f64>();
            let mut parts = parts.into_iter().peekable();
            while let Some((side, width)) = parts.next() {
                if left > width && parts.peek().is_some() {
                    left -= width;
                    continue;
                }
                let at = side.middle - side.half + left;
                let value = match (side.piece, tilt) {
                    (Some(piece), Some(tilt)) => piece.angle(at) - tilt,
                    _ => at,
                };
                pose[axis] = value.clamp(min, max);
                break;
            }
        }
        pose
    }

    /// Number of axes with a width.
    pub fn dimension(&self) -> usize {
        self.wide.len()
    }

    /// What measures are in: powers of a metre and of a radian.
    pub fn powers(&self) -> [(Quantity, usize); 2] {
        [Quantity::Length, Quantity::Angle].map(|quantity| {
            let axes = self.wide.iter().filter(|&&axis| self.axes[axis].quantity == quantity);
            (quantity, axes.count())
        })
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> {
        (0..self.first.len() as u32).map(Cell::new)
    }

    /// The sides of a cell, a side an axis.
    pub(super) fn sides(&self, cell: &Cell) -> Vec<Side> {
        let mut sides = self.first[cell.first as usize].clone();
        for (number, &axis) in self.wide.iter().enumerate() {
            let side = &mut sides[axis];
            let [middle, half] = cell.part(number);
            side.middle += side.half * (2.0 * middle - 1.0);
            side.half *= 2.0 * half;
        }
        sides
    }

    /// The measure of a cell.
    pub(super) fn size(&self, cell: &Cell) -> f64 {
        let first = &self.first[cell.first as usize];
        let sides = self.wide.iter().enumerate();
        sides.map(|(number, &axis)| 4.0 * first[axis].half * cell.part(number)[1]).product()
    }

    /// The number among the axes with a width.
    pub(super) fn wide_number(&self, axis: usize) -> Option<usize> {
        self.wide.iter().position(|&wide| wide == axis)
    }
}

/// The coordinates that are asked for, each at its home value.
fn axes(manipulator: &Manipulator, asked: Asked) -> Vec<DomainAxis> {
    let lower = manipulator.task().lower_count;
    let task = manipulator.task_coordinates().iter().map(|c| DomainAxis {
        name: c.name.to_owned(),
        quantity: c.quantity,
        min: c.home,
        max: c.home,
        tilt: match c.name {
            "xi" => Some(0.0),
            "nu" => Some(FRAC_PI_2 - c.home),
            _ => None,
        },
    });
    match asked {
        Asked::Whole => task.collect(),
        Asked::Upper => task.skip(lower).collect(),
        Asked::Lower => task.take(lower).collect(),
    }
}
