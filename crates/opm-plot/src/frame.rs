//! A box with axes on two of its sides.

use crate::axis::{Axis, Tick};
use crate::color::{FAINT, GRID, INK};
use crate::drawing::{Anchor, Path, Pen, Rect, Shape, Style};
use crate::font::{CAPITALS, Face};

/// The style of numbers at ticks.
pub const TICK: Style = Style { size: 11.0, face: Face::Regular, color: FAINT };
/// The style of names of axes and curves.
pub const NAME: Style = Style { size: 12.0, face: Face::Regular, color: INK };
/// The style of titles of panels.
pub const TITLE: Style = Style { size: 12.5, face: Face::Bold, color: INK };

/// The length of a tick.
const TICK_LENGTH: f64 = 4.0;
/// The gap between a tick and its number.
const TICK_GAP: f64 = 3.0;
/// The least gap between two numbers.
const APART: f64 = 8.0;
/// The gap between the numbers of an axis and its name.
const NAME_GAP: f64 = 6.0;
/// The room below a horizontal axis for ticks and numbers.
pub const NUMBERS_BELOW: f64 = TICK_LENGTH + TICK_GAP + 11.0;
/// The room below a horizontal axis for ticks, numbers and its name.
pub const BELOW: f64 = NUMBERS_BELOW + NAME_GAP + 13.0;
/// The least distance between the ticks of a vertical axis.
const LINE_APART: f64 = 26.0;

/// The room to the left of a vertical axis for its numbers and, if it is `named`, its name.
pub fn left_of(axis: &Axis, named: bool) -> f64 {
    let name = if named { NAME_GAP + NAME.size + 2.0 } else { 0.0 };
    TICK_LENGTH + TICK_GAP + axis.label_width(TICK.face, TICK.size) + name
}

/// The largest number of ticks of a vertical axis of this height.
pub fn ticks_in(height: f64) -> usize {
    ((height / LINE_APART) as usize).clamp(2, 8)
}

/// Tells whether the numbers of a horizontal axis of this length keep apart.
pub fn fits(length: f64) -> impl Fn(&[Tick], f64) -> bool {
    move |ticks, step| {
        let widest = ticks.iter().map(|tick| TICK.width(&tick.label)).fold(0.0, f64::max);
        widest + APART <= step * length
    }
}

/// A box and the axes along its sides.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The box.
    pub place: Rect,
    /// The axis from left to right.
    pub x: &'a Axis,
    /// The axis from bottom to top.
    pub y: &'a Axis,
}

impl Frame<'_> {
    /// The point of two values.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.across(x), self.up(y)]
    }

    /// The horizontal place of a value.
    pub fn across(&self, x: f64) -> f64 {
        self.place.x + self.place.width * self.x.share(x)
    }

    /// The vertical place of a value.
    pub fn up(&self, y: f64) -> f64 {
        self.place.bottom() - self.place.height * self.y.share(y)
    }

    /// The lines through the ticks, to be drawn first.
    pub fn grid(&self) -> Shape {
        let Rect { x: left, y: top, .. } = self.place;
        let (right, bottom) = (self.place.right(), self.place.bottom());
        let mut lines = Path::default();
        for tick in &self.x.ticks {
            let x = self.across(tick.value);
            lines.0.extend(Path::through([[x, top], [x, bottom]]).0);
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.value);
            lines.0.extend(Path::through([[left, y], [right, y]]).0);
        }
        Shape::Line(lines, Pen::new(GRID, 0.8))
    }

    /// The box itself and its ticks, to be drawn over its content.
    pub fn border(&self) -> Vec<Shape> {
        let Rect { x: left, .. } = self.place;
        let bottom = self.place.bottom();
        let mut ticks = Path::default();
        for tick in &self.x.ticks {
            let x = self.across(tick.value);
            ticks.0.extend(Path::through([[x, bottom], [x, bottom + TICK_LENGTH]]).0);
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.value);
            ticks.0.extend(Path::through([[left - TICK_LENGTH, y], [left, y]]).0);
        }
        let pen = Pen::new(INK, 0.8);
        vec![Shape::Line(Path::rect(self.place), pen), Shape::Line(ticks, pen)]
    }

    /// The numbers of the horizontal axis, and its name.
    pub fn below(&self, name: Option<&str>) -> Shape {
        let numbers = self.place.bottom() + TICK_LENGTH + TICK_GAP + TICK.size * CAPITALS;
        let number = |tick: &Tick| {
            TICK.text(&*tick.label, [self.across(tick.value), numbers], Anchor::Middle)
        };
        let mut shapes: Vec<Shape> = self.x.ticks.iter().map(number).collect();
        if let Some(name) = name {
            let middle = self.place.x + 0.5 * self.place.width;
            let line = self.place.bottom() + BELOW - 3.0;
            shapes.push(NAME.text(name, [middle, line], Anchor::Middle));
        }
        Shape::Group { kind: "x-axis", label: name.unwrap_or_default().to_owned(), shapes }
    }

    /// The numbers of the vertical axis, and its name at the left of the room that they have.
    pub fn beside(&self, name: Option<&str>, room: f64) -> Shape {
        let edge = self.place.x - TICK_LENGTH - TICK_GAP;
        let half = 0.5 * TICK.size * CAPITALS;
        let number =
            |tick: &Tick| TICK.text(&*tick.label, [edge, self.up(tick.value) + half], Anchor::End);
        let mut shapes: Vec<Shape> = self.y.ticks.iter().map(number).collect();
        if let Some(name) = name {
            let middle = self.place.y + 0.5 * self.place.height;
            let line = self.place.x - room + NAME.size;
            shapes.push(NAME.turned(name, [line, middle], Anchor::Middle));
        }
        Shape::Group { kind: "y-axis", label: name.unwrap_or_default().to_owned(), shapes }
    }

    /// The name above the box, on the left.
    pub fn title(&self, title: &str) -> Shape {
        let room = self.place.width;
        let text = TITLE.face.fit(title, TITLE.size, room);
        TITLE.text(text, [self.place.x, self.place.y - 6.0], Anchor::Start)
    }
}
