//! The public functions of the joint rates and of the Jacobian.
//!
//! As in `opm-core`, the closure of a leg is differentiated one section at a time, in the section's own frame. The rows of
//! the inverse of its screws are the reciprocal screws ([`screws`]), which give the rates of its joints. A section that
//! constrains the platform has further rows, of joints that it lacks: their rates are zero, which gives the rates of the
//! coordinates that follow from the others ([`follow`]).

mod follow;
mod motions;
mod screws;

use super::Writer;
use super::interface::{RETURN, UNMET};
use super::leg::uses;
use super::pose::{kind, numbers, word};
use opm_core::manipulator::Section;
use screws::ZERO;
use std::fmt::Write;

/// What the columns of rates belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Columns {
    /// The coordinates.
    Coordinates,
    /// The same, but for the Euler angles, which are singular: in their place are the rotations about the directions of
    /// the section's frame.
    Motions,
}

/// The rates of one leg: its function, how it is called, and how many joints it lacks.
struct LegRates {
    text: String,
    call: String,
    lacking: usize,
}

impl Writer<'_> {
    /// The functions of the Jacobian and of the rates.
    pub fn rates(&self) -> String {
        let columns = if self.turns() { Columns::Motions } else { Columns::Coordinates };
        let mut first_lacking = 0;
        let mut legs = Vec::new();
        for number in 0..self.forms.legs.len() {
            let leg = self.leg_rates(number, first_lacking);
            first_lacking += leg.lacking;
            legs.push(leg);
        }
        let functions: String = legs.iter().map(|leg| &*leg.text).collect();
        let calls: String = legs.iter().map(|leg| &*leg.call).collect();
        let all = self.task.coordinates.len();
        let mut body = format!("    NAME_displacements at;\n    NAME_twists t[{all}];\n");
        if self.dependent() {
            if !self.turns() {
                let _ = writeln!(body, "    real locked[{}];", (first_lacking * all).max(1));
            }
            body += UNMET;
        }
        let columns = self.columns(columns);
        let complete = format!("    status = NAME_complete(g, pose, mode, q, unmet);\n{RETURN}");
        let prelude = self.prelude(&calls, &complete);
        // The motions are given together with the coordinates that they start from.
        body += &match self.turns() {
            true => prelude.replacen(&format!("    real q[{all}];\n"), "", 1),
            false => prelude,
        };
        let _ = write!(body, "    status = NAME_close(g, pose, mode, &at);\n{RETURN}");
        body += &match self.dependent() {
            true => columns,
            false => columns.replace("q[", "pose["),
        };
        for (number, leg) in legs.iter().enumerate() {
            if !leg.call.is_empty() {
                let _ = writeln!(
                    body,
                    "    if ({}) {{\n        return NAME_LEGS + {};\n    }}",
                    leg.call,
                    number + 1
                );
            }
        }
        let (dependent, turns) = (self.dependent(), self.turns());
        if dependent && !turns {
            body += &self.eliminated(first_lacking);
        } else if !turns {
            body = body.replace(", all", ", jacobian");
        }
        let unused = if uses(&calls, "at") { "" } else { "    (void)at;\n" };
        let output = if dependent || turns { "all" } else { "jacobian" };
        let mut none = match calls.is_empty() {
            true => format!("    (void)t;\n    (void){output};\n"),
            false => String::new(),
        };
        if dependent && turns && first_lacking == 0 {
            none += "    (void)locked;\n";
        }
        let mut body = format!("{body}{unused}{none}    return 0;\n");
        let head = "int NAME_jacobian(const NAME_geometry *g, const NAME_real pose[], unsigned mode,\n                 \
             NAME_real jacobian[NAME_JOINTS * NAME_COORDINATES])\n";
        let mut motions = String::new();
        if turns {
            motions = self.motions(&body);
            body = self.by_coordinates(first_lacking);
        }
        let jacobian = match dependent {
            true => motions + &self.of_independent(head, &body),
            false => format!("{motions}{head}{{\n{body}}}\n\n"),
        };
        format!(
            "{functions}{jacobian}\
             int NAME_rates(const NAME_geometry *g, const NAME_real pose[], unsigned mode, const NAME_real rates[],\n                 \
             NAME_real joint_rates[])\n{{\n    real jacobian[NAME_JOINTS * NAME_COORDINATES];\n    int i, j;\n    \
             int status = NAME_jacobian(g, pose, mode, jacobian);\n{RETURN}    \
             status = NAME_numbers(rates, NAME_COORDINATES);\n{RETURN}    \
             for (i = 0; i < NAME_JOINTS; ++i) {{\n        joint_rates[i] = 0;\n        \
             for (j = 0; j < NAME_COORDINATES; ++j) {{\n            \
             joint_rates[i] += jacobian[i * NAME_COORDINATES + j] * rates[j];\n        }}\n    }}\n    return 0;\n}}\n\n"
        )
    }

    /// Statements that give the twists `t` of the sections for a unit of each column.
    pub fn columns(&self, of: Columns) -> String {
        let mut text = String::new();
        let count = self.task.coordinates.len();
        let mut twists = vec![[ZERO.to_owned(), ZERO.to_owned(), "0".to_owned()]; count];
        for (place, section) in [Section::Lower, Section::Upper].into_iter().enumerate() {
            let screws = self.coordinate_screws(section, of, &mut text);
            for (number, screw) in numbers(self.task, &self.forms, section).into_iter().zip(screws)
            {
                twists[number][place] = screw;
            }
        }
        if let Some(height) = &self.forms.height {
            twists[height.coordinate][2] = "1".to_owned();
        }
        for (number, [lower, upper, rise]) in twists.iter().enumerate() {
            let _ = writeln!(text, "    t[{number}] = NAME_twists_of({lower}, {upper}, {rise});");
        }
        text
    }

    /// The function of one leg: the columns of its joints' rates, and of the rates of joints that it lacks, whose rows begin
    /// at `first_lacking`.
    fn leg_rates(&self, number: usize, first_lacking: usize) -> LegRates {
        let leg = &self.forms.legs[number];
        let count = self.task.coordinates.len();
        let other = match leg.first {
            Section::Lower => Section::Upper,
            Section::Upper => Section::Lower,
        };
        let rows = [leg.first, other].map(|section| self.section_rows(number, section));
        let mut lacking = first_lacking;
        let mut columns = String::new();
        let lean = leg.lift.as_ref().and_then(|lift| lift.lean);
        let sloped = self.forms.height.filter(|height| height.slope != 0.0).is_some();
        let mut tau = false;
        for (place, (section, rows)) in [leg.first, other].into_iter().zip(&rows).enumerate() {
            let form = leg.section(section);
            let word = word(section);
            let mut twist = format!("t[i].{word}");
            if place == 1 && tau {
                twist = match section {
                    // L = v exp(I tau)
                    Section::Lower => format!("NAME_add({twist}, tau, along)"),
                    // U = exp(-I tau) b
                    Section::Upper => {
                        self.shifted_back(number, &format!("NAME_add({twist}, -tau, along)"))
                    }
                };
            }
            if place == 1 && leg.lift.is_some() {
                let slope = if tau && sloped { " + g->slope * tau" } else { "" };
                let _ = writeln!(columns, "        const real rise = t[i].rise{slope};");
            }
            if lean.is_some_and(|lean| lean.section == section) {
                let rise = if place == 1 { "rise" } else { "t[i].rise" };
                twist = format!("NAME_add({twist}, -{rise}, leaning)");
            }
            if !rows.free.is_empty() || !rows.lacking.is_empty() {
                let _ = writeln!(columns, "        const NAME_vector {word}_twist = {twist};");
            }
            let rate = |row: usize| format!("NAME_dot({word}.s{row}, {word}_twist)");
            for (row, &joint) in (1..).zip(&rows.free) {
                let part = form.slider.filter(|(slider, _)| *slider == joint);
                let part =
                    part.map_or(String::new(), |_| format!(" / g->leg{}_part.rate", number + 1));
                match form.coordinates[joint] {
                    Some(coordinate) => {
                        let at = coordinate * count;
                        let _ = writeln!(columns, "        all[{at} + i] = {}{part};", rate(row));
                    }
                    None => {
                        tau = true;
                        let sign = if section == Section::Lower { "-" } else { "" };
                        let _ = writeln!(
                            columns,
                            "        const real tau = {sign}{}{part};",
                            rate(row)
                        );
                    }
                }
            }
            for &row in &rows.lacking {
                let _ =
                    writeln!(columns, "        locked[{} + i] = {};", lacking * count, rate(row));
                lacking += 1;
            }
        }
        if let Some(lift) = &leg.lift {
            let at = lift.coordinate * count;
            let _ =
                writeln!(columns, "        all[{at} + i] = g->leg{}_lift.rate * rise;", number + 1);
        }
        let lacking = lacking - first_lacking;
        if columns.is_empty() {
            return LegRates { text: String::new(), call: String::new(), lacking };
        }
        let [first, second] = rows.map(|rows| rows.text);
        let mut body = first + &second;
        if tau && uses(&columns, "along") {
            let _ = writeln!(body, "    const NAME_vector along = {};", self.along_moved(other));
        }
        let _ = write!(body, "    for (i = 0; i < {count}; ++i) {{\n{columns}    }}\n");
        self.leg_function(number, &body, lacking)
    }

    /// A function with those of the parameters that its body uses.
    fn leg_function(&self, number: usize, body: &str, lacking: usize) -> LegRates {
        let of_lower = super::pose::displacement_type(kind(self.task, Section::Lower));
        let parameters = [
            ("g", "const NAME_geometry *g".to_owned(), "g"),
            ("v", format!("{} v", of_lower.unwrap_or("int")), "v"),
            ("at", "const NAME_displacements *at".to_owned(), "&at"),
            ("t", "const NAME_twists t[]".to_owned(), "t"),
            ("all", "real all[]".to_owned(), "all"),
            ("locked", "real locked[]".to_owned(), "locked"),
        ];
        let used: Vec<_> = parameters.iter().filter(|(name, ..)| uses(body, name)).collect();
        let declared: Vec<&str> = used.iter().map(|(_, declared, _)| &**declared).collect();
        let passed: Vec<&str> = used.iter().map(|(.., passed)| *passed).collect();
        let name = crate::names::comment(&self.manipulator.mechanism().legs[number].name);
        let text = format!(
            "/* Leg {0}, {name}: the rates of its joints for the twists t of its sections. It returns 1 where it is singular. */\n\
             static int NAME_leg{0}_rates({1})\n{{\n    int i;\n{body}    return 0;\n}}\n\n",
            number + 1,
            declared.join(", ")
        );
        LegRates {
            text,
            call: format!("NAME_leg{}_rates({})", number + 1, passed.join(", ")),
            lacking,
        }
    }
}
