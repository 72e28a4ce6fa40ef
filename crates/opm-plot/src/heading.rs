//! What stands above and below every figure.

use crate::color::{FAINT, INK};
use crate::drawing::{Anchor, Shape, Style};
use crate::font::Face;

const TITLE: Style = Style { size: 17.0, face: Face::Bold, color: INK };
const LINE: Style = Style { size: 12.0, face: Face::Regular, color: INK };
const NOTE: Style = Style { size: 11.0, face: Face::Regular, color: FAINT };
/// From the baseline of a line to that of the next, in sizes of the font.
const SPACING: f64 = 1.4;
/// Around the figure.
pub const MARGIN: f64 = 16.0;
/// Between the heading and the figure, and between the figure and its notes.
const GAP: f64 = 14.0;

/// What a figure is called and what is said about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heading {
    /// One line, cut where it is too long.
    pub title: String,
    /// Below the title, wrapped.
    pub lines: Vec<String>,
    /// Below the figure, wrapped.
    pub notes: Vec<String>,
}

impl Heading {
    /// How far down the heading goes in a figure of this width.
    pub fn top(&self, width: f64) -> f64 {
        let lines = wrapped(&self.lines, LINE, width).len() as f64;
        MARGIN + TITLE.size + lines * SPACING * LINE.size + GAP
    }

    /// How much room the notes take at the bottom of a figure of this width.
    pub fn bottom(&self, width: f64) -> f64 {
        match wrapped(&self.notes, NOTE, width).len() {
            0 => MARGIN,
            lines => GAP + lines as f64 * SPACING * NOTE.size + MARGIN,
        }
    }

    /// Its texts; the notes start at `end`.
    pub fn draw(&self, width: f64, end: f64) -> Vec<Shape> {
        let title = TITLE.face.fit(&self.title, TITLE.size, width - 2.0 * MARGIN);
        let mut y = MARGIN + TITLE.size - 2.0;
        let mut shapes = vec![TITLE.text(title, [MARGIN, y], Anchor::Start)];
        for line in wrapped(&self.lines, LINE, width) {
            y += SPACING * LINE.size;
            shapes.push(LINE.text(line, [MARGIN, y], Anchor::Start));
        }
        let mut y = end + GAP - 3.0;
        for line in wrapped(&self.notes, NOTE, width) {
            y += SPACING * NOTE.size;
            shapes.push(NOTE.text(line, [MARGIN, y], Anchor::Start));
        }
        shapes
    }
}

fn wrapped(paragraphs: &[String], style: Style, width: f64) -> Vec<String> {
    let room = width - 2.0 * MARGIN;
    paragraphs.iter().flat_map(|text| style.face.wrap(text, style.size, room)).collect()
}
