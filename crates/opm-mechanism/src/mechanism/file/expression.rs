//! Expressions of numbers, points and directions, by which a mechanism file gives what its drawing gives.
//!
//! Numbers are in the units of the file: lengths in its unit of length, and functions of angles take its unit of angle. A
//! text is evaluated while it is read, so that every problem has its place in it.

mod construct;
mod functions;
mod parse;

pub(super) use construct::direction;
pub(super) use functions::{is_function, reflected, turned};
pub(super) use parse::{evaluate, is_name};

use crate::mechanism::file::FileUnits;
use nalgebra::Vector3;

/// What an expression gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Term {
    Number(f64),
    /// A point, a direction or a difference of points.
    Vector(Vector3<f64>),
}

impl Term {
    fn kind(self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Vector(_) => "a point",
        }
    }

    fn is_finite(self) -> bool {
        match self {
            Self::Number(number) => number.is_finite(),
            Self::Vector(vector) => vector.iter().all(|c| c.is_finite()),
        }
    }
}

/// What is wrong with an expression, and the byte at which it is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub at: usize,
    pub message: String,
}

/// What the names in an expression mean.
pub(super) trait Scope {
    /// The value of a name.
    fn value(&self, name: &str) -> Found;
    /// The names that are known, for messages.
    fn names(&self) -> Vec<String>;
    /// The units of the numbers.
    fn units(&self) -> FileUnits;
    /// The number of the leg of a pattern that is read, which stands for `{i}` in names.
    fn leg(&self) -> Option<usize> {
        None
    }
}

/// What a name is found to be.
pub(super) enum Found {
    Term(Term),
    /// There is no such name.
    Nothing,
    /// It has no value: the reason is for a message, or was told already if there is none.
    Without(Option<String>),
}

#[cfg(test)]
mod tests;
