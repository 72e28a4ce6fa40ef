//! The text of a file with some of its numbers changed: everything else stays as it was typed, with its comments, its order
//! and its digits.
//!
//! The parser tells where each value stands, so that a change replaces the bytes of a number.

use super::{FileUnits, quoted};
use crate::mechanism::family::{Family, Group, JointTable, Parameter, ParameterValue, TableKey};
use crate::mechanism::joint::{DriveLimit, DriveNumber, Joint, JointCoordinate, JointKind};
use crate::mechanism::{BodyMasses, Mechanism, Payload, TaskHints};
use crate::numeric::Quantity;
use std::collections::HashMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text with other numbers, of the file, for some of its named parameters.
pub(super) fn parameters(text: &str, values: &[(&str, f64)]) -> Option<String> {
    edited(text, |root, edits| {
        let table = root.table("parameters")?;
        for &(name, value) in values {
            let given = table.get(name)?;
            let given = match given.get_ref() {
                DeValue::Table(entries) => entries.get("value")?,
                _ => given,
            };
            edits.replace(given.span(), literal(value));
        }
        Some(())
    })
}

/// The text with other parameters of its family.
pub(super) fn family(
    text: &str,
    [before, after]: [&Family; 2],
    units: FileUnits,
) -> Option<String> {
    let (mut before, mut after) = (before.clone(), after.clone());
    let values =
        |group: &Group<'_>| -> Vec<_> { group.parameters.iter().map(Parameter::value).collect() };
    edited(text, |root, edits| {
        let mut numbers = HashMap::new();
        for (old, new) in before.groups().iter().zip(after.groups().iter()) {
            let table = match old.table {
                TableKey::Home if values(old) == values(new) => continue,
                TableKey::Home => root.table("home")?,
                TableKey::Leg(key) => root.table(key)?,
                TableKey::Legs(key) => {
                    let number = numbers.entry(key).or_insert(0_usize);
                    *number += 1;
                    root.items(key)?.into_iter().nth(*number - 1)?
                }
            };
            for (old, new) in old.parameters.iter().zip(&new.parameters) {
                if old.value() == new.value() {
                    continue;
                }
                let flat = |value| match value {
                    Some(ParameterValue::Number(number)) => vec![number],
                    Some(ParameterValue::Pair(pair)) => pair.to_vec(),
                    Some(ParameterValue::None) | None => vec![],
                };
                let of = |value: f64| new.number_in(value, units);
                let change = Change {
                    before: flat(old.value()),
                    after: flat(new.value()),
                    number: &of,
                    rows: 1,
                };
                match new.table {
                    None => change.apply(&table, new.key, edits),
                    Some(joints) => change.apply_in(&table, joints, new.key, edits)?,
                }
            }
        }
        Some(())
    })
}

/// The text with other joints: other homes, limits, places and directions. `None` if the text cannot say them, as for one leg
/// of a pattern.
pub(super) fn joints(
    text: &str,
    [before, after]: [&Mechanism; 2],
    units: FileUnits,
) -> Option<String> {
    let same = before.name == after.name
        && before.shapes == after.shapes
        && before.differences == after.differences
        && before.legs.len() == after.legs.len();
    if !same {
        return None;
    }
    edited(text, |root, edits| {
        task(root, [&before.task, &after.task], edits)?;
        masses(root, [&before.bodies, &after.bodies], edits)?;
        if before.platform != after.platform {
            let flat = |mechanism: &Mechanism| mechanism.platform.coords.as_slice().to_vec();
            let number = |value| units.number_of(value, Quantity::Length);
            Change { before: flat(before), after: flat(after), number: &number, rows: 1 }.apply(
                &root.table("platform")?,
                "point",
                edits,
            );
        }
        let mut legs = before.legs.iter().zip(&after.legs);
        for leg in root.items("leg")? {
            let count = leg.table("pattern").map(|pattern| count_of(&pattern));
            let all: Vec<_> = legs.by_ref().take(count.unwrap_or(1)).collect();
            let mut numbers = 0..;
            let mut next = || {
                let number = numbers.next()?;
                let pairs = all
                    .iter()
                    .map(|(old, new)| Some([old.joints.get(number)?, new.joints.get(number)?]));
                pairs.collect::<Option<Vec<[&Joint; 2]>>>()
            };
            for joint in leg.array("joints")? {
                let joint = Place::inline(joint)?;
                let pairs = next()?;
                edit_joint(&joint, &pairs, count.is_some(), units, edits)?;
                if joint.get("point2").is_some() {
                    edit_end(&joint, [&pairs, &next()?], units, edits)?;
                }
            }
        }
        legs.next().is_none().then_some(())
    })
}

/// The number of legs that a pattern makes.
fn count_of(pattern: &Place<'_>) -> usize {
    let mirrored = if pattern.get("mirror").is_some() { 2 } else { 1 };
    let count = pattern.get("count").or_else(|| pattern.get("repeat"));
    let count = count.and_then(|count| count.get_ref().as_integer());
    let count = count.and_then(|count| usize::from_str_radix(count.as_str(), count.radix()).ok());
    let angles = pattern.array("angles").map(<[_]>::len);
    mirrored * count.or(angles).unwrap_or(1)
}

/// Edits the description of a joint, of which a pattern makes several.
fn edit_joint(
    table: &Place<'_>,
    pairs: &[[&Joint; 2]],
    is_pattern: bool,
    units: FileUnits,
    edits: &mut Edits<'_>,
) -> Option<()> {
    if pairs.iter().all(|[old, new]| old == new) {
        return Some(());
    }
    let [old, new] = *pairs.first()?;
    let alike = |[before, after]: &[&Joint; 2]| {
        let kinds = std::mem::discriminant(&before.kind) == std::mem::discriminant(&after.kind);
        kinds
            && before.actuated == after.actuated
            && before.turns_back == after.turns_back
            && before.cone == after.cone
            && (is_pattern || before.name == after.name)
    };
    if !pairs.iter().all(alike) {
        return None;
    }
    let places = |joint: &Joint| (joint.point, joint.axis, joint.kind);
    if is_pattern {
        // One description holds for all legs: what changes has to be the same in each of them.
        let moved = pairs.iter().any(|[before, after]| places(before) != places(after));
        let values = |joint: &Joint| -> Vec<_> {
            joint
                .coordinates
                .iter()
                .map(|c| (c.home, c.limits, c.motion_limits, c.max_effort, c.drive))
                .collect()
        };
        if moved || pairs.iter().any(|[_, after]| values(after) != values(new)) {
            return None;
        }
    }
    let length = |value| units.number_of(value, Quantity::Length);
    let plain = |value| value;
    let mut vector = |key: &str, before: &[f64], after: &[f64], number: &dyn Fn(f64) -> f64| {
        if before != after {
            Change { before: before.to_vec(), after: after.to_vec(), number, rows: 1 }
                .apply(table, key, edits);
        }
    };
    // Where a slider is drawn follows from its leg, if its place is not given.
    if old.kind != JointKind::Prismatic || table.get("point").is_some() {
        vector("point", old.point.coords.as_slice(), new.point.coords.as_slice(), &length);
    }
    vector("axis", old.axis.as_slice(), new.axis.as_slice(), &plain);
    match (old.kind, new.kind) {
        (JointKind::Universal { second: a }, JointKind::Universal { second: b }) => {
            vector("axis2", a.as_slice(), b.as_slice(), &plain);
        }
        (JointKind::Helical { pitch: a }, JointKind::Helical { pitch: b }) => {
            vector("pitch", &[a], &[b], &length);
        }
        _ => {}
    }
    let quantities: Vec<Quantity> = new.coordinates.iter().map(|c| c.quantity).collect();
    let mut of_coordinates =
        |key: &str, per: usize, numbers: &dyn Fn(&JointCoordinate) -> Option<Vec<f64>>| {
            let flat = |joint: &Joint| -> Vec<f64> {
                let all: Option<Vec<_>> = joint.coordinates.iter().map(numbers).collect();
                all.unwrap_or_default().concat()
            };
            let [before, after] = [flat(old), flat(new)];
            if before == after {
                return;
            }
            // In the units of the file already.
            Change {
                before,
                after,
                number: &plain,
                rows: if per > 1 { quantities.len() } else { 1 },
            }
            .apply(table, key, edits);
        };
    let number = |c: &JointCoordinate, value: f64| units.number_of(value, c.quantity);
    of_coordinates("home", 1, &|c| Some(vec![number(c, c.home)]));
    of_coordinates("limits", 2, &|c| Some(c.limits?.map(|limit| number(c, limit)).to_vec()));
    for limit in DriveLimit::ALL {
        of_coordinates(limit.key(), 1, &|c| {
            let value = limit.of(c)?;
            Some(vec![if limit.has_units_of_file() { number(c, value) } else { value }])
        });
    }
    for number in DriveNumber::ALL {
        let flat = |joint: &Joint| -> Vec<f64> {
            let all = joint.coordinates.iter();
            let is_usual = |c: &JointCoordinate| number.of(&c.drive) == number.usual();
            match all.clone().all(is_usual) {
                true => Vec::new(),
                false => {
                    all.map(|c| number.of(&c.drive) * number.in_file(c.quantity, units)).collect()
                }
            }
        };
        let [before, after] = [flat(old), flat(new)];
        if before != after {
            Change { before, after, number: &plain, rows: 1 }.apply(table, number.key(), edits);
        }
    }
    Some(())
}

/// Edits the second hinge of a parallelogram, which has nothing of its own but its place. The first hinges are edited.
fn edit_end(
    table: &Place<'_>,
    [first, ends]: [&[[&Joint; 2]]; 2],
    units: FileUnits,
    edits: &mut Edits<'_>,
) -> Option<()> {
    let said = |[[_, first], [old, new]]: [&[&Joint; 2]; 2]| {
        let [_, mut end] = Joint::parallelogram(&first.name, first.axis, [first.point, new.point]);
        end.coordinates[0].home = -first.coordinates[0].home;
        end == **new && (ends.len() == 1 || old.point == new.point)
    };
    if !first.iter().zip(ends).all(|(first, end)| said([first, end])) {
        return None;
    }
    let [old, new] = *ends.first()?;
    if old.point != new.point {
        let number = |value| units.number_of(value, Quantity::Length);
        let [before, after] = [old, new].map(|joint| joint.point.coords.as_slice().to_vec());
        Change { before, after, number: &number, rows: 1 }.apply(table, "point2", edits);
    }
    Some(())
}

/// Edits `[bodies]`, of which masses and a density can be changed.
fn masses(
    root: &Place<'_>,
    [before, after]: [&BodyMasses; 2],
    edits: &mut Edits<'_>,
) -> Option<()> {
    let [old, new] = [before, after].map(|bodies| {
        let payload = bodies.payload.map(|payload| Payload { mass: 0.0, ..payload });
        (&bodies.centres, &bodies.inertias, payload)
    });
    let placed = (old.0, old.1) == (new.0, new.1);
    let carries = old.2.is_none() || old.2 == new.2;
    if before == after || !placed || !carries {
        return (before == after).then_some(());
    }
    let table = root.table("bodies");
    let mut lines = String::new();
    let mut set = |key: &str, value: String, edits: &mut Edits<'_>| match &table {
        Some(table) => edits.set(table, key, Some(value)),
        None => lines += &format!("{key} = {value}\n"),
    };
    let changed = |(name, mass): &&(String, f64)| before.of(name) != Some(*mass);
    if before.density != after.density {
        set("density", literal(after.density?), edits);
    }
    let masses: Vec<_> = after.masses.iter().filter(changed).collect();
    match table.as_ref().and_then(|table| table.table("masses")) {
        Some(own) => {
            for (name, mass) in masses {
                edits.set(&own, &key(name), Some(literal(*mass)));
            }
        }
        None if masses.is_empty() => {}
        None => {
            let each =
                masses.iter().map(|(name, mass)| format!("{} = {}", key(name), literal(*mass)));
            set("masses", format!("{{ {} }}", each.collect::<Vec<_>>().join(", ")), edits);
        }
    }
    if before.payload != after.payload {
        let mass = literal(after.payload?.mass);
        match table.as_ref().and_then(|table| table.table("payload")) {
            Some(own) => edits.set(&own, "mass", Some(mass)),
            None => set("payload", format!("{{ mass = {mass} }}"), edits),
        }
    }
    if !lines.is_empty() {
        edits.append(&format!("\n[bodies]\n{lines}"));
    }
    Some(())
}

/// A name as a key.
fn key(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    if !name.is_empty() && name.chars().all(plain) { name.to_owned() } else { quoted(name) }
}

/// The text with other angles of an orientation, and other masses.
pub(super) fn angles(text: &str, [before, after]: [&Mechanism; 2]) -> Option<String> {
    let bodies = [&before.bodies, &after.bodies];
    let hints = |mechanism: &Mechanism| TaskHints {
        coordinates: mechanism.task.coordinates,
        ..TaskHints::default()
    };
    let [before, after] = [hints(before), hints(after)];
    edited(text, |root, edits| {
        task(root, [&before, &after], edits)?;
        masses(root, bodies, edits)
    })
}

/// Edits `[task]`, of which the angles of an orientation can be changed.
fn task(root: &Place<'_>, [before, after]: [&TaskHints; 2], edits: &mut Edits<'_>) -> Option<()> {
    if before == after {
        return Some(());
    }
    let coordinates = after.coordinates;
    if (TaskHints { coordinates, ..before.clone() }) != *after {
        return None;
    }
    let word = coordinates.map(|coordinates| quoted(coordinates.name()));
    match (root.table("task"), word) {
        (Some(table), word) => edits.set(&table, "coordinates", word),
        (None, Some(word)) => edits.append(&format!("\n[task]\ncoordinates = {word}\n")),
        (None, None) => {}
    }
    Some(())
}

/// Numbers under one key, before and after.
struct Change<'a> {
    before: Vec<f64>,
    /// None: the key goes.
    after: Vec<f64>,
    /// An SI value in the units of the file.
    number: &'a dyn Fn(f64) -> f64,
    /// Into how many arrays the numbers are divided.
    rows: usize,
}

impl Change<'_> {
    fn apply(&self, table: &Place<'_>, key: &str, edits: &mut Edits<'_>) {
        if self.after.is_empty() {
            return edits.set(table, key, None);
        }
        let numbers: Vec<String> =
            self.after.iter().map(|&value| literal((self.number)(value))).collect();
        if let Some(given) = table.get(key) {
            let mut leaves = Vec::new();
            collect(given, &mut leaves);
            if leaves.len() == numbers.len() && self.before.len() == numbers.len() {
                let changed = self.before.iter().zip(&self.after).map(|(a, b)| a != b);
                for ((place, number), _) in
                    leaves.into_iter().zip(numbers).zip(changed).filter(|&(_, changed)| changed)
                {
                    edits.replace(place, number);
                }
                return;
            }
        }
        edits.set(table, key, Some(self.text(&numbers)));
    }

    fn text(&self, numbers: &[String]) -> String {
        let array = |numbers: &[String]| format!("[{}]", numbers.join(", "));
        match numbers {
            [one] => one.clone(),
            all if self.rows > 1 => {
                let rows: Vec<_> = all.chunks(all.len() / self.rows).map(array).collect();
                array(&rows)
            }
            all => array(all),
        }
    }

    /// The same in a table of a leg's joints, which there may not be yet.
    fn apply_in(
        &self,
        leg: &Place<'_>,
        joints: JointTable,
        key: &str,
        edits: &mut Edits<'_>,
    ) -> Option<()> {
        match leg.get(joints.key()) {
            Some(table) => self.apply(&Place::inline(table)?, key, edits),
            None if self.after.is_empty() => {}
            None => {
                let numbers: Vec<_> =
                    self.after.iter().map(|&value| literal((self.number)(value))).collect();
                let entry = format!("{{ {key} = {} }}", self.text(&numbers));
                edits.set(leg, joints.key(), Some(entry));
            }
        }
        Some(())
    }
}

/// The places of the numbers, and of the expressions, in a value.
fn collect(value: &Spanned<DeValue<'_>>, leaves: &mut Vec<Range<usize>>) {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().for_each(|item| collect(item, leaves)),
        _ => leaves.push(value.span()),
    }
}

/// A number as it stands in a file: whole ones without a fraction.
fn literal(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// A table of the text, and where it is.
pub(super) struct Place<'a> {
    entries: &'a DeTable<'a>,
    at: Range<usize>,
}

impl<'a> Place<'a> {
    fn inline(value: &'a Spanned<DeValue<'a>>) -> Option<Self> {
        match value.get_ref() {
            DeValue::Table(entries) => Some(Self { entries, at: value.span() }),
            _ => None,
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.get(key)
    }

    fn table(&self, key: &str) -> Option<Self> {
        Self::inline(self.get(key)?)
    }

    fn array(&self, key: &str) -> Option<&'a [Spanned<DeValue<'a>>]> {
        match self.get(key)?.get_ref() {
            DeValue::Array(items) => Some(items),
            _ => None,
        }
    }

    fn items(&self, key: &str) -> Option<Vec<Self>> {
        self.array(key)?.iter().map(Self::inline).collect()
    }
}

/// Replacements of bytes of a text.
struct Edits<'t> {
    text: &'t str,
    changes: Vec<(Range<usize>, String)>,
}

impl Edits<'_> {
    fn replace(&mut self, place: Range<usize>, by: String) {
        self.changes.push((place, by));
    }

    fn append(&mut self, lines: &str) {
        let end = self.text.len();
        let stop = if self.text.ends_with('\n') { "" } else { "\n" };
        self.replace(end..end, format!("{stop}{lines}"));
    }

    /// Sets a key of a table, or removes it.
    fn set(&mut self, table: &Place<'_>, key: &str, value: Option<String>) {
        let is_inline = self.text[table.at.start..].starts_with('{');
        let given = table.entries.get_key_value(key);
        match (given, value) {
            (Some((_, given)), Some(value)) => self.replace(given.span(), value),
            (None, None) => {}
            (None, Some(value)) => {
                let own = |value: &&Spanned<DeValue<'_>>| {
                    is_inline
                        || !self.text[value.span().start..].starts_with('[')
                        || value.get_ref().is_array()
                };
                let ends = table.entries.values().filter(own).map(|value| value.span().end);
                let last = ends.max();
                let (at, text) = match (is_inline, last) {
                    (true, Some(end)) => (end, format!(", {key} = {value}")),
                    (true, None) => (table.at.start + 1, format!(" {key} = {value} ")),
                    (false, last) => {
                        let from = last.unwrap_or(table.at.end);
                        (self.line_end(from), format!("\n{key} = {value}"))
                    }
                };
                self.replace(at..at, text);
            }
            (Some((name, given)), None) => {
                let (start, end) = (name.span().start, given.span().end);
                let place = if is_inline {
                    let before = table.entries.values().map(|value| value.span().end);
                    let before = before.filter(|&end| end <= start).max();
                    let behind = table.entries.keys().map(|name| name.span().start);
                    let behind = behind.filter(|&next| next >= end).min();
                    match (before, behind) {
                        (Some(before), _) => before..end,
                        (None, Some(behind)) => start..behind,
                        (None, None) => start..end,
                    }
                } else {
                    let line = self.text[..start].rfind('\n').map_or(0, |newline| newline + 1);
                    line..(self.line_end(end) + 1).min(self.text.len())
                };
                self.replace(place, String::new());
            }
        }
    }

    /// The end of the line of a place, without its line break.
    fn line_end(&self, from: usize) -> usize {
        let end = self.text[from..].find('\n').map_or(self.text.len(), |newline| from + newline);
        if self.text[..end].ends_with('\r') { end - 1 } else { end }
    }
}

/// The text after some edits; `None` if one of them cannot be made.
fn edited(
    text: &str,
    edit: impl FnOnce(&Place<'_>, &mut Edits<'_>) -> Option<()>,
) -> Option<String> {
    let document = DeTable::parse(text).ok()?;
    let root = Place { entries: document.get_ref(), at: 0..0 };
    let mut edits = Edits { text, changes: Vec::new() };
    edit(&root, &mut edits)?;
    let mut changes = edits.changes;
    changes.sort_by_key(|(place, _)| (place.start, place.end));
    let mut result = String::with_capacity(text.len());
    let mut from = 0;
    for (place, by) in changes {
        // Two edits of one place would garble the text.
        if place.start < from {
            return None;
        }
        result += &text[from..place.start];
        result += &by;
        from = place.end;
    }
    result += &text[from..];
    // Two entries that make one table each give it twice.
    DeTable::parse(&result).is_ok().then_some(result)
}
