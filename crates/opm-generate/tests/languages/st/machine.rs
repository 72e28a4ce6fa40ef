//! Executes structured text. Whatever a controller may stop at is an error: a division by zero, a function outside its
//! domain, an index out of its array, a whole number that is too large.

use super::code::{Kind, Node, Passed, Place, Section, Step, Unit, Value, Variable};
use super::parser::parse;

/// The units of a text, and the memory of what was made of them.
pub struct Machine {
    units: Vec<Unit>,
    cells: Vec<f64>,
}

/// A variable of the machine: a function block or a struct.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    unit: usize,
    first: usize,
}

/// How statements end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flow {
    Next,
    Return,
    Exit,
    Continue,
}

impl Machine {
    pub fn new(texts: &[&str]) -> Self {
        Self { units: parse(texts), cells: Vec::new() }
    }

    /// A new variable of the type of this name.
    pub fn instance(&mut self, name: &str) -> Option<Instance> {
        let unit = self.units.iter().position(|u| u.name == name.to_lowercase())?;
        let first = self.cells.len();
        self.cells.extend(&self.units[unit].initial);
        Some(Instance { unit, first })
    }

    fn variable(&self, instance: Instance, name: &str) -> Variable {
        let variables = &self.units[instance.unit].variables;
        let found = variables.iter().find(|v| v.name == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.units[instance.unit].name)).clone()
    }

    /// Gives an input its numbers.
    pub fn set(&mut self, instance: Instance, name: &str, values: &[f64]) {
        let variable = self.variable(instance, name);
        assert_eq!((variable.section, self.size(&variable.kind)), (Section::Input, values.len()));
        let first = instance.first + variable.cell;
        self.cells[first..first + values.len()].copy_from_slice(values);
    }

    /// Lets a reference be another variable.
    pub fn refer(&mut self, instance: Instance, name: &str, to: Instance) {
        let variable = self.variable(instance, name);
        assert_eq!((variable.section, &variable.kind), (Section::InOut, &Kind::Struct(to.unit)));
        self.cells[instance.first + variable.cell] = to.first as f64;
    }

    /// Lets a reference be an array of its own, and gives it numbers.
    pub fn refer_to_array(&mut self, instance: Instance, name: &str, values: &[f64]) {
        let variable = self.variable(instance, name);
        assert_eq!((variable.section, self.size(&variable.kind)), (Section::InOut, values.len()));
        self.cells[instance.first + variable.cell] = self.cells.len() as f64;
        self.cells.extend(values);
    }

    /// The numbers of a variable.
    pub fn get(&self, instance: Instance, name: &str) -> Vec<f64> {
        let variable = self.variable(instance, name);
        let own = instance.first + variable.cell;
        let first = match variable.section {
            Section::InOut => self.cells[own] as usize,
            _ => own,
        };
        self.cells[first..first + self.size(&variable.kind)].to_vec()
    }

    /// Runs a function block.
    pub fn run(&mut self, instance: Instance) {
        let Self { units, cells } = self;
        Running { units, cells }.steps(&units[instance.unit].body, instance.first);
    }

    /// How many cells are in use.
    pub fn mark(&self) -> usize {
        self.cells.len()
    }

    /// Gives back what was made since a mark.
    pub fn release(&mut self, mark: usize) {
        self.cells.truncate(mark);
    }

    fn size(&self, kind: &Kind) -> usize {
        size(&self.units, kind)
    }
}

fn size(units: &[Unit], kind: &Kind) -> usize {
    match kind {
        Kind::Bool | Kind::Dint | Kind::Dword | Kind::Lreal => 1,
        Kind::Array(of, count) => count * size(units, of),
        Kind::Struct(place) | Kind::Block(place) => units[*place].initial.len(),
    }
}

struct Running<'a> {
    units: &'a [Unit],
    cells: &'a mut Vec<f64>,
}

impl Running<'_> {
    /// The first cell of a place, in a unit whose cells begin at `frame`.
    fn address(&mut self, place: &Place, frame: usize) -> usize {
        let own = frame + place.cell;
        let mut first = match place.section {
            Section::InOut => self.cells[own] as usize,
            _ => own,
        };
        first += place.offset;
        for (index, count, cells) in &place.indices {
            let index = self.number(index, frame);
            let inside = index >= 0.0 && index < *count as f64;
            assert!(inside, "line {}: index {index} of {count}", place.line);
            first += index as usize * cells;
        }
        first
    }

    fn steps(&mut self, body: &[Step], frame: usize) -> Flow {
        for step in body {
            let flow = self.step(step, frame);
            if flow != Flow::Next {
                return flow;
            }
        }
        Flow::Next
    }

    fn step(&mut self, step: &Step, frame: usize) -> Flow {
        match step {
            Step::Assign(place, value) => {
                let to = self.address(place, frame);
                self.evaluate(value, frame, to);
            }
            Step::Do(value) => {
                let Node::Call(unit, passed) = &value.node else { unreachable!("a call") };
                let at = self.call(*unit, passed, frame);
                self.cells.truncate(at);
            }
            Step::Run(place, block, passed) => {
                let instance = self.address(place, frame);
                self.pass(passed, frame, instance);
                self.steps(&self.units[*block].body, instance);
            }
            Step::If(ways, otherwise) => {
                for (test, body) in ways {
                    if self.number(test, frame) != 0.0 {
                        return self.steps(body, frame);
                    }
                }
                return self.steps(otherwise, frame);
            }
            Step::For { counter, from, to, body } => {
                let [from, to] = [from, to].map(|end| self.number(end, frame) as i64);
                let cell = self.address(counter, frame);
                for number in from..=to {
                    self.cells[cell] = number as f64;
                    match self.steps(body, frame) {
                        Flow::Exit => break,
                        Flow::Return => return Flow::Return,
                        Flow::Next | Flow::Continue => {}
                    }
                }
            }
            Step::Return => return Flow::Return,
            Step::Exit => return Flow::Exit,
            Step::Continue => return Flow::Continue,
        }
        Flow::Next
    }

    /// Writes the cells of a value.
    fn evaluate(&mut self, value: &Value, frame: usize, to: usize) {
        match &value.node {
            Node::Of(place) => {
                let from = self.address(place, frame);
                let count = size(self.units, &value.kind);
                self.cells.copy_within(from..from + count, to);
            }
            Node::Call(unit, passed) => {
                let at = self.call(*unit, passed, frame);
                let count = size(self.units, &value.kind);
                self.cells.copy_within(at..at + count, to);
                self.cells.truncate(at);
            }
            _ => self.cells[to] = self.number(value, frame),
        }
    }

    fn pass(&mut self, passed: &[(Variable, Passed)], frame: usize, to: usize) {
        for (parameter, passed) in passed {
            let cell = to + parameter.cell;
            match passed {
                Passed::Value(value) => self.evaluate(value, frame, cell),
                Passed::Place(place) => self.cells[cell] = self.address(place, frame) as f64,
            }
        }
    }

    /// Calls a function. Its result is left behind all other cells, from where it is to be taken.
    fn call(&mut self, unit: usize, passed: &[(Variable, Passed)], frame: usize) -> usize {
        let units = self.units;
        let at = self.cells.len();
        self.cells.extend(&units[unit].initial);
        self.pass(passed, frame, at);
        self.steps(&units[unit].body, at);
        // Its result is the first of its cells; the others are given back.
        let result = units[unit].result.as_ref().map_or(0, |kind| size(units, kind));
        self.cells.truncate(at + result);
        at
    }

    fn number(&mut self, value: &Value, frame: usize) -> f64 {
        let found = match &value.node {
            Node::Number(number) => *number,
            Node::Of(place) => {
                let at = self.address(place, frame);
                self.cells[at]
            }
            Node::Negative(of) => -self.number(of, frame),
            Node::Not(of) => 1.0 - self.number(of, frame),
            // Both sides are always evaluated.
            Node::Binary(operator, a, b) => {
                let numbers = [self.number(a, frame), self.number(b, frame)];
                binary(operator, numbers, &a.kind, value.line)
            }
            Node::Standard(name, given) => {
                let given: Vec<f64> = given.iter().map(|value| self.number(value, frame)).collect();
                standard(name, &given, value.line)
            }
            Node::Call(unit, passed) => {
                self.call(*unit, passed, frame);
                // A number is one cell.
                self.cells.pop().expect("a result")
            }
        };
        let whole = value.kind != Kind::Dint || found.abs() <= f64::from(i32::MAX);
        assert!(whole, "line {}: {found} is no DINT", value.line);
        found
    }
}

fn binary(operator: &str, [a, b]: [f64; 2], kind: &Kind, line: usize) -> f64 {
    let truth = |truth: bool| f64::from(u8::from(truth));
    match operator {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" => {
            assert!(b != 0.0, "line {line}: {a} is divided by zero");
            a / b
        }
        "=" => truth(a == b),
        "<>" => truth(a != b),
        "<" => truth(a < b),
        "<=" => truth(a <= b),
        ">" => truth(a > b),
        ">=" => truth(a >= b),
        "and" if *kind == Kind::Dword => f64::from(a as u32 & b as u32),
        "or" if *kind == Kind::Dword => f64::from(a as u32 | b as u32),
        "and" => a * b,
        "or" => a.max(b),
        other => unreachable!("{other}"),
    }
}

fn standard(name: &str, given: &[f64], line: usize) -> f64 {
    let x = given[0];
    let domain = |inside: bool| assert!(inside || x.is_nan(), "line {line}: {name}({x})");
    match name {
        "abs" => x.abs(),
        "sqrt" => {
            domain(x >= 0.0);
            x.sqrt()
        }
        "sin" => x.sin(),
        "cos" => x.cos(),
        "asin" | "acos" => {
            domain(x.abs() <= 1.0);
            if name == "asin" { x.asin() } else { x.acos() }
        }
        "atan" => x.atan(),
        "max" => {
            if x > given[1] {
                x
            } else {
                given[1]
            }
        }
        "min" => {
            if x < given[1] {
                x
            } else {
                given[1]
            }
        }
        "shl" => f64::from((x as u32) << given[1] as u32),
        "shr" => f64::from(x as u32 >> given[1] as u32),
        "lreal_to_dint" => {
            domain(x.abs() <= f64::from(i32::MAX));
            x.round_ties_even()
        }
        "dword_to_dint" => {
            domain(x <= f64::from(i32::MAX));
            x
        }
        "dint_to_dword" => {
            domain(x >= 0.0);
            x
        }
        "bool_to_dint" | "dint_to_lreal" => x,
        other => unreachable!("{other}"),
    }
}
