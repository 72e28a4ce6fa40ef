//! What a motion demands of the joints, against their limits.

use super::source::{Rate, Source};
use super::traces::{Group, Trace};
use opm_core::mechanism::joint::JointCoordinate;
use opm_plot::axis::label;

/// Most joints whose demand is listed.
const LISTED: usize = 8;

/// The limits of a joint, of its rate, of its acceleration or of its effort, in the unit of a trace.
pub fn limits(source: &Source<'_>, trace: &Trace) -> Option<[f64; 2]> {
    let both = |limit: f64| [-limit, limit];
    if trace.group == Group::Efforts {
        return trace.limit.map(both);
    }
    if !matches!(trace.group, Group::Actuated | Group::Passive | Group::Joints) {
        return None;
    }
    let coordinate = coordinate(source, &trace.name)?;
    let limits = match trace.rate {
        Rate::Position => coordinate.limits,
        Rate::Velocity => coordinate.motion_limits.max_rate.map(both),
        Rate::Acceleration => coordinate.motion_limits.max_acceleration.map(both),
    };
    limits.map(|limits| limits.map(|limit| limit / trace.factor))
}

/// What of its limits a motion uses of each actuated joint that has any.
pub fn notes(source: &Source<'_>, traces: &[Trace]) -> Vec<String> {
    let mut joints: Vec<(&str, Vec<String>)> = Vec::new();
    for trace in traces.iter().filter(|trace| trace.group == Group::Actuated) {
        let (Some([low, high]), Some(range)) = (limits(source, trace), trace.curve.range()) else {
            continue;
        };
        let share = |value: f64| {
            let percent = 100.0 * value / (high - low).max(f64::MIN_POSITIVE);
            format!("{} %", label(percent, usize::from(percent.abs() < 10.0)))
        };
        let largest = range[0].abs().max(range[1].abs());
        let used = match trace.rate {
            Rate::Position => {
                format!("{} to {} of its range", share(range[0] - low), share(range[1] - low))
            }
            Rate::Velocity => format!("{} of its max_rate", share(2.0 * largest)),
            Rate::Acceleration => format!("{} of its max_acceleration", share(2.0 * largest)),
        };
        match joints.iter_mut().find(|(name, _)| *name == trace.name) {
            Some((_, all)) => all.push(used),
            None => joints.push((&trace.name, vec![used])),
        }
    }
    let more = joints.len().saturating_sub(LISTED);
    let line = |(name, used): &(&str, Vec<String>)| format!("{name}: {}", used.join(", "));
    let mut notes: Vec<String> = joints.iter().take(LISTED).map(line).collect();
    if more > 0 {
        notes.push(format!("and {more} more joints with limits"));
    }
    if !notes.is_empty() {
        notes.insert(0, "Dashed: limits. What the motion uses of them:".to_owned());
    }
    notes
}

fn coordinate<'a>(source: &'a Source<'_>, name: &str) -> Option<&'a JointCoordinate> {
    let legs = source.mechanism.as_ref()?.file.mechanism.legs.iter();
    let mut all = legs.flat_map(|leg| &leg.joints).flat_map(|joint| &joint.coordinates);
    all.find(|coordinate| coordinate.name == name)
}
