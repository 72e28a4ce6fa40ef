//! What is measured: a range of every coordinate, and what a part of it weighs.

use super::cell::Cell;
use crate::grid::Sections;
use opm_core::enclosure::{Asked, MOST, Piece, Side};
use opm_core::joint::Quantity;
use opm_core::manipulator::{ImaginaryJoint, LARGEST, Manipulator};
use opm_core::number::readable;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::RangeInclusive;

/// Most first boxes: half turns of tilts.
const MOST_PIECES: usize = 4096;

/// Measures that are numbers in any units of length and angle, too.
const MEASURES: RangeInclusive<f64> = 1e-280..=1e280;

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
    kind: Kind,
}

/// How a coordinate enters a box.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// As it is.
    Plain,
    /// A tilt in a sphere, which is weighed by `|sin α|`, where `α` is the tilt plus this.
    Tilt(f64),
    /// The value of an imaginary joint: as its displacement along the intersection motion.
    Cut(ImaginaryJoint),
}

impl DomainAxis {
    fn has_width(&self) -> bool {
        self.min < self.max
    }

    /// What it is weighed by, up to its sign, where that is not one: `home` stands for its value at home.
    pub fn weight(&self) -> Option<&'static str> {
        match self.kind {
            Kind::Tilt(shift) if self.has_width() => Some(match &*self.name {
                "xi" => "sin xi",
                _ if shift == FRAC_PI_2 => "cos nu",
                _ => "cos(nu - home)",
            }),
            _ => None,
        }
    }

    /// Its parts: one, or of a tilt one for every half turn that it is on.
    fn parts(&self) -> Vec<Side> {
        let (min, max) = (self.min, self.max);
        let plain = |[min, max]: [f64; 2]| {
            vec![Side { middle: 0.5 * (min + max), half: 0.5 * (max - min), piece: None }]
        };
        let shift = match &self.kind {
            Kind::Tilt(shift) if self.has_width() => *shift,
            Kind::Plain | Kind::Tilt(_) => return plain([min, max]),
            Kind::Cut(joint) => {
                let [from, to] = [min, max].map(|value| joint.displacement(value));
                return plain([from.min(to), from.max(to)]);
            }
        };
        let [from, to] = [min + shift, max + shift];
        let [first, last] = [from, to].map(|end| Piece::of(end).number);
        (first..=last)
            .map(|number| {
                let piece = Piece { number };
                let low = if number == first { piece.within(from) } else { 0.0 };
                let high = if number == last { piece.within(to) } else { PI };
                // The middle and half the width of -cos, which a narrow range would lose its digits in.
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                Side {
                    middle: -middle.cos() * half.cos(),
                    half: middle.sin() * half.sin(),
                    piece: Some(piece),
                }
            })
            .filter(|side| side.half > 0.0)
            .collect()
    }
}

/// Why ranges do not make a domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// No such coordinate.
    #[error("no {} {name}, expected one of {expected}", sections.coordinate())]
    Unknown {
        /// As given.
        name: String,
        /// What is measured.
        sections: Sections,
        /// Those that there are.
        expected: String,
    },
    /// One coordinate twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// An end that is not a number, or the ends reversed.
    #[error(
        "{name}: {} to {}, expected numbers up to {LARGEST:e}, the smaller one first",
        readable(*min),
        readable(*max)
    )]
    Range {
        /// The coordinate.
        name: String,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
    },
    /// A tilt over too many turns.
    #[error(
        "{name}: {} to {}, expected at most {MOST_PIECES} half turns",
        readable(*min),
        readable(*max)
    )]
    Turns {
        /// The coordinate.
        name: String,
        /// As given.
        min: f64,
        /// As given.
        max: f64,
    },
    /// Ranges whose product is no number of double precision.
    #[error("the ranges have the measure {0:e}, out of the range of double precision")]
    Measure(f64),
    /// Too many coordinates with a range.
    #[error("{0} coordinates have a range, expected at most {MOST}, and one value for the others")]
    Axes(usize),
}

/// A range or a value for every coordinate of a manipulator's pose, or of one section alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    sections: Sections,
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
    /// Unknown or repeated coordinates, ends that are not numbers or reversed, more than [`MOST`] ranges,
    /// or ranges whose product is no number of double precision.
    pub fn new(
        manipulator: &Manipulator,
        sections: Sections,
        given: &[Over],
    ) -> Result<Self, DomainError> {
        let mut axes = axes(manipulator, sections);
        let mut seen = vec![false; axes.len()];
        for Over { name, min, max } in given {
            let Some(number) = axes.iter().position(|axis| axis.name == *name) else {
                let names: Vec<_> = axes.iter().map(|axis| &*axis.name).collect();
                let expected = names.join(", ");
                return Err(DomainError::Unknown { name: name.clone(), sections, expected });
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
            if matches!(axis.kind, Kind::Tilt(_)) && (max - min) / PI > (MOST_PIECES - 2) as f64 {
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
                whole *= parts.iter().map(|part| 2.0 * part.half).sum::<f64>();
            }
            first = first
                .iter()
                .flat_map(|sides| parts.iter().map(move |part| [&sides[..], &[*part]].concat()))
                .collect();
        }
        if !MEASURES.contains(&whole) {
            return Err(DomainError::Measure(whole));
        }
        Ok(Self { sections, axes, wide, first, whole })
    }

    /// What is measured.
    pub fn sections(&self) -> Sections {
        self.sections
    }

    pub(super) fn asked(&self) -> Asked {
        match self.sections {
            Sections::Whole => Asked::Whole,
            Sections::Upper => Asked::Upper,
            Sections::Lower => Asked::Lower,
        }
    }

    /// Its axes, in the order of the coordinates.
    pub fn axes(&self) -> &[DomainAxis] {
        &self.axes
    }

    /// Its own measure, the product of its ranges; of a tilt `∫ |sin xi| dxi` or
    /// `∫ |cos(nu - home)| dnu`. One where no axis has a width.
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
        for (&number, &share) in self.wide.iter().zip(shares) {
            let axis = &self.axes[number];
            let parts = axis.parts();
            let mut left = share * parts.iter().map(|part| 2.0 * part.half).sum::<f64>();
            let mut parts = parts.into_iter().peekable();
            while let Some(part) = parts.next() {
                if left > 2.0 * part.half && parts.peek().is_some() {
                    left -= 2.0 * part.half;
                    continue;
                }
                let value = match (part.piece, &axis.kind) {
                    (Some(piece), Kind::Tilt(shift)) => {
                        piece.angle(part.middle - part.half + left) - shift
                    }
                    _ => axis.min + share * (axis.max - axis.min),
                };
                pose[number] = value.clamp(axis.min, axis.max);
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

/// The coordinates of what is measured, each at its home value.
fn axes(manipulator: &Manipulator, sections: Sections) -> Vec<DomainAxis> {
    let cuts = manipulator.cuts();
    let lower = manipulator.task().lower_count;
    let kind = |number: usize, name: &str, home: f64| match name {
        _ if sections == Sections::Lower && number >= lower => {
            Kind::Cut(cuts[number - lower].clone())
        }
        "xi" => Kind::Tilt(0.0),
        "nu" => Kind::Tilt(FRAC_PI_2 - home),
        _ => Kind::Plain,
    };
    let coordinates = sections.coordinates(manipulator).into_iter().enumerate();
    coordinates
        .map(|(number, c)| DomainAxis {
            kind: kind(number, &c.name, c.home),
            name: c.name,
            quantity: c.quantity,
            min: c.home,
            max: c.home,
        })
        .collect()
}
