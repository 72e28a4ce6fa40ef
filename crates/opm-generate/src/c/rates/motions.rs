//! Rates by the platform's motions, for the steps of forward kinematics: they are those by the coordinates, but for the Euler
//! angles, which are singular where the second one is zero. In the place of these are the rotations about the directions of
//! the section's frame. The rates by the angles follow.

use crate::c::Writer;
use crate::c::interface::RETURN;
use crate::c::pose::{kind, numbers, shared};
use opm_core::group::{MotionType, SubspaceKind};
use opm_core::manipulator::Section;
use std::fmt::Write;

impl Writer<'_> {
    /// The section that has the Euler angles of a pose.
    pub fn oriented(&self) -> Option<Section> {
        [Section::Lower, Section::Upper].into_iter().find(|&section| {
            let tilts =
                section == Section::Lower && shared(self.task) == Some(MotionType::Rotation);
            kind(self.task, section) == SubspaceKind::Spherical && !tilts
        })
    }

    /// Whether forward kinematics take steps that are no changes of the coordinates.
    pub fn turns(&self) -> bool {
        self.has_forward() && self.oriented().is_some()
    }

    /// The number of the first Euler angle among all coordinates.
    pub fn first_angle(&self) -> usize {
        self.oriented().map_or(0, |section| numbers(self.task, &self.forms, section)[0])
    }

    /// The function of the rates by the motions.
    pub fn motions(&self, body: &str) -> String {
        let (also, parameters) = match self.dependent() {
            true => (
                ", of joints that legs lack, too, and the coordinates q",
                "real q[], real all[], real locked[]",
            ),
            false => ("", "real all[]"),
        };
        format!(
            "/* The rates of all joints{also}, by the motions of the platform: those of the coordinates, but for the Euler\n   \
             angles, in whose places are rotations about the directions of the section's frame. They have no singular pose. It\n   \
             returns what NAME_jacobian returns. */\n\
             static int NAME_motions(const NAME_geometry *g, const real pose[], unsigned mode, {parameters})\n{{\n{body}}}\n\n"
        )
    }

    /// The body of the function of the rates by the coordinates.
    pub fn by_coordinates(&self, lacking: usize) -> String {
        let (count, first) = (self.task.coordinates.len(), self.first_angle());
        let Some(section) = self.oriented() else { return String::new() };
        let mut screws = String::new();
        let angles = self.angle_screws(section, &mut screws).join(", ");
        let replace = |rates: &str, rows: &str| {
            format!("    NAME_by_angles({rates}, {rows}, {count}, {first}, {angles});\n")
        };
        if !self.dependent() {
            let screws = screws.replace("q[", "pose[").replace("    const", "        const");
            let replace = replace("jacobian", "NAME_JOINTS").replace("    NAME", "        NAME");
            return format!(
                "    const int status = NAME_motions(g, pose, mode, jacobian);\n{RETURN}    \
                 {{\n{screws}{replace}    }}\n    return 0;\n"
            );
        }
        let mut body = String::new();
        let _ = write!(
            body,
            "    real q[{count}], locked[{}];\n    const int status = NAME_motions(g, pose, mode, q, all, locked);\n{RETURN}    {{\n",
            (lacking * count).max(1)
        );
        for line in [screws, replace("all", "NAME_JOINTS"), replace("locked", &lacking.to_string())]
        {
            let _ = write!(body, "    {line}");
        }
        body + "    }\n" + &self.eliminated(lacking) + "    return 0;\n"
    }

    /// How many rows there are of joints that legs lack.
    pub fn lacking(&self) -> usize {
        let rows = |leg: usize| {
            [Section::Lower, Section::Upper]
                .map(|section| self.section_rows(leg, section).lacking.len())
        };
        (0..self.forms.legs.len()).flat_map(rows).sum()
    }
}
