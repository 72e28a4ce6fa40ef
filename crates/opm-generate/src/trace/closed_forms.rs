//! Handles as the numbers that the core's closed forms are written over: a closed form that is computed with them is traced.

use crate::library::*;
use crate::trace::{Handle, Number, Real, Truth, abs, emit, give, max, sqrt, statements, when};
use crate::tree::{Statement, visit};
use opm_core::chain::{Attempt, ClosedForm, Closes, Exception};
use opm_core::group::PlanarDisplacement;
use opm_core::numbers::{self, Over, PlaneOver, RotationOver, SpaceOver, Tolerance, Truth as _};

/// What a joint is displaced by: a direction, not normalised, or a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displaced {
    Direction(Complex),
    Value(Real),
}

/// Declares a variable with its value. Closed forms that consist of others may name two alike: then the name gets a number.
pub(super) fn declared<T: Handle>(name: &str, value: T) -> T {
    let name = crate::trace::fresh(name);
    crate::trace::named(&name, value)
}

/// A vector with a name: not every language has members of what a function gives.
fn place(vector: Complex) -> Complex {
    if vector.expr().root().is_some() { vector } else { declared("vector", vector) }
}

/// A tolerance of generated code.
fn tolerance(one: Tolerance) -> Real {
    Real::constant(one.name)
}

impl numbers::Real for Real {
    type Plane = Complex;
    type Space = Vector;
    type Rotation = Rotation;
    type Joint = Displaced;
    type Truth = Truth;
    type Sign = Self;

    fn constant(value: f64) -> Self {
        value.into()
    }

    fn known(self) -> Option<f64> {
        None
    }

    fn square(self) -> Self {
        self * self
    }

    fn over(self, by: Self) -> Self {
        self / by
    }

    fn products([a, b]: [Self; 2], [c, d]: [Self; 2]) -> Self {
        a * b + c * d
    }

    fn root(self) -> Self {
        sqrt(max(self, 0.0))
    }

    fn absolute(self) -> Self {
        abs(self)
    }

    fn larger(self, other: Self) -> Self {
        max(self, other)
    }

    fn unit(self) -> Complex {
        unit(self)
    }

    fn reduced(self) -> Self {
        near(self, 0.0)
    }

    fn side(self) -> Option<Self> {
        Some(self.lt(0.0).choose(-1.0, 1.0))
    }

    fn at_most_one(self) -> Self {
        clamp(self, -1.0, 1.0)
    }

    fn share(self, of: Tolerance, times: f64) -> Self {
        if times == 1.0 { tolerance(of) * self } else { times * tolerance(of) * self }
    }

    fn at_least(self, other: Self) -> Truth {
        self.ge(other)
    }

    fn within(self, size: f64, of: Tolerance) -> Truth {
        abs(self).le(size + tolerance(of))
    }

    fn exceeds(self, of: Tolerance) -> Truth {
        abs(self).gt(tolerance(of))
    }

    fn named(self, name: &'static str) -> Self {
        declared(name, self)
    }
}

impl numbers::Plane for Complex {
    type Real = Real;
    type Sense = Real;

    fn new(re: Real, im: Real) -> Self {
        complex_of(re, im)
    }

    fn re(self) -> Real {
        place(self).re
    }

    fn im(self) -> Real {
        place(self).im
    }

    fn conj(self) -> Self {
        conjugate(self)
    }

    fn scaled(self, by: Real) -> Self {
        self * by
    }

    fn per(self, by: Real) -> Self {
        self * (1.0 / by)
    }

    fn norm_sqr(self) -> Real {
        inner(self, self)
    }

    fn length(self) -> Real {
        sqrt(inner(self, self))
    }

    fn cross(self, other: Self) -> Real {
        across(self, other)
    }

    fn inner(self, other: Self) -> Real {
        inner(self, other)
    }

    fn normalised(self) -> Self {
        normal(self)
    }

    fn argument(self) -> Real {
        angle(self)
    }

    fn along(self, first: Self, second: Self) -> [Real; 2] {
        let n = declared("n", across(first, self) / across(first, second));
        [inner(self - second * n, first), n]
    }

    fn direction(self, size: Real) -> Self {
        direction(self, size)
    }

    fn named(self, name: &'static str) -> Self {
        declared(name, self)
    }
}

impl numbers::Space for Vector {
    type Real = Real;

    /// Constants have a name, and only one.
    fn new(x: Real, y: Real, z: Real) -> Self {
        let vector = vector_of(x, y, z);
        match [x, y, z].iter().all(|part| part.expr().is_number()) {
            true => crate::trace::once("constant", vector),
            false => vector,
        }
    }

    fn parts(self) -> [Real; 3] {
        [self.x, self.y, self.z]
    }

    fn crossed(self, other: Self) -> Self {
        cross(self, other)
    }

    fn plus(self, by: Real, other: Self) -> Self {
        add(self, by, other)
    }

    fn scaled(self, by: Real) -> Self {
        add(vector_of(0.0, 0.0, 0.0), by, self)
    }

    fn inner(self, other: Self) -> Real {
        dot(self, other)
    }

    fn named(self, name: &'static str) -> Self {
        if self.expr().root().is_some() { self } else { declared(name, self) }
    }
}

impl numbers::Rotation for Rotation {
    type Real = Real;

    fn from_rows([[a, b, c], [d, e, f], [g, h, i]]: [[Real; 3]; 3]) -> Self {
        Self::made(vector_of(a, d, g), vector_of(b, e, h), vector_of(c, f, i))
    }

    fn rows(self) -> [[Real; 3]; 3] {
        let Self { x, y, z, .. } = self;
        [[x.x, y.x, z.x], [x.y, y.y, z.y], [x.z, y.z, z.z]]
    }

    fn inverse(self) -> Self {
        transposed(self)
    }

    fn image(self, v: Vector) -> Vector {
        rotated(self, v)
    }
}

impl numbers::Joint for Displaced {
    type Real = Real;

    fn direction(vector: Complex) -> Self {
        Self::Direction(vector)
    }

    fn angle(angle: Real) -> Self {
        Self::Direction(unit(angle))
    }

    fn value(value: Real) -> Self {
        Self::Value(value)
    }

    fn inverse(self) -> Self {
        match self {
            Self::Direction(z) => Self::Direction(conjugate(z)),
            Self::Value(value) => Self::Value(-value),
        }
    }

    fn unit(self) -> Complex {
        match self {
            Self::Direction(z) => normal(z),
            Self::Value(value) => unit(value),
        }
    }

    fn number(self) -> Real {
        match self {
            Self::Direction(z) => angle(z),
            Self::Value(value) => value,
        }
    }
}

impl numbers::Truth for Truth {
    const YES: Self = Self::constant("YES");
    const NO: Self = Self::constant("NO");

    fn checked(self) -> Self {
        emit(Statement::Continue);
        self
    }
}

impl Over<Real> for Real {
    fn from_constant(constant: Self) -> Self {
        constant
    }

    fn per(self, by: Self) -> Self {
        self / by
    }

    fn in_sense(self, sense: Self) -> Self {
        self * sense
    }
}

impl PlaneOver<Complex> for Complex {
    fn from_constant(constant: Self) -> Self {
        constant
    }

    fn in_sense(self, sense: Real) -> Self {
        turn(self, sense)
    }
}

impl SpaceOver<Vector> for Vector {
    fn against(self, constant: Self) -> Real {
        dot(constant, self)
    }
}

impl RotationOver<Real> for Rotation {
    fn apply(self, constant: Vector) -> Vector {
        rotated(self, constant)
    }

    fn apply_back(self, v: Vector) -> Vector {
        vector_of(dot(self.x, v), dot(self.y, v), dot(self.z, v))
    }

    fn after(self, constant: Self) -> Self {
        product(self, constant)
    }
}

/// A displacement of a plane as the core has it.
pub fn displacement(g: Planar) -> PlanarDisplacement<Complex> {
    PlanarDisplacement { rotation: g.rotation, translation: g.translation }
}

/// Writes joints to their places.
pub fn write<const N: usize>(places: [Displaced; N], joints: [Displaced; N]) {
    for (place, joint) in places.into_iter().zip(joints) {
        match (place, joint) {
            (Displaced::Direction(place), Displaced::Direction(z)) => place.set(z),
            (Displaced::Value(place), Displaced::Value(value)) => place.set(value),
            _ => unreachable!("a chain gives each of its joints in the same form"),
        }
    }
}

/// Traces a chain's closed form: it writes the joints to their places, and gives zero, or by how much the target is out of
/// reach. `regular` says what must hold for the joints to make a chain.
pub fn solve<C: ClosedForm<Real>>(
    chain: &C,
    regular: &[Closes<Real>],
    target: &C::Target,
    sign: Real,
    places: [Displaced; 3],
) -> Real {
    let mut check = Vec::new();
    let mut body = statements(|| {
        let Attempt { displacements, holds, .. } = chain.attempt(target, sign);
        write(places, displacements);
        let closes = (holds != Truth::YES).then_some(holds);
        let conditions = regular.iter().filter_map(|condition| match *condition {
            Closes::Always => None,
            Closes::Within(number, [least, _]) => Some(number.gt(least)),
            Closes::Exceeds(number, of) => Some(numbers::Real::exceeds(number, of)),
        });
        let Some(test) = closes.into_iter().chain(conditions).reduce(|all, one| all & one) else {
            return;
        };
        check = statements(|| {
            when(!test, || {
                let Exception { excess, special, .. } = chain.exception(target, sign);
                match special {
                    Some((holds, joints)) if holds != Truth::YES => {
                        when(!holds, || give(missed(excess)));
                        write(places, joints);
                        give(0.0);
                    }
                    Some(_) => give(Real::infinity()),
                    None => give(missed(excess)),
                }
            });
        });
    });
    // Where the closed form says that it needs the chain to close.
    let place = body.iter().position(is_mark).unwrap_or(0);
    let rest = body.split_off(place);
    let mut all: Vec<Statement> =
        body.into_iter().chain(check).chain(rest.into_iter().filter(|one| !is_mark(one))).collect();
    visit::drop_unread(&mut all);
    all.into_iter().for_each(emit);
    0.0.into()
}

/// Whether a statement marks a place: no closed form has a loop to go on with.
fn is_mark(statement: &Statement) -> bool {
    matches!(statement, Statement::Continue)
}

impl From<Complex> for Displaced {
    fn from(z: Complex) -> Self {
        Self::Direction(z)
    }
}

impl From<Real> for Displaced {
    fn from(value: Real) -> Self {
        Self::Value(value)
    }
}
