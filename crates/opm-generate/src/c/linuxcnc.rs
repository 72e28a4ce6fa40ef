//! A kinematics module for LinuxCNC around the code.

use super::print::Printer;
use super::{head, symbol};
use crate::code::Writer;
use crate::library;
use crate::names::comment;
use crate::tree::Code;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The module, without what depends on the mechanism.
const MODULE: &str = include_str!("linuxcnc.c");

/// The module; `None` where the actuated joints do not determine the pose, or the pose has more lengths or angles than
/// LinuxCNC's.
pub fn module(writer: &Writer<'_>, code: &Code, name: &str, title: &str) -> Option<String> {
    if !writer.has_forward() {
        return None;
    }
    let m = writer.manipulator;
    let (mut lengths, mut angles) = (["u", "v", "w"].into_iter(), ["a", "b", "c"].into_iter());
    let (mut from, mut to, mut named) = (String::new(), String::new(), Vec::new());
    for (i, coordinate) in m.task_coordinates().iter().enumerate() {
        let (member, unit, axis) = match coordinate.quantity {
            Quantity::Length if ["x", "y", "z"].contains(&coordinate.name) => {
                (format!("tran.{}", coordinate.name), "LENGTH", coordinate.name)
            }
            Quantity::Length => {
                let axis = lengths.next()?;
                (axis.to_owned(), "LENGTH", axis)
            }
            Quantity::Angle => {
                let axis = angles.next()?;
                (axis.to_owned(), "ANGLE", axis)
            }
        };
        named.push(format!("{} is {}", coordinate.name, axis.to_uppercase()));
        let _ = writeln!(from, "    pose[{i}] = (NAME_real)(world->{member} / NAME_{unit});");
        let _ = writeln!(to, "    world->{member} = (double)at.pose[{i}] * NAME_{unit};");
    }
    let home: String = (writer.forms.independent.iter().enumerate())
        .map(|(i, at)| format!("    home.pose[{i}] = NAME_default.home[{at}];\n"))
        .collect();
    let units = m.actuated().iter().map(|&joint| match m.coordinates()[joint].quantity {
        Quantity::Angle => "NAME_ANGLE",
        Quantity::Length => "NAME_LENGTH",
    });
    let is_angle = (0..m.coordinates().len()).map(|i| usize::from(writer.is_modulo(i)));
    let names = m.actuated().iter().map(|&joint| comment(&m.coordinates()[joint].name));
    let signs = writer.signs();
    let functions = writer.functions_after(code);
    let printer = Printer { code, name, real: "real".into() };
    let constants = library::constants_for(&functions).into_iter();
    let constants =
        constants.filter(|one| code.constants.iter().all(|known| known.name != one.name));
    let constants: String = constants.map(|one| printer.constant(&one)).collect();
    let functions: String = functions.iter().map(|one| printer.function(one)).collect();
    let module = symbol(MODULE, name)
        .replace("COORDINATE_NAMES", &named.join(", "))
        .replace("JOINT_NAMES", &names.collect::<Vec<_>>().join(", "))
        .replace("FILE_NAME", name)
        .replace("HOME_MODE", &m.home_mode().bits().to_string())
        .replace("SIGN_COUNT", &signs.to_string())
        .replace("    FROM_WORLD\n", &symbol(&from, name))
        .replace("    TO_WORLD\n", &symbol(&to, name))
        .replace("    HOME_POSE\n", &symbol(&home, name))
        .replace("ACTUATED_JOINTS", &listed(m.actuated().iter()))
        .replace("{ UNITS }", &symbol(&format!("{{ {} }}", listed(units)), name))
        .replace("{ ANGLES }", &format!("{{ {} }}", listed(is_angle)))
        .replace("CONSTANTS\n\n", &constants)
        .replace("SIGNS\n\n", &functions);
    Some(head("A kinematics module for LinuxCNC, of", title) + &module)
}

fn listed(all: impl Iterator<Item = impl ToString>) -> String {
    all.map(|one| one.to_string()).collect::<Vec<_>>().join(", ")
}
