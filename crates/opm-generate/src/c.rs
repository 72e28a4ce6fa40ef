//! Source code in C99: the closed forms, printed from their tree, and what is around them.

mod golden;
mod linuxcnc;
mod print;

use crate::code::Writer;
use crate::library;
use crate::names::{comment, package};
use crate::tree::Code;
use crate::{Content, GenerateError};
use opm_core::Manipulator;
use print::Printer;

/// Functions of numbers: those of `math.h` for the type of numbers, and an arctangent.
const MATH: &str = include_str!("c/math.c");

/// Targets that CMake has itself, and headers that the code includes.
const RESERVED: &str = "all clean edit_cache hal help install kinematics math package package_source preinstall \
     rebuild_cache rtapi rtapi_app rtapi_math stdio test";

/// The kinematics of one mechanism in C99.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CCode {
    /// The prefix of every symbol, and the name of the files without their endings.
    pub name: String,
    /// The header.
    pub header: String,
    /// The source file.
    pub source: String,
    /// A program that compares the code with poses that opm solved.
    pub test: String,
    /// Those poses.
    pub golden: String,
    /// What CMake builds: a library and the test.
    pub cmake: String,
    /// A kinematics module for LinuxCNC; `None` where forward kinematics have no one pose to find, or LinuxCNC has too few axes
    /// for it.
    pub linuxcnc: Option<String>,
}

impl CCode {
    /// The names of the files, and what they hold.
    pub fn files(&self) -> Vec<(String, &str)> {
        let name = &self.name;
        let mut files = vec![
            (format!("{name}.h"), &*self.header),
            (format!("{name}.c"), &*self.source),
            (format!("{name}_test.c"), &*self.test),
            (format!("{name}_golden.h"), &*self.golden),
            ("CMakeLists.txt".to_owned(), &*self.cmake),
        ];
        if let Some(module) = &self.linuxcnc {
            files.push((format!("{name}_linuxcnc.c"), module));
        }
        files
    }
}

/// Writes the kinematics of a mechanism in C99.
///
/// # Errors
/// The mechanism has more two-valued choices than an `unsigned` has bits.
pub fn c(manipulator: &Manipulator, content: Content) -> Result<CCode, GenerateError> {
    let writer = Writer::new(manipulator, content)?;
    let code = writer.code();
    let name = package(&manipulator.mechanism().name, RESERVED);
    let title = comment(&manipulator.mechanism().name);
    Ok(CCode {
        header: header(&code, &name, &title),
        source: source(&code, &name, &title),
        test: symbol(&golden::program(&name), &name),
        golden: symbol(&(golden::vectors(manipulator) + &golden::angles(manipulator)), &name),
        cmake: golden::cmake(&name),
        linuxcnc: linuxcnc::module(&writer, &code, &name, &title),
        name,
    })
}

/// A text of C with the prefix of a mechanism in its symbols.
fn symbol(text: &str, name: &str) -> String {
    text.replace("NAME_", &format!("{name}_"))
}

/// The first comment of a file.
fn head(what: &str, title: &str) -> String {
    format!(
        "/* {what} {title}.\n   Written by opm {}; write it anew rather than change it. */\n\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// Where the types of the header end: the last one is that of the geometry.
fn types_of_header(code: &Code) -> usize {
    let geometry = code.structs.iter().position(|one| one.name == "geometry");
    geometry.map_or(0, |place| place + 1)
}

fn header(code: &Code, name: &str, title: &str) -> String {
    let printer = Printer { code, name, real: format!("{name}_real") };
    let guard = format!("{}_H", name.to_uppercase());
    let names: String = code.enums.iter().map(|names| printer.names(names)).collect();
    let types = &code.structs[..types_of_header(code)];
    let types: String = types.iter().map(|one| printer.structure(one)).collect();
    let public = code.functions.iter().filter(|function| function.public);
    let functions: Vec<String> = public.map(|one| printer.declaration(one)).collect();
    format!(
        "{}#ifndef {guard}\n#define {guard}\n\n\
         /* All numbers: change this line to float for a controller that has no double. */\ntypedef double {name}_real;\n\n\
         {names}{types}#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n\
         /* The mechanism as it was when this code was written. */\nextern const {name}_geometry {name}_default;\n\n{}\n\
         #ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
        head("The closed-form kinematics of", title),
        functions.join("\n"),
    )
}

fn source(code: &Code, name: &str, title: &str) -> String {
    let printer = Printer { code, name, real: "real".into() };
    let functions: String = code.functions.iter().map(|one| printer.function(one)).collect();
    let math = math(&functions, name);
    let used = |constant: &str| math.contains(&format!("{name}_{constant}"));
    let own = |constant: &str| code.constants.iter().any(|known| known.name == constant);
    let constants = library::constants_named(|constant| own(constant) || used(constant));
    let constants: String = constants.iter().map(|one| printer.constant(one)).collect();
    let (of_header, others) = code.structs.split_at(types_of_header(code));
    let default = of_header.last().map_or(String::new(), |one| printer.default_value(one));
    let others: String = others.iter().map(|one| printer.structure(one)).collect();
    format!(
        "{}#include \"{name}.h\"\n\n#include <math.h>\n\ntypedef {name}_real real;\n\n#define R(x) ((real)(x))\n\n\
         {default}{constants}{math}{others}{functions}",
        head("The closed-form kinematics of", title),
    )
}

/// The functions of numbers that a text needs, directly or not.
fn math(text: &str, name: &str) -> String {
    let mut needed = String::new();
    for piece in MATH.trim_end().split("\n\n").collect::<Vec<_>>().into_iter().rev() {
        let piece = symbol(piece, name);
        let mut lines = piece.lines();
        let head = lines.find(|line| line.starts_with("static ") || line.starts_with("#define "));
        let before = head.and_then(|head| head.split('(').next()).unwrap_or_default();
        let own = before.rsplit(&format!("{name}_")).next().and_then(|own| own.split(' ').next());
        let own = format!("{name}_{}", own.unwrap_or_default());
        let uses = |text: &str| ["(", " "].iter().any(|end| text.contains(&format!("{own}{end}")));
        if uses(text) || uses(&needed) {
            needed = format!("{piece}\n\n{needed}");
        }
    }
    needed
}

/// The code as a tree, from which other languages are printed.
pub(crate) fn tree(manipulator: &Manipulator, content: Content) -> Result<Code, GenerateError> {
    Ok(Writer::new(manipulator, content)?.code())
}
