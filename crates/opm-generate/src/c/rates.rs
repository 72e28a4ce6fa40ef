//! The public functions of the joint rates and of the Jacobian.
//!
//! As in `opm-core`, the closure of a leg is differentiated one section at a time, in the section's own frame. The rows of
//! the inverse of its screws are the reciprocal screws, which give the rates of its joints. A section that constrains the
//! platform has further rows, of joints that it lacks: their rates are zero, which gives the rates of the coordinates that
//! follow from the others.

use super::Writer;
use super::interface::{RETURN, UNMET};
use super::leg::{Given, given, uses};
use super::pose::{intersection, kind, numbers, shared, tilt_torsion, word};
use opm_core::chain::Chain;
use opm_core::chain::planar::PlanarJoint;
use opm_core::group::{
    CylindricalMotion, IntersectionMotion, MotionType, PlanarMotion, SubspaceKind,
};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::SectionForm;
use opm_core::numeric::Quantity;
use std::fmt::Write;

const ZERO: &str = "NAME_vector_of(0, 0, 0)";
const X: &str = "NAME_vector_of(1, 0, 0)";
const Y: &str = "NAME_vector_of(0, 1, 0)";
const Z: &str = "NAME_vector_of(0, 0, 1)";

/// The rates of one leg: its function, how it is called, and how many joints it lacks.
struct LegRates {
    text: String,
    call: String,
    lacking: usize,
}

/// A section: statements that give its reciprocal screws, its free joints in their order, and the numbers of the rows of
/// joints that it lacks.
struct SectionRows {
    text: String,
    free: Vec<usize>,
    lacking: Vec<usize>,
}

impl Writer<'_> {
    /// The functions of the Jacobian and of the rates.
    pub fn rates(&self) -> String {
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
            let _ = writeln!(body, "    real locked[{}];", (first_lacking * all).max(1));
            body += UNMET;
        }
        let columns = self.columns();
        let complete = format!("    status = NAME_complete(g, pose, mode, q, unmet);\n{RETURN}");
        body += &self.prelude(&calls, &complete);
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
        let dependent = self.dependent();
        if dependent {
            body += &self.eliminated(first_lacking);
        } else {
            body = body.replace(", all", ", jacobian");
        }
        let unused = if uses(&calls, "at") { "" } else { "    (void)at;\n" };
        let output = if dependent { "all" } else { "jacobian" };
        let none = match calls.is_empty() {
            true => format!("    (void)t;\n    (void){output};\n"),
            false => String::new(),
        };
        let body = format!("{body}{unused}{none}    return 0;\n");
        let head = "int NAME_jacobian(const NAME_geometry *g, const NAME_real pose[], unsigned mode,\n                 \
             NAME_real jacobian[NAME_JOINTS * NAME_COORDINATES])\n";
        let jacobian = match dependent {
            true => self.of_independent(head, &body),
            false => format!("{head}{{\n{body}}}\n\n"),
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

    /// Statements that give the twists `t` of the sections for a unit rate of each coordinate.
    pub fn columns(&self) -> String {
        let mut text = String::new();
        let count = self.task.coordinates.len();
        let mut twists = vec![[ZERO.to_owned(), ZERO.to_owned(), "0".to_owned()]; count];
        for (place, section) in [Section::Lower, Section::Upper].into_iter().enumerate() {
            let screws = self.coordinate_screws(section, &mut text);
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

    /// The screws of a section's coordinates, after statements that they need.
    fn coordinate_screws(&self, section: Section, text: &mut String) -> Vec<String> {
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
            SubspaceKind::Spherical => {
                let word = word(section);
                let _ = writeln!(
                    text,
                    "    const NAME_screws {word}_angles = NAME_euler_screws(q[{}], q[{}]);",
                    numbers[0], numbers[1]
                );
                let [s1, s2, s3] = [1, 2, 3].map(|i| format!("{word}_angles.s{i}"));
                // The third Euler angle is the torsion minus the azimuth.
                let s1 = match tilt_torsion(task) {
                    true => format!("NAME_add({s1}, -1, {s3})"),
                    false => s1,
                };
                vec![s1, s2, s3]
            }
            SubspaceKind::Cylindrical if rotates && !upper => of(&[Y]),
            SubspaceKind::Cylindrical if translates && upper => of(&[X]),
            SubspaceKind::Cylindrical => of(&[X, Y]),
            SubspaceKind::TranslationalPlane if shared(task).is_some() && upper => of(&[Y]),
            SubspaceKind::TranslationalPlane => of(&[X, Y]),
            SubspaceKind::TranslationalSpace if shared(task).is_some() && upper => of(&[X, Y]),
            SubspaceKind::TranslationalSpace => of(&[X, Y, Z]),
        }
    }

    /// The unit twist of the intersection motion in the frame of a section.
    fn along(&self, section: Section) -> String {
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
    fn section_rows(&self, number: usize, section: Section) -> SectionRows {
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
                "    NAME_rotation_vector_rates({member}.axes, NAME_vector_of({}), &{word});",
                fields.join(", ")
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

    /// The intersection motion as a twist of the second section.
    fn along_moved(&self, section: Section) -> String {
        let along = self.along(section);
        match (section, kind(self.task, section)) {
            (Section::Lower, SubspaceKind::Planar) => format!("NAME_planar_adjoint(v, {along})"),
            (Section::Lower, SubspaceKind::Spherical) => format!("NAME_rotated(v, {along})"),
            _ => along,
        }
    }

    /// A twist of the upper section after the displacement `exp(-I tau)`.
    fn shifted_back(&self, number: usize, twist: &str) -> String {
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

    /// The coordinates that are given, and those that follow.
    fn own_and_follow(&self) -> [Vec<usize>; 2] {
        let own = self.forms.independent.clone();
        let follow = (0..self.task.coordinates.len()).filter(|i| !own.contains(i)).collect();
        [own, follow]
    }

    /// How many rates there are of the coordinates that follow by those that are given.
    pub fn follow_rates(&self) -> usize {
        let [own, follow] = self.own_and_follow();
        (own.len() * follow.len()).max(1)
    }

    /// Statements that give `follow`, the rates of the coordinates that follow at which no joint moves that a leg lacks.
    fn eliminated(&self, lacking: usize) -> String {
        let count = self.task.coordinates.len();
        let [own, follow] = self.own_and_follow();
        let (sides, unknowns) = (own.len(), follow.len());
        let width = sides + unknowns;
        let units: Vec<&str> = follow
            .iter()
            .map(|&i| match self.task.coordinates[i].quantity {
                Quantity::Angle => "1",
                Quantity::Length => "g->size",
            })
            .collect();
        format!(
            "    {{\n        const int given[{0}] = {{ {1} }}, sought[{unknowns}] = {{ {2} }};\n        \
             const real unit[{unknowns}] = {{ {3} }};\n        \
             real a[{4}];\n        int i, j;\n        \
             for (i = 0; i < {lacking}; ++i) {{\n            \
             for (j = 0; j < {unknowns}; ++j) {{\n                \
             a[i * {width} + j] = locked[i * {count} + sought[j]] * unit[j];\n            }}\n            \
             for (j = 0; j < {sides}; ++j) {{\n                \
             a[i * {width} + {unknowns} + j] = -locked[i * {count} + given[j]];\n            }}\n        }}\n        \
             if (NAME_eliminate(a, {lacking}, {unknowns}, {sides}, follow)) {{\n            \
             return 2 * NAME_LEGS + 1;\n        }}\n        \
             for (i = 0; i < {unknowns}; ++i) {{\n            \
             for (j = 0; j < {sides}; ++j) {{\n                \
             follow[i * {sides} + j] *= unit[i];\n            }}\n        }}\n    }}\n",
            sides.max(1),
            listed(&own),
            listed(&follow),
            units.join(", "),
            lacking * width,
        )
    }

    /// The Jacobian where coordinates follow, with the functions that it shares with the twist: the rates by all coordinates,
    /// and their sums for those that are given.
    fn of_independent(&self, head: &str, body: &str) -> String {
        let count = self.task.coordinates.len();
        let [own, follow] = self.own_and_follow();
        let (sides, unknowns) = (own.len(), follow.len());
        format!(
            "/* The rates of all joints by all coordinates, and those of the coordinates that follow by the others. It returns what\n   \
             NAME_jacobian returns. */\n\
             static int NAME_differentiate(const NAME_geometry *g, const real pose[], unsigned mode, real all[], real follow[])\n\
             {{\n{body}}}\n\n\
             /* Rates by the coordinates of a pose, from rows of those by all coordinates. */\n\
             static void NAME_by_pose(const real all[], int rows, const real follow[], real by_pose[])\n\
             {{\n    const int given[{0}] = {{ {1} }}, sought[{unknowns}] = {{ {2} }};\n    int i, j, k;\n    \
             for (i = 0; i < rows; ++i) {{\n        \
             for (j = 0; j < {sides}; ++j) {{\n            \
             by_pose[i * {sides} + j] = all[i * {count} + given[j]];\n            \
             for (k = 0; k < {unknowns}; ++k) {{\n                \
             by_pose[i * {sides} + j] += all[i * {count} + sought[k]] * follow[k * {sides} + j];\n            \
             }}\n        }}\n    }}\n}}\n\n\
             {head}{{\n    real all[{3}], follow[{4}];\n    \
             const int status = NAME_differentiate(g, pose, mode, all, follow);\n{RETURN}    \
             NAME_by_pose(all, NAME_JOINTS, follow, jacobian);\n    return 0;\n}}\n\n",
            sides.max(1),
            listed(&own),
            listed(&follow),
            self.fields.len() * count,
            self.follow_rates(),
        )
    }
}

/// Numbers as the elements of an array, which has at least one.
fn listed(numbers: &[usize]) -> String {
    let each: Vec<String> = numbers.iter().map(usize::to_string).collect();
    if each.is_empty() { "0".to_owned() } else { each.join(", ") }
}
