//! The closed form of a leg over any numbers, with roots of the caller's: for programs that write it as code.

use super::element::Kind;
use super::equation::Roots;
use super::program::{Balls, Run};
use super::{LegJoint, WholeLeg};
use crate::numbers::{Real, Space};
use nalgebra::Unit;

/// The joints of a leg that have been found, but for its spherical joints.
#[derive(Clone, Debug)]
pub struct WholeRun<'a, T: Real> {
    leg: &'a WholeLeg,
    run: Run<T>,
}

impl WholeLeg {
    /// Finds the joints with other roots than those of one pose. `signs` are those of the choices.
    pub fn run<T: Real>(
        &self,
        target: (T::Rotation, T::Space),
        [first, second]: [T::Sign; 2],
        roots: &mut impl Roots<T>,
    ) -> WholeRun<'_, T> {
        self.run_given(target, &[], [first, second, first, second], roots)
    }

    /// The same for a leg of which joints are given, with their displacements in the order of the joints; with four signs.
    pub fn run_given<T: Real>(
        &self,
        target: (T::Rotation, T::Space),
        given: &[T],
        signs: [T::Sign; 4],
        roots: &mut impl Roots<T>,
    ) -> WholeRun<'_, T> {
        let mut run = Run::new();
        let known = self.elements.iter().enumerate().filter(|(_, element)| element.is_given());
        for ((joint, element), value) in known.zip(given) {
            run.give(joint, element.moved_by(*value));
        }
        self.program.run::<T>((&self.elements, self.size), target, signs, roots, &mut run);
        WholeRun { leg: self, run }
    }

    /// A length of the leg with which others are compared, metres.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Its joints at home. The point of a slider has no meaning.
    pub fn joints(&self) -> Vec<LegJoint> {
        let joint = |element: &super::Element| {
            let (axis, point) = (Unit::new_unchecked(element.direction), element.point.into());
            match element.kind {
                Kind::Turn => LegJoint::Screw { axis, point, pitch: 0.0 },
                Kind::Helix(pitch) => LegJoint::Screw { axis, point, pitch },
                Kind::Slide => LegJoint::Slide { axis },
                Kind::Ball => LegJoint::Ball { point },
                Kind::Circle(arm) => LegJoint::Parallelogram { axis, point, arm },
            }
        };
        self.elements.iter().map(joint).collect()
    }
}

impl<T: Real> WholeRun<'_, T> {
    /// The displacement of a freedom; of no meaning for those of spherical joints.
    pub fn displacement(&self, freedom: usize) -> T::Joint {
        self.run.joints[freedom]
    }

    /// The rotation of a joint that is no ball, by its number.
    pub fn turn(&self, joint: usize) -> T::Plane {
        self.run.moved(joint).unit
    }

    /// The square of how far the loop is from closed; lengths relative to the size.
    pub fn open(&self) -> T {
        self.leg.program.open::<T>(&self.run, self.leg.size)
    }

    /// Of two spherical joints, what the first one swings towards what: the second one's centre as it is behind the first one, and
    /// as it should be before it, both from the first one's.
    pub fn swing(&self) -> Option<[T::Space; 2]> {
        let Balls::Two { balls: [first, _], centre, aim } = self.leg.program.balls else {
            return None;
        };
        let pivot = super::element::constant::<T>(&self.leg.elements[first].point);
        let from = |place| self.leg.program.at::<T>(&self.run, place);
        Some([centre, aim].map(|place| from(place).plus(T::constant(-1.0), pivot)))
    }
}
