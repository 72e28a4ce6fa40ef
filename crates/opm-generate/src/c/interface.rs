//! The public functions.

use super::geometry::{Geometry, rotation, vector};
use super::leg::{Given, uses};
use super::pose::{self, displacement_type, kind, word};
use super::{Writer, geometry};
use opm_core::group::SubspaceKind;
use opm_core::manipulator::Section;
use opm_core::manipulator::form::LegForm;
use std::fmt::Write;

/// What the header declares.
const INTERFACE: &str = include_str!("interface.h");

/// Both sections, with the symbols of their displacements.
const SECTIONS: [(Section, &str); 2] = [(Section::Lower, "v"), (Section::Upper, "b")];

/// The deficits of a leg whose constraint is not satisfied.
pub const UNMET: &str = "    real unmet[2] = { 0, 0 };\n";

/// Returns from a function whose status is not zero.
pub const RETURN: &str = "    if (status != 0) {\n        return status;\n    }\n";

/// Statements that give the values of joints, with what they declare.
struct Values {
    declarations: String,
    text: String,
}

impl Writer<'_> {
    /// The definitions of the public functions, and of what they share.
    pub fn interface(&self) -> String {
        let parts = [
            self.close(),
            self.inverse(),
            self.actuated(),
            self.nearest(),
            self.deficits(),
            self.limits(),
            self.transform() + "\n",
            self.rates(),
            self.twist(),
            self.forward(),
        ];
        parts.concat()
    }

    /// The frames of the sections, and the platform at home.
    pub fn add_frames(&self, geometry: &mut Geometry) {
        for section in [Section::Lower, Section::Upper] {
            let frame = match section {
                Section::Lower => &self.task.lower,
                Section::Upper => &self.task.upper,
            };
            if frame.kind == SubspaceKind::Identity {
                continue;
            }
            let word = word(section);
            let value =
                format!("{{ {}, {} }}", vector(&frame.origin.coords), rotation(&frame.axes));
            let what = format!("The frame of the {word} sections, base coordinates.");
            geometry.add("NAME_frame", &format!("{word}_frame"), &what, value);
        }
        let platform = self.manipulator.mechanism().platform.coords;
        geometry.add(
            "NAME_vector",
            "platform",
            "The platform's reference point at home, base coordinates.",
            vector(&platform),
        );
        if self.forms.home_orientation_inverse.is_some() {
            let home = self.task.home_orientation().to_rotation_matrix().into_inner();
            geometry.add(
                "NAME_rotation",
                "orientation",
                "The platform's orientation at home, base coordinates.",
                geometry::rotation(&home),
            );
        }
    }

    /// Whether coordinates follow from those of a pose.
    pub fn dependent(&self) -> bool {
        !self.forms.steps.is_empty()
    }

    /// Statements that declare, and then give, what calls of the legs' functions use: `q`, `v`, `b`, `rise`. `status` is
    /// the pose's; `complete` is done after its check.
    pub fn prelude(&self, calls: &str, complete: &str) -> String {
        let mut text = String::new();
        let (mut declared, mut given) = (String::new(), String::new());
        let used = |symbol: &str| uses(calls, symbol);
        for (section, symbol) in SECTIONS {
            if let (true, Some(of_type)) =
                (used(symbol), displacement_type(kind(self.task, section)))
            {
                let _ = writeln!(declared, "    {of_type} {symbol};");
                let call = pose::call(self.task, &self.forms, section);
                let _ = writeln!(given, "    {symbol} = {call};");
            }
        }
        if used("rise") {
            declared += "    real rise;\n";
            let _ = writeln!(given, "    rise = {};", self.rise());
        }
        if self.dependent() {
            let _ = writeln!(text, "    real q[{}];", self.task.coordinates.len());
        }
        text += &declared;
        text += "    int status = NAME_check(pose);\n";
        text += RETURN;
        if self.dependent() {
            text += complete;
        } else {
            given =
                given.replace("q[", "pose[").replace("displacement(g, q)", "displacement(g, pose)");
            given = given.replace("displacement(q)", "displacement(pose)");
        }
        text + &given
    }

    /// The calls of the functions of a leg.
    pub fn calls(&self, leg: usize) -> Vec<String> {
        let functions = self.legs[leg].iter().filter(|function| !function.call.is_empty());
        functions.map(|function| function.call.clone()).collect()
    }

    /// The function that solves all legs.
    fn close(&self) -> String {
        let all: String = (0..self.legs.len()).flat_map(|leg| self.calls(leg)).collect();
        let missed = uses(&all, "missed");
        let complete = format!("    status = NAME_complete(g, pose, mode, q, unmet);\n{RETURN}");
        let mut body = if missed { "    real missed = 0;\n".to_owned() } else { String::new() };
        if uses(&all, "near") {
            body += "    const real near = 0;\n";
        }
        if self.dependent() {
            body += UNMET;
        }
        body += &self.prelude(&all, &complete);
        for leg in 0..self.legs.len() {
            let calls: Vec<String> =
                self.calls(leg).iter().map(|call| call.replace("missed", "&missed")).collect();
            if !calls.is_empty() {
                let _ = writeln!(
                    body,
                    "    if ({}) {{\n        return {};\n    }}",
                    calls.join(" || "),
                    leg + 1
                );
            }
        }
        format!(
            "/* The displacements of all joints at a pose in a mode, and what NAME_inverse returns. */\n\
             static int NAME_close(const NAME_geometry *g, const real pose[], unsigned mode, NAME_displacements *at)\n\
             {{\n{}    return status;\n}}\n\n",
            with_unused(&body, &["g", "mode"])
        )
    }

    /// Statements that write the values of joints from the displacements, and those of the imaginary joints. All angles are
    /// computed in one loop, which compilers turn into vectors.
    fn values(&self, joints: &[(String, usize)], with_imaginary: bool) -> Values {
        let mut directions = Vec::new();
        let mut angle = |field: &str| {
            let place = directions.iter().position(|known| known == field);
            let place = place.unwrap_or_else(|| {
                directions.push(field.to_owned());
                directions.len() - 1
            });
            format!("angle[{place}]")
        };
        let mut text = String::new();
        for (target, coordinate) in joints {
            let field = format!("at.{}", self.fields[*coordinate]);
            let value = match (self.given(*coordinate), self.ball_of(*coordinate)) {
                (_, Some(half)) => {
                    let half = format!("at.{half}");
                    let turned = format!("NAME_turned({}, {half}.im)", angle(&half));
                    format!("g->joint[{coordinate}].home + {field} * {turned}")
                }
                (Given::Value, _) => format!("g->joint[{coordinate}].home + {field}"),
                (Given::Direction | Given::Turns, _) => {
                    format!("NAME_reported(&g->joint[{coordinate}], {})", angle(&field))
                }
            };
            let _ = writeln!(text, "    {target} = {value};");
        }
        for (number, leg) in self.forms.legs.iter().enumerate().filter(|_| with_imaginary) {
            if let Some((imaginary, value)) = self.imaginary_value(leg, number, &mut angle) {
                let _ = writeln!(text, "    imaginary[{imaginary}] = {value};");
            }
        }
        if directions.is_empty() {
            return Values { declarations: String::new(), text };
        }
        // Whole vectors of the shortest kind: no angle is left over.
        let count = directions.len().next_multiple_of(2);
        let mut gathered = String::new();
        for (number, field) in directions.iter().enumerate() {
            let _ = writeln!(
                gathered,
                "    re[{number}] = {field}.re;\n    im[{number}] = {field}.im;"
            );
        }
        for number in directions.len()..count {
            let _ = writeln!(gathered, "    re[{number}] = 1;\n    im[{number}] = 0;");
        }
        let _ = write!(
            gathered,
            "    for (i = 0; i < {count}; ++i) {{\n        angle[i] = NAME_atan2(im[i], re[i]);\n    }}\n"
        );
        let declarations =
            format!("    real re[{count}], im[{count}], angle[{count}];\n    int i;\n");
        Values { declarations, text: gathered + &text }
    }

    /// The value of an imaginary joint from the displacement of its leg along the intersection motion.
    pub fn imaginary_value(
        &self,
        leg: &LegForm,
        number: usize,
        mut angle: impl FnMut(&str) -> String,
    ) -> Option<(usize, String)> {
        let (imaginary, tau) = (leg.imaginary?, self.tau(leg)?);
        let joint = &self.manipulator.imaginary()[imaginary];
        let sense = if joint.displacement(joint.home + 1.0) > 0.0 { "+" } else { "-" };
        let field = format!("at.tau_{}", number + 1);
        let value = if tau == Given::Direction { angle(&field) } else { field };
        Some((imaginary, format!("g->imaginary[{imaginary}] {sense} {value}")))
    }

    fn inverse(&self) -> String {
        let joints: Vec<_> = (0..self.fields.len()).map(|i| (format!("joints[{i}]"), i)).collect();
        let Values { declarations, text } = self.values(&joints, true);
        let unused = if uses(&text, "imaginary") { "" } else { "    (void)imaginary;\n" };
        format!(
            "int NAME_inverse(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real joints[],\n                 \
             NAME_real imaginary[])\n\
             {{\n    NAME_displacements at;\n{declarations}    const int status = NAME_close(g, pose, mode, &at);\n{RETURN}{text}{unused}    \
             return 0;\n}}\n\n"
        )
    }

    fn actuated(&self) -> String {
        let actuated = self.manipulator.actuated().iter().enumerate();
        let joints: Vec<_> =
            actuated.map(|(place, &i)| (format!("actuated[{place}]"), i)).collect();
        let Values { declarations, text } = self.values(&joints, false);
        let unused = if text.is_empty() { "    (void)actuated;\n" } else { "" };
        format!(
            "int NAME_actuated(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real actuated[])\n\
             {{\n    NAME_displacements at;\n{declarations}    const int status = NAME_close(g, pose, mode, &at);\n{RETURN}{text}{unused}    \
             return 0;\n}}\n\n"
        )
    }

    /// The public function of the reach deficits.
    fn deficits(&self) -> String {
        let all: String = (0..self.legs.len()).flat_map(|leg| self.calls(leg)).collect();
        let mut body = String::from("    NAME_displacements at;\n");
        if uses(&all, "near") {
            body += "    const real near = 0;\n";
        }
        let clear = "    for (i = 0; i < 2 * NAME_LEGS; ++i) {\n        deficits[i] = 0;\n    }\n";
        let mut complete = format!("{clear}    status = NAME_complete(g, pose, mode, q, unmet);\n");
        complete += "    if (status > 0) {\n        deficits[2 * (status - 1)] = unmet[0];\n        \
                     deficits[2 * (status - 1) + 1] = unmet[1];\n    }\n";
        complete += RETURN;
        body += if self.dependent() {
            "    real unmet[2] = { 0, 0 };\n    int i;\n"
        } else {
            "    int i;\n"
        };
        body += &self.prelude(&all, &complete);
        if !self.dependent() {
            body += clear;
        }
        for leg in 0..self.legs.len() {
            let first = self.forms.legs[leg].first;
            let place = |number: usize| {
                let section = match (number, first) {
                    (0, Section::Lower) | (1, Section::Upper) => 0,
                    _ => 1,
                };
                format!("&deficits[{}]", 2 * leg + section)
            };
            let functions = self.legs[leg].iter().enumerate();
            let calls: Vec<String> = functions
                .filter(|(_, function)| !function.call.is_empty())
                .map(|(number, function)| {
                    function.call.replace("missed", &place(number)).replace(", at", ", &at")
                })
                .collect();
            if calls.is_empty() {
                continue;
            }
            let _ = writeln!(
                body,
                "    if (({}) && status == 0) {{\n        status = {};\n    }}",
                calls.join(" || "),
                leg + 1
            );
        }
        let body = if all.is_empty() { body + "    (void)at;\n" } else { body };
        format!(
            "int NAME_deficits(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real deficits[2 * NAME_LEGS])\n\
             {{\n{}    return status;\n}}\n\n",
            with_unused(&body, &["g", "mode"])
        )
    }

    fn limits(&self) -> String {
        "int NAME_limits(const NAME_geometry *g, const NAME_real joints[])\n\
         {\n    int i;\n    for (i = 0; i < NAME_JOINTS; ++i) {\n        \
         const NAME_joint *joint = &g->joint[i];\n        const real slack = NAME_slack(joint);\n        \
         if (!(joints[i] >= joint->low - slack && joints[i] <= joint->high + slack)) {\n            \
         return i + 1;\n        }\n    }\n    return 0;\n}\n\n"
            .to_owned()
    }

    /// The displacement of a section in base coordinates, from its symbol.
    pub fn body_of(&self, section: Section, symbol: &str) -> String {
        let zero = "NAME_vector_of(0, 0, 0)";
        let identity = "NAME_about_third(NAME_complex_of(1, 0))";
        let (rotation, translation) = match kind(self.task, section) {
            SubspaceKind::Identity => (identity.to_owned(), zero.to_owned()),
            SubspaceKind::Planar => (
                format!("NAME_about_third({symbol}.rotation)"),
                format!("NAME_vector_of({symbol}.translation.re, {symbol}.translation.im, 0)"),
            ),
            SubspaceKind::Spherical => (symbol.to_owned(), zero.to_owned()),
            SubspaceKind::Cylindrical => (
                format!("NAME_about_third(NAME_unit({symbol}.angle))"),
                format!("NAME_vector_of(0, 0, {symbol}.advance)"),
            ),
            SubspaceKind::TranslationalPlane => {
                (identity.to_owned(), format!("NAME_vector_of({symbol}.re, {symbol}.im, 0)"))
            }
            SubspaceKind::TranslationalSpace => (identity.to_owned(), symbol.to_owned()),
        };
        format!("NAME_body_of(&g->{}_frame, {rotation}, {translation})", word(section))
    }

    /// The public function of the platform's pose.
    fn transform(&self) -> String {
        let complete = format!("    status = NAME_complete(g, pose, mode, q, unmet);\n{RETURN}");
        let upper = kind(self.task, Section::Upper) != SubspaceKind::Identity;
        let calls = if upper { "v b" } else { "v" };
        let rise = if self.forms.height.is_some() { " rise" } else { "" };
        let mut body =
            String::from("    NAME_body body;\n    NAME_rotation r;\n    NAME_vector p;\n");
        if self.dependent() {
            body += UNMET;
        }
        body += &self.prelude(&format!("{calls}{rise}"), &complete);
        let _ = writeln!(body, "    body = {};", self.body_of(Section::Lower, "v"));
        if upper {
            let _ = writeln!(
                body,
                "    body = NAME_body_product(body, {});",
                self.body_of(Section::Upper, "b")
            );
        }
        match self.forms.height.map(|height| height.section) {
            None => {}
            Some(Section::Lower) => {
                body += "    body.translation = NAME_add(body.translation, rise, g->lower_frame.axes.z);\n";
            }
            Some(Section::Upper) => {
                body += "    body.translation = NAME_add(body.translation, rise, NAME_rotated(body.rotation, g->upper_frame.axes.z));\n";
            }
        }
        let orientation = match self.forms.home_orientation_inverse {
            Some(_) => "NAME_product(body.rotation, g->orientation)",
            None => "body.rotation",
        };
        let _ = write!(
            body,
            "    p = NAME_add(body.translation, 1, NAME_rotated(body.rotation, g->platform));\n    r = {orientation};\n"
        );
        for (place, part) in ["x", "y", "z"].iter().enumerate() {
            let _ = writeln!(body, "    position[{place}] = p.{part};");
            for (column, of_column) in ["x", "y", "z"].iter().enumerate() {
                let _ =
                    writeln!(body, "    rotation[{}] = r.{of_column}.{part};", 3 * place + column);
            }
        }
        format!(
            "int NAME_transform(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real position[3],\n                 \
             NAME_real rotation[9])\n{{\n{}    return 0;\n}}\n",
            with_unused(&body, &["mode"])
        )
    }

    /// The declarations of the public functions.
    pub fn declarations(&self) -> String {
        let m = self.manipulator;
        let signs = m.format_mode(m.home_mode());
        let signs = match signs.is_empty() {
            true => "There is one mode, 0.".to_owned(),
            false => format!("At home it is {}: {signs}.", m.home_mode().bits()),
        };
        INTERFACE.replace("MODE", &signs).replace("FORWARD\n", self.forward_declaration())
    }
}

/// A function's body with its unused parameters named.
pub fn with_unused(body: &str, parameters: &[&str]) -> String {
    let unused = parameters.iter().filter(|parameter| !uses(body, parameter));
    let named: String = unused.map(|parameter| format!("    (void){parameter};\n")).collect();
    // Before the last statement.
    match body.rfind("    return") {
        Some(at) if body.trim_end().ends_with(';') && at + 40 > body.len() => {
            format!("{}{named}{}", &body[..at], &body[at..])
        }
        _ => format!("{body}{named}"),
    }
}
