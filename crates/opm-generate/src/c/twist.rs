//! The public function of the platform's twist.

use super::Writer;
use super::interface::{RETURN, UNMET, with_unused};
use super::pose::kind;
use super::rates::Columns;
use opm_core::group::SubspaceKind;
use opm_core::manipulator::Section;
use std::fmt::Write;

const ZERO: &str = "NAME_vector_of(0, 0, 0)";

impl Writer<'_> {
    /// The function of the platform's twist for unit rates of the coordinates: with `g = v b`, what moves `v` moves the
    /// platform where it is, and what moves `b` moves it before `v` does.
    pub fn twist(&self) -> String {
        let count = self.task.coordinates.len();
        let dependent = self.dependent();
        let upper = kind(self.task, Section::Upper) != SubspaceKind::Identity;
        let height = self.forms.height.map(|height| height.section);
        let mut calls = String::from(if upper { "v b" } else { "v" });
        if height.is_some() {
            calls += " rise";
        }
        let mut body = format!(
            "    NAME_body lower{};\n    NAME_vector before, point;\n    NAME_twists t[{count}];\n    int i;\n",
            if upper { ", upper" } else { "" }
        );
        let output = match dependent {
            true => "all",
            false => "twist",
        };
        if dependent {
            let joints = self.fields.len() * count;
            let _ = writeln!(
                body,
                "    real all[{}], joints[{joints}], follow[{}];",
                6 * count,
                self.follow_rates()
            );
            body += UNMET;
        }
        let complete = format!("    status = NAME_complete(g, pose, mode, q, unmet);\n{RETURN}");
        body += &self.prelude(&calls, &complete);
        if dependent {
            let _ = write!(
                body,
                "    status = NAME_differentiate(g, pose, mode, joints, follow);\n{RETURN}"
            );
        }
        let columns = self.columns(Columns::Coordinates);
        body += &if dependent { columns } else { columns.replace("q[", "pose[") };
        body += &self.places(upper, height);
        let _ = writeln!(body, "    for (i = 0; i < {count}; ++i) {{");
        let [w, v] = self.embedded(Section::Lower, "t[i].lower");
        let _ = write!(
            body,
            "        NAME_vector w = NAME_rotated(g->lower_frame.axes, {w});\n        \
             NAME_vector velocity = NAME_velocity_at(&g->lower_frame, {w}, {v}, point);\n"
        );
        if upper {
            let [w, v] = self.embedded(Section::Upper, "t[i].upper");
            let _ = write!(
                body,
                "        w = NAME_add(w, 1, NAME_rotated(lower.rotation, NAME_rotated(g->upper_frame.axes, {w})));\n        \
                 velocity = NAME_add(velocity, 1, NAME_rotated(lower.rotation, NAME_velocity_at(&g->upper_frame, {w}, {v}, before)));\n"
            );
        }
        if let Some(up) = height.map(up) {
            let _ = writeln!(body, "        velocity = NAME_add(velocity, t[i].rise, {up});");
        }
        for (place, part) in
            ["w.x", "w.y", "w.z", "velocity.x", "velocity.y", "velocity.z"].into_iter().enumerate()
        {
            let _ = writeln!(body, "        {output}[{} + i] = {part};", place * count);
        }
        body += "    }\n";
        if dependent {
            body += "    NAME_by_pose(all, 6, follow, twist);\n";
        }
        format!(
            "int NAME_twist(const NAME_geometry *g, const NAME_real pose[], unsigned mode,\n               \
             NAME_real twist[6 * NAME_COORDINATES])\n{{\n{}    return 0;\n}}\n\n",
            with_unused(&body, &["mode"])
        )
    }

    /// Statements that give the displacements, and the places of the reference point before and after `v` moves it.
    fn places(&self, upper: bool, height: Option<Section>) -> String {
        let mut text = format!("    lower = {};\n", self.body_of(Section::Lower, "v"));
        if upper {
            let _ = write!(
                text,
                "    upper = {};\n    before = NAME_add(upper.translation, 1, NAME_rotated(upper.rotation, g->platform));\n",
                self.body_of(Section::Upper, "b")
            );
        } else {
            text += "    before = g->platform;\n";
        }
        text +=
            "    point = NAME_add(lower.translation, 1, NAME_rotated(lower.rotation, before));\n";
        if let Some(up) = height.map(up) {
            let _ = writeln!(text, "    point = NAME_add(point, rise, {up});");
        }
        text
    }

    /// The angular velocity and the velocity of a section's origin, in its frame, of a twist.
    fn embedded(&self, section: Section, t: &str) -> [String; 2] {
        let part = |parts: [&str; 3]| {
            let each = parts.map(|part| match part {
                "" => "0".to_owned(),
                part => format!("{t}.{part}"),
            });
            format!("NAME_vector_of({})", each.join(", "))
        };
        let (whole, zero) = (t.to_owned(), ZERO.to_owned());
        match kind(self.task, section) {
            SubspaceKind::Identity => [zero.clone(), zero],
            SubspaceKind::Planar => [part(["", "", "x"]), part(["y", "z", ""])],
            SubspaceKind::Spherical => [whole, zero],
            SubspaceKind::Cylindrical => [part(["", "", "x"]), part(["", "", "y"])],
            SubspaceKind::TranslationalPlane => [zero, part(["x", "y", ""])],
            SubspaceKind::TranslationalSpace => [zero, whole],
        }
    }
}

/// The direction in which a height lifts the platform.
fn up(section: Section) -> &'static str {
    match section {
        Section::Lower => "g->lower_frame.axes.z",
        Section::Upper => "NAME_rotated(lower.rotation, g->upper_frame.axes.z)",
    }
}
