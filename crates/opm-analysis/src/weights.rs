//! The weight of a mechanism's bodies, as the work that it does for virtual motions.
//!
//! The centre of mass of a link moves with the joints before it: by the rate of each along its screw. The rates of a
//! spherical joint are those of its rotation vector `r`; the angular velocity that belongs to them is
//! `ω = ṙ + (1 − cos θ)/θ² r × ṙ + (θ − sin θ)/θ³ r × (r × ṙ)` with `θ = |r|` (F. Bullo, R. Murray, *Proportional derivative
//! control on the Euclidean group*, European Control Conference 1995).

use crate::screws::Screws;
use crate::statics::{MOST, Statics, Velocity};
use nalgebra::{Isometry3, Point3, Vector3};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::skeleton::{Density, Skeleton};
use std::ops::Range;

/// What makes bodies heavy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// The acceleration of a body that falls, base directions, m/s².
    pub acceleration: Vector3<f64>,
    /// The density of bodies whose masses the mechanism does not give.
    pub density: Density,
}

/// The links and the platform of a mechanism with their masses: those that models for simulators have
/// ([`Skeleton::masses`]).
#[derive(Clone, Debug)]
pub struct Weights<'a> {
    manipulator: &'a Manipulator,
    gravity: Vector3<f64>,
    links: Vec<Link>,
    /// The platform's mass, kilograms, and its centre at home, base coordinates, metres.
    platform: (f64, Point3<f64>),
    screws: Screws,
}

#[derive(Clone, Debug)]
struct Link {
    leg: usize,
    /// The coordinates of the joints that move it.
    moved_by: Range<usize>,
    /// Kilograms.
    mass: f64,
    /// The centre of mass at home, base coordinates, metres.
    home: Point3<f64>,
}

impl<'a> Weights<'a> {
    /// The weights of a manipulator's bodies.
    pub fn new(manipulator: &'a Manipulator, gravity: &Gravity) -> Self {
        let mechanism = manipulator.mechanism();
        let skeleton = Skeleton::new(mechanism, None);
        let masses = skeleton.masses(mechanism, gravity.density);
        let each = skeleton.bodies().iter().zip(&masses);
        let mut each =
            each.map(|(body, mass)| (mass.mass, body.origin + mass.centre.coords)).skip(1);
        let (mut links, mut first) = (Vec::new(), 0);
        for (leg, own) in mechanism.legs.iter().enumerate() {
            let mut moved_by = first..first;
            for (number, joint) in own.joints.iter().enumerate() {
                moved_by.end += joint.coordinates.len();
                // The last joint moves the platform.
                if number + 1 < own.joints.len()
                    && let Some((mass, home)) = each.next()
                {
                    links.push(Link { leg, moved_by: moved_by.clone(), mass, home });
                }
            }
            first = moved_by.end;
        }
        let platform = each.next().unwrap_or((0.0, mechanism.platform));
        let (gravity, screws) = (gravity.acceleration, Screws::new(manipulator));
        Self { manipulator, gravity, links, platform, screws }
    }

    /// The mass of all links and of the platform, kilograms.
    pub fn mass(&self) -> f64 {
        self.links.iter().map(|link| link.mass).sum::<f64>() + self.platform.0
    }

    /// The weight of each link at a pose: the coordinates of the joints that move it, the force, newtons, and the centre of mass,
    /// base coordinates.
    pub(crate) fn links(
        &self,
        screws: &Screws,
    ) -> impl Iterator<Item = (Range<usize>, Vector3<f64>, Point3<f64>)> {
        self.links.iter().map(|link| {
            let centre = screws.freedoms[link.moved_by.end - 1].after * link.home;
            (link.moved_by.clone(), self.gravity * link.mass, centre)
        })
    }

    /// The weight of the platform, and its centre of mass, where the platform is displaced from home.
    pub(crate) fn platform(&self, displacement: &Isometry3<f64>) -> (Vector3<f64>, Point3<f64>) {
        let (mass, home) = self.platform;
        (self.gravity * mass, displacement * home)
    }

    /// The work of the weights for each independent velocity at a pose, of which `statics` has taken the solution. `None`
    /// where the velocity of a link is not known: behind a spherical joint after a full revolution.
    pub fn work(&mut self, statics: &Statics<'_>, at: &Solution) -> Option<Velocity> {
        self.screws.update(at);
        let unknown = |link: &Link| {
            let mut singular = statics.singular().iter().filter(|s| s.leg == link.leg);
            singular.any(|s| self.manipulator.rateless(s).any(|c| link.moved_by.contains(&c)))
        };
        if self.links.iter().any(unknown) {
            return None;
        }
        let displacement = at.displacement(self.manipulator);
        let reference = displacement * self.manipulator.mechanism().platform;
        let (mass, home) = self.platform;
        let arm = displacement * home - reference;
        let mut work = [0.0; MOST];
        for (k, work) in work.iter_mut().enumerate().take(statics.free) {
            let twist = statics.twists.column(k);
            let angular = Vector3::new(twist[0], twist[1], twist[2]);
            let linear = Vector3::new(twist[3], twist[4], twist[5]) * statics.length();
            let mut momentum = (linear + angular.cross(&arm)) * mass;
            for link in &self.links {
                momentum += self.velocity(link, |number| statics.joint_rate(number, k)) * link.mass;
            }
            *work = momentum.dot(&self.gravity);
        }
        Some(work)
    }

    /// The velocity of the centre of mass of a link for rates of the joint coordinates.
    fn velocity(&self, link: &Link, rate: impl Fn(usize) -> f64) -> Vector3<f64> {
        let freedoms = &self.screws.freedoms;
        let centre = freedoms[link.moved_by.end - 1].after * link.home;
        let mut velocity = Vector3::zeros();
        for number in link.moved_by.clone() {
            let freedom = &freedoms[number];
            let rate = match freedom.of_ball {
                None => rate(number),
                Some(axis) => {
                    let first = number - axis;
                    let vector = self.screws.rotation_vector(first);
                    angular_velocity(&vector, &Vector3::from_fn(|i, _| rate(first + i)))[axis]
                }
            };
            let screw = &freedom.screw;
            velocity += (screw.linear + screw.angular.cross(&centre.coords)) * rate;
        }
        velocity
    }
}

/// The angular velocity of a rotation for rates of its rotation vector, in the frame that it starts from.
fn angular_velocity(vector: &Vector3<f64>, rates: &Vector3<f64>) -> Vector3<f64> {
    /// Below this angle two terms of the series are exact to double precision.
    const SMALL: f64 = 1e-3;
    let angle = vector.norm();
    let square = angle * angle;
    let [first, second] = match angle < SMALL {
        true => [0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0],
        false => [(1.0 - angle.cos()) / square, (angle - angle.sin()) / (square * angle)],
    };
    let crossed = vector.cross(rates);
    rates + crossed * first + vector.cross(&crossed) * second
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Differences of the rotation itself.
    #[test]
    fn the_angular_velocity_is_that_of_the_rotation() {
        let rates = Vector3::new(0.3, -0.7, 0.5);
        for vector in
            [Vector3::new(1.1, 0.4, -0.6), Vector3::new(5e-4, -7e-4, 2e-4), Vector3::zeros()]
        {
            let h = 1e-6;
            let at = |t: f64| UnitQuaternion::from_scaled_axis(vector + rates * t);
            let turned = (at(h) * at(-h).inverse()).scaled_axis() / (2.0 * h);
            assert!((turned - angular_velocity(&vector, &rates)).norm() < 1e-9, "{vector}");
        }
    }
}
