//! Equations in one joint alone, and what finds the joint by one or two of them.

use super::StepName;
use super::element::{Element, Kind, Moved, constant};
use crate::chain::kernel::Row;
use crate::numbers::{Joint, Plane, Real, Space};

/// A number that neither the joint nor those that are not solved yet change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar<P> {
    /// It is the same at all poses.
    Known(f64),
    /// The square of the distance of two points.
    Square([P; 2]),
    /// The height of a point over a plane.
    Height { point: P, normal: P, base: P },
    /// The scalar product of two directions.
    Cosine([P; 2]),
}

/// An invariant of two objects, one of which the joint moves. The objects are those on its two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Equation<P> {
    /// A point that the joint moves is at a distance from a fixed one.
    Distance { moved: P, fixed: P, square: Scalar<P> },
    /// A point that the joint moves has a height over a fixed plane; or, where the joint moves the plane, a fixed point has
    /// it: then the point moves back.
    Height { moved: P, normal: P, base: P, height: Scalar<P>, back: bool },
    /// A direction that the joint moves has a cosine with a fixed one.
    Angle { moved: P, fixed: P, cosine: Scalar<P> },
}

/// What is needed to say by how much an equation has no root.
#[derive(Clone, Copy, Debug)]
pub enum Invariant<T> {
    /// Of two points; the square of the distance.
    Distance(T),
    /// Of a point over a plane.
    Height,
    /// Of two directions; the cosine.
    Angle(T),
}

/// What finds a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kernel<P> {
    /// A slider, by an equation that is linear.
    Linear(Equation<P>),
    /// A slider, by the difference of two distances.
    Difference([Equation<P>; 2]),
    /// A slider, by a distance: two roots.
    Quadratic(Equation<P>),
    /// A point that the joint moves to a known place.
    Point { moved: P, fixed: P },
    /// A line parallel to the axis that the joint turns to a known place: by a point of it.
    Line { moved: P, fixed: P },
    /// A direction that the joint turns to a known one.
    Direction { moved: P, fixed: P },
    /// An angle, by two equations that are linear in its cosine and sine.
    Pair([Equation<P>; 2]),
    /// An angle, by an equation whose two roots are always one.
    Double(Equation<P>),
    /// An angle, by an equation with two roots.
    Twofold(Equation<P>),
}

/// Finds roots. The general case has no branch; what is rare is found by another one.
pub trait Roots<T: Real> {
    /// The root of a row where it rises or falls.
    fn twofold(&mut self, row: Row<T>, of: Invariant<T>, sign: T::Sign) -> T::Plane;
    /// The root of a row that is a double one.
    fn double(&mut self, row: Row<T>, of: Invariant<T>) -> T::Plane;
    /// The root of two rows.
    fn pair(&mut self, rows: [Row<T>; 2]) -> T::Plane;
    /// The unit vector in the direction of a vector whose length should be `square`, and how long that is for a size.
    fn turned(&mut self, vector: T::Plane, square: T, scale: f64) -> T::Plane;
    /// The root of `rate · s = constant`.
    fn linear(&mut self, rate: T, constant: T) -> T;
    /// The root of `s² + 2 half s + constant` where it rises or falls; the square of the distance that it is about.
    fn quadratic(&mut self, half: T, constant: T, square: T, sign: T::Sign) -> T;
}

impl<P: Copy> Scalar<P> {
    /// The number.
    #[inline(always)]
    pub fn of<T: Real>(&self, read: impl Fn(P) -> T::Space) -> T {
        let minus = T::constant(-1.0);
        T::compute(|| match *self {
            Self::Known(value) => T::constant(value),
            Self::Square([a, b]) => {
                let across = read(a).plus(minus, read(b)).named("span");
                across.inner(across).named("square")
            }
            Self::Height { point, normal, base } => {
                read(point).plus(minus, read(base)).inner(read(normal))
            }
            Self::Cosine([a, b]) => read(a).inner(read(b)),
        })
    }

    fn map<Q>(self, f: &mut impl FnMut(P) -> Q) -> Scalar<Q> {
        match self {
            Self::Known(value) => Scalar::Known(value),
            Self::Square(two) => Scalar::Square(two.map(f)),
            Self::Height { point, normal, base } => {
                Scalar::Height { point: f(point), normal: f(normal), base: f(base) }
            }
            Self::Cosine(two) => Scalar::Cosine(two.map(f)),
        }
    }
}

impl<P: Copy> Equation<P> {
    /// The same, with other sources.
    pub fn map<Q>(self, f: &mut impl FnMut(P) -> Q) -> Equation<Q> {
        match self {
            Self::Distance { moved, fixed, square } => {
                Equation::Distance { moved: f(moved), fixed: f(fixed), square: square.map(f) }
            }
            Self::Height { moved, normal, base, height, back } => Equation::Height {
                moved: f(moved),
                normal: f(normal),
                base: f(base),
                height: height.map(f),
                back,
            },
            Self::Angle { moved, fixed, cosine } => {
                Equation::Angle { moved: f(moved), fixed: f(fixed), cosine: cosine.map(f) }
            }
        }
    }

    /// The name of the invariant.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Distance { .. } => "distance",
            Self::Height { .. } => "height",
            Self::Angle { .. } => "angle",
        }
    }

    /// The equation in the cosine and the sine of a revolute joint.
    #[inline(always)]
    pub fn row<T: Real>(
        &self,
        element: &Element,
        read: impl Fn(P) -> T::Space + Copy,
    ) -> (Row<T>, Invariant<T>) {
        let axis = element.axis::<T>();
        T::compute(|| match *self {
            Self::Distance { moved, fixed, square } => {
                let square = square.of::<T>(read);
                let (moved, fixed) = element.armed::<T>(read(moved), read(fixed));
                (axis.distance(moved, fixed, square), Invariant::Distance(square))
            }
            // What a circle shifts is shifted by its arm's end, whichever side of it the plane is on.
            Self::Height { moved, normal, base, height, back }
                if let Kind::Circle(arm) = element.kind =>
            {
                let (normal, arm) = (read(normal), constant::<T>(&arm));
                let level = read(moved).plus(T::constant(-1.0), read(base)).inner(normal);
                let missing = height.of::<T>(read) - level;
                let shift = if back { -missing } else { missing };
                (axis.height(arm, normal, shift + normal.inner(arm)), Invariant::Height)
            }
            Self::Height { moved, normal, base, height, back } => {
                let normal = read(normal);
                let height = height.of::<T>(read) + normal.inner(read(base));
                let Row { cosine, sine, constant } = axis.height(read(moved), normal, height);
                let sine = if back { -sine } else { sine };
                (Row { cosine, sine, constant }, Invariant::Height)
            }
            Self::Angle { moved, fixed, cosine } => {
                let cosine = cosine.of::<T>(read);
                (axis.angle(read(moved), read(fixed), cosine), Invariant::Angle(cosine))
            }
        })
    }

    /// The rate and the constant of a height in the advance along the direction.
    #[inline(always)]
    pub fn linear<T: Real>(
        &self,
        element: &Element,
        read: impl Fn(P) -> T::Space + Copy,
    ) -> (T, T) {
        match *self {
            Self::Height { moved, normal, base, height, back } => {
                let normal = read(normal);
                let rate = normal.inner(constant::<T>(&element.direction));
                let level = read(moved).plus(T::constant(-1.0), read(base)).inner(normal);
                (if back { -rate } else { rate }, height.of::<T>(read) - level)
            }
            Self::Distance { .. } | Self::Angle { .. } => (T::constant(1.0), T::constant(0.0)),
        }
    }

    /// Half the rate, the constant and the square of the distance in the advance along the direction.
    #[inline(always)]
    pub fn quadratic<T: Real>(
        &self,
        element: &Element,
        read: impl Fn(P) -> T::Space + Copy,
    ) -> (T, T, T) {
        match *self {
            Self::Distance { moved, fixed, square } => {
                let across = read(moved).plus(T::constant(-1.0), read(fixed)).named("span");
                let half = across.inner(constant::<T>(&element.direction));
                let square = square.of::<T>(read);
                (half, across.inner(across) - square, square)
            }
            Self::Height { .. } | Self::Angle { .. } => {
                (T::constant(0.0), T::constant(0.0), T::constant(0.0))
            }
        }
    }
}

impl<P: Copy> Kernel<P> {
    /// The same, with other sources.
    pub fn map<Q>(self, f: &mut impl FnMut(P) -> Q) -> Kernel<Q> {
        match self {
            Self::Linear(one) => Kernel::Linear(one.map(f)),
            Self::Difference(two) => Kernel::Difference(two.map(|one| one.map(f))),
            Self::Quadratic(one) => Kernel::Quadratic(one.map(f)),
            Self::Point { moved, fixed } => Kernel::Point { moved: f(moved), fixed: f(fixed) },
            Self::Line { moved, fixed } => Kernel::Line { moved: f(moved), fixed: f(fixed) },
            Self::Direction { moved, fixed } => {
                Kernel::Direction { moved: f(moved), fixed: f(fixed) }
            }
            Self::Pair(two) => Kernel::Pair(two.map(|one| one.map(f))),
            Self::Double(one) => Kernel::Double(one.map(f)),
            Self::Twofold(one) => Kernel::Twofold(one.map(f)),
        }
    }

    /// Whether it has two roots.
    pub fn chooses(&self) -> bool {
        match self {
            Self::Quadratic(_) | Self::Twofold(_) => true,
            Self::Linear(_)
            | Self::Difference(_)
            | Self::Point { .. }
            | Self::Line { .. }
            | Self::Direction { .. }
            | Self::Pair(_)
            | Self::Double(_) => false,
        }
    }

    /// The name of the step that finds a joint so.
    pub fn named(&self, joint: usize) -> StepName {
        let (root, invariant) = match self {
            Self::Linear(one) => ("linear", one.name()),
            Self::Difference([one, _]) => ("linear", one.name()),
            Self::Quadratic(one) => ("quadratic", one.name()),
            Self::Point { .. } => ("direct", "point"),
            Self::Line { .. } => ("direct", "line"),
            Self::Direction { .. } => ("direct", "direction"),
            Self::Pair([one, _]) => ("pair", one.name()),
            Self::Double(one) => ("double", one.name()),
            Self::Twofold(one) => ("twofold", one.name()),
        };
        StepName { joint, root, invariant: Some(invariant) }
    }

    /// The joint.
    #[inline(always)]
    pub fn solve<T: Real, R: Roots<T>>(
        &self,
        element: &Element,
        size: f64,
        sign: T::Sign,
        read: impl Fn(P) -> T::Space + Copy,
        roots: &mut R,
    ) -> (Moved<T>, T::Joint) {
        let minus = T::constant(-1.0);
        let towards = |y, w, size, roots: &mut R| towards::<T, R>(element, y, w, size, roots);
        let arms = |moved, fixed| {
            let (from, to) = element.armed::<T>(read(moved), read(fixed));
            let point = element.axis::<T>().point;
            (from.plus(minus, point), to.plus(minus, point))
        };
        match self {
            Self::Linear(one) => {
                let (rate, constant) = one.linear::<T>(element, read);
                slid(element, roots.linear(rate, constant))
            }
            Self::Difference([one, two]) => {
                let (a, b) = (one.quadratic::<T>(element, read), two.quadratic::<T>(element, read));
                let per = 1.0 / size;
                slid(element, roots.linear((a.0 - b.0) * (2.0 * per), (b.1 - a.1) * per))
            }
            Self::Quadratic(one) => {
                let (half, constant, square) = one.quadratic::<T>(element, read);
                slid(element, roots.quadratic(half, constant, square, sign))
            }
            &Self::Point { moved, fixed } => match element.kind {
                Kind::Turn | Kind::Circle(_) => {
                    let (from, to) = arms(moved, fixed);
                    turned(element, towards(from, to, size, roots))
                }
                Kind::Helix(_) | Kind::Slide | Kind::Ball => slid(
                    element,
                    read(fixed).plus(minus, read(moved)).inner(constant::<T>(&element.direction)),
                ),
            },
            &Self::Line { moved, fixed } => {
                let (from, to) = arms(moved, fixed);
                turned(element, towards(from, to, size, roots))
            }
            &Self::Direction { moved, fixed } => {
                turned(element, towards(read(moved), read(fixed), 1.0, roots))
            }
            Self::Pair([one, two]) => {
                let rows = [one.row::<T>(element, read).0, two.row::<T>(element, read).0];
                turned(element, roots.pair(rows))
            }
            Self::Double(one) => {
                let (row, of) = one.row::<T>(element, read);
                turned(element, roots.double(row, of))
            }
            Self::Twofold(one) => {
                let (row, of) = one.row::<T>(element, read);
                turned(element, roots.twofold(row, of, sign))
            }
        }
    }
}

/// A joint that advances along its direction.
#[inline(always)]
fn slid<T: Real>(element: &Element, shift: T) -> (Moved<T>, T::Joint) {
    match element.kind {
        Kind::Helix(pitch) => {
            let angle = shift * (1.0 / pitch);
            (Moved { unit: angle.unit(), shift }, T::Joint::value(angle))
        }
        Kind::Turn | Kind::Slide | Kind::Ball | Kind::Circle(_) => {
            (Moved { shift, ..Moved::home() }, T::Joint::value(shift))
        }
    }
}

/// A joint that turns.
#[inline(always)]
fn turned<T: Real>(element: &Element, unit: T::Plane) -> (Moved<T>, T::Joint) {
    match element.kind {
        Kind::Helix(pitch) => {
            let angle = unit.argument();
            (Moved { unit, shift: angle * pitch }, T::Joint::value(angle))
        }
        Kind::Turn | Kind::Slide | Kind::Ball | Kind::Circle(_) => {
            (Moved { unit, ..Moved::home() }, T::Joint::direction(unit))
        }
    }
}

/// What turns the part of a vector across the axis to that of another one.
#[inline(always)]
fn towards<T: Real, R: Roots<T>>(
    element: &Element,
    from: T::Space,
    to: T::Space,
    size: f64,
    roots: &mut R,
) -> T::Plane {
    let direction = constant::<T>(&element.direction);
    let from = from.named("arm");
    let across = from.plus(-direction.inner(from), direction).named("across");
    let to = to.named("to");
    let vector = T::Plane::new(across.inner(to), direction.crossed(from).inner(to));
    roots.turned(vector, across.inner(across), size)
}
