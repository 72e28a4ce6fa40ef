//! The public function of the mode nearest to a previous solution.

use super::Writer;
use super::interface::{RETURN, UNMET, with_unused};
use super::leg::{Given, uses};
use super::pose::{displacement_type, kind};
use opm_core::chain::Chain;
use opm_core::manipulator::Section;
use std::fmt::Write;

impl Writer<'_> {
    /// The public function of the mode nearest to a previous solution: of each leg, the best of its own choices.
    pub fn nearest(&self) -> String {
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
            if self.ball_of(joint).is_some() {
                continue;
            }
            let field = &self.fields[joint];
            let value = match self.given(joint) {
                Given::Value => format!("g->joint[{joint}].home + at.{field}"),
                Given::Direction | Given::Turns => {
                    format!("NAME_nearest_angle(&g->joint[{joint}], at.{field}, previous[{joint}])")
                }
            };
            let _ = writeln!(text, "        value[{place}] = {value};");
        }
        for of in [Section::Lower, Section::Upper] {
            let section = leg.section(of);
            if let (Chain::Ball(_), [Some(x), Some(y), Some(z)]) =
                (&section.chain, section.coordinates)
            {
                let axis = [x, y, z].map(|joint| format!("at.{}", self.fields[joint])).join(", ");
                let previous = [x, y, z]
                    .map(|joint| format!("previous[{joint}] - g->joint[{joint}].home"))
                    .join(", ");
                let half = super::leg::ball(number, of);
                let _ = writeln!(
                    text,
                    "        {{\n            const NAME_vector vector = NAME_rotation_vector(NAME_vector_of({axis}), at.{half});\n            \
                     const NAME_vector near_previous = NAME_nearest_rotation(vector, NAME_vector_of({previous}));",
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
}
