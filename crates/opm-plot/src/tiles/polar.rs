//! Tilts in all directions: cells in polar form, the direction around and the tilt from the middle outwards.

use super::cells::{Cells, Paint};
use super::{Tile, cross};
use crate::axis::{Axis, Tick, label};
use crate::color::{Color, GRID, INK, WHITE};
use crate::drawing::{Anchor, Image, Path, Pen, Rect, Shape, Step};
use crate::font::CAPITALS;
use crate::frame::{BELOW, Frame, NAME, TICK};
use std::f64::consts::TAU;

/// The room around the outermost circle for the numbers of directions, as a share of its radius.
const AROUND: f64 = 0.17;
/// The largest number of circles.
const CIRCLES: usize = 4;
/// The number of directions with a line, and of those with a number.
const SPOKES: usize = 12;
const NUMBERED: usize = 4;
/// The direction along which the numbers of the circles stand, as a share of a turn: between two lines.
const ALONG: f64 = 0.125;
/// The largest piece of an arc that is drawn straight, as a share of a turn.
const PIECE: f64 = 1.0 / 180.0;
/// The pixels across an image of cells.
const FINE: u32 = 900;

/// Cells whose first value is a direction and whose second one is a tilt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polar<'a> {
    pub cells: &'a Cells,
    /// A whole turn, in the unit of the direction.
    pub turn: f64,
}

impl Polar<'_> {
    /// The range of both axes of a box that holds cells up to this tilt.
    pub fn range(most: f64) -> [f64; 2] {
        let radius = (1.0 + AROUND) * most.max(f64::MIN_POSITIVE);
        [-radius, radius]
    }

    /// The place of a direction and a tilt.
    fn at(&self, frame: &Frame<'_>, [direction, tilt]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (TAU * direction / self.turn).sin_cos();
        let tilt = tilt.max(0.0);
        frame.at(tilt * cos, tilt * sin)
    }

    /// The points of an arc behind its start.
    fn arc(&self, frame: &Frame<'_>, tilt: f64, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
        let pieces = ((to - from).abs() / (PIECE * self.turn)).ceil().max(1.0) as usize;
        let share = |i: usize| i as f64 / pieces as f64;
        (0..=pieces).map(|i| self.at(frame, [from + share(i) * (to - from), tilt])).collect()
    }

    /// The circles and lines, over the cells: these cover most of a tile.
    fn grid(&self, frame: &Frame<'_>, tilts: &Axis) -> Shape {
        let mut lines = Path::default();
        let most = tilts.range[1];
        for tick in tilts.ticks.iter().filter(|tick| tick.value > 0.0 && tick.value < most) {
            lines.0.extend(Path::through(self.arc(frame, tick.value, [0.0, self.turn])).0);
        }
        for i in 0..SPOKES {
            let direction = self.turn * i as f64 / SPOKES as f64;
            let ends = [0.0, most].map(|tilt| self.at(frame, [direction, tilt]));
            lines.0.extend(Path::through(ends).0);
        }
        Shape::Line(lines, Pen::new(GRID, 0.8))
    }

    /// The outermost circle and the numbers: those of the circles, and of the directions outside.
    fn border(
        &self,
        frame: &Frame<'_>,
        tilts: &Axis,
        directions: impl Fn(f64) -> String,
    ) -> Vec<Shape> {
        let most = tilts.range[1];
        let mut circle = Path::through(self.arc(frame, most, [0.0, self.turn]));
        circle.0.push(Step::Close);
        let mut numbers = Vec::new();
        for tick in tilts.ticks.iter().filter(|tick| tick.value > 0.0 && tick.value <= most) {
            let [x, y] = self.at(frame, [ALONG * self.turn, tick.value]);
            // On a ground of its own it is read over any colour.
            let (width, height) = (TICK.width(&tick.label) + 3.0, TICK.size);
            let ground = Rect { x, y: y - 0.5 * height, width, height };
            numbers.push(Shape::Area(Path::rect(ground), WHITE));
            let base = y + 0.5 * CAPITALS * TICK.size;
            numbers.push(TICK.text(&*tick.label, [x + 1.5, base], Anchor::Start));
        }
        for i in 0..NUMBERED {
            // From minus half a turn on, as ranges of angles are.
            let direction = self.turn * (i as f64 / NUMBERED as f64 - 0.25);
            let [x, y] = self.at(frame, [direction, most * (1.0 + 0.06)]);
            let (anchor, down) = match i {
                0 => (Anchor::Middle, 0.9 * TICK.size),
                1 => (Anchor::Start, 0.35 * TICK.size),
                2 => (Anchor::Middle, 0.0),
                _ => (Anchor::End, 0.35 * TICK.size),
            };
            numbers.push(TICK.text(directions(direction), [x, y + down], anchor));
        }
        let numbers = Shape::Group { kind: "polar-axes", label: String::new(), shapes: numbers };
        vec![Shape::Line(circle, Pen::new(INK, 0.8)), numbers]
    }

    /// The content of a tile.
    pub fn tile(&self, tile: &Tile, paint: &Paint, frame: &Frame<'_>) -> Vec<Shape> {
        let most = frame.x.range[1] / (1.0 + AROUND);
        let tilts = Axis::linear([0.0, most], tile.y.unit.steps, CIRCLES, |_, _| true);
        let title = tile.title.clone();
        let points = self.draw(frame, paint, most);
        let mut shapes = vec![
            Shape::Group { kind: "points", label: title, shapes: points },
            self.grid(frame, &tilts),
        ];
        if let Some(at) = tile.mark.filter(|at| at[1] <= most) {
            shapes.push(cross(self.at(frame, at)));
        }
        let axis =
            Axis::linear([-0.5, 0.5].map(|end| end * self.turn), tile.x.unit.steps, 8, |_, _| true);
        let number = |value: f64| {
            let same = |tick: &&Tick| (tick.value - value).abs() < 1e-9 * self.turn;
            axis.ticks.iter().find(same).map_or_else(|| label(value, 2), |tick| tick.label.clone())
        };
        shapes.extend(self.border(frame, &tilts, number));
        shapes
    }

    /// What is around and what is outwards, below a tile, if it fits there.
    pub fn named(&self, tile: &Tile, frame: &Frame<'_>) -> Option<Shape> {
        let Rect { x, width, .. } = frame.place;
        let [around, outwards] = [&tile.x, &tile.y].map(|measure| match &*measure.unit.symbol {
            "" => measure.name.clone(),
            symbol => format!("{} ({symbol})", measure.name),
        });
        let text = format!("{around} around, {outwards} outwards");
        let at = [x + 0.5 * width, frame.place.bottom() + BELOW - 16.0];
        let shapes = vec![NAME.text(&*text, at, Anchor::Middle)];
        (NAME.width(&text) <= width).then_some(Shape::Group { kind: "x-axis", label: text, shapes })
    }

    /// The cells that were hit, and the lines over them.
    fn draw(&self, frame: &Frame<'_>, paint: &Paint, most: f64) -> Vec<Shape> {
        let mut shapes = match paint {
            Paint::Plain(color) => vec![self.sectors(frame, *color)],
            Paint::Values(..) | Paint::Classes(_) => vec![self.image(frame, paint, most)],
        };
        shapes.extend(self.cells.lines_over(|line, closed| self.line(frame, line, closed)));
        shapes
    }

    /// The cells of one colour, with one sector for neighbours at a tilt.
    fn sectors(&self, frame: &Frame<'_>, color: Color) -> Shape {
        let mut path = Path::default();
        for [[from, to], [inner, outer]] in self.cells.runs() {
            // Cells at both ends of a whole turn overlap.
            let to = to.min(from + self.turn);
            let mut points = self.arc(frame, outer, [from, to]);
            points.extend(self.arc(frame, inner, [to, from]));
            path.0.extend(Path::through(points).0);
            path.0.push(Step::Close);
        }
        Shape::Area(path, color)
    }

    fn image(&self, frame: &Frame<'_>, paint: &Paint, most: f64) -> Shape {
        let [[left, top], [right, bottom]] = [frame.at(-most, most), frame.at(most, -most)];
        let place = Rect { x: left, y: top, width: right - left, height: bottom - top };
        let of = |i: u32| most * (2.0 * (f64::from(i) + 0.5) / f64::from(FINE) - 1.0);
        let pixel = |(row, column): (u32, u32)| {
            let (x, y) = (of(column), -of(row));
            let direction = y.atan2(x) * self.turn / TAU;
            let around = [0.0, 1.0, -1.0].map(|turns| direction + turns * self.turn);
            around.iter().find_map(|&direction| self.cells.color_at([direction, x.hypot(y)], paint))
        };
        let pixels = (0..FINE).flat_map(|row| (0..FINE).map(move |column| (row, column)));
        let pixels = pixels.map(pixel).collect();
        Shape::Image { place, image: Image { width: FINE, height: FINE, pixels } }
    }

    /// A line over the cells. Where it goes along the first or the last direction, there is no boundary: the cells go on beside.
    fn line(&self, frame: &Frame<'_>, line: &[[f64; 2]], closed: bool) -> Path {
        let mut path = Path::default();
        let ends = self.cells.first_range();
        let whole = ends[1] - ends[0] >= self.turn * (1.0 - 1e-9);
        let last = if closed { line.len() } else { line.len().saturating_sub(1) };
        for i in 0..last {
            let [a, b] = [line[i], line[(i + 1) % line.len()]];
            let near =
                |end: f64| [a, b].iter().all(|point| (point[0] - end).abs() < 1e-9 * self.turn);
            if whole && ends.iter().any(|&end| near(end)) {
                continue;
            }
            let pieces = ((b[0] - a[0]).abs() / (PIECE * self.turn)).ceil().max(1.0) as usize;
            let share = |k: usize| k as f64 / pieces as f64;
            let points = (0..=pieces)
                .map(|k| self.at(frame, [0, 1].map(|i| a[i] + share(k) * (b[i] - a[i]))));
            path.0.extend(Path::through(points).0);
        }
        path
    }
}
