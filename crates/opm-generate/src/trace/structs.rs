//! Structs and arrays.

use super::{Handle, Id, Int, emit};
use crate::tree::{Expr, Node, Statement, Type};
use std::marker::PhantomData;

/// Defines structs of generated code as handles, whose members are handles, too, and the function `structs` that lists them. What
/// is documented here is in the generated code.
macro_rules! structs {
    ($($(#[doc = $doc:literal])+ $name:ident { $($member:ident: $kind:ident),+ })+) => {
        $(
            $(#[doc = $doc])+
            // Printers know members that no function needs.
            #[allow(dead_code)]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $name {
                id: $crate::trace::Id,
                $(pub $member: $kind,)+
            }

            impl $crate::trace::Handle for $name {
                fn of(id: $crate::trace::Id) -> Self {
                    Self {
                        id,
                        $($member: $kind::of($crate::trace::member(id, stringify!($member), $kind::kind)),)+
                    }
                }
                fn id(self) -> $crate::trace::Id {
                    self.id
                }
                fn kind() -> $crate::tree::Type {
                    $crate::tree::Type::Struct($crate::trace::snake(stringify!($name)))
                }
            }

            impl $name {
                /// Of all its members.
                #[allow(dead_code)]
                pub fn made($($member: impl Into<$kind>),+) -> Self {
                    let members = vec![$($crate::trace::Handle::expr($member.into())),+];
                    let node = $crate::tree::Node::Made(members);
                    Self::from_expr($crate::tree::Expr::new(node, Self::kind()))
                }
            }
        )+

        /// The structs of this file.
        pub fn structs() -> Vec<$crate::tree::Struct> {
            vec![$($crate::tree::Struct {
                name: $crate::trace::snake(stringify!($name)),
                comment: concat!($($doc),+).trim().to_owned(),
                members: vec![$($crate::tree::Member {
                    name: stringify!($member).to_owned(),
                    kind: $kind::kind(),
                    comment: String::new(),
                }),+],
            }),+]
        }
    };
}
pub(crate) use structs;

/// The name of a type in lower case: `PlanarRrr` becomes `planar_rrr`.
pub fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.push(letter.to_ascii_lowercase());
    }
    text
}

/// An array.
#[derive(Clone, Copy, Debug)]
pub struct Array<T> {
    id: Id,
    of: PhantomData<T>,
}

impl<T: Handle> Array<T> {
    fn expr(self) -> Expr {
        Any(self.id).expr()
    }

    /// An element.
    pub fn at(self, place: impl Into<Int>) -> T {
        let (of, place) = (Box::new(self.expr()), Box::new(place.into().expr()));
        T::from_expr(Expr::new(Node::Index(of, place), T::kind()))
    }

    /// Declares an array without values.
    pub fn empty(name: &str, length: usize) -> Self {
        Self::declared(name, length, None)
    }

    /// Declares an array of values.
    pub fn named(name: &str, values: impl IntoIterator<Item = impl Into<T>>) -> Self {
        let values: Vec<Expr> = values.into_iter().map(|value| value.into().expr()).collect();
        Self::declared(name, values.len(), Some(values))
    }

    fn declared(name: &str, length: usize, values: Option<Vec<Expr>>) -> Self {
        let kind = Type::Array(Box::new(T::kind()), length);
        let init = values.map(|values| Expr::new(Node::Made(values), kind.clone()));
        emit(Statement::Declare { name: name.to_owned(), kind: kind.clone(), init });
        Any::from_expr(Expr::variable(name, kind)).array()
    }
}

/// What has a type that only the mechanism says.
#[derive(Clone, Copy, Debug)]
pub struct Any(Id);

impl Any {
    pub fn from_expr(expr: Expr) -> Self {
        Self(super::store(super::Stored::Whole(expr)))
    }

    pub fn expr(self) -> Expr {
        super::TRACE.with_borrow(|trace| super::resolved(trace, self.0, Type::Void))
    }

    /// The same with a type that is known.
    pub fn is<T: Handle>(self) -> T {
        T::of(self.0)
    }

    /// The same as an array.
    pub fn array<T: Handle>(self) -> Array<T> {
        Array { id: self.0, of: PhantomData }
    }

    /// A member.
    pub fn member<T: Handle>(self, name: &str) -> T {
        self.part(name, T::kind()).is()
    }

    /// A member of a type that only the mechanism says.
    pub fn part(self, name: &str, kind: Type) -> Self {
        Self::from_expr(Expr::new(Node::Member(Box::new(self.expr()), name.to_owned()), kind))
    }

    /// A member that is an array.
    pub fn list<T: Handle>(self, name: &str, length: usize) -> Array<T> {
        let kind = Type::Array(Box::new(T::kind()), length);
        self.part(name, kind).array()
    }

    /// Declares a variable of a type, with a value or without.
    pub fn variable(name: &str, kind: &Type, init: Option<Expr>) -> Self {
        emit(Statement::Declare { name: name.to_owned(), kind: kind.clone(), init });
        Self::from_expr(Expr::variable(name, kind.clone()))
    }

    /// Assigns a value.
    pub fn set(self, value: Self) {
        super::assign(self.expr(), None, value.expr());
    }
}

impl<T: Handle> From<T> for Any {
    fn from(handle: T) -> Self {
        Self::from_expr(handle.expr())
    }
}

impl<T: Handle> From<Array<T>> for Any {
    fn from(array: Array<T>) -> Self {
        Self(array.id)
    }
}
