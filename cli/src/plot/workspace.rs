//! The picture of a workspace: slices of it, and the values of its imaginary joints.

use super::cloud::JointCloud;
use super::label::value_label;
use super::layout::Layout;
use super::options::PanelName;
use super::sized::drawn;
use super::slices::{In, Slices, rounded};
use super::source::{Rate, ReadStop, Source};
use crate::args::{Output, PlotArgs};
use crate::failure::Failure;
use crate::text::count;
use opm_core::Quantity;
use opm_mcap::rejected::{REJECTED_RECORD, REJECTED_TOPIC};
use opm_mcap::workspace::SLICES_TOPIC;
use opm_mcap::{RejectedCause, SliceReader};
use opm_plot::{Drawing, Heading, TileFigure};
use opm_study::WorkspaceKind;
use opm_workspace::Axis;

pub fn draw(source: &Source<'_>, args: &PlotArgs, output: &Output) -> Result<Drawing, Failure> {
    let wanted = |panel: PanelName| args.panels.contains(&panel);
    for panel in &args.panels {
        if !matches!(panel, PanelName::Slices | PanelName::Rejected | PanelName::Imaginary) {
            let problem = format!("{} are of a motion, not of a workspace", panel.name());
            return Err(Failure::flag("--panels", problem));
        }
    }
    let layout = Layout::new(source);
    let points = source.recording.topic(SLICES_TOPIC).and_then(|topic| topic.points);
    if points.unwrap_or(0) == 0 {
        let run = source.metadata("run");
        let mut limited = Vec::new();
        limited.extend(run.get("max_condition").map(|_| "condition number"));
        limited.extend(run.keys().filter_map(|key| key.strip_prefix("limit.")));
        let (label, nothing) = (&source.label, layout.kind.nothing(&limited));
        return Err(Failure::work(format!("{label}: nothing to draw: {nothing}")));
    }
    let (view, joints) = chosen(&layout, source, args)?;
    // A set without an axis on a grid has no slices, unless they are requested.
    let default = args.panels.is_empty() && layout.kind != WorkspaceKind::Imaginary;
    let has_rejected = source.recording.topic(REJECTED_TOPIC).is_some();
    if wanted(PanelName::Rejected) && !has_rejected {
        let problem = "rejected: the recording has no rejected points; record with --explain";
        return Err(Failure::flag("--panels", problem));
    }
    let mut slices = match default || wanted(PanelName::Slices) || wanted(PanelName::Rejected) {
        true => Some(Slices::new(&layout, source, args, view)?),
        false => None,
    };
    let shown = slices.as_ref().filter(|_| default && has_rejected || wanted(PanelName::Rejected));
    let cells = shown.filter(|slices| slices.are_cells());
    if shown.is_some() && cells.is_none() {
        let problem =
            "rejected points are drawn over coordinates of the grid; record without --axes tip";
        if wanted(PanelName::Rejected) {
            return Err(Failure::flag("--panels", problem));
        }
        output.note(format_args!("{}: {problem}", source.label));
    }
    let mut rejected = cells.map(|slices| {
        slices.rejected(RejectedCause::read(&source.metadata(REJECTED_RECORD)), source)
    });
    let mut cloud = JointCloud::new(layout.kind, source, &joints);
    let meant = args.panels.is_empty() && layout.kind.is_of_poses();
    if cloud.is_none() && (meant || wanted(PanelName::Imaginary)) {
        let hint = missing(source);
        if wanted(PanelName::Imaginary) && slices.is_none() {
            let problem = format!("imaginary: {}: {hint}", source.label);
            return Err(Failure::flag("--panels", problem));
        }
        // A mechanism in one subspace has none to record.
        let none = source.manipulator().is_some_and(|known| known.imaginary().is_empty());
        if wanted(PanelName::Imaginary) || !none {
            output.note(format_args!("{}: {hint}", source.label));
        }
    }
    if !args.panels.is_empty() && !wanted(PanelName::Imaginary) {
        cloud = None;
    }

    let mut reader = SliceReader::default();
    source.messages(|message| {
        let slice = reader.slice(message)?;
        if let (REJECTED_TOPIC, Some(rejected)) = (message.topic, &mut rejected) {
            if let Some(found) = message.cloud()? {
                rejected.add_rejected(&found);
            }
            return Ok(());
        }
        if message.topic != SLICES_TOPIC {
            return Ok::<(), ReadStop>(());
        }
        let (Some(found), Some(slice)) = (message.cloud()?, slice) else {
            return Ok(());
        };
        if let Some(slices) = &mut slices {
            slices.add(&found, In::Slice(slice));
        }
        if let Some(cloud) = &mut cloud {
            cloud.add(&found);
        }
        Ok(())
    })?;

    let mut heading = heading(source, &layout);
    let mut sections = vec![];
    if let Some(mut slices) = slices {
        slices.drop_empty();
        // What is rejected may differ where what is reached does not.
        if rejected.is_none() {
            slices.merge_equal();
        }
        slices.find_singularities(source)?;
        if let Some(rejected) = &mut rejected {
            rejected.keep_those_of(&slices);
        }
        if default || wanted(PanelName::Slices) {
            heading.notes.extend(slices.notes());
            sections.push(slices.section(source));
        }
    }
    if let Some(rejected) = rejected {
        let every =
            source.metadata(REJECTED_RECORD).get("every").and_then(|text| text.parse().ok());
        if let Some(every) = every.filter(|every: &u64| *every > 1) {
            heading.notes.push(format!(
                "One in {} rejected {} is drawn.",
                count(every),
                layout.kind.point_name()
            ));
        }
        sections.push(rejected.section(source));
    }
    if let Some(cloud) = cloud {
        heading.notes.extend(cloud.notes());
        sections.push(cloud.section());
    }
    heading.notes.extend(source.notes());
    let figure = TileFigure { heading, sections };
    drawn(args, |size| figure.draw(size))
}

/// The selection of `--values`: the two coordinates that the slices show, and stored values.
fn chosen(
    layout: &Layout,
    source: &Source<'_>,
    args: &PlotArgs,
) -> Result<(Option<[usize; 2]>, Vec<String>), Failure> {
    let wrong = |problem: String| Err(Failure::flag("--values", problem));
    let (mut view, mut joints) = (vec![], vec![]);
    for name in &args.values {
        if view.iter().any(|&i: &usize| layout.coordinates[i].name == *name)
            || joints.contains(name)
        {
            return wrong(format!("{name} is given twice"));
        }
        if let Some(number) = layout.find(name) {
            view.push(number);
        } else if layout.scalars.contains(name) {
            joints.push(name.clone());
        } else {
            let known = [&[layout.names()], &layout.scalars[..]].concat().join(", ");
            return wrong(format!("{name:?} is not one of {known}"));
        }
    }
    let view = match view[..] {
        [] => None,
        [a, b] => Some([a, b]),
        _ => {
            let names = layout.names();
            return wrong(format!("two of {names} are seen at a time, not {}", view.len()));
        }
    };
    if joints.is_empty() {
        let names = source.imaginary().iter().map(|joint| joint.name.clone());
        joints = names.filter(|name| layout.scalars.contains(name)).collect();
    }
    Ok((view, joints))
}

/// Advice how to record missing values.
fn missing(source: &Source<'_>) -> String {
    let names: Vec<&str> = source.imaginary().iter().map(|joint| &*joint.name).collect();
    match &names[..] {
        [] => "no values of imaginary joints are stored with the points".to_owned(),
        names => format!(
            "without the imaginary joints; to draw them too, record with --scalars {}",
            names.join(",")
        ),
    }
}

fn heading(source: &Source<'_>, layout: &Layout) -> Heading {
    let (run, result) = (source.metadata("run"), source.metadata("result"));
    let mut parts = vec![];
    if let Some(mode) = run.get("mode").filter(|mode| !mode.is_empty()) {
        parts.push(format!("mode {mode}"));
    }
    if let Some(most) = run.get("max_condition") {
        parts.push(format!("condition number at most {most}"));
    }
    for (name, bound) in run.iter().filter_map(|(key, v)| Some((key.strip_prefix("limit.")?, v))) {
        parts.push(format!("limit {name} = {bound}"));
    }
    let number = |text: Option<&String>| text.and_then(|text| text.parse::<u64>().ok());
    match (number(result.get("reachable")), number(run.get("poses"))) {
        (Some(reachable), Some(poses)) if poses > 0 => {
            let share = value_label(100.0 * reachable as f64 / poses as f64);
            let (reachable, poses) = (count(reachable), count(poses));
            let (points, reached) = (layout.kind.point_name(), layout.kind.member_name());
            parts.push(format!("{reachable} of {poses} {points} {reached} ({share} %)"));
        }
        _ => {
            let points = source.recording.topic(SLICES_TOPIC).and_then(|topic| topic.points);
            parts.push(format!("{} {}", count(points.unwrap_or(0)), layout.kind.point_name()));
        }
    }
    let mut lines = vec![format!("{}; {}", parts.join(", "), source.units_line())];
    let grid: Vec<String> =
        layout.grid.iter().map(|(quantity, axis)| range(source, *quantity, axis)).collect();
    if !grid.is_empty() {
        lines.push(format!("grid (values): {}", grid.join(", ")));
    }
    let mut title = source.title();
    title.push_str(": ");
    title.push_str(layout.kind.title());
    Heading { title, lines, notes: vec![] }
}

/// The text of a grid axis in the heading.
fn range(source: &Source<'_>, quantity: Quantity, axis: &Axis) -> String {
    let (measure, factor) = source.measure(&axis.name, Some(quantity), Rate::Position);
    let [min, max] = [0, axis.count - 1].map(|end| value_label(rounded(axis, end) / factor));
    let symbol = &measure.unit.symbol;
    let text = match axis.count {
        1 => format!("{} = {min} {symbol}", axis.name),
        values => format!("{} {min} to {max} {symbol} ({})", axis.name, count(values)),
    };
    // A line does not break between a name and its range.
    text.replace(' ', "\u{a0}")
}
