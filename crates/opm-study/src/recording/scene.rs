//! The bodies of a mechanism in the form of recordings: plain numbers, and colours.

use nalgebra::{Isometry3, Point3, Vector3};
use opm_core::manipulator::{ImaginaryJoint, Manipulator};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointCoordinate};
use opm_core::skeleton::{Body, Configuration, ImaginaryJoints, Material, Seat, Skeleton, Solid};
use opm_interference::member::{Member, MemberKind};
use opm_mcap::scene::{self, Shape};
use opm_mcap::trajectory::{Coordinate, Frame, Role};

/// The bodies, and a buffer for their poses.
pub struct Scene {
    skeleton: Skeleton,
    /// What stands around the mechanism, each at rest in the base.
    obstacles: Vec<scene::Body>,
    placed: Vec<Isometry3<f64>>,
    frames: Vec<Frame>,
}

impl Scene {
    pub fn new(mechanism: &Mechanism, cuts: Option<ImaginaryJoints<'_>>) -> Self {
        let skeleton = Skeleton::new(mechanism, cuts);
        let size = skeleton.size();
        let obstacles = mechanism.shapes.obstacles.iter().map(|obstacle| {
            let solids = Solid::of_obstacle(&obstacle.shape, size, &mechanism.platform);
            let solid = |solid| scene::Solid { shape: shape(&solid), color: OBSTACLE };
            scene::Body {
                frame: format!("obstacle/{}", obstacle.name),
                parent: Some(0),
                solids: solids.into_iter().map(solid).collect(),
                notes: Vec::new(),
            }
        });
        let obstacles = obstacles.collect();
        Self { skeleton, obstacles, placed: Vec::new(), frames: Vec::new() }
    }

    pub fn of(manipulator: &Manipulator) -> Self {
        let (decomposition, imaginary) = (manipulator.decomposition(), manipulator.imaginary());
        Self::new(manipulator.mechanism(), Some(ImaginaryJoints { decomposition, imaginary }))
    }

    /// The shapes and colours of the bodies, and then of the obstacles.
    pub fn bodies(&self) -> Vec<scene::Body> {
        let body = |body: &Body| scene::Body {
            frame: body.name.clone(),
            parent: body.parent,
            solids: body
                .parts
                .iter()
                .map(|part| scene::Solid { shape: shape(&part.solid), color: color(part.material) })
                .collect(),
            notes: body.seats.iter().map(note).collect(),
        };
        let bodies = self.skeleton.bodies().iter().map(body);
        bodies.chain(self.obstacles.iter().cloned()).collect()
    }

    /// The poses of all bodies except the base.
    pub fn frames(&mut self, posture: &Configuration<'_>) -> &[Frame] {
        let placed = self.skeleton.place(posture, &mut self.placed);
        placed.expect("the posture is of the skeleton's mechanism");
        self.frames.clear();
        self.frames.extend(self.placed.iter().skip(1).map(|g| {
            let q = g.rotation.coords;
            Frame { translation: g.translation.vector.into(), rotation: [q.x, q.y, q.z, q.w] }
        }));
        let at_rest = Frame { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };
        self.frames.extend(self.obstacles.iter().map(|_| at_rest));
        &self.frames
    }

    /// The number of the scene's body for a member of the mechanism that may interfere.
    pub fn body_of(&self, member: &Member) -> usize {
        match member.kind {
            MemberKind::Body(body) => body,
            MemberKind::Guide(_) => 0,
            MemberKind::Obstacle(number) => self.skeleton.bodies().len() + number,
        }
    }
}

/// The joint coordinates of a mechanism.
pub fn joint_coordinates(mechanism: &Mechanism) -> Vec<Coordinate> {
    let of = |joint: &Joint| {
        let role = if joint.actuated { Role::Actuated } else { Role::Passive };
        let coordinate = move |c: &JointCoordinate| Coordinate {
            name: c.name.clone(),
            unit: c.quantity.unit(),
            role,
        };
        joint.coordinates.iter().map(coordinate).collect::<Vec<_>>()
    };
    mechanism.joints().flat_map(of).collect()
}

/// The imaginary joints.
pub fn imaginary_coordinates(joints: &[ImaginaryJoint]) -> Vec<Coordinate> {
    let coordinate = |joint: &ImaginaryJoint| Coordinate {
        name: joint.name.clone(),
        unit: joint.quantity.unit(),
        role: Role::Imaginary,
    };
    joints.iter().map(coordinate).collect()
}

/// A joint: its name, its type, its centre and its axis in this body's frame, in
/// metres, with all digits.
fn note(seat: &Seat) -> (String, String) {
    let Seat { joint, motion, centre: c, axis: a } = seat;
    let value = format!("{} {} {} {} {} {} {}", motion.name(), c.x, c.y, c.z, a.x, a.y, a.z);
    (format!("joint {joint}"), value)
}

fn shape(solid: &Solid) -> Shape {
    let point = |p: Point3<f64>| -> [f64; 3] { p.coords.into() };
    match *solid {
        Solid::Cylinder { from, to, radius } => {
            Shape::Cylinder { from: point(from), to: point(to), radius }
        }
        Solid::Ball { centre, radius } => Shape::Ball { centre: point(centre), radius },
        Solid::Block { centre, axis, length, width } => {
            let axis: Vector3<f64> = axis.into_inner();
            Shape::Block { centre: point(centre), axis: axis.into(), length, width }
        }
    }
}

/// The colour of obstacles.
const OBSTACLE: [f64; 4] = [0.60, 0.48, 0.30, 1.0];

/// Colours that are distinct for people with colour blindness (by Okabe and Ito), and greys.
fn color(material: Material) -> [f64; 4] {
    match material {
        Material::Base => [0.30, 0.30, 0.33, 1.0],
        Material::Link => [0.72, 0.74, 0.77, 1.0],
        Material::Actuated => [0.84, 0.37, 0.0, 1.0],
        Material::Passive => [0.34, 0.71, 0.91, 1.0],
        Material::Platform => [0.0, 0.45, 0.70, 1.0],
        Material::Imaginary => [0.80, 0.47, 0.65, 0.45],
    }
}
