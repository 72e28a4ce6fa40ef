//! Recordings of sets whose points are no poses of the platform, and of boundaries.

use super::{Kind, Study};
use crate::args::CloudArgs;
use crate::failure::Failure;
use crate::workspace::Run;
use opm_core::manipulator::{Follow, Manipulator};
use opm_mcap::cloud::{COLOR_FIELDS, POSITION_FIELDS};
use opm_mcap::{ClosedLine, CloudLayout, MAX_SLICES};
use opm_workspace::{Count, Grid, GridSet, Modes, Outline};

/// The name of an axis of the cloud along which all points have zero: there are fewer than three.
pub const FLAT: &str = "0";
/// The share of the orientations that reach a place.
const SHARE: &str = "share";

/// One value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    /// A coordinate, by its number among the set's axes.
    Coordinate(usize),
    Share,
    /// An imaginary joint, which follows from the coordinates.
    Imaginary(usize),
    Zero,
}

type Named = (String, Column);

/// What the flags ask for, of what there is.
pub struct SetWishes {
    kind: Kind,
    known: Vec<Named>,
    axes: Option<[Named; 3]>,
    scalars: Option<Vec<Named>>,
    color: Option<Named>,
}

impl SetWishes {
    /// From the flags, each of which is checked.
    pub fn new(kind: Kind, args: &CloudArgs, manipulator: &Manipulator) -> Result<Self, Failure> {
        let known = known(kind, manipulator);
        let find = |name: &String, flag: &str| {
            let found = known.iter().find(|(known, _)| known == name).cloned();
            found.ok_or_else(|| {
                let names: Vec<&str> = known.iter().map(|(name, _)| &**name).collect();
                let (kind, names) = (kind.name(), names.join(", "));
                Failure::flag(flag, format!("{name:?} with --kind {kind}: none of {names}"))
            })
        };
        let color = args.color.as_ref().map(|name| find(name, "--color")).transpose()?;
        let scalars = args.scalars.as_ref().map(|names| -> Result<Vec<Named>, Failure> {
            let mut scalars: Vec<Named> = vec![];
            for name in names {
                let wrong = |problem| Err(Failure::flag("--scalars", problem));
                if is_field(name) {
                    return wrong(format!("a cloud has a field {name} already; use --axes"));
                }
                if scalars.iter().any(|(earlier, _)| earlier == name) {
                    return wrong(format!("{name} is given twice"));
                }
                scalars.push(find(name, "--scalars")?);
            }
            Ok(scalars)
        });
        let axes = match &args.axes[..] {
            [] => None,
            [a, b, c] if a != b && b != c && a != c => {
                Some([find(a, "--axes")?, find(b, "--axes")?, find(c, "--axes")?])
            }
            given => {
                let (given, kind) = (given.join(","), kind.name());
                return Err(Failure::flag(
                    "--axes",
                    format!("{given:?}, expected three different values of --kind {kind}"),
                ));
            }
        };
        Ok(Self { kind, axes, scalars: scalars.transpose()?, color, known })
    }
}

/// What a point has a value of.
fn known(kind: Kind, manipulator: &Manipulator) -> Vec<Named> {
    let lower = manipulator.task().lower_count;
    let coordinates = kind.sections().coordinates(manipulator).into_iter().enumerate();
    let mut known: Vec<Named> = coordinates
        .filter(|(i, _)| match kind {
            Kind::Reachable | Kind::Dexterous => *i < lower,
            Kind::Imaginary => *i >= lower,
            _ => true,
        })
        .enumerate()
        .map(|(number, (_, c))| (c.name, Column::Coordinate(number)))
        .collect();
    if matches!(kind, Kind::Reachable | Kind::Dexterous) {
        known.push((SHARE.to_owned(), Column::Share));
    }
    if matches!(kind, Kind::Upper | Kind::Imaginary) {
        let joints = manipulator.imaginary().iter().enumerate();
        known.extend(joints.map(|(i, joint)| (joint.name.clone(), Column::Imaginary(i))));
    }
    known
}

/// Whether every cloud has a field of this name.
fn is_field(name: &str) -> bool {
    POSITION_FIELDS.contains(&name) || COLOR_FIELDS.contains(&name)
}

/// The recording of a set in memory.
pub struct SetRecording<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    study: &'a Study,
    set: &'a GridSet,
    axes: [Named; 3],
    scalars: Vec<Named>,
    color: Named,
    /// Points of a slice, in the set or not.
    slice: u64,
    /// Slices.
    pub slices: u64,
}

impl<'a> SetRecording<'a> {
    /// Of a study that has a set.
    pub fn new(wishes: SetWishes, run: &Run<'a>, study: &'a Study) -> Result<Self, Failure> {
        let Run { manipulator, modes, .. } = *run;
        let Some(set) = &study.set else {
            return Err(Failure::Work("there is no set to record".to_owned()));
        };
        let SetWishes { kind, known, .. } = wishes;
        let varying = set.varying();
        let coordinate = |i: usize| (set.axes()[i].axis.name.clone(), Column::Coordinate(i));
        // What varies first, then what does not.
        let order = (0..set.axes().len()).filter(|i| !varying.contains(i));
        let order: Vec<usize> = varying.iter().copied().chain(order).collect();
        let imaginary = || known.iter().filter(|(_, c)| matches!(c, Column::Imaginary(_))).cloned();
        let shown: Vec<Named> = match kind {
            Kind::Imaginary => imaginary().collect(),
            _ => order.iter().map(|&i| coordinate(i)).collect(),
        };
        let axes = wishes.axes.unwrap_or_else(|| {
            let flat = || (FLAT.to_owned(), Column::Zero);
            [0, 1, 2].map(|i| shown.get(i).cloned().unwrap_or_else(flat))
        });
        let color = wishes.color.unwrap_or_else(|| match kind {
            Kind::Reachable | Kind::Dexterous => (SHARE.to_owned(), Column::Share),
            _ => coordinate(varying.get(2).or(varying.last()).copied().unwrap_or(0)),
        });
        let scalars = wishes.scalars.unwrap_or_else(|| {
            let mut scalars: Vec<Named> = match kind {
                // By their names as well, for pictures of more than three.
                Kind::Imaginary => imaginary().collect(),
                // Nothing of a point is lost.
                _ => varying.iter().map(|&i| coordinate(i)).filter(|c| !axes.contains(c)).collect(),
            };
            if !axes.contains(&color) && !scalars.contains(&color) {
                scalars.push(color.clone());
            }
            scalars.retain(|(name, _)| !is_field(name));
            scalars
        });
        let slices = match varying[..] {
            [_, _, .., slowest] => set.axes()[slowest].axis.count,
            _ => 1,
        };
        if slices > MAX_SLICES {
            let name = &set.axes()[varying[varying.len() - 1]].axis.name;
            let problem = format!("{slices} values of {name}, expected at most {MAX_SLICES}");
            return Err(Failure::flag("--grid", problem));
        }
        let slice = set.points() / slices;
        Ok(Self { manipulator, modes, study, set, axes, scalars, color, slice, slices })
    }

    /// What a recorder is to know of it.
    pub fn layout(&self, found: &Count) -> CloudLayout {
        let color_range = match self.color.1 {
            Column::Coordinate(i) => {
                let axis = &self.set.axes()[i].axis;
                [axis.min, axis.max]
            }
            Column::Share => [0.0, 1.0],
            Column::Imaginary(i) => found.imaginary[i].unwrap_or_default(),
            Column::Zero => [0.0, 0.0],
        };
        CloudLayout {
            axes: self.axes.clone().map(|(name, _)| name),
            scalars: self.scalars.iter().map(|(name, _)| name.clone()).collect(),
            color: self.color.0.clone(),
            color_range,
            frame_id: "task".to_owned(),
        }
    }

    /// The names of the set's axes.
    pub fn set_axes(&self) -> String {
        let names: Vec<&str> = self.set.axes().iter().map(|a| &*a.axis.name).collect();
        names.join(",")
    }

    /// Gives the slice and the values of every point, in the order of [`CloudLayout::columns`].
    pub fn points(
        &self,
        mut visit: impl FnMut(u64, &[f64]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut columns: Vec<Column> =
            self.axes.iter().chain(&self.scalars).map(|(_, column)| *column).collect();
        if !self.axes.iter().chain(&self.scalars).any(|(name, _)| *name == self.color.0) {
            columns.push(self.color.1);
        }
        let (mut row, mut ways) = (vec![0.0; columns.len()], vec![]);
        for number in self.set.numbers() {
            let point = self.set.point(number);
            let mut imaginary: Option<Vec<f64>> = None;
            for (value, column) in row.iter_mut().zip(&columns) {
                *value = match *column {
                    Column::Coordinate(i) => point[i],
                    Column::Share => {
                        self.study.visits.as_ref().map_or(0.0, |visits| visits.share(number))
                    }
                    Column::Imaginary(i) => {
                        imaginary.get_or_insert_with(|| self.imaginary(&point, &mut ways))[i]
                    }
                    Column::Zero => 0.0,
                };
            }
            visit(number / self.slice, &row)?;
        }
        Ok(())
    }

    /// Every imaginary joint at the upper section's coordinates, in the first mode that closes.
    fn imaginary(&self, upper: &[f64], ways: &mut Vec<Follow>) -> Vec<f64> {
        let b = self.manipulator.task().upper(upper);
        let joints = self.manipulator.imaginary().iter();
        let value = |leg: usize| {
            ways.clear();
            self.manipulator.follow(leg, &b, self.modes.one(), ways);
            ways.first().and_then(|way| self.manipulator.imaginary_value(way)).map_or(0.0, |v| v.1)
        };
        joints.map(|joint| joint.leg).map(value).collect()
    }

    /// The boundary in the cloud's axes.
    pub fn boundary(&self) -> Option<Vec<(u64, Vec<ClosedLine>)>> {
        let coordinates: Option<Vec<_>> = (self.axes.iter())
            .map(|(_, column)| match column {
                Column::Coordinate(i) => Some(Some(*i)),
                Column::Zero => Some(None),
                Column::Share | Column::Imaginary(_) => None,
            })
            .collect();
        let coordinates = coordinates?;
        let place = |point: &[f64]| -> [f64; 3] {
            std::array::from_fn(|i| coordinates[i].map_or(0.0, |number| point[number]))
        };
        Some(boundary_lines(self.set, self.study.boundary()?, place, |slice| slice))
    }
}

/// The boundary of a set as lines in space: `place` says where a point is, and `slice` with which slice
/// of a recording that of a value of the set's third axis is shown.
pub fn boundary_lines(
    set: &GridSet,
    outlines: &[Outline],
    place: impl Fn(&[f64]) -> [f64; 3],
    slice: impl Fn(u64) -> u64,
) -> Vec<(u64, Vec<ClosedLine>)> {
    let axes = set.varying();
    let mut lines: Vec<(u64, Vec<ClosedLine>)> = vec![];
    for outline in outlines {
        let mut point: Vec<f64> = set.axes().iter().map(|a| a.axis.min).collect();
        if let Some(number) = outline.slice {
            point[axes[2]] = set.axes()[axes[2]].axis.value(number);
        }
        let rings = outline.rings.iter().map(|ring| {
            let corner = |&[x, y]: &[f64; 2]| {
                (point[axes[0]], point[axes[1]]) = (x, y);
                place(&point)
            };
            ring.points.iter().map(corner).collect::<ClosedLine>()
        });
        let at = slice(outline.slice.unwrap_or(0));
        match lines.last_mut() {
            Some((last, all)) if *last == at => all.extend(rings),
            _ => lines.push((at, rings.collect())),
        }
    }
    lines
}

/// The boundary of poses: the recording has `together` of the grid's slices in one.
pub fn pose_boundary(
    grid: &Grid,
    study: &Study,
    together: u64,
    place: impl Fn(&[f64]) -> [f64; 3],
) -> Option<Vec<(u64, Vec<ClosedLine>)>> {
    let (set, outlines) = (study.set.as_ref()?, study.boundary()?);
    let third = set.varying().get(2).copied().filter(|&axis| axis >= grid.lower());
    // The third axis is the slowest, so that what is shown does not go back.
    let before = |axis: usize| grid.axes()[grid.lower()..axis].iter().map(|a| a.count).product();
    let stride: u64 = third.map_or(0, before);
    Some(boundary_lines(set, outlines, place, |number| number * stride / together))
}
