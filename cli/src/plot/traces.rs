//! The topics of a motion, and the meaning of their values.

use super::source::{Rate, Source, SourceSolver, quantity};
use opm_analysis::Index;
use opm_core::Quantity;
use opm_mcap::Flat;
use opm_mcap::trajectory::{
    ACCELERATIONS_TOPIC, CONDITION_TOPIC, DEPENDENT_TOPIC, DEPENDENT_VELOCITIES_TOPIC,
    IMAGINARY_TOPIC, IMAGINARY_VELOCITIES_TOPIC, INDICES_TOPIC, JOINTS_TOPIC, POSE_TOPIC,
    POSE_VELOCITIES_TOPIC, Role, VALID, VELOCITIES_TOPIC,
};
use opm_plot::Curve;

/// Field of `/condition` whose values span several powers of ten.
const CONDITION: &str = "condition";

/// The group of a curve: the rows of the picture, from top to bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    Pose,
    Imaginary,
    Actuated,
    Passive,
    Joints,
    Condition,
    Singularity,
    Indices,
    Efforts,
}

/// The topics that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topic {
    pub name: &'static str,
    pub kind: TopicKind,
    pub rate: Rate,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TopicKind {
    Pose,
    Joints,
    Imaginary,
    Condition,
    Indices,
}

pub const TOPICS: [Topic; 11] = {
    const fn topic(name: &'static str, kind: TopicKind, rate: Rate) -> Topic {
        Topic { name, kind, rate }
    }
    [
        topic(POSE_TOPIC, TopicKind::Pose, Rate::Position),
        topic(POSE_VELOCITIES_TOPIC, TopicKind::Pose, Rate::Velocity),
        topic(DEPENDENT_TOPIC, TopicKind::Pose, Rate::Position),
        topic(DEPENDENT_VELOCITIES_TOPIC, TopicKind::Pose, Rate::Velocity),
        topic(JOINTS_TOPIC, TopicKind::Joints, Rate::Position),
        topic(VELOCITIES_TOPIC, TopicKind::Joints, Rate::Velocity),
        topic(ACCELERATIONS_TOPIC, TopicKind::Joints, Rate::Acceleration),
        topic(IMAGINARY_TOPIC, TopicKind::Imaginary, Rate::Position),
        topic(IMAGINARY_VELOCITIES_TOPIC, TopicKind::Imaginary, Rate::Velocity),
        topic(CONDITION_TOPIC, TopicKind::Condition, Rate::Position),
        topic(INDICES_TOPIC, TopicKind::Indices, Rate::Position),
    ]
};

/// The curve of a value over time.
pub struct Trace {
    pub name: String,
    pub group: Group,
    pub quantity: Option<Quantity>,
    pub rate: Rate,
    /// The unit of what is neither a length nor an angle.
    pub unit: String,
    /// The divisor of the SI values.
    pub factor: f64,
    /// Its largest value in either direction, in the unit of the values, if the mechanism file gives one.
    pub limit: Option<f64>,
    pub curve: Curve,
}

/// `valid` is not drawn as a curve, but as shading.
pub fn skipped(topic: usize, name: &str) -> bool {
    TOPICS[topic].kind == TopicKind::Condition && name == VALID
}

/// The traces of a topic's fields.
pub fn traces(source: &Source<'_>, topic: Topic, flat: &Flat) -> Vec<Trace> {
    let number = TOPICS.iter().position(|known| *known == topic).unwrap_or(0);
    let fields = flat.names.iter().filter(|field| !skipped(number, field));
    fields.map(|field| trace(source, topic, field)).collect()
}

fn trace(source: &Source<'_>, topic: Topic, field: &str) -> Trace {
    let find = |record: &str| source.metadata(record).get(field).cloned();
    let (mut unit, mut limit) = (String::new(), None);
    let (name, quantity, group) = match topic.kind {
        TopicKind::Condition => {
            let group = if field == CONDITION { Group::Condition } else { Group::Singularity };
            (field.to_owned(), None, group)
        }
        TopicKind::Indices => {
            // An effort has the field of its joint behind its own.
            let of_joint =
                field.strip_prefix("effort_").filter(|_| Index::from_name(field).is_none());
            let joint = of_joint.and_then(|field| source.metadata("joints").get(field).cloned());
            limit = joint.as_deref().and_then(|joint| max_effort(source, joint));
            let group = if of_joint.is_some() { Group::Efforts } else { Group::Indices };
            let name = joint.map_or_else(|| field.to_owned(), |joint| format!("effort.{joint}"));
            let known = find("quantities");
            let quantity = quantity(known.as_deref());
            unit = known.filter(|_| quantity.is_none()).unwrap_or_default();
            (name, quantity, group)
        }
        TopicKind::Pose => {
            let mut task = source
                .manipulator()
                .into_iter()
                .flat_map(|m| m.task_coordinates().iter().chain(m.dependent_coordinates()));
            let known = task.find(|c| c.name == field).map(|c| c.quantity);
            let quantity = known.or_else(|| quantity(find("quantities").as_deref()));
            (field.to_owned(), quantity, Group::Pose)
        }
        TopicKind::Imaginary => {
            let name = find("joints").unwrap_or_else(|| field.to_owned());
            let known = imaginary_quantity(source, &name);
            let quantity = known.or_else(|| quantity(find("quantities").as_deref()));
            (name, quantity, Group::Imaginary)
        }
        TopicKind::Joints => {
            let name = find("joints").unwrap_or_else(|| field.to_owned());
            let (known, group) = joint(source, &name);
            let quantity = known.or_else(|| quantity(find("quantities").as_deref()));
            let role = find("roles");
            let is = |known: Role| role.as_deref() == Some(known.name());
            let group = group
                .or_else(|| is(Role::Actuated).then_some(Group::Actuated))
                .or_else(|| is(Role::Passive).then_some(Group::Passive));
            (name, quantity, group.unwrap_or(Group::Joints))
        }
    };
    let (_, factor) = source.measure("", quantity, topic.rate);
    let (rate, curve) = (topic.rate, Curve::default());
    Trace { name, group, quantity, rate, unit, factor, limit, curve }
}

fn imaginary_quantity(source: &Source<'_>, name: &str) -> Option<Quantity> {
    match &source.mechanism.as_ref()?.kind {
        SourceSolver::Manipulator(m) => {
            m.imaginary().iter().find(|j| j.name == name).map(|j| j.quantity)
        }
        SourceSolver::Linkage(l) => {
            l.imaginary().iter().find(|j| j.name == name).map(|j| j.quantity)
        }
        SourceSolver::Other => None,
    }
}

/// The largest effort of the actuator of a joint coordinate.
fn max_effort(source: &Source<'_>, name: &str) -> Option<f64> {
    let mechanism = &source.mechanism.as_ref()?.file.mechanism;
    let mut all = mechanism.joints().filter(|joint| joint.actuated).flat_map(|j| &j.coordinates);
    all.find(|coordinate| coordinate.name == name)?.max_effort
}

/// The properties of a joint coordinate.
fn joint(source: &Source<'_>, name: &str) -> (Option<Quantity>, Option<Group>) {
    let Some(mechanism) = &source.mechanism else { return (None, None) };
    let legs = mechanism.file.mechanism.legs.iter();
    let mut joints = legs.flat_map(|leg| &leg.joints);
    let found = joints.find_map(|joint| {
        let coordinate = joint.coordinates.iter().find(|c| c.name == name)?;
        let group = if joint.actuated { Group::Actuated } else { Group::Passive };
        Some((coordinate.quantity, group))
    });
    let Some((quantity, group)) = found else { return (None, None) };
    // Over its input, a linkage has no joints that are less of interest than others.
    let group = if source.input().is_some() { Group::Joints } else { group };
    (Some(quantity), Some(group))
}
