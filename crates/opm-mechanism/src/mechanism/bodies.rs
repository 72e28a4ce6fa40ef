//! What the bodies of a mechanism weigh.

use nalgebra::{Matrix3, Point3};

/// What the bodies of a mechanism weigh: `[bodies]` in a mechanism file. Models for simulators and the dynamics have these masses;
/// kinematics do not depend on them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BodyMasses {
    /// The density of all bodies whose masses are not given, kilograms per cubic metre, positive.
    pub density: Option<f64>,
    /// Masses in kilograms, positive, by the names of bodies: [`PLATFORM`](Self::PLATFORM), or the joint that carries the
    /// body.
    pub masses: Vec<(String, f64)>,
    /// Centres of mass, where they are at home, base coordinates, metres, by the names of bodies.
    pub centres: Vec<(String, Point3<f64>)>,
    /// Tensors of inertia about the centres of mass, at home, base directions, kilograms times square metres, by the names of
    /// bodies.
    pub inertias: Vec<(String, Matrix3<f64>)>,
    /// What the platform carries.
    pub payload: Option<Payload>,
}

/// A body that the platform carries, besides its own mass.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Payload {
    /// Kilograms, positive.
    pub mass: f64,
    /// The centre of mass, where it is at home, base coordinates, metres; the platform's reference point if it is not given.
    pub centre: Option<Point3<f64>>,
    /// The tensor of inertia about the centre of mass, at home, base directions, kilograms times square metres.
    pub inertia: Matrix3<f64>,
}

impl BodyMasses {
    /// The name of the platform among bodies.
    pub const PLATFORM: &'static str = "platform";

    /// The mass of the body with a name, kilograms, if it is given.
    pub fn of(&self, body: &str) -> Option<f64> {
        given(&self.masses, body)
    }

    /// The centre of mass of the body with a name, base coordinates at home, metres, if it is given.
    pub fn centre_of(&self, body: &str) -> Option<Point3<f64>> {
        given(&self.centres, body)
    }

    /// The tensor of inertia of the body with a name about its centre of mass, base directions at home, kilograms times square
    /// metres, if it is given.
    pub fn inertia_of(&self, body: &str) -> Option<Matrix3<f64>> {
        given(&self.inertias, body)
    }
}

fn given<T: Copy>(all: &[(String, T)], body: &str) -> Option<T> {
    all.iter().find(|(name, _)| name == body).map(|&(_, value)| value)
}
