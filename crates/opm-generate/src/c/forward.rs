//! The public function of the forward kinematics.
//!
//! Its steps are motions of the platform rather than changes of the coordinates: Euler angles are singular at the home pose of
//! many mechanisms. Without them, the two are the same. Where coordinates follow from those of a pose, and there are Euler
//! angles, the steps are in all coordinates, and joints that legs lack stand still.

use super::Writer;
use super::interface::RETURN;
use super::pose::{tilt_torsion, to_euler};
use super::steps::indented;
use opm_core::mechanism::joint::JointKind;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The functions, without what depends on the mechanism.
const FORWARD: &str = include_str!("forward.c");
const LINEARISE: &str = include_str!("linearise.c");
const STEPPED: &str = include_str!("stepped.c");
const STEPPED_DEPENDENT: &str = include_str!("stepped_dependent.c");

/// What the second of these functions is.
const OF_LINEARISE: &str = "\
/* The equations of a step: the rates of the actuated joints by what moves the platform, a row for each, and right sides
   behind them. Lengths are over the size. It returns what NAME_jacobian returns. */
";

/// Its declaration.
const DECLARATION: &str = "
/* The pose at which the actuated joints have given values, by Newton's method from a pose nearby, which it replaces; in the
   working mode of that. The residual is how far the actuated joints are off in the end, radians or sizes of the mechanism.
   Angles are those nearest to the start's; a tilt is not negative. It returns 0; what NAME_jacobian returns, where it cannot go
   on; 2 * NAME_LEGS + 1 where the actuated joints do not determine the pose; 2 * NAME_LEGS + 2 where it does not converge; or
   -NAME_COORDINATES - i where actuated joint i, from 1, is no number. Unless it returns 0, pose is the last one. */
int NAME_forward(const NAME_geometry *geometry, const NAME_real actuated[], unsigned mode, NAME_real pose[],
                 NAME_real *residual);
";

impl Writer<'_> {
    /// Whether the actuated joints can determine the pose.
    pub fn has_forward(&self) -> bool {
        let coordinates = self.manipulator.task_coordinates().len();
        coordinates > 0 && self.manipulator.actuated().len() >= coordinates
    }

    /// The declaration, if there is the function.
    pub fn forward_declaration(&self) -> &'static str {
        if self.has_forward() { DECLARATION } else { "" }
    }

    /// Whether steps are in all coordinates, also those that follow.
    pub fn steps_in_all(&self) -> bool {
        self.turns() && self.dependent()
    }

    /// The numbers of the rows and of the unknowns of the equations of a step.
    pub fn equations(&self) -> [usize; 2] {
        let m = self.manipulator;
        match self.steps_in_all() {
            true => [m.actuated().len() + self.lacking(), self.task.coordinates.len()],
            false => [m.actuated().len(), m.task_coordinates().len()],
        }
    }

    /// The function, if the actuated joints can determine the pose.
    pub fn forward(&self) -> String {
        if !self.has_forward() {
            return String::new();
        }
        let (turns, all) = (self.turns(), self.steps_in_all());
        let copy =
            "    for (j = 0; j < NAME_COORDINATES; ++j) {\n        start[j] = pose[j];\n    }\n";
        let complete =
            format!("    status = NAME_complete(g, pose, mode, start, unmet);\n{RETURN}");
        let (state, start) = match (turns, all) {
            (_, true) => {
                ("    real start[UNKNOWNS], q[UNKNOWNS], unmet[2] = { 0, 0 };\n", &*complete)
            }
            (true, _) => ("    real start[UNKNOWNS];\n", copy),
            (false, _) => ("    UNITS\n", ""),
        };
        let copied = "            for (j = 0; j < NAME_COORDINATES; ++j) {\n                \
                      next[j] = pose[j] + share * unit[j] * step[j];\n            }\n";
        let (stepped, test) = match (turns, all) {
            (_, true) => ("", "NAME_stepped(g, q, start, step, share, mode, next) == 0 && "),
            (true, _) => ("            NAME_stepped(g, pose, start, step, share, next);\n", ""),
            (false, _) => (copied, ""),
        };
        let step = format!(
            "{stepped}            if ({test}NAME_actuated(g, next, mode, values) == 0) {{\n"
        );
        let whole = self.off()
            + OF_LINEARISE
            + &self.linearise()
            + "\n"
            + &self.stepped()
            + &FORWARD
                .replace("    STATE\n", state)
                .replace("    START\n", start)
                .replace("            STEP\n", &step)
                .replace("QUERIED ", if all { "q, " } else { "" });
        self.with_counts(&whole) + "\n"
    }

    /// Whether full revolutions do not change what a joint coordinate does.
    pub fn is_modulo(&self, coordinate: usize) -> bool {
        let joints = self.manipulator.mechanism().joints();
        let mut kinds = joints.flat_map(|joint| joint.coordinates.iter().map(|_| joint.kind));
        let turns = kinds.nth(coordinate).is_some_and(|kind| match kind {
            JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical => true,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Spherical => false,
        });
        turns && self.manipulator.coordinates()[coordinate].quantity == Quantity::Angle
    }

    /// How far the actuated joints are off.
    fn off(&self) -> String {
        let m = self.manipulator;
        let mut text = String::from(
            "/* How far the actuated joints are from other values: the differences, and the largest one. */\n\
             static real NAME_off(const NAME_geometry *g, const real actuated[], const real values[], real off[])\n\
             {\n    real most = 0;\n    int i;\n",
        );
        for (place, &coordinate) in m.actuated().iter().enumerate() {
            let difference = format!("actuated[{place}] - values[{place}]");
            let _ = match self.is_modulo(coordinate) {
                true => writeln!(text, "    off[{place}] = NAME_near({difference}, 0);"),
                false => writeln!(text, "    off[{place}] = {difference};"),
            };
        }
        text + "    for (i = 0; i < NAME_ACTUATED; ++i) {\n        DRIVEN\n        \
                most = NAME_max(most, NAME_abs(off[i]) / g->joint[driven[i]].size);\n    }\n    return most;\n}\n\n"
    }

    fn linearise(&self) -> String {
        let (turns, all) = (self.turns(), self.steps_in_all());
        let lacking = self.lacking();
        let rates = match (turns, all) {
            (_, true) => "NAME_motions(g, pose, mode, q, rates, locked)",
            (true, _) => "NAME_motions(g, pose, mode, rates)",
            (false, _) => "NAME_jacobian(g, pose, mode, rates)",
        };
        let (mut locked, mut held) = (String::new(), String::new());
        if all {
            let _ = writeln!(locked, "    real locked[{lacking} * UNKNOWNS];");
            let _ = write!(
                held,
                "    for (i = 0; i < {lacking}; ++i) {{\n        for (j = 0; j < UNKNOWNS; ++j) {{\n            \
                 a[(NAME_ACTUATED + i) * WIDTH + j] = locked[i * UNKNOWNS + j] * unit[j];\n        }}\n        \
                 a[(NAME_ACTUATED + i) * WIDTH + UNKNOWNS] = 0;\n    }}\n"
            );
        }
        LINEARISE
            .replace("    LOCKED\n", &locked)
            .replace("    HELD\n", &held)
            .replace("QUERY ", if all { "real q[], " } else { "" })
            .replace("RATES", rates)
    }

    /// The function of the pose after a step, where the orientation is rotated.
    fn stepped(&self) -> String {
        if !self.turns() {
            return String::new();
        }
        let all = self.steps_in_all();
        let first = self.first_angle();
        let of = |text: &str| [0, 1, 2].map(|i| text.replace('#', &(first + i).to_string()));
        let euler = |of_pose: &str| to_euler(self.task, of(&format!("{of_pose}[#]"))).join(", ");
        let found = if all { "        moved" } else { "        next" };
        let found: String = (["x", "y", "z"].iter().enumerate())
            .map(|(i, part)| format!("{found}[{}] = angles.{part};\n", first + i))
            .collect();
        let chart = if tilt_torsion(self.task) { "torsion" } else { "euler" };
        let template = if all { STEPPED_DEPENDENT } else { STEPPED };
        let independent: Vec<String> =
            self.forms.independent.iter().map(usize::to_string).collect();
        let text = template
            .replace("STEPS", &of("share * step[#]").join(", "))
            .replace("EULER", &euler(if all { "q" } else { "pose" }))
            .replace("COMPLETED", &euler("completed"))
            .replace("NEAREST", &format!("{chart}_near"))
            .replace("CHART", &format!("{chart}_in"))
            .replace("NEAR", &of("start[#]").join(", "))
            .replace("        FOUND\n", &found)
            .replace("GIVEN", &independent.join(", "));
        // Angles have no unit.
        let lengths = self.task.coordinates.iter().any(|c| c.quantity == Quantity::Length);
        let text = match lengths || all {
            true => text,
            false => text.replacen("    int j;\n", "    int j;\n    (void)g;\n", 1),
        };
        text + "\n"
    }

    /// A text with the numbers of equations and unknowns, and what does not depend on the step.
    pub fn with_counts(&self, text: &str) -> String {
        let m = self.manipulator;
        let [rows, unknowns] = self.equations();
        let unit = |quantity: Quantity| match quantity {
            Quantity::Angle => "1",
            Quantity::Length => "g->size",
        };
        let units: Vec<&str> = match self.steps_in_all() {
            true => self.task.coordinates.iter().map(|c| unit(c.quantity)).collect(),
            false => m.task_coordinates().iter().map(|c| unit(c.quantity)).collect(),
        };
        let driven: Vec<String> = m.actuated().iter().map(usize::to_string).collect();
        let driven = format!("const int driven[NAME_ACTUATED] = {{ {} }};\n", driven.join(", "));
        let units = format!("const real unit[{unknowns}] = {{ {} }};\n", units.join(", "));
        text.replace("DRIVEN\n", &driven)
            .replace("UNITS\n", &units)
            .replace("        RETURN\n", &indented(RETURN))
            .replace("    RETURN\n", RETURN)
            .replace("ROWS * WIDTH", &(rows * (unknowns + 1)).to_string())
            .replace("ROWS", &rows.to_string())
            .replace("WIDTH", &(unknowns + 1).to_string())
            .replace("UNKNOWNS", &unknowns.to_string())
    }
}
