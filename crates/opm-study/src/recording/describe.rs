//! The description of a workspace in its recording, and the workspace that is read back from it.

use super::{Attachment, PROGRAM, record};
use crate::kind::WorkspaceKind;
use crate::setup::{fields, of_fields};
use crate::workspace::{Clearance, Workspace};
use opm_analysis::Index;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_mcap::Metadata;
use opm_workspace::{
    Axis, ConditioningIndex, Count, Grid, Inscribed, InscribedShape, Modes, PoseLimit,
};
use std::sync::Arc;

/// The key of the characteristic length of a conditioning index, and the prefix of the keys of its parts.
const CONDITIONING: &str = "conditioning";

/// The parts of a conditioning index; `sum` counts units of 2⁻⁶⁰.
const CONDITIONING_PARTS: [&str; 4] = ["poses", "min", "max", "sum"];

/// The key of the least distance of bodies.
const CLEARANCE: &str = "clearance";
/// The prefix of the keys of the worst values of indices.
const LIMIT: &str = "limit.";

/// The key of the largest shape inside the set, and the prefix of the keys of its coordinates.
const INSCRIBED: &str = "inscribed";

/// The key that says whether that shape touches the edge of the grid.
const AT_EDGE: &str = "inscribed_at_edge";

/// The properties of a workspace that are known before it is swept.
pub fn describe(workspace: &Workspace, mechanism: Attachment<'_>) -> Metadata {
    let mut run = record([
        ("program", PROGRAM.to_owned()),
        ("mechanism", workspace.manipulator.mechanism().name.clone()),
        ("mechanism_file", mechanism.name.to_owned()),
        ("kind", workspace.kind.name().to_owned()),
        ("mode", workspace.mode_name()),
        ("poses", workspace.grid.poses().to_string()),
    ]);
    if let Some(limit) = &workspace.limit {
        if let Some(most) = limit.max_condition() {
            run.insert("max_condition".to_owned(), most.to_string());
        }
        for (index, bound) in limit.indices.iter() {
            run.insert(format!("{LIMIT}{index}"), bound.to_string());
        }
        run.insert("characteristic_length".to_owned(), limit.length().to_string());
    }
    let setup = fields(&workspace.setup, &workspace.manipulator);
    run.extend(setup.into_iter().map(|(key, value)| (key.to_owned(), value)));
    if let Some(clearance) = &workspace.clearance {
        run.insert(CLEARANCE.to_owned(), clearance.least.to_string());
    }
    for Axis { name, min, max, count } in workspace.grid.axes() {
        run.insert(format!("grid.{name}"), format!("{min}:{max}:{count}"));
    }
    run
}

/// As [`describe`], with everything that the shards of the workspace have in common.
pub fn describe_sharded(workspace: &Workspace, mechanism: Attachment<'_>) -> Metadata {
    let mut run = describe(workspace, mechanism);
    if let Some(length) = workspace.conditioning_length() {
        run.insert(CONDITIONING.to_owned(), length.to_string());
    }
    run
}

/// The workspace with this description; `None` if it does not fit this manipulator.
pub fn described(run: &Metadata, manipulator: Arc<Manipulator>) -> Option<Workspace> {
    let kind: WorkspaceKind = run.get("kind")?.parse().ok()?;
    let sections = kind.sections();
    let axes = sections.coordinates(&manipulator).into_iter().map(|coordinate| {
        let values = run.get(&format!("grid.{}", coordinate.name))?;
        let mut values = values.split(':');
        let mut next = || values.next();
        let [min, max] = [next()?.parse().ok()?, next()?.parse().ok()?];
        Some(Axis::new(coordinate.name, min, max, next()?.parse().ok()?))
    });
    let grid = Grid::of(sections, &manipulator, axes.collect::<Option<_>>()?).ok()?;
    let modes = match &**run.get("mode")? {
        "any" => Modes::Any,
        signs => Modes::One(manipulator.parse_mode(signs).ok()?),
    };
    let number = |key: &str| run.get(key).map(|text| text.parse().ok());
    let conditioning: Option<f64> = match number(CONDITIONING) {
        None => None,
        Some(length) => Some(length?),
    };
    let limited: Option<f64> = match number("characteristic_length") {
        None => None,
        Some(length) => Some(length?),
    };
    let length = limited.or(conditioning).unwrap_or_else(|| manipulator.characteristic_length());
    let field = |key: &str| run.get(key).map(|text| &**text);
    let setup = Arc::new(of_fields(field, length)?.check(&manipulator).ok()?);
    let limit = match limited {
        None => None,
        Some(_) => {
            let mut limit = PoseLimit::of(Arc::clone(&setup));
            if let Some(most) = number("max_condition") {
                limit.most = most?;
            }
            for index in Index::ALL {
                if let Some(bound) = number(&format!("{LIMIT}{index}")) {
                    limit = limit.with_index(index, bound?);
                }
            }
            Some(limit)
        }
    };
    let clearance = match number(CLEARANCE) {
        None => None,
        Some(least) => Some(Clearance::new(&manipulator, least?)),
    };
    let conditioning = conditioning.is_some();
    let (shape, unbounded) = (false, None);
    Some(Workspace {
        manipulator,
        kind,
        grid,
        modes,
        limit,
        clearance,
        setup,
        conditioning,
        shape,
        unbounded,
    })
}

/// The results for a workspace.
pub fn result(workspace: &Workspace, count: &Count, inscribed: Option<&Inscribed>) -> Metadata {
    let mut result = record([
        ("reachable", count.reachable.to_string()),
        ("fraction", (count.reachable as f64 / count.poses as f64).to_string()),
    ]);
    if let Some(measure) = workspace.measure(workspace.kind, count, FileUnits::SI) {
        result.insert("measure".to_owned(), measure.value.to_string());
        result.insert("measure_units".to_owned(), measure.unit);
    }
    result.extend(ranges(workspace, count));
    if let Some(found) = inscribed {
        result.insert(INSCRIBED.to_owned(), found.shape.name().to_owned());
        result.insert(AT_EDGE.to_owned(), found.at_edge.to_string());
        result.extend(found.names.iter().enumerate().map(|(i, name)| {
            let [centre, radius, error] = [&found.centre, &found.radii, &found.error].map(|v| v[i]);
            (format!("{INSCRIBED}.{name}"), format!("{centre}:{radius}:{error}"))
        }));
    }
    result
}

/// The largest shape inside that a recording has, by its record `result`.
pub fn inscribed_of(result: &Metadata) -> Option<Inscribed> {
    let shape = InscribedShape::from_name(result.get(INSCRIBED)?)?;
    let at_edge = result.get(AT_EDGE)?.parse().ok()?;
    let (names, centre, radii, error) = (vec![], vec![], vec![], vec![]);
    let mut found = Inscribed { shape, names, centre, radii, error, at_edge };
    for (key, text) in result {
        let Some(name) = key.strip_prefix(INSCRIBED).and_then(|key| key.strip_prefix('.')) else {
            continue;
        };
        let numbers: Vec<f64> = text.split(':').map(str::parse).collect::<Result<_, _>>().ok()?;
        let [centre, radius, error] = numbers[..] else { return None };
        found.names.push(name.to_owned());
        found.centre.push(centre);
        found.radii.push(radius);
        found.error.push(error);
    }
    (found.names.len() >= 2).then_some(found)
}

/// The ranges of the imaginary joints, with all digits.
pub fn ranges(workspace: &Workspace, count: &Count) -> Metadata {
    let ranges = workspace.manipulator.imaginary().iter().zip(&count.imaginary);
    ranges
        .filter_map(|(joint, range)| {
            let [low, high] = (*range)?;
            Some((range_key(&joint.name), format!("{low}:{high}")))
        })
        .collect()
}

/// The key of the range of an imaginary joint.
pub fn range_key(joint: &str) -> String {
    format!("range.{joint}")
}

/// A conditioning index, with all digits.
pub fn conditioning(index: &ConditioningIndex) -> Metadata {
    let ConditioningIndex { length: _, poses, min, max, sum } = index;
    let parts = [poses.to_string(), min.to_string(), max.to_string(), sum.to_string()];
    let keys = CONDITIONING_PARTS.map(|key| format!("{CONDITIONING}.{key}"));
    keys.into_iter().zip(parts).collect()
}

/// The conditioning index that has these parts.
pub fn conditioning_of(result: &Metadata, length: f64) -> Option<ConditioningIndex> {
    let [poses, min, max, sum] =
        CONDITIONING_PARTS.map(|key| result.get(&format!("{CONDITIONING}.{key}")));
    let (poses, sum) = (poses?.parse().ok()?, sum?.parse().ok()?);
    let (min, max) = (min?.parse().ok()?, max?.parse().ok()?);
    Some(ConditioningIndex { length, poses, min, max, sum })
}
