//! A picture as a list of shapes. Every figure is laid out as one, and every format is written from one.
//!
//! Coordinates are in pixels of a screen (96 to the inch), x to the right and y down.

use crate::color::Color;
use crate::font::{Face, LONGEST, shortened};
use crate::{pdf, png, svg};
use std::io;

/// A size, in pixels of a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// The width.
    pub width: f64,
    /// The height.
    pub height: f64,
}

/// A picture.
///
/// ```
/// use opm_plot::drawing::{Drawing, Path, Rect, Shape, Size};
///
/// let square = Path::rect(Rect { x: 10.0, y: 10.0, width: 80.0, height: 80.0 });
/// let drawing = Drawing {
///     size: Size { width: 100.0, height: 100.0 },
///     title: "A blue square".into(),
///     shapes: vec![Shape::Area(square, opm_plot::color::DOT)],
/// };
/// assert!(drawing.to_svg()?.contains("A blue square"));
/// assert!(drawing.to_png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), opm_plot::png::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// The size.
    pub size: Size,
    /// The title, which programs read that describe pictures to the blind.
    pub title: String,
    /// The shapes; later ones cover earlier ones.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// The drawing as an SVG file.
    ///
    /// # Errors
    /// An image in it cannot be encoded.
    pub fn to_svg(&self) -> Result<String, png::Error> {
        svg::write(self)
    }

    /// The drawing as a PNG file, with [`png::SCALE`] pixels for one of a screen each way.
    ///
    /// # Errors
    /// [`png::Error::Size`] if there is no memory for so many pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, png::Error> {
        png::write(self)
    }

    /// The drawing as a PDF file, one page of the drawing's size.
    ///
    /// # Errors
    /// The bytes cannot be compressed.
    pub fn to_pdf(&self) -> io::Result<Vec<u8>> {
        pdf::write(self)
    }
}

/// A shape in a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An area of one colour.
    Area(Path, Color),
    /// A line.
    Line(Path, Pen),
    /// A text on one line.
    Text(Text),
    /// A raster, stretched to a box.
    Image {
        /// The box that it fills.
        place: Rect,
        /// The raster.
        image: Image,
    },
    /// Shapes that belong together for the reader.
    Group {
        /// The kind of group, one word: for instance `panel` or `curve`.
        kind: &'static str,
        /// The name of this group among those of its kind.
        label: String,
        /// The shapes.
        shapes: Vec<Shape>,
    },
}

/// The look of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// The colour.
    pub color: Color,
    /// The width, in pixels.
    pub width: f64,
    /// The lengths of strokes and gaps, in pixels; empty for a line without gaps.
    pub dashes: &'static [f64],
}

impl Pen {
    /// A line without gaps.
    pub const fn new(color: Color, width: f64) -> Self {
        Self { color, width, dashes: &[] }
    }
}

/// A text on one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The text itself.
    pub text: String,
    /// The anchor's place on its baseline.
    pub at: [f64; 2],
    /// The part of the text that is there.
    pub anchor: Anchor,
    /// The size of the font, in pixels.
    pub size: f64,
    /// The font.
    pub face: Face,
    /// The colour.
    pub color: Color,
    /// Whether it is read from bottom to top.
    pub turned: bool,
}

impl Text {
    /// The start of its baseline.
    pub fn start(&self) -> [f64; 2] {
        let share = match self.anchor {
            Anchor::Start => return self.at,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let before = share * self.face.width(&self.text, self.size);
        let [x, y] = self.at;
        if self.turned { [x, y + before] } else { [x - before, y] }
    }
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The left side.
    pub x: f64,
    /// The upper side.
    pub y: f64,
    /// The width.
    pub width: f64,
    /// The height.
    pub height: f64,
}

impl Rect {
    /// The right side.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// The lower side.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// A raster of opaque pixels, the first row on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The colour of every pixel, row by row; `None` is transparent.
    pub pixels: Vec<Option<Color>>,
}

/// A path of straight lines, in one piece or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path(pub Vec<Step>);

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Starts a piece at a point.
    Move([f64; 2]),
    /// Goes on to a point in a straight line.
    Line([f64; 2]),
    /// Goes back to the start of the piece.
    Close,
}

impl Path {
    /// The path through these points, in one piece.
    pub fn through(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut path = Self::default();
        for (number, point) in points.into_iter().enumerate() {
            path.0.push(if number == 0 { Step::Move(point) } else { Step::Line(point) });
        }
        path
    }

    /// The path around a box.
    pub fn rect(rect: Rect) -> Self {
        let mut path = Self::default();
        path.add_rect(rect);
        path
    }

    /// Adds the piece around a box.
    pub fn add_rect(&mut self, rect: Rect) {
        let (left, top, right, bottom) = (rect.x, rect.y, rect.right(), rect.bottom());
        self.0.extend([
            Step::Move([left, top]),
            Step::Line([right, top]),
            Step::Line([right, bottom]),
            Step::Line([left, bottom]),
            Step::Close,
        ]);
    }

    /// Adds a dot: a regular octagon as large as a circle of this radius.
    pub fn add_dot(&mut self, [x, y]: [f64; 2], radius: f64) {
        use std::f64::consts::FRAC_PI_8;
        /// Area of a circle over that of an octagon whose corners are on it, rooted.
        const GROWN: f64 = 1.0539;
        for k in 0..8 {
            let (sin, cos) = (FRAC_PI_8 * f64::from(2 * k + 1)).sin_cos();
            let point = [x + GROWN * radius * cos, y + GROWN * radius * sin];
            self.0.push(if k == 0 { Step::Move(point) } else { Step::Line(point) });
        }
        self.0.push(Step::Close);
    }
}

/// The part of a text that is at a given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The start of the text.
    Start,
    /// The middle of the text.
    Middle,
    /// The end of the text.
    End,
}

/// The look of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// The size of the font, in pixels.
    pub size: f64,
    /// The font.
    pub face: Face,
    /// The colour.
    pub color: Color,
}

impl Style {
    /// The width of a text, in pixels.
    pub fn width(&self, text: &str) -> f64 {
        self.face.width(&shortened(text, LONGEST), self.size)
    }

    /// A text from left to right, with the anchor of its baseline at a point.
    pub fn text(&self, text: impl Into<String>, at: [f64; 2], anchor: Anchor) -> Shape {
        self.shape(&text.into(), at, anchor, false)
    }

    /// A text from bottom to top, with the anchor of its baseline, which is on its right, at a point.
    pub fn turned(&self, text: impl Into<String>, at: [f64; 2], anchor: Anchor) -> Shape {
        self.shape(&text.into(), at, anchor, true)
    }

    fn shape(&self, text: &str, at: [f64; 2], anchor: Anchor, turned: bool) -> Shape {
        let Self { size, face, color } = *self;
        let text = shortened(text, LONGEST).into_owned();
        Shape::Text(Text { text, at, anchor, size, face, color, turned })
    }
}
