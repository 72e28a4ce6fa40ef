//! The shapes and the masses of bodies.

use crate::color::{MATERIALS, color};
use crate::xml::Element;
use nalgebra::{Unit, UnitQuaternion, Vector3};
use opm_core::skeleton::{Body, BodyPart, Mass, Solid};

/// MuJoCo refuses cylinders between ends that are nearer than 3e-8 m. Those of a length below this are written by their middle.
const SHORT: f64 = 1e-6;

/// The shapes of a body.
pub fn shapes(body: &Body) -> impl Iterator<Item = Element> {
    body.parts.iter().map(geom)
}

/// The mass of a body.
pub fn inertial(mass: &Mass) -> Element {
    let i = &mass.inertia;
    let tensor = [i.m11, i.m22, i.m33, i.m12, i.m13, i.m23];
    Element::new("inertial")
        .numbers("pos", mass.centre.coords.as_slice())
        .numbers("mass", &[mass.mass])
        .numbers("fullinertia", &tensor)
}

/// The colours.
pub fn materials() -> Element {
    Element::new("asset").children(MATERIALS.map(|material| {
        Element::new("material").with("name", material.name()).numbers("rgba", &color(material))
    }))
}

fn geom(part: &BodyPart) -> Element {
    let geom = Element::new("geom");
    let shape = match part.solid {
        Solid::Cylinder { from, to, radius } if (to - from).norm() < SHORT => {
            let along = Unit::try_new(to - from, 0.0).unwrap_or_else(Vector3::z_axis);
            geom.with("type", "cylinder")
                .numbers("pos", nalgebra::center(&from, &to).coords.as_slice())
                .numbers("quat", &from_z(&along))
                .numbers("size", &[radius, 0.5 * (to - from).norm()])
        }
        Solid::Cylinder { from, to, radius } => {
            let ends = [from.x, from.y, from.z, to.x, to.y, to.z];
            geom.with("type", "cylinder").numbers("fromto", &ends).numbers("size", &[radius])
        }
        Solid::Ball { centre, radius } => geom
            .with("type", "sphere")
            .numbers("pos", centre.coords.as_slice())
            .numbers("size", &[radius]),
        Solid::Block { centre, axis, length, width } => geom
            .with("type", "box")
            .numbers("pos", centre.coords.as_slice())
            .numbers("quat", &from_z(&axis))
            .numbers("size", &[0.5 * width, 0.5 * width, 0.5 * length]),
    };
    shape.with("material", part.material.name())
}

/// The quaternion, real part first, of a rotation that takes z to an axis.
fn from_z(axis: &Unit<Vector3<f64>>) -> [f64; 4] {
    let along = UnitQuaternion::rotation_between(&Vector3::z(), axis).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    });
    [along.w, along.i, along.j, along.k]
}
