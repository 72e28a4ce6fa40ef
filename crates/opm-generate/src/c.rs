//! Source code in C99.
//!
//! What a kind of section needs is written once, by hand, in `c/library.c`: one function for each closed form. What one
//! mechanism needs is written here: its geometry as one struct, and for each leg two functions that call those of the
//! library, in the order in which the leg is solved.

mod forward;
mod geometry;
mod golden;
mod interface;
mod leg;
mod library;
mod linuxcnc;
mod nearest;
mod pose;
mod rates;
mod steps;
mod twist;

use crate::GenerateError;
use crate::names::{comment, identifiers, package};
use crate::tree;
use geometry::{Geometry, complex, number, rotation, vector};
use leg::{Function, Given, given};
use opm_core::Manipulator;
use opm_core::chain::Chain;
use opm_core::group::{IntersectionMotion, PlanarMotion, TranslationalMotion};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{ClosedForms, SectionMotion, StepKind};
use opm_core::mechanism::joint::JointCoordinate;
use opm_core::numeric::Quantity;
use opm_core::task::Task;
use std::fmt::Write;

/// Targets that CMake has itself, and headers that the code includes.
const RESERVED: [&str; 17] = [
    "all",
    "clean",
    "edit_cache",
    "hal",
    "help",
    "install",
    "kinematics",
    "math",
    "package",
    "package_source",
    "preinstall",
    "rebuild_cache",
    "rtapi",
    "rtapi_app",
    "rtapi_math",
    "stdio",
    "test",
];

/// The most choices: an `unsigned` has 32 bits where controllers have floating-point units.
const MOST_CHOICES: u32 = 32;

/// The kinematics of one mechanism in C99.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CCode {
    /// The prefix of every symbol, and the name of the files without their endings.
    pub name: String,
    /// The header.
    pub header: String,
    /// The source file.
    pub source: String,
    /// A program that compares the code with poses that opm solved.
    pub test: String,
    /// Those poses.
    pub golden: String,
    /// What CMake builds: a library and the test.
    pub cmake: String,
    /// A kinematics module for LinuxCNC; `None` where forward kinematics have no one pose to find, or LinuxCNC has too few axes
    /// for it.
    pub linuxcnc: Option<String>,
}

impl CCode {
    /// The names of the files, and what they hold.
    pub fn files(&self) -> Vec<(String, &str)> {
        let name = &self.name;
        let mut files = vec![
            (format!("{name}.h"), &*self.header),
            (format!("{name}.c"), &*self.source),
            (format!("{name}_test.c"), &*self.test),
            (format!("{name}_golden.h"), &*self.golden),
            ("CMakeLists.txt".to_owned(), &*self.cmake),
        ];
        if let Some(module) = &self.linuxcnc {
            files.push((format!("{name}_linuxcnc.c"), module));
        }
        files
    }
}

/// Writes the kinematics of a mechanism in C99.
///
/// # Errors
/// The mechanism has more two-valued choices than an `unsigned` has bits.
pub fn c(manipulator: &Manipulator) -> Result<CCode, GenerateError> {
    let writer = Writer::new(manipulator)?;
    let name = package(&manipulator.mechanism().name, &RESERVED);
    let [header, source] = writer.files(&name);
    let of_mechanism = |text: &str| library::with_prefix(text, &name);
    let (header, source) = (of_mechanism(&header), of_mechanism(&source));
    let test = of_mechanism(
        &golden::program()
            .replace("NAME_.h", &format!("{name}.h"))
            .replace("NAME_:", &format!("{name}:")),
    );
    let golden = of_mechanism(&(golden::vectors(manipulator) + &golden::angles(manipulator)));
    let cmake = golden::cmake(&name);
    let linuxcnc = writer.linuxcnc();
    let linuxcnc = linuxcnc.map(|module| {
        let [source, header] = ["c", "h"].map(|ending| format!("{name}.{ending}"));
        of_mechanism(&module).replace("NAME.c", &source).replace("NAME.h", &header)
    });
    Ok(CCode { name, header, source, test, golden, cmake, linuxcnc })
}

/// The same code as a tree, from which other languages are printed.
pub(crate) fn tree(manipulator: &Manipulator) -> Result<tree::Code, GenerateError> {
    let files = Writer::new(manipulator)?.files("NAME");
    tree::parse(&files.concat()).map_err(GenerateError::Unread)
}

/// What is known of a mechanism while its code is written. The code has the prefix of the library until it is complete.
struct Writer<'a> {
    manipulator: &'a Manipulator,
    task: &'a Task,
    forms: ClosedForms,
    /// The names of the joints' displacements, as members of a struct.
    fields: Vec<String>,
    /// The functions that solve the two sections of each leg, in their order.
    legs: Vec<[Function; 2]>,
}

impl<'a> Writer<'a> {
    fn new(manipulator: &'a Manipulator) -> Result<Self, GenerateError> {
        let choices = manipulator.choices();
        if choices > MOST_CHOICES {
            return Err(GenerateError::Choices { choices, most: MOST_CHOICES });
        }
        let names = manipulator.coordinates().iter().map(|c| &*c.name);
        let fields = identifiers(names).into_iter().map(|name| format!("q_{name}")).collect();
        let (task, forms) = (manipulator.task(), manipulator.closed_forms());
        let mut writer = Self { manipulator, task, forms, fields, legs: Vec::new() };
        writer.legs = (0..writer.forms.legs.len()).map(|leg| writer.leg_functions(leg)).collect();
        Ok(writer)
    }

    /// The header and the source file, with the prefix of the library; `name` is that of the files.
    fn files(&self, name: &str) -> [String; 2] {
        let geometry = self.geometry();
        let body = self.body();
        let definition = geometry.definition();
        let types = library::types(&format!("{definition}{}", library::functions(&body)));
        let header = format!(
            "{}#ifndef {guard}\n#define {guard}\n\n{}{types}{}{definition}\n{}\n#endif\n",
            self.head("The closed-form kinematics of"),
            self.scalars(),
            "/* The geometry of the mechanism, metres and radians. */\n",
            self.declarations(),
            guard = format_args!("{}_H", name.to_uppercase()),
        );
        let source = format!(
            "{}#include \"{name}.h\"\n\n#include <math.h>\n\ntypedef NAME_real real;\n\n#define R(x) ((real)(x))\n\n{}\n{}{body}",
            self.head("The closed-form kinematics of"),
            geometry.default_value(),
            library::functions(&body),
        );
        [header, source]
    }

    /// The first comment of a file.
    fn head(&self, what: &str) -> String {
        let name = comment(&self.manipulator.mechanism().name);
        format!(
            "/* {what} {name}.\n   Written by opm {}; write it anew rather than change it. */\n\n",
            env!("CARGO_PKG_VERSION")
        )
    }

    /// The type of numbers, and how many coordinates there are.
    fn scalars(&self) -> String {
        let m = self.manipulator;
        let mut text = String::from(
            "/* All numbers: change this line to float for a controller that has no double. */\ntypedef double NAME_real;\n\n",
        );
        let counts = [
            ("COORDINATES", m.task_coordinates().len()),
            ("JOINTS", m.coordinates().len()),
            ("IMAGINARY", m.imaginary().len()),
            ("ACTUATED", m.actuated().len()),
            ("CHOICES", m.choices() as usize),
            ("LEGS", self.forms.legs.len()),
        ];
        text += "/* How many there are of each. */\nenum {\n";
        let rows = counts.map(|(name, count)| format!("    NAME_{name} = {count}"));
        let _ = write!(text, "{}\n}};\n\n", rows.join(",\n"));
        let unit = |quantity: Quantity| quantity.unit();
        let mut list = |what: &str, tag: &str, names: Vec<(&str, &str)>| {
            if names.is_empty() {
                return;
            }
            let _ = write!(text, "/* {what} */\nenum {{\n");
            let ids = identifiers(names.iter().map(|(name, _)| *name));
            for (number, (id, (name, unit))) in ids.iter().zip(&names).enumerate() {
                let comma = if number + 1 < names.len() { "," } else { "" };
                let shown = comment(name);
                let _ =
                    writeln!(text, "    NAME_{tag}_{id} = {number}{comma} /* {shown}, {unit} */");
            }
            text += "};\n\n";
        };
        let of_task = |c: &'a opm_core::TaskCoordinate| (c.name, unit(c.quantity));
        let of_joint = |c: &'a JointCoordinate| (&*c.name, unit(c.quantity));
        list(
            "The coordinates of a pose.",
            "POSE",
            m.task_coordinates().iter().map(of_task).collect(),
        );
        list(
            "The joint coordinates, leg by leg.",
            "JOINT",
            m.coordinates().iter().map(of_joint).collect(),
        );
        list(
            "The imaginary joints.",
            "IMAGINARY",
            m.imaginary().iter().map(|j| (&*j.name, unit(j.quantity))).collect(),
        );
        list(
            "The actuated joint coordinates.",
            "ACTUATED",
            m.actuated().iter().map(|&i| of_joint(&m.coordinates()[i])).collect(),
        );
        text
    }

    /// The geometry of the mechanism.
    fn geometry(&self) -> Geometry {
        let (m, forms, task) = (self.manipulator, &self.forms, self.task);
        let mut geometry = Geometry::default();
        let names: Vec<&str> = task.coordinates.iter().map(|c| c.name).collect();
        let home: Vec<String> = task.coordinates.iter().map(|c| number(c.home)).collect();
        geometry.add(
            "NAME_real",
            &format!("home[{}]", home.len()),
            &format!("The pose at home: {}.", names.join(", ")),
            format!("{{ {} }}", home.join(", ")),
        );
        geometry.add(
            "NAME_real",
            "size",
            "The size of the mechanism, for what is rounding.",
            number(forms.size),
        );
        let joints: Vec<String> = m
            .coordinates()
            .iter()
            .map(|c| {
                let [low, high] = c.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                let size = if c.quantity == Quantity::Angle { 1.0 } else { forms.size };
                let row = [c.home, low, high, size].map(number).join(", ");
                format!("\n        {{ {row} }} /* {} */", comment(&c.name))
            })
            .collect();
        geometry.add(
            "NAME_joint",
            "joint[NAME_JOINTS]",
            "The joint coordinates.",
            format!("{{{}\n    }}", joints.join(",")),
        );
        if !m.imaginary().is_empty() {
            let home: Vec<String> = m.imaginary().iter().map(|j| number(j.home)).collect();
            geometry.add(
                "NAME_real",
                "imaginary[NAME_IMAGINARY]",
                "The imaginary joints at home.",
                format!("{{ {} }}", home.join(", ")),
            );
        }
        if let Some(inverse) = &forms.home_orientation_inverse {
            geometry.add(
                "NAME_rotation",
                "home_orientation_inverse",
                "The inverse of the platform's orientation at home.",
                rotation(inverse),
            );
        }
        for section in [Section::Lower, Section::Upper] {
            let along = match pose::intersection(task, section) {
                IntersectionMotion::Planar(PlanarMotion::Translation(along))
                | IntersectionMotion::Translational(TranslationalMotion::Translation(along)) => {
                    along
                }
                _ => continue,
            };
            let word = pose::word(section);
            let what = format!("The shared translation in the frame of the {word} sections.");
            geometry.add("NAME_complex", &format!("{word}_along"), &what, complex(*along));
        }
        if let Some(height) = forms.height.filter(|height| height.slope != 0.0) {
            let what = "What a unit of a leg's displacement along the shared translation adds to its height.";
            geometry.add("NAME_real", "slope", what, number(height.slope));
        }
        self.add_frames(&mut geometry);
        for (place, leg) in forms.legs.iter().enumerate() {
            let name = comment(&m.mechanism().legs[place].name);
            let place = place + 1;
            for section in [Section::Lower, Section::Upper] {
                let form = leg.section(section);
                let word = pose::word(section);
                if let Some((kind, value)) = geometry::section(form) {
                    let of_joint = |joint: usize| match form.coordinates[joint] {
                        Some(coordinate) => comment(&m.coordinates()[coordinate].name),
                        None => "the imaginary joint".to_owned(),
                    };
                    let free = (0..form.chain.freedoms())
                        .filter(|&i| form.locked.is_none_or(|locked| !locked[i]));
                    let joints: Vec<String> = free.map(of_joint).collect();
                    let what =
                        format!("Leg {place}, {name}, {word} section: {}.", joints.join(", "));
                    geometry.add(
                        &format!("NAME_{kind}"),
                        &format!("leg{place}_{word}"),
                        &what,
                        value,
                    );
                }
                if let Some((_, rate)) = form.slider {
                    let what = format!(
                        "Leg {place}, {name}: the part of the imaginary joint in the plane."
                    );
                    geometry.add(
                        "NAME_part",
                        &format!("leg{place}_part"),
                        &what,
                        format!("{{ {} }}", number(rate)),
                    );
                }
            }
            if let Some(lift) = &leg.lift {
                let (kind, value) = geometry::lift(lift);
                let joint = comment(&m.coordinates()[lift.coordinate].name);
                let what = format!("Leg {place}, {name}: {joint}, which carries the height.");
                geometry.add(kind, &format!("leg{place}_lift"), &what, value);
            }
        }
        for (place, step) in forms.steps.iter().enumerate() {
            let place = place + 1;
            let name = comment(&m.mechanism().legs[step.leg].name);
            let what = format!("What leg {name} demands of its {} section.", step.section);
            match &step.kind {
                StepKind::Constant => {}
                StepKind::Condition { condition, .. } => {
                    let (kind, value) = geometry::condition(condition);
                    geometry.add(
                        &format!("NAME_{kind}"),
                        &format!("condition{place}"),
                        &what,
                        value,
                    );
                }
                StepKind::Joint { motion, .. } => {
                    let planar =
                        pose::kind(task, step.section) == opm_core::group::SubspaceKind::Planar;
                    let (kind, value) = match motion {
                        SectionMotion::None | SectionMotion::Third => continue,
                        // The position of the axis: v = -i ω p.
                        SectionMotion::Turn(s) => {
                            ("NAME_complex", complex(nalgebra::Complex::new(-s.z, s.y) * s.x))
                        }
                        SectionMotion::Slide(s, _) if planar => {
                            ("NAME_complex", complex(nalgebra::Complex::new(s.y, s.z)))
                        }
                        SectionMotion::Slide(s, _)
                        | SectionMotion::Axis(s)
                        | SectionMotion::LastAngle(s) => ("NAME_vector", vector(s)),
                    };
                    geometry.add(kind, &format!("joint{place}"), &what, value);
                }
            }
        }
        for (place, check) in forms.checks.iter().enumerate() {
            let name = comment(&m.mechanism().legs[check.leg].name);
            let what =
                format!("What leg {name} demands of its {} section, as others do.", check.section);
            let (kind, value) = geometry::condition(&check.condition);
            geometry.add(&format!("NAME_{kind}"), &format!("check{}", place + 1), &what, value);
        }
        geometry
    }

    /// The functions of the mechanism.
    fn body(&self) -> String {
        let mut body = String::new();
        for section in [Section::Lower, Section::Upper] {
            body += &pose::function(self.task, &self.forms, section);
        }
        let mut functions = self.displacements();
        for leg in &self.legs {
            for Function { text, .. } in leg {
                functions += text;
            }
        }
        functions += &self.complete();
        body + &functions + &self.interface()
    }

    /// The struct of the displacements that the legs' functions write.
    fn displacements(&self) -> String {
        let mut text = String::from(
            "/* Displacements of the joints and along the intersection motion (tau) from home: lengths, angles as directions, and of\n   \
             spherical joints the axis, and half the angle. */\n\
             typedef struct {\n",
        );
        for (number, field) in self.fields.iter().enumerate() {
            let of_type = self.given(number).of_type();
            let _ = writeln!(text, "    {of_type} {field};");
        }
        for (number, leg) in self.forms.legs.iter().enumerate() {
            if let Some(tau) = self.tau(leg) {
                let _ = writeln!(text, "    {} tau_{};", tau.of_type(), number + 1);
            }
            for section in [Section::Lower, Section::Upper] {
                if let Chain::Ball(_) = leg.section(section).chain {
                    let _ = writeln!(text, "    NAME_complex {};", leg::ball(number, section));
                }
            }
        }
        text + "} NAME_displacements;\n\n"
    }

    /// The member that has half the angle of the spherical joint that a coordinate belongs to.
    fn ball_of(&self, coordinate: usize) -> Option<String> {
        let legs = self.forms.legs.iter().enumerate();
        let sections =
            legs.flat_map(|(leg, form)| [Section::Lower, Section::Upper].map(|of| (leg, of, form)));
        let mut balls =
            sections.filter(|(_, of, form)| matches!(form.section(*of).chain, Chain::Ball(_)));
        let found =
            balls.find(|(_, of, form)| form.section(*of).coordinates.contains(&Some(coordinate)));
        found.map(|(leg, of, _)| leg::ball(leg, of))
    }

    /// The form in which the displacement of a joint coordinate is given.
    fn given(&self, coordinate: usize) -> Given {
        for leg in &self.forms.legs {
            for section in [&leg.lower, &leg.upper] {
                if let Some(joint) = section.coordinates.iter().position(|c| *c == Some(coordinate))
                {
                    return match section.chain {
                        Chain::Ball(_) => Given::Value,
                        _ => given(section, joint),
                    };
                }
            }
        }
        // One that carries a height.
        Given::Value
    }
}
