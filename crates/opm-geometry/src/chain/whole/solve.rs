//! The joints at one pose: the general case, and what is rare.

use super::element::{Element, Kind};
use super::program::{Balls, Program, Run, SIGNS};
use super::roots::{Careful, General};
use super::{CLOSURE, MOST_FREEDOMS, samples};
use crate::chain::{Branch, ReachDeficit};
use crate::numbers::{JointDisplacement, Space};
use crate::numeric::angle;
use nalgebra::{Isometry3, Matrix3, Vector3};

/// So many joints can be given.
pub(super) const MOST_GIVEN: usize = 3;
/// Room for the values of all freedoms, and of joints that are given.
pub(super) const VALUES: usize = MOST_FREEDOMS + MOST_GIVEN;

/// A leg as it is solved.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    pub elements: &'a [Element],
    pub program: &'a Program,
    pub centre: &'a Vector3<f64>,
    pub size: f64,
    /// The displacements of the joints that are given, in their order.
    pub given: &'a [f64],
}

/// The target as numbers.
#[inline(always)]
fn numbers(target: &Isometry3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
    (target.rotation.to_rotation_matrix().into_inner(), target.translation.vector)
}

/// Newton's method mends a loop that is open by no more than this: joints that two singularities meet at.
const MENDED: f64 = 1e-4;
/// It takes so many steps.
const MOST_MENDS: usize = 4;

impl Solved<'_> {
    /// What is given.
    #[inline(always)]
    fn begin(&self) -> Run<f64> {
        let mut run = Run::new();
        if !self.given.is_empty() {
            self.give(&mut run);
        }
        run
    }

    fn give(&self, run: &mut Run<f64>) {
        let given = self.elements.iter().enumerate().filter(|(_, element)| element.is_given());
        for ((joint, element), value) in given.zip(self.given) {
            run.give(joint, element.moved_by(*value));
        }
    }

    /// The joints, as [`super::WholeLeg::solve`] gives them.
    #[inline(always)]
    pub fn joints(
        &self,
        target: &Isometry3<f64>,
        branches: [Branch; SIGNS],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        let (Self { elements, program, size, .. }, g) = (*self, numbers(target));
        let signs = branches.map(Branch::sign);
        let mut roots = General::new(size);
        let mut run = self.begin();
        program.run::<f64>((elements, size), g, signs, &mut roots, &mut run);
        let open = program.open::<f64>(&run, size);
        let closed = roots.doubt() + open <= CLOSURE * CLOSURE;
        if !closed {
            return self.special(target, signs, out);
        }
        *out = run.joints;
        self.balls(&run, target, |slot, vector| {
            for i in 0..3 {
                out[slot + i] = JointDisplacement::Value(vector[i]);
            }
        });
        Ok(())
    }

    /// The rotation vectors of balls, by their first freedom. Quaternions need not be of unit length for that.
    #[inline(always)]
    fn balls(
        &self,
        run: &Run<f64>,
        target: &Isometry3<f64>,
        mut give: impl FnMut(usize, Vector3<f64>),
    ) {
        let Self { elements, program, .. } = *self;
        let (first, last) = match program.balls {
            Balls::None => return,
            Balls::One(ball) => (ball, ball),
            Balls::Two { balls: [one, two], .. } => (one, two),
        };
        // What is left of the target's rotation between the joints before the balls and those after them.
        let whole = target.rotation.quaternion();
        let mut rest = (whole.w, whole.imag());
        let inverse = |joint: usize| {
            let unit = run.moved(joint).unit;
            let forwards = unit.re >= 0.0;
            let w = if forwards { 1.0 + unit.re } else { unit.im };
            let sine = if forwards { unit.im } else { 1.0 - unit.re };
            (w, elements[joint].direction * -sine)
        };
        let turns = |joint: usize| elements[joint].turns() && elements[joint].kind != Kind::Ball;
        for joint in (0..first).filter(|&joint| turns(joint)) {
            rest = product(inverse(joint), rest);
        }
        for joint in (last + 1..elements.len()).rev().filter(|&joint| turns(joint)) {
            rest = product(rest, inverse(joint));
        }
        if let Balls::Two { centre, aim, .. } = program.balls {
            let pivot = elements[first].point;
            let at = |place| program.at::<f64>(run, place) - pivot;
            let (w, v) = shortest(&at(centre), &at(aim));
            give(elements[first].slot, vector((w, v)));
            rest = product((w, -v), rest);
            for joint in (first + 1..last).filter(|&joint| turns(joint)) {
                rest = product(inverse(joint), rest);
            }
        }
        give(elements[last].slot, vector(rest));
    }

    /// The displacements of all joints.
    fn displacements(
        &self,
        run: &Run<f64>,
        target: &Isometry3<f64>,
    ) -> (Vec<Isometry3<f64>>, Vec<f64>) {
        let mut values: Vec<f64> = run.joints.iter().map(|joint| joint.value()).collect();
        values.extend(self.given);
        self.balls(run, target, |slot, vector| {
            values[slot..slot + 3].copy_from_slice(vector.as_slice());
        });
        let of = |element: &Element| element.exp(&values[element.slot..]);
        (self.elements.iter().map(of).collect(), values)
    }

    /// Solves what the general case does not: a joint is free, two equations are one, or the target is at the end of reach or out
    /// of reach.
    #[cold]
    fn special(
        &self,
        target: &Isometry3<f64>,
        signs: [f64; SIGNS],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        let Self { elements, program, centre, size, .. } = *self;
        let mut least = ReachDeficit::length(f64::INFINITY);
        let mut picks = 0;
        loop {
            let mut roots = Careful { size, picks, picked: 0, deficit: None };
            let mut run = self.begin();
            let g = numbers(target);
            program.run::<f64>((elements, size), g, signs, &mut roots, &mut run);
            if let Some(deficit) = roots.deficit
                && picks == 0
            {
                return Err(deficit);
            }
            let (mut joints, mut values) = self.displacements(&run, target);
            let mut rest = samples::misfit(&joints, target, centre, size);
            if rest.norm() <= CLOSURE {
                *out = run.joints;
                self.write_balls(&values, out);
                return Ok(());
            }
            if rest.norm() <= MENDED {
                for _ in 0..MOST_MENDS {
                    let damping = 1e-12;
                    let (joints, values) = (&mut joints, &mut values);
                    samples::step(elements, joints, values, target, centre, size, damping);
                }
                rest = samples::misfit(&joints, target, centre, size);
                if rest.norm() <= CLOSURE {
                    let all = elements.iter().zip(&joints);
                    for (element, joint) in all.filter(|(element, _)| !element.is_given()) {
                        let value = values[element.slot];
                        out[element.slot] = match element.kind {
                            Kind::Turn => JointDisplacement::Direction(angle::unit(value)),
                            Kind::Circle(_) => {
                                let unit = angle::unit(value);
                                out[element.slot + 1] = JointDisplacement::Direction(unit.conj());
                                JointDisplacement::Direction(unit)
                            }
                            Kind::Helix(_) | Kind::Slide => JointDisplacement::Value(value),
                            Kind::Ball => {
                                let vector = joint.rotation.scaled_axis();
                                values[element.slot..element.slot + 3]
                                    .copy_from_slice(vector.as_slice());
                                JointDisplacement::Value(vector.x)
                            }
                        };
                    }
                    self.write_balls(&values, out);
                    return Ok(());
                }
            }
            let [turn, shift] = [rest.fixed_rows::<3>(0).norm(), rest.fixed_rows::<3>(3).norm()];
            let deficit = if shift >= turn {
                ReachDeficit::length(shift * size)
            } else {
                ReachDeficit::angle(turn)
            };
            if deficit.excess < least.excess {
                least = deficit;
            }
            picks += 1;
            if picks >= 1 << roots.picked.min(4) {
                return Err(least);
            }
        }
    }

    fn write_balls(&self, values: &[f64], out: &mut [JointDisplacement; MOST_FREEDOMS]) {
        for element in self.elements {
            match element.kind {
                Kind::Ball => {
                    for i in element.slot..element.slot + 3 {
                        out[i] = JointDisplacement::Value(values[i]);
                    }
                }
                Kind::Turn | Kind::Helix(_) | Kind::Slide | Kind::Circle(_) => {}
            }
        }
    }
}

/// A quaternion of any length: its real part, and the others.
type Quaternion = (f64, Vector3<f64>);

#[inline(always)]
fn product((a, u): Quaternion, (b, v): Quaternion) -> Quaternion {
    (a * b - u.inner(v), v.scaled(a).plus(b, u).plus(1.0, u.crossed(v)))
}

/// The rotation vector of a quaternion, at most π long.
#[inline(always)]
fn vector((w, v): Quaternion) -> Vector3<f64> {
    let length = v.inner(v).sqrt();
    let angle = 2.0 * angle::atan2(length, w.abs());
    let scale = angle / if length > 0.0 { length } else { 1.0 };
    v.scaled(if w < 0.0 { -scale } else { scale })
}

/// The rotation by the smallest angle that takes the direction of one vector to that of another one. Where they are opposite,
/// it is about the cross product of the first one and the base axis that it is least along.
#[inline(always)]
fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> Quaternion {
    let (lengths, along) = ((from.inner(*from) * to.inner(*to)).sqrt(), from.inner(*to));
    if along > 0.0 {
        (lengths + along, from.crossed(*to))
    } else {
        backwards(from, to, lengths - along)
    }
}

/// The same by more than a right angle: nearly opposite vectors take the digits of their cross product and of the sum of their lengths
/// and their scalar product. `apart` is the difference of these.
fn backwards(from: &Vector3<f64>, to: &Vector3<f64>, apart: f64) -> Quaternion {
    let axis = from.crossed(*to);
    // Rounding has left a part along the first vector, by which that would come to another place.
    let axis = axis - from * (from.inner(axis) / from.inner(*from));
    let square = axis.inner(axis);
    // |a × b|² = (|a| |b| − a · b) (|a| |b| + a · b)
    if square > (OPPOSITE * apart).powi(2) { (square / apart, axis) } else { opposite(from) }
}

/// Where the cross product of two vectors is smaller, over their lengths, they are opposite.
const OPPOSITE: f64 = 1e-14;

#[cold]
fn opposite(from: &Vector3<f64>) -> Quaternion {
    if from.norm() > 0.0 { (0.0, super::objects::across(from)) } else { (1.0, Vector3::zeros()) }
}

#[cfg(test)]
mod tests {
    use super::shortest;
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};

    /// A rod that is turned over comes to where it should, however near to half a turn that is.
    #[test]
    fn the_shortest_rotation_is_exact_for_nearly_opposite_vectors() {
        let from = Vector3::new(0.3, -0.2, 0.7);
        let across = from.cross(&Vector3::new(0.5, 1.0, -0.4)).normalize();
        for away in [3.0, 1.0, 1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15, 0.0] {
            for scale in [1e-3, 1.0, 50.0] {
                let to = (across * away * from.norm() - from) * scale;
                let (w, v) = shortest(&from, &to);
                let turn = UnitQuaternion::new_normalize(Quaternion::from_parts(w, v));
                let off = (turn * from.normalize() - to.normalize()).norm();
                assert!(off < 3e-14, "{away} {scale}: {off}");
            }
        }
    }
}
