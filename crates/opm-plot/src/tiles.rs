//! Figures of points in a plane: tiles side by side, in sections.

mod bar;
mod cells;
mod cloud;
mod histogram;
mod legend;
mod polar;

pub use bar::Bar;
pub use cells::{Cells, Paint, Spacing};
pub use cloud::Cloud;
pub use histogram::Histogram;

use crate::axis::{self, Axis, Steps, Unit};
use crate::color::Color;
use crate::color::{FAINT, INK, WHITE};
use crate::drawing::{Anchor, Drawing, Path, Pen, Rect, Shape, Size, Style};
use crate::font::{Face, label};
use crate::frame::{BELOW, Frame, NAME, TICK, fits, left_of, ticks_in};
use crate::heading::{Heading, MARGIN};
use crate::{MOST, TooSmall};
use cloud::Density;
use legend::Legend;
use polar::Polar;

/// A figure of tiles, in sections from top to bottom.
///
/// ```
/// use opm_plot::{
///     Cells, Content, Heading, Measure, Paint, Section, Spacing, Steps, Tile, TileFigure, Unit, color,
/// };
///
/// let grid = Spacing::between([-100.0, 100.0], 41);
/// let mut cells = Cells::plain(grid, grid);
/// for (x, y) in (0..41).flat_map(|i| (0..41).map(move |j| (grid.value(i), grid.value(j)))) {
///     if x * x + y * y <= 80.0 * 80.0 {
///         cells.push(x, y, 0.0);
///     }
/// }
/// let unit = Unit { symbol: "mm".into(), steps: Steps::Decimal, resolution: 1e-6 };
/// let axis = |name: &str| Measure { name: name.into(), unit: unit.clone() };
/// let tile = Tile {
///     title: "level".into(),
///     x: axis("x"),
///     y: axis("y"),
///     content: Content::Cells(cells, Paint::Plain(color::DOT)),
///     mark: Some([0.0, 0.0]),
/// };
/// let figure = TileFigure {
///     heading: Heading { title: "A workspace".into(), ..Heading::default() },
///     sections: vec![Section {
///         title: "Slices".into(),
///         columns: 3,
///         shared: true,
///         tiles: vec![tile],
///         bar: None,
///         legend: vec![],
///     }],
/// };
/// assert!(figure.draw(None)?.to_svg()?.contains("A workspace"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TileFigure {
    /// The texts above and below.
    pub heading: Heading,
    /// The sections, from top to bottom.
    pub sections: Vec<Section>,
}

/// A section of a figure: tiles that show the same kind of thing.
#[derive(Clone, Debug)]
pub struct Section {
    /// The title above it.
    pub title: String,
    /// The number of tiles in a row, if they are about as tall as wide. There are more tall tiles in a row.
    pub columns: usize,
    /// Whether all tiles have the same axes, which are then numbered at the outer sides only.
    pub shared: bool,
    /// The tiles, row by row.
    pub tiles: Vec<Tile>,
    /// The meaning of the colours, if they have one.
    pub bar: Option<Bar>,
    /// The meaning of the colours of classes.
    pub legend: Vec<(String, Color)>,
}

/// A tile: a box with points.
#[derive(Clone, Debug)]
pub struct Tile {
    /// The title above it, which may be empty.
    pub title: String,
    /// The axis from left to right.
    pub x: Measure,
    /// The axis from bottom to top.
    pub y: Measure,
    /// The content.
    pub content: Content,
    /// A point that is marked by a cross.
    pub mark: Option<[f64; 2]>,
}

/// The meaning of the values along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// The name of the values.
    pub name: String,
    /// The unit of the values.
    pub unit: Unit,
}

impl Measure {
    /// Time in seconds.
    pub fn time() -> Self {
        Self { name: "time".into(), unit: Unit { symbol: "s".into(), ..Unit::none() } }
    }

    /// The measure of an axis without values, if bars lie along the other axis.
    pub fn nothing() -> Self {
        Self { name: String::new(), unit: Unit { resolution: f64::INFINITY, ..Unit::none() } }
    }

    fn is_nothing(&self) -> bool {
        self.name.is_empty()
    }

    /// The measure of a number of things, which are called `name`.
    pub fn count(name: &str) -> Self {
        let unit = Unit { symbol: String::new(), steps: Steps::Decimal, resolution: 0.5 };
        Self { name: name.to_owned(), unit }
    }
}

/// The content of a tile.
#[derive(Clone, Debug)]
pub enum Content {
    /// Cells of a grid, and how they are coloured.
    Cells(Cells, Paint),
    /// The same where the first value is a direction and the second one a tilt: in polar form, with the tilt from the middle
    /// outwards. The number is a whole turn, in the unit of the direction.
    Polar(Cells, Paint, f64),
    /// Points anywhere in the plane.
    Cloud(Cloud),
    /// A histogram of values.
    Histogram(Histogram),
}

/// The largest width of a figure whose size is not given, and the least width.
const WIDTH: f64 = 1000.0;
const NARROW: f64 = 600.0;
/// The widest tile, and the widest histogram.
const WIDEST: f64 = 420.0;
const WIDEST_HISTOGRAM: f64 = 620.0;
/// The ratio of a tile's height to its width, if lengths do not decide it, and the largest ratio.
const FLAT: f64 = 0.72;
const FLAT_HISTOGRAM: f64 = 0.36;
const FLAT_BAR: f64 = 0.15;
const TALLEST: f64 = 1.05;
/// The largest ratio for tiles that are as wide as their lengths demand.
const TALLEST_SHARED: f64 = 2.0;
/// The least width and height of a tile, and what it may lack by rounding.
const LEAST: f64 = 60.0;
const ROUNDING: f64 = 1e-6;
/// The gap between columns.
const BETWEEN: f64 = 22.0;
/// The room above a tile, with a title and without.
const ABOVE: f64 = 20.0;
const ABOVE_BARE: f64 = 8.0;
/// The room above a section for its title, and the gap between sections.
const TITLE_ROOM: f64 = 20.0;
const SECTIONS_APART: f64 = 20.0;

const SECTION: Style = Style { size: 13.5, face: Face::Bold, color: INK };
const EMPTY: Style = Style { size: 12.0, face: Face::Regular, color: FAINT };

/// A section with all sizes known.
struct Laid<'a> {
    section: &'a Section,
    /// The number of tiles in a row.
    columns: usize,
    ranges: Vec<[[f64; 2]; 2]>,
    density: Density,
    /// The room left of the first column, and of each further one.
    left: [f64; 2],
    /// The room for the colours.
    bar: f64,
    legend: Legend<'a>,
    /// The size of a tile.
    width: f64,
    height: f64,
}

impl TileFigure {
    /// Draws the figure in a given size, or in one that suits it.
    ///
    /// # Errors
    /// [`TooSmall`] if the tiles do not fit in the size.
    pub fn draw(&self, size: Option<Size>) -> Result<Drawing, TooSmall> {
        let room = size.map_or(WIDTH, |size| size.width);
        let mut laid: Vec<Laid<'_>> = self.sections.iter().map(|s| Laid::new(s, room)).collect();
        let used = laid.iter().map(Laid::right).fold(NARROW, f64::max);
        let width = size.map_or(used.ceil(), |size| size.width);
        let between = SECTIONS_APART * laid.len().saturating_sub(1) as f64;
        let fixed = self.heading.top(width) + between + self.heading.bottom(width);
        let around: f64 = laid.iter().map(Laid::around).sum();
        let tiles: f64 = laid.iter().map(Laid::tiles).sum();
        let height = size.map_or((fixed + around + tiles).ceil(), |size| size.height);
        // Tiles of the same shapes, smaller.
        let shrink = ((height - fixed - around) / tiles).min(1.0);
        for section in &mut laid {
            section.width *= shrink;
            section.height *= shrink;
        }
        let smallest = laid.iter().map(|s| s.width.min(s.height)).fold(f64::MAX, f64::min);
        if smallest < LEAST - ROUNDING || width < used - 1.0 || height > MOST || width > MOST {
            return Err(TooSmall { needed: self.least(), panels: self.panels() });
        }

        let mut shapes = self.heading.draw(width, height - self.heading.bottom(width));
        let mut y = self.heading.top(width);
        for section in &laid {
            shapes.push(section.draw(y));
            y += section.around() + section.tiles() + SECTIONS_APART;
        }
        Ok(Drawing { size: Size { width, height }, title: self.heading.title.clone(), shapes })
    }

    fn panels(&self) -> usize {
        self.sections.iter().map(|section| section.tiles.len()).sum()
    }

    /// The least size, or a little more.
    fn least(&self) -> Size {
        let laid: Vec<Laid<'_>> = self.sections.iter().map(|s| Laid::new(s, WIDTH)).collect();
        let grow = laid.iter().map(|s| LEAST / s.width.min(s.height)).fold(0.0, f64::max);
        let width = |s: &Laid<'_>| s.right() - s.columns as f64 * s.width * (1.0 - grow.min(1.0));
        let width = laid.iter().map(width).fold(NARROW, f64::max).ceil();
        let between = SECTIONS_APART * laid.len().saturating_sub(1) as f64;
        let fixed = self.heading.top(width) + between + self.heading.bottom(width);
        let height: f64 = laid.iter().map(|s| s.around() + s.tiles() * grow.min(1.0)).sum();
        Size { width, height: (fixed + height).ceil() }
    }
}

impl<'a> Laid<'a> {
    fn new(section: &'a Section, room: f64) -> Self {
        let ranges = section.ranges();
        let tile = section.tiles.first();
        let histogram = tile.is_some_and(|t| matches!(t.content, Content::Histogram(_)));
        let axis = |number: usize, named| {
            let y = Axis::linear(
                ranges[number][1],
                section.tiles[number].y.unit.steps,
                ticks_in(0.25 * room),
                |_, _| true,
            );
            left_of(&y, named) + 4.0
        };
        let widest = (0..ranges.len()).map(|i| axis(i, true)).fold(0.0, f64::max);
        let left = [widest, if section.shared { BETWEEN } else { widest + BETWEEN }];
        let bar = section.bar.as_ref().map_or(0.0, |bar| BETWEEN + bar.room());
        // Lengths, and angles, are as long one way as the other.
        let slope = |number: usize| {
            let ([x, y], tile) = (ranges[number], &section.tiles[number]);
            let polar = matches!(tile.content, Content::Polar(..));
            let same = !tile.x.unit.symbol.is_empty() && tile.x.unit.symbol == tile.y.unit.symbol;
            let same = same || polar;
            if tile.y.is_nothing() {
                FLAT_BAR
            } else if histogram {
                FLAT_HISTOGRAM
            } else if same {
                (y[1] - y[0]) / (x[1] - x[0])
            } else {
                FLAT
            }
        };
        let slopes: Vec<f64> = (0..ranges.len()).map(slope).collect();
        let steepest = slopes.iter().copied().fold(0.0, f64::max).max(0.15);
        // There are more tall tiles in a row.
        let columns = match section.shared && steepest > TALLEST {
            true => (section.columns as f64 * steepest).round() as usize,
            false => section.columns,
        };
        // Rows of about the same length.
        let tiles = section.tiles.len().max(1);
        let columns = tiles.div_ceil(tiles.div_ceil(columns.clamp(1, tiles)));
        let between = left[1] * (columns - 1) as f64;
        let free = room - 2.0 * MARGIN - left[0] - between - bar;
        let most = if histogram { WIDEST_HISTOGRAM } else { WIDEST };
        let width = (free / columns as f64).clamp(1.0, most);
        let tallest = if section.shared { TALLEST_SHARED } else { TALLEST };
        let height = width * steepest.min(tallest);
        let width = if section.shared { height / steepest } else { width };
        let density = section.density();
        // No figure is narrower, unless its size is given.
        let legend = Legend::new(&section.legend, room.min(NARROW) - 2.0 * MARGIN);
        Self { section, columns, ranges, density, left, bar, legend, width, height }
    }

    fn rows(&self) -> usize {
        self.section.tiles.len().div_ceil(self.columns)
    }

    /// The width of the tiles with their numbers.
    fn across(&self) -> f64 {
        let columns = self.columns as f64;
        self.left[0] + self.left[1] * (columns - 1.0) + columns * self.width
    }

    fn right(&self) -> f64 {
        let title = SECTION.width(&label(&self.section.title));
        MARGIN + title.max(self.across() + self.bar) + MARGIN
    }

    /// The height of the tiles alone.
    fn tiles(&self) -> f64 {
        self.rows() as f64 * self.height
    }

    fn above(&self) -> f64 {
        let titled = self.section.tiles.iter().any(|tile| !tile.title.is_empty());
        if titled { ABOVE } else { ABOVE_BARE }
    }

    /// The room below a row that is not the last.
    fn below(&self) -> f64 {
        if self.section.shared { 8.0 } else { BELOW }
    }

    /// The height of everything except the tiles.
    fn around(&self) -> f64 {
        let rows = self.rows() as f64;
        let between = (rows - 1.0).max(0.0) * self.below();
        TITLE_ROOM + rows * self.above() + between + BELOW + self.legend.height()
    }

    fn draw(&self, top: f64) -> Shape {
        let section = self.section;
        let title = SECTION.text(label(&section.title), [MARGIN, top + 11.0], Anchor::Start);
        let mut shapes = vec![title];
        let start = top + TITLE_ROOM;
        for (number, tile) in section.tiles.iter().enumerate() {
            let (row, column) = (number / self.columns, number % self.columns);
            let x = MARGIN + self.left[0] + column as f64 * (self.width + self.left[1]);
            let step = self.above() + self.height + self.below();
            let y = start + row as f64 * step + self.above();
            let lowest = number + self.columns >= section.tiles.len();
            let sides =
                Sides { left: column == 0 || !section.shared, below: lowest || !section.shared };
            let place = Rect { x, y, width: self.width, height: self.height };
            shapes.push(self.tile(tile, self.ranges[number], place, sides));
        }
        if let Some(bar) = &section.bar {
            let x = MARGIN + self.across() + BETWEEN;
            let height = (self.tiles()
                + (self.rows() as f64 - 1.0) * (self.above() + self.below()))
            .min(320.0);
            shapes.push(bar.draw([x, start + self.above()], height));
        }
        let below = top + self.around() + self.tiles() - self.legend.height();
        shapes.push(self.legend.draw([MARGIN, below]));
        Shape::Group { kind: "section", label: section.title.clone(), shapes }
    }

    fn tile(&self, tile: &Tile, range: [[f64; 2]; 2], place: Rect, sides: Sides) -> Shape {
        let [x, y] = range;
        let most = (place.width / 44.0).clamp(2.0, 10.0) as usize;
        let mut x = Axis::linear(x, tile.x.unit.steps, most, fits(place.width));
        let mut y = Axis::linear(y, tile.y.unit.steps, ticks_in(place.height), |_, _| true);
        if tile.y.is_nothing() {
            y.ticks.clear();
        }
        // Tiles of the other shapes in the section keep theirs inside the common box.
        let half = 0.5 * self.left[1] - 1.0;
        let [low, high] = x.range;
        for tick in &mut x.ticks {
            // Numbers of neighbours keep apart.
            let at = place.x + place.width * (tick.value - low) / (high - low);
            let wide = 0.5 * TICK.width(&tick.label);
            if at - wide < place.x - half || at + wide > place.right() + half {
                tick.label.clear();
            }
        }
        let frame = Frame { place, x: &x, y: &y };
        if let Content::Polar(cells, paint, turn) = &tile.content {
            let polar = Polar { cells, turn: *turn };
            let mut shapes = polar.tile(tile, paint, &frame);
            if sides.below {
                shapes.extend(polar.named(tile, &frame));
            }
            shapes.extend(above(tile, place));
            let label = tile.title.clone();
            return Shape::Group { kind: "panel", label, shapes };
        }
        let mut shapes = vec![frame.grid()];
        let content = match &tile.content {
            Content::Polar(..) => vec![],
            Content::Cells(cells, paint) => cells.draw(&frame, paint),
            Content::Cloud(cloud) => cloud.draw(&frame, self.density),
            Content::Histogram(histogram) => histogram.draw(&frame),
        };
        if tile.content.extent().is_none() {
            let middle = [place.x + 0.5 * place.width, place.y + 0.5 * place.height];
            shapes.push(EMPTY.text("no poses", middle, Anchor::Middle));
        }
        shapes.push(Shape::Group { kind: "points", label: tile.title.clone(), shapes: content });
        if let Some([a, b]) = tile.mark
            && (0.0..=1.0).contains(&x.share(a))
            && (0.0..=1.0).contains(&y.share(b))
        {
            shapes.push(cross(frame.at(a, b)));
        }
        shapes.extend(frame.border());
        let name = y.title(&tile.y.name, &tile.y.unit);
        if sides.left && !tile.y.is_nothing() {
            shapes.push(frame.beside(Some(&name), left_of(&y, true)));
        }
        let name = x.title(&tile.x.name, &tile.x.unit);
        if sides.below {
            shapes.push(frame.below(Some(&name)));
        }
        shapes.extend(above(tile, place));
        let label = match &*tile.title {
            "" if tile.y.is_nothing() => tile.x.name.clone(),
            "" => format!("{} over {}", tile.y.name, tile.x.name),
            title => title.to_owned(),
        };
        Shape::Group { kind: "panel", label, shapes }
    }
}

/// The title above a tile.
fn above(tile: &Tile, place: Rect) -> Option<Shape> {
    let middle = [place.x + 0.5 * place.width, place.y - 6.0];
    let text = NAME.face.fit(&tile.title, NAME.size, place.width + BETWEEN);
    (!tile.title.is_empty()).then(|| NAME.text(text, middle, Anchor::Middle))
}

/// The sides at which a tile has numbers.
#[derive(Clone, Copy)]
struct Sides {
    left: bool,
    below: bool,
}

impl Section {
    /// The largest number of points in one place of any cloud that is not drawn as dots; 1 without such a
    /// cloud. It is the upper end of the colours.
    pub fn densest(&self) -> u64 {
        self.density().most
    }

    fn density(&self) -> Density {
        let clouds = || {
            self.tiles.iter().filter_map(|tile| match &tile.content {
                Content::Cloud(cloud) if !cloud.has_dots() => Some(cloud),
                _ => None,
            })
        };
        let pool = clouds().map(Cloud::pool).max().unwrap_or(1);
        let most = clouds().flat_map(|cloud| cloud.pools(pool)).max().unwrap_or(1);
        Density { pool, most }
    }

    /// The ranges of both axes of every tile.
    fn ranges(&self) -> Vec<[[f64; 2]; 2]> {
        let union = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let extents: Vec<_> = self.tiles.iter().map(|tile| tile.content.extent()).collect();
        let all = extents.iter().copied().flatten();
        let all = all.reduce(|a, b| [union(a[0], b[0]), union(a[1], b[1])]);
        let of = |(tile, extent): (&Tile, Option<[[f64; 2]; 2]>)| {
            let extent = if self.shared { all } else { extent };
            let [x, y] = [(&tile.x, 0), (&tile.y, 1)]
                .map(|(measure, i)| axis::around(extent.map(|e| e[i]), &measure.unit));
            match tile.content {
                // Bars stand on the axis.
                Content::Histogram(_) => [x, [0.0, y[1]]],
                Content::Polar(..) => extent.unwrap_or([[-1.0, 1.0]; 2]),
                _ => [x, y],
            }
        };
        self.tiles.iter().zip(extents).map(of).collect()
    }
}

impl Content {
    /// The ranges of the content along both axes; `None` if there is nothing to draw.
    pub fn extent(&self) -> Option<[[f64; 2]; 2]> {
        match self {
            Self::Cells(cells, _) => cells.extent(),
            Self::Polar(cells, ..) => cells.extent().map(|[_, tilts]| [Polar::range(tilts[1]); 2]),
            Self::Cloud(cloud) => cloud.extent(),
            Self::Histogram(histogram) => histogram.extent(),
        }
    }
}

/// A cross that is seen on every background.
fn cross([x, y]: [f64; 2]) -> Shape {
    const ARM: f64 = 5.0;
    let mut path = Path::through([[x - ARM, y], [x + ARM, y]]);
    path.0.extend(Path::through([[x, y - ARM], [x, y + ARM]]).0);
    let shapes = vec![
        Shape::Line(path.clone(), Pen::new(WHITE, 3.4)),
        Shape::Line(path, Pen::new(INK, 1.3)),
    ];
    Shape::Group { kind: "mark", label: String::new(), shapes }
}
