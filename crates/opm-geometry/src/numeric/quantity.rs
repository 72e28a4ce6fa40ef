//! The physical quantity that a coordinate measures.

/// Whether a coordinate is an angle or a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Quantity {
    /// An angle, in radians.
    Angle,
    /// A length, in metres.
    Length,
}

impl Quantity {
    /// The SI unit: `rad` or `m`.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length => "m",
        }
    }
}
