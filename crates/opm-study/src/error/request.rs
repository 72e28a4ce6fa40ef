//! Errors in requests: typed, each with the option that is wrong.

use crate::kind::{PosePart, WorkspaceKind};
use crate::names::{INVERSE_CONDITION, TIP};
use crate::text::count;
use opm_analysis::{IndexError, SpringError};
use opm_core::manipulator::FollowingCoordinate;
use opm_workspace::{GridError, InscribedError, InscribedShape};
use std::path::PathBuf;

/// An option of a request. Every front end spells it in its own way: `--kind`, or `kind=`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RequestOption {
    /// What the workspace consists of.
    Kind,
    /// The axes of the grid.
    Grid,
    /// The working modes.
    Mode,
    /// The largest condition number.
    MaxCondition,
    /// The least distance of bodies.
    Clearance,
    /// The worst values of indices.
    Limit,
    /// The characteristic length of condition numbers.
    Length,
    /// The global conditioning index.
    Conditioning,
    /// The coordinates that are x, y and z of a point in a recording.
    Axes,
    /// The values that are stored with a point.
    Scalars,
    /// The value that the colour shows.
    Color,
    /// The file of a recording.
    Output,
    /// What acts on the platform.
    Wrench,
    /// What makes bodies heavy.
    Gravity,
    /// The stiffness of links and actuators.
    Stiffness,
    /// The stiffness of single actuators.
    JointStiffness,
    /// What rejects poses.
    Explain,
    /// The largest disc, ball or box.
    Inscribed,
}

impl RequestOption {
    /// The name of the option in this crate.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind => "kind",
            Self::Grid => "axes of the grid",
            Self::Mode => "modes",
            Self::MaxCondition => "max_condition",
            Self::Clearance => "clearance",
            Self::Limit => "limits",
            Self::Length => "length",
            Self::Conditioning => "conditioning",
            Self::Axes => "axes",
            Self::Scalars => "scalars",
            Self::Color => "color",
            Self::Output => "path",
            Self::Wrench => "load",
            Self::Gravity => "gravity",
            Self::Stiffness => "springs",
            Self::JointStiffness => "springs of joints",
            Self::Explain => "explain",
            Self::Inscribed => "inscribed",
        }
    }
}

/// How a front end spells an option. [`RequestOption::name`] is how this crate does.
pub type Spelling = fn(RequestOption) -> &'static str;

/// A quantity of which a set can have too many for a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetPart {
    /// Slices, one for each value of the slowest axis.
    Slices,
    /// Values of the slowest axis.
    Values,
}

/// A problem with a request.
///
/// ```
/// use opm_study::{RequestError, RequestOption, WorkspaceKind};
///
/// let error = RequestError::NoImaginaryJoints { kind: WorkspaceKind::Imaginary };
/// assert_eq!(error.option(), RequestOption::Kind);
/// let problem = error.problem(|option| match option {
///     RequestOption::Kind => "--kind",
///     other => other.name(),
/// });
/// assert_eq!(problem, "with --kind imaginary: this mechanism has no imaginary joints");
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {}", self.option().name(), self.problem(RequestOption::name))]
#[non_exhaustive]
pub enum RequestError {
    /// The kind has no poses of both sections to explain.
    ExplainKind {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// The points are on no grid.
    NoSet {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// The set does not suit the shape that is to be inscribed.
    Inscribed(InscribedError),
    /// A disc or a ball in coordinates of different units.
    Round {
        /// The shape.
        shape: InscribedShape,
        /// The names of the coordinates.
        coordinates: Vec<String>,
    },
    /// The limit on the condition number is below one, or not a number.
    MaxCondition(f64),
    /// The clearance is below zero, or not a number.
    Clearance(f64),
    /// A clearance is given for another kind than one of poses.
    SectionClearance {
        /// The kind of workspace.
        kind: WorkspaceKind,
    },
    /// A clearance is given for any working mode.
    ClearanceModes,
    /// A name is not that of an index.
    UnknownIndex {
        /// The name.
        name: String,
        /// The known names.
        known: Vec<String>,
    },
    /// An index is limited twice.
    RepeatedLimit {
        /// Its name.
        name: String,
    },
    /// The worst value of an index is not a finite number.
    LimitNotFinite {
        /// Its name.
        name: String,
        /// The value.
        bound: f64,
    },
    /// The mechanism does not have an index.
    Index(IndexError),
    /// An index is limited, but the kind is of one section alone.
    SectionIndex {
        /// The kind.
        kind: WorkspaceKind,
        /// The name of the index.
        name: &'static str,
    },
    /// The characteristic length is out of range.
    Length(f64),
    /// A characteristic length is given, but no condition number uses it.
    UnusedLength,
    /// A load is given, but no number uses it.
    UnusedLoad {
        /// The option.
        option: RequestOption,
    },
    /// Springs are given, but no number uses them.
    UnusedSprings,
    /// The springs do not suit the manipulator.
    Springs(SpringError),
    /// A value of the points is an index that the manipulator does not have.
    ColumnIndex {
        /// The option that has the name.
        option: RequestOption,
        /// Why it does not.
        error: IndexError,
    },
    /// A value of the points is an effort, but nothing acts on the mechanism.
    NoLoad {
        /// The option that has the name.
        option: RequestOption,
        /// The name.
        name: String,
    },
    /// The grid does not fit the manipulator.
    Grid(GridError),
    /// An axis has several values, but the kind of workspace holds its coordinate at one value.
    Held {
        /// The kind.
        kind: WorkspaceKind,
        /// The name of the axis.
        axis: String,
        /// Its number of values.
        count: u64,
    },
    /// The condition number is limited, but the kind is of one section alone.
    SectionCondition {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// Several working modes are requested, but the points of the kind differ from mode to mode.
    SeveralModes {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// Aspects are requested, but the mechanism has fewer actuated joints than degrees of freedom.
    Loose {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// A workspace of imaginary joints is requested, but the mechanism has no imaginary joints.
    NoImaginaryJoints {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// The kind is of the upper section or the imaginary joints, but all legs move in one subspace.
    OneSubspace {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// The kind holds or varies a part of the pose that the mechanism does not have.
    NoPart {
        /// The kind.
        kind: WorkspaceKind,
        /// The part.
        part: PosePart,
        /// The names of the coordinates of a pose.
        coordinates: Vec<String>,
        /// The names of the dependent coordinates.
        dependent: Vec<String>,
    },
    /// The kind is of one section alone, but coordinates of one section depend on those of the other.
    Dependent {
        /// The kind.
        kind: WorkspaceKind,
        /// The names of the dependent coordinates.
        dependent: Vec<String>,
    },
    /// The kind is of one section alone, but heights of legs depend on the imaginary joints.
    Inclined {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// A conditioning index is requested, but the points of the kind are not poses.
    NotOfPoses {
        /// The kind.
        kind: WorkspaceKind,
    },
    /// A name is that of a dependent coordinate, which points do not have.
    Follows {
        /// The option that has the name.
        option: RequestOption,
        /// The coordinate.
        follows: FollowingCoordinate,
    },
    /// A name is not that of a value of the points.
    UnknownColumn {
        /// The option that has the name.
        option: RequestOption,
        /// The name.
        name: String,
        /// The kind.
        kind: WorkspaceKind,
        /// The known names.
        known: Vec<String>,
    },
    /// A name is not that of a task coordinate.
    UnknownCoordinate {
        /// The name.
        name: String,
        /// The known names.
        known: Vec<String>,
    },
    /// A scalar has the name of a field that every cloud has.
    ReservedField {
        /// The name.
        name: String,
    },
    /// A scalar is given twice.
    RepeatedScalar {
        /// The name.
        name: String,
    },
    /// The axes of a cloud are not three different ones.
    CloudAxes {
        /// The names that are given.
        given: Vec<String>,
        /// The kind.
        kind: WorkspaceKind,
    },
    /// A recording cannot go to standard output: until it is complete it has a temporary name.
    StandardOutput,
    /// The ending of the file name is not that of a format for points.
    FileEnding {
        /// The file.
        path: PathBuf,
    },
    /// The file name does not end in `.mcap`, but this kind of set is written as MCAP only.
    KindIsMcap {
        /// The file.
        path: PathBuf,
        /// The kind.
        kind: WorkspaceKind,
    },
    /// The file name does not end in `.mcap`, but this content is written as MCAP only.
    ContentIsMcap {
        /// The file.
        path: PathBuf,
        /// The content.
        content: &'static str,
    },
    /// The ending of the file name is not that of a format for the table of a motion.
    TableEnding {
        /// The file.
        path: PathBuf,
    },
    /// There are more slices than a recording may have.
    TooManySlices {
        /// The quantity that is too large.
        part: SetPart,
        /// Its value.
        given: u64,
        /// The slowest axis.
        axis: String,
        /// Its largest allowed value.
        most: u64,
    },
}

impl RequestError {
    /// The option that is wrong.
    pub fn option(&self) -> RequestOption {
        match self {
            Self::MaxCondition(_) | Self::SectionCondition { .. } => RequestOption::MaxCondition,
            Self::Clearance(_) | Self::SectionClearance { .. } | Self::ClearanceModes => {
                RequestOption::Clearance
            }
            Self::UnknownIndex { .. }
            | Self::RepeatedLimit { .. }
            | Self::LimitNotFinite { .. }
            | Self::Index(_)
            | Self::SectionIndex { .. } => RequestOption::Limit,
            Self::Length(_) | Self::UnusedLength => RequestOption::Length,
            Self::Springs(SpringError::Unknown { .. }) => RequestOption::JointStiffness,
            Self::Springs(_) | Self::UnusedSprings => RequestOption::Stiffness,
            Self::UnusedLoad { option }
            | Self::ColumnIndex { option, .. }
            | Self::NoLoad { option, .. } => *option,
            Self::Grid(_) | Self::Held { .. } | Self::TooManySlices { .. } => RequestOption::Grid,
            Self::SeveralModes { .. } => RequestOption::Mode,
            Self::ExplainKind { .. } => RequestOption::Explain,
            Self::NoSet { .. } | Self::Inscribed(_) | Self::Round { .. } => {
                RequestOption::Inscribed
            }
            Self::NoImaginaryJoints { .. }
            | Self::Loose { .. }
            | Self::OneSubspace { .. }
            | Self::NoPart { .. }
            | Self::Dependent { .. }
            | Self::Inclined { .. } => RequestOption::Kind,
            Self::NotOfPoses { .. } => RequestOption::Conditioning,
            Self::Follows { option, .. } | Self::UnknownColumn { option, .. } => *option,
            Self::UnknownCoordinate { .. } | Self::CloudAxes { .. } => RequestOption::Axes,
            Self::ReservedField { .. } | Self::RepeatedScalar { .. } => RequestOption::Scalars,
            Self::StandardOutput
            | Self::FileEnding { .. }
            | Self::KindIsMcap { .. }
            | Self::ContentIsMcap { .. }
            | Self::TableEnding { .. } => RequestOption::Output,
        }
    }

    /// The problem, without the option. Other options in the text are spelled as the front end spells them.
    pub fn problem(&self, spell: Spelling) -> String {
        let with = |kind: &WorkspaceKind| format!("{} {kind}", spell(RequestOption::Kind));
        match self {
            Self::MaxCondition(most) => format!("{most:?}, expected a number of at least 1"),
            Self::Clearance(least) => format!("{least:?} m, expected a length of 0 or more"),
            Self::SectionClearance { kind } => {
                format!("with {}: a section alone has no clearance", with(kind))
            }
            Self::ClearanceModes => format!(
                "with {} any: bodies are elsewhere in each mode; give one",
                spell(RequestOption::Mode)
            ),
            Self::UnknownIndex { name, known } => {
                format!("no index {name:?}, expected one of {}", known.join(", "))
            }
            Self::RepeatedLimit { name } => format!("{name} is given twice"),
            Self::LimitNotFinite { name, bound } => {
                format!("{name} is {bound:?}, expected a finite number")
            }
            Self::Index(error) => error.to_string(),
            Self::SectionIndex { kind, name } => {
                format!("with {}: a section alone has no {name}", with(kind))
            }
            Self::Length(length) => {
                format!("{length:?} m, expected a positive length, 1e-75 to 1e75 m")
            }
            Self::ExplainKind { kind } => {
                format!("is of poses, and {} {kind} has none", spell(RequestOption::Kind))
            }
            Self::NoSet { kind } => format!(
                "needs points on a grid, and those of {} {kind} are on none",
                spell(RequestOption::Kind)
            ),
            Self::Inscribed(error) => error.to_string(),
            Self::Round { shape, coordinates } => format!(
                "a {} needs coordinates of one unit, and {} are lengths and angles; a box does not",
                shape.name(),
                coordinates.join(", ")
            ),
            Self::UnusedLength => format!(
                "nothing uses it; {}, {}, {} or {} {INVERSE_CONDITION} \
                 does",
                spell(RequestOption::MaxCondition),
                spell(RequestOption::Limit),
                spell(RequestOption::Conditioning),
                spell(RequestOption::Scalars),
            ),
            Self::UnusedLoad { .. } => format!(
                "nothing uses it; {}, {} or {} of an effort or a payload does",
                spell(RequestOption::Limit),
                spell(RequestOption::Color),
                spell(RequestOption::Scalars),
            ),
            Self::UnusedSprings => format!(
                "nothing uses it; {}, {} or {} of a stiffness does",
                spell(RequestOption::Limit),
                spell(RequestOption::Color),
                spell(RequestOption::Scalars),
            ),
            Self::Springs(error) => error.to_string(),
            Self::ColumnIndex { error, .. } => error.to_string(),
            Self::NoLoad { name, .. } => {
                format!("{name}: nothing acts on the mechanism; give a wrench or gravity")
            }
            Self::Grid(error) => error.to_string(),
            Self::Held { kind, axis, count } => {
                let part = match kind {
                    WorkspaceKind::Orientation => PosePart::Place,
                    _ => PosePart::Orientation,
                };
                format!(
                    "{axis} has {count} values; {} holds the {}'s coordinates: give one value, {axis}=VALUE",
                    with(kind),
                    part.name()
                )
            }
            Self::SectionCondition { kind } => {
                format!("with {}: a section alone has no condition number", with(kind))
            }
            Self::SeveralModes { kind } => format!(
                "with {}: {} in each mode; give one",
                with(kind),
                match kind {
                    WorkspaceKind::Aspects => "there are other aspects",
                    _ => "the imaginary joints have other values",
                }
            ),
            Self::Loose { kind } => format!(
                "{kind}: this mechanism has fewer actuated joints than degrees of freedom, so it is loose at \
                 every pose; use grid"
            ),
            Self::NoImaginaryJoints { kind } => {
                format!("with {}: this mechanism has no imaginary joints", with(kind))
            }
            Self::OneSubspace { kind } => format!(
                "{kind}: all legs of this mechanism move in one subspace, so it has no {}; use grid",
                match kind {
                    WorkspaceKind::Imaginary => "imaginary joints",
                    _ => "upper section",
                }
            ),
            Self::NoPart { kind, part, coordinates, dependent } => {
                let (part, coordinates) = (part.name(), coordinates.join(", "));
                match dependent.is_empty() {
                    true => format!(
                        "{kind}: the coordinates of this mechanism's poses, {coordinates}, have no {part} among \
                         them; use grid"
                    ),
                    false => format!(
                        "{kind}: this mechanism's {part} follows from the other coordinates (dependent: {}; poses \
                         have {coordinates}); use grid",
                        dependent.join(", ")
                    ),
                }
            }
            Self::Dependent { kind, dependent } => format!(
                "{kind}: the sections of this mechanism have no workspaces of their own, because its legs tie its \
                 coordinates together (dependent: {}); use grid",
                dependent.join(", ")
            ),
            Self::Inclined { kind } => format!(
                "{kind}: the sections of this mechanism have no workspaces of their own, because they share a \
                 translation that is inclined to the direction of its height; use grid"
            ),
            Self::NotOfPoses { kind } => format!(
                "with {}: only poses have a condition number; ask for it of grid, \
                 constant-orientation or orientation",
                with(kind)
            ),
            Self::Follows { follows, .. } => follows.to_string(),
            Self::UnknownColumn { name, kind, known, .. } => {
                let known = known.join(", ");
                match kind.is_of_poses() {
                    true => format!("{name:?} is not one of {known}"),
                    false => format!("{name:?} with {}: not one of {known}", with(kind)),
                }
            }
            Self::UnknownCoordinate { name, known } => {
                format!("no task coordinate {name:?}, expected one of {}", known.join(", "))
            }
            Self::ReservedField { name } => {
                format!("a cloud has a field {name} already; use {}", spell(RequestOption::Axes))
            }
            Self::RepeatedScalar { name } => format!("{name} is given twice"),
            Self::CloudAxes { given, kind } => {
                let given = given.join(",");
                match kind.is_of_poses() {
                    true => {
                        format!("{given:?}, expected three different task coordinates, or {TIP}")
                    }
                    false => {
                        format!("{given:?}, expected three different values of {}", with(kind))
                    }
                }
            }
            Self::StandardOutput => "a recording needs a file, not standard output".to_owned(),
            Self::FileEnding { path } => format!(
                "{}, expected a name that ends in .mcap (Foxglove, Lichtblick, Rerun), .npy \
                 (NumPy) or .ply (mesh tools)",
                path.display()
            ),
            Self::KindIsMcap { path, kind } => mcap_only(path, &with(kind)),
            Self::ContentIsMcap { path, content } => mcap_only(path, content),
            Self::TableEnding { path } => {
                format!("{}, expected a name that ends in .csv or .npy (NumPy)", path.display())
            }
            Self::TooManySlices { part: SetPart::Slices, given, axis, most } => format!(
                "{} slices, one for each value of {axis}, expected at most {}",
                count(*given),
                count(*most)
            ),
            Self::TooManySlices { part: SetPart::Values, given, axis, most } => {
                format!("{given} values of {axis}, expected at most {most}")
            }
        }
    }
}

fn mcap_only(path: &std::path::Path, content: &str) -> String {
    let path = path.display();
    format!("{path}: {content} is written as MCAP, expected a name that ends in .mcap")
}

impl From<IndexError> for RequestError {
    fn from(error: IndexError) -> Self {
        Self::Index(error)
    }
}

impl From<GridError> for RequestError {
    fn from(error: GridError) -> Self {
        Self::Grid(error)
    }
}
