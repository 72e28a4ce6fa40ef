//! The joints at one pose: the general case, and what is rare.

use super::element::{Element, Kind, Vector};
use super::equation::{Invariant, Roots};
use super::program::{Balls, Program, Run};
use super::{CLOSURE, MOST_FREEDOMS, samples};
use crate::chain::kernel::Row;
use crate::chain::{Branch, ReachDeficit};
use crate::group::rotation_vector;
use crate::numbers::{JointDisplacement, Plane, REACH, Real};
use crate::numeric::angle;
use nalgebra::{Complex, Isometry3, Matrix3, Unit, UnitQuaternion, Vector3};

/// The roots of the general case. What is wrong with them adds to a doubt: they are valid where it is at most the square of
/// [`CLOSURE`].
pub(super) struct General<T> {
    pub doubt: T,
    pub size: f64,
}

/// What a root of a coefficient that is zero but for rounding adds to the doubt, as a multiple of it.
const FREE: f64 = CLOSURE * CLOSURE * REACH.share * REACH.share;

/// What an equation's coefficients are compared with.
fn scale<T>(of: &Invariant<T>, size: f64) -> f64 {
    match of {
        Invariant::Distance(_) => size * size,
        Invariant::Height => size,
        Invariant::Angle(_) => 1.0,
    }
}

impl<T: Real> General<T> {
    #[inline(always)]
    fn doubt(&mut self, more: T) {
        self.doubt = self.doubt + more;
    }

    /// Doubts a number that is negative.
    #[inline(always)]
    fn negative(&mut self, number: T) {
        self.doubt(number.absolute() - number);
    }

    /// A vector that is one unit long but for rounding.
    #[inline(always)]
    fn unit(&mut self, vector: T::Plane) -> T::Plane {
        let off = vector.norm_sqr() - 1.0;
        self.doubt(off.square());
        // One step of Newton's method corrects the length to less than rounding.
        vector.scaled(off * -0.5 + 1.0)
    }
}

impl<T: Real> Roots<T> for General<T> {
    #[inline(always)]
    fn twofold(&mut self, row: Row<T>, of: Invariant<T>, sign: T::Sign) -> T::Plane {
        let per = 1.0 / scale(&of, self.size);
        let row =
            Row { cosine: row.cosine * per, sine: row.sine * per, constant: row.constant * per };
        let axis = T::Plane::new(row.cosine, row.sine);
        let over = T::constant(1.0).over(axis.norm_sqr());
        let square = axis.norm_sqr() - row.constant.square();
        self.negative(square);
        self.doubt(over * FREE);
        let slope = square.root() * sign;
        (axis * T::Plane::new(row.constant, -slope)).scaled(over)
    }

    #[inline(always)]
    fn double(&mut self, row: Row<T>, of: Invariant<T>) -> T::Plane {
        let axis = T::Plane::new(row.cosine, row.sine);
        let over = T::constant(1.0).over(axis.norm_sqr());
        let scale = scale(&of, self.size);
        self.doubt(over * (FREE * scale * scale));
        self.unit(axis.scaled(row.constant * over))
    }

    #[inline(always)]
    fn pair(&mut self, [one, two]: [Row<T>; 2]) -> T::Plane {
        self.unit(one.common(&two))
    }

    #[inline(always)]
    fn turned(&mut self, vector: T::Plane, square: T, scale: f64) -> T::Plane {
        let over = T::constant(1.0).over(square);
        self.doubt(over * (FREE * scale * scale));
        self.unit(vector.scaled(over))
    }

    #[inline(always)]
    fn linear(&mut self, rate: T, constant: T) -> T {
        constant.over(rate)
    }

    #[inline(always)]
    fn quadratic(&mut self, half: T, constant: T, _: T, sign: T::Sign) -> T {
        let square = half.square() - constant;
        self.negative(square * (1.0 / (self.size * self.size)));
        square.root() * sign - half
    }
}

/// The roots of the special cases too.
struct Careful {
    size: f64,
    /// Bits of the roots to take where two equations have become one.
    picks: u32,
    /// How many such roots there were.
    picked: u32,
    deficit: Option<ReachDeficit>,
}

impl Careful {
    fn miss(&mut self, deficit: ReachDeficit) {
        self.deficit.get_or_insert(deficit);
    }

    /// The root of a row where it rises or falls; home where the angle is free.
    fn root(&mut self, row: Row<f64>, of: Invariant<f64>, sign: f64) -> Complex<f64> {
        let scale = scale(&of, self.size);
        let axis = Complex::new(row.cosine, row.sine);
        let length = axis.norm();
        let excess = row.constant.abs() - length;
        let reached = excess <= REACH.share * scale;
        if !reached {
            let deficit = match of {
                Invariant::Distance(square) => {
                    let distance = square.max(0.0).sqrt();
                    let nearest = square + 2.0 * row.constant.signum() * excess;
                    ReachDeficit::length((nearest.max(0.0).sqrt() - distance).abs())
                }
                Invariant::Height => ReachDeficit::length(excess),
                Invariant::Angle(cosine) => {
                    let level = cosine - row.constant;
                    let nearest = level + row.constant.signum() * length;
                    let angle = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
                    ReachDeficit::angle((angle(nearest) - angle(cosine)).abs())
                }
            };
            self.miss(deficit);
        }
        let fixed = length > REACH.share * scale;
        if !fixed {
            return Complex::new(1.0, 0.0);
        }
        let constant = (row.constant / length).clamp(-1.0, 1.0);
        let slope = (1.0 - constant * constant).max(0.0).sqrt() * sign;
        axis * Complex::new(constant, -slope) / length
    }

    /// A vector made one unit long; that of home where it has no length.
    fn unit(vector: Complex<f64>, shortest: f64) -> Complex<f64> {
        let length = vector.norm();
        if length > shortest { vector / length } else { Complex::new(1.0, 0.0) }
    }
}

/// Two rows whose directions enclose a smaller angle than this count as one.
const ONE_ROW: f64 = 1e-7;

impl Roots<f64> for Careful {
    fn twofold(&mut self, row: Row<f64>, of: Invariant<f64>, sign: f64) -> Complex<f64> {
        self.root(row, of, sign)
    }

    fn double(&mut self, row: Row<f64>, of: Invariant<f64>) -> Complex<f64> {
        let shortest = REACH.share * scale(&of, self.size);
        let axis = Complex::new(row.cosine, row.sine);
        Self::unit(axis * row.constant.signum(), shortest)
    }

    fn pair(&mut self, rows: [Row<f64>; 2]) -> Complex<f64> {
        let lengths = rows.map(|row| row.cosine.hypot(row.sine));
        let [one, two] = rows;
        let sine = (one.cosine * two.sine - one.sine * two.cosine) / (lengths[0] * lengths[1]);
        if sine.abs() > ONE_ROW {
            return Self::unit(one.common(&two), 0.0);
        }
        let sign = if self.picks & (1 << self.picked) == 0 { 1.0 } else { -1.0 };
        self.picked += 1;
        let row = if lengths[0] >= lengths[1] { one } else { two };
        let axis = Complex::new(row.cosine, row.sine);
        let length = axis.norm();
        let fixed = length > REACH.share * REACH.share;
        if !fixed {
            return Complex::new(1.0, 0.0);
        }
        let constant = (row.constant / length).clamp(-1.0, 1.0);
        let slope = (1.0 - constant * constant).max(0.0).sqrt() * sign;
        axis * Complex::new(constant, -slope) / length
    }

    fn turned(&mut self, vector: Complex<f64>, square: f64, scale: f64) -> Complex<f64> {
        let shortest = REACH.share * scale;
        if square > shortest * shortest {
            Self::unit(vector / square, 0.0)
        } else {
            Complex::new(1.0, 0.0)
        }
    }

    fn linear(&mut self, rate: f64, constant: f64) -> f64 {
        if rate.abs() > REACH.share { constant / rate } else { 0.0 }
    }

    fn quadratic(&mut self, half: f64, constant: f64, square: f64, sign: f64) -> f64 {
        let under = half * half - constant;
        let real = under >= 0.0;
        if !real {
            let excess = (square - under).max(0.0).sqrt() - square.max(0.0).sqrt();
            let reached = excess <= REACH.share * self.size;
            if !reached {
                self.miss(ReachDeficit::length(excess));
            }
        }
        under.max(0.0).sqrt() * sign - half
    }
}

/// A leg as it is solved.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    pub elements: &'a [Element],
    pub program: &'a Program,
    pub centre: &'a Vector3<f64>,
    pub size: f64,
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
    /// The joints, as [`super::WholeLeg::solve`] gives them.
    #[inline(always)]
    pub fn joints(
        &self,
        target: &Isometry3<f64>,
        branches: [Branch; 2],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        let (Self { elements, program, size, .. }, g) = (*self, numbers(target));
        let signs = branches.map(Branch::sign);
        let mut roots = General { doubt: 0.0, size };
        let mut run = Run::new();
        program.run::<f64>((elements, size), g, signs, &mut roots, &mut run);
        let open = program.open::<f64>(&run, size);
        let closed = roots.doubt + open <= CLOSURE * CLOSURE;
        if !closed {
            return self.special(target, signs, out);
        }
        *out = run.joints;
        self.balls(&run, |slot, rotation| {
            let vector = rotation_vector(rotation);
            for i in 0..3 {
                out[slot + i] = JointDisplacement::Value(vector[i]);
            }
        });
        Ok(())
    }

    /// Reads the rotations of balls off, by their first freedom.
    #[inline(always)]
    fn balls(&self, run: &Run<f64>, mut give: impl FnMut(usize, &Matrix3<f64>)) {
        let Self { elements, program, .. } = *self;
        let at = |place| program.at::<f64>(run, place);
        match &program.balls {
            Balls::None => {}
            &Balls::One { ball, columns } => {
                let [x, y] = columns.map(at);
                give(elements[ball].slot, &Matrix3::from_columns(&[x, y, x.cross(&y)]));
            }
            Balls::Two { balls: [one, two], columns, centre, aim, between } => {
                let pivot = elements[*one].point;
                let swing = shortest(&(at(*centre) - pivot), &(at(*aim) - pivot));
                give(elements[*one].slot, &swing);
                let [x, y] = columns.map(|place| {
                    let inside = swing.tr_mul(&at(place));
                    between.iter().fold(inside, |v, &joint| {
                        elements[joint].carry::<f64>(run.moved(joint), true, Vector::Direction, v)
                    })
                });
                give(elements[*two].slot, &Matrix3::from_columns(&[x, y, x.cross(&y)]));
            }
        }
    }

    /// The displacements of all joints.
    fn displacements(&self, run: &Run<f64>) -> (Vec<Isometry3<f64>>, Vec<f64>) {
        let mut values: Vec<f64> = run.joints.iter().map(|joint| joint.value()).collect();
        self.balls(run, |slot, rotation| {
            let vector = rotation_vector(rotation);
            values[slot..slot + 3].copy_from_slice(vector.as_slice());
        });
        let of = |element: &Element| element.exp(&values[element.slot..]);
        (self.elements.iter().map(of).collect(), values)
    }

    /// Poses at which a joint is free, at which equations have become one, on the rim of reach, and out of it.
    #[cold]
    fn special(
        &self,
        target: &Isometry3<f64>,
        signs: [f64; 2],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        let Self { elements, program, centre, size } = *self;
        let mut least = ReachDeficit::length(f64::INFINITY);
        let mut picks = 0;
        loop {
            let mut roots = Careful { size, picks, picked: 0, deficit: None };
            let mut run = Run::new();
            let g = numbers(target);
            program.run::<f64>((elements, size), g, signs, &mut roots, &mut run);
            if let Some(deficit) = roots.deficit
                && picks == 0
            {
                return Err(deficit);
            }
            let (mut joints, mut values) = self.displacements(&run);
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
                    for (element, joint) in elements.iter().zip(&joints) {
                        let value = values[element.slot];
                        out[element.slot] = match element.kind {
                            Kind::Turn => JointDisplacement::Direction(angle::unit(value)),
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
                Kind::Turn | Kind::Helix(_) | Kind::Slide => {}
            }
        }
    }
}

/// The rotation by the smallest angle that takes the direction of one vector to that of another one. Where they are opposite,
/// it is about the cross product of the first one and the base axis that it is least along.
fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> Matrix3<f64> {
    let normal = from.cross(to);
    let lengths = (from.norm_squared() * to.norm_squared()).sqrt();
    let cosine = from.dot(to);
    if lengths + cosine <= 1e-12 * lengths {
        let axis = Unit::new_normalize(super::objects::across(from));
        return UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
            .to_rotation_matrix()
            .into_inner();
    }
    let apart = lengths > 0.0;
    if !apart {
        return Matrix3::identity();
    }
    let (normal, cosine) = (normal / lengths, cosine / lengths);
    Matrix3::identity() * cosine
        + normal.cross_matrix()
        + normal * normal.transpose() / (1.0 + cosine)
}
