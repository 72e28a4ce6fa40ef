//! The values that a recording stores with every point: those that exist, those that are requested, and
//! those that suit the workspace.

use crate::error::{RequestError, RequestOption};
use crate::kind::WorkspaceKind;
use crate::names::{ASPECT, INVERSE_CONDITION, NO_AXIS, SHARE, TIP};
use opm_analysis::{Index, Setup};
use opm_core::manipulator::Manipulator;
use opm_core::task::CoordinateKind;
use opm_workspace::{Axis, Grid, GridSet};

/// The position of a point in every cloud.
const POSITION_FIELDS: [&str; 3] = ["x", "y", "z"];
/// The colour of a point in every cloud.
const COLOR_FIELDS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// One value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// A coordinate, by its number among the axes of the points.
    Coordinate(usize),
    /// An imaginary joint.
    Imaginary(usize),
    /// An actuated joint.
    Actuated(usize),
    /// The position of the platform's reference point: x, y or z.
    Tip(usize),
    /// One over the condition number.
    InverseCondition,
    /// An index of the pose.
    Index(Index),
    /// The effort of an actuated joint under the load or, by larger numbers, of an imaginary one.
    Effort(usize),
    /// The share of the orientations that reach a place.
    Share,
    /// The number of the aspect that a pose is in, 0 for a singular one.
    Aspect,
    /// Zero.
    Zero,
}

/// A value of a point with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedColumn {
    /// The name.
    pub name: String,
    /// The value.
    pub column: Column,
}

impl NamedColumn {
    fn new(name: &str, column: Column) -> Self {
        Self { name: name.to_owned(), column }
    }
}

/// How the axes of a cloud are scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// Axes of another quantity than the first are multiplied, so that the extents are comparable.
    #[default]
    Comparable,
    /// Metres and radians, as they are.
    None,
}

impl AxisScale {
    /// All of them, with their names.
    pub const NAMED: [(&'static str, Self); 2] =
        [("comparable", Self::Comparable), ("none", Self::None)];

    /// The scale of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMED.into_iter().find(|named| named.0 == name).map(|named| named.1)
    }
}

/// The values of the points that are requested, by name. Defaults suit the workspace.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PointOptions {
    /// The three values that are x, y and z of a point, or [`TIP`]; empty if not given.
    pub axes: Vec<String>,
    /// Further values that are stored.
    pub scalars: Option<Vec<String>>,
    /// The value that the colour shows.
    pub color: Option<String>,
    /// How x, y and z are scaled in a recording; tables have the values themselves.
    pub scale: AxisScale,
}

/// Requested values, checked: the points of the kind of workspace have them.
#[derive(Clone, Debug)]
pub struct PointChoice {
    kind: WorkspaceKind,
    known: Vec<NamedColumn>,
    axes: Option<[NamedColumn; 3]>,
    scalars: Option<Vec<NamedColumn>>,
    color: Option<NamedColumn>,
    scale: AxisScale,
}

impl PointOptions {
    /// Finds the values by their names.
    ///
    /// # Errors
    /// A name is unknown or not allowed for a scalar, or the number of axes is not three.
    pub fn choose(
        &self,
        kind: WorkspaceKind,
        manipulator: &Manipulator,
        setup: &Setup,
    ) -> Result<PointChoice, RequestError> {
        let known = known(kind, manipulator, setup);
        let find = |name: &String, option| {
            let found = known.iter().find(|column| column.name == *name).cloned();
            if found.is_none() {
                refuse_following(name, manipulator, option)?;
                if kind.is_of_poses() {
                    refuse_absent(name, manipulator, setup, option)?;
                }
            }
            found.ok_or_else(|| RequestError::UnknownColumn {
                option,
                name: name.clone(),
                kind,
                known: known.iter().map(|column| column.name.clone()).collect(),
            })
        };
        let color = self.color.as_ref().map(|name| find(name, RequestOption::Color)).transpose()?;
        let scalars = self.scalars.as_ref().map(|names| -> Result<Vec<_>, RequestError> {
            names.iter().map(|name| find(name, RequestOption::Scalars)).collect()
        });
        let scalars = scalars.transpose()?;
        for (number, NamedColumn { name, .. }) in scalars.iter().flatten().enumerate() {
            if is_field(name) {
                return Err(RequestError::ReservedField { name: name.clone() });
            }
            if scalars.iter().flatten().take(number).any(|earlier| earlier.name == *name) {
                return Err(RequestError::RepeatedScalar { name: name.clone() });
            }
        }
        let axis = |name: &String| match kind.is_of_poses() {
            true => task_coordinate(name, manipulator),
            false => find(name, RequestOption::Axes),
        };
        let axes = match &self.axes[..] {
            [] => None,
            [one] if one == TIP && kind.is_of_poses() => Some(std::array::from_fn(|i| {
                NamedColumn::new(&format!("{TIP}.{}", POSITION_FIELDS[i]), Column::Tip(i))
            })),
            [a, b, c] if a != b && b != c && a != c => Some([axis(a)?, axis(b)?, axis(c)?]),
            given => return Err(RequestError::CloudAxes { given: given.to_vec(), kind }),
        };
        Ok(PointChoice { kind, known, axes, scalars, color, scale: self.scale })
    }
}

impl PointChoice {
    /// Whether one of the values depends on the characteristic length: a condition number, or an index.
    pub fn has_length(&self) -> bool {
        let mut asked = self.scalars.iter().flatten().chain(&self.color);
        asked.any(|named| matches!(named.column, Column::InverseCondition | Column::Index(_)))
    }

    /// Whether one of the values is an index of some kind.
    pub fn has_index(&self, test: fn(Index) -> bool) -> bool {
        let mut asked = self.scalars.iter().flatten().chain(&self.color);
        asked.any(|named| matches!(named.column, Column::Index(index) if test(index)))
    }

    /// Whether one of the values is the effort of a joint.
    pub fn has_efforts(&self) -> bool {
        let mut asked = self.scalars.iter().flatten().chain(&self.color);
        asked.any(|named| matches!(named.column, Column::Effort(_)))
    }
}

/// Refuses the name of a dependent coordinate, which points do not have.
fn refuse_following(
    name: &str,
    manipulator: &Manipulator,
    option: RequestOption,
) -> Result<(), RequestError> {
    let refused = manipulator.refuse_following(name);
    refused.map_err(|follows| RequestError::Follows { option, follows })
}

/// Refuses an index that the manipulator does not have, and an effort without a load.
fn refuse_absent(
    name: &str,
    manipulator: &Manipulator,
    setup: &Setup,
    option: RequestOption,
) -> Result<(), RequestError> {
    if let Some(index) = Index::from_name(name) {
        let absent = |error| RequestError::ColumnIndex { option, error };
        return index.check(manipulator, setup).map_err(absent);
    }
    match !setup.has_load() && efforts(manipulator).any(|known| known == name) {
        true => Err(RequestError::NoLoad { option, name: name.to_owned() }),
        false => Ok(()),
    }
}

/// The names of the efforts of the actuated, then of the imaginary joints.
pub fn efforts(manipulator: &Manipulator) -> impl Iterator<Item = String> + '_ {
    let all = manipulator.coordinates();
    let actuated = manipulator.actuated().iter().map(|&number| &*all[number].name);
    let imaginary = manipulator.imaginary().iter().map(|joint| &*joint.name);
    actuated.chain(imaginary).map(|name| format!("effort.{name}"))
}

/// An axis of a cloud of poses.
fn task_coordinate(name: &str, manipulator: &Manipulator) -> Result<NamedColumn, RequestError> {
    let coordinates = manipulator.task_coordinates();
    let number = coordinates.iter().position(|c| c.name == name);
    if number.is_none() {
        refuse_following(name, manipulator, RequestOption::Axes)?;
    }
    let number = number.ok_or_else(|| RequestError::UnknownCoordinate {
        name: name.to_owned(),
        known: coordinates.iter().map(|c| c.name.to_owned()).collect(),
    })?;
    Ok(NamedColumn::new(name, Column::Coordinate(number)))
}

/// Every value that the points of a kind of workspace have.
fn known(kind: WorkspaceKind, manipulator: &Manipulator, setup: &Setup) -> Vec<NamedColumn> {
    let places = manipulator.place_coordinates();
    let coordinates = kind.sections().coordinates(manipulator).into_iter().enumerate();
    let mut known: Vec<NamedColumn> = coordinates
        .filter(|(i, _)| match kind {
            WorkspaceKind::Reachable | WorkspaceKind::Dexterous => places.contains(i),
            WorkspaceKind::Imaginary => !places.contains(i),
            WorkspaceKind::Grid
            | WorkspaceKind::ConstantOrientation
            | WorkspaceKind::Orientation
            | WorkspaceKind::Aspects
            | WorkspaceKind::Upper
            | WorkspaceKind::Lower => true,
        })
        .enumerate()
        .map(|(number, (_, c))| NamedColumn::new(&c.name, Column::Coordinate(number)))
        .collect();
    let imaginary = manipulator.imaginary().iter().enumerate();
    let imaginary = imaginary.map(|(i, j)| NamedColumn::new(&j.name, Column::Imaginary(i)));
    match kind {
        WorkspaceKind::Grid
        | WorkspaceKind::ConstantOrientation
        | WorkspaceKind::Orientation
        | WorkspaceKind::Aspects => {
            known.extend(imaginary);
            let actuated = manipulator.actuated().iter().enumerate();
            known.extend(actuated.map(|(i, &joint)| {
                NamedColumn::new(&manipulator.coordinates()[joint].name, Column::Actuated(i))
            }));
            known.push(NamedColumn::new(INVERSE_CONDITION, Column::InverseCondition));
            if kind == WorkspaceKind::Aspects {
                known.push(NamedColumn::new(ASPECT, Column::Aspect));
            }
            let indices = Index::known(manipulator, setup).into_iter();
            known.extend(indices.map(|index| NamedColumn::new(index.name(), Column::Index(index))));
            if setup.has_load() {
                let efforts = efforts(manipulator).enumerate();
                known.extend(efforts.map(|(i, name)| NamedColumn::new(&name, Column::Effort(i))));
            }
        }
        WorkspaceKind::Reachable | WorkspaceKind::Dexterous => {
            known.push(NamedColumn::new(SHARE, Column::Share));
        }
        WorkspaceKind::Imaginary | WorkspaceKind::Upper => known.extend(imaginary),
        WorkspaceKind::Lower => {}
    }
    known
}

/// Whether every cloud has a field of this name.
pub(crate) fn is_field(name: &str) -> bool {
    POSITION_FIELDS.contains(&name) || COLOR_FIELDS.contains(&name)
}

/// The values of every point of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointColumns {
    /// The values that are x, y and z of the cloud.
    pub axes: [NamedColumn; 3],
    /// Further values that are stored.
    pub scalars: Vec<NamedColumn>,
    /// The value that the colour shows.
    pub color: NamedColumn,
    /// Whether the scalars were requested rather than chosen by default.
    pub(crate) scalars_chosen: bool,
    /// How the axes are scaled.
    pub(crate) scale: AxisScale,
}

/// Stores the value that the colour shows as a number, too, so that pictures of the recording have it.
fn store_color(axes: &[NamedColumn], scalars: &mut Vec<NamedColumn>, color: Option<NamedColumn>) {
    let new = |color: &NamedColumn| {
        !axes.contains(color) && !scalars.contains(color) && !is_field(&color.name)
    };
    scalars.extend(color.filter(new));
}

/// The axis of a cloud that has fewer coordinates.
fn no_axis() -> NamedColumn {
    NamedColumn::new(NO_AXIS, Column::Zero)
}

impl PointColumns {
    /// The values of poses of a grid; defaults suit the grid.
    pub fn of_poses(choice: PointChoice, grid: &Grid) -> Self {
        let (tallest, scale) = (tallest(grid), choice.scale);
        let axis = |i: usize| NamedColumn::new(&grid.axes()[i].name, Column::Coordinate(i));
        let asked = choice.color.clone();
        let color = choice.color.unwrap_or_else(|| match choice.kind {
            WorkspaceKind::Aspects => NamedColumn::new(ASPECT, Column::Aspect),
            _ => axis(tallest),
        });
        let several = |number: &usize| grid.axes()[*number].count > 1;
        let varying: Vec<usize> = (0..grid.axes().len()).filter(several).collect();
        let axes = choice.axes.unwrap_or_else(|| {
            if let [a, b] = varying[..] {
                let flat = (0..grid.axes().len()).rfind(|number| !several(number));
                return [axis(a), axis(b), flat.map_or_else(no_axis, axis)];
            }
            // Varying coordinates come first.
            let fixed = (0..grid.axes().len()).filter(|number| !several(number));
            let mut order: Vec<usize> = varying.iter().copied().chain(fixed).collect();
            // The coordinates of the place are horizontal, and the coordinate of `tallest` is vertical.
            if varying.len() > 2 && varying[0] < grid.lower() {
                order.retain(|&number| number != tallest);
                order.insert(2, tallest);
            }
            [0, 1, 2].map(|i| order.get(i).map_or_else(no_axis, |&number| axis(number)))
        });
        let scalars_chosen = choice.scalars.is_some();
        let mut scalars = choice.scalars.unwrap_or_default();
        let stored = if scalars_chosen { asked } else { Some(color.clone()) };
        store_color(&axes, &mut scalars, stored);
        Self { axes, scalars, color, scalars_chosen, scale }
    }

    /// The values of the points of a set in memory; defaults suit the set.
    pub fn of_set(choice: PointChoice, set: &GridSet) -> Self {
        let PointChoice { kind, known, scale, .. } = choice;
        let varying = set.varying();
        let axis = |i: usize| NamedColumn::new(&set.axes()[i].axis.name, Column::Coordinate(i));
        // Varying coordinates come first.
        let fixed = (0..set.axes().len()).filter(|i| !varying.contains(i));
        let order: Vec<usize> = varying.iter().copied().chain(fixed).collect();
        let is_imaginary = |named: &&NamedColumn| matches!(named.column, Column::Imaginary(_));
        let imaginary = || known.iter().filter(is_imaginary).cloned();
        let shown: Vec<NamedColumn> = match kind == WorkspaceKind::Imaginary {
            true => imaginary().collect(),
            false => order.iter().map(|&i| axis(i)).collect(),
        };
        let axes = choice
            .axes
            .unwrap_or_else(|| [0, 1, 2].map(|i| shown.get(i).cloned().unwrap_or_else(no_axis)));
        let asked = choice.color.clone();
        let color = choice.color.unwrap_or_else(|| match kind.is_of_places() {
            true => NamedColumn::new(SHARE, Column::Share),
            false => axis(varying.get(2).or(varying.last()).copied().unwrap_or(0)),
        });
        let scalars_chosen = choice.scalars.is_some();
        let mut scalars = choice.scalars.unwrap_or_else(|| {
            let mut scalars: Vec<NamedColumn> = match kind == WorkspaceKind::Imaginary {
                // They are stored by name as well, for pictures of more than three joints.
                true => imaginary().collect(),
                // Every coordinate of a point is stored.
                false => varying.iter().map(|&i| axis(i)).filter(|c| !axes.contains(c)).collect(),
            };
            scalars.retain(|named| !is_field(&named.name));
            scalars
        });
        let stored = if scalars_chosen { asked } else { Some(color.clone()) };
        store_color(&axes, &mut scalars, stored);
        Self { axes, scalars, color, scalars_chosen, scale }
    }

    /// The values of a row: axes, scalars, and the colour if it is not among these.
    pub fn columns(&self) -> Vec<Column> {
        let listed = || self.axes.iter().chain(&self.scalars);
        let mut columns: Vec<Column> = listed().map(|named| named.column).collect();
        if !listed().any(|named| named.name == self.color.name) {
            columns.push(self.color.column);
        }
        columns
    }
}

/// The coordinate that is vertical in a picture of the workspace: the third one that varies of the lower section, of which slices
/// do not tell it; else the tilt if it varies, else the slowest varying one of the upper section, else of the lower. A plane
/// mechanism shows its plane so, at held angles.
fn tallest(grid: &Grid) -> usize {
    let several = |axis: &Axis| axis.count > 1;
    let mut lower = (0..grid.lower()).filter(|&number| several(&grid.axes()[number]));
    if let Some(third) = lower.nth(2).filter(|_| grid.axes()[grid.lower()..].iter().any(several)) {
        return third;
    }
    let kinds = grid.coordinates().iter().map(|coordinate| coordinate.kind);
    let is_tilt = |kind| matches!(kind, Some(CoordinateKind::Xi | CoordinateKind::Tilt));
    let tilt = kinds.zip(grid.axes()).position(|(kind, axis)| is_tilt(kind) && several(axis));
    let upper = || grid.axes()[grid.lower()..].iter().rposition(several);
    tilt.or_else(|| upper().map(|number| grid.lower() + number))
        .or_else(|| grid.axes().iter().rposition(several))
        .unwrap_or(0)
}

#[cfg(all(test, feature = "recording"))]
mod tests {
    use super::*;

    #[test]
    fn fields_are_those_of_every_recorded_cloud() {
        assert_eq!(POSITION_FIELDS, opm_mcap::cloud::POSITION_FIELDS);
        assert_eq!(COLOR_FIELDS, opm_mcap::cloud::COLOR_FIELDS);
    }
}
