//! The parameters of a family as data: their names in files, their meaning, and where their values
//! are stored. Files are read and written by this list, and parameters are changed by name with it.

use super::Family;
use crate::mechanism::file::{FileUnits, checks, nearest, quoted};
use crate::mechanism::joint::{DriveLimit, DriveNumber, JointLimits, MotionLimit, MotionLimits};
use crate::numeric::Quantity;
use std::fmt::Write;

/// One parameter of home or of a leg.
pub(in crate::mechanism) struct Parameter<'a> {
    /// The key in files.
    pub key: &'static str,
    /// The table of the leg that has the key, if it is about a joint of the leg.
    pub table: Option<JointTable>,
    /// What the message says was expected if a file lacks the parameter.
    pub expected: &'static str,
    /// The stored value.
    pub target: ParameterRef<'a>,
}

/// A reference to the stored value of a parameter, SI.
pub(in crate::mechanism) enum ParameterRef<'a> {
    Number(Quantity, &'a mut f64),
    /// A number that a leg may lack.
    Optional(Quantity, &'a mut Option<f64>),
    /// A point in the plane; both coordinates are lengths.
    Point(&'a mut [f64; 2]),
    Limits(Quantity, &'a mut Option<[f64; 2]>),
    DriveLimit(DriveLimit, Quantity, &'a mut Option<f64>),
    Drive(DriveNumber, Quantity, &'a mut Option<f64>),
    Offset(Quantity, &'a mut Option<f64>),
}

/// A table of a leg with a value for each of its joints.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::mechanism) enum JointTable {
    Limits,
    Drive(DriveLimit),
    Number(DriveNumber),
    Offset,
}

impl JointTable {
    pub const ALL: [Self; 9] = [
        Self::Limits,
        Self::Drive(DriveLimit::Motion(MotionLimit::Rate)),
        Self::Drive(DriveLimit::Motion(MotionLimit::Acceleration)),
        Self::Drive(DriveLimit::Effort),
        Self::Number(DriveNumber::RotorInertia),
        Self::Number(DriveNumber::Gear),
        Self::Number(DriveNumber::ViscousFriction),
        Self::Number(DriveNumber::CoulombFriction),
        Self::Offset,
    ];

    /// The key of the table in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::Limits => "limits",
            Self::Drive(limit) => limit.key(),
            Self::Number(number) => number.key(),
            Self::Offset => "offset",
        }
    }
}

/// The parameters of home, or of one leg.
pub(in crate::mechanism) struct Group<'a> {
    /// The key of the table in files.
    pub table: TableKey,
    /// `home`, or the name of the leg.
    pub name: String,
    pub parameters: Vec<Parameter<'a>>,
}

/// The key of a table, or of an array of tables, in files.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::mechanism) enum TableKey {
    Home,
    Leg(&'static str),
    Legs(&'static str),
}

/// The value of a parameter, in metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// No limits, or no offset.
    None,
    /// A length, an angle, a pitch in metres per radian, or the largest rate, acceleration or effort of a joint, or its offset.
    Number(f64),
    /// A point in the plane, or the lowest and highest value of limits.
    Pair([f64; 2]),
}

/// Why parameters could not be changed: a list of all problems, at least one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .problems.join("; "))]
#[non_exhaustive]
pub struct ParameterErrors {
    /// The problems. Each starts with the name of the parameter.
    pub problems: Vec<String>,
}

impl<'a> Group<'a> {
    pub fn home(parameters: Vec<Parameter<'a>>) -> Self {
        Self { table: TableKey::Home, name: "home".to_owned(), parameters }
    }
}

impl Parameter<'_> {
    /// The parameter's name within its group: `h`, `limits.S`.
    fn name(&self) -> String {
        match self.table {
            Some(table) => format!("{}.{}", table.key(), self.key),
            None => self.key.to_owned(),
        }
    }

    /// Whether the parameter has this name within its group.
    fn is_called(&self, name: &str) -> bool {
        match self.table {
            Some(table) => {
                let key = name.strip_prefix(table.key()).and_then(|key| key.strip_prefix('.'));
                key == Some(self.key)
            }
            None => name == self.key,
        }
    }

    /// What it measures, in the units of the file; `None` for an effort, which is in newtons or newton metres, and for a number of a
    /// drive.
    pub(in crate::mechanism) fn quantity(&self) -> Option<Quantity> {
        match self.target {
            ParameterRef::DriveLimit(limit, ..) if !limit.has_units_of_file() => None,
            ParameterRef::Drive(..) => None,
            ParameterRef::Number(quantity, _)
            | ParameterRef::Optional(quantity, _)
            | ParameterRef::Limits(quantity, _)
            | ParameterRef::DriveLimit(_, quantity, _)
            | ParameterRef::Offset(quantity, _) => Some(quantity),
            ParameterRef::Point(_) => Some(Quantity::Length),
        }
    }

    /// A number of its value, SI, in the units of a file.
    pub(in crate::mechanism) fn number_in(&self, value: f64, units: FileUnits) -> f64 {
        match (&self.target, self.quantity()) {
            (ParameterRef::Drive(number, quantity, _), _) => {
                value * number.in_file(*quantity, units)
            }
            (_, Some(quantity)) => units.number_of(value, quantity),
            (_, None) => value,
        }
    }

    /// The parameter's value; `None` if the leg has no such parameter.
    pub fn value(&self) -> Option<ParameterValue> {
        match &self.target {
            ParameterRef::Number(_, value) => Some(ParameterValue::Number(**value)),
            ParameterRef::Optional(_, value) => value.map(ParameterValue::Number),
            ParameterRef::Point(point) => Some(ParameterValue::Pair(**point)),
            ParameterRef::Limits(_, limits) => {
                Some(limits.map_or(ParameterValue::None, ParameterValue::Pair))
            }
            ParameterRef::DriveLimit(.., limit)
            | ParameterRef::Drive(.., limit)
            | ParameterRef::Offset(_, limit) => {
                Some(limit.map_or(ParameterValue::None, ParameterValue::Number))
            }
        }
    }

    /// Sets the value, or describes what is wrong with it, in some units.
    fn set(&mut self, value: ParameterValue, units: FileUnits) -> Result<(), String> {
        use ParameterValue::{Number, Pair};
        let size = |value, quantity| checks::size(checks::finite(value)?, quantity, units);
        match (&mut self.target, value) {
            (ParameterRef::Number(quantity, target), Number(value)) => {
                **target = size(value, *quantity)?;
            }
            (ParameterRef::Optional(quantity, target), Number(value)) => {
                **target = Some(size(value, *quantity)?);
            }
            (ParameterRef::Point(target), Pair([x, y])) => {
                **target = [size(x, Quantity::Length)?, size(y, Quantity::Length)?];
            }
            (ParameterRef::Limits(_, target), ParameterValue::None) => **target = None,
            (ParameterRef::Limits(quantity, target), Pair([low, high])) => {
                let limits = [size(low, *quantity)?, size(high, *quantity)?];
                **target = Some(checks::ordered(limits, *quantity, units)?);
            }
            (ParameterRef::DriveLimit(.., target), ParameterValue::None) => **target = None,
            (ParameterRef::DriveLimit(limit, quantity, target), Number(value)) => {
                let value = checks::finite(value)?;
                **target = Some(checks::drive_limit(value, *limit, *quantity, units)?);
            }
            (ParameterRef::Drive(.., target), ParameterValue::None) => **target = None,
            (ParameterRef::Drive(.., target), Number(value)) => {
                **target = Some(checks::drive_number(value)?);
            }
            (ParameterRef::Offset(_, target), ParameterValue::None) => **target = None,
            (ParameterRef::Offset(quantity, target), Number(value)) => {
                **target = Some(size(value, *quantity)?);
            }
            (target, value) => {
                let found = match value {
                    ParameterValue::None => "nothing",
                    Number(_) => "a number",
                    Pair(_) => "a pair",
                };
                let expected = match target {
                    ParameterRef::Number(..) | ParameterRef::Optional(..) => "a number",
                    ParameterRef::Point(_) => "a point [x, y]",
                    ParameterRef::Limits(..) => "limits [lowest, highest] or none",
                    ParameterRef::DriveLimit(..)
                    | ParameterRef::Drive(..)
                    | ParameterRef::Offset(..) => "a number or none",
                };
                return Err(format!("is {found}, expected {expected}"));
            }
        }
        Ok(())
    }
}

impl Family {
    pub(in crate::mechanism) fn groups(&mut self) -> Vec<Group<'_>> {
        match self {
            Self::PlanoSpherical(family) => family.groups(),
            Self::TranslationalHelical(family) => family.groups(),
            Self::PlanarPlanar(family) => family.groups(),
        }
    }

    /// Every parameter with its name, in the order of files: `home.x`, then `leg1.h` and
    /// `leg1.limits.S` for a leg. Values are in metres and radians.
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

    /// A copy of the family with some parameters changed, by the names of [`Family::parameters`].
    ///
    /// A full name such as `leg1.h` changes one parameter. A name without the group, such as `h` or
    /// `limits.S`, changes that parameter in every group that has it. Where both are given, the
    /// full name wins.
    ///
    /// # Errors
    /// [`ParameterErrors`] lists every unknown name and every invalid value: not finite, larger
    /// than any machine, or reversed limits. Whether the parameters fit together is checked by
    /// [`Family::assemble`].
    pub fn with<'n>(
        &self,
        changes: impl IntoIterator<Item = (&'n str, ParameterValue)>,
    ) -> Result<Self, ParameterErrors> {
        self.with_in(changes, FileUnits::SI)
    }

    /// The same with problems in other units. The values are SI.
    pub(in crate::mechanism) fn with_in<'n>(
        &self,
        changes: impl IntoIterator<Item = (&'n str, ParameterValue)>,
        units: FileUnits,
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
            match every.map(|p| p.set(value, units)).collect::<Vec<_>>() {
                set if set.is_empty() => {
                    problems.push(format!("`{name}` is not a parameter; {}", meant(name, &groups)));
                }
                set => {
                    let problem = set.into_iter().find_map(Result::err);
                    problems.extend(problem.map(|problem| format!("`{name}` {problem}")));
                }
            }
        }
        for ((group, parameter), name, value) in whole {
            let set = groups[group].parameters[parameter].set(value, units);
            problems.extend(set.err().map(|problem| format!("`{name}` {problem}")));
        }
        drop(groups);
        if problems.is_empty() { Ok(family) } else { Err(ParameterErrors { problems }) }
    }

    /// What a parameter measures, by its full name or by one without the group; `None` if there is no such parameter.
    pub fn quantity_of(&self, name: &str) -> Option<Quantity> {
        let mut family = self.clone();
        let groups = family.groups();
        let called = |group: &Group<'_>, parameter: &Parameter<'_>| {
            let own = name.strip_prefix(group.name.as_str()).and_then(|n| n.strip_prefix('.'));
            parameter.is_called(name) || own.is_some_and(|own| parameter.is_called(own))
        };
        groups.iter().find_map(|group| {
            let found = group.parameters.iter().find(|parameter| called(group, parameter))?;
            found.quantity()
        })
    }

    /// The text of a mechanism file of this family, in metres and radians. Reading it gives the
    /// same parameters to the last bit.
    pub fn write(&self) -> String {
        self.write_in(FileUnits::SI)
    }

    /// The same in other units.
    pub fn write_in(&self, units: FileUnits) -> String {
        let mut family = self.clone();
        let (word, name, mode) = (self.word(), self.name().to_owned(), self.mode());
        let mut text = format!(
            "format = 1\nname = {}\nunits = {{ length = \"{}\", angle = \"{}\" }}\nfamily = \"{word}\"\n",
            quoted(&name),
            units.length.symbol(),
            units.angle.symbol()
        );
        let mut body = String::new();
        for group in family.groups() {
            let entry = |p: &Parameter<'_>| {
                let number = |value: f64| p.number_in(value, units);
                let value = match p.value()? {
                    ParameterValue::None => return None,
                    ParameterValue::Number(value) => format!("{:?}", number(value)),
                    ParameterValue::Pair([a, b]) => format!("[{:?}, {:?}]", number(a), number(b)),
                };
                Some(format!("{} = {value}", p.key))
            };
            let entries = |table: Option<JointTable>, between: &str| {
                let own = group.parameters.iter().filter(|p| p.table == table);
                own.filter_map(entry).collect::<Vec<_>>().join(between)
            };
            let header = match group.table {
                TableKey::Home => {
                    let _ = writeln!(text, "home = {{ {} }}", entries(None, ", "));
                    continue;
                }
                TableKey::Leg(key) => format!("[{key}]"),
                TableKey::Legs(key) => format!("[[{key}]]"),
            };
            let _ = writeln!(
                body,
                "\n{header}\nname = {}\n{}",
                quoted(&group.name),
                entries(None, "\n")
            );
            for table in JointTable::ALL {
                let joints = entries(Some(table), ", ");
                if !joints.is_empty() {
                    let _ = writeln!(body, "{} = {{ {joints} }}", table.key());
                }
            }
        }
        if !mode.is_empty() {
            let _ = writeln!(text, "mode = \"{mode}\"");
        }
        text + &body
    }

    /// Describes why these parameters do not assemble, each problem with the name of its leg, in SI
    /// units.
    pub fn explain(&self, error: &super::AssemblyError) -> ParameterErrors {
        self.explain_in(error, FileUnits::SI)
    }

    /// The same in other units.
    pub fn explain_in(&self, error: &super::AssemblyError, units: FileUnits) -> ParameterErrors {
        let mut family = self.clone();
        let groups = family.groups();
        let legs: Vec<_> = groups.iter().filter(|group| group.table != TableKey::Home).collect();
        let explained = error.problems.iter().map(|problem| {
            let what = problem.describe(units);
            match problem.leg.and_then(|leg| legs.get(leg)) {
                Some(leg) => format!("{}: {what}", leg.name),
                None => what,
            }
        });
        ParameterErrors { problems: explained.collect() }
    }
}

/// The name that was probably meant, and the known names.
fn meant(name: &str, groups: &[Group<'_>]) -> String {
    let group_of = |group: &&Group<'_>| {
        name.strip_prefix(group.name.as_str()).is_some_and(|rest| rest.starts_with('.'))
    };
    let (prefix, own) = match groups.iter().find(group_of) {
        Some(group) => name.split_at(group.name.len() + 1),
        None => ("", name),
    };
    let every = groups.iter().filter(|group| prefix.is_empty() || group_of(group));
    let names = every.flat_map(|group| &group.parameters).filter(|p| p.value().is_some());
    let nearest = nearest(own, &names.map(Parameter::name).collect::<Vec<_>>());
    let hint = nearest.map_or_else(String::new, |own| format!("did you mean `{prefix}{own}`? "));
    hint + &known(groups)
}

/// Lists the known names, with legs that have the same parameters in one group.
fn known(groups: &[Group<'_>]) -> String {
    let mut kinds: Vec<(Vec<&str>, String)> = vec![];
    for group in groups {
        let of = |table: Option<JointTable>| {
            let has = |p: &&Parameter<'_>| p.table == table && p.value().is_some();
            group.parameters.iter().filter(has).map(|p| p.key).collect::<Vec<_>>()
        };
        let mut names = of(None).join(", ");
        let joints = of(Some(JointTable::Limits));
        if let Some(first) = joints.first() {
            let [most @ .., last] = &JointTable::ALL.map(JointTable::key);
            let (most, joints) = (most.join(", "), joints.join(", "));
            let limits = JointTable::Limits.key();
            let _ = write!(names, ", and {most} and {last} ({limits}.{first}, ...) of {joints}");
        }
        match kinds.iter_mut().find(|(_, known)| *known == names) {
            Some((legs, _)) => legs.push(&group.name),
            None => kinds.push((vec![group.name.as_str()], names)),
        }
    }
    let kinds = kinds.into_iter().map(|(legs, names)| {
        let has = if legs.len() == 1 { "has" } else { "have" };
        format!("{} {has} {}", legs.join(", "), names)
    });
    kinds.collect::<Vec<_>>().join("; ")
}

/// Constructors that read as a table of a family's parameters.
impl<'a> Parameter<'a> {
    pub fn angle(key: &'static str, value: &'a mut f64, expected: &'static str) -> Self {
        Self { key, table: None, expected, target: ParameterRef::Number(Quantity::Angle, value) }
    }

    pub fn length(key: &'static str, value: &'a mut f64, expected: &'static str) -> Self {
        Self { key, table: None, expected, target: ParameterRef::Number(Quantity::Length, value) }
    }

    /// A length per radian, of a leg that may have none.
    pub fn pitch(key: &'static str, value: &'a mut Option<f64>, expected: &'static str) -> Self {
        Self { key, table: None, expected, target: ParameterRef::Optional(Quantity::Length, value) }
    }

    pub fn point(key: &'static str, value: &'a mut [f64; 2], expected: &'static str) -> Self {
        Self { key, table: None, expected, target: ParameterRef::Point(value) }
    }

    /// The parameters `own` of a leg, and the limits and offsets of its joints, each by its key.
    pub fn with_limits<const N: usize>(
        own: Vec<Self>,
        joints: [(&'static str, Quantity, &'a mut JointLimits); N],
    ) -> Vec<Self> {
        let mut tables = JointTable::ALL.map(|_| Vec::new());
        for (key, quantity, JointLimits { range, motion, max_effort, drive, offset }) in joints {
            let MotionLimits { max_rate, max_acceleration } = motion;
            let [rotor, gear, viscous, coulomb] = drive;
            let targets = [
                ParameterRef::Limits(quantity, range),
                ParameterRef::DriveLimit(DriveLimit::Motion(MotionLimit::Rate), quantity, max_rate),
                ParameterRef::DriveLimit(
                    DriveLimit::Motion(MotionLimit::Acceleration),
                    quantity,
                    max_acceleration,
                ),
                ParameterRef::DriveLimit(DriveLimit::Effort, quantity, max_effort),
                ParameterRef::Drive(DriveNumber::RotorInertia, quantity, rotor),
                ParameterRef::Drive(DriveNumber::Gear, quantity, gear),
                ParameterRef::Drive(DriveNumber::ViscousFriction, quantity, viscous),
                ParameterRef::Drive(DriveNumber::CoulombFriction, quantity, coulomb),
                ParameterRef::Offset(quantity, offset),
            ];
            for ((table, parameters), target) in
                JointTable::ALL.into_iter().zip(&mut tables).zip(targets)
            {
                parameters.push(Self { key, table: Some(table), expected: table.key(), target });
            }
        }
        own.into_iter().chain(tables.into_iter().flatten()).collect()
    }
}

#[cfg(test)]
mod tests;
