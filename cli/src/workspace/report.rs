//! The printed results of a workspace: text for people, and JSON.

use super::aspects;
use crate::interference::set_aside_json;
use crate::output::named;
use crate::text::{self, Table, count, plural, set_aside_text, short};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_study::{Analysis, Shape, Workspace, WorkspaceKind, setup_fields};
use opm_workspace::{Axis, GridSet, Outline, Sections, Shard};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Number of components that are listed one by one.
const LISTED: usize = 6;

/// The effort of the count.
#[derive(Clone, Copy, Debug)]
pub enum Effort {
    /// A sweep of this number of poses, with its duration.
    Counted { poses: u64, seconds: f64 },
    /// Sweeps of shards, whose times are unknown.
    Merged { shards: u64 },
    /// An earlier sweep.
    Earlier,
}

/// The results of a run, for printing.
pub struct Outcome<'a> {
    pub workspace: &'a Workspace,
    pub analysis: &'a Analysis,
    pub effort: Effort,
    /// The part of the workspace, if it is not the whole.
    pub shard: Option<Shard>,
    /// The units of the mechanism file.
    pub units: FileUnits,
}

impl Outcome<'_> {
    /// The name of the counted points. A shard counts poses, whatever the kind of workspace is.
    fn counted(&self) -> WorkspaceKind {
        match (self.shard, self.workspace.kind().sections()) {
            (Some(_), Sections::Whole) => WorkspaceKind::Grid,
            _ => self.workspace.kind(),
        }
    }

    pub fn json(&self) -> Value {
        let Self { workspace, analysis, .. } = self;
        let found = &analysis.count;
        let axis = |a: &Axis| json!({ "min": a.min, "max": a.max, "count": a.count });
        let grid: Map<String, Value> =
            workspace.grid().axes().iter().map(|a| (a.name.clone(), axis(a))).collect();
        let ranges: Map<String, Value> = (workspace.manipulator().imaginary().iter())
            .zip(&found.imaginary)
            .map(|(joint, range)| (joint.name.clone(), json!(range)))
            .collect();
        let measure = workspace.measure(self.counted(), found, FileUnits::SI);
        let measure =
            measure.map(|m| json!({ "value": m.value, "units": m.unit, "method": "grid" }));
        let mut json = json!({
            "poses": found.poses,
            "reachable": found.reachable,
            "fraction": analysis.fraction(),
            "grid": grid,
            "mode": workspace.mode_name(),
            "measure": measure,
            "imaginary_range": ranges,
            "seconds": self.seconds(),
            "poses_per_second": self.rate(),
        });
        json["kind"] = workspace.kind().name().into();
        analysis_json(analysis, &mut json);
        if let Some(aspects) = &analysis.aspects {
            json["aspects"] = aspects::json(workspace, aspects);
            json["singularities"] =
                aspects::curves_json(workspace, analysis.singularities.as_deref());
        }
        if let Some(shard) = self.shard {
            json["shard"] = shard.to_string().into();
        }
        if let Some(limit) = workspace.limit() {
            if let Some(most) = limit.max_condition() {
                json["max_condition"] = most.into();
            }
            if !limit.indices.is_empty() {
                let each = limit.indices.iter().map(|(index, bound)| (index.name(), bound));
                json["limits"] = named(each).into();
            }
            json["characteristic_length"] = limit.length().into();
        }
        for (key, value) in setup_fields(workspace.setup(), workspace.manipulator()) {
            json[key] = value.into();
        }
        if let Some(clearance) = workspace.clearance() {
            json["clearance"] = clearance.least.into();
            json["set_aside"] = set_aside_json(&clearance.interference);
        }
        json
    }

    pub fn text(&self) -> String {
        let Self { workspace, analysis, units, .. } = *self;
        let (found, manipulator) = (&analysis.count, workspace.manipulator());
        let mut text = manipulator.mechanism().name.clone();
        if workspace.kind() != WorkspaceKind::Grid {
            let _ = write!(text, ", {}", workspace.kind().title());
        }
        let mode = workspace.mode_name();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        if let Some(shard) = self.shard {
            let _ = write!(text, ", shard {shard}");
        }
        let mut axes = Table::new(["grid", ">from", ">to", "unit", ">values"]);
        for (axis, c) in workspace.grid().axes().iter().zip(workspace.grid().coordinates()) {
            let end = |value| text::number(value, c.quantity, units);
            let symbol = units.symbol(c.quantity);
            axes.row([&*axis.name, &end(axis.min), &end(axis.max), symbol, &count(axis.count)]);
        }
        let _ = writeln!(text, "\n\n{axes}");
        if let Some(limit) = workspace.limit() {
            let length = units.show(limit.length(), Quantity::Length);
            if let Some(most) = limit.max_condition() {
                let _ = writeln!(text, "condition number at most {most} (lengths over {length})");
            }
            for (index, bound) in limit.indices.iter() {
                let opm_analysis::Facts { unit, about, large_is_good, .. } = index.facts();
                let most = if large_is_good { "least" } else { "most" };
                let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
                let _ = writeln!(text, "{about} at {most} {bound}{unit}");
            }
            text.push('\n');
        }
        if let Some(clearance) = workspace.clearance() {
            let least = units.show(clearance.least, Quantity::Length);
            let aside = set_aside_text(&clearance.interference, units);
            let aside = aside.map_or_else(String::new, |aside| aside + "\n");
            let _ = writeln!(text, "bodies at least {least} apart\n{aside}");
        }

        let share = match found.poses {
            0 => "no poses of its own".to_owned(),
            poses => format!("{} %", short(100.0 * found.reachable as f64 / poses as f64)),
        };
        let points = [self.counted().point_name(), &format!(">{}", count(found.poses)), ">"];
        let mut results = Table::new(points);
        let reached = self.counted().member_name().to_owned();
        results.row([reached, count(found.reachable), share]);
        let _ = write!(text, "{results}");
        if workspace.grid().poses() > 1
            && let Some(measure) = workspace.measure(self.counted(), found, units)
        {
            let _ = writeln!(text, "size in coordinates {} {}", short(measure.value), measure.unit);
        }
        text += &analysis_text(analysis, units);
        if let Some(aspects) = &analysis.aspects {
            text += &aspects::text(workspace, aspects, units);
        }

        if found.imaginary.iter().any(Option::is_some) {
            let mut ranges = Table::new(["imaginary joint", ">min", ">max", "unit"]);
            for (joint, range) in manipulator.imaginary().iter().zip(&found.imaginary) {
                let Some(range) = range else { continue };
                let [low, high] = range.map(|value| text::number(value, joint.quantity, units));
                ranges.row([&*joint.name, &low, &high, units.symbol(joint.quantity)]);
            }
            let _ = write!(text, "\n{ranges}");
        }
        let _ = match self.effort {
            Effort::Counted { poses, seconds } => {
                let rate = short(poses as f64 / seconds / 1e6);
                writeln!(text, "\ncounted in {} s, {rate} million poses/s", short(seconds))
            }
            Effort::Merged { shards } => {
                writeln!(text, "\nmerged from {}", plural(shards, "shard"))
            }
            Effort::Earlier => Ok(()),
        };
        text
    }

    /// The time of the count; `None` if it was counted elsewhere.
    fn seconds(&self) -> Option<f64> {
        match self.effort {
            Effort::Counted { seconds, .. } => Some(seconds),
            Effort::Merged { .. } | Effort::Earlier => None,
        }
    }

    /// Poses per second.
    fn rate(&self) -> Option<f64> {
        match self.effort {
            Effort::Counted { poses, seconds } => Some(poses as f64 / seconds),
            Effort::Merged { .. } | Effort::Earlier => None,
        }
    }
}

/// Adds the known results to the JSON of a workspace.
fn analysis_json(analysis: &Analysis, json: &mut Value) {
    if let Some(visits) = &analysis.visits {
        json["orientations"] = visits.orientations().into();
    }
    if let (Some(shape), Some(set)) = (&analysis.shape, &analysis.set) {
        let Shape { components, boundary } = shape;
        json["components"] = json!({ "number": components.len(), "sizes": components });
        json["boundary"] = boundary.as_ref().map_or(Value::Null, |lines| boundary_json(set, lines));
    }
    if let Some(index) = &analysis.conditioning {
        let none = index.poses == 0;
        json["conditioning"] = json!({
            "characteristic_length": index.length,
            "global": index.global(),
            "local_min": (!none).then_some(index.min),
            "local_max": (!none).then_some(index.max),
        });
    }
}

/// The boundary, slice by slice.
fn boundary_json(set: &GridSet, outlines: &[Outline]) -> Value {
    let axes = set.varying();
    let name = |i: usize| set.axes()[axes[i]].axis.name.clone();
    let slices: Vec<Value> = (outlines.iter())
        .map(|outline| {
            let at: Map<String, Value> = (outline.slice.into_iter())
                .map(|number| (name(2), set.axes()[axes[2]].axis.value(number).into()))
                .collect();
            let rings: Vec<&[[f64; 2]]> = outline.rings.iter().map(|ring| &*ring.points).collect();
            json!({ "at": at, "area": outline.area(), "rings": rings })
        })
        .collect();
    json!({ "axes": [name(0), name(1)], "slices": slices })
}

/// The known results for the points, line by line.
fn analysis_text(analysis: &Analysis, units: FileUnits) -> String {
    let mut text = String::new();
    if let Some(visits) = &analysis.visits {
        let word = if analysis.kind == WorkspaceKind::Dexterous { "all" } else { "any" };
        let number = count(visits.orientations());
        let _ = writeln!(text, "in {word} of {number} orientations");
    }
    if let (Some(shape), Some(set)) = (&analysis.shape, &analysis.set) {
        text += &shape_text(shape, analysis.kind, set);
    }
    if let Some(index) = &analysis.conditioning {
        let length = units.show(index.length, Quantity::Length);
        let _ = match index.global() {
            Some(global) => writeln!(
                text,
                "conditioning index {} on average, {} to {} (lengths over {length})",
                short(global),
                short(index.min),
                short(index.max),
            ),
            None => writeln!(text, "no pose has a conditioning index"),
        };
    }
    text
}

/// Components and boundary.
fn shape_text(shape: &Shape, kind: WorkspaceKind, set: &GridSet) -> String {
    let mut text = String::new();
    let Shape { components, boundary } = shape;
    let sizes: Vec<String> = components.iter().take(LISTED).map(|&size| count(size)).collect();
    let more = if components.len() > LISTED { ", ..." } else { "" };
    let _ = match components.len() {
        0 => Ok(()),
        _ if kind == WorkspaceKind::Aspects => Ok(()),
        1 => writeln!(text, "connected: one component"),
        number => {
            let (sizes, points) = (sizes.join(", "), kind.point_name());
            writeln!(text, "{number} connected components: {sizes}{more} {points}")
        }
    };
    let Some(outlines) = boundary else { return text };
    let rings: usize = outlines.iter().map(|outline| outline.rings.len()).sum();
    let holes = outlines.iter().flat_map(|outline| &outline.rings);
    let holes = holes.filter(|ring| ring.area() < 0.0).count();
    if rings == 0 {
        return text;
    }
    let lines = if rings == 1 { "closed line" } else { "closed lines" };
    let around = match holes {
        0 => String::new(),
        1 => ", one of them around a hole".to_owned(),
        holes => format!(", {holes} of them around holes"),
    };
    let slices = match set.varying()[..] {
        [_, _, slow] => format!(" in slices of {}", set.axes()[slow].axis.name),
        _ => String::new(),
    };
    let _ = writeln!(text, "boundary: {} {lines}{slices}{around}", count(rings as u64));
    text
}
