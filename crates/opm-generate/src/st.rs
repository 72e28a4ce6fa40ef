//! Source code in structured text (IEC 61131-3): a function block for each function of the interface.
//!
//! The closed forms are those of the C code, printed from their tree as functions. What the language lacks is taken out of
//! the tree before: choices in expressions, names that differ in their case alone, arrays of any length.

mod instances;
mod names;
mod print;

use crate::golden::{angles, poses};
use crate::names::prefix;
use crate::text::commented;
use crate::tree::lower::{Has, lower};
use crate::tree::{Code, Function, Parameter, Pass, Type};
use crate::{Content, GenerateError, Package, c};
use opm_core::Manipulator;
use opm_core::mechanism::joint::DriveLimit;
use print::{Printer, comment, kind, real};
use std::fmt::Write;

/// What the language has no function for.
const MATH: &str = include_str!("st/package/math.st");
const TEST: &str = include_str!("st/package/test.st");

/// Writes the kinematics of a mechanism in structured text.
///
/// # Errors
/// The mechanism has more than 32 two-valued choices.
pub fn st(manipulator: &Manipulator, content: Content) -> Result<Package, GenerateError> {
    let mut code = c::tree(manipulator, content)?;
    lower(&mut code, Has { choices: false });
    names::unique(&mut code);
    // The language has no infinite number (`print::real`).
    let structs = code.structs.iter_mut().map(|one| &mut one.comment);
    for comment in structs.chain(code.functions.iter_mut().map(|function| &mut function.comment)) {
        *comment = comment.replace("infinite", "the largest number");
    }
    let public: Vec<String> =
        code.functions.iter().filter(|f| f.public).map(|f| f.name.clone()).collect();
    instances::resolve(&mut code).map_err(GenerateError::Unread)?;
    let name = names::symbol(&prefix(&manipulator.mechanism().name));
    let file = file(manipulator, &code, &public, &name)?;
    let files =
        vec![(format!("{name}.st"), file), (format!("{name}_test.st"), test(manipulator, &name))];
    Ok(Package { name, files })
}

/// The file of types, functions and function blocks.
fn file(
    m: &Manipulator,
    code: &Code,
    public: &[String],
    name: &str,
) -> Result<String, GenerateError> {
    let title = comment(&m.mechanism().name);
    let mut text = format!(
        "(* The closed-form kinematics of {title}, in structured text (IEC 61131-3).\n   \
         Written by opm {}; write it anew rather than change it. *)\n\n",
        env!("CARGO_PKG_VERSION")
    );
    for one in &code.structs {
        text += &print::structure(code, one, name);
    }
    let functions: String = code
        .functions
        .iter()
        .map(|function| Printer::new(code, function, name).function())
        .collect::<Result<_, _>>()
        .map_err(GenerateError::Unread)?;
    for function in MATH.split("\n\n").map(|text| text.replace("NAME", name)) {
        let own = function.split_whitespace().find(|word| word.starts_with(name));
        if own.is_some_and(|own| functions.contains(&format!("{own}("))) {
            let _ = write!(text, "{}\n\n", function.trim_end());
        }
    }
    text += &functions;
    let blocks = code.functions.iter().filter(|function| public.contains(&function.name));
    for function in blocks {
        text += &block(m, code, function, name);
    }
    Ok(text.trim_end().to_owned() + "\n")
}

/// The function block of a function of the interface.
fn block(m: &Manipulator, code: &Code, function: &Function, name: &str) -> String {
    let is_geometry = |p: &Parameter| p.kind == Type::Struct("geometry".into());
    let in_out = |p: &Parameter| is_geometry(p) || (p.pass == Pass::Write && p.name == "pose");
    let empty = |p: &Parameter| p.name == "imaginary" && code.number("IMAGINARY") == Some(0);
    let declared = |p: &Parameter| {
        let own = if is_geometry(p) { "geometry" } else { &p.name };
        let what = described(m, &p.name);
        format!("    {own} : {};{what}\n", kind(&p.kind, name))
    };
    let section = |head: &str, of: &dyn Fn(&Parameter) -> bool, before: &str| {
        let lines: String = function.parameters.iter().filter(|p| of(p)).map(declared).collect();
        match lines.is_empty() && before.is_empty() {
            true => String::new(),
            false => format!("{head}\n{before}{lines}END_VAR\n"),
        }
    };
    let mut text = commented(&comment(&function.comment), "", "");
    text = format!("(* {} *)\n", text.trim_end().replace('\n', "\n   "));
    let _ = writeln!(text, "FUNCTION_BLOCK {name}_{}", function.name);
    text += &section("VAR_IN_OUT", &in_out, "");
    text += &section("VAR_INPUT", &|p| !in_out(p) && p.pass != Pass::Write, "");
    let status = "    status : DINT;\n";
    text += &section("VAR_OUTPUT", &|p| !in_out(p) && p.pass == Pass::Write && !empty(p), status);
    text += &section("VAR", &empty, "");
    for p in &function.parameters {
        // What is only written has no value before.
        if p.pass == Pass::Write && p.kind == Type::Bits {
            let _ = writeln!(text, "{} := DWORD#0;", p.name);
        }
    }
    let passed: Vec<String> = function
        .parameters
        .iter()
        .map(|p| {
            let own = if is_geometry(p) { "geometry" } else { &p.name };
            format!("{} := {own}", p.name)
        })
        .collect();
    let _ = write!(
        text,
        "status := {name}_fn_{}({});\nEND_FUNCTION_BLOCK\n\n",
        function.name,
        passed.join(", ")
    );
    text
}

/// What the elements of an array are, as a comment.
fn described(m: &Manipulator, parameter: &str) -> String {
    let joint = |i: usize| {
        let c = &m.coordinates()[i];
        format!("{} [{}]", c.name, c.quantity.unit())
    };
    let all: Vec<String> = match parameter {
        "pose" => {
            let coordinates = m.task_coordinates().iter();
            coordinates.map(|c| format!("{} [{}]", c.name, c.quantity.unit())).collect()
        }
        "joints" | "previous" => (0..m.coordinates().len()).map(joint).collect(),
        "actuated" => m.actuated().iter().map(|&i| joint(i)).collect(),
        "efforts" => {
            let all = m.actuated().iter().map(|&i| &m.coordinates()[i]);
            all.map(|c| format!("{} [{}]", c.name, DriveLimit::Effort.unit(c.quantity))).collect()
        }
        "imaginary" => {
            let imaginary = m.imaginary().iter();
            imaginary.map(|j| format!("{} [{}]", j.name, j.quantity.unit())).collect()
        }
        _ => return String::new(),
    };
    let listed = commented(&comment(&all.join(", ")), "", "       ");
    format!(" (* {} *)", listed.trim())
}

/// A program that compares the code with poses that opm solved.
fn test(m: &Manipulator, name: &str) -> String {
    let list = |values: &[f64]| {
        let all: Vec<String> = values.iter().map(|&value| real(value)).collect();
        format!("[{}]", all.join(", "))
    };
    let rows: Vec<String> = poses(m)
        .iter()
        .map(|golden| {
            let joints = match golden.joints.is_empty() {
                true => String::new(),
                false => format!(", joints := {}", list(&golden.joints)),
            };
            format!(
                "        (mode := DWORD#{}, status := {}, pose := {}{joints})",
                golden.mode.bits(),
                golden.status,
                list(&golden.pose)
            )
        })
        .collect();
    let angles = angles(m, ["TRUE", "FALSE"]);
    let last = |count: usize| count.saturating_sub(1).to_string();
    TEST.replace("TITLE", &comment(&m.mechanism().name))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("NAME", name)
        .replace("LAST_POSE", &last(rows.len()))
        .replace("LAST_COORDINATE", &last(m.task_coordinates().len()))
        .replace("LAST_JOINT", &last(m.coordinates().len()))
        .replace("ANGLES", &angles)
        .replace("        ROWS", &rows.join(",\n"))
}
