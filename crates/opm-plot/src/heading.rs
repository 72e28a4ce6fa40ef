//! The texts above and below every figure.

use crate::color::{FAINT, INK};
use crate::drawing::{Anchor, Shape, Style};
use crate::font::Face;

const TITLE: Style = Style { size: 17.0, face: Face::Bold, color: INK };
const LINE: Style = Style { size: 12.0, face: Face::Regular, color: INK };
const NOTE: Style = Style { size: 11.0, face: Face::Regular, color: FAINT };
/// The distance between baselines, in sizes of the font.
const SPACING: f64 = 1.4;
/// The margin around the figure.
pub const MARGIN: f64 = 16.0;
/// The gap between the heading and the figure, and between the figure and its notes.
const GAP: f64 = 14.0;

/// The texts of a figure: its title, lines below the title, and notes below the figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heading {
    /// The title, which is wrapped.
    pub title: String,
    /// The lines below the title, which are wrapped. Lines are not broken at no-break spaces.
    pub lines: Vec<String>,
    /// The notes below the figure, which are wrapped.
    pub notes: Vec<String>,
}

impl Heading {
    /// The room that the heading takes at the top of a figure of this width, in pixels.
    pub fn top(&self, width: f64) -> f64 {
        let titles = self.titles(width).len().max(1) as f64;
        let lines = wrapped(&self.lines, LINE, width).len() as f64;
        let title = TITLE.size + (titles - 1.0) * SPACING * TITLE.size;
        MARGIN + title + lines * SPACING * LINE.size + GAP
    }

    /// The room that the notes take at the bottom of a figure of this width, in pixels.
    pub fn bottom(&self, width: f64) -> f64 {
        match wrapped(&self.notes, NOTE, width).len() {
            0 => MARGIN,
            lines => GAP + lines as f64 * SPACING * NOTE.size + MARGIN,
        }
    }

    /// The texts as shapes, in a figure of this width. The notes start at the height `end`.
    pub fn draw(&self, width: f64, end: f64) -> Vec<Shape> {
        let mut y = MARGIN + TITLE.size - 2.0;
        let mut shapes = Vec::new();
        for (number, title) in self.titles(width).into_iter().enumerate() {
            y += if number > 0 { SPACING * TITLE.size } else { 0.0 };
            shapes.push(TITLE.text(title, [MARGIN, y], Anchor::Start));
        }
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

    fn titles(&self, width: f64) -> Vec<String> {
        wrapped(std::slice::from_ref(&self.title), TITLE, width)
    }
}

fn wrapped(paragraphs: &[String], style: Style, width: f64) -> Vec<String> {
    let room = width - 2.0 * MARGIN;
    paragraphs.iter().flat_map(|text| style.face.wrap(text, style.size, room)).collect()
}
