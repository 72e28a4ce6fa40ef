//! `opm inspect`: the contents of a recording.

use crate::args::{InspectArgs, Output};
use crate::failure::Failure;
use crate::output::Shown;
use crate::text::{Table, count, short};
use opm_core::text::cell;
use opm_mcap::{Metadata, ReadError, Recording, read};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Nanoseconds per second.
const SECOND: f64 = 1e9;

pub fn run(args: &InspectArgs, output: &Output) -> Result<(), Failure> {
    let label = args.file.shown();
    let recording = read::<ReadError>(&args.file, |_| Ok(())).map_err(|error| match error {
        ReadError::Io { source, .. } => Failure::at(&label, source),
        ReadError::NotMcap { .. } => Failure::because(format!("{label}: not an MCAP file"), error),
        _ => Failure::at(&label, error),
    })?;
    output.print(&json(&label, &recording), text(&label, &recording))?;
    if !recording.complete {
        output.warn(format_args!("{label}: the run that wrote it was cut short"));
    }
    Ok(())
}

fn json(label: &str, recording: &Recording) -> Value {
    let record = |record: &Metadata| -> Map<String, Value> {
        record.iter().map(|(key, value)| (key.clone(), Value::from(&**value))).collect()
    };
    let topics: Vec<_> = (recording.topics.iter())
        .map(|t| json!({ "name": t.name, "schema": t.schema, "messages": t.messages, "points": t.points }))
        .collect();
    let extents: Map<String, Value> =
        recording.extents.iter().map(|e| (e.field.clone(), json!([e.min, e.max]))).collect();
    let metadata: Map<String, Value> = (recording.metadata.iter())
        .map(|(name, found)| (name.clone(), record(found).into()))
        .collect();
    let attachments: Vec<_> = (recording.attachments.iter())
        .map(|a| json!({ "name": a.name, "media_type": a.media_type, "size": a.size }))
        .collect();
    json!({
        "file": label,
        "complete": recording.complete,
        "topics": topics,
        "time": recording.time_range.map(|range| range.map(|t| t as f64 / SECOND)),
        "extents": extents,
        "metadata": metadata,
        "attachments": attachments,
    })
}

fn text(label: &str, recording: &Recording) -> String {
    let state = if recording.complete { "complete" } else { "cut short: what could be recovered" };
    let mut text = format!("{label}: {state}\n\n");
    let mut topics = Table::new(["topic", "schema", ">messages", ">points"]);
    for topic in &recording.topics {
        let points = topic.points.map_or(String::new(), count);
        topics.row([&topic.name, &topic.schema, &count(topic.messages), &points]);
    }
    let _ = write!(text, "{topics}");
    if let Some([start, end]) = recording.time_range {
        let seconds = (end - start) as f64 / SECOND;
        let _ = writeln!(text, "\nplays for {} s", short(seconds));
    }
    if !recording.extents.is_empty() {
        let mut extents = Table::new(["value", ">min", ">max"]);
        for extent in &recording.extents {
            extents.row([extent.field.clone(), short(extent.min), short(extent.max)]);
        }
        let _ = write!(text, "\n{extents}");
    }
    for (name, record) in &recording.metadata {
        let mut table = Table::new([&**name, ""]);
        for (key, value) in record {
            table.row([format!("  {key}"), value.clone()]);
        }
        let _ = write!(text, "\n{table}");
    }
    for attachment in &recording.attachments {
        let (name, kind) = (cell(&attachment.name), cell(&attachment.media_type));
        let _ = writeln!(text, "\nattached: {name}, {kind}, {} bytes", count(attachment.size));
    }
    text
}
