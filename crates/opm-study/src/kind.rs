//! Kinds of workspace: which grid each kind needs, and which points belong to it.

use opm_core::manipulator::Manipulator;
use opm_workspace::{Grid, Sections};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// What a workspace consists of: the terms of J.-P. Merlet (*Parallel Robots*, 2006), and each section
/// alone.
///
/// A *place* has a value for each coordinate of the lower section, an *orientation* one for each
/// coordinate of the upper section, and a *pose* has both. Where all legs move in one subspace, a place has
/// its lengths and an orientation its angles.
///
/// ```
/// use opm_study::WorkspaceKind;
///
/// let kind: WorkspaceKind = "dexterous".parse()?;
/// assert_eq!(kind, WorkspaceKind::Dexterous);
/// assert_eq!(kind.point_name(), "places");
/// # Ok::<(), opm_study::UnknownKind>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum WorkspaceKind {
    /// Poses in reach.
    #[default]
    Grid,
    /// Poses in reach, with one value for each coordinate of the orientation.
    ConstantOrientation,
    /// Poses in reach, with one value for each coordinate of the place.
    Orientation,
    /// Poses in reach in one working mode, divided into aspects: connected parts without a singularity.
    Aspects,
    /// Places that are in reach at one orientation of the grid or more.
    Reachable,
    /// Places that are in reach at every orientation of the grid.
    Dexterous,
    /// Orientations at which any place of the grid is in reach; the imaginary joints follow from them.
    Imaginary,
    /// Orientations at which the upper section alone closes.
    Upper,
    /// Places, and values of the imaginary joints, at which the lower section alone closes.
    Lower,
}

/// A part of a pose, which some kinds of workspace hold or vary by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PosePart {
    /// Where the platform is: [`Manipulator::place_coordinates`].
    Place,
    /// How it is turned, or in general all other coordinates: [`Manipulator::orientation_coordinates`].
    Orientation,
}

impl PosePart {
    /// The name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Place => "place",
            Self::Orientation => "orientation",
        }
    }
}

/// A name that is not one of a kind of workspace.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name:?} is not a kind of workspace, expected one of {}", kind_names())]
pub struct UnknownKind {
    /// The name that was given.
    pub name: String,
}

fn kind_names() -> String {
    WorkspaceKind::ALL.map(WorkspaceKind::name).join(", ")
}

impl WorkspaceKind {
    /// Every kind, in the order in which they are listed for people.
    pub const ALL: [Self; 9] = [
        Self::Grid,
        Self::ConstantOrientation,
        Self::Orientation,
        Self::Aspects,
        Self::Reachable,
        Self::Dexterous,
        Self::Imaginary,
        Self::Upper,
        Self::Lower,
    ];

    /// The name of a kind in requests and recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::ConstantOrientation => "constant-orientation",
            Self::Orientation => "orientation",
            Self::Aspects => "aspects",
            Self::Reachable => "reachable",
            Self::Dexterous => "dexterous",
            Self::Imaginary => "imaginary",
            Self::Upper => "upper",
            Self::Lower => "lower",
        }
    }

    /// One line for a list of kinds.
    pub fn description(self) -> &'static str {
        match self {
            Self::Grid => "Poses in reach",
            Self::ConstantOrientation => {
                "Poses in reach with the orientation's coordinates held, each at one value"
            }
            Self::Orientation => {
                "Poses in reach with the place's coordinates held, each at one value"
            }
            Self::Aspects => {
                "Poses in reach in one working mode, divided into connected parts without a singularity"
            }
            Self::Reachable => "Places in reach at some orientation of the grid",
            Self::Dexterous => "Places in reach at every orientation of the grid",
            Self::Imaginary => {
                "Values of the imaginary joints at orientations with some place in reach"
            }
            Self::Upper => "Orientations at which the upper section alone closes",
            Self::Lower => "Places and imaginary joints at which the lower section alone closes",
        }
    }

    /// The sections of the mechanism that have to close. The grid has their coordinates.
    pub fn sections(self) -> Sections {
        match self {
            Self::Upper => Sections::Upper,
            Self::Lower => Sections::Lower,
            Self::Grid
            | Self::ConstantOrientation
            | Self::Orientation
            | Self::Aspects
            | Self::Reachable
            | Self::Dexterous
            | Self::Imaginary => Sections::Whole,
        }
    }

    /// The part of a pose that the kind needs and that this mechanism does not have: no coordinate belongs to it,
    /// or all that do follow from the other part, so that it cannot be held or varied.
    pub fn missing_part(self, manipulator: &Manipulator) -> Option<PosePart> {
        let has = |part| match part {
            PosePart::Place => !manipulator.place_coordinates().is_empty(),
            PosePart::Orientation => !manipulator.orientation_coordinates().is_empty(),
        };
        let follows = |part| {
            let mut dependent = manipulator.dependent_coordinates().iter();
            !has(part) && dependent.any(|c| manipulator.is_of_place(c) == (part == PosePart::Place))
        };
        let (place, orientation) = match self {
            Self::ConstantOrientation | Self::Dexterous => {
                (has(PosePart::Place), !follows(PosePart::Orientation))
            }
            Self::Orientation => (!follows(PosePart::Place), has(PosePart::Orientation)),
            Self::Reachable => (has(PosePart::Place), true),
            Self::Grid | Self::Aspects | Self::Imaginary | Self::Upper | Self::Lower => {
                (true, true)
            }
        };
        match (place, orientation) {
            (false, _) => Some(PosePart::Place),
            (true, false) => Some(PosePart::Orientation),
            (true, true) => None,
        }
    }

    /// Whether its points are poses of the platform.
    pub fn is_of_poses(self) -> bool {
        matches!(self, Self::Grid | Self::ConstantOrientation | Self::Orientation | Self::Aspects)
    }

    /// Whether its points are places. The share of orientations in reach is then known for each.
    pub fn is_of_places(self) -> bool {
        matches!(self, Self::Reachable | Self::Dexterous)
    }

    /// Whether its points have a boundary. The orientations of `Imaginary` have one, but it says nothing
    /// about the imaginary joints.
    pub fn has_boundary(self) -> bool {
        self != Self::Imaginary
    }

    /// The number of orientations of the grid at which a point has to be reached to belong to the set; `None` if
    /// every point of the grid is decided on its own.
    pub fn required_visits(self, grid: &Grid) -> Option<u64> {
        match self {
            Self::Reachable | Self::Imaginary => Some(1),
            Self::Dexterous => Some(grid.orientation_count()),
            Self::Grid
            | Self::ConstantOrientation
            | Self::Orientation
            | Self::Aspects
            | Self::Upper
            | Self::Lower => None,
        }
    }

    /// Indices of the axes of a grid whose coordinates its points have.
    pub fn axes(self, grid: &Grid) -> Range<usize> {
        match self {
            Self::Reachable | Self::Dexterous => grid.places(),
            Self::Imaginary => grid.orientations(),
            Self::Grid
            | Self::ConstantOrientation
            | Self::Orientation
            | Self::Aspects
            | Self::Upper
            | Self::Lower => 0..grid.axes().len(),
        }
    }

    /// Indices of the axes that have a single value in a grid of this kind.
    pub fn held_axes(self, grid: &Grid) -> Range<usize> {
        match self {
            Self::ConstantOrientation => grid.orientations(),
            Self::Orientation => grid.places(),
            Self::Grid
            | Self::Aspects
            | Self::Reachable
            | Self::Dexterous
            | Self::Imaginary
            | Self::Upper
            | Self::Lower => 0..0,
        }
    }

    /// The name of its points, in the plural.
    pub fn point_name(self) -> &'static str {
        match self {
            Self::Reachable | Self::Dexterous => "places",
            Self::Imaginary | Self::Upper => "orientations",
            Self::Lower => "points",
            Self::Grid | Self::ConstantOrientation | Self::Orientation | Self::Aspects => "poses",
        }
    }

    /// The adjective for the points that belong to the set.
    pub fn member_name(self) -> &'static str {
        match self {
            Self::Upper | Self::Lower => "closing",
            Self::Dexterous => "dexterous",
            Self::Grid
            | Self::ConstantOrientation
            | Self::Orientation
            | Self::Aspects
            | Self::Reachable
            | Self::Imaginary => "reachable",
        }
    }

    /// The title of a text about it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Grid => "workspace",
            Self::ConstantOrientation => "constant-orientation workspace",
            Self::Orientation => "orientation workspace",
            Self::Aspects => "aspects",
            Self::Reachable => "reachable workspace",
            Self::Dexterous => "dexterous workspace",
            Self::Imaginary => "workspace of the imaginary joints",
            Self::Upper => "upper section alone",
            Self::Lower => "lower section alone",
        }
    }

    /// The sentence about an empty set; `limited` names what has a limit besides the joints.
    pub fn nothing(self, limited: &[&str]) -> String {
        let well = match limited {
            [] => " and within the limits".to_owned(),
            [others @ .., last] => {
                let names = [&["joints"], others].concat().join(", ");
                format!(" and within the limits of {names} and {last}")
            }
        };
        match self {
            Self::Dexterous => {
                format!("no place of the grid is in reach{well} at all of its orientations")
            }
            Self::Upper | Self::Lower => {
                "the section closes at no point of the grid within the limits".to_owned()
            }
            Self::Grid
            | Self::ConstantOrientation
            | Self::Orientation
            | Self::Aspects
            | Self::Reachable
            | Self::Imaginary => format!("no pose of the grid is in reach{well}"),
        }
    }
}

impl fmt::Display for WorkspaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for WorkspaceKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let known = Self::ALL.into_iter().find(|kind| kind.name() == name);
        known.ok_or_else(|| UnknownKind { name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example;
    use opm_workspace::Axis;

    #[test]
    fn names_are_read_back() {
        for kind in WorkspaceKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
            assert!(!kind.description().is_empty() && !kind.title().is_empty());
        }
        let error = "Grid".parse::<WorkspaceKind>().unwrap_err().to_string();
        assert!(error.starts_with("\"Grid\" is not a kind of workspace, expected one of grid, "));
    }

    /// These are the sets for which several slices decide together.
    #[test]
    fn a_dexterous_place_is_reached_in_every_slice_and_a_reachable_one_in_any() {
        let manipulator = example();
        let axes = vec![Axis::new("xi", -0.1, 0.1, 3), Axis::new("psi", -0.1, 0.1, 5)];
        let grid = Grid::new(&manipulator, axes).unwrap();
        assert_eq!(WorkspaceKind::Dexterous.required_visits(&grid), Some(15));
        assert_eq!(WorkspaceKind::Reachable.required_visits(&grid), Some(1));
        assert_eq!(WorkspaceKind::Imaginary.required_visits(&grid), Some(1));
        for kind in WorkspaceKind::ALL {
            let decided_alone = kind.is_of_poses() || kind.sections() != Sections::Whole;
            assert_eq!(kind.required_visits(&grid).is_none(), decided_alone, "{kind}");
        }
    }

    #[test]
    fn points_have_the_coordinates_of_their_kind() {
        let manipulator = example();
        let grid = Grid::new(&manipulator, vec![]).unwrap();
        assert_eq!(WorkspaceKind::Grid.axes(&grid), 0..5);
        assert_eq!(WorkspaceKind::Dexterous.axes(&grid), 0..2);
        assert_eq!(WorkspaceKind::Imaginary.axes(&grid), 2..5);
        assert_eq!(WorkspaceKind::ConstantOrientation.held_axes(&grid), 2..5);
        assert_eq!(WorkspaceKind::Orientation.held_axes(&grid), 0..2);
        assert!(WorkspaceKind::Reachable.held_axes(&grid).is_empty());
    }
}
