//! The shapes and the masses of links.

use super::joints::origin;
use crate::xml::Element;
use nalgebra::{Point3, Unit, UnitQuaternion, Vector3};
use opm_core::skeleton::{Body, BodyPart, Mass, Solid};

/// A link with the shapes of a body, whose frame is at `place`.
pub fn link(name: &str, body: &Body, place: Point3<f64>) -> Element {
    let shift = body.origin - place;
    Element::new("link")
        .with("name", name)
        .children(body.parts.iter().map(|part| visual(part, shift)))
}

/// The mass of a body whose frame is at `shift` in that of its link.
pub fn inertial(mass: &Mass, shift: Vector3<f64>) -> Element {
    let i = &mass.inertia;
    let tensor = Element::new("inertia")
        .numbers("ixx", &[i.m11])
        .numbers("ixy", &[i.m12])
        .numbers("ixz", &[i.m13])
        .numbers("iyy", &[i.m22])
        .numbers("iyz", &[i.m23])
        .numbers("izz", &[i.m33]);
    Element::new("inertial")
        .child(origin(mass.centre.coords + shift, &UnitQuaternion::identity()))
        .child(Element::new("mass").numbers("value", &[mass.mass]))
        .child(tensor)
}

fn visual(part: &BodyPart, shift: Vector3<f64>) -> Element {
    let (centre, axis, shape) = match part.solid {
        Solid::Cylinder { from, to, radius } => {
            let axis = Unit::try_new(to - from, 0.0).unwrap_or(Vector3::z_axis());
            let shape = Element::new("cylinder")
                .numbers("radius", &[radius])
                .numbers("length", &[(to - from).norm()]);
            (nalgebra::center(&from, &to), axis, shape)
        }
        Solid::Ball { centre, radius } => {
            (centre, Vector3::z_axis(), Element::new("sphere").numbers("radius", &[radius]))
        }
        Solid::Block { centre, axis, length, width } => {
            (centre, axis, Element::new("box").numbers("size", &[width, width, length]))
        }
    };
    let turn =
        UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &axis).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        });
    Element::new("visual")
        .child(origin(centre.coords + shift, &turn))
        .child(Element::new("geometry").child(shape))
        .child(Element::new("material").with("name", part.material.name()))
}
