//! Tiles with their titles, their lines and their legend: a section of a picture.

use super::{Lines, Seen, Slices, cells as cells_of};
use crate::failure::Failure;
use crate::plot::choice::columns;
use crate::plot::grid::is_home;
use crate::plot::label::value_label;
use crate::plot::layout::Coordinate;
use crate::plot::singular::Singular;
use crate::plot::source::{Rate, Source};
use opm_plot::color::Map;
use opm_plot::{Bar, Cells, Content, Measure, Paint, Scale, Section, Tile};
use opm_study::recording::class_color;
use opm_workspace::{Axis, mask_boundary};

/// Largest number of values that a title lists.
const MOST_LISTED: usize = 3;
/// Largest number of aspects that a legend names.
const MOST_NAMED: usize = 12;
/// Share of the colour scale that the slices take: the brightest colours are not used.
const COLORS: f64 = 0.95;
/// A value below this share of a grid's largest value, or of one metre or radian, counts as zero.
const ROUNDING: f64 = 1e-12;

impl Slices<'_> {
    /// The finished tiles.
    pub fn section(mut self, source: &Source<'_>) -> Section {
        let coordinates = &self.layout.coordinates;
        // A coordinate with its value, or with the values of slices that are equal: the first and the last of many.
        let named = |number: usize, values: &[u64]| {
            let c = &coordinates[number];
            let (measure, factor) = source.measure(&c.name, c.quantity, Rate::Position);
            let value = |value: &u64| {
                let value = c.axis.as_ref().map_or(0.0, |axis| rounded(axis, *value)) / factor;
                value_label(value)
            };
            let listed = match values {
                [first, .., last] if values.len() > MOST_LISTED => {
                    format!("{} … {}", value(first), value(last))
                }
                all => all.iter().map(value).collect::<Vec<_>>().join(", "),
            };
            format!("{} = {listed} {}", c.name, measure.unit.symbol)
        };
        let kind = self.layout.kind;
        let reached = if self.causes.is_some() { "rejected" } else { kind.member_name() };
        let reached = format!("{}{}", reached[..1].to_uppercase(), &reached[1..]);
        let mut title = format!("{reached} {}", kind.point_name());
        if !self.held.is_empty() {
            let held: Vec<_> = self.held.iter().map(|&(n, value)| named(n, &[value])).collect();
            title = format!("{reached} at {}", held.join(", "));
        }
        let positions = self.view.iter().all(|seen| coordinates[seen.number].axis.is_some());
        if self.causes.is_some() {
            title.push_str(", by what rejects them");
        } else if let Some((first, rest)) = self.layout.lost.split_first().filter(|_| positions) {
            let names = rest.iter().fold(first.clone(), |text, name| format!("{text}, {name}"));
            title.push_str(&format!(", at one value or more of {names}"));
        }
        let bar = self.is_bar();
        let [a, b] = &self.view;
        let columns = self.columns();
        let marks: Vec<Option<[f64; 2]>> =
            self.tiles.iter().map(|(value, _)| self.mark(*value)).collect();
        let total = self.varied.and_then(|v| coordinates[v].axis.as_ref()).map_or(1, |a| a.count);
        let cells = self.tiles.iter().any(|tile| cells_of(&tile.1).is_some());
        let mut curves = std::mem::take(&mut self.curves).into_iter();
        let tiles = std::mem::take(&mut self.tiles);
        let tile = |((value, content), mark): ((u64, Content), Option<[f64; 2]>)| {
            let share = COLORS * value as f64 / (total - 1).max(1) as f64;
            let content = match content {
                Content::Cells(mut cells, paint) | Content::Polar(mut cells, paint, _) => {
                    if let Some(lines) = self.boundary(&cells) {
                        cells.surround(lines);
                    }
                    if let Some(line) = self.inside(value) {
                        cells.inscribe(line);
                    }
                    cells.trace(curves.next().unwrap_or_default());
                    let paint = match paint {
                        Paint::Plain(_) => Paint::Plain(Map::Viridis.color(share)),
                        values => values,
                    };
                    match self.polar {
                        Some(turn) => Content::Polar(cells, paint, turn),
                        None => Content::Cells(cells, paint),
                    }
                }
                other => other,
            };
            Tile {
                title: self.varied.map_or_else(String::new, |number| {
                    named(number, self.equal.get(&value).map_or(&[value], |values| values))
                }),
                x: a.measure.clone(),
                y: if bar { Measure::nothing() } else { b.measure.clone() },
                content,
                mark,
            }
        };
        let mut shown: Vec<usize> = match self.aspects {
            true => tiles.iter().filter_map(|tile| classes(&tile.1)).flatten().flatten().collect(),
            false => vec![],
        };
        shown.sort_unstable();
        shown.dedup();
        let colors = self.color.as_ref().filter(|_| !self.aspects).map(|color| Bar {
            measure: color.measure.clone(),
            range: color.range,
            map: Map::Viridis,
            scale: Scale::Linear,
        });
        let tiles = tiles.into_iter().zip(marks).map(tile).collect();
        let causes = self.causes.unwrap_or_default().into_iter().filter(|_| cells);
        let causes = causes.map(|cause| (cause.text, cause.color));
        let aspects = shown.into_iter().take(MOST_NAMED).map(|number| {
            let text = match number {
                0 => "singular, or several aspects".to_owned(),
                _ => format!("aspect {number}"),
            };
            (text, class_color(number))
        });
        let legend = causes.chain(aspects).collect();
        Section { title, columns, shared: true, tiles, bar: colors.filter(|_| cells), legend }
    }

    /// Number of tiles in a row: fewer if tiles that are much wider than high would be too small.
    fn columns(&self) -> usize {
        /// Approximate width of a row of tiles, and approximate smallest height of a tile.
        const ROOM: [f64; 2] = [800.0, 70.0];
        let most = columns(self.tiles.len());
        let [a, b] = self.view.each_ref().map(|seen| &self.layout.coordinates[seen.number]);
        let (Some(x), Some(y)) = (&a.axis, &b.axis) else { return most };
        if a.quantity != b.quantity || self.polar.is_some() {
            return most;
        }
        let steep = (y.max - y.min) / (x.max - x.min).max(f64::MIN_POSITIVE);
        let fits = |columns: &usize| ROOM[0] / *columns as f64 * steep >= ROOM[1];
        (1..=most).rfind(fits).unwrap_or(1)
    }

    /// The boundary of the set in a tile, if the recording has it.
    pub(super) fn boundary(&self, cells: &Cells) -> Option<Vec<Vec<[f64; 2]>>> {
        let axis = |seen: &Seen| {
            let axis = self.layout.coordinates[seen.number].axis.as_ref()?;
            let [min, max] = [axis.min, axis.max].map(|value| value / seen.factor);
            (axis.count > 1).then(|| Axis::new(&*axis.name, min, max, axis.count))
        };
        let [a, b] = &self.view;
        let (x, y) = (axis(a)?, axis(b).filter(|_| !self.is_bar())?);
        if self.aspects {
            return self.boundaries_of_aspects([&x, &y], &cells.classes()?);
        }
        let inside = cells.hits().filter(|_| self.layout.bounded && self.causes.is_none())?;
        let rings = mask_boundary(&x, &y, &inside).expect("one value for each cell");
        Some(rings.into_iter().map(|ring| ring.points).collect())
    }

    /// Finds the singularity curves of every tile, for a picture of aspects.
    pub fn find_singularities(&mut self, source: &Source<'_>) -> Result<(), Failure> {
        if let Some(singular) = Singular::of(source).filter(|_| self.aspects && !self.is_bar()) {
            let of = |tile: &(u64, Content)| self.singularities(&singular, tile.0);
            self.curves = self.tiles.iter().map(of).collect::<Result<_, _>>()?;
        }
        Ok(())
    }

    /// The singularity curves in the tile of this value.
    fn singularities(&self, singular: &Singular<'_>, value: u64) -> Result<Lines, Failure> {
        let coordinates = &self.layout.coordinates;
        let view = self.view.each_ref().map(|seen| coordinates[seen.number].axis.as_ref());
        let [Some(x), Some(y)] = view else { return Ok(vec![]) };
        // Coordinates with one value are held at that.
        let single = self.layout.grid.iter().map(|(_, axis)| axis).filter(|axis| axis.count == 1);
        let single = single.map(|axis| (&*axis.name, axis.min));
        let varied = self.varied.map(|number| (number, value));
        let held = self.held.iter().copied().chain(varied).filter_map(|(number, value)| {
            Some((&*coordinates[number].name, coordinates[number].axis.as_ref()?.value(value)))
        });
        let held: Vec<(&str, f64)> = single.chain(held).collect();
        let [a, b] = &self.view;
        let scaled = |[x, y]: [f64; 2]| [x / a.factor, y / b.factor];
        let lines = singular.curves([x, y], &held)?.into_iter();
        Ok(lines.map(|line| line.into_iter().map(scaled).collect()).collect())
    }

    /// The boundary of each aspect in a tile.
    fn boundaries_of_aspects(
        &self,
        [x, y]: [&Axis; 2],
        classes: &[Option<usize>],
    ) -> Option<Vec<Vec<[f64; 2]>>> {
        let mut shown: Vec<usize> = classes.iter().flatten().copied().collect();
        shown.sort_unstable();
        shown.dedup();
        let lines = shown.into_iter().filter(|_| self.layout.bounded).flat_map(|number| {
            let inside: Vec<bool> = classes.iter().map(|class| *class == Some(number)).collect();
            mask_boundary(x, y, &inside).expect("one value for each cell")
        });
        Some(lines.map(|ring| ring.points).collect())
    }

    /// The line of the largest shape inside, in the tile of this value.
    pub(super) fn inside(&self, value: u64) -> Option<Vec<[f64; 2]>> {
        let [a, b] = &self.view;
        let coordinates = &self.layout.coordinates;
        let varied = self.varied.map(|number| (number, value));
        let held = self.held.iter().copied().chain(varied);
        let held = held.filter_map(|(number, value)| {
            let c = &coordinates[number];
            Some((&*c.name, c.axis.as_ref()?.value(value)))
        });
        let [x, y] = [a, b].map(|seen| &*coordinates[seen.number].name);
        let line = self.shape.as_ref().filter(|_| !self.is_bar())?.across([x, y], held)?;
        Some(line.into_iter().map(|[x, y]| [x / a.factor, y / b.factor]).collect())
    }

    /// The position of home, if it is in the tile of this value.
    pub(super) fn mark(&self, value: u64) -> Option<[f64; 2]> {
        let value_of = |number: usize| {
            let held = self.held.iter().find(|(held, _)| *held == number).map(|held| held.1);
            held.or_else(|| (self.varied == Some(number)).then_some(value)).unwrap_or(0)
        };
        let seen = |number: usize| self.view.iter().any(|seen| seen.number == number);
        let others = (0..self.layout.coordinates.len()).filter(|number| !seen(*number));
        let mut others = others.map(|number| (&self.layout.coordinates[number], value_of(number)));
        let is_home = |c: &Coordinate, value: u64| match (&c.axis, c.home) {
            (Some(axis), Some(home)) => is_home(axis, home, value),
            _ => false,
        };
        let here = self.layout.has_home && others.all(|(c, value)| is_home(c, value));
        self.home.filter(|_| here)
    }
}

/// A value of the grid; exactly zero if it differs from zero only by rounding.
pub fn rounded(axis: &Axis, number: u64) -> f64 {
    let value = axis.value(number);
    let largest = axis.min.abs().max(axis.max.abs()).max(1.0);
    if value.abs() <= ROUNDING * largest { 0.0 } else { value }
}

/// The classes of the cells of a tile.
fn classes(content: &Content) -> Option<Vec<Option<usize>>> {
    cells_of(content)?.classes()
}
