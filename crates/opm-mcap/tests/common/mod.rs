//! A small workspace whose points are known in closed form, and what reads it back.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::convert::Infallible;
use std::path::{Path, PathBuf};

use opm_mcap::{CloudLayout, Metadata, ReadError, RecordError, Recording, Sink};
use opm_mcap::{SliceAxis, SliceReader, Slices};
use opm_mcap::{Workspace, WorkspaceRecorder, workspace};

pub const MECHANISM: &[u8] = b"format = 1\nname = \"test\"\n";

/// x y xi, the scalar theta11, and colour by S1, which is not stored.
pub fn layout() -> CloudLayout {
    CloudLayout {
        axes: ["x", "y", "xi"].map(String::from),
        scalars: vec!["theta11".into()],
        color: "S1".into(),
        color_range: [-1.0, 1.0],
        frame_id: "base".into(),
        scale: [1.0; 3],
        units: ["m", "m", "rad"],
    }
}

/// Axes alone, coloured by the first: the smallest point there is.
pub fn bare_layout() -> CloudLayout {
    CloudLayout { scalars: vec![], color: "x".into(), ..layout() }
}

pub fn workspace(layout: CloudLayout, points: u64, slices: u64) -> Workspace<'static> {
    Workspace {
        layout,
        mechanism_name: "test.toml",
        mechanism: MECHANISM,
        run: record([("mode", "++ ++ ++ +"), ("grid", "x=0:1:3")]),
        points,
        slices: slices_of(slices),
    }
}

/// Slices at xi = 0, 1, 2 ...; a point stands for a quarter.
pub fn slices_of(count: u64) -> Slices {
    let ends = [0.0, count as f64 - 1.0];
    let xi = SliceAxis { name: "xi".into(), unit: "rad", ends, count };
    Slices { axes: vec![xi], point_area: 0.25 }
}

pub fn record<const N: usize>(pairs: [(&str, &str); N]) -> Metadata {
    pairs.map(|(key, value)| (key.to_string(), value.to_string())).into()
}

/// Point number `i` in [`layout`].
pub fn row(i: u64) -> [f64; 5] {
    let i = i as f64;
    [0.001 * i, -0.002 * i, 0.5 * i, (0.1 * i).sin(), (0.3 * i).cos()]
}

/// Rows `range` one behind the other.
pub fn rows(range: std::ops::Range<u64>) -> Vec<f64> {
    range.flat_map(row).collect()
}

/// Records `counts[s]` points in slice s, handed over `portion` at a time.
pub fn record_slices<W: Sink>(sink: W, counts: &[u64], portion: usize) -> Result<(), RecordError> {
    let points = counts.iter().sum();
    let description = workspace(layout(), points, counts.len() as u64);
    let mut recorder = WorkspaceRecorder::new(sink, &description)?;
    for part in rows(0..points).chunks(5 * portion) {
        recorder.overview(part)?;
    }
    let mut first = 0;
    for (slice, count) in counts.iter().enumerate() {
        for part in rows(first..first + count).chunks(5 * portion) {
            recorder.push(slice as u64, part)?;
        }
        first += count;
    }
    recorder.finish(&record([("reachable", &points.to_string())]))
}

/// The same in memory.
pub fn recorded(counts: &[u64], portion: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    record_slices(std::io::Cursor::new(&mut bytes), counts, portion).unwrap();
    bytes
}

/// A cloud read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    pub topic: String,
    pub time: u64,
    pub slice: Option<u64>,
    /// Field by field.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Seen {
    pub fn column(&self, name: &str) -> &[f64] {
        let found = self.columns.iter().find(|(field, _)| field == name);
        &found.unwrap_or_else(|| panic!("no field {name}")).1
    }

    pub fn len(&self) -> usize {
        self.column("x").len()
    }
}

/// Reads all clouds.
pub fn clouds(path: &Path) -> Result<(Vec<Seen>, Recording), ReadError> {
    let (mut seen, mut slices) = (Vec::new(), SliceReader::default());
    let recording = opm_mcap::read(path, |message| -> Result<(), ReadError> {
        let slice = slices.slice(message)?;
        let Some(cloud) = message.cloud()? else { return Ok(()) };
        assert_eq!(cloud.frame_id, "base");
        assert_eq!(cloud.time, Some(message.time), "stamp and log time agree");
        let column = |name: &str| (name.to_string(), cloud.column(name).unwrap().collect());
        seen.push(Seen {
            topic: message.topic.into(),
            time: message.time,
            slice: slice.filter(|_| message.topic == workspace::SLICES_TOPIC),
            columns: cloud.fields().map(column).collect(),
        });
        Ok(())
    })?;
    Ok((seen, recording))
}

/// Writes `bytes` to a file of this name in `directory`.
pub fn file(directory: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = directory.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// A visitor that looks at nothing.
pub fn nothing(_: &opm_mcap::Message<'_>) -> Result<(), Never> {
    Ok(())
}

/// The error of [`nothing`].
#[derive(Debug)]
pub enum Never {
    Read(ReadError),
    Visit(Infallible),
}

impl From<ReadError> for Never {
    fn from(error: ReadError) -> Self {
        Self::Read(error)
    }
}
