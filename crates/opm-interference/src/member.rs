//! Which parts of a mechanism have shapes.
//!
//! | member | its shapes | its name |
//! |---|---|---|
//! | link | the rod between its two joints; the guides of sliders on it | `LEG/JOINT`, the joint that carries it |
//! | guide on the base | the guide of a leg's first joint | `base/JOINT` |
//! | platform | a rod from each leg's last joint to the reference point | `platform` |
//! | obstacle | its box, capsule or half-space | its own |
//!
//! A guide has a shape only if its slider has limits, from which its length follows. A rod that ends at a slider whose axis
//! it lies on is a *telescope*: it ends where the slider is, and there is no guide. Pins, collars and balls are signs for
//! joints, and the ring that a base is drawn with is a sign for the base: they have no shapes here.

use nalgebra::{Point3, Unit, Vector3};
use opm_core::mechanism::{Mechanism, Obstacle, ObstacleShape};
use opm_core::skeleton::{Body, BodyPart, Material, PartKind, SeatMotion, Skeleton, Solid};
use parry3d_f64::math::{Pose, Rot3, Vector};
use std::ops::Range;

/// Sine of the angle below which a rod lies along a slider's axis.
const ALONG: f64 = 1e-6;

/// Something that has shapes, which move as one.
#[derive(Clone, Debug)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: MemberKind,
    /// The numbers of its shapes.
    pub(crate) shapes: Range<usize>,
}

/// What a member is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemberKind {
    /// A link or the platform, with the number of its body in the [`Skeleton`].
    Body(usize),
    /// The guide, on the base, of the first joint of a leg. The number is that of the leg.
    Guide(usize),
    /// An obstacle, with its number.
    Obstacle(usize),
}

impl Member {
    /// Whether it is at rest in the base.
    pub fn is_at_rest(&self) -> bool {
        !matches!(self.kind, MemberKind::Body(_))
    }

    /// The number of its body in the [`Skeleton`]; `None` for an obstacle.
    pub fn body(&self) -> Option<usize> {
        match self.kind {
            MemberKind::Body(body) => Some(body),
            MemberKind::Guide(_) => Some(0),
            MemberKind::Obstacle(_) => None,
        }
    }
}

/// A shape, in units of the mechanism's size.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// A capsule between two points of bodies.
    Capsule { ends: [End; 2], radius: f64 },
    /// A box at rest.
    Box { pose: Pose, half: Vector },
    /// A half-space: all points whose product with the normal is at most `offset`.
    HalfSpace { normal: Vector, offset: f64 },
}

impl Shape {
    pub fn is_capsule(&self) -> bool {
        matches!(self, Self::Capsule { .. })
    }
}

/// A point that moves with a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    /// The number of the body in the skeleton.
    pub body: usize,
    /// The point in the body's frame, metres.
    pub point: Point3<f64>,
}

/// A vector in units of the mechanism's size.
pub(crate) fn scaled(vector: &Vector3<f64>, unit: f64) -> Vector {
    Vector::new(vector.x / unit, vector.y / unit, vector.z / unit)
}

fn direction(axis: &Unit<Vector3<f64>>) -> Vector {
    Vector::new(axis.x, axis.y, axis.z)
}

/// The name of the member that each part of a body is drawn for, in the order of the parts; none for signs of joints, and for
/// the ring that a base is drawn with.
pub fn names_of_parts(body: &Body) -> Vec<Option<String>> {
    // The guides of the base come in the order of the joints that they belong to.
    let sliders = body.seats.iter().filter(|seat| seat.motion == SeatMotion::Slide);
    let mut guides = sliders.map(|seat| format!("{}/{}", body.name, seat.joint));
    let name = |part: &BodyPart| match part.kind {
        PartKind::Guide { .. } if body.parent.is_none() => guides.next(),
        PartKind::Rod | PartKind::Guide { .. } => Some(body.name.clone()),
        PartKind::Joint | PartKind::Ring => None,
    };
    body.parts.iter().map(name).collect()
}

/// The members of a mechanism, and their shapes.
pub(crate) fn collect(mechanism: &Mechanism, skeleton: &Skeleton) -> (Vec<Member>, Vec<Shape>) {
    let mut all = Collected { unit: skeleton.size(), members: Vec::new(), shapes: Vec::new() };
    let bodies = skeleton.bodies();
    let platform = bodies.len() - 1;
    for number in 1..platform {
        all.link(bodies, number);
    }
    all.guides(mechanism, &bodies[0]);
    let rods = bodies[platform].parts.iter().filter(|part| part.kind == PartKind::Rod);
    all.add(bodies[platform].name.clone(), MemberKind::Body(platform), |all| {
        rods.for_each(|part| all.rod(platform, &part.solid, None));
    });
    for (number, obstacle) in mechanism.shapes.obstacles.iter().enumerate() {
        all.add(obstacle.name.clone(), MemberKind::Obstacle(number), |all| all.obstacle(obstacle));
    }
    (all.members, all.shapes)
}

struct Collected {
    unit: f64,
    members: Vec<Member>,
    shapes: Vec<Shape>,
}

impl Collected {
    fn add(&mut self, name: String, kind: MemberKind, shapes: impl FnOnce(&mut Self)) {
        let first = self.shapes.len();
        shapes(self);
        self.members.push(Member { name, kind, shapes: first..self.shapes.len() });
    }

    /// A capsule of a body, whose second end may be elsewhere.
    fn rod(&mut self, body: usize, solid: &Solid, end: Option<End>) {
        if let Solid::Cylinder { from, to, radius } = *solid {
            let ends = [End { body, point: from }, end.unwrap_or(End { body, point: to })];
            self.shapes.push(Shape::Capsule { ends, radius: radius / self.unit });
        }
    }

    fn link(&mut self, bodies: &[Body], number: usize) {
        let body = &bodies[number];
        let telescope = telescope(bodies, number);
        self.add(body.name.clone(), MemberKind::Body(number), |all| {
            for part in body.parts.iter().filter(|part| part.material != Material::Imaginary) {
                match part.kind {
                    PartKind::Rod => all.rod(number, &part.solid, telescope),
                    PartKind::Guide { limited: true } if telescope.is_none() => {
                        all.rod(number, &part.solid, None);
                    }
                    PartKind::Guide { .. } | PartKind::Joint | PartKind::Ring => {}
                }
            }
        });
    }

    /// The guides on the base, in the order of the legs whose first joint is a slider with limits.
    fn guides(&mut self, mechanism: &Mechanism, base: &Body) {
        let mut guides =
            base.parts.iter().filter(|part| matches!(part.kind, PartKind::Guide { .. }));
        for (leg, seat) in base.seats.iter().enumerate() {
            if seat.motion != SeatMotion::Slide {
                continue;
            }
            let Some(part) = guides.next() else { continue };
            if part.kind == (PartKind::Guide { limited: true }) {
                let name = format!("{}/{}", base.name, mechanism.legs[leg].joints[0].name);
                let shapes = |all: &mut Self| all.rod(0, &part.solid, None);
                self.add(name, MemberKind::Guide(leg), shapes);
            }
        }
    }

    fn obstacle(&mut self, obstacle: &Obstacle) {
        let unit = self.unit;
        self.shapes.push(match &obstacle.shape {
            ObstacleShape::Box { centre, size, edges } => {
                let rotation = ObstacleShape::rotation(*edges);
                let q = rotation.quaternion();
                let rotation = Rot3::from_xyzw(q.i, q.j, q.k, q.w);
                let pose = Pose::from_parts(scaled(&centre.coords, unit), rotation);
                Shape::Box { pose, half: scaled(size, 2.0 * unit) }
            }
            ObstacleShape::Capsule { ends, radius } => Shape::Capsule {
                ends: ends.map(|point| End { body: 0, point }),
                radius: radius / unit,
            },
            ObstacleShape::HalfSpace { point, normal } => {
                let offset = normal.dot(&point.coords) / unit;
                Shape::HalfSpace { normal: direction(normal), offset }
            }
        });
    }
}

/// Where a link's rod ends that lies along the slider at its end: at the slider, which is a point of the next body.
fn telescope(bodies: &[Body], number: usize) -> Option<End> {
    let seat = bodies[number].seats.get(1).filter(|seat| seat.motion == SeatMotion::Slide)?;
    let arm = seat.centre.coords;
    if arm.cross(&seat.axis).norm() > ALONG * arm.norm() || arm.norm() == 0.0 {
        return None;
    }
    // The next body is the other one with this joint.
    let others = bodies.iter().enumerate().skip(number + 1);
    let mut found = others.filter_map(|(body, other)| {
        let seat = other.seats.iter().find(|other| other.joint == seat.joint)?;
        Some(End { body, point: seat.centre })
    });
    found.next()
}
