//! Mechanisms and decompositions displaced as rigid bodies.

use nalgebra::{Isometry3, Vector3};
use opm_core::decomposition::Decomposition;
use opm_core::group::subspace::SubspaceClass;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::JointKind;

/// The mechanism displaced as a rigid body, including its task hints.
pub fn displace(mechanism: &Mechanism, g: &Isometry3<f64>) -> Mechanism {
    let mut displaced = mechanism.clone();
    for joint in displaced.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        (joint.axis, joint.point) = (g * joint.axis, g * joint.point);
        if let JointKind::Universal { second } = &mut joint.kind {
            *second = g * *second;
        }
    }
    for label in displaced.legs.iter_mut().filter_map(|leg| leg.imaginary.as_mut()) {
        label.positive = g * label.positive;
    }
    displaced.platform = g * mechanism.platform;
    let task = &mut displaced.task;
    let turned = |v: &mut Option<Vector3<f64>>| *v = v.map(|v| g * v);
    turned(&mut task.axis);
    for frame in [&mut task.lower, &mut task.upper] {
        turned(&mut frame.x);
        turned(&mut frame.axis);
        turned(&mut frame.w);
        turned(&mut frame.normal);
        frame.origin = frame.origin.map(|point| g * point);
    }
    displaced
}

/// The decomposition of the displaced mechanism.
pub fn displace_decomposition(decomposition: &Decomposition, g: &Isometry3<f64>) -> Decomposition {
    let class = |class: &SubspaceClass| match *class {
        SubspaceClass::Rotation { axis, point } => {
            SubspaceClass::Rotation { axis: g * axis, point: g * point }
        }
        SubspaceClass::Translation { axis } => SubspaceClass::Translation { axis: g * axis },
        SubspaceClass::Planar { normal } => SubspaceClass::Planar { normal: g * normal },
        SubspaceClass::TranslationalPlane { normal } => {
            SubspaceClass::TranslationalPlane { normal: g * normal }
        }
        SubspaceClass::Cylindrical { axis, point } => {
            SubspaceClass::Cylindrical { axis: g * axis, point: g * point }
        }
        SubspaceClass::Spherical { centre } => SubspaceClass::Spherical { centre: g * centre },
        SubspaceClass::Schoenflies { axis } => SubspaceClass::Schoenflies { axis: g * axis },
        SubspaceClass::TranslationalSpace => SubspaceClass::TranslationalSpace,
        SubspaceClass::Identity => SubspaceClass::Identity,
        other => panic!("{other}: not a subspace of these mechanisms"),
    };
    Decomposition {
        lower: class(&decomposition.lower),
        upper: class(&decomposition.upper),
        intersection: class(&decomposition.intersection),
        ..decomposition.clone()
    }
}
