//! The geometry of a mechanism: the members of its struct, and their values.

use super::{GEOMETRY, Writer, word};
use crate::Content;
use crate::library::{Complex, Frame, Joint, LeaningLift, Lift, Part, Rotation, Vector};
use crate::names::comment;
use crate::trace::Handle;
use crate::tree::{Member, Struct, Type, Value};
use opm_core::chain::Chain;
use opm_core::chain::condition::Condition;
use opm_core::chain::cylindrical::CoaxialJoint;
use opm_core::chain::planar::PlanarJoint;
use opm_core::group::{IntersectionMotion, PlanarMotion, SubspaceKind, TranslationalMotion};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{LiftForm, SectionForm, SectionMotion, StepForm, StepKind};
use opm_core::numeric::Quantity;

/// The members of the struct, with their values.
#[derive(Default)]
pub struct Geometry {
    members: Vec<Member>,
    values: Vec<Value>,
}

impl Geometry {
    pub fn add(&mut self, kind: Type, name: &str, comment: &str, value: Value) {
        let (name, comment) = (name.to_owned(), comment.to_owned());
        self.members.push(Member { name, kind, comment });
        self.values.push(value);
    }

    pub fn list(&mut self, kind: Type, name: &str, comment: &str, values: Vec<Value>) {
        self.add(Type::Array(Box::new(kind), values.len()), name, comment, Value::List(values));
    }
}

impl Writer<'_> {
    /// The struct of the geometry, and the mechanism's own.
    pub fn geometry(&self) -> (Struct, Value) {
        let (m, forms, task) = (self.manipulator, &self.forms, self.task);
        let mut geometry = Geometry::default();
        let names: Vec<&str> = task.coordinates.iter().map(|c| c.name).collect();
        let what = format!("The pose at home: {}.", names.join(", "));
        let home = task.coordinates.iter().map(|c| real(c.home)).collect();
        geometry.list(Type::Real, "home", &what, home);
        let what = "The size of the mechanism, for what is rounding.";
        geometry.add(Type::Real, "size", what, real(forms.size));
        let joint = |c: &opm_core::mechanism::joint::JointCoordinate| {
            let [low, high] = c.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let size = if c.quantity == Quantity::Angle { 1.0 } else { forms.size };
            numbers(&[c.home, low, high, size])
        };
        let joints = m.coordinates().iter().map(joint).collect();
        geometry.list(Joint::kind(), "joint", "The joint coordinates.", joints);
        if !m.imaginary().is_empty() {
            let home = m.imaginary().iter().map(|j| real(j.home)).collect();
            geometry.list(Type::Real, "imaginary", "The imaginary joints at home.", home);
        }
        if let Some(inverse) = &forms.home_orientation_inverse {
            let what = "The inverse of the platform's orientation at home.";
            let value = rotation(inverse);
            geometry.add(Rotation::kind(), "home_orientation_inverse", what, value);
        }
        for section in [Section::Lower, Section::Upper] {
            if let IntersectionMotion::Planar(PlanarMotion::Translation(along))
            | IntersectionMotion::Translational(TranslationalMotion::Translation(along)) =
                self.intersection(section)
            {
                let word = word(section);
                let what = format!("The shared translation in the frame of the {word} sections.");
                let value = numbers(&[along.re, along.im]);
                geometry.add(Complex::kind(), &format!("{word}_along"), &what, value);
            }
        }
        if let Some(height) = forms.height.filter(|height| height.slope != 0.0) {
            let what = "What a unit of a leg's displacement along the shared translation adds to its height.";
            geometry.add(Type::Real, "slope", what, real(height.slope));
        }
        self.add_frames(&mut geometry);
        for leg in 0..forms.legs.len() {
            self.add_leg(leg, &mut geometry);
        }
        for (place, step) in (1..).zip(&forms.steps) {
            self.add_step(place, step, &mut geometry);
        }
        for (place, check) in (1..).zip(&forms.checks) {
            let name = comment(&m.mechanism().legs[check.leg].name);
            let what =
                format!("What leg {name} demands of its {} section, as others do.", check.section);
            let (kind, value) = condition(&check.condition);
            let kind = Type::Struct(kind.to_owned());
            geometry.add(kind, &format!("check{place}"), &what, value);
        }
        if self.content == Content::Dynamics {
            self.add_dynamics(&mut geometry);
        }
        let one = Struct {
            name: GEOMETRY.to_owned(),
            comment: match self.content {
                Content::Kinematics => "The geometry of the mechanism, metres and radians.",
                Content::Dynamics => {
                    "The geometry of the mechanism and its bodies, metres, radians and kilograms."
                }
            }
            .to_owned(),
            members: geometry.members,
        };
        (one, Value::List(geometry.values))
    }

    /// The frames of the sections, and the platform at home.
    fn add_frames(&self, geometry: &mut Geometry) {
        for (section, frame) in
            [(Section::Lower, &self.task.lower), (Section::Upper, &self.task.upper)]
        {
            if frame.kind != SubspaceKind::Identity {
                let word = word(section);
                let value = Value::List(vec![vector(&frame.origin.coords), rotation(&frame.axes)]);
                let what = format!("The frame of the {word} sections, base coordinates.");
                geometry.add(Frame::kind(), &format!("{word}_frame"), &what, value);
            }
        }
        let platform = self.manipulator.mechanism().platform.coords;
        let what = "The platform's reference point at home, base coordinates.";
        geometry.add(Vector::kind(), "platform", what, vector(&platform));
        if self.forms.home_orientation_inverse.is_some() {
            let home = self.task.home_orientation().to_rotation_matrix().into_inner();
            let what = "The platform's orientation at home, base coordinates.";
            geometry.add(Rotation::kind(), "orientation", what, rotation(&home));
        }
    }

    fn add_leg(&self, leg: usize, geometry: &mut Geometry) {
        let m = self.manipulator;
        let of_joint = |joint: usize| comment(&m.coordinates()[joint].name);
        let (form, place) = (&self.forms.legs[leg], leg + 1);
        let name = comment(&m.mechanism().legs[leg].name);
        for of in [Section::Lower, Section::Upper] {
            let (section, word) = (form.section(of), word(of));
            if let Some((kind, value)) = chain(section) {
                let named = |joint: usize| {
                    section.coordinates[joint].map_or("the imaginary joint".to_owned(), of_joint)
                };
                let joints: Vec<String> = free(section).into_iter().map(named).collect();
                let what = format!("Leg {place}, {name}, {word} section: {}.", joints.join(", "));
                geometry.add(Type::Struct(kind), &format!("leg{place}_{word}"), &what, value);
            }
            if let Some((_, rate)) = section.slider {
                let what =
                    format!("Leg {place}, {name}: the part of the imaginary joint in the plane.");
                let member = format!("leg{place}_part");
                geometry.add(Part::kind(), &member, &what, numbers(&[rate]));
            }
        }
        if let Some(LiftForm { coordinate, rate, lean }) = &form.lift {
            let (kind, value) = match lean {
                None => (Lift::kind(), numbers(&[*rate])),
                Some(lean) => {
                    let velocity = numbers(&[lean.screw.y, lean.screw.z]);
                    let members = vec![real(*rate), real(lean.screw.x), velocity];
                    (LeaningLift::kind(), Value::List(members))
                }
            };
            let what = format!(
                "Leg {place}, {name}: {}, which carries the height.",
                of_joint(*coordinate)
            );
            geometry.add(kind, &format!("leg{place}_lift"), &what, value);
        }
    }

    fn add_step(&self, place: usize, step: &StepForm, geometry: &mut Geometry) {
        let name = comment(&self.manipulator.mechanism().legs[step.leg].name);
        let what = format!("What leg {name} demands of its {} section.", step.section);
        match &step.kind {
            StepKind::Constant => {}
            StepKind::Condition { condition: demanded, .. } => {
                let (kind, value) = condition(demanded);
                let kind = Type::Struct(kind.to_owned());
                geometry.add(kind, &format!("condition{place}"), &what, value);
            }
            StepKind::Joint { motion, .. } => {
                let planar = self.kind(step.section) == SubspaceKind::Planar;
                let (kind, value) = match motion {
                    SectionMotion::None | SectionMotion::Third => return,
                    // The position of the axis: v = -i ω p.
                    SectionMotion::Turn(s) => (Complex::kind(), numbers(&[-s.z * s.x, s.y * s.x])),
                    SectionMotion::Slide(s, _) if planar => (Complex::kind(), numbers(&[s.y, s.z])),
                    SectionMotion::Slide(s, _)
                    | SectionMotion::Axis(s)
                    | SectionMotion::LastAngle(s) => (Vector::kind(), vector(s)),
                };
                geometry.add(kind, &format!("joint{place}"), &what, value);
            }
        }
    }
}

/// A number; adding zero makes a negative zero positive.
pub fn real(value: f64) -> Value {
    Value::Number(value + 0.0)
}

pub fn numbers(values: &[f64]) -> Value {
    Value::List(values.iter().map(|&value| real(value)).collect())
}

pub fn vector(v: &nalgebra::Vector3<f64>) -> Value {
    numbers(v.as_slice())
}

fn rotation(r: &nalgebra::Matrix3<f64>) -> Value {
    Value::List(r.column_iter().map(|column| vector(&column.into_owned())).collect())
}

fn complex(z: nalgebra::Complex<f64>) -> Value {
    numbers(&[z.re, z.im])
}

fn planar_joint(joint: &PlanarJoint) -> Value {
    match joint {
        PlanarJoint::Revolute { at, reversed } => {
            Value::List(vec![complex(*at), real(if *reversed { -1.0 } else { 1.0 })])
        }
        PlanarJoint::Prismatic { along } => complex(*along),
    }
}

fn coaxial(joint: &CoaxialJoint) -> Value {
    numbers(&[joint.rotation, joint.advance])
}

/// The joints of a section that are not locked.
pub fn free(form: &SectionForm) -> Vec<usize> {
    (0..form.chain.freedoms()).filter(|&i| form.locked.is_none_or(|locked| !locked[i])).collect()
}

/// The type of a section's geometry, and its value; `None` for a section without joints.
pub fn chain(form: &SectionForm) -> Option<(String, Value)> {
    let free = free(form);
    if free.is_empty() {
        return None;
    }
    let repeated = |letter: &str| letter.repeat(free.len());
    let (kind, joints): (String, Vec<Value>) = match &form.chain {
        Chain::Rigid | Chain::Part(_) => return None,
        Chain::Planar(chain) => {
            let joints = chain.joints();
            let letter = |i: &usize| match joints[*i] {
                PlanarJoint::Revolute { .. } => 'r',
                PlanarJoint::Prismatic { .. } => 'p',
            };
            let letters: String = free.iter().map(letter).collect();
            (format!("planar_{letters}"), free.iter().map(|&i| planar_joint(&joints[i])).collect())
        }
        Chain::Spherical(chain) => {
            let axes = free.iter().map(|&i| vector(&chain.axes()[i]));
            (format!("spherical_{}", repeated("r")), axes.collect())
        }
        Chain::Ball(ball) => ("spherical_s".into(), vec![rotation(&ball.axes)]),
        Chain::Cylindrical(chain) => {
            let kind = if free.len() == 2 { "cylindrical_two" } else { "cylindrical_one" };
            (kind.into(), free.iter().map(|&i| coaxial(&chain.joints()[i])).collect())
        }
        Chain::Translational(chain) => {
            let slides = free.iter().map(|&i| complex(chain.slides()[i]));
            (format!("translational_{}", repeated("p")), slides.collect())
        }
        Chain::Spatial(chain) => {
            let slides = free.iter().map(|&i| vector(&chain.slides()[i]));
            (format!("spatial_{}", repeated("p")), slides.collect())
        }
    };
    Some((kind, Value::List(joints)))
}

/// The type and the value of a condition.
pub fn condition(condition: &Condition) -> (&'static str, Value) {
    match condition {
        Condition::Circle { point, centre, radius } => {
            ("circle", Value::List(vec![complex(*point), complex(*centre), real(*radius)]))
        }
        Condition::Line { point, normal, offset } => {
            ("line", Value::List(vec![complex(*point), complex(*normal), real(*offset)]))
        }
        Condition::CarriedLine { point, normal, offset } => {
            ("carried_line", Value::List(vec![complex(*point), complex(*normal), real(*offset)]))
        }
        Condition::Heading { rotation } => ("heading", Value::List(vec![complex(*rotation)])),
        Condition::Cone { fixed, carried, cosine } => {
            ("cone", Value::List(vec![vector(fixed), vector(carried), real(*cosine)]))
        }
        Condition::Flat { normal, value } => {
            ("flat", Value::List(vec![vector(normal), real(*value)]))
        }
    }
}
