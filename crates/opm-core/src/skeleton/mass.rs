//! Masses of solids of one density, their centres and their tensors of inertia.

use super::{Body, Density, Skeleton, Solid};
use crate::mechanism::{BodyMasses, Mechanism, Payload};
use nalgebra::{Matrix3, Point3, Unit, Vector3};
use std::f64::consts::PI;

/// A rigid body's mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Kilograms.
    pub mass: f64,
    /// The centre of mass, metres.
    pub centre: Point3<f64>,
    /// The tensor of inertia about the centre of mass, kilograms times square metres.
    pub inertia: Matrix3<f64>,
}

impl Skeleton {
    /// The masses of all bodies of the mechanism that this is the skeleton of, in the order of [`Skeleton::bodies`], each in
    /// its body's frame. Those that the mechanism does not give follow from the shapes and a density.
    ///
    /// ```
    /// use opm_core::Manipulator;
    /// use opm_core::skeleton::{Density, Skeleton};
    ///
    /// let manipulator = Manipulator::example("planar-3rrr")?;
    /// let skeleton = Skeleton::new(manipulator.mechanism(), None);
    /// let masses = skeleton.masses(manipulator.mechanism(), Density::default());
    /// assert_eq!(masses.len(), skeleton.bodies().len());
    /// # Ok::<(), opm_core::ReadError>(())
    /// ```
    pub fn masses(&self, mechanism: &Mechanism, density: Density) -> Vec<Mass> {
        let density = density.of(mechanism);
        // The base, then the bodies that move in the order of their names.
        let platform = self.platform - 1;
        let names = mechanism.body_names().enumerate().map(|(number, name)| {
            // A joint may be called as the platform is.
            (name != BodyMasses::PLATFORM || number == platform).then_some(name)
        });
        let weighed = self.bodies.iter().zip([None].into_iter().chain(names));
        let weighed = weighed.map(|(body, name)| {
            let mass = Mass::of_body(body, density);
            name.map_or(mass, |name| mass.given(&mechanism.bodies, name, body.origin))
        });
        let mut weighed: Vec<Mass> = weighed.collect();
        if let (Some(payload), Some(mass)) =
            (mechanism.bodies.payload, weighed.get_mut(self.platform))
        {
            let Payload { mass: kilograms, centre, inertia } = payload;
            let centre = centre.unwrap_or(mechanism.platform);
            let origin = self.bodies[self.platform].origin;
            let carried = Mass { mass: kilograms, centre: centre - origin.coords, inertia };
            *mass = Mass::sum(&[*mass, carried]);
        }
        weighed
    }
}

impl Mass {
    /// The same with what a mechanism gives of the body with this name, whose frame is at `origin` at home.
    fn given(mut self, given: &BodyMasses, name: &str, origin: Point3<f64>) -> Self {
        if let Some(mass) = given.of(name) {
            self = self.share(mass / self.mass);
        }
        if let Some(centre) = given.centre_of(name) {
            self.centre = centre - origin.coords;
        }
        if let Some(inertia) = given.inertia_of(name) {
            self.inertia = inertia;
        }
        self
    }

    /// The mass of a body of one density, kilograms per cubic metre, in the body's frame.
    pub fn of_body(body: &Body, density: f64) -> Self {
        Self::sum(&body.parts.iter().map(|part| Self::of(&part.solid, density)).collect::<Vec<_>>())
    }

    /// The mass of a solid.
    pub fn of(solid: &Solid, density: f64) -> Self {
        let (volume, centre, axis, [along, across]) = match *solid {
            Solid::Cylinder { from, to, radius } => {
                let length = (to - from).norm();
                let axis = Unit::try_new(to - from, 0.0).unwrap_or(Vector3::z_axis());
                let round = radius * radius;
                let squares = [round / 2.0, round / 4.0 + length * length / 12.0];
                (PI * round * length, nalgebra::center(&from, &to), axis, squares)
            }
            Solid::Ball { centre, radius } => {
                let square = 0.4 * radius * radius;
                (4.0 / 3.0 * PI * radius.powi(3), centre, Vector3::z_axis(), [square; 2])
            }
            Solid::Block { centre, axis, length, width } => {
                let side = width * width;
                let squares = [side / 6.0, (side + length * length) / 12.0];
                (length * side, centre, axis, squares)
            }
        };
        let mass = density * volume;
        let projection = axis.into_inner() * axis.transpose();
        let inertia = projection * along + (Matrix3::identity() - projection) * across;
        Self { mass, centre, inertia: inertia * mass }
    }

    /// The mass of several bodies that move as one.
    pub fn sum(parts: &[Self]) -> Self {
        let mass: f64 = parts.iter().map(|part| part.mass).sum();
        let moment: Vector3<f64> = parts.iter().map(|part| part.centre.coords * part.mass).sum();
        let centre = Point3::from(moment / mass);
        let inertia = parts.iter().map(|part| part.inertia + part.offset(&centre)).sum();
        Self { mass, centre, inertia }
    }

    /// A share of the mass, with the same shape.
    #[must_use]
    pub fn share(self, of: f64) -> Self {
        Self { mass: self.mass * of, inertia: self.inertia * of, ..self }
    }

    /// The same mass in a frame that is parallel to this one, whose origin is at `-by` in it.
    #[must_use]
    pub fn moved(self, by: Vector3<f64>) -> Self {
        Self { centre: self.centre + by, ..self }
    }

    /// The moment of inertia about an axis.
    pub fn about(&self, axis: &Unit<Vector3<f64>>, point: &Point3<f64>) -> f64 {
        axis.dot(&((self.inertia + self.offset(point)) * axis.into_inner()))
    }

    /// What the tensor has more about a point than about the centre (Steiner).
    fn offset(&self, point: &Point3<f64>) -> Matrix3<f64> {
        let arm = self.centre - point;
        (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * self.mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of solids give these for a rod about its end, and for all three about their own axes.
    #[test]
    fn moments_are_those_of_tables() {
        let (z, origin) = (Vector3::z_axis(), Point3::origin());
        let square = |solid: Solid| {
            let mass = Mass::of(&solid, 2.0);
            mass.about(&z, &origin) / mass.mass
        };
        let rod = Solid::Cylinder { from: origin, to: Point3::new(3.0, 0.0, 0.0), radius: 1e-6 };
        assert!((square(rod) - 3.0).abs() < 1e-9);
        let own = Solid::Cylinder { from: origin, to: Point3::new(0.0, 0.0, 5.0), radius: 2.0 };
        assert!((square(own) - 2.0).abs() < 1e-12);
        let block = Solid::Block { centre: origin, axis: z, length: 7.0, width: 3.0 };
        assert!((square(block) - 1.5).abs() < 1e-12);
        let ball = Solid::Ball { centre: Point3::new(1.0, 0.0, 9.0), radius: 5.0 };
        assert!((square(ball) - 11.0).abs() < 1e-12);
        assert!((Mass::of(&block, 2.0).mass - 126.0).abs() < 1e-12);
    }

    /// A block cut in two halves has the mass of the whole.
    #[test]
    fn halves_add_up() {
        let at = |x, length| Solid::Block {
            centre: Point3::new(x, 0.5, 0.0),
            axis: Vector3::x_axis(),
            length,
            width: 0.3,
        };
        let halves = Mass::sum(&[Mass::of(&at(-1.0, 2.0), 5.0), Mass::of(&at(1.0, 2.0), 5.0)]);
        let whole = Mass::of(&at(0.0, 4.0), 5.0);
        assert!((halves.mass - whole.mass).abs() < 1e-12);
        assert!((halves.centre - whole.centre).norm() < 1e-12);
        assert!((halves.inertia - whole.inertia).norm() < 1e-12);
    }
}
