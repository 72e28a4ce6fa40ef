//! Cells of a plane grid that have something in them.

use crate::MOST_SHAPES;
use crate::color::{ALARM, Color, INK, Map, WHITE};
use crate::drawing::{Image, Path, Pen, Rect, Shape, Step};
use crate::frame::Frame;

/// The most cells in a row or column. On a finer grid, several values share a cell.
const MOST_CELLS: usize = 600;
/// The number of pixels in a row or column of an image: two for a pixel of the screen, so that it makes no
/// difference whether a program smoothes images.
const FINE: usize = 1200;

/// Equally spaced values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// The first value.
    pub first: f64,
    /// The distance from one value to the next.
    pub step: f64,
    /// The number of values.
    pub count: usize,
}

impl Spacing {
    /// `count` values from `first` to `last`.
    pub fn between([first, last]: [f64; 2], count: usize) -> Self {
        let step = (last - first) / count.saturating_sub(1).max(1) as f64;
        // A single value gets a cell of a tenth of its size.
        let step = if step > 0.0 { step } else { (0.1 * first.abs()).max(1.0) };
        Self { first, step, count }
    }

    /// The number of the nearest value; `None` outside the range, or for NaN.
    pub fn nearest(&self, value: f64) -> Option<usize> {
        let number = ((value - self.first) / self.step).round();
        (number >= 0.0 && number < self.count as f64).then_some(number as usize)
    }

    /// Value number `i`, from 0 on.
    pub fn value(&self, i: usize) -> f64 {
        self.first + self.step * i as f64
    }
}

/// The cells of a plane grid that were hit by points. [`TileFigure`](crate::TileFigure) has an example.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    spacing: [Spacing; 2],
    /// The number of grid values that share a cell, along both axes.
    together: [usize; 2],
    cells: [usize; 2],
    counts: Vec<u32>,
    values: CellValues,
    /// Closed lines over the cells.
    lines: Vec<Vec<[f64; 2]>>,
    /// Closed lines over the cells that stand out.
    inside: Vec<Vec<[f64; 2]>>,
    /// Open lines over the cells that stand out.
    curves: Vec<Vec<[f64; 2]>>,
}

/// The values that colour cells.
#[derive(Clone, Debug, PartialEq)]
enum CellValues {
    None,
    /// The sum over the hits of each cell.
    Sums(Vec<f64>),
    /// The class of each cell: the first one if its hits have several.
    Classes(Vec<usize>),
}

/// The colours of cells.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// All cells have this colour.
    Plain(Color),
    /// The colour of a cell shows the mean of its values, between the two ends.
    Values(Map, [f64; 2]),
    /// The colour of a cell is that of its class, by number. The first class is that of several.
    Classes(Vec<Color>),
}

impl Cells {
    /// Cells of which none was hit, and which will be drawn in one colour.
    pub fn plain(x: Spacing, y: Spacing) -> Self {
        let together = [x, y].map(|s| s.count.div_ceil(MOST_CELLS).max(1));
        let cells = [x.count.div_ceil(together[0]), y.count.div_ceil(together[1])];
        let counts = vec![0; cells[0] * cells[1]];
        let values = CellValues::None;
        Self {
            spacing: [x, y],
            together,
            cells,
            counts,
            values,
            lines: vec![],
            inside: vec![],
            curves: vec![],
        }
    }

    /// Cells of which none was hit, and which will be coloured by the values of the hits.
    pub fn with_values(x: Spacing, y: Spacing) -> Self {
        let plain = Self::plain(x, y);
        Self { values: CellValues::Sums(vec![0.0; plain.counts.len()]), ..plain }
    }

    /// Cells of which none was hit, and whose hits have whole numbers as values: their classes.
    pub fn with_classes(x: Spacing, y: Spacing) -> Self {
        let plain = Self::plain(x, y);
        Self { values: CellValues::Classes(vec![0; plain.counts.len()]), ..plain }
    }

    /// Adds a hit to the cell of the nearest grid values. A point outside the grid hits no cell.
    pub fn push(&mut self, x: f64, y: f64, value: f64) {
        let [Some(i), Some(j)] = [self.spacing[0].nearest(x), self.spacing[1].nearest(y)] else {
            return;
        };
        let cell = j / self.together[1] * self.cells[0] + i / self.together[0];
        match &mut self.values {
            CellValues::None => {}
            CellValues::Sums(sums) => sums[cell] += value,
            CellValues::Classes(classes) => {
                // A cast saturates.
                let class = value.round() as usize;
                let same = self.counts[cell] == 0 || classes[cell] == class;
                classes[cell] = if same { class } else { 0 };
            }
        }
        self.counts[cell] = self.counts[cell].saturating_add(1);
    }

    /// Whether several values of the grid share a cell.
    pub fn is_coarse(&self) -> bool {
        self.together != [1, 1]
    }

    /// Whether each point of the grid was hit, row by row; `None` if several points share a cell.
    pub fn hits(&self) -> Option<Vec<bool>> {
        (!self.is_coarse()).then(|| self.counts.iter().map(|&count| count > 0).collect())
    }

    /// The class of each point of the grid, row by row, `None` where none was hit. There are no classes if several points
    /// share a cell.
    pub fn classes(&self) -> Option<Vec<Option<usize>>> {
        let CellValues::Classes(classes) = &self.values else { return None };
        let hits = self.counts.iter().zip(classes);
        let class = |(&count, &class): (&u32, &usize)| (count > 0).then_some(class);
        (!self.is_coarse()).then(|| hits.map(class).collect())
    }

    /// Sets closed lines to be drawn over the cells: the boundary of what was hit, in the units of the axes.
    pub fn surround(&mut self, lines: Vec<Vec<[f64; 2]>>) {
        self.lines = lines;
    }

    /// Adds a closed line that stands out over the cells, in the units of the axes: a shape inside of what was hit.
    pub fn inscribe(&mut self, line: Vec<[f64; 2]>) {
        self.inside.push(line);
    }

    /// Adds lines that stand out over the cells, in the units of the axes. They are not closed.
    pub fn trace(&mut self, lines: Vec<Vec<[f64; 2]>>) {
        self.curves.extend(lines);
    }

    /// The edges of the cells that were hit: left and right, lower and upper; `None` if no cell was hit.
    pub fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let [[i0, i1], [j0, j1]] = self.hit()?;
        Some([[self.edge(0, i0), self.edge(0, i1 + 1)], [self.edge(1, j0), self.edge(1, j1 + 1)]])
    }

    /// The first and the last column, and the first and the last row, with a hit.
    fn hit(&self) -> Option<[[usize; 2]; 2]> {
        let width = self.cells[0];
        let hits = || (0..self.counts.len()).filter(|&cell| self.counts[cell] > 0);
        let column = |cell: usize| cell % width;
        let [first, last] = [hits().next()? / width, hits().next_back()? / width];
        let columns = [hits().map(column).min()?, hits().map(column).max()?];
        Some([columns, [first, last]])
    }

    /// The edge at which cell number `i` of an axis begins. If values share cells, the last cell may be
    /// narrower.
    fn edge(&self, axis: usize, i: usize) -> f64 {
        let spacing = self.spacing[axis];
        let value = (i * self.together[axis]).min(spacing.count);
        spacing.first + spacing.step * (value as f64 - 0.5)
    }

    /// The cells that were hit.
    pub(crate) fn draw(&self, frame: &Frame<'_>, paint: &Paint) -> Vec<Shape> {
        let Some(hit) = self.hit() else { return vec![] };
        let mut shapes = match paint {
            Paint::Plain(color) => match self.outline(frame) {
                Some(path) => vec![Shape::Area(path, *color)],
                None => vec![self.image(frame, hit, paint)],
            },
            Paint::Values(..) | Paint::Classes(_) => vec![self.image(frame, hit, paint)],
        };
        shapes.extend(self.lines_over(|line, closed| {
            let mut path = Path::through(line.iter().map(|&[x, y]| frame.at(x, y)));
            if closed {
                path.0.push(Step::Close);
            }
            path
        }));
        shapes
    }

    /// The lines over the cells, each drawn as a path by `draw`, which is told whether it is closed.
    pub(super) fn lines_over(&self, draw: impl Fn(&[[f64; 2]], bool) -> Path) -> Vec<Shape> {
        let mut shapes = Vec::new();
        // Two lines each, which are seen on every background.
        let all = [
            (&self.lines, INK, 1.1, true),
            (&self.inside, ALARM, 2.2, true),
            (&self.curves, ALARM, 1.6, false),
        ];
        for (lines, color, width, closed) in all {
            let steps: Vec<Step> = lines.iter().flat_map(|line| draw(line, closed).0).collect();
            if steps.is_empty() {
                continue;
            }
            let path = Path(steps);
            shapes.push(Shape::Line(path.clone(), Pen::new(WHITE, width + 1.5)));
            shapes.push(Shape::Line(path, Pen::new(color, width)));
        }
        shapes
    }

    /// The edges of cells that were hit, along both axes, with one for neighbours in a row.
    pub(super) fn runs(&self) -> Vec<[[f64; 2]; 2]> {
        let mut found = Vec::new();
        for (j, row) in self.counts.chunks(self.cells[0]).enumerate() {
            let mut start = 0;
            for run in row.chunk_by(|a, b| (*a > 0) == (*b > 0)) {
                let end = start + run.len();
                if run[0] > 0 {
                    let ends = [(0, [start, end]), (1, [j, j + 1])];
                    found.push(ends.map(|(axis, ends)| ends.map(|i| self.edge(axis, i))));
                }
                start = end;
            }
        }
        found
    }

    /// The colour at a point; `None` outside of what was hit.
    pub(super) fn color_at(&self, at: [f64; 2], paint: &Paint) -> Option<Color> {
        let [i, j] = [0, 1].map(|axis| self.spacing[axis].nearest(at[axis]));
        self.color(j? / self.together[1] * self.cells[0] + i? / self.together[0], paint)
    }

    /// The first and the last value along the first axis.
    pub(super) fn first_range(&self) -> [f64; 2] {
        let spacing = self.spacing[0];
        [spacing.first, spacing.value(spacing.count.saturating_sub(1))]
    }

    /// The cells as boxes, with one box for neighbours in a row; `None` if there are too many.
    fn outline(&self, frame: &Frame<'_>) -> Option<Path> {
        let mut path = Path::default();
        let mut boxes = 0;
        for (j, row) in self.counts.chunks(self.cells[0]).enumerate() {
            let mut start = 0;
            for run in row.chunk_by(|a, b| (*a > 0) == (*b > 0)) {
                let end = start + run.len();
                if run[0] > 0 {
                    boxes += 1;
                    if boxes > MOST_SHAPES {
                        return None;
                    }
                    path.add_rect(self.place(frame, [start, end], [j, j + 1]));
                }
                start = end;
            }
        }
        Some(path)
    }

    /// The box around cells from `i0` up to, not including, `i1`, and in the same way for rows.
    fn place(&self, frame: &Frame<'_>, [i0, i1]: [usize; 2], [j0, j1]: [usize; 2]) -> Rect {
        let [x, bottom] = frame.at(self.edge(0, i0), self.edge(1, j0));
        let [right, y] = frame.at(self.edge(0, i1), self.edge(1, j1));
        Rect { x, y, width: right - x, height: bottom - y }
    }

    fn image(&self, frame: &Frame<'_>, hit: [[usize; 2]; 2], paint: &Paint) -> Shape {
        let [[i0, i1], [j0, j1]] = hit;
        let fine = |cells: usize| (FINE / cells).max(1);
        let [columns, rows] = [i1 + 1 - i0, j1 + 1 - j0];
        let [across, up] = [fine(columns), fine(rows)];
        let mut pixels = Vec::with_capacity(columns * across * rows * up);
        for j in (j0..=j1).rev() {
            let row = (i0..=i1).flat_map(|i| {
                let color = self.color(j * self.cells[0] + i, paint);
                std::iter::repeat_n(color, across)
            });
            let row: Vec<Option<Color>> = row.collect();
            (0..up).for_each(|_| pixels.extend_from_slice(&row));
        }
        let image = Image { width: (columns * across) as u32, height: (rows * up) as u32, pixels };
        Shape::Image { place: self.place(frame, [i0, i1 + 1], [j0, j1 + 1]), image }
    }

    fn color(&self, cell: usize, paint: &Paint) -> Option<Color> {
        let count = self.counts[cell];
        if count == 0 {
            return None;
        }
        Some(match (paint, &self.values) {
            (Paint::Values(map, [low, high]), CellValues::Sums(sums)) => {
                let mean = sums[cell] / f64::from(count);
                map.color((mean - low) / (high - low).max(f64::MIN_POSITIVE))
            }
            (Paint::Values(map, _), _) => map.color(0.0),
            (Paint::Classes(colors), CellValues::Classes(classes)) => {
                colors.get(classes[cell]).copied().unwrap_or(INK)
            }
            (Paint::Classes(colors), _) => colors.first().copied().unwrap_or(INK),
            (Paint::Plain(color), _) => *color,
        })
    }
}
