//! The recording of a workspace sweep: an overview, and every point slice by slice.
//!
//! | topic | messages |
//! |---|---|
//! | `/workspace/cloud` | one: every k-th point, at most [`MAX_OVERVIEW_POINTS`], at the start |
//! | `/workspace/slices` | one for each slice that has points, [`SLICE_STEP`] apart; together they hold every point |
//! | `/workspace/slice` | `opm.Slice`, before each of them: the number of the slice, its coordinates, its points and their area |
//! | `/workspace/label` | `foxglove.SceneUpdate`, where there are several slices: the same in words, above the points |
//! | `/workspace/axes` | one `foxglove.SceneUpdate`: a box round the points, with the values at its ends |
//! | `/workspace/boundary` | `foxglove.SceneUpdate`, if the boundary is known: its closed lines, with their slice |
//! | `/workspace/boundary_points` | `foxglove.PointCloud`: the same lines as points, for viewers without scenes |
//! | `/workspace/rejected` | one `foxglove.PointCloud`, if it is known what rejects the other points: these, each with the number of its slice and of its cause; the record `rejected` has the causes in words, with their colours |
//!
//! A viewer shows the newest message of a topic. So the overview, which comes first, is always in view, and
//! moving the playhead walks through the slices. Beside slices, its colours are faint. A slice without points has no messages, and
//! takes no time. A slice with more points than [`MAX_MESSAGE_POINTS`] continues in
//! further messages, each [`PART_STEP`] after the one before.
//!
//! Time starts at [`START`] and counts slices; no clock is read. The metadata records are `run` (the
//! caller's description of the run), `clouds` (what x, y, z and the colour are, how the overview was
//! decimated), and last `result`, with `complete = "true"`. The mechanism file is an attachment.
//!
//! The [crate] has an example.

use std::path::Path;

use foxglove::Encode;
use foxglove::messages::{PointCloud, SceneUpdate, Timestamp};

use crate::cloud::CloudEncoder;
use crate::joints::JointsTopic;
use crate::log::{Log, Topic};
use crate::rejected::{self, REJECTED_RECORD, REJECTED_TOPIC, RejectedCause, RejectedPoints};
use crate::scene::{ClosedLine, dots, labelled_box, lines, slice_label};
pub use crate::slices::SLICE_TOPIC;
use crate::slices::Slices;
use crate::{CloudLayout, Metadata, PartialFile, RecordError, Sink};

/// The topic of the overview.
pub const OVERVIEW_TOPIC: &str = "/workspace/cloud";
/// The topic of the slices.
pub const SLICES_TOPIC: &str = "/workspace/slices";
/// The topic of the words about the slice that is shown.
pub const LABEL_TOPIC: &str = "/workspace/label";
/// The topic of the labelled box round the points.
pub const AXES_TOPIC: &str = "/workspace/axes";
/// The topic of the boundary.
pub const BOUNDARY_TOPIC: &str = "/workspace/boundary";
/// The topic of the boundary as points.
pub const BOUNDARY_POINTS_TOPIC: &str = "/workspace/boundary_points";
/// The time of the first message, nanoseconds: one second, since viewers take zero for a time that is not set.
pub const START: u64 = 1_000_000_000;
/// The time between slices, nanoseconds.
pub const SLICE_STEP: u64 = 100_000_000;
/// The time between the messages of one slice, nanoseconds.
pub const PART_STEP: u64 = 100_000;
/// Most points of the overview.
pub const MAX_OVERVIEW_POINTS: u64 = 2_000_000;
/// Most points of one message of a slice.
pub const MAX_MESSAGE_POINTS: u64 = 4_000_000;
/// Most bytes of the points of one message, which bounds the recorder's memory. Clouds of more than four
/// scalars reach this limit before those in points.
pub const MAX_MESSAGE_BYTES: u64 = 128 << 20;
/// The number of uncompressed bytes of points after which a chunk is closed. In chunks of this size zstd finds
/// the slice before, so that they are smaller by a fifth than chunks of 1 MiB.
pub const CHUNK_BYTES: u64 = 4 << 20;
/// Most slices. A million of them play for a day.
pub const MAX_SLICES: u64 = 1_000_000;

/// The number of parts into which flushes divide the slices. A recording that is cut short lacks at most one
/// of them, or the last 4 MiB of points if that is less. They are counted in slices, not in seconds, so that
/// the bytes do not depend on the machine's speed.
const FLUSHES: u64 = 100;

/// The head of a workspace recording.
#[derive(Debug, Clone)]
pub struct Workspace<'a> {
    /// The values of its points.
    pub layout: CloudLayout,
    /// The name of the mechanism file.
    pub mechanism_name: &'a str,
    /// The mechanism file itself (TOML).
    pub mechanism: &'a [u8],
    /// The description of the run: grid, mode, version.
    pub run: Metadata,
    /// The number of points of all slices together.
    pub points: u64,
    /// The slices: combinations of values on the slowest grid axes.
    pub slices: Slices,
}

/// How messages are divided: the numbers that follow from the memory bound and the number of points.
#[derive(Debug, Clone, Copy)]
struct Plan {
    points: u64,
    slices: u64,
    overview_every: u64,
    overview_points: u64,
    message_points: usize,
}

impl Plan {
    fn new(points: u64, slices: u64, stride: usize) -> Self {
        let fitting = (MAX_MESSAGE_BYTES / stride as u64).max(1);
        let overview_every = points.div_ceil(MAX_OVERVIEW_POINTS.min(fitting)).max(1);
        Self {
            points,
            slices,
            overview_every,
            overview_points: points.div_ceil(overview_every),
            message_points: MAX_MESSAGE_POINTS.min(fitting) as usize,
        }
    }

    /// The number of points of the largest cloud to come.
    fn capacity(&self) -> usize {
        self.message_points.min(usize::try_from(self.points).unwrap_or(usize::MAX))
    }
}

/// Boundaries that are still to be written.
struct Boundary {
    topic: Topic,
    points: Topic,
    left: std::vec::IntoIter<(u64, Vec<ClosedLine>)>,
}

/// The slice that points go to.
#[derive(Debug, Clone, Copy)]
struct Open {
    slice: u64,
    /// The number of messages of this slice that are already written, and of their points.
    parts: u64,
    points: u64,
}

/// Writes a workspace recording.
///
/// The points are given twice, both times in the order of their numbers in the grid: first every k-th point
/// ([`overview_every`](Self::overview_every)) to [`overview`](Self::overview), then all points, with the
/// number of their slice, to [`push`](Self::push). The portions in which they come make no difference to
/// the file. Any error is final. It takes the memory of one message, at most [`MAX_MESSAGE_BYTES`]. The
/// [crate] has an example.
pub struct WorkspaceRecorder<'w> {
    log: Log<'w>,
    encoder: CloudEncoder,
    plan: Plan,
    overview: Topic,
    slices: Topic,
    layout: CloudLayout,
    boundary: Option<Boundary>,
    /// `None` while the overview is being gathered.
    open: Option<Open>,
    pushed: u64,
    /// What the slices are, and where it is told.
    told: Slices,
    slice: JointsTopic,
    /// `None` where there is one slice only.
    label: Option<Topic>,
    /// The number of slices that are already written.
    written: u64,
    /// The range of the points of the overview.
    bounds: Option<[[f64; 2]; 3]>,
}

impl WorkspaceRecorder<'static> {
    /// Starts a recording that will appear as the file `path`; see [`PartialFile`].
    ///
    /// # Errors
    /// [`RecordError::Layout`] for a layout that contradicts itself, [`RecordError::TooManySlices`], or a file
    /// that cannot be written.
    pub fn create(path: &Path, workspace: &Workspace<'_>) -> Result<Self, RecordError> {
        Self::new(PartialFile::create(path)?, workspace)
    }
}

impl<'w> WorkspaceRecorder<'w> {
    /// Starts a recording that is written to `sink`.
    ///
    /// # Errors
    /// As [`create`](WorkspaceRecorder::create).
    pub fn new(sink: impl Sink + 'w, workspace: &Workspace<'_>) -> Result<Self, RecordError> {
        Self::begin(Box::new(sink), workspace)
    }

    fn begin(sink: Box<dyn Sink + 'w>, workspace: &Workspace<'_>) -> Result<Self, RecordError> {
        let Workspace { layout, slices: told, points, .. } = workspace;
        let slices = told.count();
        if slices > MAX_SLICES {
            return Err(RecordError::TooManySlices { slices, limit: MAX_SLICES });
        }
        let plan = Plan::new(*points, slices, layout.stride());
        let encoder = CloudEncoder::new(layout, plan.capacity())?;

        let mut log = Log::new(sink, CHUNK_BYTES)?;
        log.attach(workspace.mechanism_name, "application/toml", START, workspace.mechanism)?;
        log.metadata("run", &workspace.run)?;
        log.metadata("clouds", &describe(layout, &plan))?;
        let overview = log.topic::<PointCloud>(OVERVIEW_TOPIC)?;
        let slices = log.topic::<PointCloud>(SLICES_TOPIC)?;
        let slice = JointsTopic::new(&mut log, SLICE_TOPIC, "Slice", &told.names()?)?;
        let label = match told.axes.is_empty() {
            true => None,
            false => Some(log.topic::<SceneUpdate>(LABEL_TOPIC)?),
        };
        let (told, written, bounds) = (told.clone(), 0, None);
        let layout = layout.clone();
        let (boundary, open) = (None, None);
        Ok(Self {
            log,
            encoder,
            plan,
            overview,
            slices,
            layout,
            boundary,
            open,
            pushed: 0,
            told,
            slice,
            label,
            written,
            bounds,
        })
    }

    /// The k of the overview, to which points number 0, k, 2k, ... belong.
    pub fn overview_every(&self) -> u64 {
        self.plan.overview_every
    }

    /// Records the boundary, too, in the axes of the cloud: closed lines, with the number of the slice from
    /// which on they are shown, ascending. It has to come before the points of the slices.
    ///
    /// # Errors
    /// [`RecordError::OverviewClosed`] after the first slice, [`RecordError::Slice`] for lines out of order or
    /// beyond the last slice, or a failed write.
    pub fn boundary(&mut self, lines: Vec<(u64, Vec<ClosedLine>)>) -> Result<(), RecordError> {
        let result = self.try_boundary(lines);
        self.settle(result)
    }

    /// Records points that are rejected, too: one of `every` of all of them, with what the numbers of their causes mean.
    /// It has to come before the points of the slices.
    ///
    /// # Errors
    /// [`RecordError::OverviewClosed`] after the first slice, or a failed write.
    pub fn rejected(
        &mut self,
        points: RejectedPoints,
        causes: &[RejectedCause],
        every: u64,
    ) -> Result<(), RecordError> {
        let result = self.try_rejected(points, causes, every);
        self.settle(result)
    }

    /// Adds points of the overview, as rows of [`CloudLayout::columns`].
    ///
    /// # Errors
    /// Points that do not fit the layout ([`RecordError::Row`]) or are not finite ([`RecordError::NonFinite`]),
    /// are too many ([`RecordError::Count`]) or come after the first slice ([`RecordError::OverviewClosed`]).
    pub fn overview(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        let result = self.try_overview(rows);
        self.settle(result)
    }

    /// Adds points of a slice, as rows of [`CloudLayout::columns`]. Slices may be skipped, but not
    /// returned to.
    ///
    /// # Errors
    /// Points that do not fit the layout ([`RecordError::Row`]) or are not finite ([`RecordError::NonFinite`]),
    /// a slice out of order ([`RecordError::Slice`]), an overview with too few points
    /// ([`RecordError::Count`]), or a failed write.
    pub fn push(&mut self, slice: u64, rows: &[f64]) -> Result<(), RecordError> {
        let result = self.try_push(slice, rows);
        self.settle(result)
    }

    /// Adds points of the overview that a [`Packer`](crate::Packer) of the layout has packed.
    ///
    /// # Errors
    /// [`RecordError::Layout`] if `points` is not a whole number of points, and as [`overview`](Self::overview).
    pub fn overview_packed(&mut self, points: &[u8]) -> Result<(), RecordError> {
        let result = self.try_overview_packed(points);
        self.settle(result)
    }

    /// Adds points of a slice that a [`Packer`](crate::Packer) of the layout has packed.
    ///
    /// # Errors
    /// [`RecordError::Layout`] if `points` is not a whole number of points, and as [`push`](Self::push).
    pub fn push_packed(&mut self, slice: u64, points: &[u8]) -> Result<(), RecordError> {
        let result = self.try_push_packed(slice, points);
        self.settle(result)
    }

    /// Completes the recording, which only now gets its name. `result` is the last metadata record, with
    /// `complete = "true"` added.
    ///
    /// # Errors
    /// [`RecordError::Count`] if there were fewer or more points than announced, or a failed write.
    pub fn finish(mut self, result: &Metadata) -> Result<(), RecordError> {
        let open = self.open_slices()?;
        self.close_until(open, self.plan.slices)?;
        if self.pushed != self.plan.points {
            let (found, expected) = (self.pushed, self.plan.points);
            return Err(RecordError::Count { what: "slices", found, expected });
        }
        let mut result = result.clone();
        result.insert("complete".into(), "true".into());
        self.log.metadata("result", &result)?;
        self.log.finish()
    }

    /// Ends the recording after an error, whatever the error was.
    fn settle(&mut self, result: Result<(), RecordError>) -> Result<(), RecordError> {
        if result.is_err() {
            self.log.give_up();
        }
        result
    }

    fn try_boundary(&mut self, lines: Vec<(u64, Vec<ClosedLine>)>) -> Result<(), RecordError> {
        if self.open.is_some() {
            return Err(RecordError::OverviewClosed);
        }
        let mut first = 0;
        for &(slice, _) in &lines {
            if slice < first || slice >= self.plan.slices {
                return Err(RecordError::Slice { slice, first, end: self.plan.slices });
            }
            first = slice + 1;
        }
        let topic = self.log.topic::<SceneUpdate>(BOUNDARY_TOPIC)?;
        let points = self.log.topic::<PointCloud>(BOUNDARY_POINTS_TOPIC)?;
        self.boundary = Some(Boundary { topic, points, left: lines.into_iter() });
        Ok(())
    }

    fn try_rejected(
        &mut self,
        mut points: RejectedPoints,
        causes: &[RejectedCause],
        every: u64,
    ) -> Result<(), RecordError> {
        if self.open.is_some() {
            return Err(RecordError::OverviewClosed);
        }
        self.log.metadata(REJECTED_RECORD, &rejected::describe(causes, points.len(), every))?;
        let mut topic = self.log.topic::<PointCloud>(REJECTED_TOPIC)?;
        self.log.message(&mut topic, START, points.encoder.message(stamp(START)?)?)
    }

    fn try_overview(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        self.announce((rows.len() / self.encoder.packer().columns()) as u64)?;
        self.encoder.push(rows)
    }

    fn try_overview_packed(&mut self, points: &[u8]) -> Result<(), RecordError> {
        let more = self.whole_points(points)?;
        self.announce(more)?;
        self.encoder.push_packed(points);
        Ok(())
    }

    /// Checks that `more` points may be added to the overview.
    fn announce(&self, more: u64) -> Result<(), RecordError> {
        if self.open.is_some() {
            return Err(RecordError::OverviewClosed);
        }
        let (found, expected) = (self.encoder.len() as u64 + more, self.plan.overview_points);
        if found > expected {
            return Err(RecordError::Count { what: "overview", found, expected });
        }
        Ok(())
    }

    /// The number of points in some bytes.
    fn whole_points(&self, points: &[u8]) -> Result<u64, RecordError> {
        let stride = self.encoder.packer().stride();
        if points.len().is_multiple_of(stride) {
            return Ok((points.len() / stride) as u64);
        }
        let bytes = points.len();
        Err(RecordError::Layout(format!("{bytes} bytes are no whole number of points of {stride}")))
    }

    fn try_push(&mut self, slice: u64, rows: &[f64]) -> Result<(), RecordError> {
        let columns = self.encoder.packer().columns();
        let more = (rows.len() / columns) as u64;
        self.push_parts(slice, more, columns, rows, CloudEncoder::push)
    }

    fn try_push_packed(&mut self, slice: u64, points: &[u8]) -> Result<(), RecordError> {
        let more = self.whole_points(points)?;
        let stride = self.encoder.packer().stride();
        self.push_parts(slice, more, stride, points, |encoder, points| {
            encoder.push_packed(points);
            Ok(())
        })
    }

    /// Adds `more` points of a slice, each of which is `width` elements of `points`, in as many messages as they
    /// need.
    fn push_parts<T>(
        &mut self,
        slice: u64,
        more: u64,
        width: usize,
        points: &[T],
        push: impl Fn(&mut CloudEncoder, &[T]) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        let mut open = self.open_slices()?;
        if slice < open.slice || slice >= self.plan.slices {
            let (first, end) = (open.slice, self.plan.slices);
            return Err(RecordError::Slice { slice, first, end });
        }
        if slice > open.slice {
            open = self.close_until(open, slice)?;
        }
        self.pushed += more;
        let mut rest = points;
        while !rest.is_empty() {
            if self.encoder.len() == self.plan.message_points {
                open = self.write_part(open)?;
            }
            let room = (self.plan.message_points - self.encoder.len()) * width;
            let (now, later) = rest.split_at(room.min(rest.len()));
            push(&mut self.encoder, now)?;
            rest = later;
        }
        Ok(())
    }

    /// Writes the overview, unless that has been done, and opens the first slice.
    fn open_slices(&mut self) -> Result<Open, RecordError> {
        if let Some(open) = self.open {
            return Ok(open);
        }
        let (found, expected) = (self.encoder.len() as u64, self.plan.overview_points);
        if found != expected {
            return Err(RecordError::Count { what: "overview", found, expected });
        }
        self.bounds = self.encoder.bounds();
        if let Some(bounds) = self.bounds {
            let mut topic = self.log.topic::<SceneUpdate>(AXES_TOPIC)?;
            let mut message = Vec::new();
            labelled_box(&self.layout, bounds, stamp(START)?)
                .encode(&mut message)
                .map_err(|reason| RecordError::Layout(format!("the axes: {reason}")))?;
            self.log.message(&mut topic, START, &message)?;
        }
        if self.plan.slices > 1 {
            // Otherwise it hides the slice, which has the same colours.
            self.encoder.fade();
        }
        self.log.message(&mut self.overview, START, self.encoder.message(stamp(START)?)?)?;
        self.encoder.clear();
        Ok(*self.open.insert(Open { slice: 0, parts: 0, points: 0 }))
    }

    /// Closes slices, with or without points, until `end` is open.
    fn close_until(&mut self, mut open: Open, end: u64) -> Result<Open, RecordError> {
        while open.slice < end {
            let slice = open.slice;
            if self.encoder.len() > 0 {
                self.write_part(open)?;
                self.written += 1;
            }
            if (slice + 1).is_multiple_of(self.plan.slices.div_ceil(FLUSHES)) {
                self.log.flush()?;
            }
            open = *self.open.insert(Open { slice: slice + 1, parts: 0, points: 0 });
        }
        Ok(open)
    }

    /// Writes the boundary that goes with a slice, if there is one still to be written.
    fn write_boundary(&mut self, slice: u64, time: u64) -> Result<(), RecordError> {
        let Some(boundary) = &mut self.boundary else { return Ok(()) };
        let Some(rings) = boundary.at(slice) else { return Ok(()) };
        let mut message = Vec::new();
        lines(&self.layout.frame_id, stamp(time)?, &rings)
            .encode(&mut message)
            .map_err(|reason| RecordError::Layout(format!("the boundary: {reason}")))?;
        self.log.message(&mut boundary.topic, time, &message)?;
        let points = dots(&self.layout.frame_id, stamp(time)?, &rings)?;
        self.log.message(&mut boundary.points, time, &points)
    }

    /// Says which slice is shown, and how many points it has so far.
    fn tell(&mut self, slice: u64, points: u64, time: u64) -> Result<(), RecordError> {
        let row = self.told.row(slice, points);
        self.slice.write(&mut self.log, time, &row)?;
        let (Some(label), Some(bounds)) = (&mut self.label, self.bounds) else { return Ok(()) };
        let mut message = Vec::new();
        slice_label(&self.layout.frame_id, bounds, &self.told.words(slice, points), stamp(time)?)
            .encode(&mut message)
            .map_err(|reason| RecordError::Layout(format!("the label: {reason}")))?;
        self.log.message(label, time, &message)
    }

    /// Writes the gathered points as the open slice's next message.
    fn write_part(&mut self, open: Open) -> Result<Open, RecordError> {
        const LIMIT: u64 = SLICE_STEP / PART_STEP;
        let Open { slice, parts, points } = open;
        let points = points + self.encoder.len() as u64;
        if parts == LIMIT {
            return Err(RecordError::SliceTooLarge { slice, limit: LIMIT });
        }
        let time = START + self.written * SLICE_STEP + parts * PART_STEP;
        self.write_boundary(slice, time)?;
        self.tell(slice, points, time)?;
        self.log.message(&mut self.slices, time, self.encoder.message(stamp(time)?)?)?;
        self.encoder.clear();
        Ok(*self.open.insert(Open { slice, parts: parts + 1, points }))
    }
}

impl Boundary {
    /// The lines that are shown from this slice on, if they differ from those before. Slices may have been skipped.
    fn at(&mut self, slice: u64) -> Option<Vec<ClosedLine>> {
        let mut latest = None;
        while self.left.as_slice().first().is_some_and(|next| next.0 <= slice) {
            latest = self.left.next().map(|(_, lines)| lines);
        }
        latest
    }
}

fn stamp(nanoseconds: u64) -> Result<Timestamp, RecordError> {
    const SECOND: u64 = 1_000_000_000;
    u32::try_from(nanoseconds / SECOND)
        .ok()
        .and_then(|seconds| Timestamp::new_checked(seconds, (nanoseconds % SECOND) as u32))
        .ok_or_else(|| RecordError::Layout(format!("{nanoseconds} ns do not fit a timestamp")))
}

fn describe(layout: &CloudLayout, plan: &Plan) -> Metadata {
    let [low, high] = layout.color_range;
    [
        ("axes", layout.axes.join(",")),
        ("units", layout.units.join(",")),
        ("scale", layout.scale.map(|factor| factor.to_string()).join(",")),
        ("scalars", layout.scalars.join(",")),
        ("color", layout.color.clone()),
        ("color_map", "viridis".into()),
        ("color_min", low.to_string()),
        ("color_max", high.to_string()),
        ("points", plan.points.to_string()),
        ("slices", plan.slices.to_string()),
        ("slice_seconds", (SLICE_STEP as f64 * 1e-9).to_string()),
        ("message_points_max", plan.message_points.to_string()),
        ("overview_points", plan.overview_points.to_string()),
        ("overview_every", plan.overview_every.to_string()),
        ("overview_decimated", (plan.overview_every > 1).to_string()),
    ]
    .map(|(key, value)| (key.to_string(), value))
    .into()
}
