//! URDF, the format of ROS for trees of links, and the closures of the loops beside it.
//!
//! URDF has no loops. Each leg is a chain of links from `base` to a link in the platform's place: `platform` in the first
//! leg, `LEG.platform` in every other one, with a share of the platform's mass. The closures say that these links are one.
//!
//! A link's frame stands on the axis of the joint that carries it and is parallel to the base's at home. URDF has no
//! reference values: a joint is at zero where its two frames coincide. So each joint's frame is turned or moved back by the
//! value at home, and a joint has the same number here as in opm.

mod closures;
mod joints;
mod shapes;

use crate::color::{MATERIALS, color};
use crate::names::unique;
use crate::xml::Element;
use nalgebra::{Point3, Vector3};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::leg::Leg;
use opm_core::skeleton::{Body, Density, Mass, Skeleton};
use std::collections::BTreeSet;
use std::ops::Range;

/// A mechanism as a tree of links, and what closes its loops.
#[derive(Clone, Debug, PartialEq)]
pub struct Urdf {
    /// The tree: the text of a file in XML.
    pub tree: String,
    /// The closures of its loops: the text of a file in YAML.
    pub closures: String,
}

/// Writes a mechanism as URDF, and the closures of its loops as YAML.
///
/// The joints have opm's names and values, but a ball is three revolute joints `NAME.1`, `NAME.2` and `NAME.3`: rotations
/// about x, then y, then z, each of which carries the next. A helical joint has a slide `NAME.slide` that follows it
/// (`mimic`). The platform is the link `platform`, at its reference point.
///
/// ```
/// use opm_core::skeleton::Density;
/// use opm_export::urdf;
///
/// let manipulator = opm_core::Manipulator::example("planar-3rrr")?;
/// let model = urdf(manipulator.mechanism(), Density::default());
/// assert!(model.tree.contains("<robot name=\"planar-3rrr\">"));
/// let closures = model.closures.lines().find(|line| line.starts_with("closed_loop: "));
/// assert_eq!(
///     closures,
///     Some("closed_loop: [['platform', 'leg2.platform'], ['platform', 'leg3.platform']]")
/// );
/// # Ok::<(), opm_core::ReadError>(())
/// ```
pub fn urdf(mechanism: &Mechanism, density: Density) -> Urdf {
    let skeleton = Skeleton::new(mechanism, None);
    let bodies = skeleton.bodies();
    let masses = skeleton.masses(mechanism, density);
    let (links, joints, motors) = (Vec::new(), Vec::new(), Vec::new());
    let names = joints::names(mechanism);
    let mut tree = Tree { mechanism, bodies, masses: &masses, names, links, joints, motors };
    let base = tree.name("base".to_owned());
    tree.links.push(shapes::link(&base, &bodies[0], Point3::origin()));
    let mut ends = Vec::new();
    let mut first = 1;
    for (number, leg) in mechanism.legs.iter().enumerate() {
        let links = leg.joints.len().saturating_sub(1);
        let end = match number {
            0 => tree.name(PLATFORM.to_owned()),
            _ => tree.name(format!("{}.{PLATFORM}", leg.name)),
        };
        tree.chain(leg, first..first + links, &base, &end, number == 0);
        first += links;
        ends.push(end);
    }
    let mut robot = Element::new("robot").with("name", &*mechanism.name);
    for material in MATERIALS {
        let rgba = Element::new("color").numbers("rgba", &color(material));
        robot.push(Element::new("material").with("name", material.name()).child(rgba));
    }
    let robot = robot.children(tree.links).children(tree.joints);
    Urdf { tree: robot.document(), closures: closures::closures(&ends, &tree.motors) }
}

/// The name of the platform's link.
const PLATFORM: &str = "platform";

/// The links and joints that are written so far.
struct Tree<'a> {
    mechanism: &'a Mechanism,
    /// The base, the links leg by leg, and the platform.
    bodies: &'a [Body],
    /// Their masses, in their frames.
    masses: &'a [Mass],
    /// The names that are taken. Readers look frames up by name, so that a link is not called as a joint is.
    names: BTreeSet<String>,
    links: Vec<Element>,
    joints: Vec<Element>,
    /// The names of the joints that motors drive.
    motors: Vec<String>,
}

impl Tree<'_> {
    /// A name for a link.
    fn name(&mut self, wanted: String) -> String {
        unique(&mut self.names, wanted)
    }

    /// Adds the links and joints of a leg, and its end in the platform's place.
    fn chain(&mut self, leg: &Leg, links: Range<usize>, base: &str, end: &str, first: bool) {
        let platform = self.bodies.len() - 1;
        let mut parent = base.to_owned();
        let mut origin = Point3::origin();
        for (i, joint) in leg.joints.iter().enumerate() {
            let last = i + 1 == leg.joints.len();
            let body = &self.bodies[if last { platform } else { links.start + i }];
            let seat = body.seats.iter().find(|seat| seat.joint == joint.name);
            let place = seat.map_or(joint.point, |seat| body.origin + seat.centre.coords);
            let parts =
                joints::parts(joint, i.checked_sub(1).map(|i| &leg.joints[i]), &mut self.names);
            let count = parts.len();
            for (number, part) in parts.into_iter().enumerate() {
                let inner = number + 1 < count;
                let wanted = if inner { &part.name } else { &joint.name };
                let child = self.name(format!("{}.{wanted}", leg.name));
                if joint.actuated && !part.is_led() {
                    self.motors.push(part.name.clone());
                }
                self.joints.push(part.element(&parent, &child, place - origin));
                (parent, origin) = (child, place);
                if inner || last {
                    self.links.push(Element::new("link").with("name", &*parent));
                }
            }
            if !last {
                let mass = self.masses[links.start + i];
                let link = shapes::link(&parent, body, place);
                self.links.push(link.child(shapes::inertial(&mass, body.origin - place)));
            }
        }
        let body = &self.bodies[platform];
        let mass = self.masses[platform].share(1.0 / self.mechanism.legs.len() as f64);
        let inertial = shapes::inertial(&mass, Vector3::zeros());
        // The end of another leg is the platform, drawn already.
        let link = match first {
            true => shapes::link(end, body, body.origin),
            false => Element::new("link").with("name", end),
        };
        self.links.push(link.child(inertial));
        let name = self.name(format!("{end}.fixed"));
        self.joints.push(joints::fixed(&name, &parent, end, body.origin - origin));
    }
}
