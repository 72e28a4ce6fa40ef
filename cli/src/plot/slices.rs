//! Slices of a workspace: its reachable part with all coordinates held except two.

use super::choice::{columns, fast, home, selected, several, varied};
use super::grid::{is_home, nearest};
use super::inscribed::Shape;
use super::label::value_label;
use super::layout::{Coordinate, Layout, Place};
use super::singular::Singular;
use super::source::{Rate, Source, Stop};
use crate::args::PlotArgs;
use crate::failure::Failure;
use opm_mcap::Cloud as Points;
use opm_mcap::rejected::{CAUSE, MAX_CAUSES, SLICE};
use opm_mcap::workspace::SLICES_TOPIC;
use opm_mcap::{RejectedCause, SliceReader};
use opm_plot::color::{INK, Map};
use opm_plot::{Bar, Cells, Cloud, Content, Measure, Paint, Scale, Section, Spacing, Tile};
use opm_study::recording::class_color;
use opm_study::{ASPECT, WorkspaceKind};
use opm_workspace::{Axis, mask_boundary};

/// Largest number of slices that are chosen without --slice.
const CHOSEN: u64 = 8;
/// Largest number of aspects that a legend names.
const MOST_NAMED: usize = 12;
/// Share of the colour scale that the slices take: the brightest colours are not used.
const COLORS: f64 = 0.95;
/// A value below this share of a grid's largest value, or of one metre or radian, counts as zero.
const ROUNDING: f64 = 1e-12;

/// Lines in the units of a picture.
type Lines = Vec<Vec<[f64; 2]>>;

/// Slices that are being built.
pub struct Slices<'a> {
    layout: &'a Layout,
    view: [Seen; 2],
    /// Coordinates that are held, each at a value of its grid.
    held: Vec<(usize, u64)>,
    /// The coordinate that has another value in each tile.
    varied: Option<usize>,
    /// The tiles, by the value of the varied coordinate.
    tiles: Vec<(u64, Content)>,
    /// The values that colour the cells: the field, its range, its divisor.
    color: Option<Colored>,
    /// Whether these values are the numbers of aspects.
    aspects: bool,
    /// The singularity curves of each tile, if they are shown.
    curves: Vec<Lines>,
    /// The position of home, if it is in the picture.
    home: Option<[f64; 2]>,
    /// Whether the tiles were chosen here, and not by --slice.
    chosen: bool,
    /// The number of tiles that are left out, because nothing is in them.
    empty: usize,
    /// The largest shape inside, if the recording has it.
    shape: Option<Shape>,
    /// What rejects the points, if those that are rejected are shown.
    causes: Option<Vec<RejectedCause>>,
}

/// The slices that points are in.
#[derive(Clone, Copy)]
pub enum In<'a> {
    /// All in one.
    Slice(u64),
    /// Each in its own.
    Slices(&'a [u64]),
}

struct Colored {
    field: String,
    measure: Measure,
    factor: f64,
    range: [f64; 2],
}

/// A coordinate that is an axis of the picture.
struct Seen {
    number: usize,
    measure: Measure,
    factor: f64,
}

impl<'a> Slices<'a> {
    /// Decides what to show. This may read the recording.
    pub fn new(
        layout: &'a Layout,
        source: &Source<'_>,
        args: &PlotArgs,
        view: Option<[usize; 2]>,
    ) -> Result<Self, Failure> {
        let view = view.unwrap_or_else(|| fast(layout));
        let bar = view[0] == view[1];
        if bar && layout.coordinates.get(view[0]).is_none_or(|c| c.axis.is_none()) {
            let name = layout.coordinates.get(view[0]).map_or("one coordinate", |c| &*c.name);
            return Err(Failure::work(format!(
                "{}: nothing to draw: its points differ in {name} alone, and a slice shows two \
                 coordinates; record with --axes or --scalars, and choose with --values",
                source.label
            )));
        }
        let selected = selected(layout, (source, args), view)?;
        let free: Vec<usize> = (0..layout.coordinates.len())
            .filter(|number| !view.contains(number) && several(&layout.coordinates[*number]))
            .collect();
        let varied = varied(layout, &free, &selected)?;
        let held: Vec<(usize, u64)> = free
            .iter()
            .filter(|number| Some(**number) != varied)
            .map(|&number| {
                let given = selected.iter().find(|(selected, _)| *selected == number);
                let value = given.map_or_else(|| home(&layout.coordinates[number]), |g| g.1[0]);
                (number, value)
            })
            .collect();
        let seen = |number: usize| {
            let c = &layout.coordinates[number];
            let (measure, factor) = source.measure(&c.name, c.quantity, Rate::Position);
            Seen { number, measure, factor }
        };
        let color = layout.color.as_ref().map(|(field, range)| {
            let (measure, factor) =
                source.measure(field, source.joint_quantity(field), Rate::Position);
            let range = range.map(|value| value / factor);
            Colored { field: field.clone(), measure, factor, range }
        });
        // If every place is reached at every orientation, there is nothing to colour.
        let color = color.filter(|_| layout.kind != WorkspaceKind::Dexterous);
        let aspects = layout.kind == WorkspaceKind::Aspects
            && color.as_ref().is_some_and(|color| color.field == ASPECT);
        let mut slices = Self {
            layout,
            view: view.map(seen),
            held,
            varied,
            tiles: vec![],
            color,
            aspects,
            curves: vec![],
            home: None,
            chosen: false,
            empty: 0,
            shape: Shape::of(source),
            causes: None,
        };
        let values =
            match (varied, selected.into_iter().find(|(number, _)| Some(*number) == varied)) {
                (None, _) => vec![0],
                (_, Some((_, values))) => values,
                (Some(number), None) => {
                    slices.chosen = true;
                    slices.spread(source, number)?
                }
            };
        let extents = &source.recording.extents;
        let content = |slices: &Self| slices.content(extents);
        slices.tiles = values.into_iter().map(|value| (value, content(&slices))).collect();
        let [a, b] = view.map(|number| &layout.coordinates[number]);
        slices.home = a.home.zip(b.home).map(|(a, b)| {
            [a / slices.view[0].factor, if bar { 0.0 } else { b / slices.view[1].factor }]
        });
        Ok(slices)
    }

    /// The same slices of the points that are rejected, for these reasons.
    pub fn rejected(&self, causes: Vec<RejectedCause>, source: &Source<'_>) -> Self {
        let seen = |seen: &Seen| Seen { measure: seen.measure.clone(), ..*seen };
        let mut rejected = Self {
            layout: self.layout,
            view: self.view.each_ref().map(seen),
            held: self.held.clone(),
            varied: self.varied,
            tiles: vec![],
            color: None,
            aspects: false,
            curves: vec![],
            home: self.home,
            chosen: self.chosen,
            empty: 0,
            shape: None,
            causes: Some(causes),
        };
        let content = |value: u64| (value, rejected.content(&source.recording.extents));
        rejected.tiles = self.tiles.iter().map(|tile| content(tile.0)).collect();
        rejected
    }

    /// Whether the slices are cells of a grid, and not clouds of points.
    pub fn are_cells(&self) -> bool {
        self.tiles.iter().all(|tile| matches!(tile.1, Content::Cells(..)))
    }

    /// Keeps only the slices that others keep, too.
    pub fn keep_those_of(&mut self, others: &Self) {
        self.tiles.retain(|tile| others.tiles.iter().any(|other| other.0 == tile.0));
    }

    /// Values of a coordinate, evenly spread over those at which anything is reachable.
    fn spread(&self, source: &Source<'_>, varied: usize) -> Result<Vec<u64>, Failure> {
        let mut ends: Option<[u64; 2]> = None;
        let mut extend = |value: u64| {
            let [first, last] = ends.unwrap_or([value; 2]);
            ends = Some([first.min(value), last.max(value)]);
        };
        let mut slices = SliceReader::default();
        source.messages(|message| {
            let slice = slices.slice(message)?;
            if message.topic != SLICES_TOPIC {
                return Ok::<(), Stop>(());
            }
            if let (Some(cloud), Some(slice)) = (message.cloud()?, slice) {
                self.each(&cloud, In::Slice(slice), Some(varied), |_, value| extend(value));
            }
            Ok(())
        })?;
        let Some([first, last]) = ends else { return Ok(vec![]) };
        // The steps from home are equal, if home is among the values.
        let step = (last - first).div_ceil(CHOSEN - 1).max(1);
        let home = home(&self.layout.coordinates[varied]);
        let start =
            if (first..=last).contains(&home) { first + (home - first) % step } else { first };
        Ok((start..=last).step_by(step as usize).collect())
    }

    /// Whether only one coordinate is shown, so that a set is a bar.
    fn is_bar(&self) -> bool {
        self.view[0].number == self.view[1].number
    }

    /// An empty tile.
    fn content(&self, extents: &[opm_mcap::Extent]) -> Content {
        let [a, b] = &self.view;
        let spacing = |seen: &Seen| {
            let axis = self.layout.coordinates[seen.number].axis.as_ref()?;
            let ends = [axis.min, axis.max].map(|value| value / seen.factor);
            Some(Spacing::between(ends, usize::try_from(axis.count).ok()?))
        };
        let across = match self.is_bar() {
            true => Some(Spacing { first: 0.0, step: 1.0, count: 1 }),
            false => spacing(b),
        };
        if let (Some(x), Some(y)) = (spacing(a), across) {
            return match (&self.causes, &self.color) {
                (Some(causes), _) => {
                    let most = causes.iter().map(|cause| cause.number).max().unwrap_or(0);
                    let mut colors = vec![INK; 1 + most.min(MAX_CAUSES)];
                    for cause in causes {
                        if let Some(color) = colors.get_mut(cause.number) {
                            *color = cause.color;
                        }
                    }
                    Content::Cells(Cells::with_classes(x, y), Paint::Classes(colors))
                }
                (None, Some(color)) if self.aspects => {
                    // A cast saturates.
                    let colors = (0..=color.range[1] as usize).map(class_color).collect();
                    Content::Cells(Cells::with_classes(x, y), Paint::Classes(colors))
                }
                (None, Some(color)) => {
                    let paint = Paint::Values(Map::Viridis, color.range);
                    Content::Cells(Cells::with_values(x, y), paint)
                }
                (None, None) => Content::Cells(Cells::plain(x, y), Paint::Plain([0; 3])),
            };
        }
        let range = |seen: &Seen| {
            let (field, scale) = match &self.layout.coordinates[seen.number].place {
                Place::Field(field, scale) => (Some(field), *scale),
                Place::Slice(_) => (None, 1.0),
            };
            let found = field.and_then(|field| extents.iter().find(|e| e.field == *field));
            let value = |value: f64| value / scale / seen.factor;
            found.map_or([0.0, 1.0], |e| [value(e.min), value(e.max)])
        };
        Content::Cloud(Cloud::new(range(a), range(b)))
    }

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
        let color: Option<Vec<f64>> = color.and_then(|(field, factor)| {
            Some(cloud.column(field)?.map(|value| value / factor).collect())
        });
        self.each(cloud, slice, self.varied, |point, value| {
            let Some((_, content)) = tiles.iter_mut().find(|tile| tile.0 == value) else { return };
            let x = x.get(point) / a.factor;
            let y = if bar { 0.0 } else { y.get(point) / b.factor };
            match content {
                Content::Cells(cells, _) => {
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
    fn each(
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
            Place::Slice(divisor) => Some(match slice {
                In::Slice(slice) => Numbers::All(slice / divisor % axis.count),
                In::Slices(slices) => {
                    Numbers::Each(slices.iter().map(|slice| slice / divisor % axis.count).collect())
                }
            }),
            Place::Field(field, scale) => {
                let column = cloud.column(field)?;
                Some(Numbers::Each(column.map(|value| nearest(axis, value / scale)).collect()))
            }
        }
    }

    fn values(&self, cloud: &Points<'_>, slice: In<'_>, number: usize) -> Option<Values> {
        let coordinate = &self.layout.coordinates[number];
        match &coordinate.place {
            Place::Slice(divisor) => {
                let axis = coordinate.axis.as_ref()?;
                let value = |slice: u64| axis.value(slice / divisor % axis.count);
                Some(match slice {
                    In::Slice(slice) => Values::All(value(slice)),
                    In::Slices(slices) => {
                        Values::Each(slices.iter().map(|&slice| value(slice)).collect())
                    }
                })
            }
            Place::Field(field, scale) => {
                Some(Values::Each(cloud.column(field)?.map(|value| value / scale).collect()))
            }
        }
    }

    /// Leaves tiles out that hold nothing, unless they were asked for. One stays.
    pub fn drop_empty(&mut self) {
        let empty = |content: &Content| match content {
            Content::Cells(cells, _) => cells.extent().is_none(),
            Content::Cloud(cloud) => cloud.points() == 0,
            Content::Histogram(_) => false,
        };
        let held = self.tiles.iter().filter(|tile| !empty(&tile.1)).count();
        if self.chosen && held > 0 {
            self.empty = self.tiles.len() - held;
            self.tiles.retain(|tile| !empty(&tile.1));
        }
    }

    /// The finished tiles.
    pub fn section(mut self, source: &Source<'_>) -> Section {
        let coordinates = &self.layout.coordinates;
        let name = |number: usize, value: u64| {
            let c = &coordinates[number];
            let (measure, factor) = source.measure(&c.name, c.quantity, Rate::Position);
            let value = c.axis.as_ref().map_or(0.0, |axis| rounded(axis, value)) / factor;
            format!("{} = {} {}", c.name, value_label(value), measure.unit.symbol)
        };
        let kind = self.layout.kind;
        let reached = if self.causes.is_some() { "rejected" } else { kind.member_name() };
        let reached = format!("{}{}", reached[..1].to_uppercase(), &reached[1..]);
        let mut title = format!("{reached} {}", kind.point_name());
        if !self.held.is_empty() {
            let held: Vec<_> = self.held.iter().map(|&(n, value)| name(n, value)).collect();
            title = format!("{reached} at {}", held.join(", "));
        }
        let positions = self.view.iter().all(|seen| coordinates[seen.number].axis.is_some());
        if self.causes.is_some() {
            title.push_str(", by what rejects them");
        } else if let Some((first, rest)) = self.layout.lost.split_first().filter(|_| positions) {
            let names = rest.iter().fold(first.clone(), |text, name| format!("{text}, {name}"));
            title.push_str(&format!(", at any {names}"));
        }
        let bar = self.is_bar();
        let [a, b] = &self.view;
        let columns = self.columns();
        let marks: Vec<Option<[f64; 2]>> =
            self.tiles.iter().map(|(value, _)| self.mark(*value)).collect();
        let total = self.varied.and_then(|v| coordinates[v].axis.as_ref()).map_or(1, |a| a.count);
        let cells = self.tiles.iter().any(|tile| matches!(tile.1, Content::Cells(..)));
        let mut curves = std::mem::take(&mut self.curves).into_iter();
        let tiles = std::mem::take(&mut self.tiles);
        let tile = |((value, content), mark): ((u64, Content), Option<[f64; 2]>)| {
            let share = COLORS * value as f64 / (total - 1).max(1) as f64;
            let content = match content {
                Content::Cells(mut cells, paint) => {
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
                    Content::Cells(cells, paint)
                }
                other => other,
            };
            Tile {
                title: self.varied.map_or_else(String::new, |number| name(number, value)),
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
        if a.quantity != b.quantity {
            return most;
        }
        let steep = (y.max - y.min) / (x.max - x.min).max(f64::MIN_POSITIVE);
        let fits = |columns: &usize| ROOM[0] / *columns as f64 * steep >= ROOM[1];
        (1..=most).rfind(fits).unwrap_or(1)
    }

    /// The boundary of the set in a tile, if the recording has it.
    fn boundary(&self, cells: &Cells) -> Option<Vec<Vec<[f64; 2]>>> {
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
    fn inside(&self, value: u64) -> Option<Vec<[f64; 2]>> {
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
    fn mark(&self, value: u64) -> Option<[f64; 2]> {
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

    /// Notes on the picture.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![];
        let coordinates = &self.layout.coordinates;
        if let Some(varied) = self.varied
            && let Some(axis) = &coordinates[varied].axis
            && ((self.tiles.len() + self.empty) as u64) < axis.count
        {
            notes.push(format!(
                "Slices: {} of the {} values of {} on the grid.",
                self.tiles.len() + self.empty,
                axis.count,
                axis.name
            ));
        }
        if self.empty > 0 {
            let slices = if self.empty == 1 { "slice" } else { "slices" };
            notes.push(format!("Left out: {} {slices} that hold nothing.", self.empty));
        }
        let bounded = |tile: &(u64, Content)| match &tile.1 {
            Content::Cells(cells, _) => self.boundary(cells).is_some(),
            _ => false,
        };
        if self.tiles.iter().any(bounded) {
            let line =
                "The line is the boundary, half-way between values of the grid, and on its edge.";
            notes.push(line.to_owned());
        }
        if self.curves.iter().any(|lines| !lines.is_empty()) {
            notes.push(
                "The red lines are parallel singularities, found by bisection on the lines of the grid.".to_owned(),
            );
        }
        if let Some(shape) = &self.shape
            && self.tiles.iter().any(|(value, _)| self.inside(*value).is_some())
        {
            notes.push(format!("The thick line is the largest {}.", shape.text));
        }
        let coarse = |tile: &(u64, Content)| match &tile.1 {
            Content::Cells(cells, _) => cells.is_coarse(),
            _ => false,
        };
        if self.tiles.iter().any(coarse) {
            notes.push(
                "A cell holds several values of the grid, at least one of them reachable."
                    .to_owned(),
            );
        }
        if self.tiles.iter().any(|(value, _)| self.mark(*value).is_some()) {
            notes.push("The cross is home.".to_owned());
        }
        notes
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
    match content {
        Content::Cells(cells, _) => cells.classes(),
        _ => None,
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
