//! The public function of the forward kinematics.

use super::Writer;
use super::interface::RETURN;
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// The function, without what depends on the mechanism.
const FORWARD: &str = include_str!("forward.c");

/// Its declaration.
const DECLARATION: &str = "
/* The pose at which the actuated joints have given values, by Newton's method from a pose nearby, which it replaces; in the
   working mode of that. The residual is how far the actuated joints are off in the end, radians or sizes of the mechanism.
   It returns 0; what NAME_jacobian returns, where it cannot go on; 2 * NAME_LEGS + 1 where the actuated joints do not
   determine the pose; 2 * NAME_LEGS + 2 where it does not converge; or -NAME_COORDINATES - i where actuated joint i, from 1, is
   no number. Unless it returns 0, pose is the last one. */
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

    /// The function, if the actuated joints can determine the pose.
    pub fn forward(&self) -> String {
        if !self.has_forward() {
            return String::new();
        }
        let m = self.manipulator;
        let unit = |quantity: Quantity| match quantity {
            Quantity::Angle => "1",
            Quantity::Length => "g->size",
        };
        let mut text = String::from(
            "/* How far the actuated joints are from other values: the differences, and the largest one. */\n\
             static real NAME_off(const NAME_geometry *g, const real actuated[], const real values[], real off[])\n\
             {\n    real most = 0;\n    int i;\n",
        );
        for (place, &coordinate) in m.actuated().iter().enumerate() {
            let difference = format!("actuated[{place}] - values[{place}]");
            let _ = match m.coordinates()[coordinate].quantity {
                Quantity::Angle => writeln!(text, "    off[{place}] = NAME_near({difference}, 0);"),
                Quantity::Length => writeln!(text, "    off[{place}] = {difference};"),
            };
        }
        let driven: Vec<String> = m.actuated().iter().map(usize::to_string).collect();
        let driven = format!("const int driven[NAME_ACTUATED] = {{ {} }};", driven.join(", "));
        let _ = write!(
            text,
            "    for (i = 0; i < NAME_ACTUATED; ++i) {{\n        {driven}\n        \
             most = NAME_max(most, NAME_abs(off[i]) / g->joint[driven[i]].size);\n    }}\n    return most;\n}}\n\n"
        );
        let units: Vec<&str> = m.task_coordinates().iter().map(|c| unit(c.quantity)).collect();
        let units = format!("const real unit[NAME_COORDINATES] = {{ {} }};", units.join(", "));
        text + &FORWARD
            .replace("    DRIVEN\n", &format!("    {driven}\n"))
            .replace("    UNITS\n", &format!("    {units}\n"))
            .replace("    RETURN\n", RETURN)
            + "\n"
    }
}
