//! Figures of solids in space: from above, from the front, from the side, and in perspective.

mod camera;
mod label;
mod paint;

use crate::axis::{self, Axis, Unit};
use crate::color::Color;
use crate::drawing::{Anchor, Drawing, Path, Pen, Rect, Shape, Size};
use crate::font::label as short;
use crate::frame::{BELOW, Frame, NAME, TICK, TITLE, fits, left_of, ticks_in};
use crate::heading::{Heading, MARGIN};
use crate::{MOST, TooSmall};
use camera::Camera;

/// A point or a direction in space: x, y and z.
pub type Point = [f64; 3];

/// A figure of solids in space, drawn in four views.
///
/// ```
/// use opm_plot::{Body, Heading, Named, Steps, Unit, ViewFigure};
///
/// let blue = opm_plot::color::DOT;
/// let figure = ViewFigure {
///     heading: Heading { title: "A link".into(), ..Heading::default() },
///     unit: Unit { symbol: "mm".into(), steps: Steps::Decimal, resolution: 1e-6 },
///     bodies: vec![
///         (Body::Rod { from: [0.0; 3], to: [100.0, 40.0, 60.0], radius: 4.0 }, blue),
///         (Body::Ball { centre: [0.0; 3], radius: 9.0 }, blue),
///     ],
///     names: vec![Named { name: "joint".into(), at: [0.0; 3] }],
///     legend: vec![("link".into(), blue)],
/// };
/// assert!(figure.draw(None)?.to_svg()?.contains("in perspective"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ViewFigure {
    /// The texts above and below.
    pub heading: Heading,
    /// The unit of all lengths.
    pub unit: Unit,
    /// The solids, with their colours.
    pub bodies: Vec<(Body, Color)>,
    /// The places that have names.
    pub names: Vec<Named>,
    /// What the colours mean.
    pub legend: Vec<(String, Color)>,
}

/// A solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// A round rod between the centres of its ends.
    Rod {
        /// The centre of one end.
        from: Point,
        /// The centre of the other end.
        to: Point,
        /// The radius.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// The centre.
        centre: Point,
        /// The radius.
        radius: f64,
    },
    /// A block with a square cross-section.
    Block {
        /// The centre.
        centre: Point,
        /// The direction of its length, a unit vector.
        axis: Point,
        /// The length.
        length: f64,
        /// The width of the cross-section.
        width: f64,
    },
}

/// A place with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The place.
    pub at: Point,
}

/// The width of a figure whose size is not given, and the largest height of its views.
const WIDTH: f64 = 1000.0;
const HIGHEST: f64 = 860.0;
/// The least width and height of a view.
const LEAST: f64 = 80.0;
/// The room above a view for its title.
const ABOVE: f64 = 24.0;
/// The gap between two views, besides the numbers of the axes.
const BETWEEN: f64 = 26.0;
/// The room for a line of the legend, the distance of further lines, and the side of a colour in it.
const LEGEND: f64 = 22.0;
const LEGEND_LINE: f64 = 18.0;
const SWATCH: f64 = 11.0;
/// No extent is drawn shorter than this share of the longest one.
const SHORTEST: f64 = 0.45;

/// The sizes of everything in a figure.
struct Layout {
    size: Size,
    /// The room at the left of a view for its numbers.
    left: f64,
    /// The pixels of a unit of length.
    scale: f64,
    /// The ranges of x, y and z.
    ranges: [[f64; 2]; 3],
}

impl ViewFigure {
    /// Draws the figure in a given size, or in one that suits it.
    ///
    /// # Errors
    /// [`TooSmall`] if the views do not fit in the size.
    pub fn draw(&self, size: Option<Size>) -> Result<Drawing, TooSmall> {
        let layout = self.layout(size);
        let Layout { size: Size { width, height }, left, scale, ranges } = layout;
        let [x, y, z] = ranges.map(|[low, high]| (high - low) * scale);
        if x.min(y).min(z) < LEAST || width.max(height) > MOST {
            let least = self.layout(None);
            let shortest = least.ranges.map(|[low, high]| (high - low) * least.scale);
            let grow = LEAST / shortest.into_iter().fold(f64::MAX, f64::min);
            let needed = [least.size.width, least.size.height].map(|side| (side * grow).ceil());
            let needed = Size { width: needed[0], height: needed[1] };
            return Err(TooSmall { needed, panels: 4 });
        }
        let top = self.heading.top(width);
        let mut shapes = self.heading.draw(width, height - self.heading.bottom(width));
        shapes.push(self.draw_legend(top, width));
        let legend = self.legend_height(width);
        let columns = [MARGIN + left, MARGIN + left + x + BETWEEN + left];
        let rows = [top + legend + ABOVE, top + legend + ABOVE + y + BELOW + ABOVE];
        let place = |column: usize, row: usize, width, height| Rect {
            x: columns[column],
            y: rows[row],
            width,
            height,
        };
        // As on a drawing: the view from above is above that from the front, and the view from the right at its right.
        shapes.push(self.flat("from above", place(0, 0, x, y), [0, 1], ranges));
        shapes.push(self.flat("from the front", place(0, 1, x, z), [0, 2], ranges));
        shapes.push(self.flat("from the right", place(1, 1, y, z), [1, 2], ranges));
        shapes.push(self.perspective(place(1, 0, y, y), ranges));
        Ok(Drawing { size: Size { width, height }, title: self.heading.title.clone(), shapes })
    }

    fn layout(&self, size: Option<Size>) -> Layout {
        let ranges = self.ranges();
        let axis = |range| Axis::linear(range, self.unit.steps, 8, |_, _| true);
        let left = ranges[1..].iter().map(|&range| left_of(&axis(range), true)).fold(0.0, f64::max);
        let [x, y, z] = ranges.map(|[low, high]| high - low);
        let width = size.map_or(WIDTH, |size| size.width);
        let across = width - 2.0 * (MARGIN + left) - BETWEEN;
        let texts = |width: f64| {
            let heading = self.heading.top(width) + self.heading.bottom(width);
            heading + self.legend_height(width) + 2.0 * (ABOVE + BELOW)
        };
        let high = size.map_or(HIGHEST, |size| size.height - texts(width));
        let scale = (across / (x + y)).min(high / (y + z));
        let fitted = (width - across + scale * (x + y)).ceil();
        let fitted = Size { width: fitted, height: (texts(fitted) + scale * (y + z)).ceil() };
        Layout { size: size.unwrap_or(fitted), left, scale, ranges }
    }

    /// The ranges of x, y and z, none far shorter than the others.
    fn ranges(&self) -> [[f64; 2]; 3] {
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for (body, _) in &self.bodies {
            for (range, [low, high]) in ranges.iter_mut().zip(body.extent()) {
                *range = [range[0].min(low), range[1].max(high)];
            }
        }
        let ranges =
            ranges.map(|range| axis::around((range[0] <= range[1]).then_some(range), &self.unit));
        let longest = ranges.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        ranges.map(|[low, high]| {
            let lacking = (SHORTEST * longest - (high - low)).max(0.0);
            [low - 0.5 * lacking, high + 0.5 * lacking]
        })
    }

    /// Where each entry of the legend begins: how far from the left, and in which line.
    fn legend_places(&self, width: f64) -> Vec<(f64, usize)> {
        let (mut x, mut line) = (MARGIN, 0);
        let place = |(name, _): &(String, Color)| {
            let own = SWATCH + 5.0 + NAME.width(&short(name));
            if x > MARGIN && x + own > width - MARGIN {
                (x, line) = (MARGIN, line + 1);
            }
            let place = (x, line);
            x += own + 16.0;
            place
        };
        self.legend.iter().map(place).collect()
    }

    /// The room for the legend in a figure of this width.
    fn legend_height(&self, width: f64) -> f64 {
        let last = self.legend_places(width).last().map_or(0, |&(_, line)| line);
        LEGEND + last as f64 * LEGEND_LINE
    }

    fn draw_legend(&self, top: f64, width: f64) -> Shape {
        let mut shapes = Vec::new();
        for ((name, color), (x, line)) in self.legend.iter().zip(self.legend_places(width)) {
            let y = top + line as f64 * LEGEND_LINE;
            let swatch = Rect { x, y: y - SWATCH + 2.0, width: SWATCH, height: SWATCH };
            shapes.push(Shape::Area(Path::rect(swatch), *color));
            shapes.push(NAME.text(short(name), [x + SWATCH + 5.0, y], Anchor::Start));
        }
        Shape::Group { kind: "legend", label: String::new(), shapes }
    }

    /// A view along an axis, with the coordinates of these numbers across and up.
    fn flat(
        &self,
        title: &str,
        place: Rect,
        across_up: [usize; 2],
        ranges: [[f64; 2]; 3],
    ) -> Shape {
        let [across, up] = across_up;
        let most = (place.width / 44.0).clamp(2.0, 10.0) as usize;
        let steps = self.unit.steps;
        let x = Axis::linear(ranges[across], steps, most, fits(place.width));
        let y = Axis::linear(ranges[up], steps, ticks_in(place.height), |_, _| true);
        let frame = Frame { place, x: &x, y: &y };
        let camera = Camera::along_axis(across_up, &frame);
        let mut shapes = vec![frame.grid()];
        shapes.extend(self.content(&camera, place));
        shapes.extend(frame.border());
        let name = |axis: &Axis, i: usize| axis.title(["x", "y", "z"][i], &self.unit);
        shapes.push(frame.below(Some(&name(&x, across))));
        shapes.push(frame.beside(Some(&name(&y, up)), left_of(&y, true)));
        shapes.push(frame.title(title));
        Shape::Group { kind: "panel", label: title.to_owned(), shapes }
    }

    fn perspective(&self, place: Rect, ranges: [[f64; 2]; 3]) -> Shape {
        let title = "in perspective";
        let boxes = self.bodies.iter().map(|(body, _)| body.extent());
        let camera = Camera::in_perspective(ranges, boxes, place);
        let mut shapes: Vec<Shape> = self.content(&camera, place).collect();
        shapes.extend(triad(&camera, place));
        let at = [place.x, place.y - 6.0];
        shapes.push(TITLE.text(title, at, Anchor::Start));
        Shape::Group { kind: "panel", label: title.to_owned(), shapes }
    }

    /// The solids and the names.
    fn content(&self, camera: &Camera, place: Rect) -> impl Iterator<Item = Shape> {
        let solids = paint::solids(&self.bodies, camera);
        let names = label::names(&self.names, camera, &solids, place);
        let group = |kind, shapes| Shape::Group { kind, label: String::new(), shapes };
        [group("solids", solids), group("names", names)].into_iter()
    }
}

impl Body {
    /// The ranges of x, y and z.
    fn extent(&self) -> [[f64; 2]; 3] {
        std::array::from_fn(|i| match *self {
            // A disc of this radius reaches so far in the direction of the coordinate.
            Self::Rod { from, to, radius } => {
                let along: Point = std::array::from_fn(|k| to[k] - from[k]);
                let length = camera::dot(along, along).sqrt();
                let share = if length > 0.0 { along[i] / length } else { 0.0 };
                let reach = radius * (1.0 - share * share).max(0.0).sqrt();
                [from[i].min(to[i]) - reach, from[i].max(to[i]) + reach]
            }
            Self::Ball { centre, radius } => [centre[i] - radius, centre[i] + radius],
            Self::Block { centre, axis, length, width } => {
                let reach = 0.5 * (length * axis[i].abs() + width);
                [centre[i] - reach, centre[i] + reach]
            }
        })
    }
}

/// The directions of x, y and z, in the lower left corner of a view.
fn triad(camera: &Camera, place: Rect) -> Vec<Shape> {
    const LENGTH: f64 = 26.0;
    let corner = [place.x + 34.0, place.bottom() - 30.0];
    let mut shapes = Vec::new();
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        let [right, up] = camera.turned(std::array::from_fn(|k| f64::from(u8::from(k == i))));
        let end = |length: f64| [corner[0] + length * right, corner[1] - length * up];
        let line = Path::through([corner, end(LENGTH)]);
        shapes.push(Shape::Line(line, Pen::new(TICK.color, 1.2)));
        let [x, y] = end(LENGTH + 8.0);
        shapes.push(TICK.text(name, [x, y + 4.0], Anchor::Middle));
    }
    shapes
}
