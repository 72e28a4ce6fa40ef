//! Names beside the places that they belong to, clear of each other and of the solids as far as possible.

use super::Named;
use super::camera::Camera;
use crate::color::{FAINT, INK};
use crate::drawing::{Anchor, Path, Pen, Rect, Shape, Step, Style};
use crate::font::{CAPITALS, Face, label, shortened};
use std::f64::consts::TAU;

const STYLE: Style = Style { size: 10.0, face: Face::Regular, color: INK };
/// The height of a label, from the top of its capitals to the end of its descenders, in sizes of the font.
const LINE: f64 = 1.0;
/// The longest label of several places, in characters.
const LONGEST: usize = 200;
/// Places that are nearer than this, in pixels, share one label.
const SAME: f64 = 4.0;
/// The distances of a label from its place that are tried, and the number of directions.
const DISTANCES: [f64; 5] = [9.0, 16.0, 26.0, 38.0, 54.0];
const DIRECTIONS: usize = 16;
/// The side of a cell in which it is known whether anything is drawn.
const CELL: f64 = 5.0;
/// The cost of lying over another label, and outside of the view, against that of lying over a cell with a solid.
const OVER_LABEL: f64 = 60.0;
const OUTSIDE: f64 = 400.0;
/// The cost of a pixel of distance.
const FAR: f64 = 0.25;

/// The labels of some places.
pub fn names(names: &[Named], camera: &Camera, solids: &[Shape], view: Rect) -> Vec<Shape> {
    let mut groups: Vec<([f64; 2], String)> = Vec::new();
    for named in names {
        let at = camera.see(named.at).at;
        let near = |other: &[f64; 2]| (other[0] - at[0]).hypot(other[1] - at[1]) < SAME;
        match groups.iter_mut().find(|(other, _)| near(other)) {
            Some((_, text)) => {
                text.push_str(", ");
                text.push_str(&label(&named.name));
            }
            None => groups.push((at, label(&named.name).into_owned())),
        }
    }
    let drawn = Drawn::new(solids, view);
    let mut taken: Vec<Rect> = Vec::new();
    let mut shapes = Vec::new();
    for (at, text) in groups {
        let text = shortened(&text, LONGEST);
        let size = [STYLE.width(&text), STYLE.size * LINE];
        let mut best =
            (f64::INFINITY, Rect { x: at[0], y: at[1], width: size[0], height: size[1] });
        for distance in DISTANCES {
            for direction in 0..DIRECTIONS {
                let (sin, cos) = (TAU * direction as f64 / DIRECTIONS as f64).sin_cos();
                // The nearest point of the label's box is at the distance.
                let x = at[0] + distance * cos - size[0] * 0.5 * (1.0 - cos);
                let y = at[1] - distance * sin - size[1] * 0.5 * (1.0 + sin);
                let place = Rect { x, y, width: size[0], height: size[1] };
                let over = taken.iter().filter(|other| overlap(&place, other)).count() as f64;
                let cost = drawn.under(&place)
                    + OVER_LABEL * over
                    + if within(&place, &view) { 0.0 } else { OUTSIDE }
                    + FAR * distance;
                if cost < best.0 {
                    best = (cost, place);
                }
            }
        }
        let place = best.1;
        let nearest = [at[0].clamp(place.x, place.right()), at[1].clamp(place.y, place.bottom())];
        if (nearest[0] - at[0]).hypot(nearest[1] - at[1]) > DISTANCES[0] + 1.0 {
            shapes.push(Shape::Line(Path::through([at, nearest]), Pen::new(FAINT, 0.6)));
        }
        let baseline = place.bottom() - STYLE.size * (LINE - CAPITALS);
        shapes.push(STYLE.text(text, [place.x, baseline], Anchor::Start));
        taken.push(place);
    }
    shapes
}

fn overlap(a: &Rect, b: &Rect) -> bool {
    const GAP: f64 = 2.0;
    a.x < b.right() + GAP
        && b.x < a.right() + GAP
        && a.y < b.bottom() + GAP
        && b.y < a.bottom() + GAP
}

fn within(a: &Rect, view: &Rect) -> bool {
    a.x >= view.x && a.right() <= view.right() && a.y >= view.y && a.bottom() <= view.bottom()
}

/// The cells of a view in which a solid is drawn.
struct Drawn {
    view: Rect,
    columns: usize,
    cells: Vec<bool>,
}

impl Drawn {
    fn new(solids: &[Shape], view: Rect) -> Self {
        let [columns, rows] =
            [view.width, view.height].map(|side| (side / CELL).ceil().max(1.0) as usize);
        let mut drawn = Self { view, columns, cells: vec![false; columns * rows] };
        for shape in solids {
            if let Shape::Area(path, _) = shape {
                drawn.add(path);
            }
        }
        drawn
    }

    /// Marks the cells that a convex path comes near to. Those are the cells whose middle is inside of it, or not much farther
    /// out of any of its sides.
    fn add(&mut self, path: &Path) {
        let corners = path.0.iter().filter_map(|step| match step {
            Step::Move(point) | Step::Line(point) => Some(*point),
            Step::Close => None,
        });
        let corners: Vec<[f64; 2]> = corners.collect();
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for point in &corners {
            for (range, value) in range.iter_mut().zip(point) {
                *range = [range[0].min(*value), range[1].max(*value)];
            }
        }
        let [[left, right], [top, bottom]] = range;
        let place = Rect { x: left, y: top, width: right - left, height: bottom - top };
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let doubled: f64 = (0..corners.len())
            .map(|i| corners[i][0] * next(i)[1] - corners[i][1] * next(i)[0])
            .sum();
        for cell in self.cells_of(&place) {
            let [column, row] = [cell % self.columns, cell / self.columns].map(|n| n as f64 + 0.5);
            let [x, y] = [self.view.x + CELL * column, self.view.y + CELL * row];
            let near = (0..corners.len()).all(|i| {
                let ([ax, ay], [bx, by]) = (corners[i], next(i));
                let inward = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) * doubled.signum();
                inward >= -0.7 * CELL * (bx - ax).hypot(by - ay)
            });
            self.cells[cell] |= near;
        }
    }

    fn cells_of(&self, place: &Rect) -> Vec<usize> {
        let rows = self.cells.len() / self.columns;
        let range = |low: f64, high: f64, start: f64, count: usize| {
            let cell = |value: f64| ((value - start) / CELL).floor();
            cell(low).max(0.0) as usize..(cell(high) + 1.0).clamp(0.0, count as f64) as usize
        };
        let across = range(place.x, place.right(), self.view.x, self.columns);
        let down = range(place.y, place.bottom(), self.view.y, rows);
        down.flat_map(|row| across.clone().map(move |column| row * self.columns + column)).collect()
    }

    /// The number of cells under a label in which a solid is drawn.
    fn under(&self, place: &Rect) -> f64 {
        self.cells_of(place).into_iter().filter(|&cell| self.cells[cell]).count() as f64
    }
}
