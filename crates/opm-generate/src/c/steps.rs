//! The functions that complete a pose by the coordinates that constraining legs determine.

use super::leg::Given;
use super::pose::{self, displacement_type, kind, of_euler, shifted, to_euler};
use super::{Writer, geometry};
use opm_core::chain::condition::Condition;
use opm_core::group::SubspaceKind;
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{SectionMotion, StepForm, StepKind};
use opm_core::numeric::Quantity;
use std::fmt::Write;

/// Stands for the array of a leg's two deficits.
const MISSED: &str = "DEFICITS";

impl Writer<'_> {
    /// The function that completes a pose, and those that it calls; empty where all coordinates are independent.
    pub fn complete(&self) -> String {
        if self.forms.steps.is_empty() {
            return String::new();
        }
        let mut body = String::new();
        for (number, step) in self.forms.steps.iter().enumerate() {
            let names: Vec<&str> =
                step.coordinates.iter().map(|&i| self.task.coordinates[i].name).collect();
            let names = names.join(", ");
            let leg = crate::names::comment(&self.manipulator.mechanism().legs[step.leg].name);
            let why = match step.kind {
                StepKind::Constant => format!("{names}: constant, because of leg {leg}"),
                _ => format!("{names}: from the constraint of leg {leg}"),
            };
            let _ = writeln!(
                body,
                "    /* {why} */\n    {{\n{}    }}",
                indented(&placed(&self.step(number, step), step.section))
            );
        }
        for number in 0..self.forms.checks.len() {
            let leg = self.forms.checks[number].leg;
            let leg = crate::names::comment(&self.manipulator.mechanism().legs[leg].name);
            let _ = writeln!(
                body,
                "    /* The constraint of leg {leg} is obeyed already. */\n    {{\n{}    }}",
                indented(&placed(&self.check(number), self.forms.checks[number].section))
            );
        }
        let scratch = if super::leg::uses(&body, "scratch") {
            "    NAME_displacements scratch;\n"
        } else {
            ""
        };
        let mode = if super::leg::uses(&body, "mode") { "" } else { "    (void)mode;\n" };
        let missed = if super::leg::uses(&body, "missed") { "" } else { "    (void)missed;\n" };
        format!(
            "/* Completes a pose by the coordinates that follow. It returns 0, or the number of the leg whose constraint no\n   \
             value of them satisfies, with the deficits of its lower and its upper section. */\n\
             static int NAME_complete(const NAME_geometry *g, const real pose[], unsigned mode, real q[],\n                 \
             real missed[2])\n\
             {{\n{scratch}{mode}{missed}{}{body}    return 0;\n}}\n\n",
            self.spread()
        )
    }

    /// All coordinates as at home, but for the independent ones.
    fn spread(&self) -> String {
        let mut text = String::new();
        for coordinate in 0..self.task.coordinates.len() {
            let independent = self.forms.independent.iter().position(|&i| i == coordinate);
            let value = match independent {
                Some(place) => format!("pose[{place}]"),
                None => format!("g->home[{coordinate}]"),
            };
            let _ = writeln!(text, "    q[{coordinate}] = {value};");
        }
        text
    }

    fn step(&self, number: usize, step: &StepForm) -> String {
        match &step.kind {
            StepKind::Constant => {
                let home = |&i: &usize| format!("    q[{i}] = g->home[{i}];\n");
                step.coordinates.iter().map(home).collect()
            }
            StepKind::Condition { condition, harmonic, .. } => {
                self.condition_step(number, step, condition, *harmonic)
            }
            StepKind::Joint { motion, all } => self.joint_step(number, step, *motion, all),
        }
    }

    /// Solves the other section of a leg where its displacement along the intersection motion matters. The name of that
    /// displacement; `None` where it does not.
    fn tau_before(&self, leg: usize, section: Section, text: &mut String) -> Option<String> {
        let form = &self.forms.legs[leg];
        let first_done = self.first_section();
        if !form.bridged || form.first == section || first_done == section {
            return None;
        }
        let other = form.first;
        let of_type = displacement_type(kind(self.task, other))?;
        let symbol = if other == Section::Lower { "v" } else { "b" };
        let own = format!("&{MISSED}[{}]", other as usize);
        let call = self.legs[leg][0].call.replace("at", "&scratch").replace("missed", &own);
        if super::leg::uses(&call, symbol) {
            let call = pose::call(self.task, &self.forms, other);
            let _ = writeln!(text, "    const {of_type} {symbol} = {call};");
        }
        if super::leg::uses(&call, "rise") {
            let _ = writeln!(text, "    const real rise = {};", self.rise());
        }
        if super::leg::uses(&call, "near") {
            let _ = writeln!(text, "    const real near = 0;");
        }
        let _ = writeln!(text, "    if ({call}) {{\n        return {};\n    }}", leg + 1);
        Some(format!("scratch.tau_{}", leg + 1))
    }

    /// The section whose dependent coordinates are found first: the one that is taken modulo the intersection motion.
    fn first_section(&self) -> Section {
        use opm_core::group::MotionType::{Rotation, Translation};
        match pose::shared(self.task) {
            Some(Rotation) | None => Section::Lower,
            Some(Translation) => Section::Upper,
        }
    }

    /// Statements that give `target` what a section's chain has to reach at the coordinates `q`.
    fn write_target(&self, leg: usize, section: Section, tau: Option<&str>, text: &mut String) {
        let displacement = pose::call(self.task, &self.forms, section);
        let _ = writeln!(text, "    target = {displacement};");
        let (Some(tau), Some(given)) = (tau, self.tau(&self.forms.legs[leg])) else { return };
        let direction = given == Given::Direction;
        // U = exp(-I τ) b
        let tau = match (section, direction) {
            (Section::Lower, _) => tau.to_owned(),
            (Section::Upper, true) => format!("NAME_conjugate({tau})"),
            (Section::Upper, false) => format!("-{tau}"),
        };
        let shifted = shifted(self.task, section, "target", &tau, direction);
        let _ = writeln!(text, "    target = {shifted};");
    }

    fn condition_step(
        &self,
        number: usize,
        step: &StepForm,
        condition: &Condition,
        harmonic: bool,
    ) -> String {
        let [coordinate] = step.coordinates[..] else { return String::new() };
        let (word_of, member) =
            (geometry::condition(condition).0, format!("g->condition{}", number + 1));
        let mut text = String::new();
        let tau = self.tau_before(step.leg, step.section, &mut text);
        let length = self.task.coordinates[coordinate].quantity == Quantity::Length;
        let unit = unit(condition);
        let sign = step.bit.map_or("1".to_owned(), |bit| format!("NAME_sign(mode, {bit})"));
        let of_type = displacement_type(kind(self.task, step.section)).unwrap_or("int");
        let step_size = if length { "g->size" } else { "1" };
        let at = match harmonic {
            true => "home + (real)i * (NAME_PI / 2)".to_owned(),
            false => format!("home + (real)(i - 1) * {step_size}"),
        };
        let mut target = String::new();
        self.write_target(step.leg, step.section, tau.as_deref(), &mut target);
        let _ =
            writeln!(text, "    const real held = q[{coordinate}], home = g->home[{coordinate}];");
        let start = match (harmonic, length) {
            (false, true) => "(held - home) / g->size",
            _ => "held - home",
        };
        let _ = writeln!(text, "    real value[3], c[3], u = {start};\n    int i;");
        let _ = writeln!(
            text,
            "    for (i = 0; i < 3; ++i) {{\n        {of_type} target;\n        q[{coordinate}] = {at};"
        );
        text += &indented(&target);
        let _ = writeln!(
            text,
            "        value[i] = NAME_value_{word_of}(&{member}, {});\n    }}",
            sum(condition, kind(self.task, step.section))
        );
        let (coefficients, function) = match harmonic {
            true => (
                "    c[0] = (value[0] + value[2]) / 2;\n    c[1] = (value[0] - value[2]) / 2;\n    c[2] = value[1] - c[0];\n",
                "harmonic",
            ),
            false => (
                "    c[0] = value[1];\n    c[1] = (value[2] - value[0]) / 2;\n    c[2] = (value[2] + value[0]) / 2 - value[1];\n",
                "polynomial",
            ),
        };
        text += coefficients;
        let _ = writeln!(
            text,
            "    if (NAME_zero_{function}(c, {sign}, {unit}, &u, missed)) {{\n        \
             *missed = NAME_missed_{word_of}(&{member}, *missed);\n        return {};\n    }}",
            step.leg + 1
        );
        let found = match harmonic {
            true => "NAME_near(home + u, held)".to_owned(),
            false => format!("home + {step_size} * u"),
        };
        let _ = writeln!(text, "    q[{coordinate}] = {found};");
        text
    }

    fn check(&self, number: usize) -> String {
        let check = &self.forms.checks[number];
        let (word_of, member) =
            (geometry::condition(&check.condition).0, format!("g->check{}", number + 1));
        let mut text = String::new();
        let tau = self.tau_before(check.leg, check.section, &mut text);
        let of_type = displacement_type(kind(self.task, check.section)).unwrap_or("int");
        let _ = writeln!(text, "    {of_type} target;");
        self.write_target(check.leg, check.section, tau.as_deref(), &mut text);
        let size = match check.condition {
            Condition::Heading { .. } | Condition::Cone { .. } => "",
            _ => " * g->size",
        };
        let _ = writeln!(
            text,
            "    const real off = NAME_missed_{word_of}(&{member}, NAME_value_{word_of}(&{member}, {}));\n    \
             if (!(off <= NAME_OBEYED{size})) {{\n        *missed = off;\n        return {};\n    }}",
            sum(&check.condition, kind(self.task, check.section)),
            check.leg + 1
        );
        text
    }

    fn joint_step(
        &self,
        number: usize,
        step: &StepForm,
        motion: SectionMotion,
        all: &[usize],
    ) -> String {
        let mut text = String::new();
        let section = step.section;
        let kind_of = kind(self.task, section);
        let tau = self.tau_before(step.leg, section, &mut text);
        let home = |i: usize| match all.get(i) {
            Some(coordinate) => format!("g->home[{coordinate}]"),
            None => "0".to_owned(),
        };
        let leg = &self.forms.legs[step.leg];
        let direction = self.tau(leg) == Some(Given::Direction);
        // g = exp(I τ) · exp(s q) for b, and exp(s q) · exp(-I τ) for v.
        let shift = |motion: &str| match &tau {
            None => motion.to_owned(),
            Some(tau) => {
                let tau = match (section, direction) {
                    (Section::Upper, _) => tau.clone(),
                    (Section::Lower, true) => format!("NAME_conjugate({tau})"),
                    (Section::Lower, false) => format!("-{tau}"),
                };
                shifted(self.task, section, motion, &tau, direction)
            }
        };
        let of_type = displacement_type(kind_of).unwrap_or("int");
        let sign = step.bit.map_or("1".to_owned(), |bit| format!("NAME_sign(mode, {bit})"));
        let joint = format!("g->joint{}", number + 1);
        // The rotation about the third direction in the rest.
        let still = |text: &mut String| {
            let identity = identity(kind_of);
            let _ = writeln!(text, "    {of_type} still = {identity};");
            if tau.is_some() {
                let _ = writeln!(text, "    still = {};", shift("still"));
            }
        };
        let found: [String; 3] = match motion {
            SectionMotion::None => {
                still(&mut text);
                match kind_of {
                    SubspaceKind::Spherical => {
                        let [zeta, xi, psi] = to_euler(self.task, [0, 1, 2].map(home));
                        let zeta = format!("({zeta} + NAME_atan2(still.x.y, still.x.x))");
                        of_euler(self.task, [zeta, xi, psi])
                    }
                    _ => coordinates_of(kind_of, "still", home),
                }
            }
            SectionMotion::Turn(_) => {
                still(&mut text);
                let third = all[2];
                let _ = writeln!(
                    text,
                    "    const NAME_complex turn = NAME_times(NAME_unit(q[{third}] - {}), NAME_conjugate(still.rotation));\n    \
                     const NAME_complex about = {joint};\n    \
                     NAME_planar moved = NAME_planar_of(turn, NAME_minus(about, NAME_times(turn, about)));",
                    home(2)
                );
                if tau.is_some() {
                    let _ = writeln!(text, "    moved = {};", shift("moved"));
                }
                coordinates_of(kind_of, "moved", home)
            }
            SectionMotion::Slide(_, given) => {
                let planar = kind_of == SubspaceKind::Planar;
                let along = |s: &str| match planar {
                    true => {
                        format!("NAME_planar_of(NAME_complex_of(1, 0), NAME_scaled({joint}, {s}))")
                    }
                    false => format!("NAME_add(NAME_vector_of(0, 0, 0), {s}, {joint})"),
                };
                let zero = |_: usize| "0".to_owned();
                for (name, s) in [("start", "0"), ("end", "1")] {
                    let _ = writeln!(text, "    {of_type} {name} = {};", along(s));
                    if tau.is_some() {
                        let _ = writeln!(text, "    {name} = {};", shift(name));
                    }
                }
                let [from, to] =
                    ["start", "end"].map(|at| coordinates_of(kind_of, at, zero)[given].clone());
                let _ = writeln!(
                    text,
                    "    const real past = q[{}] - {} - ({from}), rate = ({to}) - ({from});\n    \
                     {of_type} moved;\n    \
                     if (!(NAME_abs(rate) >= NAME_DEGENERATE)) {{\n        *missed = NAME_missed(NAME_abs(past));\n        \
                     return {};\n    }}\n    moved = {};",
                    all[given],
                    home(given),
                    step.leg + 1,
                    along("past / rate")
                );
                if tau.is_some() {
                    let _ = writeln!(text, "    moved = {};", shift("moved"));
                }
                coordinates_of(kind_of, "moved", home)
            }
            SectionMotion::Third => {
                let [_, xi, psi] = to_euler(self.task, [0, 1, 2].map(home));
                let angles = of_euler(self.task, [format!("q[{}]", all[0]), xi, psi]);
                for (coordinate, angle) in all.iter().zip(angles).skip(1) {
                    let _ = writeln!(text, "    q[{coordinate}] = {angle};");
                }
                return text;
            }
            SectionMotion::Axis(_) | SectionMotion::LastAngle(_) => {
                if tau.is_some() {
                    still(&mut text);
                }
                let xi = format!("q[{}]", all[1]);
                let call = match self.forms.home_orientation_inverse {
                    None => format!("NAME_axis_from_identity({joint}, {xi}, {sign}, &zeta, &psi)"),
                    Some(_) => format!(
                        "NAME_axis_from_home({joint}, NAME_transposed(g->home_orientation_inverse), {xi}, {sign}, &zeta, &psi)"
                    ),
                };
                let _ = writeln!(
                    text,
                    "    real zeta = 0, psi = 0;\n    *missed = {call};\n    if (*missed > 0) {{\n        return {};\n    }}",
                    step.leg + 1
                );
                let zeta = match (motion, tau.is_some()) {
                    (SectionMotion::LastAngle(_), _) => format!("q[{}]", all[0]),
                    (_, true) => "(zeta + NAME_atan2(still.x.y, still.x.x))".to_owned(),
                    (_, false) => "zeta".to_owned(),
                };
                if matches!(motion, SectionMotion::LastAngle(_)) {
                    text += "    (void)zeta;\n";
                    if tau.is_some() {
                        text += "    (void)still;\n";
                    }
                }
                of_euler(self.task, [zeta, xi, "psi".to_owned()])
            }
        };
        for (&coordinate, value) in all.iter().zip(found) {
            if !step.coordinates.contains(&coordinate) {
                continue;
            }
            let angle = self.task.coordinates[coordinate].quantity == Quantity::Angle;
            let value = match angle && kind_of != SubspaceKind::Cylindrical {
                true => format!("NAME_near({value}, q[{coordinate}])"),
                false => value,
            };
            let _ = writeln!(text, "    q[{coordinate}] = {value};");
        }
        text
    }

    /// The height above home at the coordinates `q`.
    pub fn rise(&self) -> String {
        match &self.forms.height {
            Some(height) => format!("q[{0}] - g->home[{0}]", height.coordinate),
            None => "0".to_owned(),
        }
    }
}

/// The argument of a condition: of a linear one, the coordinates of the displacement's logarithm.
fn sum(condition: &Condition, kind: SubspaceKind) -> &'static str {
    match (condition, kind) {
        (Condition::Flat { .. }, SubspaceKind::Cylindrical) => {
            "NAME_vector_of(target.angle, target.advance, 0)"
        }
        (Condition::Flat { .. }, SubspaceKind::TranslationalPlane) => {
            "NAME_vector_of(target.re, target.im, 0)"
        }
        _ => "target",
    }
}

/// The unit of the values of a condition.
fn unit(condition: &Condition) -> &'static str {
    match condition {
        Condition::Circle { .. } => "g->size * g->size",
        Condition::Line { .. } | Condition::CarriedLine { .. } | Condition::Flat { .. } => {
            "g->size"
        }
        Condition::Heading { .. } | Condition::Cone { .. } => "1",
    }
}

/// The identity of a kind.
fn identity(kind: SubspaceKind) -> &'static str {
    match kind {
        SubspaceKind::Identity => "0",
        SubspaceKind::Planar => "NAME_planar_of(NAME_complex_of(1, 0), NAME_complex_of(0, 0))",
        SubspaceKind::Spherical => {
            "NAME_rotation_about(NAME_vector_of(0, 0, 1), NAME_complex_of(1, 0))"
        }
        SubspaceKind::Cylindrical => "NAME_cylindrical_of(0, 0)",
        SubspaceKind::TranslationalPlane => "NAME_complex_of(0, 0)",
        SubspaceKind::TranslationalSpace => "NAME_vector_of(0, 0, 0)",
    }
}

/// The coordinates of a displacement of a section that has all coordinates of its subspace.
fn coordinates_of(kind: SubspaceKind, g: &str, home: impl Fn(usize) -> String) -> [String; 3] {
    let from_home = |parts: [&str; 3]| {
        let mut number = 0;
        parts.map(|part| {
            let value = match part {
                "" => home(number),
                part => format!("{} + {}", home(number), part.replace('$', g)),
            };
            number += 1;
            value
        })
    };
    match kind {
        SubspaceKind::Identity => from_home([""; 3]),
        SubspaceKind::Planar => {
            from_home(["$.translation.re", "$.translation.im", "NAME_angle($.rotation)"])
        }
        SubspaceKind::Spherical => from_home(["NAME_atan2($.x.y, $.x.x)", "", ""]),
        SubspaceKind::Cylindrical => from_home(["$.angle", "$.advance", ""]),
        SubspaceKind::TranslationalPlane => from_home(["$.re", "$.im", ""]),
        SubspaceKind::TranslationalSpace => from_home(["$.x", "$.y", "$.z"]),
    }
}

/// A step's text with the deficit of its section in its place among those of a leg's two.
fn placed(text: &str, section: Section) -> String {
    let own = format!("{MISSED}[{}]", section as usize);
    let text = text.replace("*missed", &own).replace("&u, missed", &format!("&u, &{own}"));
    text.replace(MISSED, "missed")
}

pub fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}\n")).collect()
}
