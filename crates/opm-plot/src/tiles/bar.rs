//! The legend of a section's colours.

use super::Measure;
use crate::axis::{self, Axis};
use crate::color::{INK, Map};
use crate::drawing::{Anchor, Path, Pen, Rect, Shape};
use crate::font::CAPITALS;
use crate::frame::{NAME, NUMBERS_BELOW, TICK, ticks_in};
use crate::time::Scale;

/// The legend of a section's colours: a bar from the lowest value to the highest.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// The meaning of the values.
    pub measure: Measure,
    /// The values at the two ends.
    pub range: [f64; 2],
    /// The colours.
    pub map: Map,
    /// How values are laid out along the bar.
    pub scale: Scale,
}

/// The width of the colours.
const BAR: f64 = 14.0;

impl Bar {
    fn axis(&self, height: f64) -> Axis {
        match self.scale {
            Scale::Linear => {
                let range = if self.range[0] < self.range[1] {
                    self.range
                } else {
                    axis::around(Some(self.range), &self.measure.unit)
                };
                Axis::linear(range, self.measure.unit.steps, ticks_in(height), |_, _| true)
            }
            Scale::Logarithmic => Axis::logarithmic(self.range, ticks_in(height)),
        }
    }

    /// The width of the bar with its numbers and its name.
    pub(super) fn room(&self) -> f64 {
        BAR + 10.0 + self.axis(200.0).label_width(TICK.face, TICK.size) + 10.0 + NAME.size
    }

    /// The bar with its numbers, from this corner down.
    pub(super) fn draw(&self, [x, y]: [f64; 2], height: f64) -> Shape {
        const SHADES: usize = 64;
        let place = Rect { x, y, width: BAR, height };
        let axis = self.axis(height);
        let mut shapes = Vec::new();
        let piece = place.height / SHADES as f64;
        for i in 0..SHADES {
            let color = self.map.color((i as f64 + 0.5) / SHADES as f64);
            let y = place.bottom() - piece * (i + 1) as f64;
            // Pieces overlap a little, so that no background shows between them.
            let height = (piece + 0.5).min(place.bottom() - y);
            shapes.push(Shape::Area(Path::rect(Rect { y, height, ..place }), color));
        }
        let pen = Pen::new(INK, 0.8);
        shapes.push(Shape::Line(Path::rect(place), pen));
        let mut ticks = Path::default();
        for tick in &axis.ticks {
            let share = axis.share(tick.value);
            if !(0.0..=1.0).contains(&share) {
                continue;
            }
            let y = place.bottom() - share * place.height;
            ticks.0.extend(Path::through([[place.right(), y], [place.right() + 4.0, y]]).0);
            let half = 0.5 * CAPITALS * TICK.size;
            let at = [place.right() + 7.0, y + half];
            shapes.push(TICK.text(&*tick.label, at, Anchor::Start));
        }
        shapes.push(Shape::Line(ticks, pen));
        let name = axis.title(&self.measure.name, &self.measure.unit);
        let x =
            place.right() + 10.0 + axis.label_width(TICK.face, TICK.size) + 6.0 + NAME.size * 0.8;
        let middle = place.y + 0.5 * place.height;
        let room = place.height + NUMBERS_BELOW;
        let name = NAME.face.fit(&name, NAME.size, room);
        shapes.push(NAME.turned(name, [x, middle], Anchor::Middle));
        Shape::Group { kind: "bar", label: self.measure.name.clone(), shapes }
    }
}
