//! A kinematics module for LinuxCNC around the code.

use super::Writer;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The module, without what depends on the mechanism.
const MODULE: &str = include_str!("linuxcnc.c");

impl Writer<'_> {
    /// The module; `None` where the actuated joints do not determine the pose, or the pose has more lengths or angles than
    /// LinuxCNC's.
    pub fn linuxcnc(&self) -> Option<String> {
        if !self.has_forward() {
            return None;
        }
        let m = self.manipulator;
        let coordinates = m.task_coordinates();
        let positions = ["x", "y", "z"];
        let mut lengths = ["u", "v", "w"].into_iter();
        let mut angles = ["a", "b", "c"].into_iter();
        let (mut from, mut to, mut named) = (String::new(), String::new(), Vec::new());
        for (i, coordinate) in coordinates.iter().enumerate() {
            let (member, unit, name) = match coordinate.quantity {
                Quantity::Length if positions.contains(&coordinate.name) => {
                    (format!("tran.{}", coordinate.name), "LENGTH", coordinate.name)
                }
                Quantity::Length => {
                    let name = lengths.next()?;
                    (name.to_owned(), "LENGTH", name)
                }
                Quantity::Angle => {
                    let name = angles.next()?;
                    (name.to_owned(), "ANGLE", name)
                }
            };
            named.push(format!("{} is {}", coordinate.name, name.to_uppercase()));
            let _ = writeln!(from, "    pose[{i}] = (NAME_real)(world->{member} / NAME_{unit});");
            let _ = writeln!(to, "        world->{member} = (double)pose[{i}] * NAME_{unit};");
        }
        let home: String = (self.forms.independent.iter().enumerate())
            .map(|(i, at)| format!("        pose[{i}] = NAME_default.home[{at}];\n"))
            .collect();
        let units = m.actuated().iter().map(|&joint| match m.coordinates()[joint].quantity {
            Quantity::Angle => "NAME_ANGLE",
            Quantity::Length => "NAME_LENGTH",
        });
        let units = units.collect::<Vec<_>>().join(", ");
        let head = self.head("A kinematics module for LinuxCNC, of");
        Some(
            head + &MODULE
                .replace("COORDINATE_NAMES", &named.join(", "))
                .replace("HOME_MODE", &m.home_mode().bits().to_string())
                .replace("    FROM_WORLD\n", &from)
                .replace("        TO_WORLD\n", &to)
                .replace("        HOME_POSE\n", &home)
                .replace("UNITS", &units),
        )
    }
}
