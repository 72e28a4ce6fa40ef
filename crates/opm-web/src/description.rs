//! A mechanism as the page shows it: its coordinates, joints, modes, sections, dimensions and bodies.

use crate::changes::{Dimension, dimensions};
use crate::explorer::Explorer;
use crate::scene::{self, Body};
use crate::session::Reply;
use crate::units::{shown, shown_range};
use opm_core::decomposition::mobility::mobility;
use opm_core::group::subspace::SubspaceClass;
use opm_core::nalgebra::{Point3, Unit, Vector3};
use opm_core::{Quantity, TaskCoordinate};
use serde::Serialize;

/// Most choices whose modes are listed: 256 modes. A mechanism with more has its home mode alone in the list.
const MOST_CHOICES: u32 = 8;

#[derive(Serialize)]
struct Description<'a> {
    name: &'a str,
    length: &'static str,
    angle: &'static str,
    coordinates: Vec<Coordinate>,
    dependent: Vec<Coordinate>,
    home_mode: String,
    modes: Vec<String>,
    /// The rank of all joint screws.
    lambda: usize,
    mobility: usize,
    lower: Subspace,
    upper: Subspace,
    intersection: Subspace,
    imaginary_joints: usize,
    joints: Vec<Joint<'a>>,
    /// Whether forward kinematics have a closed form.
    forward: bool,
    /// What cannot be told at home, where it is a parallel singularity.
    home_warning: Option<String>,
    dimensions: Vec<Dimension>,
    bodies: Vec<Body<'a>>,
}

/// A task coordinate.
#[derive(Serialize)]
struct Coordinate {
    name: &'static str,
    unit: &'static str,
    /// The unit in SI.
    si: f64,
    /// `length` or `angle`.
    quantity: &'static str,
    home: f64,
}

/// A subgroup of SE(3): where it is, metres.
#[derive(Serialize)]
struct Subspace {
    name: &'static str,
    dimension: usize,
    point: Option<[f64; 3]>,
    /// The normal of a plane, or the direction of an axis.
    direction: Option<[f64; 3]>,
}

/// A joint coordinate, or an imaginary joint.
#[derive(Serialize)]
struct Joint<'a> {
    name: &'a str,
    /// The joint that it is a coordinate of, by which bodies name it.
    joint: &'a str,
    leg: &'a str,
    kind: &'static str,
    section: Option<String>,
    unit: &'static str,
    home: f64,
    limits: Option<[f64; 2]>,
}

/// Describes the open mechanism.
pub fn describe(explorer: &Explorer) -> Reply {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let decomposition = manipulator.decomposition();
    let coordinate = |c: &TaskCoordinate| Coordinate {
        name: c.name,
        unit: units.symbol(c.quantity),
        si: units.factor(c.quantity),
        quantity: match c.quantity {
            Quantity::Length => "length",
            Quantity::Angle => "angle",
        },
        home: shown(c.home, c.quantity, units),
    };
    let format = |mode| manipulator.format_mode(mode);
    let modes = match manipulator.choices() {
        ..=MOST_CHOICES => manipulator.modes().map(format).collect(),
        _ => vec![format(manipulator.home_mode())],
    };
    Reply::new(&Description {
        name: &manipulator.mechanism().name,
        length: units.length.symbol(),
        angle: units.angle.symbol(),
        coordinates: manipulator.task_coordinates().iter().map(coordinate).collect(),
        dependent: manipulator.dependent_coordinates().iter().map(coordinate).collect(),
        home_mode: format(manipulator.home_mode()),
        modes,
        lambda: decomposition.lambda,
        mobility: decomposition.mobility,
        lower: subspace(&decomposition.lower),
        upper: subspace(&decomposition.upper),
        intersection: subspace(&decomposition.intersection),
        imaginary_joints: decomposition.imaginary_joints,
        joints: joints(explorer),
        forward: manipulator.forward_closed_form().is_ok(),
        home_warning: mobility(manipulator.mechanism()).ok().and_then(|m| m.parallel_home()),
        dimensions: dimensions(explorer.file()),
        bodies: scene::bodies(explorer),
    })
}

/// The joint coordinates, leg by leg, and then the imaginary joints: the order of the values of a pose.
fn joints(explorer: &Explorer) -> Vec<Joint<'_>> {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let mut all = Vec::new();
    for (number, leg) in manipulator.mechanism().legs.iter().enumerate() {
        for (place, joint) in leg.joints.iter().enumerate() {
            let kind = if joint.actuated { "actuated" } else { "passive" };
            for (index, c) in joint.coordinates.iter().enumerate() {
                all.push(Joint {
                    name: &c.name,
                    joint: &joint.name,
                    leg: &leg.name,
                    kind,
                    section: scene::section(explorer, number, place, index)
                        .map(|section| section.to_string()),
                    unit: units.symbol(c.quantity),
                    home: shown(c.home, c.quantity, units),
                    limits: c.limits.map(|limits| shown_range(limits, c.quantity, units)),
                });
            }
        }
    }
    let legs = &manipulator.mechanism().legs;
    all.extend(manipulator.imaginary().iter().map(|joint| Joint {
        name: &joint.name,
        joint: &joint.name,
        leg: &legs[joint.leg].name,
        kind: "imaginary",
        section: None,
        unit: units.symbol(joint.quantity),
        home: shown(joint.home, joint.quantity, units),
        limits: None,
    }));
    all
}

fn subspace(class: &SubspaceClass) -> Subspace {
    let at = |point: Point3<f64>| -> Option<[f64; 3]> { Some(point.coords.into()) };
    let along = |axis: Unit<Vector3<f64>>| -> Option<[f64; 3]> { Some(axis.into_inner().into()) };
    let (point, direction) = match *class {
        SubspaceClass::Identity | SubspaceClass::TranslationalSpace | SubspaceClass::Full => {
            (None, None)
        }
        SubspaceClass::Rotation { axis, point }
        | SubspaceClass::Helical { axis, point, .. }
        | SubspaceClass::Cylindrical { axis, point } => (at(point), along(axis)),
        SubspaceClass::Translation { axis }
        | SubspaceClass::PlanarHelical { axis, .. }
        | SubspaceClass::Schoenflies { axis } => (None, along(axis)),
        SubspaceClass::TranslationalPlane { normal } | SubspaceClass::Planar { normal } => {
            (None, along(normal))
        }
        SubspaceClass::Spherical { centre } => (at(centre), None),
    };
    Subspace { name: class.name(), dimension: class.dimension(), point, direction }
}
