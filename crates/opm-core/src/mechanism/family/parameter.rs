//! The parameters of a family as data: what files call them, what they are, and where they are kept.
//! Files are read and written by this list, and parameters changed by name without a file.

use super::Family;
use crate::mechanism::file::{FileUnits, checks};
use crate::numeric::Quantity;
use std::fmt::Write;

/// One parameter of home or of a leg.
pub(in crate::mechanism) struct Parameter<'a> {
    /// What files call it; limits, what they call it in the leg's `limits`.
    pub key: &'static str,
    /// What a file is told that lacks it.
    pub expected: &'static str,
    pub slot: Slot<'a>,
}

/// Where a parameter is kept; SI.
pub(in crate::mechanism) enum Slot<'a> {
    Number(Quantity, &'a mut f64),
    /// That a leg may have or not.
    Optional(Quantity, &'a mut Option<f64>),
    /// Of the plane, lengths.
    Point(&'a mut [f64; 2]),
    Limits(Quantity, &'a mut Option<[f64; 2]>),
}

/// The parameters of home, or of one leg.
pub(in crate::mechanism) struct Group<'a> {
    /// What files call the table that they stand in.
    pub table: TableKey,
    /// `home`, or the leg's name.
    pub name: String,
    pub parameters: Vec<Parameter<'a>>,
}

/// The key of a table, or of an array of tables.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::mechanism) enum TableKey {
    Home,
    Leg(&'static str),
    Legs(&'static str),
}

/// The value of a parameter: metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// Of limits: there are none.
    None,
    /// A length, an angle, or a pitch.
    Number(f64),
    /// A point of the plane, or lowest and highest value.
    Pair([f64; 2]),
}

/// Why parameters could not be changed: every problem, at least one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .problems.join("; "))]
pub struct ParameterErrors {
    /// Each with the name of the parameter and what was expected.
    pub problems: Vec<String>,
}

impl<'a> Group<'a> {
    pub fn home(parameters: Vec<Parameter<'a>>) -> Self {
        Self { table: TableKey::Home, name: "home".to_owned(), parameters }
    }
}

impl Parameter<'_> {
    /// Its name in its group: `h`, `limits.S`.
    fn name(&self) -> String {
        match self.slot {
            Slot::Limits(..) => format!("limits.{}", self.key),
            _ => self.key.to_owned(),
        }
    }

    /// Whether this is its name in its group.
    fn is_called(&self, name: &str) -> bool {
        match self.slot {
            Slot::Limits(..) => name.strip_prefix("limits.") == Some(self.key),
            _ => name == self.key,
        }
    }

    /// What it is, if the leg has it.
    pub fn value(&self) -> Option<ParameterValue> {
        match &self.slot {
            Slot::Number(_, value) => Some(ParameterValue::Number(**value)),
            Slot::Optional(_, value) => value.map(ParameterValue::Number),
            Slot::Point(point) => Some(ParameterValue::Pair(**point)),
            Slot::Limits(_, limits) => {
                Some(limits.map_or(ParameterValue::None, ParameterValue::Pair))
            }
        }
    }

    /// Sets it, or says what is wrong with the value.
    fn set(&mut self, value: ParameterValue) -> Result<(), String> {
        use ParameterValue::{Number, Pair};
        let size = |value, quantity| checks::size(checks::finite(value)?, quantity, FileUnits::SI);
        match (&mut self.slot, value) {
            (Slot::Number(quantity, slot), Number(value)) => **slot = size(value, *quantity)?,
            (Slot::Optional(quantity, slot), Number(value)) => {
                **slot = Some(size(value, *quantity)?);
            }
            (Slot::Point(slot), Pair([x, y])) => {
                **slot = [size(x, Quantity::Length)?, size(y, Quantity::Length)?];
            }
            (Slot::Limits(_, slot), ParameterValue::None) => **slot = None,
            (Slot::Limits(quantity, slot), Pair([low, high])) => {
                let limits = [size(low, *quantity)?, size(high, *quantity)?];
                **slot = Some(checks::ordered(limits, *quantity, FileUnits::SI)?);
            }
            (slot, value) => {
                let found = match value {
                    ParameterValue::None => "nothing",
                    Number(_) => "a number",
                    Pair(_) => "a pair",
                };
                let expected = match slot {
                    Slot::Number(..) | Slot::Optional(..) => "a number",
                    Slot::Point(_) => "a point [x, y]",
                    Slot::Limits(..) => "limits [lowest, highest] or none",
                };
                return Err(format!("is {found}, expected {expected}"));
            }
        }
        Ok(())
    }
}

impl Family {
    fn groups(&mut self) -> Vec<Group<'_>> {
        match self {
            Self::PlanoSpherical(family) => family.groups(),
            Self::TranslationalHelical(family) => family.groups(),
            Self::PlanarPlanar(family) => family.groups(),
        }
    }

    /// Every parameter in the order of files, by its name: `home.x`; of a leg `leg1.h`, of its limits
    /// `leg1.limits.S`. Metres and radians.
    pub fn parameters(&self) -> Vec<(String, ParameterValue)> {
        let mut family = self.clone();
        let groups = family.groups();
        let named = groups.iter().flat_map(|group| {
            let named =
                |p: &Parameter<'_>| Some((format!("{}.{}", group.name, p.name()), p.value()?));
            group.parameters.iter().filter_map(named)
        });
        named.collect()
    }

    /// The family with some parameters changed, by the names of [`Family::parameters`]. What follows
    /// the dot alone (`h`, `limits.S`) is that parameter wherever there is one; a whole name goes
    /// before it.
    ///
    /// # Errors
    /// Every name that is no parameter, and every value that is none: not finite, larger than any
    /// machine, limits reversed. Whether the parameters fit together, [`Family::assemble`] says.
    pub fn with<'n>(
        &self,
        changes: impl IntoIterator<Item = (&'n str, ParameterValue)>,
    ) -> Result<Self, ParameterErrors> {
        let mut family = self.clone();
        let mut groups = family.groups();
        let (mut whole, mut problems) = (vec![], vec![]);
        for (name, value) in changes {
            let own = |group: &Group<'_>| {
                let key = name.strip_prefix(group.name.as_str())?.strip_prefix('.')?;
                group.parameters.iter().position(|p| p.value().is_some() && p.is_called(key))
            };
            let found = groups.iter().enumerate().find_map(|(i, group)| Some((i, own(group)?)));
            if let Some(place) = found {
                whole.push((place, name, value));
                continue;
            }
            let every = groups.iter_mut().flat_map(|group| &mut group.parameters);
            let every = every.filter(|p| p.value().is_some() && p.is_called(name));
            match every.map(|p| p.set(value)).collect::<Vec<_>>() {
                set if set.is_empty() => {
                    problems.push(format!("`{name}` is no parameter; {}", known(&groups)));
                }
                set => {
                    let problem = set.into_iter().find_map(Result::err);
                    problems.extend(problem.map(|problem| format!("`{name}` {problem}")));
                }
            }
        }
        for ((group, parameter), name, value) in whole {
            let set = groups[group].parameters[parameter].set(value);
            problems.extend(set.err().map(|problem| format!("`{name}` {problem}")));
        }
        drop(groups);
        if problems.is_empty() { Ok(family) } else { Err(ParameterErrors { problems }) }
    }

    /// The text of a file that gives this very family, to the last bit: in metres and radians.
    pub fn write(&self) -> String {
        let mut family = self.clone();
        let (word, name, mode) = (self.word(), self.name().to_owned(), self.mode());
        let mut text = format!(
            "format = 1\nname = {}\nunits = {{ length = \"m\", angle = \"rad\" }}\nfamily = \"{word}\"\n",
            quoted(&name)
        );
        let mut body = String::new();
        for group in family.groups() {
            let entry = |p: &Parameter<'_>| {
                let value = match p.value()? {
                    ParameterValue::None => return None,
                    ParameterValue::Number(value) => format!("{value:?}"),
                    ParameterValue::Pair([a, b]) => format!("[{a:?}, {b:?}]"),
                };
                Some((matches!(p.slot, Slot::Limits(..)), format!("{} = {value}", p.key)))
            };
            let (limits, others): (Vec<_>, Vec<_>) =
                group.parameters.iter().filter_map(entry).partition(|(limit, _)| *limit);
            let line = |entries: Vec<(bool, String)>, between: &str| {
                entries.into_iter().map(|(_, entry)| entry).collect::<Vec<_>>().join(between)
            };
            let header = match group.table {
                TableKey::Home => {
                    let _ = writeln!(text, "home = {{ {} }}", line(others, ", "));
                    continue;
                }
                TableKey::Leg(key) => format!("[{key}]"),
                TableKey::Legs(key) => format!("[[{key}]]"),
            };
            let _ = writeln!(
                body,
                "\n{header}\nname = {}\n{}",
                quoted(&group.name),
                line(others, "\n")
            );
            if !limits.is_empty() {
                let _ = writeln!(body, "limits = {{ {} }}", line(limits, ", "));
            }
        }
        if !mode.is_empty() {
            let _ = writeln!(text, "mode = \"{mode}\"");
        }
        text + &body
    }

    /// What is wrong with these parameters, each problem with the name of its leg; SI.
    pub fn explain(&self, error: &super::AssemblyError) -> ParameterErrors {
        let mut family = self.clone();
        let groups = family.groups();
        let legs: Vec<_> = groups.iter().filter(|group| group.table != TableKey::Home).collect();
        let explained = error.problems.iter().map(|problem| {
            let what = problem.describe(FileUnits::SI);
            match problem.leg.and_then(|leg| legs.get(leg)) {
                Some(leg) => format!("{}: {what}", leg.name),
                None => what,
            }
        });
        ParameterErrors { problems: explained.collect() }
    }
}

/// The names that there are; legs of the same parameters together.
fn known(groups: &[Group<'_>]) -> String {
    let mut kinds: Vec<(Vec<&str>, Vec<String>)> = vec![];
    for group in groups {
        let has = |p: &&Parameter<'_>| p.value().is_some();
        let names: Vec<_> = group.parameters.iter().filter(has).map(Parameter::name).collect();
        match kinds.iter_mut().find(|(_, known)| *known == names) {
            Some((legs, _)) => legs.push(&group.name),
            None => kinds.push((vec![group.name.as_str()], names)),
        }
    }
    let kinds = kinds.into_iter().map(|(legs, names)| {
        let has = if legs.len() == 1 { "has" } else { "have" };
        format!("{} {has} {}", legs.join(", "), names.join(", "))
    });
    kinds.collect::<Vec<_>>().join("; ")
}

fn quoted(name: &str) -> String {
    toml::Value::from(name).to_string()
}

/// Constructors that read as a table of a family's parameters.
impl<'a> Parameter<'a> {
    pub fn angle(key: &'static str, value: &'a mut f64, expected: &'static str) -> Self {
        Self { key, expected, slot: Slot::Number(Quantity::Angle, value) }
    }

    pub fn length(key: &'static str, value: &'a mut f64, expected: &'static str) -> Self {
        Self { key, expected, slot: Slot::Number(Quantity::Length, value) }
    }

    /// Length per radian, of a leg that may have none.
    pub fn pitch(key: &'static str, value: &'a mut Option<f64>, expected: &'static str) -> Self {
        Self { key, expected, slot: Slot::Optional(Quantity::Length, value) }
    }

    pub fn point(key: &'static str, value: &'a mut [f64; 2], expected: &'static str) -> Self {
        Self { key, expected, slot: Slot::Point(value) }
    }

    pub fn travel(key: &'static str, limits: &'a mut Option<[f64; 2]>) -> Self {
        Self { key, expected: "limits", slot: Slot::Limits(Quantity::Length, limits) }
    }

    pub fn turn(key: &'static str, limits: &'a mut Option<[f64; 2]>) -> Self {
        Self { key, expected: "limits", slot: Slot::Limits(Quantity::Angle, limits) }
    }
}

#[cfg(test)]
mod tests;
