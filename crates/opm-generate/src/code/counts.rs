//! How many coordinates, joints and legs there are, and their names.

use super::Writer;
use crate::names::{comment, identifiers};
use crate::tree::{Entry, Enum};
use opm_core::numeric::Quantity;

impl Writer<'_> {
    /// The names of the numbers of joints and coordinates, and how many there are of each.
    pub fn counts(&self) -> Vec<Enum> {
        let m = self.manipulator;
        let counts = [
            ("COORDINATES", m.task_coordinates().len()),
            ("JOINTS", m.coordinates().len()),
            ("IMAGINARY", m.imaginary().len()),
            ("ACTUATED", m.actuated().len()),
            ("CHOICES", m.choices() as usize),
            ("LEGS", self.forms.legs.len()),
        ];
        let count = |(name, value): (&str, usize)| Entry {
            name: name.to_owned(),
            value,
            comment: String::new(),
        };
        let of_joint = |i: usize| (&*m.coordinates()[i].name, m.coordinates()[i].quantity);
        let lists = [
            listed(
                "The coordinates of a pose.",
                "POSE",
                &m.task_coordinates().iter().map(|c| (c.name, c.quantity)).collect::<Vec<_>>(),
            ),
            listed(
                "The joint coordinates, leg by leg.",
                "JOINT",
                &(0..m.coordinates().len()).map(of_joint).collect::<Vec<_>>(),
            ),
            listed(
                "The imaginary joints.",
                "IMAGINARY",
                &m.imaginary().iter().map(|j| (&*j.name, j.quantity)).collect::<Vec<_>>(),
            ),
            listed(
                "The actuated joint coordinates.",
                "ACTUATED",
                &m.actuated().iter().map(|&i| of_joint(i)).collect::<Vec<_>>(),
            ),
        ];
        let entries = counts.map(count).into();
        let mut all = vec![Enum { comment: "How many there are of each.".to_owned(), entries }];
        all.extend(lists.into_iter().filter(|list| !list.entries.is_empty()));
        all
    }
}

/// Numbers from 0 with the names of coordinates, and their units.
fn listed(what: &str, tag: &str, names: &[(&str, Quantity)]) -> Enum {
    let ids = identifiers(names.iter().map(|(name, _)| *name));
    let entries = ids.iter().zip(names).enumerate().map(|(value, (id, (name, quantity)))| Entry {
        name: format!("{tag}_{id}"),
        value,
        comment: format!("{}, {}", comment(name), quantity.unit()),
    });
    Enum { comment: what.to_owned(), entries: entries.collect() }
}
