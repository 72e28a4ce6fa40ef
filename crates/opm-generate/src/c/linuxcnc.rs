//! A kinematics module for LinuxCNC around the code.

use super::Writer;
use crate::names::comment;
use opm_core::manipulator::Section;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The module, without what depends on the mechanism.
const MODULE: &str = include_str!("linuxcnc.c");
const DETERMINANT: &str = include_str!("determinant.c");

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
        let [_, unknowns] = self.equations();
        let parts = self.parts();
        let mut found = String::new();
        for (i, part) in parts.iter().enumerate() {
            let _ = writeln!(
                found,
                "        const int rows{i}[] = {{ {} }}, columns{i}[] = {{ {} }};\n        \
                 const real part{i} = determinant(a, rows{i}, columns{i}, {});",
                listed(&part.rows),
                listed(&part.columns),
                part.rows.len()
            );
        }
        for i in 0..parts.len() {
            let _ = writeln!(
                found,
                "        found[{i}] = part{i} > NAME_VANISHED ? 1 : part{i} < -NAME_VANISHED ? -1 : 0;"
            );
        }
        if parts.is_empty() {
            found += "        found[0] = 0;\n";
        }
        let most = parts.iter().map(|part| part.rows.len()).max().unwrap_or(1);
        let determinant = if parts.is_empty() { "" } else { DETERMINANT };
        let all = self.steps_in_all();
        let head = self.head("A kinematics module for LinuxCNC, of");
        let module = MODULE
            .replace("DETERMINANT\n", determinant)
            .replace("COORDINATE_NAMES", &named.join(", "))
            .replace("JOINT_NAMES", &names)
            .replace("HOME_MODE", &m.home_mode().bits().to_string())
            .replace("    FROM_WORLD\n", &from)
            .replace("    TO_WORLD\n", &to)
            .replace("    HOME_POSE\n", &home)
            .replace("        PARTS\n", &found)
            .replace("PART_COUNT", &parts.len().max(1).to_string())
            .replace("MOST", &most.to_string())
            .replace("ACTUATED_JOINTS", &listed(m.actuated()))
            .replace("ANGLES", &listed(&angles.collect::<Vec<_>>()))
            .replace("STATE ", &if all { format!("q[{unknowns}], ") } else { String::new() })
            .replace("QUERIED ", if all { "q, " } else { "" });
        // What is left are words in capitals.
        Some(head + &self.with_counts(&module.replace("{ UNITS }", &format!("{{ {units} }}"))))
    }

    /// The parts of the equations of a step whose determinants tell assemblies apart: those of the two sections, where the
    /// joints of one of them do not depend on what the other one does; otherwise the whole. None where there are more joints
    /// than freedoms.
    fn parts(&self) -> Vec<DeterminantPart> {
        let [rows, unknowns] = self.equations();
        if rows != unknowns {
            return Vec::new();
        }
        if !self.dependent() {
            let count = self.task.lower_count;
            let of = [(0..count).collect::<Vec<_>>(), (count..unknowns).collect()];
            for (own, section) in [Section::Lower, Section::Upper].into_iter().enumerate() {
                let (alone, rest): (Vec<usize>, Vec<usize>) = (0..rows).partition(|&row| {
                    self.only_of(self.manipulator.actuated()[row]) == Some(section)
                });
                if alone.len() == of[own].len() && !alone.is_empty() && !rest.is_empty() {
                    return vec![
                        DeterminantPart { rows: alone, columns: of[own].clone() },
                        DeterminantPart { rows: rest, columns: of[1 - own].clone() },
                    ];
                }
            }
        }
        vec![DeterminantPart { rows: (0..rows).collect(), columns: (0..unknowns).collect() }]
    }

    /// The one section whose displacement determines a joint coordinate; `None` where both do.
    fn only_of(&self, coordinate: usize) -> Option<Section> {
        for leg in &self.forms.legs {
            let leans = leg.lift.as_ref().is_some_and(|lift| lift.lean.is_some());
            for section in [Section::Lower, Section::Upper] {
                if leg.section(section).coordinates.contains(&Some(coordinate)) {
                    let alone = (leg.first == section || !leg.bridged) && !leans;
                    return alone.then_some(section);
                }
            }
        }
        // A lift.
        self.forms.height.filter(|height| height.slope == 0.0).map(|height| height.section)
    }
}

/// Rows and columns of the equations of a step.
struct DeterminantPart {
    rows: Vec<usize>,
    columns: Vec<usize>,
}

fn listed(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}
