//! MJCF, the model format of MuJoCo.
//!
//! The frame of every body is parallel to the base's at home, and every joint's reference value is its value at home, so
//! that a joint has the same number here as in opm. Each leg is a chain of bodies. The first one carries the platform.
//! Every other leg carries a body of its own at its end, in the platform's place, and one weld holds it there. The
//! platform's mass is shared evenly by these bodies: as long as the welds hold, they are one.
//!
//! A weld has six rows, and in an overconstrained mechanism some of them depend on others. That does no harm to MuJoCo's
//! solver, which has a soft constraint for each row.

mod geoms;
mod joints;
mod mass_unit;
mod reference;
mod servo;

pub use reference::{MjcfReference, ReferenceError};

use crate::keyframe::{Keyframes, Source};
use crate::xml::{Element, number};
use joints::{Names, joint_values, joints};
use mass_unit::MassUnit;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::Joint;
use opm_core::mechanism::leg::Leg;
use opm_core::skeleton::{Body, Density, Mass, OutOfRange, Skeleton};
use servo::{FREQUENCY, Servos};
use std::ops::Range;

/// How stiff a constraint is: the share of the force of a rigid one. MuJoCo refuses 1.
const SOLIMP: [f64; 3] = [0.9999, 0.9999, 0.001];
/// The time steps of a simulation, seconds: shorter or longer ones are no use.
const TIME_STEPS: [f64; 2] = [1e-9, 1.0];
/// The time in which a gap closes, in time steps: MuJoCo takes 2 as the least that is stable.
const SOLREF_STEPS: f64 = 2.0;
/// The acceleration of gravity, metres per second squared.
const GRAVITY: f64 = 9.81;
/// A servo may give way to the weight of what moves by this share of the mechanism's size. That of a mechanism of a few
/// millimetres would give way by more, and the mechanism would leave its assembly.
const SAG: f64 = 0.05;

/// What a model in MJCF is written with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MjcfOptions {
    density: Density,
    time_step: f64,
}

impl MjcfOptions {
    /// MuJoCo takes twice as much; the loops are held the more stiffly the less it is.
    pub const TIME_STEP: f64 = 0.001;

    /// The density of bodies, and the time step of a simulation, seconds, on which the stiffness of the constraints depends.
    ///
    /// # Errors
    /// The time step is not a number from a nanosecond to a second.
    pub fn new(density: Density, time_step: f64) -> Result<Self, OutOfRange> {
        OutOfRange::check("time_step", time_step, TIME_STEPS).map(|()| Self { density, time_step })
    }

    /// The time step of a simulation, seconds.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }
}

impl Default for MjcfOptions {
    fn default() -> Self {
        Self { density: Density::default(), time_step: Self::TIME_STEP }
    }
}

/// Writes a mechanism as a model of MuJoCo.
///
/// The joints have opm's names and values; a ball has one name and a quaternion, a helical joint a slide `NAME.slide`
/// beside its hinge. The platform is the body `platform`, and its sensors are `platform.position` and
/// `platform.orientation`. Every actuated joint coordinate has a position servo of its name.
pub fn mjcf(keyframes: &Keyframes<'_>, options: &MjcfOptions) -> String {
    let mechanism = keyframes.mechanism();
    let skeleton = Skeleton::new(mechanism, None);
    let bodies = skeleton.bodies();
    let density = options.density.of(mechanism);
    let masses = skeleton.masses(mechanism, options.density);
    let unit = MassUnit::of(bodies, &masses, skeleton.size());
    let masses: Vec<Mass> = masses.iter().map(|mass| mass.share(unit.per_kilogram())).collect();
    let density = density * unit.per_kilogram();
    let time_step = options.time_step;
    let floats = skeleton.size() < GRAVITY / (SAG * FREQUENCY * FREQUENCY);
    Model { mechanism, bodies, masses: &masses, unit, density, time_step, floats }
        .document(keyframes)
}

/// What is known while a model is written.
struct Model<'a> {
    mechanism: &'a Mechanism,
    /// The base, the links leg by leg, and the platform.
    bodies: &'a [Body],
    /// Their masses, in their frames.
    masses: &'a [Mass],
    /// The unit of these masses.
    unit: MassUnit,
    /// The density of bodies whose masses are not given, in that unit per cubic metre.
    density: f64,
    /// Seconds.
    time_step: f64,
    /// Whether weight is taken from the bodies.
    floats: bool,
}

impl Model<'_> {
    fn document(&self, keyframes: &Keyframes<'_>) -> String {
        let servos = Servos::new(self.bodies, self.masses, self.unit);
        let mut names = Names::of(self.mechanism);
        let mut base = Element::new("body").with("name", "base");
        base = base.children(geoms::shapes(&self.bodies[0]));
        let mut equality = Element::new("equality");
        let mut actuator = Element::new("actuator");
        let mut first = 1;
        for (number, leg) in self.mechanism.legs.iter().enumerate() {
            let links = leg.joints.len().saturating_sub(1);
            let chain = Chain { leg, first: number == 0, links: first..first + links };
            first += links;
            let (tree, end) = self.chain(&chain, &servos, &mut names, &mut equality);
            if let Some(tree) = tree {
                base.push(tree);
            }
            if !chain.first {
                equality.push(self.weld(leg, &end));
            }
            actuator =
                actuator.children(leg.joints.iter().flat_map(|joint| servos.actuators(joint)));
        }
        let world = Element::new("worldbody").child(base);
        self.heading()
            .child(world)
            .child(equality)
            .child(actuator)
            .child(sensors())
            .child(self.postures(keyframes))
            .document()
    }

    /// The element `mujoco` with everything that comes before the bodies.
    fn heading(&self) -> Element {
        let option = Element::new("option")
            .numbers("timestep", &[self.time_step])
            .with("integrator", "implicitfast")
            .with("solver", "Newton");
        // Bodies touch where they are joined, and their shapes are not those of a real mechanism.
        let geom = Element::new("geom")
            .with("contype", "0")
            .with("conaffinity", "0")
            .numbers("density", &[self.density]);
        // Bodies without an extent, such as a link between axes that meet.
        let compiler = Element::new("compiler")
            .with("angle", "radian")
            .with("autolimits", "true")
            .numbers("boundmass", &[1e-12])
            .numbers("boundinertia", &[1e-14]);
        let mut heading = Element::new("mujoco").with("model", &*self.mechanism.name);
        if let Some(told) = self.unit.told() {
            heading.comment(told);
        }
        if self.floats {
            heading.comment("servos of 20 Hz would give way to the weight of so small bodies: it is taken from them".to_owned());
        }
        heading
            .child(compiler)
            .child(option)
            .child(Element::new("default").child(geom))
            .child(geoms::materials())
    }

    /// The bodies of a leg as a tree, and the name of the last one.
    fn chain(
        &self,
        chain: &Chain<'_>,
        servos: &Servos,
        names: &mut Names,
        equality: &mut Element,
    ) -> (Option<Element>, String) {
        let platform = self.bodies.len() - 1;
        let mut open: Vec<Element> = Vec::new();
        let mut parent = &self.bodies[0];
        let mut name = String::new();
        for (i, joint) in chain.leg.joints.iter().enumerate() {
            let end = i + 1 == chain.leg.joints.len();
            let number = if end { platform } else { chain.links.start + i };
            let body = &self.bodies[number];
            name = if end && chain.first {
                PLATFORM.to_owned()
            } else {
                names.body(format!("{}.{}", chain.leg.name, joint.name))
            };
            let offset = body.origin - parent.origin;
            let mut element =
                Element::new("body").with("name", &*name).numbers("pos", offset.as_slice());
            for part in joints(joint, body, servos, names) {
                element.push(part.joint);
                if let Some(coupling) = part.coupling {
                    equality.push(self.stiff(coupling));
                }
            }
            if joint.turns_back && i > 0 {
                let turned = &chain.leg.joints[i - 1];
                equality.push(self.stiff(turning_back(joint, turned)));
            }
            let share = if end { 1.0 / self.mechanism.legs.len() as f64 } else { 1.0 };
            if self.floats {
                element = element.with("gravcomp", "1");
            }
            element.push(geoms::inertial(&self.masses[number].share(share)));
            // The end of another leg is the platform, drawn already.
            if !end || chain.first {
                element = element.children(geoms::shapes(body));
            }
            if end && chain.first {
                element.push(Element::new("site").with("name", SITE));
            }
            open.push(element);
            parent = body;
        }
        let tree = open.into_iter().rev().reduce(|inner, outer| outer.child(inner));
        (tree, name)
    }

    /// Holds the end of a leg at the platform.
    fn weld(&self, leg: &Leg, end: &str) -> Element {
        let weld = Element::new("weld")
            .with("name", &*leg.name)
            .with("body1", PLATFORM)
            .with("body2", end)
            .numbers("anchor", &[0.0; 3])
            .numbers("relpose", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        self.stiff(weld)
    }

    /// A constraint that is as stiff as the time step allows.
    fn stiff(&self, constraint: Element) -> Element {
        constraint
            .numbers("solref", &[SOLREF_STEPS * self.time_step, 1.0])
            .numbers("solimp", &SOLIMP)
    }

    /// The keyframes.
    fn postures(&self, keyframes: &Keyframes<'_>) -> Element {
        let mut list = Element::new("keyframe");
        let home = keyframes.home();
        list.comment(match keyframes.source() {
            Source::Modes => format!("the working modes at the home pose; {home} is home"),
            Source::Branches => format!("the branches with the input at home; {home} is home"),
            Source::HomeMode => "the home mode; there are too many to write".to_owned(),
            Source::Home => "home; there are no closed forms of other modes".to_owned(),
        });
        if !keyframes.missed().is_empty() {
            list.comment(format!("do not reach the home pose: {}", keyframes.missed().join(" ")));
        }
        for keyframe in keyframes.reached() {
            let mut name = keyframe.name.clone();
            if keyframe.loose {
                name.push_str(LOOSE);
            }
            if !keyframe.within_limits {
                name.push_str(OUT_OF_LIMITS);
            }
            let values = joint_values(self.mechanism, &keyframe.joints);
            let key = Element::new("key")
                .with("name", name)
                .numbers("qpos", &values.positions)
                .numbers("ctrl", &values.controls);
            list.push(key);
        }
        list
    }
}

/// Holds the second hinge of a parallelogram at the opposite of what the first one turns from home.
fn turning_back(joint: &Joint, turned: &Joint) -> Element {
    Element::new("joint")
        .with("joint1", &*joint.name)
        .with("joint2", &*turned.name)
        .numbers("polycoef", &[0.0, -1.0, 0.0, 0.0, 0.0])
}

/// A leg as it is written.
struct Chain<'a> {
    leg: &'a Leg,
    /// Whether it is the first leg, which carries the platform.
    first: bool,
    /// The numbers of its bodies, without the last one.
    links: Range<usize>,
}

/// The name of the platform's body.
const PLATFORM: &str = "platform";
/// The name of the site at the platform's reference point.
const SITE: &str = "platform";
/// What follows the name of a mode in which the platform is loose while the motors are held.
const LOOSE: &str = "_loose";
/// What follows the name of a mode that is past limits.
const OUT_OF_LIMITS: &str = "_out_of_limits";

fn sensors() -> Element {
    let sensor = |kind, name| {
        Element::new(kind).with("name", name).with("objtype", "site").with("objname", SITE)
    };
    Element::new("sensor")
        .child(sensor("framepos", "platform.position"))
        .child(sensor("framequat", "platform.orientation"))
}

/// A list of numbers as an attribute.
fn list(values: &[f64]) -> String {
    values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(" ")
}
