//! What a design is judged by: one number of a mechanism.

use opm_analysis::Index;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_workspace::InscribedShape;
use std::fmt;

/// A number of a mechanism over the grid of a problem.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// The share of the grid's poses that are in reach and within limits.
    Grid,
    /// The share of its places that are in reach at any of its orientations.
    Reachable,
    /// The share of its places that are in reach at each of its orientations.
    Dexterous,
    /// The radius of the largest disc or ball of dexterous places, metres or radians.
    Inscribed(InscribedShape),
    /// The worst value of an index over all poses of the grid. A pose out of reach has the worst that there is: zero, or
    /// infinity where small values are good.
    Worst(Index),
    /// The width of the range of a joint over the poses in reach, metres or radians.
    Range(String),
    /// The lengths of all links at home together, metres.
    Size,
}

/// The prefix of the names of ranges.
const RANGE: &str = "range.";

impl Measure {
    /// The measure of a name; ranges have the names of joints behind `range.`.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "grid" => Self::Grid,
            "reachable" => Self::Reachable,
            "dexterous" => Self::Dexterous,
            "size" => Self::Size,
            _ => {
                if let Some(joint) = name.strip_prefix(RANGE) {
                    return Some(Self::Range(joint.to_owned()));
                }
                let shape = InscribedShape::from_name(name).filter(|s| *s != InscribedShape::Box);
                return shape
                    .map(Self::Inscribed)
                    .or_else(|| Index::from_name(name).map(Self::Worst));
            }
        })
    }

    /// The names of all measures, with those of the indices and joints that a manipulator has.
    pub fn names(manipulator: &Manipulator) -> Vec<String> {
        let setup = opm_analysis::Setup::new(manipulator.characteristic_length());
        let fixed = ["dexterous", "reachable", "grid", "disc", "ball", "size"].map(str::to_owned);
        let indices = Index::known(manipulator, &setup).into_iter().map(|i| i.name().to_owned());
        let joints = manipulator.imaginary().iter().map(|joint| &joint.name);
        let joints = joints.chain(manipulator.coordinates().iter().map(|joint| &joint.name));
        fixed
            .into_iter()
            .chain(indices)
            .chain(joints.map(|name| format!("{RANGE}{name}")))
            .collect()
    }

    /// Whether large values are good.
    pub fn large_is_good(&self) -> bool {
        match self {
            Self::Grid | Self::Reachable | Self::Dexterous | Self::Inscribed(_) => true,
            Self::Worst(index) => index.facts().large_is_good,
            Self::Range(_) | Self::Size => false,
        }
    }

    /// Whether it is a length or an angle; `None` for a number without such a unit. That of an inscribed shape is that of
    /// the places.
    pub fn quantity(&self, manipulator: &Manipulator) -> Option<Quantity> {
        match self {
            Self::Grid | Self::Reachable | Self::Dexterous => None,
            Self::Inscribed(_) => {
                let first = manipulator.place_coordinates().start;
                manipulator.task_coordinates().get(first).map(|coordinate| coordinate.quantity)
            }
            Self::Worst(index) => (index.facts().unit == "m").then_some(Quantity::Length),
            Self::Range(name) => {
                let imaginary = manipulator.imaginary().iter().find(|joint| joint.name == *name);
                let joint = || manipulator.coordinates().iter().find(|joint| joint.name == *name);
                imaginary.map(|i| i.quantity).or_else(|| joint().map(|joint| joint.quantity))
            }
            Self::Size => Some(Quantity::Length),
        }
    }

    /// The value for a mechanism that reaches nothing.
    pub(crate) fn nothing(&self) -> f64 {
        match self {
            Self::Worst(index) if !index.facts().large_is_good => f64::INFINITY,
            _ => 0.0,
        }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grid => f.write_str("grid"),
            Self::Reachable => f.write_str("reachable"),
            Self::Dexterous => f.write_str("dexterous"),
            Self::Inscribed(shape) => f.write_str(shape.name()),
            Self::Worst(index) => f.write_str(index.name()),
            Self::Range(joint) => write!(f, "{RANGE}{joint}"),
            Self::Size => f.write_str("size"),
        }
    }
}
