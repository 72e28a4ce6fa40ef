//! Source code in MATLAB, which Octave understands, too: a package with a file for each function of the interface.
//!
//! The closed forms are those of the C code, printed from their tree. Each file has all that its function needs, so that it
//! can be taken into a block of Simulink by itself.

mod print;

use crate::golden::{angles, rows};
use crate::names::package;
use crate::text::commented;
use crate::tree::lower::{Has, lower};
use crate::tree::{Code, Function, Node, Type, visit};
use crate::{Content, GenerateError, Package, c};
use opm_core::Manipulator;
use std::fmt::Write;

const TEST: &str = include_str!("matlab/package/test.m");
const ALL_MODES: &str = include_str!("matlab/package/all_modes.m");

/// Keywords of MATLAB and of Octave.
const RESERVED: &str = "break case catch classdef continue do else elseif end endfor endfunction endif endswitch \
     endwhile for function global if otherwise parfor persistent return spmd switch try until \
     unwind_protect while";

/// Writes the kinematics of a mechanism as a package of MATLAB.
///
/// # Errors
/// The mechanism has more than 32 two-valued choices.
pub fn matlab(manipulator: &Manipulator, content: Content) -> Result<Package, GenerateError> {
    let mut code = c::tree(manipulator, content)?;
    lower(&mut code, Has { choices: false });
    // Operators of MATLAB have the other names.
    visit::rename_functions(&mut code, &|name| {
        let own = [("plus", "sum_of"), ("minus", "difference_of"), ("times", "product_of")];
        own.iter().find(|(known, _)| *known == name).map(|(_, other)| (*other).to_owned())
    });
    // Results have values from the start, as MATLAB has no others.
    for function in &mut code.functions {
        function.comment = function.comment.replace("nothing is written", "the others are NaN");
    }
    let name = package(&manipulator.mechanism().name, RESERVED);
    let title = crate::names::comment(&manipulator.mechanism().name);
    let head = format!(
        "% Of the closed-form kinematics of {title}.\n% Written by opm {}; write it anew rather than change it.\n",
        env!("CARGO_PKG_VERSION")
    );
    let mut files = vec![(format!("+{name}/default.m"), geometry(&code, &head))];
    for function in code.functions.iter().filter(|function| function.public) {
        let text = with_needed(&code, function, &head);
        files.push((format!("+{name}/{}.m", function.name), text));
    }
    let choices = manipulator.choices().to_string();
    files.push((
        format!("+{name}/all_modes.m"),
        ALL_MODES.replace("NAME", &name).replace("HEAD\n", &head).replace("CHOICES", &choices),
    ));
    files.push((format!("{name}_test.m"), test(manipulator, &name)));
    Ok(Package { name, files })
}

/// The geometry as a function.
fn geometry(code: &Code, head: &str) -> String {
    let kind = Type::Struct("geometry".into());
    format!(
        "function g = default()\n    % The mechanism as it was when this code was written, metres and radians.\n{head}\n{}end\n",
        print::value(code, &kind, &code.default, 0)
    )
}

/// A function with those that it needs behind it.
fn with_needed(code: &Code, function: &Function, head: &str) -> String {
    let mut needed = vec![function.name.clone()];
    let mut constants: Vec<String> = Vec::new();
    let mut at = 0;
    while at < needed.len() {
        let known = code.functions.iter().find(|known| known.name == needed[at]);
        at += 1;
        for statement in known.map_or(&[][..], |known| &known.body) {
            visit::statements(std::slice::from_ref(statement), &mut |inner| {
                for expr in visit::own(inner) {
                    visit::expressions(expr, &mut |part| {
                        let (list, name) = match &part.node {
                            Node::Call(name, _) => (&mut needed, name),
                            Node::Constant(name) => (&mut constants, name),
                            _ => return,
                        };
                        if !list.contains(name) {
                            list.push(name.clone());
                        }
                    });
                }
            });
        }
    }
    let mut text = print::function(code, function);
    let body = text.find('\n').map_or(0, |at| at + 1);
    let comment_end = text[body..]
        .lines()
        .take_while(|line| line.trim_start().starts_with('%'))
        .map(|line| line.len() + 1)
        .sum::<usize>();
    text.insert_str(body + comment_end, &format!("\n{head}"));
    let others = code.functions.iter().filter(|other| other.name != function.name);
    for other in others.filter(|other| needed.contains(&other.name)) {
        text += "\n";
        text += &print::function(code, other);
    }
    for one in code.constants.iter().filter(|one| constants.contains(&one.name)) {
        let comment = commented(&one.comment, "% ", "    ");
        let _ =
            write!(text, "\nfunction x = {}()\n{comment}    x = {};\nend\n", one.name, one.double);
    }
    let entries = code.enums.iter().flat_map(|names| &names.entries);
    for entry in entries.filter(|entry| constants.contains(&entry.name)) {
        let _ = write!(text, "\nfunction n = {}()\n    n = {};\nend\n", entry.name, entry.value);
    }
    text
}

/// A program that compares the code with poses that opm solved.
fn test(m: &Manipulator, name: &str) -> String {
    let rows = rows(m, |mode, status, [pose, joints, imaginary]| {
        format!("        {mode}, {status}, [{pose}], [{joints}], [{imaginary}]; ...\n")
    });
    let angles = angles(m, ["true", "false"]);
    TEST.replace("TITLE", &crate::names::comment(&m.mechanism().name))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("NAME", name)
        .replace("ANGLES", &angles)
        .replace("        ROWS\n", &rows)
}
