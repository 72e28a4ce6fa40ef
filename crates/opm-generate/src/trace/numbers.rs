//! Numbers and truths.

use super::{Handle, Id, Value, assign};
use crate::tree::{Argument, Expr, Node, Op, Pass, Type};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Rem, Shl, Shr, Sub};

/// Defines the handles of simple types, with the Rust type of their literals.
macro_rules! handles {
    ($($(#[$doc:meta])* $name:ident $kind:ident $($literal:ident)?;)+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub(super) Id);

        impl $name {
            /// A constant of the code.
            #[allow(dead_code)]
            pub const fn constant(name: &'static str) -> Self {
                Self(Id::Constant(name))
            }
        }

        impl Handle for $name {
            fn of(id: Id) -> Self {
                Self(id)
            }
            fn id(self) -> Id {
                self.0
            }
            fn kind() -> Type {
                Type::$kind
            }
        }

        $(
            impl From<$literal> for $name {
                fn from(value: $literal) -> Self {
                    Self::from_expr(literal(value.into(), Type::$kind))
                }
            }

            impl Value for $literal {
                type Handle = $name;
                fn handle(self) -> $name {
                    self.into()
                }
            }
        )?
    )+};
}

handles! {
    /// A real number.
    Real Real f64;
    /// A whole number.
    Int Int i32;
    /// A working mode, or bits of one.
    Bits Bits u32;
    /// Whether something is true.
    Truth Bool;
}

/// A number as it is written in code.
fn literal(value: f64, kind: Type) -> Expr {
    if value < 0.0 {
        let positive = literal(-value, kind.clone());
        return Expr::new(Node::Negative(Box::new(positive)), kind);
    }
    Expr::new(Node::Number(digits(value)), kind)
}

/// All digits of a number, with an exponent where that is shorter.
pub fn digits(value: f64) -> String {
    if value.fract() == 0.0 && value < 1e9 {
        return format!("{value}");
    }
    let [plain, exponent] = [format!("{value:?}"), format!("{value:e}")];
    if exponent.len() < plain.len() && !exponent.contains('.') { exponent } else { plain }
}

fn binary<A: Handle, B: Handle, C: Handle>(op: Op, a: A, b: B) -> C {
    C::from_expr(Expr::new(Node::Binary(op, Box::new(a.expr()), Box::new(b.expr())), C::kind()))
}

macro_rules! operators {
    ($($handle:ident $literal:ident: $($op:ident $method:ident $node:ident),+;)+) => {$($(
        impl<T: Into<$handle>> $op<T> for $handle {
            type Output = Self;
            fn $method(self, other: T) -> Self {
                binary(Op::$node, self, other.into())
            }
        }

        impl $op<$handle> for $literal {
            type Output = $handle;
            fn $method(self, other: $handle) -> $handle {
                binary(Op::$node, $handle::from(self), other)
            }
        }
    )+)+};
}

operators! {
    Real f64: Add add Add, Sub sub Subtract, Mul mul Multiply, Div div Divide;
    Int i32: Add add Add, Sub sub Subtract, Mul mul Multiply, Div div Divide, Rem rem Remainder;
    Bits u32: BitAnd bitand BitAnd, BitOr bitor BitOr, Shl shl ShiftLeft, Shr shr ShiftRight;
}

macro_rules! negative {
    ($($handle:ident)+) => {$(
        impl Neg for $handle {
            type Output = Self;
            fn neg(self) -> Self {
                Self::from_expr(Expr::new(Node::Negative(Box::new(self.expr())), Self::kind()))
            }
        }
    )+};
}

negative!(Real Int);

impl BitAnd for Truth {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        binary(Op::And, self, other)
    }
}

impl BitOr for Truth {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        binary(Op::Or, self, other)
    }
}

impl Not for Truth {
    type Output = Self;
    /// Of comparisons, only those for equality have an opposite that is right for what is no number.
    fn not(self) -> Self {
        let Expr { node, kind } = self.expr();
        Self::from_expr(match node {
            Node::Binary(Op::Equal, a, b) => Expr::new(Node::Binary(Op::Unequal, a, b), kind),
            Node::Binary(Op::Unequal, a, b) => Expr::new(Node::Binary(Op::Equal, a, b), kind),
            node => Expr::new(Node::Not(Box::new(Expr::new(node, kind.clone()))), kind),
        })
    }
}

/// Numbers that can be compared and changed in place.
pub trait Number: Handle {
    fn compared(self, op: Op, other: impl Into<Self>) -> Truth {
        binary(op, self, other.into())
    }
    fn changed(self, op: Op, by: impl Into<Self>) {
        assign(self.expr(), Some(op), by.into().expr());
    }
    fn lt(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::Less, other)
    }
    fn le(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::LessEqual, other)
    }
    fn gt(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::Greater, other)
    }
    fn ge(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::GreaterEqual, other)
    }
    fn is(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::Equal, other)
    }
    fn is_not(self, other: impl Into<Self>) -> Truth {
        self.compared(Op::Unequal, other)
    }
    fn increase(self, by: impl Into<Self>) {
        self.changed(Op::Add, by);
    }
    fn decrease(self, by: impl Into<Self>) {
        self.changed(Op::Subtract, by);
    }
    fn multiply(self, by: impl Into<Self>) {
        self.changed(Op::Multiply, by);
    }
    fn divide(self, by: impl Into<Self>) {
        self.changed(Op::Divide, by);
    }
}

impl Number for Real {}
impl Number for Int {}
impl Number for Bits {}

impl Truth {
    /// The first where it is true, else the second.
    pub fn choose<T: Value>(self, a: T, b: impl Into<T::Handle>) -> T::Handle {
        let [a, b] = [a.handle(), b.into()].map(|part| Box::new(part.expr()));
        T::Handle::from_expr(Expr::new(
            Node::Choice(Box::new(self.expr()), a, b),
            T::Handle::kind(),
        ))
    }
    /// 1 where it is true, else 0.
    pub fn int(self) -> Int {
        cast(self)
    }
}

fn cast<A: Handle, B: Handle>(of: A) -> B {
    B::from_expr(Expr::new(Node::Cast(Box::new(of.expr())), B::kind()))
}

impl Int {
    pub fn real(self) -> Real {
        cast(self)
    }
    pub fn bits(self) -> Bits {
        cast(self)
    }
    /// Whether it is not zero.
    pub fn is_set(self) -> Truth {
        self.is_not(0)
    }
}

impl Bits {
    pub fn int(self) -> Int {
        cast(self)
    }
    /// Whether any is set.
    pub fn is_set(self) -> Truth {
        self.is_not(0_u32)
    }
}

impl Real {
    /// The number that is larger than all others.
    pub fn infinity() -> Self {
        Self::from_expr(Expr::new(Node::Infinity, Type::Real))
    }
}

/// The functions of numbers that every language has.
macro_rules! built_in {
    ($($name:ident($($x:ident),+))+) => {$(
        pub fn $name($($x: impl Into<Real>),+) -> Real {
            let given = [$($x.into()),+];
            let given = given.map(|x| Argument { value: x.expr(), pass: Pass::Value });
            Real::from_expr(Expr::new(
                Node::Call(stringify!($name).to_owned(), given.into()),
                Type::Real,
            ))
        }
    )+};
}

built_in! {
    abs(x) max(a, b) min(a, b) sqrt(x) sin(x) cos(x) asin(x) acos(x) round(x) ceil(x) atan2(y, x)
}
