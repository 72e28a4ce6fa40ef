//! The aspects of a workspace, in words and in JSON.

use crate::text::{self, Table, count, short};
use opm_core::mechanism::file::FileUnits;
use opm_study::Workspace;
use opm_workspace::{Aspect, Aspects, Axis, Count, SingularCurves};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Number of aspects that are listed one by one in text.
const LISTED: usize = 12;

/// A part of so few poses tells more of the grid than of the mechanism.
const SPECK: u64 = 2;

/// The aspects without and with the specks, which come last: there are none where all are as small.
fn specks(aspects: &Aspects) -> (&[Aspect], &[Aspect]) {
    let list = aspects.list();
    let large = list.partition_point(|aspect| aspect.poses > SPECK);
    list.split_at(if large == 0 { list.len() } else { large })
}

/// The aspects: number, sign of the parallel measure, poses, measure, extent.
pub fn json(workspace: &Workspace, aspects: &Aspects) -> Value {
    let one = |(number, aspect): (usize, &Aspect)| {
        let extent: Map<String, Value> = (workspace.grid().axes().iter().zip(&aspect.extent))
            .map(|(axis, range)| (axis.name.clone(), json!(range)))
            .collect();
        let measure =
            workspace.measure(workspace.kind(), &counted(workspace, aspect), FileUnits::SI);
        json!({
            "aspect": number + 1,
            "mode": workspace.mode_name(),
            "sign": sign(aspect),
            "poses": aspect.poses,
            "measure": measure.map(|m| json!({ "value": m.value, "units": m.unit, "method": "grid" })),
            "extent": extent,
        })
    };
    let list: Vec<Value> = aspects.list().iter().enumerate().map(one).collect();
    let specks = specks(aspects).1.len();
    json!({ "number": list.len(), "specks": specks, "singular": aspects.singular(), "list": list })
}

/// The singularity curves, slice by slice.
pub fn curves_json(workspace: &Workspace, curves: Option<&[SingularCurves]>) -> Value {
    let Some(curves) = curves else { return Value::Null };
    let axes: Vec<&Axis> = workspace.grid().axes().iter().filter(|axis| axis.count > 1).collect();
    let slices: Vec<Value> = (curves.iter())
        .map(|curves| {
            let at: Map<String, Value> = (curves.slice.into_iter())
                .map(|number| (axes[2].name.clone(), axes[2].value(number).into()))
                .collect();
            json!({ "at": at, "lines": curves.lines })
        })
        .collect();
    json!({ "axes": [axes[0].name, axes[1].name], "slices": slices })
}

/// A table of the aspects, the largest first.
pub fn text(workspace: &Workspace, aspects: &Aspects, units: FileUnits) -> String {
    let grid = workspace.grid();
    let varying: Vec<usize> =
        (0..grid.axes().len()).filter(|&i| grid.axes()[i].count > 1).collect();
    let mut headers = vec![">aspect".to_owned(), "sign".to_owned(), ">poses".to_owned()];
    let measured =
        |aspect: &Aspect| workspace.measure(workspace.kind(), &counted(workspace, aspect), units);
    let unit = aspects.list().first().and_then(measured).map(|measure| measure.unit);
    headers.extend(unit.map(|unit| format!(">size [{unit}]")));
    for &i in &varying {
        headers.push(text::header(&grid.axes()[i].name, grid.coordinates()[i].quantity, units));
        headers.push(">to".to_owned());
    }
    let mut table = Table::new(headers);
    let (large, specks) = specks(aspects);
    for (number, aspect) in large.iter().take(LISTED).enumerate() {
        let mut row = vec![count(number as u64 + 1), sign(aspect).to_owned()];
        row.push(count(aspect.poses));
        row.extend(measured(aspect).map(|measure| short(measure.value)));
        for &i in &varying {
            let quantity = grid.coordinates()[i].quantity;
            row.extend(aspect.extent[i].map(|end| text::number(end, quantity, units)));
        }
        table.row(row);
    }
    let mut text = String::new();
    let poses = |of: &[Aspect]| count(of.iter().map(|aspect| aspect.poses).sum());
    if !aspects.list().is_empty() {
        let _ = write!(text, "\n{table}");
    }
    if let Some(more @ [_, ..]) = large.get(LISTED..) {
        let number = count(more.len() as u64);
        let _ = writeln!(text, "and {number} smaller aspects with {} poses", poses(more));
    }
    if !specks.is_empty() {
        let number = count(specks.len() as u64);
        let _ = writeln!(
            text,
            "and {number} specks of one or two poses, {} together: a finer --grid tells what they are",
            poses(specks)
        );
    }
    if aspects.singular() > 0 {
        let _ = writeln!(text, "singular, and in no aspect: {} poses", count(aspects.singular()));
    }
    text
}

/// The sign of the parallel measure.
fn sign(aspect: &Aspect) -> &'static str {
    if aspect.is_positive() { "+" } else { "-" }
}

/// The count of the poses of one aspect.
fn counted(workspace: &Workspace, aspect: &Aspect) -> Count {
    let mut counted = Count::nothing(workspace.manipulator());
    (counted.poses, counted.reachable) = (workspace.grid().poses(), aspect.poses);
    counted
}
