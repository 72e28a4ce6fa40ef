//! Source code in Python: a module for NumPy, which solves arrays of poses at once.
//!
//! The closed forms are those of the C code, printed from their tree; what is around them is written once.

mod print;
mod ways;

use crate::golden::{angles, listed, rows};
use crate::names::package;
use crate::text::{camel, commented};
use crate::tree::lower::{Has, lower};
use crate::tree::{Code, Struct, Type, Value};
use crate::{Content, GenerateError, Package, c};
use opm_core::Manipulator;
use std::fmt::Write;

const MODULE: &str = include_str!("python/package/module.py");
const FORWARD: &str = include_str!("python/package/forward.py");
const DYNAMICS: &str = include_str!("python/package/dynamics.py");
const TEST: &str = include_str!("python/package/test.py");
const PROJECT: &str = include_str!("python/package/pyproject.toml");

/// Keywords, and modules that the code imports.
const RESERVED: &str = "False None True and as assert async await break class continue def del elif else except \
     finally for from global if import in is lambda nonlocal not numpy or pass raise return try \
     typing while with yield";

/// Writes the kinematics of a mechanism as a module of Python.
///
/// # Errors
/// The mechanism has more than 32 two-valued choices.
pub fn python(manipulator: &Manipulator, content: Content) -> Result<Package, GenerateError> {
    let mut code = c::tree(manipulator, content)?;
    lower(&mut code, Has { choices: true });
    let name = package(&manipulator.mechanism().name, RESERVED);
    let files = vec![
        (format!("{name}.py"), module(manipulator, &code)),
        (format!("test_{name}.py"), test(manipulator, &name)),
        (
            "pyproject.toml".to_owned(),
            PROJECT.replace("PACKAGE", &name.replace('_', "-")).replace("NAME", &name),
        ),
    ];
    Ok(Package { name, files })
}

fn module(m: &Manipulator, code: &Code) -> String {
    let mut constants = String::new();
    for names in &code.enums {
        constants += &commented(&names.comment, "# ", "");
        for entry in &names.entries {
            let note = if entry.comment.is_empty() { "" } else { "  # " };
            let _ = writeln!(constants, "{} = {}{note}{}", entry.name, entry.value, entry.comment);
        }
        constants += "\n";
    }
    for one in &code.constants {
        constants += &commented(&one.comment, "# ", "");
        let _ = writeln!(constants, "{} = {}\n", one.name, one.double);
    }
    let types: String = code.structs.iter().map(structure).collect();
    let functions: Vec<String> =
        code.functions.iter().map(|function| print::function(code, function)).collect();
    let signs = m.format_mode(m.home_mode());
    let mode = match signs.is_empty() {
        true => "There is one mode, 0.".to_owned(),
        false => format!("At home it is {}: ``{signs}``.", m.home_mode().bits()),
    };
    let coordinates: Vec<&str> = m.task_coordinates().iter().map(|c| c.name).collect();
    let geometry = value(code, &Type::Struct("geometry".into()), &code.default, 0);
    let has = |name: &str| code.functions.iter().any(|function| function.name == name);
    // The mode is only given back where it is not read.
    let nearest = code.functions.iter().find(|function| function.name == "nearest");
    let takes_mode = nearest.is_some_and(|function| {
        let mode = function.parameters.iter().find(|p| p.name == "mode");
        mode.is_some_and(|mode| crate::tree::flow::is_kept(function, mode))
    });
    MODULE
        .replace("TITLE", &title(m))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("COORDINATE_NAMES", &coordinates.join(", "))
        .replace("MODE_BITS", &m.home_mode().bits().to_string())
        .replace(" MODE A mode", &format!(" {mode} A mode"))
        .replace("HOME_POSE", &listed(&m.home_pose()))
        .replace("CONSTANTS\n", &constants)
        .replace("TYPES\n", &types)
        .replace("GEOMETRY", &format!("({geometry})"))
        .replace("NEAREST_ARGUMENTS", if takes_mode { "0, " } else { "" })
        .replace("FORWARD\n", if has("forward") { FORWARD } else { "" })
        .replace("DYNAMICS\n", if has("inverse_dynamics") { DYNAMICS } else { "" })
        .replace("FUNCTIONS\n", &functions.join("\n\n"))
}

/// The mechanism's name, where it cannot end a text.
fn title(m: &Manipulator) -> String {
    m.mechanism().name.replace(['\\', '"'], " ")
}

fn structure(one: &Struct) -> String {
    let mut text = format!("class {}(NamedTuple):\n", camel(&one.name));
    let comment = commented(&one.comment, "", "    ");
    if !comment.is_empty() {
        let _ = writeln!(text, "    \"\"\"{}\"\"\"\n", comment.trim());
    }
    for member in &one.members {
        text += &commented(&member.comment, "# ", "    ");
        let _ = writeln!(text, "    {}: Any = None", member.name);
    }
    text + "\n\n"
}

/// A constant of a type.
fn value(code: &Code, of: &Type, value_of: &Value, depth: usize) -> String {
    match (of, value_of) {
        (_, Value::Number(number)) if number.is_infinite() => {
            if *number > 0.0 {
                "np.inf".into()
            } else {
                "-np.inf".into()
            }
        }
        (_, Value::Number(number)) => format!("{:?}", number + 0.0),
        (Type::Array(of, _), Value::List(parts)) => {
            let long = matches!(**of, Type::Struct(_));
            let space =
                if long { format!("\n{}", "    ".repeat(depth + 1)) } else { String::new() };
            let parts: Vec<String> = parts
                .iter()
                .map(|part| format!("{space}{},", value(code, of, part, depth + 1)))
                .collect();
            let end = if long { format!("\n{}", "    ".repeat(depth)) } else { String::new() };
            format!("({}{end})", parts.join(if long { "" } else { " " }))
        }
        (Type::Struct(name), Value::List(parts)) => {
            let members = code.members(name);
            let parts: Vec<String> = members
                .iter()
                .zip(parts)
                .map(|(m, part)| match depth {
                    0 => format!("\n    {}={},", m.name, value(code, &m.kind, part, 1)),
                    _ => value(code, &m.kind, part, depth + 1),
                })
                .collect();
            match depth {
                0 => format!("{}({}\n)", camel(name), parts.concat()),
                _ => format!("{}({})", camel(name), parts.join(", ")),
            }
        }
        _ => String::new(),
    }
}

/// A program that compares the code with poses that opm solved.
fn test(m: &Manipulator, name: &str) -> String {
    let rows = rows(m, |mode, status, [pose, joints, imaginary]| {
        format!("    ({mode}, {status}, [{pose}], [{joints}], [{imaginary}]),\n")
    });
    let angles = angles(m, ["True", "False"]);
    TEST.replace("TITLE", &title(m))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("NAME", name)
        .replace("ANGLES", &angles)
        .replace("    ROWS\n", &rows)
}
