//! Reading a mechanism file: its head, its form, and the family or the joints that it gives.

use super::problem::{FileErrors, Locations, Problem};
use super::reader::{Reader, Table};
use super::units::{AngleUnit, FileUnits, LengthUnit};
use super::{MechanismFile, Source, bodies, differences, joints, named, obstacles};
use crate::chain::Branch;
use crate::mechanism::Mechanism;
use crate::mechanism::family::{AssemblyError, AssemblyReason, FORMS, Family};
use toml::de::DeTable;

/// The format number that this version reads.
pub(crate) const FORMAT: i64 = 1;

/// The keys that the file of every family may have.
pub(super) const FAMILY_KEYS: &[&str] = &["parameters", "task", "bodies", "obstacle", "difference"];

/// Reads the text of a mechanism file.
///
/// # Errors
/// [`FileErrors`] lists every problem of the file; if the text is not TOML, only the parser's
/// problems.
pub fn read(text: &str) -> Result<MechanismFile, FileErrors> {
    let (mut file, places) = document(text, "mechanism", read_document)?;
    file.places = places.in_text(text);
    file.source = Some(Source::of(text.to_owned(), &file));
    Ok(file)
}

/// What a text is that is XML, and where to go with it: one message in place of the parser's about each line.
fn foreign(text: &str, kind: &str) -> Option<Problem> {
    let text = text.trim_start_matches('\u{feff}');
    if !text.trim_start().starts_with('<') {
        return None;
    }
    let what = [
        ("<robot", "a URDF model (XML)"),
        ("<mujoco", "an MJCF model (XML)"),
        ("<sdf", "an SDF model (XML)"),
    ];
    let what = what.iter().find(|(tag, _)| text.contains(tag)).map_or("XML", |(_, what)| what);
    let more = match kind {
        "mechanism" => {
            "; opm writes such models (`opm export`) and does not read them: write the joints at home as a list, \
             which `opm help format` explains, or begin with a known architecture (`opm new`)"
        }
        _ => "",
    };
    let message = format!("this is {what}, expected a {kind} file (TOML){more}");
    Some(Problem { line: 1, column: 1, message })
}

/// Reads a TOML text as a file of the kind `kind`. `read` reads its content.
pub fn document<T>(
    text: &str,
    kind: &str,
    read: impl FnOnce(&Table<'_>) -> Option<T>,
) -> Result<T, FileErrors> {
    if let Some(problem) = foreign(text, kind) {
        return Err(FileErrors { problems: vec![problem] });
    }
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

/// Reads the common head of every file: the format, which must be `FORMAT`; the name, which is
/// empty if it is invalid; and the units, which are set in the reader.
pub fn head<'a>(root: &Table<'a>, kind: &str) -> Option<&'a str> {
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
    let parameters = named::read(root);
    let Some(family) = root.get("family") else {
        let (mut mechanism, noted, patterns) = joints::read(root, name);
        bodies::read(root, &mut mechanism);
        differences::read(root, &mut mechanism);
        mechanism.shapes.obstacles = obstacles::read(root);
        let (family, mode, places) = (None, None, Locations::default());
        let file = MechanismFile {
            mechanism,
            units,
            family,
            mode,
            places,
            parameters,
            patterns,
            source: None,
        };
        return Some((file, noted));
    };
    let form = family.word(&FORMS)?;
    root.allow(&[form.keys, FAMILY_KEYS].concat());
    let mut noted = Locations::default();
    let task = root.get("task").and_then(|value| value.table(joints::FAMILY_TASK_KEYS));
    let coordinates = task.and_then(|task| joints::read_angles(&task, &mut noted));
    let (family, mut mechanism) = (form.read)(root, name, &branches(root, form.choices))?;
    mechanism.task.coordinates = coordinates;
    mechanism.units = units;
    bodies::read(root, &mut mechanism);
    differences::read(root, &mut mechanism);
    mechanism.shapes.obstacles = obstacles::read(root);
    let (mode, family, places) = (Some(family.mode()), Some(family), Locations::default());
    let file = MechanismFile {
        mechanism,
        units,
        mode,
        family,
        places,
        parameters,
        patterns: Vec::new(),
        source: None,
    };
    Some((file, noted))
}

/// The keys of `units`.
const UNITS_KEYS: &[&str] = &["length", "angle"];

/// Reads the file's units. Units that are not understood become SI, so that the rest can be
/// checked.
fn read_units(root: &Table<'_>) -> FileUnits {
    let expected = "units = { length = \"mm\", angle = \"deg\" }, for instance";
    let units = root.require("units", expected).and_then(|value| value.table(UNITS_KEYS));
    let Some(units) = units else { return FileUnits::SI };
    units.require("length", "the unit of lengths");
    units.require("angle", "the unit of angles");
    named_units(&units)
}

/// Reads the units of a file of another kind, which may leave them out, as a whole or in part: they are SI then. Also
/// gives the problems that they have.
pub fn optional_units(root: &DeTable<'_>, text: &str) -> (FileUnits, Vec<Problem>) {
    let reader = Reader::new();
    let units = Table::new(root, 0, &reader).get("units");
    let units = units.and_then(|value| value.table(UNITS_KEYS)).map(|units| named_units(&units));
    let problems = reader.into_errors(text).map_or_else(Vec::new, |errors| errors.problems);
    (units.unwrap_or_default(), problems)
}

/// The units that a table names; SI for what it does not name.
fn named_units(units: &Table<'_>) -> FileUnits {
    let lengths = LengthUnit::ALL.map(|unit| (unit.symbol(), unit));
    let angles = AngleUnit::ALL.map(|unit| (unit.symbol(), unit));
    let length = units.get("length").and_then(|value| value.word(&lengths));
    let angle = units.get("angle").and_then(|value| value.word(&angles));
    FileUnits { length: length.unwrap_or_default(), angle: angle.unwrap_or_default() }
}

/// The name of a leg, or `leg1`, `leg2`, ... if it has none.
pub(in crate::mechanism) fn leg_name(leg: &Table<'_>, index: usize) -> String {
    let given = leg.get("name").and_then(|value| value.name());
    given.map_or_else(|| format!("leg{}", index + 1), str::to_owned)
}

/// Reads the branches of `mode`: one group of signs for each leg with choices, concatenated. Every
/// branch is plus if the mode is not given or invalid.
fn branches(root: &Table<'_>, choices: &[usize]) -> Vec<Branch> {
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
pub(in crate::mechanism) fn assembled(
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
