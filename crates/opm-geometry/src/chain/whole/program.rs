//! An order as a flat list of operations on vectors, over any numbers.

use super::MOST_FREEDOMS;
use super::element::{Element, Kind, Moved, Vector, constant};
use super::equation::{Kernel, Roots};
use crate::numbers::{Joint, Plane, Real, Rotation, Space};
use nalgebra::Vector3;

/// So many vectors are held at once, at most.
pub(super) const REGISTERS: usize = 16;

/// Where a vector is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Constant(u8),
    Register(u8),
}

/// An operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Operation {
    /// A vector moved by the target, or moved back.
    Target { back: bool, kind: Vector, of: Place, to: u8 },
    /// A vector moved by a joint, or moved back.
    Joint { joint: u8, back: bool, kind: Vector, of: Place, to: u8 },
    /// Where a line is nearest to another one.
    Meet { lines: [[Place; 2]; 2], to: u8 },
    /// The cross product.
    Cross { two: [Place; 2], to: u8 },
    /// A joint, by the sign of a choice.
    Solve { joint: u8, kernel: Kernel<Place>, choice: u8 },
}

/// Two ways to the same vector: what shows that the loop is closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Check {
    Same(Vector, [Place; 2]),
    /// Two pairs of points have the same distance.
    Length([[Place; 2]; 2]),
}

/// The balls of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Balls {
    None,
    One(usize),
    /// The second one's centre as it is behind the first one, and as it should be before it.
    Two {
        balls: [usize; 2],
        centre: Place,
        aim: Place,
    },
}

/// The operations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program {
    pub constants: Vec<Vector3<f64>>,
    pub operations: Vec<Operation>,
    pub checks: Vec<Check>,
    pub balls: Balls,
}

/// Room for the signs of choices. It is a power of two, too.
pub(super) const SIGNS: usize = 4;
/// Room for the joints. It is a power of two: to stay within costs nothing.
pub(super) const JOINTS: usize = 8;

/// What the operations give.
#[derive(Clone, Debug)]
pub(super) struct Run<T: Real> {
    /// The displacement of each joint but balls.
    moved: [Moved<T>; JOINTS],
    /// That of each freedom.
    pub joints: [T::Joint; MOST_FREEDOMS],
    registers: [T::Space; REGISTERS],
}

impl<T: Real> Run<T> {
    /// Nothing yet.
    #[inline(always)]
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        Self {
            moved: [Moved::home(); JOINTS],
            joints: [T::Joint::value(zero); MOST_FREEDOMS],
            registers: [T::Space::new(zero, zero, zero); REGISTERS],
        }
    }

    /// Takes the displacement of a joint that is given.
    pub fn give(&mut self, joint: usize, by: Moved<T>) {
        self.moved[joint % JOINTS] = by;
    }

    /// The displacement of a joint that is no ball.
    #[inline(always)]
    pub fn moved(&self, joint: usize) -> Moved<T> {
        self.moved[joint % JOINTS]
    }
}

#[inline(always)]
fn read<T: Real>(constants: &[Vector3<f64>], registers: &[T::Space], place: Place) -> T::Space {
    match place {
        Place::Constant(number) => constant::<T>(&constants[usize::from(number)]),
        Place::Register(number) => registers[usize::from(number) % REGISTERS],
    }
}

impl Program {
    /// Computes all joints but balls.
    #[inline(always)]
    pub fn run<T: Real>(
        &self,
        leg: (&[Element], f64),
        (rotation, translation): (T::Rotation, T::Space),
        signs: [T::Sign; SIGNS],
        roots: &mut impl Roots<T>,
        run: &mut Run<T>,
    ) {
        let (elements, size) = leg;
        for operation in &self.operations {
            let Run { moved, joints, registers } = &mut *run;
            let at = |place| read::<T>(&self.constants, registers, place);
            let (made, to) = match operation {
                &Operation::Target { back, kind, of, to } => {
                    let v = at(of);
                    let made = match (back, kind) {
                        (false, Vector::Direction) => rotation.image(v),
                        (false, Vector::Point) => {
                            rotation.image(v).plus(T::constant(1.0), translation)
                        }
                        (true, Vector::Direction) => rotation.inverse().image(v),
                        (true, Vector::Point) => {
                            rotation.inverse().image(v.plus(T::constant(-1.0), translation))
                        }
                    };
                    (made, to)
                }
                &Operation::Joint { joint, back, kind, of, to } => {
                    let joint = usize::from(joint);
                    (elements[joint].carry(moved[joint % JOINTS], back, kind, at(of)), to)
                }
                &Operation::Meet { lines: [[a, u], [b, v]], to } => {
                    let (a, u, b, v) = (at(a), at(u), at(b), at(v));
                    let normal = u.crossed(v).named("normal");
                    let apart = b.plus(T::constant(-1.0), a);
                    let along = apart.crossed(v).inner(normal).over(normal.inner(normal));
                    (a.plus(along, u), to)
                }
                &Operation::Cross { two: [a, b], to } => (at(a).crossed(at(b)), to),
                Operation::Solve { joint, kernel, choice } => {
                    let joint = usize::from(*joint);
                    let (element, sign) = (&elements[joint], signs[usize::from(*choice) % SIGNS]);
                    let (by, displacement) = kernel.solve(element, size, sign, at, roots);
                    moved[joint % JOINTS] = by;
                    joints[element.slot] = displacement;
                    // The second hinge of a parallelogram turns back.
                    if let Kind::Circle(_) = element.kind {
                        joints[element.slot + 1] = T::Joint::direction(by.unit.conj());
                    }
                    continue;
                }
            };
            registers[usize::from(to) % REGISTERS] = made.named("carried");
        }
    }

    /// The operations that decide on choices, and those that find some joints, without checks.
    pub fn reduced(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let (mut registers, mut joints) = ([false; REGISTERS], [false; JOINTS]);
        let mut operations = Vec::new();
        for operation in self.operations.iter().rev() {
            let mut read = Vec::new();
            match operation {
                Operation::Solve { joint, kernel, .. } => {
                    let number = usize::from(*joint);
                    if !(kernel.chooses() || joints[number] || wanted(number)) {
                        continue;
                    }
                    kernel.map(&mut |place| read.push(place));
                }
                &Operation::Target { to, .. }
                | &Operation::Joint { to, .. }
                | &Operation::Meet { to, .. }
                | &Operation::Cross { to, .. } => {
                    if !std::mem::take(&mut registers[usize::from(to)]) {
                        continue;
                    }
                    match *operation {
                        Operation::Joint { joint, of, .. } => {
                            joints[usize::from(joint)] = true;
                            read.push(of);
                        }
                        Operation::Meet { lines, .. } => read.extend(lines.as_flattened()),
                        Operation::Cross { two, .. } => read.extend(two),
                        Operation::Target { of, .. } => read.push(of),
                        Operation::Solve { .. } => {}
                    }
                }
            }
            for place in read {
                if let Place::Register(number) = place {
                    registers[usize::from(number)] = true;
                }
            }
            operations.push(*operation);
        }
        operations.reverse();
        Self {
            constants: self.constants.clone(),
            operations,
            checks: Vec::new(),
            balls: Balls::None,
        }
    }

    /// The square of how far the loop is from closed; lengths relative to the size.
    #[inline(always)]
    pub fn open<T: Real>(&self, run: &Run<T>, size: f64) -> T {
        let per = 1.0 / size;
        let minus = T::constant(-1.0);
        let square = |v: T::Space| v.inner(v);
        let mut all = T::constant(0.0);
        for check in &self.checks {
            let off = match check {
                Check::Same(kind, [a, b]) => {
                    let apart = self.at::<T>(run, *a).plus(minus, self.at::<T>(run, *b));
                    let off = square(apart.named("apart"));
                    match kind {
                        Vector::Point => off * (per * per),
                        Vector::Direction => off,
                    }
                }
                Check::Length(two) => {
                    let [a, b] = two.map(|[a, b]| {
                        let apart = self.at::<T>(run, a).plus(minus, self.at::<T>(run, b));
                        square(apart.named("apart"))
                    });
                    ((a - b) * (per * per)).square()
                }
            };
            all = all + off;
        }
        all
    }

    /// A vector.
    #[inline(always)]
    pub fn at<T: Real>(&self, run: &Run<T>, place: Place) -> T::Space {
        read::<T>(&self.constants, &run.registers, place)
    }
}
