//! The lines, points and planes of a group that guide its joints.

use crate::group::subspace::SubspaceClass;
use nalgebra::{Point3, Unit, Vector3};

/// What a group fixes of the joints in it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Guides {
    /// The direction of every axis of rotation.
    pub axis: Option<Unit<Vector3<f64>>>,
    /// The direction of every slide.
    pub slide: Option<Unit<Vector3<f64>>>,
    /// The normal of the plane in which every slide lies.
    pub normal: Option<Unit<Vector3<f64>>>,
    /// The line on which every axis of rotation lies.
    pub line: Option<(Unit<Vector3<f64>>, Point3<f64>)>,
    /// The point that every axis of rotation passes through.
    pub centre: Option<Point3<f64>>,
}

impl Guides {
    pub fn of(group: &SubspaceClass) -> Self {
        let none = Self::default();
        match *group {
            SubspaceClass::Identity | SubspaceClass::TranslationalSpace | SubspaceClass::Full => {
                none
            }
            SubspaceClass::Rotation { axis, point }
            | SubspaceClass::Helical { axis, point, .. } => {
                Self { axis: Some(axis), line: Some((axis, point)), ..none }
            }
            SubspaceClass::Translation { axis } => Self { slide: Some(axis), ..none },
            SubspaceClass::Cylindrical { axis, point } => {
                Self { axis: Some(axis), slide: Some(axis), line: Some((axis, point)), ..none }
            }
            SubspaceClass::TranslationalPlane { normal } => Self { normal: Some(normal), ..none },
            SubspaceClass::Planar { normal }
            | SubspaceClass::PlanarHelical { axis: normal, .. } => {
                Self { axis: Some(normal), normal: Some(normal), ..none }
            }
            SubspaceClass::Spherical { centre } => Self { centre: Some(centre), ..none },
            SubspaceClass::Schoenflies { axis } => Self { axis: Some(axis), ..none },
        }
    }
}
