//! Reading of TOML values: every problem is noted with its location, and reading continues.
//!
//! A method that returns `None` has already reported the problem. Its caller only continues without
//! the value.

use super::checks;
use super::expression::{Fault, Term, direction, evaluate};
use super::hint::expected_one_of;
use super::named::Names;
use super::problem::{FileErrors, Lines, Problem};
use super::units::FileUnits;
use crate::mechanism::joint::{DriveLimit, DriveNumber};
use crate::numeric::Quantity;
use crate::text::{is_unseen, quoted};
use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The problems found so far, the units of the file, and the names of its parameters.
pub struct Reader {
    problems: RefCell<Vec<(usize, String)>>,
    units: Cell<FileUnits>,
    /// What expressions may name; `None` in files whose numbers are no expressions.
    names: RefCell<Option<Names>>,
}

impl Reader {
    pub fn new() -> Self {
        Self { problems: RefCell::default(), units: Cell::default(), names: RefCell::default() }
    }

    pub fn report(&self, at: usize, message: impl Into<String>) {
        self.problems.borrow_mut().push((at, message.into()));
    }

    pub fn units(&self) -> FileUnits {
        self.units.get()
    }

    pub fn set_units(&self, units: FileUnits) {
        self.units.set(units);
    }

    /// Takes expressions in place of numbers from now on, with these names.
    pub(super) fn set_names(&self, names: Names) {
        *self.names.borrow_mut() = Some(names);
    }

    /// Sets the number of the leg of a pattern that is read next, from 1.
    pub(super) fn number_leg(&self, number: Option<usize>) {
        self.names.borrow_mut().iter_mut().for_each(|names| names.number_leg(number));
    }

    /// Whether a problem was reported at this location.
    pub fn has_problem(&self, at: usize) -> bool {
        self.problems.borrow().iter().any(|&(other, _)| other == at)
    }

    /// The problems in the order of their locations; `None` if there are none.
    pub(crate) fn into_errors(self, text: &str) -> Option<FileErrors> {
        let lines = Lines::new(text);
        let mut problems: Vec<_> = self
            .problems
            .into_inner()
            .into_iter()
            .map(|(at, message)| {
                let (line, column) = lines.location(at);
                Problem { line, column, message }
            })
            .collect();
        problems.sort();
        problems.dedup();
        (!problems.is_empty()).then_some(FileErrors { problems })
    }
}

/// A value, with its key for messages.
#[derive(Clone, Copy)]
pub struct Value<'a> {
    value: &'a DeValue<'a>,
    key: &'a str,
    /// Byte offset of the value.
    pub at: usize,
    reader: &'a Reader,
}

impl<'a> Value<'a> {
    fn new(key: &'a str, value: &'a Spanned<DeValue<'a>>, reader: &'a Reader) -> Self {
        Self { value: value.get_ref(), key, at: value.span().start, reader }
    }

    /// Reports the problem `KEY PROBLEM` at the value.
    pub fn report(&self, problem: impl AsRef<str>) {
        self.report_as(self.key, problem.as_ref());
    }

    /// The same with another name than its key.
    pub(super) fn report_as(&self, name: &str, problem: &str) {
        self.reader.report(self.at, format!("`{name}` {problem}"));
    }

    /// The key that it stands under.
    pub(super) fn key(&self) -> &'a str {
        self.key
    }

    /// The expressions of a parameter, as they were typed.
    pub(super) fn formula(&self) -> String {
        match self.value {
            DeValue::String(text) => text.to_string(),
            DeValue::Array(items) => {
                let items =
                    items.iter().map(|item| Value::new(self.key, item, self.reader).formula());
                format!("[{}]", items.collect::<Vec<_>>().join(", "))
            }
            DeValue::Integer(number) => number.to_string(),
            DeValue::Float(number) => number.to_string(),
            _ => String::new(),
        }
    }

    /// Its text, if it is one.
    pub(super) fn text(&self) -> Option<&'a str> {
        self.value.as_str()
    }

    fn wrong_type<T>(&self, expected: &str) -> Option<T> {
        let found = match self.value {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) => "an integer",
            DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "a boolean",
            DeValue::Datetime(_) => "a date or time",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        };
        self.report(format!("is {found}, expected {expected}"));
        None
    }

    pub(crate) fn boolean(&self) -> Option<bool> {
        self.value.as_bool().or_else(|| self.wrong_type("true or false"))
    }

    /// Reads a string.
    pub fn string(&self) -> Option<&'a str> {
        match self.value {
            DeValue::String(text) => Some(text),
            _ => self.wrong_type("a string"),
        }
    }

    /// Reads a name: not empty, without characters that would break it on command lines or in headers of tables (commas,
    /// equals signs, quotes), and without any that cannot be seen, which terminals obey and compilers refuse.
    pub(crate) fn name(&self) -> Option<&'a str> {
        let name = self.string()?;
        let shown = quoted(name);
        if let Some(unseen) = name.chars().find(|&c| is_unseen(c)) {
            self.report(format!(
                "is {shown}, expected a name without U+{:04X}, a character that is not seen",
                u32::from(unseen)
            ));
            return None;
        }
        if name.trim().is_empty() || name.trim() != name || name.contains([',', '=', '"']) {
            self.report(format!(
                "is {shown}, expected a name: not empty, without spaces around it, and without , = \""
            ));
            return None;
        }
        Some(name)
    }

    /// Reads one of the given words, and returns its meaning.
    pub fn word<T: Copy>(&self, words: &[(&str, T)]) -> Option<T> {
        let text = self.string()?;
        let found = words.iter().find(|(word, _)| *word == text).map(|&(_, meaning)| meaning);
        if found.is_none() {
            let names: Vec<_> = words.iter().map(|&(word, _)| word).collect();
            self.report(format!("is {}, {}", quoted(text), expected_one_of(text, &names)));
        }
        found
    }

    pub(crate) fn integer(&self) -> Option<i64> {
        match self.value {
            DeValue::Integer(integer) => {
                let value = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
                if value.is_none() {
                    self.report(format!("is {integer}, expected an integer of at most 64 bits"));
                }
                value
            }
            _ => self.wrong_type("an integer"),
        }
    }

    /// The expression that stands in place of a number or of three; `None` if it is none.
    fn expression(&self) -> Option<&'a str> {
        self.text().filter(|_| self.reader.names.borrow().is_some())
    }

    /// Evaluates an expression. A problem is reported where it is in the text.
    fn evaluated(
        &self,
        name: &str,
        evaluate: impl FnOnce(&str) -> Result<Term, Fault>,
    ) -> Option<Term> {
        match evaluate(self.text()?) {
            Ok(term) => Some(term),
            // What it depends on has its own problem, for which the file is refused.
            Err(Fault { message, .. }) if message.is_empty() => None,
            Err(Fault { at, message }) => {
                // Behind the quotation mark.
                let place = self.at + 1 + at;
                self.reader.report(place, format!("`{name}`: {message}"));
                None
            }
        }
    }

    /// Evaluates an expression with the names that are known.
    fn term_of_names(&self) -> Option<Term> {
        let names = self.reader.names.borrow();
        let names = names.as_ref()?;
        self.evaluated(self.key, |text| evaluate(text, names))
    }

    /// Reads a number, an expression, or a point of three of them.
    pub(super) fn term(
        &self,
        name: &str,
        evaluate: &dyn Fn(&str) -> Result<Term, Fault>,
    ) -> Option<Term> {
        match self.value {
            DeValue::String(_) => self.evaluated(name, evaluate),
            DeValue::Array(_) => {
                let component = |item: &Value<'a>| match item.component(name, evaluate)? {
                    Term::Number(number) => Some(number),
                    Term::Vector(_) => {
                        item.report_as(name, "has a point in a point, expected three numbers");
                        None
                    }
                };
                let [x, y, z] = self.each("a point [x, y, z]", component)?;
                Some(Term::Vector(nalgebra::Vector3::new(x, y, z)))
            }
            _ => self.number().map(Term::Number),
        }
    }

    /// A component of a point, which is no array.
    fn component(
        &self,
        name: &str,
        evaluate: &dyn Fn(&str) -> Result<Term, Fault>,
    ) -> Option<Term> {
        if self.is_array() {
            self.report_as(name, "has an array in a point, expected three numbers");
            return None;
        }
        self.term(name, evaluate)
    }

    /// Three numbers that an expression gives, if there is one: the outer `None` if it is none, the inner one if it gives
    /// none.
    fn vector(&self, expected: &str) -> Option<Option<[f64; 3]>> {
        self.expression()?;
        Some(match self.term_of_names() {
            Some(Term::Vector(vector)) => Some(vector.into()),
            Some(Term::Number(number)) => {
                self.report(format!("is the number {number}, expected {expected}"));
                None
            }
            None => None,
        })
    }

    /// Reads a finite number without a unit. Integers are accepted.
    pub fn number(&self) -> Option<f64> {
        if self.expression().is_some() {
            return match self.term_of_names()? {
                Term::Number(number) => Some(number),
                Term::Vector(_) => {
                    self.report("is a point, expected a number");
                    None
                }
            };
        }
        let value = match self.value {
            DeValue::Float(float) => float.as_str().parse().unwrap_or(f64::NAN),
            // Parsed as i128 first, which also reads hexadecimal, octal and binary integers.
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix())
                .map_or(f64::INFINITY, |n| n as f64),
            _ => return self.wrong_type("a number"),
        };
        if !value.is_finite() {
            let literal = match self.value {
                DeValue::Float(float) => float.to_string(),
                DeValue::Integer(integer) => integer.to_string(),
                _ => String::new(),
            };
            self.report(format!("is {literal}, expected a finite number"));
            return None;
        }
        Some(value)
    }

    /// Reads an angle or a length in the file's unit; returns it in SI.
    pub fn quantity(&self, quantity: Quantity) -> Option<f64> {
        let units = self.reader.units();
        let value = units.si(self.number()?, quantity);
        checks::size(value, quantity, units).map_err(|problem| self.report(problem)).ok()
    }

    /// Reads a length in the file's unit; returns it in metres.
    pub fn length(&self) -> Option<f64> {
        self.quantity(Quantity::Length)
    }

    /// A number as a length, metres.
    fn as_length(&self, number: f64) -> Option<f64> {
        let units = self.reader.units();
        let value = units.si(number, Quantity::Length);
        checks::size(value, Quantity::Length, units).map_err(|problem| self.report(problem)).ok()
    }

    /// Reads a length above zero; returns it in metres.
    pub(crate) fn positive_length(&self) -> Option<f64> {
        self.as_positive_length(self.number()?)
    }

    /// A number as a length above zero, metres.
    fn as_positive_length(&self, number: f64) -> Option<f64> {
        let length = self.as_length(number)?;
        if length > 0.0 {
            return Some(length);
        }
        let found = self.reader.units().show(length, Quantity::Length);
        self.report(format!("is {found}, expected a length above 0"));
        None
    }

    /// Reads three lengths above zero; returns them in metres.
    pub(crate) fn positive_lengths(&self) -> Option<[f64; 3]> {
        let expected = "lengths [a, b, c]";
        match self.vector(expected) {
            Some(given) => all(given?.into_iter().map(|number| self.as_positive_length(number)))?
                .try_into()
                .ok(),
            None => self.each(expected, Self::positive_length),
        }
    }

    /// The values of an array; `expected` describes the array.
    pub fn items(&self, expected: &str) -> Option<Vec<Value<'a>>> {
        match self.value {
            DeValue::Array(items) => {
                Some(items.iter().map(|item| Value::new(self.key, item, self.reader)).collect())
            }
            _ => self.wrong_type(expected),
        }
    }

    /// The values of an array with exactly `count` items.
    fn exactly(&self, count: usize, expected: &str) -> Option<Vec<Value<'a>>> {
        let items = self.items(expected)?;
        if items.len() != count {
            let values = if items.len() == 1 { "value" } else { "values" };
            self.report(format!("has {} {values}, expected {expected}", items.len()));
            return None;
        }
        Some(items)
    }

    fn each<const N: usize>(
        &self,
        expected: &str,
        read: impl Fn(&Value<'a>) -> Option<f64>,
    ) -> Option<[f64; N]> {
        all(self.exactly(N, expected)?.iter().map(read))?.try_into().ok()
    }

    /// Reads a point in the plane or in space; returns it in metres.
    pub(crate) fn point<const N: usize>(&self) -> Option<[f64; N]> {
        let expected = if N == 2 { "a point [x, y]" } else { "a point [x, y, z]" };
        if N == 3
            && let Some(given) = self.vector(expected)
        {
            return all(given?.into_iter().map(|number| self.as_length(number)))?.try_into().ok();
        }
        self.each(expected, Self::length)
    }

    /// Reads a direction: three numbers without a unit, not all zero. Returns the unit vector.
    pub(crate) fn direction(&self) -> Option<nalgebra::Unit<nalgebra::Vector3<f64>>> {
        let expected = "a direction [x, y, z]";
        let [x, y, z] = match self.vector(expected) {
            Some(given) => given?,
            None => self.each(expected, Value::number)?,
        };
        let direction = direction(&nalgebra::Vector3::new(x, y, z));
        if direction.is_none() {
            self.report("is zero, expected a direction");
        }
        direction
    }

    /// Reads one value per coordinate, each with `read`. A single value has no brackets around it.
    pub(crate) fn per_coordinate(
        &self,
        quantities: &[Quantity],
        read: impl Fn(&Self, Quantity) -> Option<f64>,
    ) -> Option<Vec<f64>> {
        if let [quantity] = quantities {
            return Some(vec![read(self, *quantity)?]);
        }
        let expected = format!("{} values, one for each coordinate", quantities.len());
        let items = self.exactly(quantities.len(), &expected)?;
        all(items.iter().zip(quantities).map(|(item, &quantity)| read(item, quantity)))
    }

    /// Reads the lowest and highest value of each coordinate. A single pair has no outer brackets.
    pub(crate) fn limits_per_coordinate(&self, quantities: &[Quantity]) -> Option<Vec<[f64; 2]>> {
        if let [quantity] = quantities {
            return Some(vec![self.limits(*quantity)?]);
        }
        let expected =
            format!("{} pairs [lowest, highest], one for each coordinate", quantities.len());
        let items = self.exactly(quantities.len(), &expected)?;
        all(items.iter().zip(quantities).map(|(item, &quantity)| item.limits(quantity)))
    }

    /// Reads the lowest and highest value, both included.
    pub(crate) fn limits(&self, quantity: Quantity) -> Option<[f64; 2]> {
        let limits = self.each("limits [lowest, highest]", |item| item.quantity(quantity))?;
        let ordered = checks::ordered(limits, quantity, self.reader.units());
        ordered.map_err(|problem| self.report(problem)).ok()
    }

    /// Reads the largest rate or acceleration of a joint in the file's units and seconds, or its largest effort in newtons or
    /// newton metres; returns it in SI.
    pub(crate) fn drive_limit(&self, limit: DriveLimit, quantity: Quantity) -> Option<f64> {
        let units = self.reader.units();
        let number = self.number()?;
        let value = if limit.has_units_of_file() { units.si(number, quantity) } else { number };
        let checked = checks::drive_limit(value, limit, quantity, units);
        checked.map_err(|problem| self.report(problem)).ok()
    }

    /// Reads a number of a joint's drive, which is at least zero; returns it in SI.
    pub(crate) fn drive_number(&self, number: DriveNumber, quantity: Quantity) -> Option<f64> {
        let given = self.number()?;
        let checked = checks::drive_number(given);
        let checked = checked.map_err(|problem| self.report(problem)).ok()?;
        Some(checked / number.in_file(quantity, self.reader.units()))
    }

    /// Whether the value is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.value, DeValue::Table(_))
    }

    /// Whether the value is an array.
    pub fn is_array(&self) -> bool {
        matches!(self.value, DeValue::Array(_))
    }

    /// Reads a table, and reports every key that is not in `keys`.
    pub fn table(&self, keys: &[&str]) -> Option<Table<'a>> {
        let table = self.open_table()?;
        table.allow(keys);
        Some(table)
    }

    /// Reads a table whose keys are still to be checked.
    pub fn open_table(&self) -> Option<Table<'a>> {
        match self.value {
            DeValue::Table(entries) => Some(Table::new(entries, self.at, self.reader)),
            _ => self.wrong_type("a table"),
        }
    }
}

/// A table of the file.
#[derive(Clone, Copy)]
pub struct Table<'a> {
    entries: &'a DeTable<'a>,
    /// Byte offset of the table's header, or of its opening brace.
    pub at: usize,
    /// What collects the problems of the file, and knows its units.
    pub reader: &'a Reader,
}

impl<'a> Table<'a> {
    pub(crate) fn new(entries: &'a DeTable<'a>, at: usize, reader: &'a Reader) -> Self {
        Self { entries, at, reader }
    }

    /// Reports every key that is not in `keys`.
    pub fn allow(&self, keys: &[&str]) {
        for key in self.entries.keys() {
            let name: &str = key.get_ref();
            if !keys.contains(&name) {
                let (shown, expected) = (name.escape_debug(), expected_one_of(name, keys));
                self.reader.report(key.span().start, format!("unknown key `{shown}`, {expected}"));
            }
        }
    }

    /// The keys, in alphabetic order.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let mut keys: Vec<&str> = self.entries.keys().map(|key| &**key.get_ref()).collect();
        keys.sort_unstable();
        keys.into_iter()
    }

    /// Every value, in the order of the file.
    pub(super) fn in_order(&self) -> Vec<Value<'a>> {
        let mut entries: Vec<_> = self.entries.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        entries
            .into_iter()
            .map(|(key, value)| Value::new(key.get_ref(), value, self.reader))
            .collect()
    }

    /// The value of an optional key.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        let (key, value) = self.entries.get_key_value(key)?;
        Some(Value::new(key.get_ref(), value, self.reader))
    }

    /// The value of a required key; `expected` describes the value.
    pub fn require(&self, key: &str, expected: &str) -> Option<Value<'a>> {
        let value = self.get(key);
        if value.is_none() {
            self.reader.report(self.at, format!("`{key}` is missing, expected {expected}"));
        }
        value
    }

    /// The location for a problem with a key: that of its value, or that of the table if the key is
    /// missing.
    pub fn location_of(&self, key: &str) -> usize {
        self.get(key).map_or(self.at, |value| value.at)
    }

    /// The tables of an array of tables; none if the key is missing.
    pub(crate) fn tables(&self, key: &str, keys: &[&str]) -> Vec<Table<'a>> {
        let tables = self.open_tables(key);
        tables.iter().for_each(|table| table.allow(keys));
        tables
    }

    /// The same, where the keys of each table are still to be checked.
    pub(crate) fn open_tables(&self, key: &str) -> Vec<Table<'a>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let Some(items) = value.items(&format!("an array of tables [[{key}]]")) else {
            return Vec::new();
        };
        items.iter().filter_map(Value::open_table).collect()
    }
}

/// Checks that names of one kind are different.
pub(crate) struct UniqueNames {
    what: &'static str,
    seen: HashSet<String>,
    /// Names that are reserved, and what each of them names.
    reserved: HashMap<String, &'static str>,
}

impl UniqueNames {
    pub(crate) fn new(what: &'static str) -> Self {
        Self { what, seen: HashSet::new(), reserved: HashMap::new() }
    }

    /// Reserves a name for something else.
    pub(super) fn reserve(&mut self, name: &str, other: &'static str) {
        self.reserved.insert(name.to_owned(), other);
    }

    /// Reports a name that was used before, or that is reserved.
    pub(crate) fn add(&mut self, name: &str, reader: &Reader, at: usize) {
        let what = self.what;
        if let Some(other) = self.reserved.get(name) {
            let problem = format!("{name:?} is the name of {other}, expected another for {what}");
            reader.report(at, problem);
        } else if !self.seen.insert(name.to_owned()) {
            reader.report(at, format!("two {what} are called {name:?}, expected different names"));
        }
    }
}

/// The values, if all of them could be read. All are read before the result is decided, so that
/// every problem is reported.
pub fn all<T>(read: impl Iterator<Item = Option<T>>) -> Option<Vec<T>> {
    read.collect::<Vec<_>>().into_iter().collect()
}
