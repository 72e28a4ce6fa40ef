//! The colours of materials.

use opm_core::skeleton::Material;

/// The materials that bodies of a mechanism have.
pub const MATERIALS: [Material; 5] = {
    use Material::{Actuated, Base, Link, Passive, Platform};
    [Base, Link, Actuated, Passive, Platform]
};

/// Red, green, blue and opacity, from 0 to 1.
pub fn color(material: Material) -> [f64; 4] {
    match material {
        Material::Base => [0.25, 0.27, 0.3, 1.0],
        Material::Link => [0.7, 0.72, 0.75, 1.0],
        Material::Actuated => [0.9, 0.5, 0.1, 1.0],
        Material::Passive => [0.55, 0.75, 0.9, 1.0],
        Material::Platform => [0.15, 0.4, 0.75, 1.0],
        Material::Imaginary => [0.6, 0.6, 0.6, 0.3],
    }
}
