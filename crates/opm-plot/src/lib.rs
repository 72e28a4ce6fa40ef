//! Figures of curves over time, of points in a plane and of solids in space, as SVG, PNG and PDF.
//!
//! A figure is plain data: numbers in the units that they are shown in, and names. [`TimeFigure`] shows curves
//! over time or over another value, [`TileFigure`] shows tiles with cells of a grid, point clouds and histograms, [`ViewFigure`] shows
//! solids from four sides. Each is laid out as a [`Drawing`], a list of shapes, which is written as SVG, PNG or PDF; all
//! look the same.
//!
//! ```
//! use opm_plot::{Curve, Heading, Measure, Panel, PanelRow, Scale, Steps, TimeFigure, Unit};
//!
//! let mut curve = Curve::default();
//! for i in 0..=100 {
//!     let time = 0.1 * f64::from(i);
//!     curve.push(time, 30.0 * time.sin());
//! }
//! let panel = Panel {
//!     title: "Joint".into(),
//!     name: "angle".into(),
//!     unit: Unit { symbol: "deg".into(), steps: Steps::Degrees, resolution: 1e-6 },
//!     scale: Scale::Linear,
//!     curves: vec![(0, curve)],
//!     limits: vec![(0, 45.0), (0, -45.0)],
//! };
//! let figure = TimeFigure {
//!     heading: Heading { title: "A motion".into(), ..Heading::default() },
//!     over: Measure::time(),
//!     range: [0.0, 10.0],
//!     rows: vec![PanelRow { names: vec!["phi1".into()], panels: vec![Some(panel)] }],
//!     invalid: vec![],
//!     marks: vec![],
//! };
//! let drawing = figure.draw(None)?;
//! let (svg, png) = (drawing.to_svg()?, drawing.to_png()?);
//! assert!(svg.starts_with("<svg") && png.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to find what
//!
//! | question | items |
//! |---|---|
//! | curves over time | [`TimeFigure`], [`PanelRow`], [`Panel`], [`Curve`], [`Scale`] |
//! | points in a plane | [`TileFigure`], [`Section`], [`Tile`], [`Cells`], [`Cloud`], [`Histogram`], [`Bar`] |
//! | solids in space | [`ViewFigure`], [`Body`], [`Named`] |
//! | axes and units | [`Unit`], [`Steps`], [`Measure`], module [`axis`] |
//! | texts above and below | [`Heading`] |
//! | the shapes of a figure | [`Drawing`], modules [`drawing`], [`color`], [`font`] |
//! | files | [`Drawing::to_svg`], [`Drawing::to_png`], [`Drawing::to_pdf`], modules [`svg`], [`png`], [`pdf`] |
//!
//! Texts are measured with fonts that come with the crate: nothing depends on the fonts of the machine. SVG and PDF have them
//! as text; a PDF carries what it uses of the fonts, and a viewer of an SVG without them takes others that are like them. The
//! same figure gives the same bytes.
//!
//! A figure stays small, however much there is to draw: curves are thinned out to their extremes ([`Curve`]),
//! and more than [`MOST_SHAPES`] cells or dots become an image.

pub mod axis;
pub mod color;
mod curve;
pub mod drawing;
pub mod font;
mod frame;
mod heading;
pub mod pdf;
pub mod png;
mod subset;
pub mod svg;
mod tiles;
mod time;
mod views;

pub use axis::{Steps, Unit};
pub use color::{Color, Map};
pub use curve::Curve;
pub use drawing::{Drawing, Size};
pub use heading::Heading;
pub use tiles::{
    Bar, Cells, Cloud, Content, Histogram, Measure, Paint, Section, Spacing, Tile, TileFigure,
};
pub use time::{Panel, PanelRow, Scale, TimeFigure};
pub use views::{Body, Named, Point, ViewFigure};

/// The largest width and height of a figure, in pixels of a screen. A PNG has [`png::SCALE`] pixels for each of
/// them, each way.
pub const MOST: f64 = 4000.0;

/// The most cells or dots of one panel that are drawn one by one. More of them become an image.
pub const MOST_SHAPES: usize = 5000;

/// A figure does not fit in the size that it should be drawn in.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{panels} panels need at least {}x{}, and nothing is larger than {MOST}x{MOST}",
    needed.width,
    needed.height
)]
pub struct TooSmall {
    /// The smallest size that the figure fits in.
    pub needed: Size,
    /// The number of panels of the figure.
    pub panels: usize,
}
