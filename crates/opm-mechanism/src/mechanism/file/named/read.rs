//! Reading `[parameters]`: each is evaluated when it is first needed, in whatever order they stand.

use super::{NamedParameter, NamedValue, ParameterUnit};
use crate::mechanism::file::checks;
use crate::mechanism::file::expression::{Found, Scope, Term, evaluate, is_function, is_name};
use crate::mechanism::file::reader::{Table, Value};
use crate::mechanism::file::units::FileUnits;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;

/// The keys of a parameter's table.
pub(in crate::mechanism::file) const KEYS: &[&str] = &["value", "unit", "min", "max", "text"];

/// Names that mean something else, in expressions or where numbers are changed by name.
const TAKEN: [&str; 6] = ["pi", INDEX, "limits", "max_rate", "max_acceleration", "max_effort"];

/// The number of a leg of a pattern, in expressions.
pub(in crate::mechanism::file) const INDEX: &str = "i";

/// How long a chain of parameters may be of which each follows from the next.
const LONGEST: usize = 200;

/// The values of the parameters, in the units of the file, and the number of the leg that is read.
#[derive(Default)]
pub(in crate::mechanism::file) struct Names {
    parameters: HashMap<String, Option<Term>>,
    index: Option<usize>,
    units: FileUnits,
}

impl Names {
    /// Sets the number of the leg that is read next.
    pub fn number_leg(&mut self, index: Option<usize>) {
        self.index = index;
    }
}

impl Scope for Names {
    fn value(&self, name: &str) -> Found {
        if let (INDEX, Some(index)) = (name, self.index) {
            return Found::Term(Term::Number(index as f64));
        }
        match self.parameters.get(name) {
            Some(Some(term)) => Found::Term(*term),
            Some(None) => Found::Without(None),
            None => Found::Nothing,
        }
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.parameters.keys().cloned().collect();
        names.sort();
        names
    }

    fn units(&self) -> FileUnits {
        self.units
    }

    fn leg(&self) -> Option<usize> {
        self.index
    }
}

/// A parameter as it stands in the file.
struct Entry<'a> {
    name: &'a str,
    unit: ParameterUnit,
    /// The value's own place.
    value: Option<Value<'a>>,
    table: Option<Table<'a>>,
}

/// Reads the table, if there is one. The reader knows the names from then on.
pub(in crate::mechanism::file) fn read(root: &Table<'_>) -> Vec<NamedParameter> {
    let units = root.reader.units();
    let known = |parameters| Names { parameters, index: None, units };
    root.reader.set_names(known(HashMap::new()));
    let table = root.get("parameters").and_then(|value| value.open_table());
    let entries: Vec<Entry<'_>> =
        table.iter().flat_map(Table::in_order).map(|value| entry(&value)).collect();
    let values = Values {
        places: entries.iter().enumerate().map(|(index, entry)| (entry.name, index)).collect(),
        entries: &entries,
        states: RefCell::new(vec![State::Open; entries.len()]),
        chain: RefCell::default(),
        follows: Cell::default(),
        units,
    };
    let all: Vec<Option<Evaluated>> = (0..entries.len()).map(|index| values.of(index)).collect();
    let names = entries.iter().map(|entry| entry.name.to_owned());
    let terms = all.iter().map(|value| value.map(|value| value.term));
    root.reader.set_names(known(names.zip(terms).collect()));
    let read = entries.iter().zip(all);
    read.filter_map(|(entry, value)| entry.parameter(value?, units)).collect()
}

fn entry<'a>(value: &Value<'a>) -> Entry<'a> {
    let name = value.key();
    if !is_name(name) {
        value.report(
            "is no name of a parameter, expected letters, digits and _, and no digit first",
        );
    } else if TAKEN.contains(&name) || is_function(name) {
        value.report("has another meaning in expressions or changes, expected another name");
    }
    if !value.is_table() {
        let value = Some(*value);
        return Entry { name, unit: ParameterUnit::Number, value, table: None };
    }
    let table = value.table(KEYS);
    let unit = table.and_then(|table| table.get("unit"));
    let unit = unit.and_then(|unit| unit.word(&ParameterUnit::NAMED));
    let value = table.and_then(|table| {
        table.require("value", "a number, an expression in quotes, or a point [x, y, z]")
    });
    Entry { name, unit: unit.unwrap_or(ParameterUnit::Number), value, table }
}

impl Entry<'_> {
    /// The parameter with its value in the units of the file.
    fn parameter(&self, evaluated: Evaluated, units: FileUnits) -> Option<NamedParameter> {
        let (unit, Evaluated { term, follows }) = (self.unit, evaluated);
        let value = match term {
            Term::Number(number) => NamedValue::Number(unit.si(number, units)),
            Term::Vector(v) => NamedValue::Point(v.map(|c| unit.si(c, units)).into()),
        };
        let bound = |key: &str| self.table?.get(key)?.number();
        let range = [bound("min"), bound("max")];
        let named = self.value?;
        match (term, range) {
            (Term::Number(number), [low, high]) => {
                let beyond = |bound: Option<f64>, sign: f64| {
                    bound.filter(|bound| sign * (number - bound) > 0.0)
                };
                let show = |number: f64| unit.show(unit.si(number, units), units);
                if let Some(low) = beyond(low, -1.0) {
                    let problem = format!("is {}, expected at least {}", show(number), show(low));
                    self.report(&problem);
                } else if let Some(high) = beyond(high, 1.0) {
                    let problem = format!("is {}, expected at most {}", show(number), show(high));
                    self.report(&problem);
                }
            }
            (Term::Vector(_), [None, None]) => {}
            (Term::Vector(_), _) => self.report("is a point, which has no min and max"),
        }
        let text = self.table.and_then(|table| table.get("text")).and_then(|text| text.string());
        let formula = follows.then(|| named.formula());
        let range = range.map(|bound| bound.map(|bound| unit.si(bound, units)));
        let (name, text) = (self.name.to_owned(), text.map(str::to_owned));
        Some(NamedParameter { name, unit, value, formula, range, text })
    }

    /// Reports a problem of the parameter, by its name.
    fn report(&self, problem: &str) {
        let Some(value) = self.value else { return };
        value.report_as(self.name, problem);
    }
}

#[derive(Clone, Copy)]
enum State {
    Open,
    /// It is being evaluated: what needs it now depends on itself.
    Begun,
    Done(Option<Evaluated>),
}

/// A value, and whether it follows from other parameters.
#[derive(Clone, Copy)]
struct Evaluated {
    term: Term,
    follows: bool,
}

/// The values of parameters, each evaluated once, when it is first needed.
struct Values<'a> {
    entries: &'a [Entry<'a>],
    /// The numbers of the entries by their names.
    places: HashMap<&'a str, usize>,
    states: RefCell<Vec<State>>,
    /// Those that are being evaluated, each of which needs the next.
    chain: RefCell<Vec<usize>>,
    /// Whether the one that is being evaluated has named another.
    follows: Cell<bool>,
    units: FileUnits,
}

impl Values<'_> {
    fn of(&self, index: usize) -> Option<Evaluated> {
        if let State::Done(value) = self.states.borrow()[index] {
            return value;
        }
        self.states.borrow_mut()[index] = State::Begun;
        self.chain.borrow_mut().push(index);
        let outer = self.follows.replace(false);
        let term = self.evaluated(&self.entries[index]);
        let follows = self.follows.replace(outer);
        self.chain.borrow_mut().pop();
        let value = term.map(|term| Evaluated { term, follows });
        self.states.borrow_mut()[index] = State::Done(value);
        value
    }

    fn evaluated(&self, entry: &Entry<'_>) -> Option<Term> {
        let value = entry.value?;
        let term = value.term(entry.name, &|text| evaluate(text, self))?;
        let sizes = match term {
            Term::Number(number) => vec![number],
            Term::Vector(vector) => vector.iter().copied().collect(),
        };
        let quantity = entry.unit.quantity();
        let too_large = sizes.into_iter().find_map(|number| {
            checks::size(self.units.si(number, quantity?), quantity?, self.units).err()
        });
        match too_large {
            Some(problem) => {
                value.report_as(entry.name, &problem);
                None
            }
            None => Some(term),
        }
    }
}

impl Scope for Values<'_> {
    fn value(&self, name: &str) -> Found {
        let Some(&index) = self.places.get(name) else { return Found::Nothing };
        self.follows.set(true);
        let state = self.states.borrow()[index];
        match state {
            State::Done(Some(value)) => Found::Term(value.term),
            State::Done(None) => Found::Without(None),
            State::Begun => {
                let chain = self.chain.borrow();
                let names = chain.iter().skip_while(|&&other| other != index);
                let names = names.chain([&index]).map(|&index| self.entries[index].name);
                let circle = names.collect::<Vec<_>>().join(" -> ");
                Found::Without(Some(format!("`{name}` depends on itself: {circle}")))
            }
            State::Open if self.chain.borrow().len() == LONGEST => Found::Without(Some(format!(
                "`{name}` is the end of a chain of more than {LONGEST} parameters"
            ))),
            State::Open => match self.of(index) {
                Some(value) => Found::Term(value.term),
                None => Found::Without(None),
            },
        }
    }

    fn names(&self) -> Vec<String> {
        self.entries.iter().map(|entry| entry.name.to_owned()).collect()
    }

    fn units(&self) -> FileUnits {
        self.units
    }
}
