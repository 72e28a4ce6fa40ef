//! The bodies of the mechanism to draw, in metres, and where they are.

use crate::explorer::Explorer;
use opm_core::Section;
use opm_core::decomposition::Freedom;
use opm_core::nalgebra::{Isometry3, Point3};
use opm_core::skeleton::{Configuration, SeatMotion, Solid};
use opm_interference::member::names_of_parts;
use serde::Serialize;

/// The material of obstacles.
const OBSTACLE: &str = "obstacle";

/// A body: its solids are in its own frame.
#[derive(Serialize)]
pub struct Body<'a> {
    name: &'a str,
    /// Where its frame is at home, parallel to the base's.
    origin: [f64; 3],
    section: Option<String>,
    solids: Vec<Shape>,
    seats: Vec<Seat<'a>>,
}

/// Where a body has a joint, in the body's frame.
#[derive(Serialize)]
struct Seat<'a> {
    joint: &'a str,
    at: [f64; 3],
    /// The direction of its axis; none for a ball.
    axis: Option<[f64; 3]>,
}

/// A solid, with what decides its colour.
#[derive(Serialize)]
struct Shape {
    shape: &'static str,
    material: &'static str,
    /// What it belongs to among the bodies that may interfere; none for signs of joints, and for the ring of the base.
    member: Option<String>,
    /// The ends of the axis; both are the centre of a ball.
    from: [f64; 3],
    to: [f64; 3],
    /// Radius, or half the side of the square section of a block.
    radius: f64,
}

/// The bodies, the base first, and then the obstacles.
pub fn bodies(explorer: &Explorer) -> Vec<Body<'_>> {
    let skeleton = explorer.skeleton();
    let bodies = skeleton.bodies().iter().map(|body| {
        let parts = body.parts.iter().zip(names_of_parts(body));
        Body {
            name: &body.name,
            origin: body.origin.coords.into(),
            section: section_of_body(explorer, &body.name).map(|section| section.to_string()),
            solids: parts.map(|(part, of)| shape(&part.solid, part.material.name(), of)).collect(),
            seats: seats(body).collect(),
        }
    });
    let mechanism = explorer.manipulator().mechanism();
    let obstacles = mechanism.shapes.obstacles.iter().map(|obstacle| {
        let solids = Solid::of_obstacle(&obstacle.shape, skeleton.size(), &mechanism.platform);
        let of = || Some(obstacle.name.clone());
        Body {
            name: &obstacle.name,
            origin: [0.0; 3],
            section: None,
            solids: solids.iter().map(|solid| shape(solid, OBSTACLE, of())).collect(),
            seats: vec![],
        }
    });
    bodies.chain(obstacles).collect()
}

/// The joints that a body has a part of. Each is in two bodies: the one on the platform side comes last, with which a
/// slider's block moves.
fn seats(body: &opm_core::skeleton::Body) -> impl Iterator<Item = Seat<'_>> {
    let seats = body.seats.iter().filter(|seat| seat.motion != SeatMotion::Weld);
    seats.map(|seat| Seat {
        joint: &seat.joint,
        at: seat.centre.coords.into(),
        axis: (seat.motion != SeatMotion::Ball).then(|| seat.axis.into_inner().into()),
    })
}

/// The section that a joint's freedom belongs to.
pub fn section(explorer: &Explorer, leg: usize, joint: usize, index: usize) -> Option<Section> {
    let split = &explorer.manipulator().decomposition().legs[leg];
    let freedom = Freedom { joint, index };
    match () {
        () if split.lower.contains(&freedom) => Some(Section::Lower),
        () if split.upper.contains(&freedom) => Some(Section::Upper),
        () => None,
    }
}

/// The section of the joint that carries a link: `LEG/JOINT` is the link on that joint's platform side.
fn section_of_body(explorer: &Explorer, name: &str) -> Option<Section> {
    let legs = explorer.manipulator().mechanism().legs.iter().enumerate();
    let mut joints = legs.flat_map(|(number, leg)| {
        let joints = leg.joints.iter().enumerate();
        joints.map(move |(place, joint)| (number, leg, place, joint))
    });
    let link = joints.find(|(_, leg, _, joint)| {
        let own = name.strip_prefix(&*leg.name).and_then(|rest| rest.strip_prefix('/'));
        own == Some(&*joint.name)
    });
    let (leg, _, place, joint) = link?;
    section(explorer, leg, place, joint.coordinates.len().saturating_sub(1))
}

fn shape(solid: &Solid, material: &'static str, member: Option<String>) -> Shape {
    let at = |point: Point3<f64>| -> [f64; 3] { point.coords.into() };
    let (shape, from, to, radius) = match *solid {
        Solid::Cylinder { from, to, radius } => ("cylinder", from, to, radius),
        Solid::Ball { centre, radius } => ("ball", centre, centre, radius),
        Solid::Block { centre, axis, length, width } => {
            let half = axis.into_inner() * (0.5 * length);
            ("block", centre - half, centre + half, 0.5 * width)
        }
    };
    Shape { shape, material, member, from: at(from), to: at(to), radius }
}

/// The transforms of all bodies and obstacles to the base, in their order: 4 x 4 matrices of 32-bit numbers, column by column.
pub fn placed(
    explorer: &Explorer,
    joints: &[f64],
    imaginary: &[f64],
    platform: Isometry3<f64>,
) -> Vec<u8> {
    let configuration = Configuration { joints, imaginary, platform };
    let placed = explorer.skeleton().place_in_base(&configuration).unwrap_or_default();
    let obstacles = explorer.manipulator().mechanism().shapes.obstacles.len();
    let placed = placed.into_iter().chain(std::iter::repeat_n(Isometry3::identity(), obstacles));
    let numbers = placed.flat_map(|g| <[[f64; 4]; 4]>::from(g.to_homogeneous()));
    numbers.flatten().flat_map(|number| (number as f32).to_le_bytes()).collect()
}
