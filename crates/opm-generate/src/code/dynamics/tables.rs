//! What the inverse dynamics know of a mechanism: which joints are of which leg, and the masses of its bodies.

use crate::code::geometry::{Geometry, numbers, real, vector};
use crate::code::rates::follow::numbers as listed;
use crate::code::*;
use crate::library::{Drive as OfDrive, Mass as OfMass, Screw as OfScrew, Vector};
use crate::trace::Handle;
use crate::tree::Value;
use opm_core::mechanism::joint::{Drive, JointKind};
use opm_core::nalgebra::Matrix3;
use opm_core::skeleton::{Density, Mass, Skeleton};

/// 9.81 m/s² along -z.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Lists of numbers, which the functions declare that need them.
pub struct Tables {
    /// The number of the first coordinate of each leg, and that behind the last.
    first: Vec<usize>,
    /// Of each coordinate: its column among those of its leg, and whether it turns back what the one before it turned.
    columns: Vec<usize>,
    back: Vec<bool>,
    /// Of each coordinate: 0, or its place in a ball, from 1; 0, or the number of the link behind it, from 1.
    balls: Vec<usize>,
    links: Vec<usize>,
}

impl Tables {
    pub fn of(writer: &Writer<'_>) -> Self {
        let (mut first, mut columns, mut back) = (vec![0], Vec::new(), Vec::new());
        let (mut balls, mut links, mut link) = (Vec::new(), Vec::new(), 0);
        for leg in &writer.manipulator.mechanism().legs {
            let mut column = 0;
            for (number, joint) in leg.joints.iter().enumerate() {
                let count = joint.coordinates.len();
                for place in 0..count {
                    back.push(joint.turns_back);
                    column += usize::from(!joint.turns_back);
                    columns.push(column.saturating_sub(1));
                    let ball = joint.kind == JointKind::Spherical;
                    balls.push(if ball { place + 1 } else { 0 });
                    // The last joint moves the platform.
                    let carries = place + 1 == count && number + 1 < leg.joints.len();
                    link += usize::from(carries);
                    links.push(if carries { link } else { 0 });
                }
            }
            first.push(columns.len());
        }
        Self { first, columns, back, balls, links }
    }

    pub fn legs(&self) -> usize {
        self.first.len() - 1
    }

    pub fn link_count(&self) -> usize {
        self.links.iter().copied().max().unwrap_or_default()
    }

    /// How many unknowns the legs have.
    fn counts(&self) -> Vec<usize> {
        let each = self.first.windows(2).map(|ends| &self.back[ends[0]..ends[1]]);
        each.map(|back| back.iter().filter(|&&back| !back).count()).collect()
    }

    /// The most unknowns of a leg.
    pub fn most(&self) -> usize {
        self.counts().into_iter().max().unwrap_or_default().max(1)
    }

    pub fn first(&self) -> Array<Int> {
        listed("first", &self.first)
    }

    pub fn unknowns(&self) -> Array<Int> {
        listed("unknowns", &self.counts())
    }

    /// The columns where they are not one after the other.
    pub fn columns(&self) -> Option<Array<Int>> {
        self.back.contains(&true).then(|| listed("columns", &self.columns))
    }

    /// 1, and -1 of a joint that turns back.
    pub fn senses(&self) -> Option<Array<Real>> {
        let sense = |&back: &bool| if back { -1.0 } else { 1.0 };
        let each = self.back.iter().map(sense);
        self.back.contains(&true).then(|| Array::named("senses", each))
    }

    pub fn balls(&self) -> Option<Array<Int>> {
        self.balls.iter().any(|&ball| ball > 0).then(|| listed("balls", &self.balls))
    }

    pub fn links(&self) -> Option<Array<Int>> {
        (self.link_count() > 0).then(|| listed("links", &self.links))
    }
}

/// Why there are no inverse dynamics of a mechanism.
pub fn refused(writer: &Writer<'_>) -> Result<(), GenerateError> {
    let m = writer.manipulator;
    let [actuators, freedoms] = [m.actuated().len(), m.task_coordinates().len()];
    if actuators != freedoms || freedoms == 0 {
        return Err(GenerateError::Actuators { actuators, freedoms });
    }
    for leg in &m.mechanism().legs {
        let freedoms = leg.independent_screws().len();
        if freedoms > 6 {
            return Err(GenerateError::Idle { leg: leg.name.clone(), freedoms });
        }
    }
    let joints = m.mechanism().legs.iter().flat_map(|leg| &leg.joints);
    let driven = |joint: &&opm_core::mechanism::joint::Joint| {
        let own = joint.coordinates.iter().any(|c| c.drive != Drive::default());
        joint.kind == JointKind::Spherical && own
    };
    if let Some(joint) = joints.into_iter().find(driven) {
        return Err(GenerateError::BallFriction { joint: joint.name.clone() });
    }
    Ok(())
}

impl Writer<'_> {
    /// The members of the geometry that inverse dynamics need besides.
    pub fn add_dynamics(&self, geometry: &mut Geometry) {
        let mechanism = self.manipulator.mechanism();
        let screws = mechanism.legs.iter().flat_map(opm_core::Leg::screws);
        let screw = |s: opm_core::group::screw::Screw| {
            Value::List(vec![vector(&s.angular), vector(&s.linear)])
        };
        let what = "The screws of the joint coordinates at home, about the origin of the base.";
        geometry.list(OfScrew::kind(), "screw", what, screws.map(screw).collect());
        let mut bare = mechanism.clone();
        let payload = bare.bodies.payload.take();
        let skeleton = Skeleton::new(mechanism, None);
        let masses = skeleton.masses(&bare, Density::default());
        let each = skeleton.bodies().iter().zip(masses);
        let mut masses: Vec<Value> =
            each.map(|(body, m)| mass(&m.moved(body.origin.coords))).skip(1).collect();
        let platform = masses.pop().unwrap_or_default();
        let names: Vec<String> =
            mechanism.body_names().take(masses.len()).map(crate::names::comment).collect();
        if !masses.is_empty() {
            let what = format!("The links: {}.", names.join(", "));
            geometry.list(OfMass::kind(), "link", &what, masses);
        }
        geometry.add(OfMass::kind(), "platform_mass", "The platform.", platform);
        let carried = payload.map_or(
            Mass { mass: 0.0, centre: mechanism.platform, inertia: Matrix3::zeros() },
            |load| Mass {
                mass: load.mass,
                centre: load.centre.unwrap_or(mechanism.platform),
                inertia: load.inertia,
            },
        );
        let what = "What the platform carries; it may be another one in each call.";
        geometry.add(OfMass::kind(), "payload", what, mass(&carried));
        let what = "The acceleration of what falls, base directions, m/s^2.";
        geometry.add(Vector::kind(), "gravity", what, numbers(&GRAVITY));
        let drives = self.manipulator.coordinates().iter().map(|c| numbers(&c.drive.numbers()));
        let what = "The drives and the friction of the joint coordinates.";
        geometry.list(OfDrive::kind(), "drive", what, drives.collect());
    }
}

/// A mass as a constant.
fn mass(m: &Mass) -> Value {
    let i = &m.inertia;
    let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| i[place]);
    Value::List(vec![real(m.mass), vector(&m.centre.coords), numbers(&entries)])
}
