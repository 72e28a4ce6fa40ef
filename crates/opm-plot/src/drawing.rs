//! A picture as a list of shapes: what every figure is drawn into, and every format written from.
//!
//! Coordinates are in pixels of a screen (96 to the inch), x to the right and y down.

use crate::color::Color;
use crate::font::Face;

/// Width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// From left to right.
    pub width: f64,
    /// From top to bottom.
    pub height: f64,
}

/// A picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Its size.
    pub size: Size,
    /// What it is called by programs that read pictures aloud.
    pub title: String,
    /// What is on it; later shapes cover earlier ones.
    pub shapes: Vec<Shape>,
}

/// One thing in a picture.
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
        /// The box.
        place: Rect,
        /// The raster.
        image: Image,
    },
    /// Shapes that are one thing to the reader.
    Group {
        /// What kind of thing: a word.
        kind: &'static str,
        /// Which one.
        label: String,
        /// Its shapes.
        shapes: Vec<Shape>,
    },
}

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Its colour.
    pub color: Color,
    /// Its width.
    pub width: f64,
    /// Lengths of strokes and gaps; nothing is a line without gaps.
    pub dashes: &'static [f64],
}

impl Pen {
    /// A line without gaps.
    pub const fn new(color: Color, width: f64) -> Self {
        Self { color, width, dashes: &[] }
    }
}

/// A text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// What it says.
    pub text: String,
    /// Where its baseline starts.
    pub at: [f64; 2],
    /// The font's size.
    pub size: f64,
    /// The font.
    pub face: Face,
    /// Its colour.
    pub color: Color,
    /// Read from bottom to top.
    pub turned: bool,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left side.
    pub x: f64,
    /// Upper side.
    pub y: f64,
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
}

impl Rect {
    /// Right side.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// Lower side.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// A raster of opaque pixels, the first row on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue of every pixel, row by row; `None` lets the ground be seen.
    pub pixels: Vec<Option<Color>>,
}

/// Straight lines, in one piece or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path(pub Vec<Step>);

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Starts a piece.
    Move([f64; 2]),
    /// Goes on.
    Line([f64; 2]),
    /// Back to where the piece started.
    Close,
}

impl Path {
    /// Through these points.
    pub fn through(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut path = Self::default();
        for (number, point) in points.into_iter().enumerate() {
            path.0.push(if number == 0 { Step::Move(point) } else { Step::Line(point) });
        }
        path
    }

    /// Around a box.
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

/// Which part of a text is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a text is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// The font's size.
    pub size: f64,
    /// The font.
    pub face: Face,
    /// Its colour.
    pub color: Color,
}

impl Style {
    /// How wide a text is.
    pub fn width(&self, text: &str) -> f64 {
        self.face.width(text, self.size)
    }

    /// A text on the baseline `at`.
    pub fn text(&self, text: impl Into<String>, [x, y]: [f64; 2], anchor: Anchor) -> Shape {
        let text = text.into();
        let x = x - self.before(&text, anchor);
        self.shape(text, [x, y], false)
    }

    /// A text from bottom to top, its baseline to the right of it.
    pub fn turned(&self, text: impl Into<String>, [x, y]: [f64; 2], anchor: Anchor) -> Shape {
        let text = text.into();
        let y = y + self.before(&text, anchor);
        self.shape(text, [x, y], true)
    }

    fn before(&self, text: &str, anchor: Anchor) -> f64 {
        match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * self.width(text),
            Anchor::End => self.width(text),
        }
    }

    fn shape(&self, text: String, at: [f64; 2], turned: bool) -> Shape {
        let Self { size, face, color } = *self;
        Shape::Text(Text { text, at, size, face, color, turned })
    }
}
