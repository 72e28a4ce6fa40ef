//! The geometry of a mechanism: the members of the C struct, and their values.

use nalgebra::{Complex, Matrix3, Vector3};
use opm_core::chain::Chain;
use opm_core::chain::condition::Condition;
use opm_core::chain::cylindrical::CoaxialJoint;
use opm_core::chain::planar::PlanarJoint;
use opm_core::manipulator::form::{LiftForm, SectionForm};
use std::fmt::Write;

/// The members of the struct, in its order.
#[derive(Default)]
pub struct Geometry {
    members: Vec<Member>,
}

struct Member {
    /// The type, and the name with the number of elements of an array.
    declaration: [String; 2],
    comment: String,
    value: String,
}

impl Geometry {
    /// Adds a member; `name` may have a number of elements: `home[5]`.
    pub fn add(&mut self, kind: &str, name: &str, comment: &str, value: String) {
        let declaration = [kind, name].map(str::to_owned);
        self.members.push(Member { declaration, comment: comment.to_owned(), value });
    }

    /// The definition of the type.
    pub fn definition(&self) -> String {
        let mut text = String::from("typedef struct {\n");
        for Member { declaration: [kind, name], comment, .. } in &self.members {
            let _ = writeln!(text, "    /* {comment} */\n    {kind} {name};");
        }
        text + "} NAME_geometry;\n"
    }

    /// The mechanism's own.
    pub fn default_value(&self) -> String {
        let mut text = String::from("const NAME_geometry NAME_default = {\n");
        for Member { declaration: [_, name], value, .. } in &self.members {
            let name = name.split('[').next().unwrap_or(name);
            let _ = writeln!(text, "    /* {name} */\n    {value},");
        }
        text + "};\n"
    }
}

/// A number with all its digits.
pub fn number(value: f64) -> String {
    if value == f64::INFINITY {
        return "R(INFINITY)".into();
    }
    if value == f64::NEG_INFINITY {
        return "R(-INFINITY)".into();
    }
    // Adding zero makes a negative zero positive.
    format!("R({:?})", value + 0.0)
}

pub fn complex(z: Complex<f64>) -> String {
    format!("{{ {}, {} }}", number(z.re), number(z.im))
}

pub fn vector(v: &Vector3<f64>) -> String {
    format!("{{ {}, {}, {} }}", number(v.x), number(v.y), number(v.z))
}

pub fn rotation(r: &Matrix3<f64>) -> String {
    let columns = [0, 1, 2].map(|i| vector(&r.column(i).into_owned()));
    format!("{{ {} }}", columns.join(", "))
}

fn planar_joint(joint: &PlanarJoint) -> String {
    match joint {
        PlanarJoint::Revolute { at, reversed } => {
            format!("{{ {}, {} }}", complex(*at), number(if *reversed { -1.0 } else { 1.0 }))
        }
        PlanarJoint::Prismatic { along } => complex(*along),
    }
}

fn coaxial(joint: &CoaxialJoint) -> String {
    format!("{{ {}, {} }}", number(joint.rotation), number(joint.advance))
}

/// The type of a section's geometry without its prefix, and its value; `None` for a section without joints.
pub fn section(form: &SectionForm) -> Option<(String, String)> {
    let free: Vec<usize> = (0..form.chain.freedoms())
        .filter(|&i| form.locked.is_none_or(|locked| !locked[i]))
        .collect();
    if free.is_empty() {
        return None;
    }
    let (kind, joints): (String, Vec<String>) = match &form.chain {
        Chain::Rigid => return None,
        Chain::Planar(chain) => {
            let joints = chain.joints();
            let letter = |joint: &PlanarJoint| match joint {
                PlanarJoint::Revolute { .. } => 'r',
                PlanarJoint::Prismatic { .. } => 'p',
            };
            let letters: String = free.iter().map(|&i| letter(&joints[i])).collect();
            (format!("planar_{letters}"), free.iter().map(|&i| planar_joint(&joints[i])).collect())
        }
        Chain::Spherical(chain) => {
            let kind = format!("spherical_{}", "r".repeat(free.len()));
            (kind, free.iter().map(|&i| vector(&chain.axes()[i])).collect())
        }
        Chain::Ball(ball) => ("spherical_s".into(), vec![rotation(&ball.axes)]),
        Chain::Cylindrical(chain) => {
            let kind = if free.len() == 2 { "cylindrical_two" } else { "cylindrical_one" };
            (kind.into(), free.iter().map(|&i| coaxial(&chain.joints()[i])).collect())
        }
        Chain::Translational(chain) => {
            let kind = format!("translational_{}", "p".repeat(free.len()));
            (kind, free.iter().map(|&i| complex(chain.slides()[i])).collect())
        }
        Chain::Spatial(chain) => {
            let kind = format!("spatial_{}", "p".repeat(free.len()));
            (kind, free.iter().map(|&i| vector(&chain.slides()[i])).collect())
        }
    };
    Some((kind, format!("{{ {} }}", joints.join(", "))))
}

/// The type and the value of a condition.
pub fn condition(condition: &Condition) -> (&'static str, String) {
    match condition {
        Condition::Circle { point, centre, radius } => (
            "circle",
            format!("{{ {}, {}, {} }}", complex(*point), complex(*centre), number(*radius)),
        ),
        Condition::Line { point, normal, offset } => (
            "line",
            format!("{{ {}, {}, {} }}", complex(*point), complex(*normal), number(*offset)),
        ),
        Condition::CarriedLine { point, normal, offset } => (
            "carried_line",
            format!("{{ {}, {}, {} }}", complex(*point), complex(*normal), number(*offset)),
        ),
        Condition::Heading { rotation } => ("heading", format!("{{ {} }}", complex(*rotation))),
        Condition::Cone { fixed, carried, cosine } => {
            ("cone", format!("{{ {}, {}, {} }}", vector(fixed), vector(carried), number(*cosine)))
        }
        Condition::Flat { normal, value } => {
            ("flat", format!("{{ {}, {} }}", vector(normal), number(*value)))
        }
    }
}

/// The type and the value of a joint that carries the height.
pub fn lift(lift: &LiftForm) -> (&'static str, String) {
    match &lift.lean {
        None => ("NAME_lift", format!("{{ {} }}", number(lift.rate))),
        Some(lean) => {
            let velocity = complex(Complex::new(lean.screw.y, lean.screw.z));
            let [rate, turn] = [lift.rate, lean.screw.x].map(number);
            ("NAME_leaning_lift", format!("{{ {rate}, {turn}, {velocity} }}"))
        }
    }
}
