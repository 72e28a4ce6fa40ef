//! Figures of curves over time and of clouds of points, as SVG and PNG.
//!
//! A figure ([`TimeFigure`], [`TileFigure`]) is plain data: numbers in the units that they are shown
//! in, and names. It is laid out as a [`Drawing`], a list of shapes, from which [`svg::write`] and
//! [`png::write`] make files that show the same thing. Texts are outlines of fonts that come with
//! the crate, and are measured with the same fonts: nothing depends on what the machine has. The same
//! figure gives the same bytes.
//!
//! However much there is to draw, a figure stays small: curves are thinned out to their extremes
//! ([`Curve`]), cells and dots beyond [`MOST_SHAPES`] of them become an image.

pub mod axis;
pub mod color;
mod curve;
pub mod drawing;
pub mod font;
mod frame;
mod heading;
pub mod png;
pub mod svg;
mod tiles;
mod time;

pub use axis::{Steps, Unit};
pub use curve::Curve;
pub use drawing::{Drawing, Size};
pub use heading::Heading;
pub use tiles::{
    Bar, Cells, Cloud, Content, Histogram, Measure, Paint, Section, Spacing, Tile, TileFigure,
};
pub use time::{Panel, Row, Scale, TimeFigure};

/// Largest width and height of a figure; its PNG has four times as many pixels as that squared.
pub const MOST: f64 = 4000.0;

/// Cells or dots of one panel that are drawn one by one; where there are more they become an image.
pub const MOST_SHAPES: usize = 5000;

/// A figure does not fit in the size that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{panels} panels need at least {}x{}, and nothing is larger than {MOST}x{MOST}",
    needed.width,
    needed.height
)]
pub struct TooSmall {
    /// The least size.
    pub needed: Size,
    /// Panels of the figure.
    pub panels: usize,
}
