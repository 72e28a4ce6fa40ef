//! A kinematics module for LinuxCNC around the code.

use super::Writer;
use crate::names::comment;
use opm_core::manipulator::Section;
use opm_core::manipulator::form::LegForm;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The module, without what depends on the mechanism.
const MODULE: &str = include_str!("linuxcnc.c");
const DETERMINANT: &str = include_str!("determinant.c");
const SECTIONS: &str = include_str!("sections.c");
const PLAIN_SECTIONS: &str = include_str!("plain_sections.c");

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
            let _ = writeln!(to, "    world->{member} = (double)at.pose[{i}] * NAME_{unit};");
        }
        let home: String = (self.forms.independent.iter().enumerate())
            .map(|(i, at)| format!("    home.pose[{i}] = NAME_default.home[{at}];\n"))
            .collect();
        let units = m.actuated().iter().map(|&joint| match m.coordinates()[joint].quantity {
            Quantity::Angle => "NAME_ANGLE",
            Quantity::Length => "NAME_LENGTH",
        });
        let units = units.collect::<Vec<_>>().join(", ");
        let angles = (0..m.coordinates().len()).map(|i| usize::from(self.is_modulo(i)));
        let names = m.actuated().iter().map(|&joint| comment(&m.coordinates()[joint].name));
        let names = names.collect::<Vec<_>>().join(", ");
        let [rows, unknowns] = self.equations();
        let sections = self.sections();
        let (determinant, parts, count) = match &sections {
            _ if rows != unknowns => (String::new(), "        found[0] = 0;\n".to_owned(), 1),
            Some(sections) => (
                DETERMINANT.to_owned() + &self.of_sections(sections),
                "        status = signs_of_sections(a, pose, found);\n".to_owned(),
                2,
            ),
            None => (
                DETERMINANT.to_owned(),
                format!(
                    "        real whole[{0}];\n        int i, j;\n        for (i = 0; i < {unknowns}; ++i) {{\n            \
                     for (j = 0; j < {unknowns}; ++j) {{\n                whole[i * {unknowns} + j] = a[i * WIDTH + j];\n            \
                     }}\n        }}\n        found[0] = sign_of(whole, {unknowns});\n",
                    unknowns * unknowns
                ),
                1,
            ),
        };
        let all = self.steps_in_all();
        let head = self.head("A kinematics module for LinuxCNC, of");
        let module = MODULE
            .replace("DETERMINANT\n", &determinant)
            .replace("COORDINATE_NAMES", &named.join(", "))
            .replace("JOINT_NAMES", &names)
            .replace("HOME_MODE", &m.home_mode().bits().to_string())
            .replace("    FROM_WORLD\n", &from)
            .replace("    TO_WORLD\n", &to)
            .replace("    HOME_POSE\n", &home)
            .replace("        PARTS\n", &parts)
            .replace("PART_COUNT", &count.to_string())
            .replace("ACTUATED_JOINTS", &listed(m.actuated()))
            .replace("ANGLES", &listed(&angles.collect::<Vec<_>>()))
            .replace("STATE ", &if all { format!("q[{unknowns}], ") } else { String::new() })
            .replace("QUERIED ", if all { "q, " } else { "" });
        // What is left are words in capitals.
        Some(head + &self.with_counts(&module.replace("{ UNITS }", &format!("{{ {units} }}"))))
    }

    /// What the determinants of the two sections consist of; `None` where one of them is not square: then assemblies are told
    /// apart by that of the whole.
    fn sections(&self) -> Option<Sections> {
        if self.dependent() || self.forms.height.is_some_and(|height| height.slope != 0.0) {
            return None;
        }
        // The imaginary joints that follow from the upper section.
        let above = |leg: &LegForm| leg.bridged && leg.first == Section::Upper;
        let taus: Vec<usize> =
            (0..self.forms.legs.len()).filter(|&leg| above(&self.forms.legs[leg])).collect();
        let numbers: Vec<usize> =
            taus.iter().map(|&leg| self.forms.legs[leg].imaginary).collect::<Option<_>>()?;
        let (mut lower, mut moved, mut upper) = (Vec::new(), Vec::new(), Vec::new());
        for (row, &coordinate) in self.manipulator.actuated().iter().enumerate() {
            match self.section_of(coordinate)? {
                (leg, Section::Lower) => {
                    lower.push(row);
                    moved.push(taus.iter().position(|&tau| Some(tau) == leg));
                }
                (_, Section::Upper) => upper.push(row),
            }
        }
        let (own, all) = (self.task.lower_count, self.task.coordinates.len());
        let square = lower.len() == own + taus.len() && upper.len() + taus.len() == all - own;
        (square && own > 0 && own < all).then_some(Sections { numbers, lower, moved, upper })
    }

    /// The functions of the signs of the determinants of the sections.
    fn of_sections(&self, sections: &Sections) -> String {
        let Sections { numbers, lower, moved, upper } = sections;
        let imaginary = self.manipulator.imaginary();
        let turns = numbers.iter().map(|&i| usize::from(imaginary[i].quantity == Quantity::Angle));
        let moved: Vec<String> =
            moved.iter().map(|k| k.map_or("-1".to_owned(), |k| k.to_string())).collect();
        let stepped = match self.turns() {
            true => {
                "        NAME_stepped(&NAME_default, pose, pose, step, way, next);\n".to_owned()
            }
            false => (self.manipulator.task_coordinates().iter().enumerate())
                .map(|(j, c)| {
                    let unit =
                        if c.quantity == Quantity::Length { " * NAME_default.size" } else { "" };
                    format!("        next[{j}] = pose[{j}] + way * step[{j}]{unit};\n")
                })
                .collect(),
        };
        let own = self.task.lower_count;
        let none = if upper.is_empty() { "0".to_owned() } else { listed(upper) };
        let template = if numbers.is_empty() { PLAIN_SECTIONS } else { SECTIONS };
        template
            .replace("            STEPPED\n", &super::steps::indented(&stepped))
            .replace("        STEPPED\n", &stepped)
            .replace("NUMBERS", &listed(numbers))
            .replace("TURNS", &listed(&turns.collect::<Vec<_>>()))
            .replace("LOWER_ROWS", &listed(lower))
            .replace("UPPER_ROWS", &none)
            .replace("UPPER_COUNT", &upper.len().max(1).to_string())
            .replace("MOVED", &moved.join(", "))
            .replace("TAUS", &numbers.len().to_string())
            .replace("LOWER", &lower.len().to_string())
            .replace("UPPER", &(self.task.coordinates.len() - own).to_string())
            .replace("BELOW", &own.to_string())
    }

    /// The leg and the section of a joint coordinate; of a lift, the section that has the height. `None` where a lift leans.
    fn section_of(&self, coordinate: usize) -> Option<(Option<usize>, Section)> {
        for (number, leg) in self.forms.legs.iter().enumerate() {
            if leg.lift.as_ref().is_some_and(|lift| lift.lean.is_some()) {
                return None;
            }
            for section in [Section::Lower, Section::Upper] {
                if leg.section(section).coordinates.contains(&Some(coordinate)) {
                    return Some((Some(number), section));
                }
            }
        }
        Some((None, self.forms.height?.section))
    }
}

/// The rows of the determinants of the two sections.
struct Sections {
    /// The numbers of the imaginary joints that follow from the upper section.
    numbers: Vec<usize>,
    /// The actuated joints of the lower section, and which of those imaginary joints moves each.
    lower: Vec<usize>,
    moved: Vec<Option<usize>>,
    /// The actuated joints of the upper section.
    upper: Vec<usize>,
}

fn listed(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}
