//! Tolerances and other constants: of the core in double precision, and beside them for single precision.

use crate::trace::{Int, Real, digits};
use crate::tree::Constant;
use opm_core::{chain, manipulator, numbers, velocity};

/// Defines constants as numbers, and the function `constants` that lists them. What is documented here is in the generated code.
macro_rules! constants {
    ($($(#[doc = $doc:literal])* $name:ident = $double:expr, $single:expr;)+) => {
        $(
            $(#[doc = $doc])*
            pub const $name: Real = Real::constant(stringify!($name));
        )+

        /// The constants of the library.
        pub fn constants() -> Vec<Constant> {
            vec![$(Constant {
                name: stringify!($name).to_owned(),
                comment: concat!($($doc,)* "").trim().to_owned(),
                double: $double.to_text(),
                float: $single.to_text(),
            }),+]
        }
    };
}

constants! {
    /// How far beyond its reach a chain still closes, as a share of its size: rounding must not decide there.
    REACH = numbers::REACH.share, numbers::REACH.single;

    /// A length or a sine below this share counts as zero.
    DEGENERATE = numbers::DEGENERATE.share, numbers::DEGENERATE.single;

    /// A coefficient below this share counts as zero.
    VERGE = chain::condition::VERGE, 1e-6;

    /// The sine of the angle below which two equations of one joint count as one.
    ONE_ROW = 1e-7, 1e-3;

    /// A leg is closed where it is open by less than this, radians or shares of its size.
    CLOSED = 1e-7, 1e-3;

    /// A constraint that the platform obeys already is missed by less than this.
    OBEYED = manipulator::form::OBEYED, 1e-4;

    /// The largest coordinate of a pose: the fourth power of a larger one would overflow.
    LARGEST = manipulator::LARGEST, 1e9;

    /// The square of the cosine of the angle from which on two axes count as well apart.
    BESIDE = 0.99, 0.99;

    PI = "3.14159265358979323846", "3.14159265358979323846";

    TAU = "6.28318530717958647693", "6.28318530717958647693";

    /// A singular system has a pivot below this share: its rates would be rounding.
    SINGULAR = velocity::SINGULAR, 1e-4;

    /// A determinant below this is one of a singular pose, in radians and sizes of the mechanism.
    VANISHED = 1e-9, 1e-5;

    /// How far poses are beside another one of which differences are taken, in radians and sizes of the mechanism.
    NEARBY = 1e-6, 1e-3;
}

/// How many coordinates a pose has.
pub const COORDINATES: Int = Int::constant("COORDINATES");

/// What is written as a number of the code.
trait ToText {
    fn to_text(&self) -> String;
}

impl ToText for f64 {
    fn to_text(&self) -> String {
        digits(*self)
    }
}

impl ToText for &str {
    fn to_text(&self) -> String {
        (*self).to_owned()
    }
}
