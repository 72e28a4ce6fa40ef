//! Layouts: what a viewer shows of a recording, from where, and beside what.
//!
//! Without one, a viewer shows an empty grid at first. [`Layout::of`] reads a recording: how large it is, which topics it
//! has, which values belong together. [`Layout::foxglove`] gives a layout file for Foxglove and Lichtblick,
//! [`Layout::rerun`] a Python script for Rerun.
//!
//! ```no_run
//! use opm_mcap::Layout;
//! use std::path::Path;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let layout = Layout::of(Path::new("play.mcap"))?;
//! std::fs::write("layout.json", layout.foxglove())?;
//! std::fs::write("show.py", layout.rerun("play.mcap"))?;
//! # Ok(())
//! # }
//! ```

mod extent;
mod foxglove;
mod plots;
mod rerun;

use crate::cloud::POSITION_FIELDS;
use crate::reader::{Recording, read};
use crate::rejected::REJECTED_TOPIC;
use crate::scene::end_labels;
use crate::trajectory::{BODIES_TOPIC, VIOLATIONS_TOPIC};
use crate::workspace::{
    AXES_TOPIC, BOUNDARY_POINTS_TOPIC, BOUNDARY_TOPIC, LABEL_TOPIC, OVERVIEW_TOPIC, SLICES_TOPIC,
};
use crate::{Cloud, Message, Metadata, ReadError};
use extent::{Extent, Frames};
use plots::{Flats, Plot};
use std::path::Path;

/// Why there is no layout for a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The recording has nothing that a viewer shows.
    #[error("it holds {found}, expected a workspace or a motion, as opm records them")]
    Nothing {
        /// Its topics.
        found: String,
    },
}

/// What a viewer shows of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    title: String,
    /// The views in space, side by side.
    views: Vec<View>,
    plots: Vec<Plot>,
    /// Whether there is a log of violations.
    violations: bool,
}

/// A view in space.
#[derive(Debug, Clone, PartialEq)]
struct View {
    title: String,
    /// The frame that it is drawn in.
    frame: String,
    extent: Extent,
    /// The topics of the recording that are shown and those that are not, with the size of points, pixels.
    shown: Vec<(String, u32)>,
    hidden: Vec<String>,
    /// The values at the ends of its axes, with their places, where the axes are those of a cloud.
    labels: Vec<([f64; 3], String)>,
}

/// The size of points of an overview, of a slice, and of what has none, pixels.
const OVERVIEW_POINTS: u32 = 3;
const SLICE_POINTS: u32 = 5;
const NO_POINTS: u32 = 0;

impl Layout {
    /// Reads a recording, and lays out what is in it.
    ///
    /// # Errors
    /// [`LayoutError::Read`]: it cannot be read; [`LayoutError::Nothing`]: it is neither of a workspace nor of a motion.
    pub fn of(path: &Path) -> Result<Self, LayoutError> {
        let (mut frames, mut flats) = (Frames::default(), Flats::default());
        let (mut frame_id, mut rejected) = (None, None);
        let recording = read(path, |message: &Message<'_>| -> Result<(), ReadError> {
            if matches!(message.topic, OVERVIEW_TOPIC | SLICES_TOPIC) {
                if let Some(cloud) = message.cloud()? {
                    frame_id.get_or_insert(cloud.frame_id);
                }
                return Ok(());
            }
            if message.topic == REJECTED_TOPIC {
                rejected = message.cloud()?.and_then(|cloud| box_of(&cloud));
                return Ok(());
            }
            frames.add(message)?;
            flats.add(message);
            Ok(())
        })?;
        let plots = flats.plots(&recording);
        let views = match frame_id {
            Some(frame) => {
                let mut views = workspace(&recording, &frame);
                views.extend(rejected.map(|extent| rejected_view(&recording, frame, extent)));
                views
            }
            None => frames.extent().map_or_else(Vec::new, |extent| motion(&recording, extent)),
        };
        if views.is_empty() && plots.is_empty() {
            let names = recording.topics.iter().take(8);
            let names: Vec<_> = names.map(|topic| topic.name.escape_debug().to_string()).collect();
            let found = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            return Err(LayoutError::Nothing { found });
        }
        let run = recording.metadata("run");
        let word = |key: &str| run.and_then(|run: &Metadata| run.get(key)).cloned();
        let parts = [word("mechanism"), word("kind").or_else(|| word("motion"))];
        let title = parts.into_iter().flatten().collect::<Vec<_>>().join(", ");
        let violations = recording.topic(VIOLATIONS_TOPIC).is_some();
        Ok(Self { title, views, plots, violations })
    }
}

/// A workspace: the overview beside the slice.
fn workspace(recording: &Recording, frame: &str) -> Vec<View> {
    let range = |name: &str| {
        let found = recording.extents.iter().find(|extent| extent.field == name);
        found.map_or([0.0; 2], |extent| [extent.min, extent.max])
    };
    let [x, y, z] = ["x", "y", "z"].map(range);
    let extent = Extent { low: [x[0], y[0], z[0]], high: [x[1], y[1], z[1]] };
    let labels = labels(recording, &extent);
    // In a view, and in none.
    let boundary = recording.topic(BOUNDARY_TOPIC).map(|topic| topic.name.clone());
    let dots = recording.topic(BOUNDARY_POINTS_TOPIC).map(|topic| topic.name.clone());
    let rejected = recording.topic(REJECTED_TOPIC).map(|topic| topic.name.clone());
    let axes = recording.topic(AXES_TOPIC).map(|topic| topic.name.clone());
    let words = recording.topic(LABEL_TOPIC).map(|topic| topic.name.clone());
    let view = |title: &str, topic: &str, size, hidden: &str, with_slice: bool| {
        let lines = boundary.iter().chain(&words).cloned();
        let (on, off) =
            if with_slice { (lines.collect(), vec![]) } else { (vec![], lines.collect()) };
        let shown = [(topic.to_owned(), size)].into_iter();
        View {
            title: title.to_owned(),
            frame: frame.to_owned(),
            extent,
            shown: shown
                .chain(axes.iter().cloned().chain(on).map(|name| (name, NO_POINTS)))
                .collect(),
            hidden: [hidden.to_owned()]
                .into_iter()
                .chain(off)
                .chain(dots.clone())
                .chain(rejected.clone())
                .collect(),
            labels: labels.clone(),
        }
    };
    match recording.topic(SLICES_TOPIC) {
        Some(slices) if slices.messages > 1 => vec![
            view("Overview", OVERVIEW_TOPIC, OVERVIEW_POINTS, SLICES_TOPIC, false),
            view("Slice", SLICES_TOPIC, SLICE_POINTS, OVERVIEW_TOPIC, true),
        ],
        _ => vec![view("Workspace", OVERVIEW_TOPIC, OVERVIEW_POINTS, SLICES_TOPIC, true)],
    }
}

/// The box round the points of a cloud, if there are any.
fn box_of(cloud: &Cloud<'_>) -> Option<Extent> {
    let mut extent = Extent { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
    for (i, name) in POSITION_FIELDS.into_iter().enumerate() {
        for value in cloud.column(name)? {
            extent.low[i] = extent.low[i].min(value);
            extent.high[i] = extent.high[i].max(value);
        }
    }
    (!cloud.is_empty()).then_some(extent)
}

/// What is rejected, round the workspace.
fn rejected_view(recording: &Recording, frame: String, extent: Extent) -> View {
    let others = [
        OVERVIEW_TOPIC,
        SLICES_TOPIC,
        AXES_TOPIC,
        BOUNDARY_TOPIC,
        BOUNDARY_POINTS_TOPIC,
        LABEL_TOPIC,
    ];
    let others = others.into_iter().filter(|name| recording.topic(name).is_some());
    View {
        title: "Rejected".to_owned(),
        frame,
        extent,
        shown: vec![(REJECTED_TOPIC.to_owned(), OVERVIEW_POINTS)],
        hidden: others.map(str::to_owned).collect(),
        labels: labels(recording, &extent),
    }
}

/// The values at the ends of the axes of a cloud, before these were scaled.
fn labels(recording: &Recording, extent: &Extent) -> Vec<([f64; 3], String)> {
    let clouds = recording.metadata("clouds");
    let list = |key: &str| -> Vec<&str> {
        let text = clouds.and_then(|clouds| clouds.get(key));
        text.map(|text| text.split(',').collect()).unwrap_or_default()
    };
    let (names, units, scales) = (list("axes"), list("units"), list("scale"));
    let bounds = std::array::from_fn(|i| [extent.low[i], extent.high[i]]);
    end_labels(bounds, |i| {
        let scale = scales.get(i).and_then(|text| text.parse().ok()).filter(|scale| *scale > 0.0);
        let text = |texts: &[&'_ str]| texts.get(i).copied().unwrap_or_default().to_owned();
        (text(&names), text(&units), scale.unwrap_or(1.0))
    })
}

/// A motion: the mechanism.
fn motion(recording: &Recording, (frame, extent): (String, Extent)) -> Vec<View> {
    let scene = recording.topic(crate::trajectory::SCENE_TOPIC);
    let bodies = recording.topics.iter().filter(|topic| topic.name.starts_with(BODIES_TOPIC));
    vec![View {
        title: "Mechanism".to_owned(),
        frame,
        extent,
        shown: scene.iter().map(|topic| (topic.name.clone(), NO_POINTS)).collect(),
        hidden: bodies.map(|topic| topic.name.clone()).collect(),
        labels: Vec::new(),
    }]
}
