//! Kinds of workspace: which grid each is of, which points of it are in, and what is told of them.

mod record;

pub use record::{FLAT, SetRecording, SetWishes, pose_boundary};

use crate::args::WorkspaceArgs;
use crate::failure::Failure;
use crate::text::{count, product, short};
use clap::ValueEnum;
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_core::number::readable;
use opm_workspace::{
    Axis, Components, ConditionLimit, ConditioningIndex, Extent, Grid, GridSet, Modes, Outline,
    Poses, Progress, Sections, Visits, boundary,
};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::ops::Range;

/// What `--kind` names: J.-P. Merlet's terms, and each section alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Poses in reach
    Grid,
    /// Poses in reach with the upper section's coordinates held, each at one value
    ConstantOrientation,
    /// Poses in reach with the lower section's coordinates held, each at one value
    Orientation,
    /// Places, of the lower section's coordinates, in reach at any orientation of the grid
    Reachable,
    /// Places in reach at every orientation of the grid
    Dexterous,
    /// Values of the imaginary joints at orientations with any place in reach
    Imaginary,
    /// Orientations at which the upper section alone closes
    Upper,
    /// Places and imaginary joints at which the lower section alone closes
    Lower,
}

/// Values along each axis of a grid that is fitted: of the lower section's coordinates, and of the
/// upper's; one is home's.
type Finesse = [f64; 2];

impl Kind {
    /// All of them.
    pub fn all() -> &'static [Self] {
        Self::value_variants()
    }

    /// As it is given.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The kind that is called so.
    pub fn named(name: &str) -> Option<Self> {
        Self::from_str(name, false).ok()
    }

    /// What its grid is of.
    pub fn sections(self) -> Sections {
        match self {
            Self::Upper => Sections::Upper,
            Self::Lower => Sections::Lower,
            _ => Sections::Whole,
        }
    }

    /// Whether its points are poses of the platform.
    pub fn is_of_poses(self) -> bool {
        matches!(self, Self::Grid | Self::ConstantOrientation | Self::Orientation)
    }

    /// The axes of a grid that its points are points of.
    pub fn axes(self, grid: &Grid) -> Range<usize> {
        let all = grid.axes().len();
        match self {
            Self::Reachable | Self::Dexterous => 0..grid.lower(),
            Self::Imaginary => grid.lower()..all,
            _ => 0..all,
        }
    }

    /// What its points are called.
    pub fn points(self) -> &'static str {
        match self {
            Self::Reachable | Self::Dexterous => "places",
            Self::Imaginary | Self::Upper => "orientations",
            Self::Lower => "points",
            Self::Grid | Self::ConstantOrientation | Self::Orientation => "poses",
        }
    }

    /// What those of them that are in are called.
    pub fn reached(self) -> &'static str {
        match self {
            Self::Upper | Self::Lower => "closing",
            Self::Dexterous => "dexterous",
            _ => "reachable",
        }
    }

    /// What it is called at the head of a text.
    pub fn title(self) -> String {
        match self {
            Self::Grid => "workspace".to_owned(),
            Self::Upper => "upper section alone".to_owned(),
            Self::Lower => "lower section alone".to_owned(),
            Self::Imaginary => "workspace of the imaginary joints".to_owned(),
            _ => format!("{} workspace", self.name()),
        }
    }

    /// What is said of a set without points.
    pub fn nothing(self, limited: bool) -> String {
        let well = if limited {
            ", within the limits and well conditioned"
        } else {
            " and within the limits"
        };
        match self {
            Self::Dexterous => {
                format!("no place of the grid is in reach{well} at every orientation of it")
            }
            Self::Upper | Self::Lower => {
                "the section closes at no point of the grid within the limits".to_owned()
            }
            _ => format!("no pose of the grid is in reach{well}"),
        }
    }

    /// Refuses a grid that it is not of.
    pub fn check(self, grid: &Grid) -> Result<(), Failure> {
        let (held, section) = match self {
            Self::ConstantOrientation => (grid.lower()..grid.axes().len(), "upper"),
            Self::Orientation => (0..grid.lower(), "lower"),
            _ => return Ok(()),
        };
        match grid.axes()[held].iter().find(|axis| axis.count > 1) {
            None => Ok(()),
            Some(Axis { name, count, .. }) => Err(Failure::flag(
                "--grid",
                format!(
                    "{name} has {count} values; --kind {} holds the {section} section's \
                     coordinates: give one value, {name}=VALUE",
                    self.name()
                ),
            )),
        }
    }

    /// What is to be said where a set that is over orientations is asked for at home's alone.
    pub fn of_one_orientation(self, grid: &Grid) -> Option<String> {
        let upper = &grid.axes()[grid.lower()..];
        let over = matches!(self, Self::Reachable | Self::Dexterous | Self::Imaginary);
        if !over || upper.iter().any(|axis| axis.count > 1) {
            return None;
        }
        let names: Vec<String> =
            upper.iter().map(|axis| format!("--grid {}=MIN:MAX:COUNT", axis.name)).collect();
        let (kind, names) = (self.name(), names.join(", "));
        Some(format!("--kind {kind} has one orientation alone; for more give {names}"))
    }

    /// How to ask for fewer orientations where no place is in reach at all of them.
    pub fn fewer(self, grid: &Grid) -> Option<String> {
        /// Values of a coordinate, and how far it goes from home if it is an angle.
        const VALUES: u64 = 5;
        const HALF: f64 = 20.0;
        let axes = || grid.axes().iter().zip(grid.coordinates()).skip(grid.lower());
        let orientations: u64 = axes().map(|(axis, _)| axis.count).product();
        if self != Self::Dexterous || orientations == 1 {
            return None;
        }
        // A part of the range, about home where that is in it.
        let flags = axes().filter(|(axis, _)| axis.count > 1).map(|(axis, c)| {
            let (unit, scale, most) = match c.quantity {
                Quantity::Angle => ("deg", 1_f64.to_degrees(), HALF),
                Quantity::Length => ("mm", 1e3, f64::INFINITY),
            };
            let [min, max] = [axis.min, axis.max].map(|end| end * scale);
            let middle = (c.home * scale).clamp(min, max);
            let half = (0.25 * (max - min)).min(most);
            let end = |value: f64| readable((1e2 * value.clamp(min, max)).round() / 1e2 + 0.0);
            let [from, to] = [end(middle - half), end(middle + half)];
            format!("--grid {}={from}{unit}:{to}{unit}:{VALUES}", axis.name)
        });
        let flags: Vec<String> = flags.collect();
        let (number, flags) = (count(orientations), flags.join(" "));
        Some(format!("these are {number} orientations; ask for fewer, for example {flags}"))
    }

    /// What is wrong with a flag.
    fn wrong(self, flag: &str, problem: &str) -> Failure {
        Failure::flag(flag, format!("with --kind {}: {problem}", self.name()))
    }

    /// Refuses what it has no meaning with.
    pub fn check_run(
        self,
        manipulator: &Manipulator,
        modes: Modes,
        limit: Option<ConditionLimit>,
    ) -> Result<(), Failure> {
        let wrong = |flag, problem| Err(self.wrong(flag, problem));
        if self.sections() != Sections::Whole && limit.is_some() {
            return wrong("--max-condition", "a section alone has no condition number");
        }
        if self == Self::Imaginary && modes == Modes::Any {
            return wrong(
                "--mode",
                "the imaginary joints have other values in each mode; give one",
            );
        }
        if self == Self::Imaginary && manipulator.imaginary().is_empty() {
            return wrong("--kind", "this mechanism has no imaginary joints");
        }
        Ok(())
    }

    /// Refuses flags that make no sense with it.
    pub fn check_flags(self, args: &WorkspaceArgs) -> Result<(), Failure> {
        if args.conditioning && !self.is_of_poses() {
            let problem = "only poses have a condition number; ask for it of grid, \
                           constant-orientation or orientation";
            return Err(self.wrong("--conditioning", problem));
        }
        Ok(())
    }

    /// How fine a grid of so many lower and upper coordinates is where nobody gives one: `None` where
    /// it is the one that is fitted to the poses.
    fn finesse(self, [lower, upper]: [usize; 2]) -> Option<Finesse> {
        // A picture worth looking at, and no more than a second or so.
        let share = |points: f64, axes: usize| points.powf(1.0 / axes.max(1) as f64);
        match self {
            Self::Grid | Self::Reachable | Self::Dexterous => None,
            Self::ConstantOrientation | Self::Lower => Some([share(2.5e5, lower).min(501.0), 1.0]),
            Self::Orientation | Self::Upper => Some([1.0, share(2.5e5, upper).min(501.0)]),
            Self::Imaginary => Some([share(200.0, lower), share(7e4, upper).min(1001.0)]),
        }
    }

    /// The grid of this kind over a workspace that reaches so far, `fitted` to its poses.
    pub fn fit(self, manipulator: &Manipulator, fitted: Grid) -> Grid {
        let lower = manipulator.task().lower_count;
        let upper = fitted.axes().len() - lower;
        let Some(finesse) = self.finesse([lower, upper]) else { return fitted };
        let axes = fitted.axes().iter().zip(fitted.coordinates()).enumerate();
        let axes = axes.filter_map(|(i, (axis, coordinate))| {
            let values = finesse[usize::from(i >= lower)];
            let ours = match self.sections() {
                Sections::Whole => true,
                Sections::Upper => i >= lower,
                Sections::Lower => i < lower,
            };
            ours.then(|| match axis.count {
                1 => axis.clone(),
                _ if values <= 1.0 => Axis::fixed(&*axis.name, coordinate.home),
                _ => {
                    let count = 2 * (0.5 * (values - 1.0)).round().max(1.0) as u64 + 1;
                    Axis::new(&*axis.name, axis.min, axis.max, count)
                }
            })
        });
        Grid::of(self.sections(), manipulator, axes.collect())
            .expect("the axes are those of a grid, with fewer values")
    }

    /// Whether an extent that has no end matters to it.
    pub fn asks(self, extent: &Extent, grid: &Grid) -> bool {
        grid.axes().iter().any(|axis| axis.name == extent.name && axis.count > 1)
    }
}

/// What is asked of a set of points beside their number.
#[derive(Clone, Copy, Debug)]
pub struct Questions {
    pub kind: Kind,
    /// Its boundary and its components.
    pub shape: bool,
}

impl Questions {
    /// Whether the answers take all poses.
    pub fn need_poses(&self) -> bool {
        self.shape || !self.kind.is_of_poses()
    }
}

/// What is known of a set of points beside their number.
pub struct Study {
    pub kind: Kind,
    /// The points, where they are held in memory.
    pub set: Option<GridSet>,
    pub visits: Option<Visits>,
    pub conditioning: Option<ConditioningIndex>,
    pub shape: Option<Shape>,
}

/// A set's parts and its outline.
pub struct Shape {
    components: Vec<u64>,
    boundary: Option<Vec<Outline>>,
}

impl Study {
    /// Nothing yet.
    pub fn nothing(kind: Kind) -> Self {
        Self { kind, set: None, visits: None, conditioning: None, shape: None }
    }

    /// What follows from the poses, which are gone through once if that is needed.
    pub fn new<P: Poses>(
        questions: Questions,
        poses: &P,
        progress: &Progress,
    ) -> Result<Self, P::Error> {
        let Questions { kind, shape } = questions;
        let visits = match kind {
            Kind::Reachable | Kind::Dexterous => Some(Visits::new(poses, progress)?),
            _ => None,
        };
        let set = match (kind, &visits) {
            (Kind::Dexterous, Some(visits)) => Some(visits.dexterous()?),
            (_, Some(visits)) => Some(visits.reachable()?),
            (Kind::Imaginary, None) => Some(GridSet::slices(poses, progress)?),
            _ if questions.need_poses() => Some(GridSet::reached(poses, progress)?),
            _ => None,
        };
        let shape = set.as_ref().filter(|_| shape).map(|set| Shape {
            components: Components::new(set).sizes().to_vec(),
            // That of the orientations says nothing of the imaginary joints.
            boundary: if kind == Kind::Imaginary { None } else { boundary(set) },
        });
        Ok(Self { kind, set, visits, conditioning: None, shape })
    }

    /// The boundary, slice by slice, where it is known.
    pub fn boundary(&self) -> Option<&[Outline]> {
        self.shape.as_ref()?.boundary.as_deref()
    }

    /// Adds what is known to the JSON of a workspace.
    pub fn json(&self, json: &mut Value) {
        if let Some(visits) = &self.visits {
            json["orientations"] = visits.slices().into();
        }
        if let (Some(shape), Some(set)) = (&self.shape, &self.set) {
            let Shape { components, boundary } = shape;
            json["components"] = json!({ "number": components.len(), "sizes": components });
            json["boundary"] = match boundary {
                None => Value::Null,
                Some(outlines) => {
                    let axes = set.varying();
                    let name = |i: usize| set.axes()[axes[i]].axis.name.clone();
                    let slices: Vec<Value> = (outlines.iter())
                        .map(|outline| {
                            let at: Map<String, Value> = (outline.slice.into_iter())
                                .map(|number| {
                                    (name(2), set.axes()[axes[2]].axis.value(number).into())
                                })
                                .collect();
                            let rings: Vec<&[[f64; 2]]> =
                                outline.rings.iter().map(|ring| &*ring.points).collect();
                            json!({ "at": at, "area": outline.area(), "rings": rings })
                        })
                        .collect();
                    json!({ "axes": [name(0), name(1)], "slices": slices })
                }
            };
        }
        if let Some(index) = &self.conditioning {
            let none = index.poses == 0;
            json["conditioning"] = json!({
                "characteristic_length": index.length,
                "global": index.global(),
                "local_min": (!none).then_some(index.min),
                "local_max": (!none).then_some(index.max),
            });
        }
    }

    /// Tells people.
    pub fn text(&self, units: FileUnits) -> String {
        let mut text = String::new();
        if let Some(visits) = &self.visits {
            let word = if self.kind == Kind::Dexterous { "all" } else { "any" };
            let number = count(visits.slices());
            let _ = writeln!(text, "in {word} of {number} orientations");
        }
        if let (Some(shape), Some(set)) = (&self.shape, &self.set) {
            shape.tell(&mut text, self.kind, set);
        }
        if let Some(index) = &self.conditioning {
            let length = units.show(index.length, Quantity::Length);
            let _ = match index.global() {
                Some(global) => writeln!(
                    text,
                    "conditioning index {} on average, {} to {} (lengths over {length})",
                    short(global),
                    short(index.min),
                    short(index.max),
                ),
                None => writeln!(text, "no pose has a conditioning index"),
            };
        }
        text
    }
}

impl Shape {
    /// Components that are told one by one.
    const TOLD: usize = 6;

    fn tell(&self, text: &mut String, kind: Kind, set: &GridSet) {
        let Self { components, boundary } = self;
        let sizes: Vec<String> =
            components.iter().take(Self::TOLD).map(|&size| count(size)).collect();
        let more = if components.len() > Self::TOLD { ", ..." } else { "" };
        let _ = match components.len() {
            0 => Ok(()),
            1 => writeln!(text, "connected: one component"),
            number => {
                let (sizes, points) = (sizes.join(", "), kind.points());
                writeln!(text, "{number} connected components: {sizes}{more} {points}")
            }
        };
        let Some(outlines) = boundary else { return };
        let rings: usize = outlines.iter().map(|outline| outline.rings.len()).sum();
        let holes = outlines.iter().flat_map(|outline| &outline.rings);
        let holes = holes.filter(|ring| ring.area() < 0.0).count();
        if rings == 0 {
            return;
        }
        let lines = if rings == 1 { "closed line" } else { "closed lines" };
        let around = match holes {
            0 => String::new(),
            1 => ", one of them around a hole".to_owned(),
            holes => format!(", {holes} of them around holes"),
        };
        let slices = match set.varying()[..] {
            [_, _, slow] => format!(" in slices of {}", set.axes()[slow].axis.name),
            _ => String::new(),
        };
        let _ = writeln!(text, "boundary: {} {lines}{slices}{around}", count(rings as u64));
    }
}

/// The counted share of a box, over the axes with more than one value, and its unit.
pub fn measure<'a>(
    fraction: f64,
    axes: impl Iterator<Item = (&'a Axis, Quantity)>,
    units: FileUnits,
) -> (f64, String) {
    let mut value = fraction;
    let mut powers = [(Quantity::Length, 0), (Quantity::Angle, 0)];
    for (axis, quantity) in axes {
        if axis.count > 1 {
            value *= axis.max - axis.min;
            powers.iter_mut().filter(|p| p.0 == quantity).for_each(|p| p.1 += 1);
        }
    }
    let (symbol, factor) = product(&powers, units);
    (value / factor, symbol)
}
