//! The public functions.

use super::geometry::{Geometry, rotation, vector};
use super::leg::{Given, uses};
use super::pose::{self, displacement_type, kind, word};
use super::{Writer, geometry};
use opm_core::chain::Chain;
use opm_core::group::SubspaceKind;
use opm_core::manipulator::Section;
use opm_core::manipulator::form::LegForm;
use std::fmt::Write;

/// Both sections, with the symbols of their displacements.
const SECTIONS: [(Section, &str); 2] = [(Section::Lower, "v"), (Section::Upper, "b")];

/// The deficits of a leg whose constraint is not satisfied.
const UNMET: &str = "    real unmet[2] = { 0, 0 };\n";

/// Returns from a function whose status is not zero.
const RETURN: &str = "    if (status != 0) {\n        return status;\n    }\n";

impl Writer<'_> {
    /// The definitions of the public functions, and of what they share.
    pub fn interface(&self) -> String {
        let parts = [
            self.start(),
            self.close(),
            self.inverse(),
            self.actuated(),
            self.nearest(),
            self.deficits(),
            self.limits(),
            self.transform(),
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
    fn dependent(&self) -> bool {
        !self.forms.steps.is_empty()
    }

    /// The function that checks a pose and gives all its coordinates.
    fn start(&self) -> String {
        let check = "    int i;\n    for (i = 0; i < NAME_COORDINATES; ++i) {\n        \
             /* Not true of a number that is none. */\n        \
             if (!((double)NAME_abs(pose[i]) <= NAME_LARGEST)) {\n            return -(i + 1);\n        }\n    }\n";
        format!(
            "/* 0, or what is returned for a pose that has a coordinate that is no number. */\n\
             static int NAME_check(const real pose[])\n{{\n{check}    return 0;\n}}\n\n"
        )
    }

    /// Statements that declare, and then give, what calls of the legs' functions use: `q`, `v`, `b`, `rise`. `status` is
    /// the pose's; `complete` is done after its check.
    fn prelude(&self, calls: &str, complete: &str) -> String {
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
    fn calls(&self, leg: usize) -> Vec<String> {
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

    /// The value of a joint coordinate from the displacements.
    fn value(&self, coordinate: usize) -> String {
        let field = &self.fields[coordinate];
        match self.given(coordinate) {
            Given::Value => format!("g->joint[{coordinate}].home + at.{field}"),
            Given::Direction | Given::Turns => {
                format!("NAME_reported(&g->joint[{coordinate}], at.{field})")
            }
        }
    }

    /// The value of an imaginary joint from the displacement of its leg along the intersection motion.
    fn imaginary_value(
        &self,
        leg: &LegForm,
        number: usize,
        angle: impl Fn(&str) -> String,
    ) -> Option<(usize, String)> {
        let (imaginary, tau) = (leg.imaginary?, self.tau(leg)?);
        let joint = &self.manipulator.imaginary()[imaginary];
        let sense = if joint.displacement(joint.home + 1.0) > 0.0 { "+" } else { "-" };
        let field = format!("at.tau_{}", number + 1);
        let value = if tau == Given::Direction { angle(&field) } else { field };
        Some((imaginary, format!("g->imaginary[{imaginary}] {sense} {value}")))
    }

    fn inverse(&self) -> String {
        let mut body = String::new();
        for number in 0..self.fields.len() {
            let _ = writeln!(body, "    joints[{number}] = {};", self.value(number));
        }
        for (number, leg) in self.forms.legs.iter().enumerate() {
            let value = self.imaginary_value(leg, number, |field| format!("NAME_angle({field})"));
            if let Some((imaginary, value)) = value {
                let _ = writeln!(body, "    imaginary[{imaginary}] = {value};");
            }
        }
        let unused = if uses(&body, "imaginary") { "" } else { "    (void)imaginary;\n" };
        format!(
            "int NAME_inverse(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real joints[],\n                 \
             NAME_real imaginary[])\n\
             {{\n    NAME_displacements at;\n    const int status = NAME_close(g, pose, mode, &at);\n{RETURN}{body}{unused}    \
             return 0;\n}}\n\n"
        )
    }

    fn actuated(&self) -> String {
        let mut body = String::new();
        for (place, &coordinate) in self.manipulator.actuated().iter().enumerate() {
            let _ = writeln!(body, "    actuated[{place}] = {};", self.value(coordinate));
        }
        let unused = if body.is_empty() { "    (void)actuated;\n" } else { "" };
        format!(
            "int NAME_actuated(const NAME_geometry *g, const NAME_real pose[], unsigned mode, NAME_real actuated[])\n\
             {{\n    NAME_displacements at;\n    const int status = NAME_close(g, pose, mode, &at);\n{RETURN}{body}{unused}    \
             return 0;\n}}\n\n"
        )
    }

    /// The bits of a mode that are one leg's own, and on which no dependent coordinate depends.
    fn own_bits(&self, leg: usize) -> Vec<u32> {
        let leg = &self.forms.legs[leg];
        let bits = [leg.section(leg.first).bit, leg.lower.bit, leg.upper.bit];
        let mut own: Vec<u32> =
            bits.into_iter().flatten().filter(|bit| !self.forms.step_bits.contains(bit)).collect();
        own.sort_unstable();
        own.dedup();
        own
    }

    /// The mode with the bits of a combination, as an expression.
    fn spread_bits(bits: &[u32], combination: &str) -> String {
        let part =
            |(place, bit): (usize, &u32)| format!("((({combination} >> {place}) & 1u) << {bit})");
        let parts: Vec<String> = bits.iter().enumerate().map(part).collect();
        if parts.is_empty() { "0u".into() } else { parts.join(" | ") }
    }

    /// The public function of the mode nearest to a previous solution: of each leg, the best of its own choices.
    fn nearest(&self) -> String {
        let mut text = String::new();
        let all: String = (0..self.legs.len()).flat_map(|leg| self.calls(leg)).collect();
        let mut legs = String::new();
        for number in 0..self.legs.len() {
            let name = format!("nearest{}", number + 1);
            let body = self.nearest_of_leg(number);
            let declared = [
                ("v", self.parameter(Section::Lower, "v")),
                ("b", self.parameter(Section::Upper, "b")),
                ("rise", Some("real rise, ".to_owned())),
            ];
            let used = |symbol: &str| uses(&body, symbol);
            let parameters: String = declared
                .iter()
                .filter(|(symbol, _)| used(symbol))
                .filter_map(|(_, parameter)| parameter.clone())
                .collect();
            let passed: String = declared
                .iter()
                .filter(|(symbol, parameter)| used(symbol) && parameter.is_some())
                .map(|(symbol, _)| format!("{symbol}, "))
                .collect();
            let _ = write!(
                text,
                "/* The choices of leg {0} in which its joints are nearest to a previous solution: they are added to mode, and the\n   \
                 motion to them to moved. */\n\
                 static int NAME_{name}(const NAME_geometry *g, {parameters}const real previous[], unsigned *mode, real joints[],\n                 \
                 real imaginary[], real *moved)\n{{\n{1}}}\n\n",
                number + 1,
                with_unused(&body, &["imaginary"])
            );
            let _ = writeln!(
                legs,
                "    if (NAME_{name}(g, {passed}previous, mode, joints, imaginary, moved)) {{\n        return {};\n    }}",
                number + 1
            );
        }
        let complete = format!("    status = NAME_complete(g, pose, *mode, q, unmet);\n{RETURN}");
        let mut body = if self.dependent() { UNMET.to_owned() } else { String::new() };
        body += &self.prelude(&all, &complete);
        let _ = write!(
            text,
            "/* The same for all legs, with the choices in mode on which coordinates of the pose depend. */\n\
             static int NAME_nearest_legs(const NAME_geometry *g, const real pose[], const real previous[], unsigned *mode,\n                 \
             real joints[], real imaginary[], real *moved)\n\
             {{\n{body}    *moved = 0;\n{legs}    return status;\n}}\n\n"
        );
        let outer = &self.forms.step_bits;
        let head = "int NAME_nearest(const NAME_geometry *g, const NAME_real pose[], const NAME_real previous[], unsigned *mode,\n                 \
             NAME_real joints[], NAME_real imaginary[])\n";
        if outer.is_empty() {
            let _ = write!(
                text,
                "{head}{{\n    real moved;\n    *mode = 0;\n    \
                 return NAME_nearest_legs(g, pose, previous, mode, joints, imaginary, &moved);\n}}\n\n"
            );
            return text;
        }
        let spread = Self::spread_bits(outer, "i");
        let (joints, imaginary) = (self.fields.len(), self.manipulator.imaginary().len());
        let copy_imaginary = match imaginary {
            0 => "            (void)imaginary;\n".to_owned(),
            count => format!(
                "            for (j = 0; j < {count}; ++j) {{\n                imaginary[j] = other_imaginary[j];\n            }}\n"
            ),
        };
        let _ = write!(
            text,
            "{head}{{\n    real least = (real)INFINITY, moved = 0, other[{joints}], other_imaginary[{}] = {{ 0 }};\n    \
             int best = -1, status = 0, j;\n    unsigned i;\n    \
             /* Those choices on which coordinates of the pose depend. */\n    \
             for (i = 0; i < {}u; ++i) {{\n        unsigned tried = {spread};\n        \
             const int found = NAME_nearest_legs(g, pose, previous, &tried, other, other_imaginary, &moved);\n        \
             if (found != 0) {{\n            status = found;\n        }} else if (best < 0 || moved < least) {{\n            \
             least = moved;\n            best = (int)i;\n            *mode = tried;\n            \
             for (j = 0; j < {joints}; ++j) {{\n                joints[j] = other[j];\n            }}\n\
             {copy_imaginary}        }}\n    }}\n    return best < 0 ? status : 0;\n}}\n\n",
            imaginary.max(1),
            1u64 << outer.len(),
        );
        text
    }

    /// A displacement as a parameter.
    fn parameter(&self, section: Section, symbol: &str) -> Option<String> {
        Some(format!("{} {symbol}, ", displacement_type(kind(self.task, section))?))
    }

    /// The best of the choices of one leg.
    fn nearest_of_leg(&self, number: usize) -> String {
        let leg = &self.forms.legs[number];
        let own = self.own_bits(number);
        let calls = self.calls(number);
        let mut loop_body = String::new();
        let joints: Vec<usize> = self.joints_of(number);
        if !calls.is_empty() {
            let tests: Vec<String> = calls
                .iter()
                .map(|call| {
                    call.replace("missed", "&missed")
                        .replace(", at", ", &at")
                        .replace("mode", "tried")
                })
                .collect();
            let _ = writeln!(
                loop_body,
                "        if ({}) {{\n            continue;\n        }}",
                tests.join(" || ")
            );
        }
        let values = self.near_values(number);
        loop_body += &values;
        loop_body += "        total = 0;\n";
        for (place, joint) in joints.iter().enumerate() {
            let _ = writeln!(
                loop_body,
                "        total += NAME_moved(&g->joint[{joint}], value[{place}], previous[{joint}]);"
            );
        }
        let mut take = String::new();
        for (place, joint) in joints.iter().enumerate() {
            let _ = writeln!(take, "            joints[{joint}] = value[{place}];");
        }
        let angle = |field: &str| format!("NAME_angle({field})");
        if let Some((imaginary, value)) = self.imaginary_value(leg, number, angle) {
            let _ = writeln!(take, "            imaginary[{imaginary}] = {value};");
        }
        let joined = calls.join(" ");
        let mut body =
            String::from("    const unsigned rest = *mode;\n    NAME_displacements at;\n");
        let _ = writeln!(
            body,
            "    real value[{}], total, least = (real)INFINITY;",
            joints.len().max(1)
        );
        if uses(&joined, "missed") {
            body += "    real missed = 0;\n";
        }
        if uses(&joined, "near") {
            let _ = writeln!(body, "    const real near = {};", self.previous_tau(number));
        }
        let spread = Self::spread_bits(&own, "i");
        let tried = match own.is_empty() {
            true => "rest".to_owned(),
            false => format!("rest | {spread}"),
        };
        let _ = write!(
            body,
            "    int found = 0;\n    unsigned i;\n    for (i = 0; i < {}u; ++i) {{\n        const unsigned tried = {tried};\n\
             {loop_body}        if (!found || total < least) {{\n            found = 1;\n            least = total;\n            \
             *mode = tried;\n{take}        }}\n    }}\n    *moved += least;\n    return !found;\n",
            1u64 << own.len()
        );
        body
    }

    /// The numbers of the joint coordinates of a leg.
    fn joints_of(&self, leg: usize) -> Vec<usize> {
        let legs = &self.manipulator.mechanism().legs;
        let first: usize = legs[..leg].iter().map(|leg| leg.coordinates().count()).sum();
        (first..first + legs[leg].coordinates().count()).collect()
    }

    /// Statements that give the values of a leg's joints, with the revolutions that are nearest to the previous ones.
    fn near_values(&self, number: usize) -> String {
        let leg = &self.forms.legs[number];
        let joints = self.joints_of(number);
        let mut text = String::new();
        for (place, &joint) in joints.iter().enumerate() {
            let field = &self.fields[joint];
            let value = match self.given(joint) {
                Given::Value => format!("g->joint[{joint}].home + at.{field}"),
                Given::Direction | Given::Turns => {
                    format!("NAME_nearest_angle(&g->joint[{joint}], at.{field}, previous[{joint}])")
                }
            };
            let _ = writeln!(text, "        value[{place}] = {value};");
        }
        for section in [&leg.lower, &leg.upper] {
            if let (Chain::Ball(_), [Some(x), Some(y), Some(z)]) =
                (&section.chain, section.coordinates)
            {
                let from_home = |field: &str, joint: usize| match field {
                    "" => format!("previous[{joint}] - g->joint[{joint}].home"),
                    _ => format!("at.{}", self.fields[joint]),
                };
                let vector = |field: &str| {
                    let parts = [x, y, z].map(|joint| from_home(field, joint));
                    format!("NAME_vector_of({})", parts.join(", "))
                };
                let _ = writeln!(
                    text,
                    "        {{\n            const NAME_vector near_previous = NAME_nearest_rotation({}, {});",
                    vector("at"),
                    vector("")
                );
                for (joint, part) in [x, y, z].into_iter().zip(["x", "y", "z"]) {
                    let place = joint - joints.first().copied().unwrap_or(0);
                    let _ = writeln!(
                        text,
                        "            value[{place}] = g->joint[{joint}].home + near_previous.{part};"
                    );
                }
                text += "        }\n";
            }
        }
        text
    }

    /// The displacement along the intersection motion at the previous solution, up to what a revolution does not change:
    /// the rotation of the joints on the axis where revolutions are counted.
    fn previous_tau(&self, number: usize) -> String {
        let leg = &self.forms.legs[number];
        let second = if leg.first == Section::Lower { Section::Upper } else { Section::Lower };
        let form = leg.section(second);
        let Chain::Cylindrical(chain) = &form.chain else { return "0".into() };
        let parts: Vec<String> = chain
            .joints()
            .iter()
            .enumerate()
            .filter_map(|(place, joint)| {
                let coordinate = form.coordinates[place]?;
                let sense = if joint.rotation > 0.0 { "+" } else { "-" };
                (joint.rotation != 0.0).then(|| {
                    format!(" {sense} (previous[{coordinate}] - g->joint[{coordinate}].home)")
                })
            })
            .collect();
        match second {
            Section::Lower => format!("0{}", parts.concat()),
            Section::Upper => format!("b.angle - (0{})", parts.concat()),
        }
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
        let of = |section: Section, symbol: &str| {
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
        };
        let _ = writeln!(body, "    body = {};", of(Section::Lower, "v"));
        if upper {
            let _ =
                writeln!(body, "    body = NAME_body_product(body, {});", of(Section::Upper, "b"));
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
        INTERFACE.replace("MODE", &signs)
    }
}

/// A function's body with its unused parameters named.
fn with_unused(body: &str, parameters: &[&str]) -> String {
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

/// What the header declares.
const INTERFACE: &str = "\
#ifdef __cplusplus
extern \"C\" {
#endif

/* The mechanism as it was when this code was written. */
extern const NAME_geometry NAME_default;

/* Every joint at a pose in a working mode. Bit i of the mode, the lowest first, is set where sign i of opm's text is a minus.
   MODE
   Angles are within half a revolution of home, or within their limits where full revolutions bring them there; limits are
   not tested. It returns 0; or the number of the first leg, from 1, that the pose is out of reach of; or -i where coordinate
   i of the pose, from 1, is no number or far too large. Unless it returns 0, nothing is written. */
int NAME_inverse(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real joints[],
                 NAME_real imaginary[]);

/* The actuated joints alone, in the same way. */
int NAME_actuated(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real actuated[]);

/* Every joint at a pose in that mode in which the joints move least from previous ones (the sum of the squares, lengths
   over the size of the mechanism), angles with the revolutions nearest to the previous ones. It writes the mode, too. Unless
   it returns 0, joints, imaginary and mode have no meaning. */
int NAME_nearest(const NAME_geometry *geometry, const NAME_real pose[], const NAME_real previous[], unsigned *mode,
                 NAME_real joints[], NAME_real imaginary[]);

/* By how much the pose is out of reach: of leg i, from 0, deficits[2 * i] of the lower section and deficits[2 * i + 1] of the
   upper one, in metres, or radians where the section is spherical; zero where it closes, infinite where it is not known. A
   section that follows another one out of reach counts as closed. It returns what NAME_inverse returns. */
int NAME_deficits(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real deficits[2 * NAME_LEGS]);

/* 0 where all joints are within their limits; otherwise the number of the first one, from 1, that is not. */
int NAME_limits(const NAME_geometry *geometry, const NAME_real joints[]);

/* The position of the platform's reference point and the platform's orientation in base coordinates: a rotation matrix, row by
   row. They depend on the mode only where coordinates follow from those of the pose. It returns what NAME_inverse returns,
   but tests no leg. */
int NAME_transform(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real position[3],
                   NAME_real rotation[9]);

#ifdef __cplusplus
}
#endif
";
