//! The legend of a section's classes: a box and a name for each, in lines.

use crate::color::{Color, INK};
use crate::drawing::{Anchor, Path, Pen, Rect, Shape};
use crate::font::{CAPITALS, label};
use crate::frame::TICK;

/// The side of a box, the gap behind it, and the gap between entries.
const BOX: f64 = 11.0;
const BEHIND: f64 = 6.0;
const BETWEEN: f64 = 20.0;
/// The height of a line.
const LINE: f64 = 19.0;
/// The room above the first line.
const ABOVE: f64 = 6.0;

/// Entries in lines that fit a width.
pub(super) struct Legend<'a> {
    lines: Vec<Vec<(f64, &'a (String, Color))>>,
}

impl<'a> Legend<'a> {
    pub fn new(entries: &'a [(String, Color)], room: f64) -> Self {
        let mut lines: Vec<Vec<(f64, &(String, Color))>> = vec![];
        let mut x = 0.0;
        for entry in entries {
            let width = BOX + BEHIND + TICK.width(&label(&entry.0));
            if x > 0.0 && x + width > room || lines.is_empty() {
                lines.push(vec![]);
                x = 0.0;
            }
            if let Some(line) = lines.last_mut() {
                line.push((x, entry));
            }
            x += width + BETWEEN;
        }
        Self { lines }
    }

    /// Its height, with the room above it.
    pub fn height(&self) -> f64 {
        if self.lines.is_empty() { 0.0 } else { ABOVE + LINE * self.lines.len() as f64 }
    }

    /// The legend, from this corner down.
    pub fn draw(&self, [left, top]: [f64; 2]) -> Shape {
        let mut shapes = vec![];
        for (number, line) in self.lines.iter().enumerate() {
            let y = top + ABOVE + LINE * number as f64;
            for (x, (name, color)) in line {
                let place = Rect { x: left + x, y, width: BOX, height: BOX };
                shapes.push(Shape::Area(Path::rect(place), *color));
                shapes.push(Shape::Line(Path::rect(place), Pen::new(INK, 0.8)));
                let base = y + 0.5 * (BOX + CAPITALS * TICK.size);
                shapes.push(TICK.text(label(name), [place.right() + BEHIND, base], Anchor::Start));
            }
        }
        Shape::Group { kind: "legend", label: String::new(), shapes }
    }
}
