//! The domain of a measure: a range of every coordinate, and the weight of its parts.

use super::cell::Cell;
use super::coordinate_range::{CoordinateRange, RangeError};
use crate::grid::Sections;
use opm_core::Quantity;
use opm_core::enclosure::{BoxQuery, HalfTurn, MOST, Side};
use opm_core::group::SubspaceKind;
use opm_core::manipulator::{ImaginaryJoint, Manipulator};
use opm_core::numeric::number::readable;
use opm_core::task::CoordinateKind;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::RangeInclusive;

/// Most first boxes: a tilt has one for each half turn.
const MOST_PIECES: usize = 4096;

/// Measures that stay finite numbers in any units of length and angle.
const MEASURES: RangeInclusive<f64> = 1e-280..=1e280;

/// One coordinate of a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainAxis {
    /// The name of the coordinate.
    pub name: String,
    /// Whether it is an angle or a length.
    pub quantity: Quantity,
    /// The lowest value, radians or metres.
    pub min: f64,
    /// The highest value, radians or metres.
    pub max: f64,
    kind: SideKind,
}

/// How a coordinate becomes a side of a box.
#[derive(Clone, Debug, PartialEq)]
enum SideKind {
    /// The side is the coordinate itself.
    Plain,
    /// A tilt in a sphere, which is weighted by `|sin α|`, where `α` is the tilt plus `shift`; and the formula
    /// of that weight for people.
    Tilt { shift: f64, weight: &'static str },
    /// The value of an imaginary joint, of which the side is the displacement along the intersection motion.
    Imaginary(ImaginaryJoint),
}

impl DomainAxis {
    fn has_width(&self) -> bool {
        self.min < self.max
    }

    /// The formula of its weight, up to the sign, in which `home` stands for its value at home; `None` if the
    /// weight is one.
    pub fn weight(&self) -> Option<&'static str> {
        match self.kind {
            SideKind::Tilt { weight, .. } if self.has_width() => Some(weight),
            _ => None,
        }
    }

    /// The sides of its boxes: one, or for a tilt one for every half turn that the range meets.
    fn parts(&self) -> Vec<Side> {
        let (min, max) = (self.min, self.max);
        let plain = |[min, max]: [f64; 2]| {
            vec![Side { middle: 0.5 * (min + max), half: 0.5 * (max - min), half_turn: None }]
        };
        let shift = match &self.kind {
            SideKind::Tilt { shift, .. } if self.has_width() => *shift,
            SideKind::Plain | SideKind::Tilt { .. } => return plain([min, max]),
            SideKind::Imaginary(joint) => {
                let [from, to] = [min, max].map(|value| joint.displacement(value));
                return plain([from.min(to), from.max(to)]);
            }
        };
        let [from, to] = [min + shift, max + shift];
        let [first, last] = [from, to].map(|end| HalfTurn::of(end).number);
        (first..=last)
            .map(|number| {
                let half_turn = HalfTurn { number };
                let low = if number == first { half_turn.within(from) } else { 0.0 };
                let high = if number == last { half_turn.within(to) } else { PI };
                // The middle and half the width of -cos, which a narrow range would lose its digits in.
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                Side {
                    middle: -middle.cos() * half.cos(),
                    half: middle.sin() * half.sin(),
                    half_turn: Some(half_turn),
                }
            })
            .filter(|side| side.half > 0.0)
            .collect()
    }
}

/// Why ranges do not make a domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The upper section is asked for, but all legs move in one subspace.
    #[error("the mechanism has no upper section: all its legs move in one subspace")]
    NoUpperSection,
    /// A section alone is asked for, but its coordinates depend on those of the other one.
    #[error(
        "the sections of this mechanism have no measures of their own: its legs tie its coordinates together \
         (dependent: {})",
        dependent.join(", ")
    )]
    Dependent {
        /// The names of the dependent coordinates.
        dependent: Vec<&'static str>,
    },
    /// Several legs impose the same constraint.
    #[error(
        "there are no bounds for a mechanism in which several legs impose the same constraint: whether they agree is a \
         matter of a tolerance; a grid of its workspace can be counted"
    )]
    Repeated,
    /// A section alone is asked for, but legs are solved whole.
    #[error("the mechanism has no sections to measure alone: its legs are each solved by itself")]
    NoSections,
    /// Legs are solved whole, and their reach alone does not decide.
    #[error(
        "there are no bounds for a mechanism whose legs are each solved by itself, where coordinates of its pose depend on each \
         other or spherical joints are limited; a grid of its workspace can be counted"
    )]
    Whole,
    /// Joints have cones.
    #[error(
        "there are no bounds for a mechanism whose joints have cones; a grid of its workspace can be counted"
    )]
    Cones,
    /// Differences of joints have limits.
    #[error(
        "there are no bounds for a mechanism where differences of joints have limits ({name}); a grid of its workspace can be counted"
    )]
    Differences {
        /// The first difference.
        name: String,
    },
    /// The heights of legs depend on the imaginary joints.
    #[error(
        "there are no bounds for a mechanism whose sections share a translation that is inclined to the direction of \
         the height; a grid of its workspace can be counted"
    )]
    Inclined,
    /// A coordinate is unknown or repeated, or its ends are not finite numbers in their order.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The range of a tilt has too many half turns.
    #[error(
        "{name}: {} to {}, expected at most {MOST_PIECES} half turns",
        readable(*min),
        readable(*max)
    )]
    Turns {
        /// The name of the coordinate.
        name: String,
        /// The lowest value, as given.
        min: f64,
        /// The highest value, as given.
        max: f64,
    },
    /// The product of the ranges is too small or too large for double precision.
    #[error("the ranges have the measure {0:e}, out of the range of double precision")]
    Measure(f64),
    /// Too many coordinates have a range.
    #[error("{0} coordinates have a range, expected at most {MOST}, and one value for the others")]
    Axes(usize),
    /// There is not one share for each axis with a width.
    #[error("{found} shares, expected {expected}: one for each axis with a width")]
    Shares {
        /// The number of shares.
        found: usize,
        /// The number of axes with a width.
        expected: usize,
    },
}

/// The domain of a measure: a range or a value for every coordinate of a manipulator's pose, or of one
/// section alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    sections: Sections,
    axes: Vec<DomainAxis>,
    /// The numbers of the axes with a width.
    wide: Vec<usize>,
    /// The first boxes, each with one side for each axis.
    first: Vec<Vec<Side>>,
    whole: f64,
}

impl Domain {
    /// A domain over these ranges. A coordinate without a range stays at its home value.
    ///
    /// # Errors
    /// [`DomainError`]: a section that the mechanism does not have, unknown or repeated coordinates, ends that are not finite numbers or reversed, more
    /// than [`MOST`] ranges, or ranges whose product is out of the range of double precision.
    pub fn new(
        manipulator: &Manipulator,
        sections: Sections,
        given: &[CoordinateRange],
    ) -> Result<Self, DomainError> {
        let mut axes = axes(manipulator, sections);
        let one_subspace = manipulator.task().upper.kind == SubspaceKind::Identity;
        if axes.is_empty() && one_subspace {
            return Err(DomainError::NoUpperSection);
        }
        let dependent = manipulator.dependent_coordinates();
        if sections != Sections::Whole && !dependent.is_empty() {
            let dependent = dependent.iter().map(|c| c.name).collect();
            return Err(DomainError::Dependent { dependent });
        }
        if sections != Sections::Whole && manipulator.is_whole() {
            return Err(DomainError::NoSections);
        }
        if manipulator.has_cones() {
            return Err(DomainError::Cones);
        }
        if let Some(difference) = manipulator.differences().first() {
            return Err(DomainError::Differences { name: difference.name.clone() });
        }
        if !manipulator.has_enclosures() {
            let whole = manipulator.is_whole();
            return Err(if whole { DomainError::Whole } else { DomainError::Repeated });
        }
        if manipulator.task().shares_height() {
            return Err(DomainError::Inclined);
        }
        let ends = CoordinateRange::of_each(manipulator, sections, given)?;
        for (axis, [min, max]) in axes.iter_mut().zip(ends) {
            (axis.min, axis.max) = (min, max);
            if matches!(axis.kind, SideKind::Tilt { .. })
                && (max - min) / PI > (MOST_PIECES - 2) as f64
            {
                return Err(DomainError::Turns { name: axis.name.clone(), min, max });
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

    /// The sections that are measured.
    pub fn sections(&self) -> Sections {
        self.sections
    }

    /// The question about each box.
    pub(super) fn query(&self) -> BoxQuery {
        match self.sections {
            Sections::Whole => BoxQuery::Whole,
            Sections::Upper => BoxQuery::Upper,
            Sections::Lower => BoxQuery::Lower,
        }
    }

    /// The axes, in the order of the coordinates.
    pub fn axes(&self) -> &[DomainAxis] {
        &self.axes
    }

    /// The measure of the whole domain: the product of its ranges. The range of a tilt counts
    /// `∫ |sin xi| dxi`, `∫ |cos pitch| dpitch` or `∫ |cos(nu - home)| dnu`. It is one if no axis has a width.
    pub fn whole(&self) -> f64 {
        self.whole
    }

    /// The pose at these shares, from 0 to 1, of the axes with a width, in their order. Shares that are drawn
    /// evenly give poses that are even in the measure; for orientations that is Haar's. The pose has one
    /// value for each axis, radians and metres.
    ///
    /// # Errors
    /// [`DomainError::Shares`] if there is not one share for each axis with a width.
    pub fn pose(&self, shares: &[f64]) -> Result<Vec<f64>, DomainError> {
        if shares.len() != self.wide.len() {
            let (found, expected) = (shares.len(), self.wide.len());
            return Err(DomainError::Shares { found, expected });
        }
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
                let value = match (part.half_turn, &axis.kind) {
                    (Some(half_turn), SideKind::Tilt { shift, .. }) => {
                        half_turn.angle(part.middle - part.half + left) - shift
                    }
                    _ => axis.min + share * (axis.max - axis.min),
                };
                pose[number] = value.clamp(axis.min, axis.max);
                break;
            }
        }
        Ok(pose)
    }

    /// The number of axes with a width.
    pub fn dimension(&self) -> usize {
        self.wide.len()
    }

    /// The unit of the measure: the powers of a metre and of a radian.
    pub fn powers(&self) -> [(Quantity, usize); 2] {
        [Quantity::Length, Quantity::Angle].map(|quantity| {
            let axes = self.wide.iter().filter(|&&axis| self.axes[axis].quantity == quantity);
            (quantity, axes.count())
        })
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> {
        (0..self.first.len() as u32).map(Cell::new)
    }

    /// The sides of a cell, one for each axis.
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

    /// The number of an axis among those with a width.
    pub(super) fn wide_number(&self, axis: usize) -> Option<usize> {
        self.wide.iter().position(|&wide| wide == axis)
    }
}

/// The coordinates of what is measured, each at its home value.
fn axes(manipulator: &Manipulator, sections: Sections) -> Vec<DomainAxis> {
    let cuts = manipulator.reach().intersection_joints();
    let lower = manipulator.lower_coordinates();
    let kind = |number: usize, kind: Option<CoordinateKind>, home: f64| match kind {
        // In a domain of the lower section the values of the imaginary joints follow its coordinates.
        None => SideKind::Imaginary(cuts[number - lower].clone()),
        Some(CoordinateKind::Xi) => SideKind::Tilt { shift: 0.0, weight: "sin xi" },
        // The Euler angles are linear in tilt and torsion, with a determinant of one.
        Some(CoordinateKind::Tilt) => SideKind::Tilt { shift: 0.0, weight: "sin tilt" },
        Some(CoordinateKind::Pitch) => SideKind::Tilt { shift: FRAC_PI_2, weight: "cos pitch" },
        Some(CoordinateKind::Nu) => SideKind::Tilt {
            shift: FRAC_PI_2 - home,
            weight: if home == 0.0 { "cos nu" } else { "cos(nu - home)" },
        },
        Some(
            CoordinateKind::X
            | CoordinateKind::Y
            | CoordinateKind::Z
            | CoordinateKind::H
            | CoordinateKind::W
            | CoordinateKind::Theta
            | CoordinateKind::Phi
            | CoordinateKind::Zeta
            | CoordinateKind::Psi
            | CoordinateKind::Azimuth
            | CoordinateKind::Torsion
            | CoordinateKind::Roll
            | CoordinateKind::Yaw
            | CoordinateKind::Mu,
        ) => SideKind::Plain,
    };
    // An orientation of which a part follows from the rest has no measure of all orientations.
    let tied = |name: &str| is_tied(manipulator, name);
    let coordinates = sections.coordinates(manipulator).into_iter().enumerate();
    coordinates
        .map(|(number, c)| DomainAxis {
            kind: if tied(&c.name) { SideKind::Plain } else { kind(number, c.kind, c.home) },
            name: c.name,
            quantity: c.quantity,
            min: c.home,
            max: c.home,
        })
        .collect()
}

/// Whether coordinates of the section to which a coordinate belongs follow from others.
fn is_tied(manipulator: &Manipulator, name: &str) -> bool {
    let task = manipulator.task();
    let lower = |name: &str| {
        let number = task.coordinates.iter().position(|c| c.name == name);
        number.is_some_and(|number| number < task.lower_count)
    };
    let dependent = manipulator.dependent_coordinates();
    dependent.iter().any(|c| lower(c.name) == lower(name))
}
