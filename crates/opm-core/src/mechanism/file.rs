//! Mechanism files: TOML text is read into a [`Mechanism`], or every problem is reported with its
//! location.
//!
//! A file names its own units; every value after reading is SI. There are two forms:
//!
//! * **Family**: `family = "..."` and the parameters of one of the [families](super::family).
//!   `home` may be left out, as a whole or in part: missing coordinates are zero. `mode` may be left
//!   out too: every choice is then `+`.
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
//! `home` (default zero) is a number and `limits` a pair `[lowest, highest]`. A joint with several
//! coordinates has an array with one entry per coordinate.
//!
//! `[task]` says how the pose is measured, where the [geometry](crate::task) leaves a choice:
//!
//! ```toml
//! [task]
//! axis = [0, 0, 1]
//! lower = { x = [0, 1, 0], normal = [0, 0, -1], origin = [100, 0, 0] }
//! upper = { w = [0, 0, 1], normal = [1, 0, 0], origin = [0, 0, 50] }
//! ```
//!
//! | key | meaning | sections |
//! |---|---|---|
//! | `axis` | the positive direction of the intersection motion: the one on the side of this vector | both sections |
//! | `x` | the direction of coordinate `x`, in the plane; for a sphere, the direction of its frame's first axis, perpendicular to the intersection motion | planes with `x y`, spheres |
//! | `w` | the positive direction of coordinate `w` | upper planes with `w` |
//! | `normal` | the plane's normal about which `y` and the angle are positive | planes that share a translation and have an angle or `y` |
//! | `origin` | the point that lengths are measured from | all sections with a length among their coordinates |
//!
//! Every key may be left out. `opm decompose` prints the resulting frames.
//!
//! Both forms need `format = 1`, `name`, and `units = { length = "m|cm|mm|in", angle = "rad|deg" }`.
//! A leg's `name` is `leg1`, `leg2`, ... if it is not given. Some names are columns of tables and
//! cannot be names of joints: task coordinates (`x`, `phi`, ...), `reachable`, `within_limits`,
//! `mode`, `branch`, and the imaginary joints of the legs (`tau.leg1`). An unknown key is a
//! problem, and its message suggests the nearest known key.

pub(crate) mod checks;
mod hint;
mod joints;
mod parameters;
mod problem;
mod reader;
mod units;
mod writer;

pub use problem::{FileErrors, Location, Locations, Problem};
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

/// The format number that this version reads.
const FORMAT: i64 = 1;

/// The content of a mechanism file.
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismFile {
    /// The mechanism at its assembled home pose, SI.
    pub mechanism: Mechanism,
    /// The units of the file, for text that people read.
    pub units: FileUnits,
    /// The family and parameters from which the mechanism was assembled; `None` for a list of
    /// joints.
    pub family: Option<Family>,
    /// The working mode of home, if a family determines it; for a list of joints it follows from
    /// the joints.
    pub mode: Option<String>,
    /// Locations, in the file, of what may later turn out to be inconsistent.
    pub places: Locations,
}

/// Reads the text of a mechanism file.
///
/// # Errors
/// [`FileErrors`] lists every problem of the file; if the text is not TOML, only the parser's
/// problems.
pub fn read(text: &str) -> Result<MechanismFile, FileErrors> {
    let (file, places) = document(text, "mechanism", read_document)?;
    Ok(MechanismFile { places: places.in_text(text), ..file })
}

/// Reads a TOML text as a file of the kind `kind`. `read` reads its content.
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

/// Reads the common head of every file: the format, which must be [`FORMAT`]; the name, which is
/// empty if it is invalid; and the units, which are set in the reader.
pub(crate) fn head<'a>(root: &Table<'a>, kind: &str) -> Option<&'a str> {
    let format = root.require("format", &format!("format = {FORMAT}"))?;
    let number = format.integer()?;
    if number != FORMAT {
        format.report(format!("is {number}, expected {FORMAT}, the only format so far"));
        return None;
    }
    let name = root
        .require("name", &format!("the {kind}'s name"))
        .and_then(|value| value.name())
        .unwrap_or_default();
    root.reader.set_units(read_units(root));
    Some(name)
}

/// Reads the file without its locations, and the locations as byte offsets.
fn read_document(root: &Table<'_>) -> Option<(MechanismFile, Locations<usize>)> {
    let name = head(root, "mechanism")?;
    let units = root.reader.units();
    let Some(family) = root.get("family") else {
        let (mechanism, noted) = joints::read(root, name);
        let places = Locations::default();
        return Some((MechanismFile { mechanism, units, family: None, mode: None, places }, noted));
    };
    type Read = fn(&Table<'_>, &str) -> Option<(Family, Mechanism)>;
    let read = family.word::<Read>(&[
        ("plano-spherical", plano_spherical::read),
        ("translational-helical", translational_helical::read),
        ("planar-planar", planar_planar::read),
    ])?;
    let (family, mechanism) = read(root, name)?;
    let (mode, family, places) = (Some(family.mode()), Some(family), Locations::default());
    Some((MechanismFile { mechanism, units, mode, family, places }, Locations::default()))
}

/// Reads the file's units. Units that are not understood become SI, so that the rest can be
/// checked.
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

/// The name of a leg, or `leg1`, `leg2`, ... if it has none.
pub(super) fn leg_name(leg: &Table<'_>, index: usize) -> String {
    let given = leg.get("name").and_then(|value| value.name());
    given.map_or_else(|| format!("leg{}", index + 1), str::to_owned)
}

/// Reads the branches of `mode`: one group of signs for each leg with choices, concatenated. Every
/// branch is plus if the mode is not given or invalid.
pub(super) fn branches(root: &Table<'_>, choices: &[usize]) -> Vec<Branch> {
    let plus = || vec![Branch::Plus; choices.iter().sum()];
    let Some((value, text)) = root.get("mode").and_then(|value| Some((value, value.string()?)))
    else {
        return plus();
    };
    let groups: Vec<&str> = text.split_whitespace().collect();
    let example = choices.iter().map(|&n| "+".repeat(n)).collect::<Vec<_>>().join(" ");
    if let Some(wrong) = text.chars().find(|c| !c.is_whitespace() && !"+-".contains(*c)) {
        value.report(format!("contains {wrong:?}, expected signs + and - as in {example:?}"));
        return plus();
    }
    if groups.iter().map(|group| group.len()).ne(choices.iter().copied()) {
        let expected = match choices {
            [] => "an empty text: this family has no working modes to choose from".to_owned(),
            _ => format!("one sign for every choice, in a group for each leg, as in {example:?}"),
        };
        value.report(format!("is {text:?}, expected {expected}"));
        return plus();
    }
    let branch = |sign| if sign == '+' { Branch::Plus } else { Branch::Minus };
    groups.into_iter().flat_map(str::chars).map(branch).collect()
}

/// Assembles a family that was read. Each problem is reported at the parameter that causes it. A
/// parameter that could not be read (its value is NaN) has its problem already.
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
        let reported = value.is_some() && root.reader.has_problem(at);
        if problem.reason != AssemblyReason::NotFinite && !reported {
            root.reader.report(at, problem.describe(root.reader.units()));
        }
    }
    None
}

#[cfg(test)]
mod tests;
