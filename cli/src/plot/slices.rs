//! Slices of a workspace: its reachable part with all coordinates held except two.

mod notes;
mod points;
mod section;

use super::choice::{fast, home, selected, several, tilts, varied};
use super::inscribed::Shape;
use super::layout::{Layout, ValueSource};
use super::source::{Rate, ReadStop, Source};
use crate::args::PlotArgs;
use crate::failure::Failure;
use opm_mcap::rejected::MAX_CAUSES;
use opm_mcap::workspace::SLICES_TOPIC;
use opm_mcap::{RejectedCause, SliceReader};
use opm_plot::color::{INK, Map};
use opm_plot::{Cells, Cloud, Content, Measure, Paint, Spacing};
use opm_study::recording::class_color;
use opm_study::{ASPECT, WorkspaceKind};
pub use points::In;
pub use section::rounded;
use std::collections::BTreeMap;

/// Largest number of slices that are chosen without --slice.
const CHOSEN: u64 = 8;

/// Lines in the units of a picture.
type Lines = Vec<Vec<[f64; 2]>>;

/// Slices that are being built.
pub struct Slices<'a> {
    layout: &'a Layout,
    view: [Seen; 2],
    /// A whole turn, in the unit of the picture, where these are a direction and a tilt.
    polar: Option<f64>,
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
    /// The values whose slices are equal to that of a tile, and its own, in ascending order, by the value of the tile.
    equal: BTreeMap<u64, Vec<u64>>,
    /// The largest shape inside, if the recording has it.
    shape: Option<Shape>,
    /// What rejects the points, if those that are rejected are shown.
    causes: Option<Vec<RejectedCause>>,
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
        let tilts = tilts(layout, source);
        let view = view.or(tilts).unwrap_or_else(|| fast(layout));
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
        let view_of = view.map(seen);
        let turn = std::f64::consts::TAU / view_of[0].factor;
        let mut slices = Self {
            layout,
            polar: (tilts == Some(view)).then_some(turn),
            view: view_of,
            held,
            varied,
            tiles: vec![],
            color,
            aspects,
            curves: vec![],
            home: None,
            chosen: false,
            empty: 0,
            equal: BTreeMap::new(),
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
            polar: self.polar,
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
            equal: BTreeMap::new(),
            shape: None,
            causes: Some(causes),
        };
        let content = |value: u64| (value, rejected.content(&source.recording.extents));
        rejected.tiles = self.tiles.iter().map(|tile| content(tile.0)).collect();
        rejected
    }

    /// Whether the slices are cells of a grid, and not clouds of points.
    pub fn are_cells(&self) -> bool {
        self.tiles.iter().all(|tile| cells(&tile.1).is_some())
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
                return Ok::<(), ReadStop>(());
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
            let content = match (&self.causes, &self.color) {
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
            return match (content, self.polar) {
                (Content::Cells(cells, paint), Some(turn)) => Content::Polar(cells, paint, turn),
                (content, _) => content,
            };
        }
        let range = |seen: &Seen| {
            let (field, scale) = match &self.layout.coordinates[seen.number].place {
                ValueSource::Field(field, scale) => (Some(field), *scale),
                ValueSource::Slice(_) => (None, 1.0),
            };
            let found = field.and_then(|field| extents.iter().find(|e| e.field == *field));
            let value = |value: f64| value / scale / seen.factor;
            found.map_or([0.0, 1.0], |e| [value(e.min), value(e.max)])
        };
        Content::Cloud(Cloud::new(range(a), range(b)))
    }

    /// Leaves one tile of those that hold the same, unless they were asked for: that of home, or the first.
    pub fn merge_equal(&mut self) {
        // What is drawn over the cells depends on the value.
        if !self.chosen || self.aspects || self.shape.is_some() {
            return;
        }
        let mut kept: Vec<(u64, Content)> = Vec::new();
        for (value, content) in std::mem::take(&mut self.tiles) {
            let same = kept.iter_mut().find(|(_, known)| {
                cells(known).zip(cells(&content)).is_some_and(|(known, cells)| known == cells)
            });
            let Some((first, _)) = same else {
                kept.push((value, content));
                continue;
            };
            let mut values = self.equal.remove(first).unwrap_or_else(|| vec![*first]);
            values.push(value);
            if self.mark(value).is_some() {
                *first = value;
            }
            self.equal.insert(*first, values);
        }
        self.tiles = kept;
    }

    /// Leaves tiles out that hold nothing, unless they were asked for. One stays.
    pub fn drop_empty(&mut self) {
        let empty = |content: &Content| match content {
            Content::Cells(cells, _) | Content::Polar(cells, ..) => cells.extent().is_none(),
            Content::Cloud(cloud) => cloud.points() == 0,
            Content::Histogram(_) => false,
        };
        let held = self.tiles.iter().filter(|tile| !empty(&tile.1)).count();
        if self.chosen && held > 0 {
            self.empty = self.tiles.len() - held;
            self.tiles.retain(|tile| !empty(&tile.1));
        }
    }
}

/// The cells of a tile, if it has any.
fn cells(content: &Content) -> Option<&Cells> {
    match content {
        Content::Cells(cells, _) | Content::Polar(cells, ..) => Some(cells),
        Content::Cloud(_) | Content::Histogram(_) => None,
    }
}
