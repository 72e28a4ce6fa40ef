//! The weight of a mechanism's bodies, and what resists their acceleration, as the work that both do for virtual motions.
//!
//! A body of mass `m` and inertia `I` about its centre of mass, which moves with `ω` and is accelerated by `α` and `a`, is at rest
//! in its own frame under its weight and `-m a`, `-I α - ω × I ω` (d'Alembert). The acceleration of a leg's body follows joint by joint
//! from the base on, since each screw moves with the bodies before it: `V' = V + s q̇`, `A' = A + s q̈ + [V, s] q̇` (R. Featherstone,
//! *Rigid Body Dynamics Algorithms*, 2008, section 5.3, without the forces).
//!
//! The centre of mass of a link moves with the joints before it: by the rate of each along its screw. The rates of a
//! spherical joint are those of its rotation vector `r`; the angular velocity that belongs to them is
//! `ω = ṙ + (1 − cos θ)/θ² r × ṙ + (θ − sin θ)/θ³ r × (r × ṙ)` with `θ = |r|` (F. Bullo, R. Murray, *Proportional derivative
//! control on the Euclidean group*, European Control Conference 1995).

use crate::screws::Screws;
use crate::statics::{MOST, Statics, Velocity};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use opm_core::group::screw::Screw;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::joint::Drive;
use opm_core::skeleton::{Density, Mass, Skeleton};
use std::ops::Range;

/// How the joints of a mechanism move.
#[derive(Clone, Copy, Debug)]
pub struct JointMotion<'a> {
    /// The rate of every joint coordinate, rad/s and m/s.
    pub rates: &'a [f64],
    /// The acceleration of every joint coordinate, rad/s² and m/s².
    pub accelerations: &'a [f64],
}

/// What acts in a motion: all of it, or one part. The parts add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    All,
    Weight,
    /// What resists accelerations, of bodies and rotors.
    Inertia,
    Viscous,
    Coulomb,
}

impl Part {
    fn has(self, part: Self) -> bool {
        self == Self::All || self == part
    }

    /// The effort that a drive needs for this part.
    fn of_drive(self, drive: &Drive, rate: f64, acceleration: f64) -> f64 {
        let none = Drive::default();
        let (inertia, viscous, coulomb) =
            (self.has(Self::Inertia), self.has(Self::Viscous), self.has(Self::Coulomb));
        let part = Drive {
            rotor_inertia: if inertia { drive.rotor_inertia } else { none.rotor_inertia },
            viscous_friction: if viscous { drive.viscous_friction } else { none.viscous_friction },
            coulomb_friction: if coulomb { drive.coulomb_friction } else { none.coulomb_friction },
            ..*drive
        };
        part.effort(rate, acceleration)
    }
}

/// What makes bodies heavy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// The acceleration of a body that falls, base directions, m/s².
    pub acceleration: Vector3<f64>,
    /// The density of bodies whose masses the mechanism does not give.
    pub density: Density,
}

impl Default for Gravity {
    /// 9.81 m/s² along -z, and the density of the mechanism.
    fn default() -> Self {
        Self { acceleration: Vector3::new(0.0, 0.0, -9.81), density: Density::default() }
    }
}

/// The links and the platform of a mechanism with their masses: those that models for simulators have
/// ([`Skeleton::masses`]).
#[derive(Clone, Debug)]
pub struct Weights<'a> {
    manipulator: &'a Manipulator,
    gravity: Vector3<f64>,
    links: Vec<Link>,
    /// The platform's mass, in base coordinates at home.
    platform: Mass,
    screws: Screws,
    /// The twist and its rate of what each freedom moves, base coordinates.
    moving: Vec<[Screw; 2]>,
    /// The force and the moment on each link, about its centre of mass.
    acting: Vec<Acting>,
    /// The efforts that drives need by themselves, by the numbers of their coordinates.
    drives: Vec<(usize, f64)>,
}

/// What acts on a body: a force at its centre of mass, newtons, and a moment, newton metres.
pub(crate) type Acting = [Vector3<f64>; 2];

#[derive(Clone, Debug)]
struct Link {
    leg: usize,
    /// The coordinates of the joints that move it.
    moved_by: Range<usize>,
    /// In base coordinates at home.
    mass: Mass,
}

impl<'a> Weights<'a> {
    /// The weights of a manipulator's bodies.
    pub fn new(manipulator: &'a Manipulator, gravity: &Gravity) -> Self {
        let mechanism = manipulator.mechanism();
        let skeleton = Skeleton::new(mechanism, None);
        let masses = skeleton.masses(mechanism, gravity.density);
        let each = skeleton.bodies().iter().zip(&masses);
        let mut each = each.map(|(body, mass)| mass.moved(body.origin.coords)).skip(1);
        let (mut links, mut first) = (Vec::new(), 0);
        for (leg, own) in mechanism.legs.iter().enumerate() {
            let mut moved_by = first..first;
            for (number, joint) in own.joints.iter().enumerate() {
                moved_by.end += joint.coordinates.len();
                // The last joint moves the platform.
                if number + 1 < own.joints.len()
                    && let Some(mass) = each.next()
                {
                    links.push(Link { leg, moved_by: moved_by.clone(), mass });
                }
            }
            first = moved_by.end;
        }
        let none = Mass { mass: 0.0, centre: mechanism.platform, inertia: Matrix3::zeros() };
        let platform = each.next().unwrap_or(none);
        let (gravity, screws) = (gravity.acceleration, Screws::new(manipulator));
        let acting = vec![[Vector3::zeros(); 2]; links.len()];
        let moving = vec![[Screw::default(); 2]; screws.freedoms.len()];
        let driven = manipulator.coordinates().iter().enumerate();
        let driven = driven.filter(|(_, c)| c.drive != Drive::default());
        let drives = driven.map(|(number, _)| (number, 0.0)).collect();
        Self { manipulator, gravity, links, platform, screws, moving, acting, drives }
    }

    /// The mass of all links and of the platform, kilograms.
    pub fn mass(&self) -> f64 {
        self.links.iter().map(|link| link.mass.mass).sum::<f64>() + self.platform.mass
    }

    /// What acts on each link in a motion, or at rest: the coordinates of the joints that move it, force and moment, and the centre of
    /// mass, base coordinates. [`Weights::act_at`] finds it.
    pub(crate) fn on_links(
        &self,
    ) -> impl Iterator<Item = (Range<usize>, &Acting, Point3<f64>)> + '_ {
        self.links.iter().zip(&self.acting).map(|(link, acting)| {
            let centre = self.screws.freedoms[link.moved_by.end - 1].after * link.mass.centre;
            (link.moved_by.clone(), acting, centre)
        })
    }

    /// Finds what acts on all bodies at a pose, and what drives and bearings need; returns what acts on the platform, and its centre
    /// of mass.
    pub(crate) fn act_at(
        &mut self,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
    ) -> (Acting, Point3<f64>) {
        self.screws.update(at);
        let displacement = at.displacement(self.manipulator);
        let acting = self.act(&displacement, motion, Part::All);
        (acting, displacement * self.platform.centre)
    }

    /// The force or the moment along each freedom that rotors and friction need in the motion of [`Weights::act_at`]. The three of a ball
    /// are those about its axes, which do the work of its coordinates.
    pub(crate) fn resisting(&self) -> Vec<f64> {
        let freedoms = &self.screws.freedoms;
        let mut found = vec![0.0; freedoms.len()];
        self.drives.iter().for_each(|&(number, effort)| found[number] = effort);
        for first in (0..freedoms.len()).filter(|&k| freedoms[k].of_ball == Some(0)) {
            let vector = self.screws.rotation_vector(first);
            let each = [Vector3::x(), Vector3::y(), Vector3::z()];
            let turning = Matrix3::from_columns(&each.map(|rate| angular_velocity(&vector, &rate)));
            let own = Vector3::from_fn(|i, _| found[first + i]);
            // After a full revolution a rotation vector has no rates.
            if let Some(about) = turning.transpose().try_inverse() {
                let about = about * own;
                (0..3).for_each(|i| found[first + i] = about[i]);
            }
        }
        found
    }

    /// The mass of each link at a pose: the coordinates of the joints that move it, its mass at home, and its displacement.
    pub(crate) fn masses<'b>(
        &'b self,
        screws: &'b Screws,
    ) -> impl Iterator<Item = (Range<usize>, &'b Mass, &'b Isometry3<f64>)> {
        self.links.iter().map(|link| {
            (link.moved_by.clone(), &link.mass, &screws.freedoms[link.moved_by.end - 1].after)
        })
    }

    /// The platform's mass at home.
    pub(crate) fn platform_mass(&self) -> &Mass {
        &self.platform
    }

    /// The work of the weights for each independent velocity at a pose, of which `statics` has taken the solution, and of what
    /// resists the accelerations of a motion, if there is one. `None`
    /// where the velocity of a link is not known: behind a spherical joint after a full revolution.
    pub fn work(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
    ) -> Option<Velocity> {
        self.work_of(statics, at, motion, Part::All)
    }

    /// The work of one part of it.
    pub(crate) fn work_of(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
        part: Part,
    ) -> Option<Velocity> {
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
        let arm = displacement * self.platform.centre - reference;
        let on_platform = self.act(&displacement, motion, part);
        let mut work = [0.0; MOST];
        for (k, work) in work.iter_mut().enumerate().take(statics.free) {
            let twist = statics.twists.column(k);
            let angular = Vector3::new(twist[0], twist[1], twist[2]);
            let linear = Vector3::new(twist[3], twist[4], twist[5]) * statics.length();
            // Rotors and friction.
            for &(number, effort) in &self.drives {
                *work -= effort * statics.joint_rate(number, k);
            }
            let [force, moment] = on_platform;
            *work += (linear + angular.cross(&arm)).dot(&force) + angular.dot(&moment);
            for (link, [force, moment]) in self.links.iter().zip(&self.acting) {
                let [angular, linear] = self.velocity(link, |number| statics.joint_rate(number, k));
                *work += linear.dot(force) + angular.dot(moment);
            }
        }
        Some(work)
    }

    /// Finds what acts on all links, and returns what acts on the platform.
    fn act(
        &mut self,
        displacement: &Isometry3<f64>,
        motion: Option<JointMotion<'_>>,
        part: Part,
    ) -> Acting {
        let gravity = if part.has(Part::Weight) { self.gravity } else { Vector3::zeros() };
        let weight = |mass: &Mass| [gravity * mass.mass, Vector3::zeros()];
        for (number, effort) in &mut self.drives {
            let drive = self.manipulator.coordinates()[*number].drive;
            *effort = motion.map_or(0.0, |motion| {
                part.of_drive(&drive, motion.rates[*number], motion.accelerations[*number])
            });
        }
        let Some(motion) = motion.filter(|_| part.has(Part::Inertia)) else {
            for (acting, link) in self.acting.iter_mut().zip(&self.links) {
                *acting = weight(&link.mass);
            }
            return weight(&self.platform);
        };
        self.move_freedoms(motion);
        for (acting, link) in self.acting.iter_mut().zip(&self.links) {
            let last = link.moved_by.end - 1;
            let after = &self.screws.freedoms[last].after;
            *acting = inertial(&link.mass, after, &self.moving[last], &gravity);
        }
        // All legs end at the platform.
        let last = self.screws.legs.first().and_then(|leg| leg.clone().last());
        let moving = last.map_or([Screw::default(); 2], |last| self.moving[last]);
        inertial(&self.platform, displacement, &moving, &gravity)
    }

    /// The twist of what each freedom moves, and its rate.
    fn move_freedoms(&mut self, motion: JointMotion<'_>) {
        for leg in 0..self.screws.legs.len() {
            let leg = self.screws.legs[leg].clone();
            let [mut twist, mut rate] = [Screw::default(); 2];
            let mut number = leg.start;
            while number < leg.end {
                let freedom = &self.screws.freedoms[number];
                let count = if freedom.of_ball.is_some() { 3 } else { 1 };
                let of = |values: &[f64]| {
                    Vector3::from_fn(|i, _| if i < count { values[number + i] } else { 0.0 })
                };
                let [first, second] = [of(motion.rates), of(motion.accelerations)];
                let [first, second] = match freedom.of_ball {
                    None => [first, second],
                    Some(_) => {
                        let vector = self.screws.rotation_vector(number);
                        let turning = angular_velocity(&vector, &first);
                        [turning, angular_acceleration(&vector, &first, &second)]
                    }
                };
                // The three axes of a ball are those of the body before it.
                let before = twist;
                for i in 0..count {
                    let screw = self.screws.freedoms[number + i].screw;
                    let carried = before.bracket(&screw);
                    twist = sum(&twist, &screw, first[i]);
                    rate = sum(&sum(&rate, &screw, second[i]), &carried, first[i]);
                }
                for i in 0..count {
                    self.moving[number + i] = [twist, rate];
                }
                number += count;
            }
        }
    }

    /// The angular velocity of a link, and the velocity of its centre of mass, for rates of the joint coordinates.
    fn velocity(&self, link: &Link, rate: impl Fn(usize) -> f64) -> [Vector3<f64>; 2] {
        let freedoms = &self.screws.freedoms;
        let centre = freedoms[link.moved_by.end - 1].after * link.mass.centre;
        let mut velocity = [Vector3::zeros(); 2];
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
            velocity[0] += screw.angular * rate;
            velocity[1] += (screw.linear + screw.angular.cross(&centre.coords)) * rate;
        }
        velocity
    }
}

fn sum(to: &Screw, screw: &Screw, by: f64) -> Screw {
    Screw { angular: to.angular + screw.angular * by, linear: to.linear + screw.linear * by }
}

/// The weight of a body that is displaced from home, and what resists its acceleration.
fn inertial(
    mass: &Mass,
    displacement: &Isometry3<f64>,
    [twist, rate]: &[Screw; 2],
    gravity: &Vector3<f64>,
) -> Acting {
    let centre = (displacement * mass.centre).coords;
    let turned = displacement.rotation.to_rotation_matrix();
    let inertia = turned * mass.inertia * turned.transpose();
    let (w, velocity) = (twist.angular, twist.linear + twist.angular.cross(&centre));
    let acceleration = rate.linear + rate.angular.cross(&centre) + w.cross(&velocity);
    [(gravity - acceleration) * mass.mass, -inertia * rate.angular - w.cross(&(inertia * w))]
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

/// The rate of the angular velocity ([`angular_velocity`]) for rates and accelerations of the rotation vector.
fn angular_acceleration(
    vector: &Vector3<f64>,
    rates: &Vector3<f64>,
    accelerations: &Vector3<f64>,
) -> Vector3<f64> {
    /// Below this angle two terms of the series are exact to some 1e-12.
    const SMALL: f64 = 1e-2;
    let angle = vector.norm();
    let (square, along) = (angle * angle, vector.dot(rates));
    // Of the two coefficients: what they are, and their derivatives by the angle over the angle.
    let [[_, by_first], [second, by_second]] = match angle < SMALL {
        true => [
            [0.5 - square / 24.0, -1.0 / 12.0 + square / 180.0],
            [1.0 / 6.0 - square / 120.0, -1.0 / 60.0 + square / 1260.0],
        ],
        false => {
            let (sin, cos) = angle.sin_cos();
            let cube = square * angle;
            [
                [(1.0 - cos) / square, (angle * sin - 2.0 * (1.0 - cos)) / (square * square)],
                [
                    (angle - sin) / cube,
                    (angle * (1.0 - cos) - 3.0 * (angle - sin)) / (cube * square),
                ],
            ]
        }
    };
    let crossed = vector.cross(rates);
    angular_velocity(vector, accelerations)
        + crossed * (by_first * along)
        + vector.cross(&crossed) * (by_second * along)
        + rates.cross(&crossed) * second
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Differences of the angular velocity, also near zero and where the series ends.
    #[test]
    fn the_angular_acceleration_is_the_rate_of_the_angular_velocity() {
        let (rates, accelerations) = (Vector3::new(0.3, -0.7, 0.5), Vector3::new(-1.1, 0.2, 0.9));
        let directions = Vector3::new(0.6, 0.48, -0.64);
        for angle in [2.8, 1.1, 0.011, 0.009, 1e-4, 0.0] {
            let vector = directions * angle;
            let h = 1e-5;
            let at = |t: f64| {
                let moved = vector + rates * t + accelerations * (0.5 * t * t);
                angular_velocity(&moved, &(rates + accelerations * t))
            };
            let expected = (at(h) - at(-h)) / (2.0 * h);
            let found = angular_acceleration(&vector, &rates, &accelerations);
            assert!((found - expected).norm() < 1e-9, "{angle}: {found} {expected}");
        }
    }

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
