//! The screws of coordinates, of the joints of a section at a pose, and of the intersection motion, and their reciprocal
//! screws.

use super::Columns;
use crate::c::Writer;
use crate::c::leg::{Given, ball, given};
use crate::c::pose::{intersection, kind, numbers, shared, tilt_torsion, word};
use opm_core::chain::Chain;
use opm_core::chain::planar::PlanarJoint;
use opm_core::group::{
    CylindricalMotion, IntersectionMotion, MotionType, PlanarMotion, SubspaceKind,
};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::SectionForm;
use std::fmt::Write;

pub const ZERO: &str = "NAME_vector_of(0, 0, 0)";
const X: &str = "NAME_vector_of(1, 0, 0)";
const Y: &str = "NAME_vector_of(0, 1, 0)";
const Z: &str = "NAME_vector_of(0, 0, 1)";

/// A section: statements that give its reciprocal screws, its free joints in their order, and the numbers of the rows of
/// joints that it lacks.
pub struct SectionRows {
    pub text: String,
    pub free: Vec<usize>,
    pub lacking: Vec<usize>,
}

impl Writer<'_> {
    /// The screws of a section's coordinates, after statements that they need.
    pub fn coordinate_screws(
        &self,
        section: Section,
        columns: Columns,
        text: &mut String,
    ) -> Vec<String> {
        let (task, numbers) = (self.task, numbers(self.task, &self.forms, section));
        let q = |i: usize| format!("q[{0}] - g->home[{0}]", numbers[i]);
        let of = |screws: &[&str]| screws.iter().map(|&screw| screw.to_owned()).collect();
        let rotates = shared(task) == Some(MotionType::Rotation);
        let translates = shared(task) == Some(MotionType::Translation);
        let upper = section == Section::Upper;
        let turn = |x: &str, y: &str| format!("NAME_vector_of(1, {y}, -({x}))");
        match kind(task, section) {
            SubspaceKind::Identity => Vec::new(),
            SubspaceKind::Planar if rotates && !upper => of(&[Y, Z]),
            SubspaceKind::Planar if translates && upper => {
                vec![Z.to_owned(), format!("NAME_vector_of(1, {}, 0)", q(0))]
            }
            SubspaceKind::Planar => vec![Y.to_owned(), Z.to_owned(), turn(&q(0), &q(1))],
            SubspaceKind::Spherical if rotates && !upper => {
                let e = format!("NAME_unit({})", q(0));
                let _ = writeln!(text, "    const NAME_complex tilted = {e};");
                vec![X.to_owned(), "NAME_vector_of(0, tilted.re, tilted.im)".to_owned()]
            }
            SubspaceKind::Spherical => match columns {
                Columns::Motions => of(&[X, Y, Z]),
                Columns::Coordinates => self.angle_screws(section, text).into(),
            },
            SubspaceKind::Cylindrical if rotates && !upper => of(&[Y]),
            SubspaceKind::Cylindrical if translates && upper => of(&[X]),
            SubspaceKind::Cylindrical => of(&[X, Y]),
            SubspaceKind::TranslationalPlane if shared(task).is_some() && upper => of(&[Y]),
            SubspaceKind::TranslationalPlane => of(&[X, Y]),
            SubspaceKind::TranslationalSpace if shared(task).is_some() && upper => of(&[X, Y]),
            SubspaceKind::TranslationalSpace => of(&[X, Y, Z]),
        }
    }

    /// The screws of the three angles of a section's orientation, after statements that they need.
    pub fn angle_screws(&self, section: Section, text: &mut String) -> [String; 3] {
        let (word, numbers) = (word(section), numbers(self.task, &self.forms, section));
        let _ = writeln!(
            text,
            "    const NAME_screws {word}_angles = NAME_euler_screws(q[{}], q[{}]);",
            numbers[0], numbers[1]
        );
        let [s1, s2, s3] = [1, 2, 3].map(|i| format!("{word}_angles.s{i}"));
        // The third Euler angle is the torsion minus the azimuth.
        let s1 = match tilt_torsion(self.task) {
            true => format!("NAME_add({s1}, -1, {s3})"),
            false => s1,
        };
        [s1, s2, s3]
    }

    /// The unit twist of the intersection motion in the frame of a section.
    pub fn along(&self, section: Section) -> String {
        let word = word(section);
        match intersection(self.task, section) {
            IntersectionMotion::None(_) => ZERO.to_owned(),
            IntersectionMotion::Planar(PlanarMotion::Rotation)
            | IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => X.to_owned(),
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => Y.to_owned(),
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
                format!("NAME_slider_screw(g->{word}_along)")
            }
            IntersectionMotion::Translational(_) => {
                format!("NAME_vector_of(g->{word}_along.re, g->{word}_along.im, 0)")
            }
            IntersectionMotion::Spherical(_) | IntersectionMotion::Spatial(_) => Z.to_owned(),
        }
    }

    /// The displacement along the intersection motion of a leg: a direction of length one, or a number.
    fn tau_value(&self, number: usize) -> String {
        match self.tau(&self.forms.legs[number]) {
            Some(Given::Direction) => format!("NAME_normal(at->tau_{})", number + 1),
            _ => format!("at->tau_{}", number + 1),
        }
    }

    /// The same as a direction, if the motion is a rotation.
    fn tau_turn(&self, number: usize) -> String {
        match self.tau(&self.forms.legs[number]) {
            Some(Given::Direction) => self.tau_value(number),
            _ => format!("NAME_unit(at->tau_{})", number + 1),
        }
    }

    /// The displacement of a joint before others of its chain, from home: an angle as a direction.
    fn displacement(&self, number: usize, form: &SectionForm, joint: usize) -> String {
        match (form.coordinates[joint], given(form, joint)) {
            (Some(coordinate), _) => format!("at->{}", self.fields[coordinate]),
            (None, Given::Direction) => self.tau_turn(number),
            (None, _) => {
                let part = form.slider.filter(|(slider, _)| *slider == joint);
                let rate =
                    part.map_or(String::new(), |_| format!(" * g->leg{}_part.rate", number + 1));
                format!("{}{rate}", self.tau_value(number))
            }
        }
    }

    /// The reciprocal screws of a section of a leg.
    pub fn section_rows(&self, number: usize, section: Section) -> SectionRows {
        let leg = &self.forms.legs[number];
        let form = leg.section(section);
        let kind = kind(self.task, section);
        let (word, member) = (word(section), format!("g->leg{}_{}", number + 1, word(section)));
        let dimension = match kind {
            SubspaceKind::Identity => 0,
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => 2,
            SubspaceKind::Planar | SubspaceKind::Spherical | SubspaceKind::TranslationalSpace => 3,
        };
        let free: Vec<usize> = (0..form.chain.freedoms())
            .filter(|&i| form.locked.is_none_or(|locked| !locked[i]))
            .collect();
        let mut text = String::new();
        if dimension == 0 {
            return SectionRows { text, free, lacking: Vec::new() };
        }
        let _ = writeln!(text, "    NAME_screws {word};");
        if let Chain::Ball(_) = &form.chain {
            let fields: Vec<String> = (form.coordinates.iter().flatten())
                .map(|&coordinate| format!("at->{}", self.fields[coordinate]))
                .collect();
            let _ = writeln!(
                text,
                "    NAME_rotation_vector_rates({member}.axes, NAME_rotation_vector(NAME_vector_of({}), at->{}), &{word});",
                fields.join(", "),
                ball(number, section)
            );
            return SectionRows { text, free, lacking: Vec::new() };
        }
        text += &match &form.chain {
            Chain::Planar(chain) => self.planar_screws(number, section, &chain.joints(), &free),
            _ => self.other_screws(number, section, &free),
        };
        let mut known = free.len();
        if dimension == 2 {
            known += 1;
            let _ = writeln!(text, "    {word}.s{known} = {Z};");
        }
        for rest in known + 1..=3 {
            let _ = writeln!(text, "    {word}.s{rest} = {ZERO};");
        }
        let unit = match kind {
            SubspaceKind::Planar | SubspaceKind::Cylindrical => "g->size",
            _ => "1",
        };
        let _ = writeln!(
            text,
            "    if (NAME_reciprocal(&{word}, {known}, {unit})) {{\n        return 1;\n    }}"
        );
        // The third dimension of two is none that could be lacking.
        SectionRows { text, free, lacking: (known + 1..=3).collect() }
    }

    /// The displaced screws of a planar chain: what is before a joint displaces its screw. A lift that leans is one of the
    /// joints.
    fn planar_screws(
        &self,
        number: usize,
        section: Section,
        joints: &[PlanarJoint; 3],
        free: &[usize],
    ) -> String {
        let leg = &self.forms.legs[number];
        let (form, word) = (leg.section(section), word(section));
        let member = format!("g->leg{}_{word}", number + 1);
        // What is written, the screw at home, and the motion.
        let mut items: Vec<[String; 3]> = Vec::new();
        for (place, &joint) in (1..).zip(free) {
            let q = self.displacement(number, form, joint);
            let (letter, what) = match joints[joint] {
                PlanarJoint::Revolute { .. } => ("p", "pivot"),
                PlanarJoint::Prismatic { .. } => ("d", "slider"),
            };
            items.push([
                format!("{word}.s{place}"),
                format!("NAME_{what}_screw({member}.{letter}{place})"),
                format!("NAME_{what}_motion({member}.{letter}{place}, {q})"),
            ]);
        }
        let lift = leg.lift.as_ref().and_then(|lift| Some((lift.coordinate, lift.lean?)));
        if let Some((coordinate, lean)) = lift.filter(|(_, lean)| lean.section == section) {
            let lift = format!("g->leg{}_lift", number + 1);
            let field = &self.fields[coordinate];
            let before = free.iter().filter(|&&joint| joint < lean.before).count();
            items.insert(
                before,
                [
                    "const NAME_vector leaning".to_owned(),
                    format!(
                        "NAME_vector_of({lift}.rotation, {lift}.velocity.re, {lift}.velocity.im)"
                    ),
                    format!("NAME_leaned(&{lift}, at->{field} / {lift}.rate)"),
                ],
            );
        }
        let mut text = String::new();
        for (place, [target, screw, motion]) in items.iter().enumerate() {
            let _ = match place {
                0 => writeln!(text, "    {target} = {screw};"),
                _ => writeln!(text, "    {target} = NAME_planar_adjoint({word}_moved, {screw});"),
            };
            let _ = match place {
                _ if place + 1 == items.len() => Ok(()),
                0 => writeln!(text, "    NAME_planar {word}_moved = {motion};"),
                _ => writeln!(
                    text,
                    "    {word}_moved = NAME_planar_product({word}_moved, {motion});"
                ),
            };
        }
        text
    }

    /// The displaced screws of the other chains.
    fn other_screws(&self, number: usize, section: Section, free: &[usize]) -> String {
        let form = self.forms.legs[number].section(section);
        let (word, member) = (word(section), format!("g->leg{}_{}", number + 1, word(section)));
        let turn = |place: usize| {
            let q = self.displacement(number, form, free[place - 1]);
            if q.starts_with("at->q") { format!("NAME_normal({q})") } else { q }
        };
        let mut text = String::new();
        for place in 1..=free.len() {
            let screw = match &form.chain {
                Chain::Spherical(_) => {
                    let about = |place: usize, screw: &str| {
                        format!("NAME_rotated_about({member}.a{place}, {}, {screw})", turn(place))
                    };
                    let own = format!("{member}.a{place}");
                    (1..place).rev().fold(own, |screw, before| about(before, &screw))
                }
                Chain::Cylindrical(_) => {
                    format!(
                        "NAME_vector_of({member}.j{place}.rotation, {member}.j{place}.advance, 0)"
                    )
                }
                Chain::Translational(_) => {
                    format!("NAME_vector_of({member}.d{place}.re, {member}.d{place}.im, 0)")
                }
                Chain::Spatial(_) => format!("{member}.d{place}"),
                Chain::Rigid | Chain::Ball(_) | Chain::Planar(_) => ZERO.to_owned(),
            };
            let _ = writeln!(text, "    {word}.s{place} = {screw};");
        }
        text
    }

    /// The intersection motion as a twist of the second section.
    pub fn along_moved(&self, section: Section) -> String {
        let along = self.along(section);
        match (section, kind(self.task, section)) {
            (Section::Lower, SubspaceKind::Planar) => format!("NAME_planar_adjoint(v, {along})"),
            (Section::Lower, SubspaceKind::Spherical) => format!("NAME_rotated(v, {along})"),
            _ => along,
        }
    }

    /// A twist of the upper section after the displacement `exp(-I tau)`.
    pub fn shifted_back(&self, number: usize, twist: &str) -> String {
        match intersection(self.task, Section::Upper) {
            IntersectionMotion::Planar(PlanarMotion::Rotation) => format!(
                "NAME_planar_adjoint(NAME_planar_of(NAME_conjugate({}), NAME_complex_of(0, 0)), {twist})",
                self.tau_turn(number)
            ),
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => format!(
                "NAME_planar_adjoint(NAME_slider_motion(g->upper_along, -{}), {twist})",
                self.tau_value(number)
            ),
            IntersectionMotion::Spherical(_) => {
                format!(
                    "NAME_rotated_about({Z}, NAME_conjugate({}), {twist})",
                    self.tau_turn(number)
                )
            }
            IntersectionMotion::None(_)
            | IntersectionMotion::Cylindrical(_)
            | IntersectionMotion::Translational(_)
            | IntersectionMotion::Spatial(_) => twist.to_owned(),
        }
    }
}
