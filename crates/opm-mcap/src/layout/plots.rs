//! The curves of a motion: those of one role and one unit are in one plot.

use crate::trajectory::{
    CONDITION_TOPIC, DEPENDENT_TOPIC, IMAGINARY_TOPIC, INDICES_TOPIC, JOINTS_TOPIC, POSE_TOPIC,
    Role,
};
use crate::{Message, Metadata, Recording};
use std::collections::BTreeMap;

/// The curves that one plot shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    pub title: String,
    /// The SI unit; empty for a pure number.
    pub unit: String,
    pub topic: String,
    /// The name of the topic's schema.
    pub schema: String,
    /// The fields of its messages, with the names of the values.
    pub curves: Vec<(String, String)>,
}

/// Most plots one above the other.
const MOST_IN_COLUMN: usize = 5;

/// The plots of each column, as many in all of them, or nearly so.
pub fn columns(plots: &[Plot]) -> std::slice::Chunks<'_, Plot> {
    let columns = plots.len().div_ceil(MOST_IN_COLUMN).max(1);
    plots.chunks(plots.len().div_ceil(columns).max(1))
}

/// The fields of the topics of doubles.
#[derive(Default)]
pub struct Flats {
    topics: BTreeMap<String, (String, Vec<String>)>,
}

/// The field of `/condition` that is plotted.
const CONDITION: &str = "condition";

impl Flats {
    pub fn add(&mut self, message: &Message<'_>) {
        if let Some(flat) = message.flat
            && !self.topics.contains_key(message.topic)
        {
            let found = (message.schema.to_owned(), flat.names.clone());
            self.topics.insert(message.topic.to_owned(), found);
        }
    }

    /// The plots of a recording, in the order in which they are looked at.
    pub fn plots(&self, recording: &Recording) -> Vec<Plot> {
        let none = Metadata::new();
        let [roles, units, names] =
            ["roles", "quantities", "joints"].map(|name| recording.metadata(name).unwrap_or(&none));
        let mut plots = Vec::new();
        for (title, topic, role) in [
            ("Pose", POSE_TOPIC, None),
            ("Dependent", DEPENDENT_TOPIC, None),
            ("Actuated", JOINTS_TOPIC, Some(Role::Actuated)),
            ("Passive", JOINTS_TOPIC, Some(Role::Passive)),
            ("Imaginary", IMAGINARY_TOPIC, None),
        ] {
            let Some((schema, fields)) = self.topics.get(topic) else { continue };
            let is_of = |field: &String| {
                role.is_none_or(|role| roles.get(field).is_some_and(|found| found == role.name()))
            };
            for unit in ["m", "rad"] {
                let in_unit = |field: &&String| units.get(*field).is_some_and(|u| u == unit);
                let curves: Vec<_> = (fields.iter().filter(|field| is_of(field)).filter(in_unit))
                    .map(|field| (field.clone(), names.get(field).unwrap_or(field).clone()))
                    .collect();
                if !curves.is_empty() {
                    plots.push(Plot {
                        title: format!("{title} [{unit}]"),
                        unit: unit.to_owned(),
                        topic: topic.to_owned(),
                        schema: schema.clone(),
                        curves,
                    });
                }
            }
        }
        if let Some((schema, fields)) = self.topics.get(CONDITION_TOPIC)
            && fields.iter().any(|field| field == CONDITION)
        {
            plots.push(Plot {
                title: "Condition number".to_owned(),
                unit: String::new(),
                topic: CONDITION_TOPIC.to_owned(),
                schema: schema.clone(),
                curves: vec![(CONDITION.to_owned(), CONDITION.to_owned())],
            });
        }
        if let Some((schema, fields)) = self.topics.get(INDICES_TOPIC) {
            let unit = |field: &String| units.get(field).map_or("", |unit| unit);
            let mut each: Vec<&str> = fields.iter().map(unit).collect();
            each.sort_unstable();
            each.dedup();
            plots.extend(each.into_iter().map(|own| {
                Plot {
                    title: if own.is_empty() {
                        "Indices".into()
                    } else {
                        format!("Indices [{own}]")
                    },
                    unit: own.to_owned(),
                    topic: INDICES_TOPIC.to_owned(),
                    schema: schema.clone(),
                    curves: (fields.iter().filter(|field| unit(field) == own))
                        .map(|field| (field.clone(), field.clone()))
                        .collect(),
                }
            }));
        }
        plots
    }
}
