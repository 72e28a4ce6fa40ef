//! The Python script that shows a recording in Rerun.

use super::plots::{Plot, columns};
use super::{Layout, View};
use crate::trajectory::{BODIES_TOPIC, FRAMES_TOPIC, SCENE_TOPIC, VIOLATIONS_TOPIC};
use crate::workspace::{AXES_TOPIC, BOUNDARY_POINTS_TOPIC, BOUNDARY_TOPIC, LABEL_TOPIC};
use serde_json::{Value, json};
use std::fmt::Write;

/// The place of the camera from the middle, in radii of what is shown.
const FROM: [f64; 3] = [1.7, -1.7, 1.2];

/// The beginning of every script.
const HEAD: &str = r#"
import subprocess
import sys
import tempfile
import uuid
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping


BOX = "/box"
GREY = [140, 140, 140]
# Those of Okabe and Ito, which people with any kind of colour vision tell apart; darker where there are more curves.
COLOURS = [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (86, 180, 233), (230, 159, 0), (240, 228, 66)]


def curves(title, topic, schema, names):
    """A plot of some fields of the messages of a topic."""

    def line(number, field, name):
        source = ComponentSourceKind.SourceComponent
        value = VisualizerComponentMapping(
            "Scalars:scalars", source, source_component=f"{schema}:message", selector=f".{field}"
        )
        dark = 0.6 ** (number // len(COLOURS))
        colour = [round(dark * part) for part in COLOURS[number % len(COLOURS)]]
        return rr.SeriesLines(names=name, colors=[colour]).visualizer(mappings=[value])

    lines = [line(number, *field) for number, field in enumerate(names.items())]
    return rrb.TimeSeriesView(name=title, origin="/", contents=topic, overrides={topic: lines})


def space(title, topics, eye, target):
    """A view in space."""
    return rrb.Spatial3DView(
        name=title, origin="/", contents=topics, eye_controls=rrb.EyeControls3D(position=eye, look_target=target)
    )


def load(recording, name, run):
    """Loads a recording, whose times are durations from its start on; as times of day where Rerun cannot convert it."""
    with tempfile.TemporaryDirectory() as folder:
        converted = Path(folder) / "recording.rrd"
        command = [sys.executable, "-m", "rerun_cli", "mcap", "convert", recording, "-o", converted]
        options = ["--timeline-type", "duration", "--application-id", name, "--recording-id", run]
        if subprocess.run([*command, *options], capture_output=True).returncode == 0:
            rr.log_file_from_contents(converted, converted.read_bytes())
        else:
            rr.log_file_from_path(recording)


"#;

/// The end of every script.
const TAIL: &str = r#"
blueprint = rrb.Blueprint(
    shown,
    rrb.BlueprintPanel(state="collapsed"),
    rrb.SelectionPanel(state="collapsed"),
    rrb.TimePanel(state="collapsed", timeline="message_log_time"),
)
run = uuid.uuid4().hex
rr.init(name, recording_id=run)
if len(sys.argv) > 1:
    rr.save(sys.argv[1], default_blueprint=blueprint)
else:
    rr.spawn(default_blueprint=blueprint)
load(recording, name, run)
for frame, low, high, labels in boxes:
    sizes = [b - a for a, b in zip(low, high)]
    box = rr.Boxes3D(mins=[low], sizes=[sizes], colors=[GREY], fill_mode="majorwireframe")
    rr.log(BOX, rr.CoordinateFrame(frame), box, static=True)
    ends = rr.Points3D(list(labels.values()), labels=list(labels), colors=[GREY], show_labels=True)
    rr.log(f"{BOX}/ends", rr.CoordinateFrame(frame), ends, static=True)
"#;

impl Layout {
    /// The text of a Python script that shows the recording in Rerun, for the package `rerun-sdk`. `recording` is its name,
    /// from the folder of the script. With an argument, the script saves what is shown as a file (`.rrd`) instead.
    pub fn rerun(&self, recording: &str) -> String {
        let mut text = String::from("# Shows a recording of opm in Rerun: pip install rerun-sdk\n");
        text += HEAD;
        let mut line = |text_: std::fmt::Arguments<'_>| {
            let _ = writeln!(text, "{text_}");
        };
        // Rerun's names have few kinds of characters.
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let name: String = self.title.chars().map(plain).collect();
        line(format_args!("name = {}", python(&json!(name))));
        line(format_args!("recording = Path(__file__).parent / {}", python(&json!(recording))));
        let views: Vec<String> = self.views.iter().map(space).collect();
        let columns = columns(&self.plots).map(|plots| {
            let plots: Vec<String> = plots.iter().map(curves).collect();
            format!(
                "rrb.Vertical({})",
                indented(&plots).replace('\n', "\n    ").replace("    )", ")")
            )
        });
        let columns: Vec<String> = columns.collect();
        line(format_args!("views = [{}]", indented(&views)));
        line(format_args!("columns = [{}]", indented(&columns)));
        // Every view of a cloud has the same box.
        let boxes: Vec<String> = self.views.iter().take(1).filter_map(labelled_box).collect();
        line(format_args!("boxes = [{}]", indented(&boxes)));
        if self.violations {
            line(format_args!(
                "log = rrb.TextLogView(name=\"Violations\", origin=\"{VIOLATIONS_TOPIC}\")"
            ));
            line(format_args!(
                "left = rrb.Vertical(*views, log, row_shares=[*(6 for _ in views), 1])"
            ));
        } else {
            line(format_args!("left = rrb.Horizontal(*views)"));
        }
        line(format_args!(
            "shown = rrb.Horizontal(left, *columns, column_shares=[3, *(2 / len(columns) for _ in columns)])"
        ));
        text + TAIL
    }
}

fn space(view: &View) -> String {
    let View { title, extent, shown, .. } = view;
    let (target, radius) = (extent.centre(), extent.radius());
    let eye: Vec<f64> = (0..3).map(|i| target[i] + FROM[i] * radius).collect();
    // Rerun shows no scenes; there are clouds of the same shapes.
    let topics = shown.iter().flat_map(|(topic, _)| match &**topic {
        SCENE_TOPIC => vec![format!("{BODIES_TOPIC}**"), FRAMES_TOPIC.to_owned()],
        BOUNDARY_TOPIC => vec![BOUNDARY_POINTS_TOPIC.to_owned()],
        LABEL_TOPIC => vec![],
        AXES_TOPIC => vec!["/box/**".to_owned()],
        other => vec![other.to_owned()],
    });
    let topics: Vec<String> = topics.collect();
    let arguments = [json!(title), json!(topics), json!(eye), json!(target)];
    format!("space({})", arguments.map(|argument| python(&argument)).join(", "))
}

/// The box of a cloud with the values at the ends of its axes.
fn labelled_box(view: &View) -> Option<String> {
    let View { frame, extent, labels, .. } = view;
    let named: serde_json::Map<String, Value> =
        labels.iter().map(|(at, text)| (text.clone(), json!(at))).collect();
    let items = [json!(frame), json!(extent.low), json!(extent.high), Value::Object(named)];
    let items = items.map(|item| python(&item)).join(", ");
    (!labels.is_empty()).then(|| format!("({items})"))
}

fn curves(plot: &Plot) -> String {
    let Plot { title, topic, schema, curves, .. } = plot;
    let names: serde_json::Map<String, Value> =
        curves.iter().map(|(field, name)| (field.clone(), json!(name))).collect();
    let arguments = [json!(title), json!(topic), json!(schema), Value::Object(names)];
    format!("curves({})", arguments.map(|argument| python(&argument)).join(", "))
}

/// A value as Python writes it: texts and numbers are those of JSON.
fn python(value: &Value) -> String {
    let joined = |items: Vec<String>| items.join(", ");
    match value {
        Value::Array(items) => format!("[{}]", joined(items.iter().map(python).collect())),
        Value::Object(items) => {
            let item =
                |(key, value): (&String, &Value)| format!("{}: {}", json!(key), python(value));
            format!("{{{}}}", joined(items.iter().map(item).collect()))
        }
        other => other.to_string(),
    }
}

/// Items of a list, one in a line.
fn indented(items: &[String]) -> String {
    let lines: String = items.iter().map(|item| format!("\n    {item},")).collect();
    if lines.is_empty() { lines } else { lines + "\n" }
}
