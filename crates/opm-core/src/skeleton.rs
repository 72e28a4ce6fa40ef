//! The bodies of a mechanism: their shapes for drawing, and their poses as the joints move.
//!
//! A mechanism is given by its joint screws alone, so its links have no shapes. This module derives
//! shapes from the screws: a pin along the axis of a revolute joint, a rail and a slider for a
//! translation, a ball, and a rod between two successive joints of a leg. A joint is drawn at its
//! centre, a point on its axis that is fixed in both of its bodies. If the centres coincide in a
//! drawing, the mechanism is assembled.
//!
//! | body | what it is |
//! |---|---|
//! | `base` | fixed; the parent of all bodies except the imaginary joints' |
//! | `LEG/JOINT` | the link on the platform side of that joint |
//! | `platform` | the link on the platform side of every leg's last joint |
//! | `lower_platform` | the body that the imaginary joints carry, `v` in `g = v · b` |
//! | `imaginary/NAME` | the link of an imaginary joint; its parent is `lower_platform` |
//!
//! At home, every body's frame is parallel to the base's. Its origin is at the centre of the body's
//! joint on the base side; the platform's origin is its reference point.

mod centre;
mod density;
mod mass;
mod obstacle;
mod solid;

pub use density::{Density, OutOfRange};
pub use mass::Mass;
pub use solid::{BodyPart, Material, PartKind, Solid};

use crate::decomposition::{Decomposition, Freedom};
use crate::group::screw::Screw;
use crate::group::subspace::SubspaceClass;
use crate::manipulator::ImaginaryJoint;
use crate::mechanism::joint::{Joint, JointKind, ValueCountError};
use crate::mechanism::{BodyMasses, Mechanism, Shapes};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use solid::Sizes;

/// A rigid body of the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Unique name of the body and of its frame.
    pub name: String,
    /// Index of the body in whose frame this body's pose is given; `None` for the base.
    pub parent: Option<usize>,
    /// Origin of the body's frame at home, in base coordinates, metres.
    pub origin: Point3<f64>,
    /// The solids that the body consists of, in its own frame.
    pub parts: Vec<BodyPart>,
    /// The joints that connect the body to others, in its own frame; of a link, first the one on the base side.
    pub seats: Vec<Seat>,
    /// The radius of its rods, metres.
    pub radius: f64,
}

/// The part of a joint that belongs to one body: where the joint is in that body.
#[derive(Clone, Debug, PartialEq)]
pub struct Seat {
    /// The name of the joint.
    pub joint: String,
    /// The relative motion of the joint's two bodies.
    pub motion: SeatMotion,
    /// The centre of the joint in the body's frame, metres.
    pub centre: Point3<f64>,
    /// Direction of the joint's axis in the body's frame; arbitrary for a ball and a weld.
    pub axis: Unit<Vector3<f64>>,
}

/// The relative motion of the two bodies of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeatMotion {
    /// The centre is fixed in both bodies, and so is the axis (revolute).
    Turn,
    /// The centre moves along the axis, which is fixed in both bodies (prismatic, cylindrical,
    /// helical).
    Slide,
    /// The centre is fixed in both bodies (spherical, universal).
    Ball,
    /// The two bodies move as one.
    Weld,
}

impl SeatMotion {
    /// The name of the motion: `turn`, `slide`, `ball` or `weld`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::Slide => "slide",
            Self::Ball => "ball",
            Self::Weld => "weld",
        }
    }

    fn of(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => Self::Turn,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Cylindrical => {
                Self::Slide
            }
            JointKind::Universal { .. } | JointKind::Spherical => Self::Ball,
        }
    }
}

/// The configuration of a mechanism, from which the poses of its bodies follow.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'a> {
    /// The reported value of every joint coordinate, leg by leg, radians or metres.
    pub joints: &'a [f64],
    /// The reported value of every imaginary joint, radians or metres.
    pub imaginary: &'a [f64],
    /// The platform's displacement from home.
    pub platform: Isometry3<f64>,
}

/// The bodies of a mechanism, and the joints that move them.
///
/// ```
/// use opm_core::nalgebra::Isometry3;
/// use opm_core::skeleton::{Configuration, ImaginaryJoints, Skeleton};
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (decomposition, imaginary) = (manipulator.decomposition(), manipulator.imaginary());
/// let joints = ImaginaryJoints { decomposition, imaginary };
/// let skeleton = Skeleton::new(manipulator.mechanism(), Some(joints));
///
/// let solution = manipulator.solution(); // home
/// let (joints, imaginary) = (solution.joints(), solution.imaginary());
/// let platform = Isometry3::identity();
/// let mut transforms = Vec::new();
/// skeleton.place(&Configuration { joints, imaginary, platform }, &mut transforms)?;
/// assert_eq!(transforms.len(), skeleton.bodies().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Skeleton {
    bodies: Vec<Body>,
    legs: Vec<Vec<BodyJoint>>,
    platform: usize,
    imaginary: Vec<ImaginaryBody>,
    /// The number of joint coordinates of all legs.
    coordinates: usize,
    size: f64,
}

/// A joint, and the body on its platform side that it moves.
#[derive(Clone, Debug)]
struct BodyJoint {
    /// Index of the body; `None` for the platform.
    body: Option<usize>,
    /// The screw and the home value of each freedom. The three values of a ball are one rotation
    /// vector.
    freedoms: Vec<(Screw, f64)>,
    ball: Option<Point3<f64>>,
}

/// The link of an imaginary joint.
#[derive(Clone, Debug)]
struct ImaginaryBody {
    joint: ImaginaryJoint,
    screw: Screw,
    /// The number of coordinates of the leg's lower section, which are the leg's first ones.
    lower: usize,
}

/// The imaginary joints of a mechanism, and the decomposition that they belong to.
#[derive(Clone, Copy, Debug)]
pub struct ImaginaryJoints<'a> {
    /// The decomposition of the mechanism.
    pub decomposition: &'a Decomposition,
    /// The imaginary joints.
    pub imaginary: &'a [ImaginaryJoint],
}

impl Skeleton {
    /// Builds the bodies of a mechanism and, if it decomposes, of its imaginary joints.
    pub fn new(mechanism: &Mechanism, joints: Option<ImaginaryJoints<'_>>) -> Self {
        let size = centre::size(mechanism);
        Builder {
            mechanism,
            sizes: Sizes::of(size),
            size,
            centres: centre::centres(mechanism, size),
            bodies: Vec::new(),
            guides: Vec::new(),
            movers: Vec::new(),
        }
        .build(joints)
    }

    /// The bodies; the first one is the base.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The size of the mechanism, metres: its joints' points and the platform's are within this distance of each other,
    /// unless sliders travel farther.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The transform from every body's frame to the base, in the order of [`Skeleton::bodies`].
    ///
    /// # Errors
    /// The configuration does not have as many coordinates as the mechanism.
    pub fn place_in_base(
        &self,
        configuration: &Configuration<'_>,
    ) -> Result<Vec<Isometry3<f64>>, ValueCountError> {
        let mut placed = Vec::new();
        self.place(configuration, &mut placed)?;
        for (number, body) in self.bodies.iter().enumerate() {
            // A parent has a lower number than its children.
            if let Some(parent) = body.parent {
                placed[number] = placed[parent] * placed[number];
            }
        }
        Ok(placed)
    }

    /// Writes the transform from every body's frame to its parent's into `out`, in the order of
    /// [`Skeleton::bodies`]. The base's is the identity.
    ///
    /// # Errors
    /// The configuration does not have as many coordinates as the mechanism. Then `out` stays as it is.
    pub fn place(
        &self,
        configuration: &Configuration<'_>,
        out: &mut Vec<Isometry3<f64>>,
    ) -> Result<(), ValueCountError> {
        ValueCountError::check("joints", configuration.joints, self.coordinates)?;
        ValueCountError::check("imaginary joints", configuration.imaginary, self.imaginary.len())?;
        out.clear();
        out.resize(self.bodies.len(), Isometry3::identity());
        let at = |body: usize, displacement: Isometry3<f64>| {
            displacement * Translation3::from(self.bodies[body].origin.coords)
        };
        out[self.platform] = at(self.platform, configuration.platform);
        let mut first = 0;
        for (number, leg) in self.legs.iter().enumerate() {
            let mut moved = Isometry3::identity();
            let mut coordinate = 0;
            // The link of an imaginary joint moves with the last displacement of the lower section.
            let cut = self.imaginary.iter().position(|i| i.joint.leg == number);
            let mut lower = Isometry3::identity();
            for mover in leg {
                let values = &configuration.joints[first + coordinate..];
                for taken in 0..=mover.freedoms.len() {
                    if cut.is_some_and(|i| self.imaginary[i].lower == coordinate + taken) {
                        lower = moved * mover.part(values, taken);
                    }
                }
                moved *= mover.part(values, mover.freedoms.len());
                coordinate += mover.freedoms.len();
                if let Some(body) = mover.body {
                    out[body] = at(body, moved);
                }
            }
            if let Some(i) = cut {
                let ImaginaryBody { joint, screw, .. } = &self.imaginary[i];
                let tau = joint.displacement(configuration.imaginary[i]);
                let platform = self.platform + 1;
                if i == 0 {
                    out[platform] = at(platform, lower * screw.exp(-tau));
                }
                let body = platform + 1 + i;
                let origin = Translation3::from(-self.bodies[platform].origin.coords);
                out[body] = origin * at(body, screw.exp(tau));
            }
            first += coordinate;
        }
        Ok(())
    }
}

impl BodyJoint {
    /// The displacement of the joint's first `freedoms` freedoms.
    fn part(&self, values: &[f64], freedoms: usize) -> Isometry3<f64> {
        let from_home = |i: usize| values[i] - self.freedoms[i].1;
        match self.ball {
            Some(point) if freedoms == 3 => {
                let vector = Vector3::from_fn(|i, _| from_home(i));
                let rotation = UnitQuaternion::from_scaled_axis(vector);
                let p = point.coords;
                Isometry3::from_parts(Translation3::from(p - rotation * p), rotation)
            }
            Some(_) => Isometry3::identity(),
            None => (0..freedoms)
                .fold(Isometry3::identity(), |g, i| g * self.freedoms[i].0.exp(from_home(i))),
        }
    }
}

/// Builds a skeleton.
struct Builder<'a> {
    mechanism: &'a Mechanism,
    sizes: Sizes,
    size: f64,
    /// The centre of every joint, leg by leg.
    centres: Vec<Vec<Point3<f64>>>,
    bodies: Vec<Body>,
    /// The radius of the guides of every body's sliders.
    guides: Vec<f64>,
    movers: Vec<Vec<BodyJoint>>,
}

impl Builder<'_> {
    fn build(mut self, joints: Option<ImaginaryJoints<'_>>) -> Skeleton {
        let mechanism = self.mechanism;
        let radius = |name: &str| mechanism.shapes.radius_of(name);
        self.add("base".into(), None, Point3::origin(), radius(Shapes::BASE));
        for (leg, centres) in mechanism.legs.iter().zip(self.centres.clone()) {
            let (outer, links) = leg.joints.split_last().unzip();
            let mut movers = Vec::new();
            for (joint, &centre) in links.unwrap_or_default().iter().zip(&centres) {
                let name = format!("{}/{}", leg.name, joint.name);
                let body = self.add(name, Some(0), centre, radius(&joint.name));
                movers.push(BodyJoint::new(joint, Some(body)));
            }
            movers.extend(outer.map(|joint: &Joint| BodyJoint::new(joint, None)));
            self.movers.push(movers);
        }
        let of_platform = radius(BodyMasses::PLATFORM);
        let platform = self.add("platform".into(), Some(0), mechanism.platform, of_platform);
        self.draw_base();
        for leg in 0..mechanism.legs.len() {
            self.draw_leg(leg, platform);
        }
        let ball = Solid::ball(mechanism.platform, self.sizes.ball);
        self.draw(platform, ball, Material::Platform, PartKind::Joint);
        let imaginary = joints.map_or_else(Vec::new, |joints| self.imaginary(joints, platform));
        Skeleton {
            coordinates: mechanism.coordinates().count(),
            bodies: self.bodies,
            legs: self.movers,
            platform,
            imaginary,
            size: self.size,
        }
    }

    /// Adds a body, whose rods have a radius that is given, or follows from the mechanism's size.
    fn add(
        &mut self,
        name: String,
        parent: Option<usize>,
        origin: Point3<f64>,
        radius: Option<f64>,
    ) -> usize {
        let (parts, seats) = (Vec::new(), Vec::new());
        self.guides.push(radius.unwrap_or(self.sizes.guide));
        let radius = radius.unwrap_or(self.sizes.rod);
        self.bodies.push(Body { name, parent, origin, parts, seats, radius });
        self.bodies.len() - 1
    }

    /// Adds a solid, given in base coordinates at home, to a body.
    fn draw(&mut self, body: usize, solid: Solid, material: Material, kind: PartKind) {
        let body = &mut self.bodies[body];
        body.parts.push(BodyPart { solid: solid.moved(-body.origin.coords), material, kind });
    }

    /// Connects two bodies by a joint. Its centre is given in base coordinates at home.
    fn seat(&mut self, bodies: [usize; 2], seat: &Seat) {
        for body in bodies {
            let body = &mut self.bodies[body];
            let centre = seat.centre - body.origin.coords;
            body.seats.push(Seat { centre, ..seat.clone() });
        }
    }

    fn rod(&mut self, body: usize, ends: [Point3<f64>; 2], (material, kind): (Material, PartKind)) {
        if (ends[1] - ends[0]).norm() > self.sizes.touch {
            self.draw(body, Solid::rod(ends, self.bodies[body].radius), material, kind);
        }
    }

    /// Draws the base: a ring of rods from leg to leg.
    fn draw_base(&mut self) {
        let feet: Vec<_> = self.centres.iter().filter_map(|leg| leg.first().copied()).collect();
        let feet = centre::around(feet);
        let count = if feet.len() > 2 { feet.len() } else { 1 };
        for i in 0..count {
            let ends = [feet[i], feet[(i + 1) % feet.len()]];
            self.rod(0, ends, (Material::Base, PartKind::Ring));
        }
    }

    fn draw_leg(&mut self, number: usize, platform: usize) {
        let leg = &self.mechanism.legs[number];
        let centres = self.centres[number].clone();
        let outer = |i: usize| self.movers[number][i].body.unwrap_or(platform);
        let bodies: Vec<usize> =
            std::iter::once(0).chain((0..leg.joints.len()).map(outer)).collect();
        for (i, joint) in leg.joints.iter().enumerate() {
            let between = [bodies[i], bodies[i + 1]];
            let material = |body: usize| match body {
                0 => Material::Base,
                body if body == platform => Material::Platform,
                _ => Material::Link,
            };
            // What is before the joint is as thick as its body.
            let sizes = Sizes { guide: self.guides[between[0]], ..self.sizes };
            for (side, part) in sizes.joint(joint, centres[i]) {
                let driven = if joint.actuated { Material::Actuated } else { Material::Passive };
                let body = between[usize::from(side.outer)];
                let material = if side.own { driven } else { material(body) };
                self.draw(body, part, material, side.kind);
            }
            let next = centres.get(i + 1).copied().unwrap_or(self.mechanism.platform);
            self.rod(between[1], [centres[i], next], (material(between[1]), PartKind::Rod));
            let motion = SeatMotion::of(joint.kind);
            let (joint, axis) = (joint.name.clone(), joint.axis);
            self.seat(between, &Seat { joint, motion, centre: centres[i], axis });
        }
    }

    /// Draws the imaginary joints: a shaft on the platform of the lower section, and a link on it
    /// for each leg. The link rotates, or slides, by the value of the imaginary joint. `top` is the platform.
    fn imaginary(&mut self, joints: ImaginaryJoints<'_>, top: usize) -> Vec<ImaginaryBody> {
        let (axis, point) = match &joints.decomposition.intersection {
            SubspaceClass::Rotation { axis, point } => (*axis, Some(*point)),
            SubspaceClass::Translation { axis } => (*axis, None),
            _ => return Vec::new(),
        };
        let Some(first) = joints.imaginary.first() else { return Vec::new() };
        let ends: Vec<_> = joints
            .imaginary
            .iter()
            .map(|joint| self.attachment(joint, joints.decomposition, top))
            .collect();
        // The axis of a translation has no position, so the shaft runs through the first leg's
        // attachment.
        let line = point.unwrap_or(ends[0].centre);
        let along = |p: &Point3<f64>| (p - line).dot(&axis);
        let platform = self.add("lower_platform".into(), Some(0), line, None);
        let screw = match point {
            Some(point) => Screw::rotation(axis, point),
            None => Screw::translation(axis),
        };
        let step = 2.5 * self.sizes.collar;
        let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
        let mut imaginary = Vec::new();
        for (i, (joint, end)) in joints.imaginary.iter().zip(&ends).enumerate() {
            // The links are next to each other along the axis, so that all of them are visible.
            let height = along(&end.centre) + step * (i as f64 - 0.5 * (ends.len() - 1) as f64);
            reach = [reach[0].min(height), reach[1].max(height)];
            let centre = line + axis.into_inner() * height;
            let name = format!("imaginary/{}", joint.name);
            let body = self.add(name, Some(platform), centre, None);
            let (motion, hub) = match point {
                Some(_) => (SeatMotion::Turn, self.sizes.hub(centre, axis)),
                None => (SeatMotion::Slide, self.sizes.block(centre, axis)),
            };
            self.draw(body, hub, Material::Imaginary, PartKind::Joint);
            if motion == SeatMotion::Turn {
                let pin = self.sizes.pin(centre, axis);
                self.draw(platform, pin, Material::Imaginary, PartKind::Joint);
            }
            self.rod(body, [centre, end.centre], (Material::Imaginary, PartKind::Rod));
            let name = joint.name.clone();
            self.seat([platform, body], &Seat { joint: name, motion, centre, axis });
            let weld = format!("{} on {}", joint.name, self.bodies[end.body].name);
            let (motion, centre) = (SeatMotion::Weld, end.centre);
            self.seat([body, end.body], &Seat { joint: weld, motion, centre, axis });
            let lower = joints.decomposition.legs[joint.leg].lower.len();
            imaginary.push(ImaginaryBody { joint: joint.clone(), screw, lower });
        }
        let margin = if first.quantity == crate::mechanism::joint::Quantity::Angle {
            2.0 * step
        } else {
            self.sizes.travel
        };
        let shaft = [reach[0] - margin, reach[1] + margin].map(|h| line + axis.into_inner() * h);
        let shaft = Solid::rod(shaft, self.sizes.rod);
        self.draw(platform, shaft, Material::Imaginary, PartKind::Rod);
        imaginary
    }

    /// The point where a leg's imaginary joint is attached to it: the last joint of its lower
    /// section.
    fn attachment(
        &self,
        joint: &ImaginaryJoint,
        decomposition: &Decomposition,
        top: usize,
    ) -> Attachment {
        let split = &decomposition.legs[joint.leg];
        let leg = &self.mechanism.legs[joint.leg];
        let last = split.lower.last().copied().unwrap_or(Freedom { joint: 0, index: 0 });
        let whole = last.index + 1 == leg.joints[last.joint].freedoms();
        let movers = &self.movers[joint.leg];
        // A joint that is split between the sections has no link after its first freedoms. The link
        // before it holds the joint's centre as well.
        let outward = if whole { Some(last.joint) } else { last.joint.checked_sub(1) };
        // A leg that is all in the lower section ends at the platform, `top`.
        let body = outward.map_or(0, |joint| movers[joint].body.unwrap_or(top));
        Attachment { centre: self.centres[joint.leg][last.joint], body }
    }
}

/// Where an imaginary joint is attached to its leg.
struct Attachment {
    centre: Point3<f64>,
    body: usize,
}

impl BodyJoint {
    fn new(joint: &Joint, body: Option<usize>) -> Self {
        let homes = joint.coordinates.iter().map(|c| c.home);
        Self {
            body,
            freedoms: joint.screws().into_iter().zip(homes).collect(),
            ball: (joint.kind == JointKind::Spherical).then_some(joint.point),
        }
    }
}

#[cfg(test)]
mod tests;
