//! Mechanisms of every pair of subspaces and of every family, redrawn at special homes.

use fastrand::Rng;
use nalgebra::{Point3, Unit, Vector3};
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{Decomposition, Freedom, search_all};
use opm_core::group::subspace::SubspaceClass;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::{Mechanism, examples, file};
use opm_tests::random::{self, PAIRS};

/// How the joints of a section stand at home.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Axes through a point are in one plane, and parallel axes too.
    Flat,
    /// All legs are alike, each displaced by the motion that the sections share, or by a rotation of the one section.
    Symmetric,
    /// The middle joint of three is on the line, or in the plane, of the others.
    Stretched,
    /// The last links point to the platform.
    Concurrent,
    /// The last joints of all legs are in one place.
    Coincident,
}

pub const SHAPES: [Shape; 5] =
    [Shape::Flat, Shape::Symmetric, Shape::Stretched, Shape::Concurrent, Shape::Coincident];

/// A mechanism of each pair and each shipped one that decomposes, with its name and decomposition.
pub fn regular(seed: u64) -> Vec<(String, Mechanism, Decomposition)> {
    let mut rng = Rng::with_seed(seed);
    let options = random::Options { limited: 0.0, balls: false };
    let mut all: Vec<_> = PAIRS
        .iter()
        .map(|pair| {
            let (mechanism, decomposition) = random::mechanism(&mut rng, *pair, options);
            (format!("{pair:?}"), mechanism, decomposition)
        })
        .collect();
    for example in examples::SPLIT {
        let mechanism = file::read(example.text).unwrap().mechanism;
        if let Ok(found) = search_all(&mechanism) {
            all.push((example.name.to_owned(), mechanism, found[0].clone()));
        }
    }
    all
}

/// The mechanism at another home.
pub fn redrawn(mechanism: &Mechanism, decomposition: &Decomposition, shape: Shape) -> Mechanism {
    let mut drawn = mechanism.clone();
    if shape == Shape::Symmetric {
        symmetric(&mut drawn, decomposition);
    }
    let centre = drawn.platform;
    for (leg, split) in drawn.legs.iter_mut().zip(&decomposition.legs) {
        for (part, class) in
            [(&split.lower, decomposition.lower), (&split.upper, decomposition.upper)]
        {
            section(&mut leg.joints, part, &class, shape, centre);
        }
    }
    actuate(&mut drawn);
    drawn.name = "home".to_owned();
    drawn
}

/// All legs with as many joints as the first become copies of it.
fn symmetric(drawn: &mut Mechanism, decomposition: &Decomposition) {
    let about = match (decomposition.intersection, decomposition.lower) {
        (SubspaceClass::Identity, SubspaceClass::Planar { normal }) => {
            SubspaceClass::Rotation { axis: normal, point: drawn.platform }
        }
        (SubspaceClass::Identity, SubspaceClass::Spherical { centre }) => {
            SubspaceClass::Rotation { axis: Vector3::z_axis(), point: centre }
        }
        (SubspaceClass::Identity, _) => return,
        (shared, _) => shared,
    };
    let step = std::f64::consts::TAU / drawn.legs.len() as f64;
    let first = drawn.legs[0].joints.clone();
    for (number, leg) in drawn.legs.iter_mut().enumerate().skip(1) {
        if leg.joints.len() != first.len() || decomposition.legs[number] != decomposition.legs[0] {
            continue;
        }
        let g = about.screws()[0].exp(number as f64 * step);
        for (joint, model) in leg.joints.iter_mut().zip(&first) {
            let mut copy = Joint::new(joint.name.clone(), model.kind, model.axis, g * model.point);
            copy.axis = Unit::new_normalize(g * model.axis.into_inner());
            if let JointKind::Universal { second } = &mut copy.kind {
                *second = Unit::new_normalize(g * second.into_inner());
            }
            *joint = copy;
        }
    }
}

/// Redraws the joints of a leg's part within its group.
fn section(
    joints: &mut [Joint],
    part: &[Freedom],
    class: &SubspaceClass,
    shape: Shape,
    platform: Point3<f64>,
) {
    let mut numbers: Vec<usize> = part.iter().map(|freedom| freedom.joint).collect();
    numbers.dedup();
    match class {
        SubspaceClass::Spherical { centre } => sphere(joints, &numbers, shape, *centre),
        SubspaceClass::Planar { normal } | SubspaceClass::Schoenflies { axis: normal } => {
            plane(joints, &numbers, shape, *normal, platform);
        }
        _ => {}
    }
}

fn sphere(joints: &mut [Joint], numbers: &[usize], shape: Shape, centre: Point3<f64>) {
    let normal = Vector3::new(0.3, -0.2, 0.93).normalize();
    let level = |axis: Vector3<f64>| Unit::try_new(axis - normal * normal.dot(&axis), 1e-3);
    let place = |joint: &mut Joint, axis: Unit<Vector3<f64>>| {
        (joint.axis, joint.point) = (axis, centre + axis.into_inner() * 0.1);
    };
    let is_revolute = |joint: &Joint| joint.kind == JointKind::Revolute;
    match (shape, numbers) {
        (Shape::Flat | Shape::Concurrent, _) => {
            for &number in numbers {
                let joint = &mut joints[number];
                if let Some(axis) = level(joint.axis.into_inner()).filter(|_| is_revolute(joint)) {
                    place(joint, axis);
                }
            }
        }
        (Shape::Stretched, [first, middle, last]) if is_revolute(&joints[*middle]) => {
            let between = joints[*first].axis.into_inner() + joints[*last].axis.into_inner() * 0.7;
            place(&mut joints[*middle], Unit::new_normalize(between));
        }
        (Shape::Coincident, [.., last]) if is_revolute(&joints[*last]) => {
            place(&mut joints[*last], Unit::new_normalize(normal));
        }
        _ => {}
    }
}

fn plane(
    joints: &mut [Joint],
    numbers: &[usize],
    shape: Shape,
    normal: Unit<Vector3<f64>>,
    platform: Point3<f64>,
) {
    let turns = |number: &&usize| joints[**number].kind == JointKind::Revolute;
    let turning: Vec<usize> = numbers.iter().filter(turns).copied().collect();
    let across = |v: Vector3<f64>| v - normal.into_inner() * normal.dot(&v);
    match (shape, &*turning) {
        (Shape::Flat, _) => {
            // All axes are in the plane of the normal and one direction.
            let side = normal.cross(&Vector3::new(0.6, 0.5, -0.3)).normalize();
            for &number in &turning {
                let off = joints[number].point - platform;
                joints[number].point -= side * side.dot(&off);
            }
        }
        (Shape::Stretched, &[first, middle, last]) => {
            let [from, to] = [first, last].map(|number| joints[number].point);
            joints[middle].point = from + (to - from) * 0.4;
        }
        (Shape::Concurrent, &[.., elbow, last]) => {
            let out = across(joints[last].point - platform);
            joints[elbow].point = joints[last].point + out * 1.4;
        }
        (Shape::Concurrent, &[last]) => {
            let out = Unit::try_new(across(joints[last].point - platform), 1e-6);
            for &number in numbers {
                if let Some(out) = out
                    && joints[number].kind == JointKind::Prismatic
                {
                    joints[number].axis = out;
                }
            }
        }
        (Shape::Coincident, &[.., last]) => joints[last].point = platform,
        _ => {}
    }
}

/// Actuates the joints of each leg from the base on, until they control the platform.
fn actuate(drawn: &mut Mechanism) {
    drawn.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(|joint| joint.actuated = false);
    let most = drawn.legs.iter().map(|leg| leg.joints.len()).max().unwrap_or(0);
    for place in 0..most {
        for leg in 0..drawn.legs.len() {
            if let Some(joint) = drawn.legs[leg].joints.get_mut(place) {
                joint.actuated = true;
            }
            if mobility(drawn).is_ok_and(|found| found.controlled == found.mobility) {
                return;
            }
        }
    }
}
