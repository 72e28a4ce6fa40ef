//! Reads structured text strictly: names are declared before they are used, nothing is converted without a word, what is given
//! is not changed, and only variables that may change are passed to be changed.

use super::code::{Kind, Node, Passed, Place, Section, Step, Unit, Value, Variable};
use super::words::{Word, words};
use std::collections::HashMap;

/// Words that are no names of variables.
const RESERVED: [&str; 50] = [
    "and",
    "or",
    "xor",
    "not",
    "mod",
    "if",
    "then",
    "elsif",
    "else",
    "end_if",
    "for",
    "to",
    "by",
    "do",
    "end_for",
    "while",
    "end_while",
    "repeat",
    "until",
    "end_repeat",
    "case",
    "of",
    "end_case",
    "return",
    "exit",
    "continue",
    "type",
    "struct",
    "end_struct",
    "end_type",
    "array",
    "var",
    "var_input",
    "var_output",
    "var_in_out",
    "end_var",
    "constant",
    "function",
    "end_function",
    "function_block",
    "end_function_block",
    "program",
    "true",
    "false",
    "at",
    "step",
    "action",
    "transition",
    "on",
    "with",
];

/// Functions of the standard: how many arguments they take, of which types, and what they give.
const STANDARD: [(&str, usize, &str, &str); 17] = [
    ("abs", 1, "lreal", "lreal"),
    ("sqrt", 1, "lreal", "lreal"),
    ("sin", 1, "lreal", "lreal"),
    ("cos", 1, "lreal", "lreal"),
    ("asin", 1, "lreal", "lreal"),
    ("acos", 1, "lreal", "lreal"),
    ("atan", 1, "lreal", "lreal"),
    ("max", 2, "lreal", "lreal"),
    ("min", 2, "lreal", "lreal"),
    ("shl", 2, "dword", "dword"),
    ("shr", 2, "dword", "dword"),
    ("bool_to_dint", 1, "bool", "dint"),
    ("dint_to_lreal", 1, "dint", "lreal"),
    ("lreal_to_dint", 1, "lreal", "dint"),
    ("dint_to_dword", 1, "dint", "dword"),
    ("dword_to_dint", 1, "dword", "dint"),
    ("trunc", 1, "lreal", "dint"),
];

/// The units of texts, in the order of their declaration.
pub fn parse(texts: &[&str]) -> Vec<Unit> {
    let mut parser = Parser {
        words: Vec::new(),
        at: 0,
        units: Vec::new(),
        names: HashMap::new(),
        counters: Vec::new(),
    };
    for text in texts {
        parser.words = words(text);
        parser.at = 0;
        parser.text();
    }
    parser.units
}

/// What a global name is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Global {
    Struct,
    Function,
    Block,
}

struct Parser {
    words: Vec<(Word, usize)>,
    at: usize,
    units: Vec<Unit>,
    names: HashMap<String, (Global, usize)>,
    /// The counters of the loops around.
    counters: Vec<usize>,
}

impl Parser {
    fn line(&self) -> usize {
        self.words[self.at].1
    }

    #[track_caller]
    fn wrong(&self, what: &str) -> ! {
        let before: Vec<_> =
            self.words[self.at.saturating_sub(8)..=self.at].iter().map(|w| &w.0).collect();
        panic!("line {}: {what}; behind {before:?}", self.line())
    }

    fn peek(&self) -> &Word {
        &self.words[self.at].0
    }

    fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Word::Sign(next) if *next == sign);
        self.at += usize::from(found);
        found
    }

    #[track_caller]
    fn expect(&mut self, sign: &str) {
        if !self.take(sign) {
            self.wrong(&format!("expected '{sign}'"));
        }
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Word::Name(next) if next == word)
    }

    fn word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        self.at += usize::from(found);
        found
    }

    #[track_caller]
    fn expect_word(&mut self, word: &str) {
        if !self.word(word) {
            self.wrong(&format!("expected {word}"));
        }
    }

    fn name(&mut self) -> String {
        let Word::Name(name) = self.peek().clone() else { self.wrong("expected a name") };
        if RESERVED.contains(&&*name) || STANDARD.iter().any(|(known, ..)| *known == name) {
            self.wrong("a reserved word as a name");
        }
        self.at += 1;
        name
    }

    fn declare(&mut self, name: &str, what: Global) -> usize {
        let place = self.units.len();
        if self.names.insert(name.to_owned(), (what, place)).is_some() {
            self.wrong("a name is declared twice");
        }
        place
    }

    fn text(&mut self) {
        while *self.peek() != Word::End {
            if self.word("type") {
                self.structure();
            } else if self.word("function") {
                self.unit(Global::Function, "end_function");
            } else if self.word("function_block") {
                self.unit(Global::Block, "end_function_block");
            } else {
                self.wrong("expected a declaration");
            }
        }
    }

    fn structure(&mut self) {
        let name = self.name();
        self.expect(":");
        self.expect_word("struct");
        let mut unit = Unit { name: name.clone(), ..Unit::default() };
        while !self.word("end_struct") {
            self.variable(&mut unit, Section::Local);
        }
        self.take(";");
        self.expect_word("end_type");
        self.declare(&name, Global::Struct);
        self.units.push(unit);
    }

    /// A declaration: its cells follow those that are there.
    fn variable(&mut self, unit: &mut Unit, section: Section) {
        let name = self.name();
        if name == unit.name || unit.variables.iter().any(|v| v.name == name) {
            self.wrong("a name is declared twice");
        }
        if self.names.contains_key(&name) {
            self.wrong("the name of a type or of a function");
        }
        self.expect(":");
        let kind = self.kind();
        let cell = unit.initial.len();
        let initial = match (section, self.take(":=")) {
            (Section::InOut, given) => {
                if given {
                    self.wrong("a reference has no value");
                }
                vec![f64::NAN]
            }
            (_, true) => self.initial(&kind),
            (Section::Constant, false) => self.wrong("a constant has a value"),
            (_, false) => self.new_cells(&kind),
        };
        self.expect(";");
        unit.initial.extend(initial);
        unit.variables.push(Variable { name, kind, section, cell });
    }

    fn kind(&mut self) -> Kind {
        if self.word("array") {
            self.expect("[");
            let (Word::Whole(0), _) = self.words[self.at] else { self.wrong("expected 0") };
            self.at += 1;
            self.expect("..");
            let Word::Whole(last) = *self.peek() else { self.wrong("expected the last index") };
            self.at += 1;
            self.expect("]");
            self.expect_word("of");
            let of = self.kind();
            return Kind::Array(Box::new(of), usize::try_from(last).expect("a count") + 1);
        }
        let Word::Name(name) = self.peek().clone() else { self.wrong("expected a type") };
        self.at += 1;
        if let Some(kind) = elementary(&name) {
            return kind;
        }
        match self.names.get(&name) {
            Some((Global::Struct, place)) => Kind::Struct(*place),
            Some((Global::Block, place)) => Kind::Block(*place),
            _ => self.wrong("expected a type that is declared"),
        }
    }

    fn cells(&self, kind: &Kind) -> usize {
        match kind {
            Kind::Bool | Kind::Dint | Kind::Dword | Kind::Lreal => 1,
            Kind::Array(of, count) => count * self.cells(of),
            Kind::Struct(place) | Kind::Block(place) => self.units[*place].initial.len(),
        }
    }

    fn new_cells(&self, kind: &Kind) -> Vec<f64> {
        match kind {
            Kind::Bool | Kind::Dint | Kind::Dword | Kind::Lreal => vec![0.0],
            Kind::Array(of, count) => self.new_cells(of).repeat(*count),
            Kind::Struct(place) | Kind::Block(place) => self.units[*place].initial.clone(),
        }
    }

    /// A value that a variable begins with.
    fn initial(&mut self, kind: &Kind) -> Vec<f64> {
        match kind {
            Kind::Array(of, count) => {
                self.expect("[");
                let mut all = Vec::new();
                for number in 0..*count {
                    if number > 0 {
                        self.expect(",");
                    }
                    all.extend(self.initial(of));
                }
                self.expect("]");
                all
            }
            Kind::Struct(place) => {
                self.expect("(");
                let members = self.units[*place].variables.clone();
                let mut all = self.new_cells(kind);
                loop {
                    let name = self.name();
                    let Some(member) = members.iter().find(|m| m.name == name) else {
                        self.wrong("there is no such member")
                    };
                    self.expect(":=");
                    let given = self.initial(&member.kind);
                    all[member.cell..member.cell + given.len()].copy_from_slice(&given);
                    if !self.take(",") {
                        break;
                    }
                }
                self.expect(")");
                all
            }
            Kind::Block(_) => self.wrong("a function block has no value"),
            simple => {
                let sign = if self.take("-") { -1.0 } else { 1.0 };
                let value = self.primary(&Unit::default());
                match value.node {
                    Node::Number(number) if value.kind == *simple => vec![sign * number],
                    _ => self.wrong("expected a number of this type"),
                }
            }
        }
    }

    fn unit(&mut self, what: Global, end: &str) {
        let name = self.name();
        let mut unit = Unit { name: name.clone(), ..Unit::default() };
        if what == Global::Function {
            self.expect(":");
            let kind = self.kind();
            unit.initial = self.new_cells(&kind);
            unit.result = Some(kind);
        }
        while let Word::Name(word) = self.peek() {
            let section = match &**word {
                "var_input" => Section::Input,
                "var_output" if what == Global::Block => Section::Output,
                "var_in_out" => Section::InOut,
                "var" => Section::Local,
                _ => break,
            };
            self.at += 1;
            let constant = section == Section::Local && self.word("constant");
            let section = if constant { Section::Constant } else { section };
            while !self.word("end_var") {
                self.variable(&mut unit, section);
            }
        }
        unit.body = self.steps(&unit, &[end]);
        self.at += 1;
        self.declare(&name, what);
        self.units.push(unit);
    }

    /// Statements up to one of these words.
    fn steps(&mut self, unit: &Unit, ends: &[&str]) -> Vec<Step> {
        let mut all = Vec::new();
        let before = self.at;
        while !ends.iter().any(|end| self.is_word(end)) {
            if self.take(";") {
                continue;
            }
            let step = self.step(unit);
            all.push(step);
        }
        if self.at == before {
            self.wrong("expected a statement");
        }
        all
    }

    fn test(&mut self, unit: &Unit) -> Value {
        let value = self.value(unit);
        if value.kind != Kind::Bool {
            self.wrong("expected a condition");
        }
        value
    }

    fn step(&mut self, unit: &Unit) -> Step {
        if self.word("if") {
            let mut ways = Vec::new();
            let mut otherwise = Vec::new();
            loop {
                let test = self.test(unit);
                self.expect_word("then");
                ways.push((test, self.steps(unit, &["elsif", "else", "end_if"])));
                if self.word("elsif") {
                    continue;
                }
                if self.word("else") {
                    otherwise = self.steps(unit, &["end_if"]);
                }
                self.expect_word("end_if");
                self.expect(";");
                return Step::If(ways, otherwise);
            }
        }
        if self.word("for") {
            return self.counting(unit);
        }
        for (word, step) in
            [("return", Step::Return), ("exit", Step::Exit), ("continue", Step::Continue)]
        {
            if self.word(word) {
                if word != "return" && self.counters.is_empty() {
                    self.wrong("no loop is around");
                }
                self.expect(";");
                return step;
            }
        }
        let step = self.assignment_or_call(unit);
        self.expect(";");
        step
    }

    fn counting(&mut self, unit: &Unit) -> Step {
        let counter = self.place(unit);
        if counter.kind != Kind::Dint || counter.section != Section::Local {
            self.wrong("a counter is a variable of whole numbers");
        }
        self.expect(":=");
        let from = self.value(unit);
        self.expect_word("to");
        let to = self.value(unit);
        self.expect_word("do");
        if from.kind != Kind::Dint || to.kind != Kind::Dint || self.counters.contains(&counter.cell)
        {
            self.wrong("a loop counts whole numbers, with a counter of its own");
        }
        self.counters.push(counter.cell);
        let body = self.steps(unit, &["end_for"]);
        self.counters.pop();
        self.at += 1;
        self.expect(";");
        Step::For { counter, from, to, body }
    }

    fn assignment_or_call(&mut self, unit: &Unit) -> Step {
        let Word::Name(name) = self.peek().clone() else { self.wrong("expected a statement") };
        if name == unit.name {
            // The result of a function.
            let Some(kind) = unit.result.clone() else { self.wrong("there is no result") };
            let line = self.line();
            self.at += 1;
            self.expect(":=");
            let value = self.value(unit);
            if value.kind != kind {
                self.wrong("a result of another type");
            }
            let place = Place {
                kind,
                section: Section::Local,
                cell: 0,
                offset: 0,
                indices: Vec::new(),
                line,
            };
            return Step::Assign(place, value);
        }
        if let Some((Global::Function, place)) = self.names.get(&name).copied() {
            if self.units[place].result.is_some() {
                self.wrong("the result of a function is not used");
            }
            return Step::Do(self.value(unit));
        }
        let place = self.place(unit);
        if let Kind::Block(block) = place.kind {
            let passed = self.arguments(unit, block);
            return Step::Run(place, block, passed);
        }
        self.expect(":=");
        self.may_change(&place);
        let value = self.value(unit);
        if value.kind != place.kind {
            self.wrong(&format!("{:?} is assigned to {:?}", value.kind, place.kind));
        }
        Step::Assign(place, value)
    }

    fn may_change(&self, place: &Place) {
        if matches!(place.section, Section::Input | Section::Constant) {
            self.wrong("what is given, and a constant, cannot be changed");
        }
        if place.section == Section::Local && self.counters.contains(&place.cell) {
            self.wrong("a counter cannot be changed");
        }
    }

    fn place(&mut self, unit: &Unit) -> Place {
        let line = self.line();
        let name = self.name();
        let Some(variable) = unit.variables.iter().find(|v| v.name == name).cloned() else {
            self.at -= 1;
            self.wrong("there is no such variable")
        };
        let Variable { kind, section, cell, .. } = variable;
        let mut place = Place { kind, section, cell, offset: 0, indices: Vec::new(), line };
        loop {
            if self.take(".") {
                let (Kind::Struct(of) | Kind::Block(of)) = place.kind else {
                    self.wrong("no struct")
                };
                let name = self.name();
                let Some(member) =
                    self.units[of].variables.iter().find(|m| m.name == name).cloned()
                else {
                    self.wrong("there is no such member")
                };
                if matches!(place.kind, Kind::Block(_)) {
                    if member.section != Section::Output {
                        self.wrong("no output of the function block");
                    }
                    place.section = Section::Constant;
                }
                place.kind = member.kind;
                place.offset += member.cell;
            } else if self.take("[") {
                let Kind::Array(of, count) = place.kind.clone() else { self.wrong("no array") };
                let index = self.value(unit);
                if index.kind != Kind::Dint {
                    self.wrong("an index is a whole number");
                }
                self.expect("]");
                place.indices.push((index, count, self.cells(&of)));
                place.kind = *of;
            } else {
                return place;
            }
        }
    }

    /// The arguments of a function or of a function block, in its parameters' order where they have no names.
    fn arguments(&mut self, unit: &Unit, of: usize) -> Vec<(Variable, Passed)> {
        self.expect("(");
        let parameters: Vec<Variable> = (self.units[of].variables.iter())
            .filter(|v| matches!(v.section, Section::Input | Section::InOut))
            .cloned()
            .collect();
        let mut all: Vec<(Variable, Passed)> = Vec::new();
        let named = matches!(self.words.get(self.at + 1), Some((Word::Sign(":="), _)));
        while !self.take(")") {
            if !all.is_empty() {
                self.expect(",");
            }
            let parameter = if named {
                let name = match self.peek().clone() {
                    Word::Name(name) => name,
                    _ => self.wrong("expected the name of a parameter"),
                };
                self.at += 1;
                self.expect(":=");
                parameters.iter().find(|p| p.name == name)
            } else {
                parameters.get(all.len())
            };
            let Some(parameter) = parameter.cloned() else { self.wrong("no such parameter") };
            if all.iter().any(|(p, _)| p.name == parameter.name) {
                self.wrong("a parameter is given twice");
            }
            let (passed, kind) = if parameter.section == Section::InOut {
                let place = self.place(unit);
                self.may_change(&place);
                let kind = place.kind.clone();
                (Passed::Place(place), kind)
            } else {
                let value = self.value(unit);
                let kind = value.kind.clone();
                (Passed::Value(value), kind)
            };
            if kind != parameter.kind {
                self.wrong(&format!(
                    "{kind:?} is given for {}, {:?}",
                    parameter.name, parameter.kind
                ));
            }
            all.push((parameter, passed));
        }
        if all.len() != parameters.len() {
            self.wrong("not all parameters are given");
        }
        all
    }

    fn value(&mut self, unit: &Unit) -> Value {
        self.binary(unit, 0)
    }

    /// Operators that bind at least as closely as those of a level.
    fn binary(&mut self, unit: &Unit, level: usize) -> Value {
        const LEVELS: [&[&str]; 6] =
            [&["or"], &["and"], &["=", "<>"], &["<", "<=", ">", ">="], &["+", "-"], &["*", "/"]];
        let Some(operators) = LEVELS.get(level) else { return self.unary(unit) };
        let mut left = self.binary(unit, level + 1);
        loop {
            let next = match self.peek() {
                Word::Sign(sign) => *sign,
                Word::Name(word) if word == "or" => "or",
                Word::Name(word) if word == "and" => "and",
                _ => return left,
            };
            let Some(operator) = operators.iter().find(|known| **known == next) else {
                return left;
            };
            let line = self.line();
            self.at += 1;
            let right = self.binary(unit, level + 1);
            let of = left.kind.clone();
            let allowed = match level {
                0 | 1 => matches!(of, Kind::Bool | Kind::Dword),
                2 => !matches!(of, Kind::Array(..) | Kind::Struct(_) | Kind::Block(_)),
                5 if *operator == "/" => of == Kind::Lreal,
                _ => matches!(of, Kind::Lreal | Kind::Dint),
            };
            if right.kind != of || !allowed {
                self.wrong(&format!("{of:?} {operator} {:?}", right.kind));
            }
            let kind = if level == 2 || level == 3 { Kind::Bool } else { of };
            let node = Node::Binary(operator, Box::new(left), Box::new(right));
            left = Value { kind, node, line };
        }
    }

    fn unary(&mut self, unit: &Unit) -> Value {
        let line = self.line();
        if self.take("-") {
            let of = self.primary(unit);
            if !matches!(of.kind, Kind::Lreal | Kind::Dint) {
                self.wrong("a sign of what is no number");
            }
            return Value { kind: of.kind.clone(), node: Node::Negative(Box::new(of)), line };
        }
        if self.word("not") {
            let of = self.primary(unit);
            if of.kind != Kind::Bool {
                self.wrong("NOT of what is no condition");
            }
            return Value { kind: Kind::Bool, node: Node::Not(Box::new(of)), line };
        }
        self.primary(unit)
    }

    fn primary(&mut self, unit: &Unit) -> Value {
        let line = self.line();
        let number = |kind, number| Value { kind, node: Node::Number(number), line };
        match self.peek().clone() {
            Word::Real(value) => {
                self.at += 1;
                number(Kind::Lreal, value)
            }
            Word::Whole(value) => {
                self.at += 1;
                let value = i32::try_from(value).unwrap_or_else(|_| self.wrong("no DINT"));
                number(Kind::Dint, f64::from(value))
            }
            Word::Bits(bits) => {
                self.at += 1;
                number(Kind::Dword, f64::from(bits))
            }
            Word::Sign("(") => {
                self.at += 1;
                let inside = self.value(unit);
                self.expect(")");
                inside
            }
            Word::Name(word) if word == "true" || word == "false" => {
                self.at += 1;
                number(Kind::Bool, f64::from(u8::from(word == "true")))
            }
            Word::Name(name) => {
                if let Some(known) = STANDARD.iter().find(|(known, ..)| *known == name) {
                    self.at += 1;
                    return self.standard(unit, *known, line);
                }
                if let Some((Global::Function, place)) = self.names.get(&name).copied() {
                    self.at += 1;
                    let passed = self.arguments(unit, place);
                    // What gives nothing is a statement, which has a type that nothing else has.
                    let kind = self.units[place].result.clone();
                    let kind = kind.unwrap_or(Kind::Block(usize::MAX));
                    return Value { kind, node: Node::Call(place, passed), line };
                }
                let place = self.place(unit);
                Value { kind: place.kind.clone(), node: Node::Of(Box::new(place)), line }
            }
            _ => self.wrong("expected a value"),
        }
    }

    fn standard(
        &mut self,
        unit: &Unit,
        (name, count, takes, gives): (&str, usize, &str, &str),
        line: usize,
    ) -> Value {
        self.expect("(");
        let mut given = Vec::new();
        while !self.take(")") {
            if !given.is_empty() {
                self.expect(",");
            }
            given.push(self.value(unit));
        }
        // How far bits are shifted is a whole number.
        let right = given.iter().enumerate().all(|(i, value)| {
            let shift = i == 1 && (name == "shl" || name == "shr");
            Some(&value.kind) == elementary(if shift { "dint" } else { takes }).as_ref()
        });
        if given.len() != count || !right {
            self.wrong(&format!("wrong arguments of {name}"));
        }
        let kind = elementary(gives).expect("a type");
        Value { kind, node: Node::Standard(name.to_owned(), given), line }
    }
}

fn elementary(name: &str) -> Option<Kind> {
    Some(match name {
        "bool" => Kind::Bool,
        "dint" => Kind::Dint,
        "dword" => Kind::Dword,
        "lreal" => Kind::Lreal,
        _ => return None,
    })
}
