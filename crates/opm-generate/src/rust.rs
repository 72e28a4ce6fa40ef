//! Source code in Rust: a package without allocation that needs no standard library.
//!
//! The closed forms are those of the C code, printed from their tree into a module that is not public. Around it stands an
//! interface as is usual in Rust: arrays of the right length, and `Result`.

mod print;

use crate::golden::{angles, listed, rows};
use crate::names::package;
use crate::tree::Code;
use crate::{Content, GenerateError, Package, c};
use opm_core::Manipulator;

const LIB: &str = include_str!("rust/package/lib.rs");
const FORWARD: &str = include_str!("rust/package/forward.rs");
const DYNAMICS: &str = include_str!("rust/package/dynamics.rs");
const MATH: &str = include_str!("rust/package/math.rs");
const TEST: &str = include_str!("rust/package/golden.rs");
const CARGO: &str = include_str!("rust/package/Cargo.toml.txt");

/// Keywords, and crates that Rust or the package has.
const RESERVED: &str = "abstract alloc as async await become box break const continue core crate do dyn else enum \
     extern false final fn for gen if impl in let libm loop macro match mod move mut override \
     priv proc_macro pub ref return self static std struct super test trait true try type typeof \
     unsafe unsized use virtual where while yield";

/// Writes the kinematics of a mechanism as a package of Rust.
///
/// # Errors
/// The mechanism has more two-valued choices than a `u32` has bits.
pub fn rust(manipulator: &Manipulator, content: Content) -> Result<Package, GenerateError> {
    let code = c::tree(manipulator, content)?;
    // A package has a lower-case name.
    let name = package(&manipulator.mechanism().name.to_lowercase(), RESERVED);
    let files = [
        ("Cargo.toml", CARGO.replace("CRATE", &name)),
        ("src/lib.rs", lib(manipulator, &code, &name)),
        ("src/kinematics.rs", kinematics(&code)),
        ("src/math.rs", MATH.to_owned()),
        ("tests/golden.rs", golden(manipulator, &name)),
    ];
    let files = files.map(|(file, text)| (file.to_owned(), text)).into();
    Ok(Package { name, files })
}

fn kinematics(code: &Code) -> String {
    let text = print::module(code);
    let functions =
        ["abs", "acos", "asin", "atan2", "ceil", "cos", "max", "min", "round", "sin", "sqrt"];
    let mut used: Vec<&str> = functions
        .into_iter()
        .filter(|name| {
            let call = format!("{name}(");
            text.match_indices(&call).any(|(at, _)| {
                !text[..at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
            })
        })
        .collect();
    if text.contains("by_type(") {
        used.push("by_type");
    }
    format!(
        "//! The closed forms, in the letters of the method: `L(q_lower) U(q_upper) = v b`, and `tau` for the displacement along\n\
         //! what the two subgroups share. A status is zero, or says why there is no answer.\n\n\
         #![allow(missing_docs, non_snake_case, non_upper_case_globals)]\n\nuse super::Real;\nuse super::math::{{{}}};\n\n{text}",
        used.join(", ")
    )
}

fn lib(m: &Manipulator, code: &Code, name: &str) -> String {
    let signs = m.format_mode(m.home_mode());
    let mode = match signs.is_empty() {
        true => "There is one mode, 0.".to_owned(),
        false => format!("At home it is {}: `{signs}`.", m.home_mode().bits()),
    };
    let text = LIB
        .replace("TITLE", &crate::names::comment(&m.mechanism().name))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("HOME_MODE", &m.home_mode().bits().to_string())
        .replace("//! MODE", &format!("//! {mode}"))
        .replace("CRATE", name);
    let home = format!(
        "\n/// The pose at home.\npub const HOME: [Real; COORDINATES] = [{}];\n",
        listed(&m.home_pose())
    );
    let own = |name: &str, text: &'static str| {
        let has = code.functions.iter().any(|function| function.name == name);
        if has { text } else { "" }
    };
    text + &home + own("forward", FORWARD) + own("inverse_dynamics", DYNAMICS)
}

/// A test that compares the code with poses that opm solved.
fn golden(m: &Manipulator, name: &str) -> String {
    let rows = rows(m, |mode, status, [pose, joints, imaginary]| {
        format!("    ({mode}, {status}, [{pose}], &[{joints}], &[{imaginary}]),\n")
    });
    let angles = angles(m, ["true", "false"]);
    TEST.replace("CRATE", name)
        .replace("TITLE", &crate::names::comment(&m.mechanism().name))
        .replace("VERSION", env!("CARGO_PKG_VERSION"))
        .replace("ANGLES", &angles)
        .replace("    ROWS\n", &rows)
}
