//! Position servos, and the inertia of their motors.
//!
//! A servo is a spring and a damper on the joint. They are chosen for all that moves: its mass where the joint is a
//! slide, its moment of inertia about the joint where it is a hinge, as though the mechanism moved as one body. On such a
//! load a servo is critically damped. What it really moves is less, so that it follows at least as fast. A rotor that the
//! mechanism gives turns with its joint, and is part of what its servo moves.

use super::list;
use super::mass_unit::MassUnit;
use crate::xml::Element;
use nalgebra::{Unit, Vector3};
use opm_core::Quantity;
use opm_core::mechanism::joint::{Drive, Joint, JointKind};
use opm_core::skeleton::{Body, Mass};
use std::f64::consts::TAU;

/// The natural frequency of a servo on its load, radians per second: 20 Hz.
pub const FREQUENCY: f64 = 20.0 * TAU;
/// A reference that is this many seconds ahead makes up for the lag of a servo: its damping over its stiffness.
pub const LEAD: f64 = 2.0 / FREQUENCY;
/// The inertia of a motor whose rotor the mechanism does not give, as a share of its load.
const ARMATURE: f64 = 0.1;

/// The servos of a mechanism.
pub struct Servos {
    /// All that moves, as one body, in base coordinates at home.
    moving: Mass,
    /// The unit of masses.
    unit: MassUnit,
}

impl Servos {
    /// The first of the bodies is the base. The masses are in a unit, those of rotors in kilograms.
    pub fn new(bodies: &[Body], masses: &[Mass], unit: MassUnit) -> Self {
        let moving = bodies.iter().zip(masses).skip(1);
        let masses = moving.map(|(body, mass)| mass.moved(body.origin.coords));
        Self { moving: Mass::sum(&masses.collect::<Vec<_>>()), unit }
    }

    /// The load of a joint coordinate: kilograms, or kilograms times square metres.
    fn load(&self, joint: &Joint, number: usize) -> f64 {
        // A screw lifts what it turns.
        let advance = match joint.kind {
            JointKind::Helical { pitch } => pitch,
            _ => 0.0,
        };
        match joint.coordinates[number].quantity {
            Quantity::Length => self.moving.mass,
            Quantity::Angle => {
                let turned = self.moving.about(&axis(joint, number), &joint.point);
                turned + self.moving.mass * advance * advance
            }
        }
    }

    /// A joint with the inertia of its motor, if it has one, and its friction. A ball has one number for its three coordinates: it
    /// takes the mean.
    pub fn driven(&self, element: Element, joint: &Joint, number: usize) -> Element {
        let ball = joint.kind == JointKind::Spherical;
        let numbers = if ball { 0..joint.coordinates.len() } else { number..number + 1 };
        let count = numbers.len() as f64;
        let mean = |of: &dyn Fn(&Drive) -> f64| {
            let each = joint.coordinates[numbers.clone()].iter().map(|c| of(&c.drive));
            each.sum::<f64>() / count * self.unit.per_kilogram()
        };
        let rotor = mean(&Drive::inertia);
        let armature = if joint.actuated && rotor == 0.0 {
            ARMATURE * self.load(joint, number)
        } else {
            rotor
        };
        let all = [
            ("armature", armature),
            ("damping", mean(&|drive| drive.viscous_friction)),
            ("frictionloss", mean(&|drive| drive.coulomb_friction)),
        ];
        let given = all.into_iter().filter(|(_, value)| *value != 0.0);
        given.fold(element, |element, (key, value)| element.numbers(key, &[value]))
    }

    /// The servos of a joint: one for each coordinate if it is actuated.
    pub fn actuators(&self, joint: &Joint) -> Vec<Element> {
        let count = if joint.actuated { joint.coordinates.len() } else { 0 };
        (0..count).map(|number| self.actuator(joint, number)).collect()
    }

    fn actuator(&self, joint: &Joint, number: usize) -> Element {
        let coordinate = &joint.coordinates[number];
        let ball = joint.kind == JointKind::Spherical;
        let name = if ball { &joint.name } else { &coordinate.name };
        let rotor = coordinate.drive.inertia() * self.unit.per_kilogram();
        let load = self.load(joint, number) + rotor;
        let element = Element::new("position")
            .with("name", &*coordinate.name)
            .with("joint", &**name)
            .numbers("kp", &[load * FREQUENCY * FREQUENCY])
            .numbers("kv", &[2.0 * load * FREQUENCY]);
        let element = match coordinate.limits.filter(|_| !ball) {
            Some(limits) => element.with("ctrllimited", "true").with("ctrlrange", list(&limits)),
            None => element,
        };
        if ball {
            // A component of the rotation vector.
            let gear: [f64; 6] = std::array::from_fn(|i| f64::from(u8::from(i == number)));
            return element.numbers("gear", &gear);
        }
        element
    }
}

/// The axis of a joint's coordinate.
fn axis(joint: &Joint, number: usize) -> Unit<Vector3<f64>> {
    match joint.kind {
        JointKind::Universal { second } if number == 1 => second,
        JointKind::Spherical => [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][number],
        JointKind::Universal { .. }
        | JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Helical { .. }
        | JointKind::Cylindrical => joint.axis,
    }
}
