//! The points of a message, put into the tiles that they are in.

use super::{Seen, Slices};
use crate::plot::grid::nearest;
use crate::plot::layout::ValueSource;
use opm_mcap::Cloud as Points;
use opm_mcap::rejected::{CAUSE, SLICE};
use opm_plot::Content;

/// The slices that points are in.
#[derive(Clone, Copy)]
pub enum In<'a> {
    /// All in one.
    Slice(u64),
    /// Each in its own.
    Slices(&'a [u64]),
}

impl Slices<'_> {
    /// Adds the points of a message, each of which has the number of its slice.
    pub fn add_rejected(&mut self, cloud: &Points<'_>) {
        // A cast saturates; a number that is none is slice zero.
        let slices: Option<Vec<u64>> =
            cloud.column(SLICE).map(|column| column.map(|number| number as u64).collect());
        self.add(cloud, slices.as_deref().map_or(In::Slice(0), In::Slices));
    }

    /// Adds the points of a message.
    pub fn add(&mut self, cloud: &Points<'_>, slice: In<'_>) {
        let mut tiles = std::mem::take(&mut self.tiles);
        let bar = self.is_bar();
        let [a, b] = &self.view;
        let value = |seen: &Seen| self.values(cloud, slice, seen.number);
        let (Some(x), Some(y)) = (value(a), value(b)) else {
            self.tiles = tiles;
            return;
        };
        let color = match (&self.causes, &self.color) {
            (Some(_), _) => Some((CAUSE, 1.0)),
            (None, color) => color.as_ref().map(|color| (&*color.field, color.factor)),
        };
        let color: Option<Vec<f64>> =
            color.and_then(|(field, factor)| Some(cloud.column(field)?.in_units_of(factor)));
        self.each(cloud, slice, self.varied, |point, value| {
            let Some((_, content)) = tiles.iter_mut().find(|tile| tile.0 == value) else { return };
            let x = x.get(point) / a.factor;
            let y = if bar { 0.0 } else { y.get(point) / b.factor };
            match content {
                Content::Cells(cells, _) | Content::Polar(cells, ..) => {
                    let value = color.as_ref().map_or(0.0, |color| color[point]);
                    cells.push(x, y, value);
                }
                Content::Cloud(cloud) => cloud.push(x, y),
                Content::Histogram(_) => {}
            }
        });
        self.tiles = tiles;
    }

    /// Visits the points at which the held coordinates have their values, with the number of the
    /// value that the varied one has.
    pub(super) fn each(
        &self,
        cloud: &Points<'_>,
        slice: In<'_>,
        varied: Option<usize>,
        mut visit: impl FnMut(usize, u64),
    ) {
        let mut held = vec![];
        for &(number, wanted) in &self.held {
            match self.numbers(cloud, slice, number) {
                Some(Numbers::All(found)) if found == wanted => {}
                Some(Numbers::Each(found)) => held.push((found, wanted)),
                _ => return,
            }
        }
        let varied = match varied {
            None => Numbers::All(0),
            Some(number) => match self.numbers(cloud, slice, number) {
                Some(numbers) => numbers,
                None => return,
            },
        };
        for point in 0..cloud.len() {
            if held.iter().all(|(found, wanted)| found[point] == *wanted) {
                match &varied {
                    Numbers::All(value) => visit(point, *value),
                    Numbers::Each(values) => visit(point, values[point]),
                }
            }
        }
    }

    /// The index of a coordinate's grid value at every point.
    fn numbers(&self, cloud: &Points<'_>, slice: In<'_>, number: usize) -> Option<Numbers> {
        let coordinate = &self.layout.coordinates[number];
        let axis = coordinate.axis.as_ref()?;
        match &coordinate.place {
            ValueSource::Slice(divisor) => Some(match slice {
                In::Slice(slice) => Numbers::All(slice / divisor % axis.count),
                In::Slices(slices) => {
                    Numbers::Each(slices.iter().map(|slice| slice / divisor % axis.count).collect())
                }
            }),
            ValueSource::Field(field, scale) => {
                let column = cloud.column(field)?;
                Some(Numbers::Each(column.map(|value| nearest(axis, value / scale)).collect()))
            }
        }
    }

    fn values(&self, cloud: &Points<'_>, slice: In<'_>, number: usize) -> Option<Values> {
        let coordinate = &self.layout.coordinates[number];
        match &coordinate.place {
            ValueSource::Slice(divisor) => {
                let axis = coordinate.axis.as_ref()?;
                let value = |slice: u64| axis.value(slice / divisor % axis.count);
                Some(match slice {
                    In::Slice(slice) => Values::All(value(slice)),
                    In::Slices(slices) => {
                        Values::Each(slices.iter().map(|&slice| value(slice)).collect())
                    }
                })
            }
            ValueSource::Field(field, scale) => {
                Some(Values::Each(cloud.column(field)?.in_units_of(*scale)))
            }
        }
    }
}

enum Numbers {
    All(u64),
    Each(Vec<u64>),
}

enum Values {
    All(f64),
    Each(Vec<f64>),
}

impl Values {
    fn get(&self, point: usize) -> f64 {
        match self {
            Self::All(value) => *value,
            Self::Each(values) => values[point],
        }
    }
}
