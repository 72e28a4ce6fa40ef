//! Figures of curves over time, or over another value: panels below each other, related ones side by side.

use crate::axis::{self, Axis, Unit};
use crate::color::{ALARM, INK, SHADE, line};
use crate::curve::Curve;
use crate::drawing::{Anchor, Drawing, Path, Pen, Rect, Shape, Size, Style};
use crate::font::{CAPITALS, Face};
use crate::frame::{BELOW, Frame, NAME, fits, left_of, ticks_in};
use crate::heading::{Heading, MARGIN};
use crate::{MOST, Measure, TooSmall};

/// A figure of curves over time, or over another value. The [crate] has an example.
#[derive(Clone, Debug)]
pub struct TimeFigure {
    /// The texts above and below.
    pub heading: Heading,
    /// What the curves are drawn over: its name and unit.
    pub over: Measure,
    /// The first and the last time, or the lowest and the highest of the other value.
    pub range: [f64; 2],
    /// The rows of panels, from top to bottom.
    pub rows: Vec<PanelRow>,
    /// Spans in which the values are not valid, which are shaded.
    pub invalid: Vec<[f64; 2]>,
    /// Places that are marked with their numbers, from 1 on, in ascending order.
    pub marks: Vec<f64>,
}

/// A row of panels whose curves have the same names: for instance values and their rates.
#[derive(Clone, Debug)]
pub struct PanelRow {
    /// The names of the curves, for the legend.
    pub names: Vec<String>,
    /// One panel for each column; `None` leaves a column empty.
    pub panels: Vec<Option<Panel>>,
}

/// A panel: a box with curves.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The title above it.
    pub title: String,
    /// The name of the values, for instance `angle`.
    pub name: String,
    /// The unit of the values.
    pub unit: Unit,
    /// How values are laid out along the vertical axis.
    pub scale: Scale,
    /// The curves, each with the number of its name in [`PanelRow::names`].
    pub curves: Vec<(usize, Curve)>,
    /// Limits of curves, by the number of the name: dashed lines, where they are no farther from the curves than these are high.
    pub limits: Vec<(usize, f64)>,
}

/// How values are laid out along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Values are laid out evenly.
    Linear,
    /// Values are laid out by their logarithms. Values that are not positive are left out.
    Logarithmic,
}

/// The height of a panel, if the figure's size is not given, and the least height.
const HEIGHT: f64 = 132.0;
const LEAST_HEIGHT: f64 = 64.0;
/// The width of a panel, by the number of columns, and the least width.
const WIDTHS: [f64; 3] = [640.0, 430.0, 370.0];
const LEAST_WIDTH: f64 = 140.0;
/// The room above a panel for its title.
const ABOVE: f64 = 22.0;
/// The room below a panel that has no numbers there.
const SPACE: f64 = 12.0;
/// The gap between columns.
const BETWEEN: f64 = 22.0;
/// In a legend: the distance between lines, the length of the piece of curve, the gap behind it.
const LINE: f64 = 17.0;
const SAMPLE: f64 = 26.0;
const BEHIND: f64 = 6.0;
/// The widest name in a legend.
const WIDEST: f64 = 170.0;
/// The room for the numbers of marks.
const MARKS: f64 = 14.0;

const MARK: Style = Style { size: 10.5, face: Face::Bold, color: ALARM };

/// The room beside the panels: left of every column, and for the legends.
struct Sides {
    left: Vec<f64>,
    legend: f64,
}

/// The place of a panel.
struct Spot {
    place: Rect,
    /// The room left of it.
    left: f64,
    /// Whether no panel is below it.
    ends: bool,
    /// Whether it is in the first row.
    first: bool,
}

impl TimeFigure {
    /// Draws the figure in a given size, or in one that suits it.
    ///
    /// # Errors
    /// [`TooSmall`] if the panels do not fit in the size.
    pub fn draw(&self, size: Option<Size>) -> Result<Drawing, TooSmall> {
        let columns = self.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1).max(1);
        let sides = self.sides(columns);
        let beside = MARGIN + sides.left.iter().sum::<f64>() + sides.legend + MARGIN;
        let beside = beside + BETWEEN * (columns - 1) as f64;
        let natural = beside + columns as f64 * WIDTHS[(columns - 1).min(WIDTHS.len() - 1)];
        let width = size.map_or(natural.ceil(), |size| size.width);
        let panel = (width - beside) / columns as f64;

        let least: Vec<f64> =
            self.rows.iter().map(|row| (row.names.len() as f64 * LINE).max(LEAST_HEIGHT)).collect();
        let between = ABOVE * self.rows.len() as f64
            + SPACE * self.rows.len().saturating_sub(1) as f64
            + self.strip()
            + BELOW;
        // Columns that end early have their numbers there.
        let early = self.early(columns) as f64 * (BELOW - SPACE);
        let fixed = self.heading.top(width) + between + early + self.heading.bottom(width);
        let natural: Vec<f64> = least.iter().map(|least| least.max(HEIGHT)).collect();
        let height = size.map_or((fixed + natural.iter().sum::<f64>()).ceil(), |size| size.height);
        let needed = Size {
            width: (beside + LEAST_WIDTH * columns as f64).ceil(),
            height: (fixed + least.iter().sum::<f64>()).ceil(),
        };
        if panel < LEAST_WIDTH || height < needed.height || height > MOST || width > MOST {
            return Err(TooSmall { needed, panels: self.panels() });
        }
        // Surplus or missing height is shared evenly, as far as the legends allow.
        let heights = share(height - fixed, &least, &natural);

        let mut shapes = self.heading.draw(width, height - self.heading.bottom(width));
        let mut y = self.heading.top(width) + self.strip();
        for (number, (row, height)) in self.rows.iter().zip(&heights).enumerate() {
            y += ABOVE;
            let mut x = MARGIN;
            let mut side = x;
            let mut last = false;
            for column in 0..columns {
                x += sides.left[column];
                if let Some(found) = row.panels.get(column).and_then(Option::as_ref) {
                    let place = Rect { x, y, width: panel, height: *height };
                    let (left, ends) = (sides.left[column], self.ends(number, column));
                    last |= ends && number + 1 < self.rows.len();
                    let spot = Spot { place, left, ends, first: number == 0 };
                    shapes.push(self.panel(found, row, &spot));
                    side = place.right();
                }
                x += panel + BETWEEN;
            }
            let at = [side + 2.0 * BEHIND, y];
            shapes.push(legend(&row.names, at, *height));
            y += height + if last { BELOW } else { SPACE };
        }
        Ok(Drawing { size: Size { width, height }, title: self.heading.title.clone(), shapes })
    }

    fn panels(&self) -> usize {
        self.rows.iter().flat_map(|row| &row.panels).flatten().count()
    }

    fn strip(&self) -> f64 {
        if self.marks.is_empty() { 0.0 } else { MARKS }
    }

    /// Whether no panel is below this one.
    fn ends(&self, row: usize, column: usize) -> bool {
        let below = self.rows[row + 1..].iter();
        below.flat_map(|row| row.panels.get(column)).all(Option::is_none)
    }

    /// The number of rows, without the last, in which a column ends.
    fn early(&self, columns: usize) -> usize {
        let rows = 0..self.rows.len().saturating_sub(1);
        let ends = |row: &usize| {
            (0..columns).any(|column| {
                self.rows[*row].panels.get(column).is_some_and(Option::is_some)
                    && self.ends(*row, column)
            })
        };
        rows.filter(ends).count()
    }

    /// The room for the numbers left of every column, and for the legends.
    fn sides(&self, columns: usize) -> Sides {
        // Numbers get no wider in panels of other heights than by a digit.
        let slack = TICK_SLACK;
        let of = |column: usize| {
            let panels = self.rows.iter().filter_map(|row| row.panels.get(column)?.as_ref());
            panels.map(|panel| left_of(&panel.axis(HEIGHT), true) + slack).fold(0.0, f64::max)
        };
        let names = self.rows.iter().flat_map(|row| &row.names);
        let widest = names.map(|name| NAME.width(name)).fold(0.0, f64::max).min(WIDEST);
        Sides {
            left: (0..columns).map(of).collect(),
            legend: 2.0 * BEHIND + SAMPLE + BEHIND + widest,
        }
    }

    fn panel(&self, panel: &Panel, row: &PanelRow, spot: &Spot) -> Shape {
        let Spot { place, left, ends, first } = *spot;
        let most = (place.width / 50.0) as usize;
        let x = Axis::linear(widened(self.range), self.over.unit.steps, most, fits(place.width));
        let y = panel.axis(place.height);
        let frame = Frame { place, x: &x, y: &y };
        let mut shapes = Vec::new();
        for span in &self.invalid {
            let [left, right] = span.map(|time| frame.across(time.clamp(x.range[0], x.range[1])));
            // A single sample has to be seen, too.
            let width = (right - left).max(1.5);
            let area = Path::rect(Rect { x: left, width, ..place });
            shapes.push(Shape::Area(area, SHADE));
        }
        shapes.push(frame.grid());
        for (number, curve) in &panel.curves {
            let (color, dashes) = line(*number);
            let pen = Pen { color, width: 1.8, dashes };
            let shapes_of = curve_shapes(curve, &frame, pen);
            let label = row.names.get(*number).cloned().unwrap_or_default();
            shapes.push(Shape::Group { kind: "curve", label, shapes: shapes_of });
        }
        shapes.extend(panel.limits(&frame));
        shapes.extend(self.marks(&frame, first));
        shapes.extend(frame.border());
        shapes.push(frame.beside(Some(&y.title(&panel.name, &panel.unit)), left));
        if ends {
            shapes.push(frame.below(Some(&x.title(&self.over.name, &self.over.unit))));
        }
        let raised = if first { self.strip() } else { 0.0 };
        let above = Rect { y: place.y - raised, ..place };
        shapes.push(Frame { place: above, ..frame }.title(&panel.title));
        Shape::Group { kind: "panel", label: panel.title.clone(), shapes }
    }

    fn marks(&self, frame: &Frame<'_>, numbered: bool) -> Vec<Shape> {
        const PEN: Pen = Pen { color: ALARM, width: 1.0, dashes: &[3.0, 2.0] };
        let mut shapes = Vec::new();
        let mut free = f64::MIN;
        for (number, &time) in self.marks.iter().enumerate() {
            let x = frame.across(time);
            let line = Path::through([[x, frame.place.y], [x, frame.place.bottom()]]);
            shapes.push(Shape::Line(line, PEN));
            let text = (number + 1).to_string();
            let width = MARK.width(&text);
            // Numbers that would run into each other are left out: the notes list all times.
            if numbered && x - 0.5 * width > free {
                shapes.push(MARK.text(text, [x, frame.place.y - 4.0], Anchor::Middle));
                free = x + 0.5 * width + 3.0;
            }
        }
        match shapes.is_empty() {
            true => shapes,
            false => vec![Shape::Group { kind: "marks", label: String::new(), shapes }],
        }
    }
}

const DECADE: f64 = 10.0;
/// The room for one more digit than the numbers were measured with.
const TICK_SLACK: f64 = 7.0;

/// The range of the horizontal axis: a single value gets one unit around it.
fn widened([start, end]: [f64; 2]) -> [f64; 2] {
    if end > start { [start, end] } else { [start - 0.5, start + 0.5] }
}

/// Divides `height` among rows: all get their least height first, then their natural height, then the rest.
fn share(height: f64, least: &[f64], natural: &[f64]) -> Vec<f64> {
    let [least_sum, natural_sum] = [least, natural].map(|heights| heights.iter().sum::<f64>());
    if height >= natural_sum {
        let more = (height - natural_sum) / natural.len().max(1) as f64;
        return natural.iter().map(|natural| natural + more).collect();
    }
    let part = (height - least_sum) / (natural_sum - least_sum).max(1e-9);
    least.iter().zip(natural).map(|(l, n)| l + part.max(0.0) * (n - l)).collect()
}

impl Panel {
    /// The range of the curves, and of the limits that are near.
    fn range(&self) -> Option<[f64; 2]> {
        let union = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let values = self.curves.iter().filter_map(|(_, curve)| curve.range()).reduce(union)?;
        let span = values[1] - values[0];
        let near = |limit: &f64| (values[0] - span..=values[1] + span).contains(limit);
        let limits = self.limits.iter().map(|(_, limit)| *limit).filter(near);
        Some(limits.fold(values, |range, limit| union(range, [limit; 2])))
    }

    /// The limits that are seen. One of several curves is neither's colour.
    fn limits(&self, frame: &Frame<'_>) -> Option<Shape> {
        const DASHES: &[f64] = &[5.0, 3.5];
        let mut shapes: Vec<Shape> = Vec::new();
        for (place, &(number, limit)) in self.limits.iter().enumerate() {
            let same = |other: &(usize, f64)| other.1 == limit;
            let [low, high] = frame.y.range;
            let seen = (low..=high).contains(&limit) && frame.y.holds(limit);
            if self.limits[..place].iter().any(same) || !seen {
                continue;
            }
            let shared = self.limits[place..].iter().filter(|other| same(other)).count() > 1;
            let color = if shared { INK } else { line(number).0 };
            let [x, y] = frame.at(frame.x.range[0], limit);
            let path = Path::through([[x, y], [frame.place.right(), y]]);
            shapes.push(Shape::Line(path, Pen { color, width: 1.1, dashes: DASHES }));
        }
        let label = String::new();
        (!shapes.is_empty()).then_some(Shape::Group { kind: "limits", label, shapes })
    }

    /// The vertical axis in a panel of this height.
    fn axis(&self, height: f64) -> Axis {
        let curves = self.curves.iter().map(|(_, curve)| curve);
        let values = self.range();
        let positive = curves.filter_map(Curve::smallest_positive).reduce(f64::min);
        let most = ticks_in(height);
        match (self.scale, values, positive) {
            // Within a power of ten, logarithms have no numbers to put at an axis.
            (Scale::Logarithmic, Some([_, high]), Some(low)) if high > DECADE * low => {
                Axis::logarithmic([low, high], most)
            }
            _ => Axis::linear(axis::around(values, &self.unit), self.unit.steps, most, |_, _| true),
        }
    }
}

/// The pieces of a curve between its gaps; a point alone becomes a dot.
fn curve_shapes(curve: &Curve, frame: &Frame<'_>, pen: Pen) -> Vec<Shape> {
    let mut lines = Path::default();
    let mut dots = Path::default();
    let drawn = |point: &[f64; 2]| point[0].is_finite() && frame.y.holds(point[1]);
    for piece in curve.points().chunk_by(|a, b| drawn(a) == drawn(b)) {
        let points = piece.iter().filter(|point| drawn(point));
        let points: Vec<[f64; 2]> = points.map(|[t, v]| frame.at(*t, *v)).collect();
        match &points[..] {
            [] => {}
            [one] => dots.add_dot(*one, 2.0),
            more => lines.0.extend(Path::through(more.iter().copied()).0),
        }
    }
    let mut shapes = Vec::new();
    if !lines.0.is_empty() {
        shapes.push(Shape::Line(lines, pen));
    }
    if !dots.0.is_empty() {
        shapes.push(Shape::Area(dots, pen.color));
    }
    shapes
}

/// The legend: names with a piece of their curves, in the middle of a panel's height.
fn legend(names: &[String], [x, top]: [f64; 2], height: f64) -> Shape {
    let mut y = top + 0.5 * (height - LINE * names.len() as f64) + 0.5 * LINE;
    let mut shapes = Vec::new();
    for (number, name) in names.iter().enumerate() {
        let (color, dashes) = line(number);
        let sample = Path::through([[x, y], [x + SAMPLE, y]]);
        shapes.push(Shape::Line(sample, Pen { color, width: 2.2, dashes }));
        let text = NAME.face.fit(name, NAME.size, WIDEST);
        let base = y + 0.5 * CAPITALS * NAME.size;
        shapes.push(NAME.text(text, [x + SAMPLE + BEHIND, base], Anchor::Start));
        y += LINE;
    }
    Shape::Group { kind: "legend", label: String::new(), shapes }
}
