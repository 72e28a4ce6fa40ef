//! Mechanism files: TOML in, a [`Mechanism`] out, or every problem of the file with its place.
//!
//! A file names its own units and what follows is SI. Two forms:
//!
//! * **Family**: `family = "..."` and the parameters of one of the [families](super::family). All
//!   of `home` may be left out: a coordinate that is not given is zero. So may `mode`: every
//!   choice is `+`.
//! * **Joints**: `[platform]` and `[[leg]]` with `joints`, at the assembled home pose. A joint is
//!   `{ name, type, ... }` with
//!
//! | type | needs | may have |
//! |---|---|---|
//! | `revolute` | `axis`, `point` | `home`, `limits`, `actuated` |
//! | `prismatic` | `axis` | `point` (where it is drawn), `home`, `limits`, `actuated` |
//! | `helical` | `axis`, `point`, `pitch` (length per radian, negative left-handed) | as revolute |
//! | `cylindrical` | `axis`, `point` | as revolute; coordinates angle, slide |
//! | `universal` | `axis`, `axis2`, `point` | as revolute; coordinates about `axis`, `axis2` |
//! | `spherical` | `point` | as revolute; coordinates x, y, z of the rotation vector |
//!
//! `home` (default zero) is a number and `limits` a pair `[lowest, highest]`; a joint of several
//! coordinates has an array of as many.
//!
//! `[task]` may say how the pose is to be measured, where the [geometry](crate::task) leaves that
//! free:
//!
//! ```toml
//! [task]
//! axis = [0, 0, 1]
//! lower = { x = [0, 1, 0], normal = [0, 0, -1], origin = [100, 0, 0] }
//! upper = { w = [0, 0, 1], normal = [1, 0, 0], origin = [0, 0, 50] }
//! ```
//!
//! | key | says | of |
//! |---|---|---|
//! | `axis` | which direction of the intersection motion is positive: the one on its side | both |
//! | `x` | the direction of coordinate `x`, in the plane; of a sphere's first axis, square to the intersection motion | planes with `x y`, spheres |
//! | `w` | which direction of coordinate `w` is positive | upper planes with `w` |
//! | `normal` | which of a plane's two normals `y` and the angle turn about | planes that share a translation, where they turn or have `y` |
//! | `origin` | the point that lengths are measured from | all with a length among their coordinates |
//!
//! Each may be left out. `opm decompose` prints the frames as they are.
//!
//! Both forms need `format = 1`, `name`, and `units = { length = "m|cm|mm|in", angle = "rad|deg" }`.
//! A leg's `name` is `leg1`, `leg2`, ... if it is not given. A joint cannot be called like a task
//! coordinate (`x`, `phi`, ...), like `reachable`, `within_limits`, `mode` or `branch`, or like a leg's
//! imaginary joint (`tau.leg1`): tables have columns of these names. Whatever a file does not need to have
//! it may not have either: an unknown key is a problem, with the nearest known one as a hint.

pub(crate) mod checks;
mod hint;
mod joints;
mod parameters;
mod problem;
mod reader;
mod units;
mod writer;

pub use problem::{FileErrors, Place, Places, Problem};
pub use units::{AngleUnit, FileUnits, LengthUnit};
pub use writer::{Digits, write};

pub(super) use parameters::{read_home, read_leg, table_of, tables_of};
pub(crate) use reader::{LARGEST, Reader, Table, Value};

use super::Mechanism;
use super::family::{
    AssemblyError, AssemblyReason, Family, planar_planar, plano_spherical, translational_helical,
};
use crate::chain::Branch;
use toml::de::DeTable;

/// The format that this version reads.
const FORMAT: i64 = 1;

/// What a mechanism file says.
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismFile {
    /// The mechanism at its assembled home pose, SI.
    pub mechanism: Mechanism,
    /// The file's units, for what people read.
    pub units: FileUnits,
    /// The parameters that it was assembled from; `None` for a list of joints.
    pub family: Option<Family>,
    /// The working mode of home, where the family knows it; else it follows from the joints.
    pub mode: Option<String>,
    /// Where it says what may not fit together.
    pub places: Places,
}

/// Reads the text of a mechanism file.
///
/// # Errors
/// Every problem of the file. Where the text is not TOML: the parser's problems only.
pub fn read(text: &str) -> Result<MechanismFile, FileErrors> {
    let (file, places) = document(text, "mechanism", read_document)?;
    Ok(MechanismFile { places: places.in_text(text), ..file })
}

/// Reads a TOML text that should be a file of this kind, with `read` for what is in it.
pub(crate) fn document<T>(
    text: &str,
    kind: &str,
    read: impl FnOnce(&Table<'_>) -> Option<T>,
) -> Result<T, FileErrors> {
    let reader = Reader::new();
    let (document, syntax) = DeTable::parse_recoverable(text);
    for error in &syntax {
        reader.report(error.span().map_or(0, |span| span.start), error.message());
    }
    let file =
        if syntax.is_empty() { read(&Table::new(document.get_ref(), 0, &reader)) } else { None };
    match (reader.into_errors(text), file) {
        (None, Some(file)) => Ok(file),
        (Some(errors), _) => Err(errors),
        (None, None) => Err(FileErrors {
            problems: vec![Problem {
                line: 1,
                column: 1,
                message: format!("not a {kind}, expected a {kind} file"),
            }],
        }),
    }
}

/// What every file begins with: its format, which must be the one that is read here; its name,
/// empty where that is wrong; and its units, which from now on are those of the reader.
pub(crate) fn head<'a>(root: &Table<'a>, kind: &str) -> Option<&'a str> {
    let format = root.require("format", &format!("format = {FORMAT}"))?;
    let number = format.integer()?;
    if number != FORMAT {
        format.report(format!("is {number}, expected {FORMAT}, the only one so far"));
        return None;
    }
    let name = root
        .require("name", &format!("the {kind}'s name"))
        .and_then(|value| value.name())
        .unwrap_or_default();
    root.reader.set_units(read_units(root));
    Some(name)
}

/// The file, its places still to be told, and these as byte offsets.
fn read_document(root: &Table<'_>) -> Option<(MechanismFile, Places<usize>)> {
    let name = head(root, "mechanism")?;
    let units = root.reader.units();
    let Some(family) = root.get("family") else {
        let (mechanism, noted) = joints::read(root, name);
        let places = Places::default();
        return Some((MechanismFile { mechanism, units, family: None, mode: None, places }, noted));
    };
    type Read = fn(&Table<'_>, &str) -> Option<(Family, Mechanism)>;
    let read = family.word::<Read>(&[
        ("plano-spherical", plano_spherical::read),
        ("translational-helical", translational_helical::read),
        ("planar-planar", planar_planar::read),
    ])?;
    let (family, mechanism) = read(root, name)?;
    let (mode, family, places) = (Some(family.mode()), Some(family), Places::default());
    Some((MechanismFile { mechanism, units, mode, family, places }, Places::default()))
}

/// The file's units; where they are not understood, SI, so that the rest can be checked.
fn read_units(root: &Table<'_>) -> FileUnits {
    let expected = "units = { length = \"mm\", angle = \"deg\" }, for instance";
    let units = root.require("units", expected).and_then(|value| value.table(&["length", "angle"]));
    let lengths = LengthUnit::ALL.map(|unit| (unit.symbol(), unit));
    let angles = AngleUnit::ALL.map(|unit| (unit.symbol(), unit));
    let length = units
        .and_then(|units| units.require("length", "the unit of lengths"))
        .and_then(|value| value.word(&lengths));
    let angle = units
        .and_then(|units| units.require("angle", "the unit of angles"))
        .and_then(|value| value.word(&angles));
    FileUnits { length: length.unwrap_or_default(), angle: angle.unwrap_or_default() }
}

/// A leg's name; `leg1`, `leg2`, ... where it has none.
pub(super) fn leg_name(leg: &Table<'_>, index: usize) -> String {
    let given = leg.get("name").and_then(|value| value.name());
    given.map_or_else(|| format!("leg{}", index + 1), str::to_owned)
}

/// The branches of `mode`: a group of signs for each leg with choices, in one row. All plus where
/// it is not given.
pub(super) fn branches(root: &Table<'_>, choices: &[usize]) -> Vec<Branch> {
    let plus = || vec![Branch::Plus; choices.iter().sum()];
    let Some((value, text)) = root.get("mode").and_then(|value| Some((value, value.string()?)))
    else {
        return plus();
    };
    let groups: Vec<&str> = text.split_whitespace().collect();
    let example = choices.iter().map(|&n| "+".repeat(n)).collect::<Vec<_>>().join(" ");
    if let Some(wrong) = text.chars().find(|c| !c.is_whitespace() && !"+-".contains(*c)) {
        value.report(format!("has {wrong:?} in it, expected signs + and - like {example:?}"));
        return plus();
    }
    if groups.iter().map(|group| group.len()).ne(choices.iter().copied()) {
        value
            .report(format!("is {text:?}, expected as many signs, in such groups, as {example:?}"));
        return plus();
    }
    let branch = |sign| if sign == '+' { Branch::Plus } else { Branch::Minus };
    groups.into_iter().flat_map(str::chars).map(branch).collect()
}

/// A family that was read, and what it assembles to. What keeps it from assembling is reported, each problem at
/// the parameter to blame. A value that could not be read, and so is no number, has its problem already.
pub(super) fn assembled(
    family: Family,
    root: &Table<'_>,
    legs: &[Table<'_>],
) -> Option<(Family, Mechanism)> {
    let problems = match family.assemble() {
        Ok(mechanism) => return Some((family, mechanism)),
        Err(AssemblyError { problems }) => problems,
    };
    for problem in problems {
        let table = problem.leg.and_then(|leg| legs.get(leg)).unwrap_or(root);
        let value = problem.parameter.and_then(|parameter| table.get(parameter));
        let at = value.map_or(table.at, |value| value.at);
        let told = value.is_some() && root.reader.has_problem(at);
        if problem.reason != AssemblyReason::NotFinite && !told {
            root.reader.report(at, problem.describe(root.reader.units()));
        }
    }
    None
}

#[cfg(test)]
mod tests;
