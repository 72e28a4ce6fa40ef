//! The closed forms, as Python: each number is an array of one number for each pose.
//!
//! Where the closed forms branch, poses take different ways. All of them are gone by all poses: an assignment behind a test
//! keeps what the other poses have, and a function remembers which poses have returned, and what. Where a function has
//! returned something else than zero, what it wrote has no meaning, nor have its own variables: they need not be kept.

mod expressions;

use super::ways::Ways;
use crate::text::commented;
use crate::tree::flow::is_kept;
use crate::tree::{BUILT_IN, Code, Expr, Function, Node, Pass, Statement, Type};
use std::fmt::Write;

/// Words that are no names.
const KEYWORDS: [&str; 8] = ["from", "in", "is", "as", "lambda", "pass", "with", "not"];

/// A function.
pub fn function(code: &Code, function: &Function) -> String {
    let mut function = function.clone();
    crate::tree::visit::rename(&mut function, &|name| {
        (KEYWORDS.contains(&name) || name == "np").then(|| format!("{name}_"))
    });
    let ways = Ways::new(&function);
    let mut printer =
        Printer { code, function: &function, ways, text: String::new(), masks: 0, open: false };
    printer.whole();
    printer.text
}

/// The names of what a function takes.
fn taken(function: &Function) -> Vec<String> {
    let each = function.parameters.iter().filter(|p| p.pass != Pass::Write || is_kept(function, p));
    each.map(|p| p.name.clone()).collect()
}

/// The names of what a function gives back besides its result: lists are changed in place.
fn given(function: &Function) -> Vec<String> {
    let each = function.parameters.iter().filter(|p| p.pass == Pass::Write && !p.kind.is_array());
    each.map(|p| p.name.clone()).collect()
}

/// The poses that go all of several ways.
fn all_of(masks: &[String]) -> String {
    let [one] = masks else {
        let each = masks.iter().map(|mask| match mask.contains(' ') {
            true => format!("({mask})"),
            false => mask.clone(),
        });
        return each.collect::<Vec<_>>().join(" & ");
    };
    one.clone()
}

/// Where statements stand.
#[derive(Clone, Default)]
struct Place {
    depth: usize,
    /// The poses that go this way, by the number of nested ways.
    masks: Vec<String>,
    /// The variables, with the number of ways around their declaration.
    declared: Vec<(String, usize)>,
}

struct Printer<'a> {
    code: &'a Code,
    function: &'a Function,
    ways: Ways,
    text: String,
    masks: usize,
    /// Whether some poses may have returned.
    open: bool,
}

impl Printer<'_> {
    fn whole(&mut self) {
        let function = self.function;
        let name = &function.name;
        let _ = writeln!(self.text, "def _{name}({}):", taken(function).join(", "));
        if !function.comment.is_empty() {
            let comment = commented(&function.comment, "", "    ");
            let _ = writeln!(self.text, "    \"\"\"{}\"\"\"", comment.trim());
        }
        let mut place = Place { depth: 1, ..Place::default() };
        for parameter in &function.parameters {
            place.declared.push((parameter.name.clone(), 0));
            if parameter.pass == Pass::Write && !is_kept(function, parameter) {
                let _ = writeln!(self.text, "    {} = None", parameter.name);
            }
        }
        if self.ways.returns_early {
            self.text += "    result, open_ = None, True\n";
        }
        self.block(&function.body, &mut place);
        let ends = matches!(function.body.last(), Some(Statement::Return(_)));
        if self.ways.returns_early || !ends {
            let result = (function.result != Type::Void).then(|| "result".to_owned());
            self.give_back(result);
        }
    }

    fn give_back(&mut self, result: Option<String>) {
        let all: Vec<String> = result.into_iter().chain(given(self.function)).collect();
        if !all.is_empty() {
            let _ = writeln!(self.text, "    return {}", all.join(", "));
        }
    }

    fn line(&mut self, place: &Place, line: &str) {
        let _ = writeln!(self.text, "{}{line}", "    ".repeat(place.depth));
    }

    fn block(&mut self, body: &[Statement], place: &mut Place) {
        let known = place.declared.len();
        let ways = place.masks.len();
        for statement in body {
            self.statement(statement, place);
        }
        place.declared.truncate(known);
        place.masks.truncate(ways);
    }

    fn statement(&mut self, statement: &Statement, place: &mut Place) {
        match statement {
            Statement::Comment(comment) => {
                self.text += &commented(comment, "# ", &"    ".repeat(place.depth));
            }
            Statement::Declare { name, kind, init } => {
                place.declared.push((name.clone(), place.masks.len()));
                match init {
                    Some(init) => self.assign(place, &Expr::variable(name, kind.clone()), init),
                    None => {
                        let empty = self.empty(kind);
                        self.line(place, &format!("{name} = {empty}"));
                    }
                }
            }
            Statement::Assign { place: to, op: None, value } => self.assign(place, to, value),
            Statement::Assign { place: to, op: Some(op), value } => {
                let whole = Node::Binary(*op, Box::new(to.clone()), Box::new(value.clone()));
                self.assign(place, to, &Expr::new(whole, to.kind.clone()));
            }
            Statement::Call(call) => self.call(place, None, call),
            Statement::If { test, then, otherwise } => self.branch(place, test, then, otherwise),
            Statement::For { name, from, to, test, body, .. } => {
                self.repeat(place, (name, from, to), test.as_ref(), body);
            }
            Statement::Block(body) => self.block(body, place),
            Statement::Return(value) => self.give(place, value.as_ref()),
            // What follows goes the other way: see `branch`.
            Statement::Continue => {}
        }
    }

    /// A value of a type before anything is written to it.
    fn empty(&self, kind: &Type) -> String {
        match kind {
            Type::Array(of, count) => match **of {
                Type::Real => format!("[0.0] * {count}"),
                Type::Int | Type::Bits => format!("[0] * {count}"),
                _ => format!("[None] * {count}"),
            },
            Type::Struct(name) => format!("{}()", crate::text::camel(name)),
            _ => "None".into(),
        }
    }

    /// The poses for which a variable is written here; `None` if its other values do not matter.
    fn mask(&self, place: &Place, variable: &str) -> Option<String> {
        let found = place.declared.iter().rev().find(|(name, _)| name == variable);
        let depth = found.map_or(0, |(_, depth)| *depth);
        let mut masks: Vec<String> = place.masks[depth.min(place.masks.len())..].to_vec();
        // What has no meaning where the function has returned something else than zero: a struct, and what had no value before.
        let outside = self.function.parameters.iter().any(|p| {
            let meant = is_kept(self.function, p) && !matches!(p.kind, Type::Struct(_));
            let written = p.pass == Pass::Write && (meant || self.ways.succeeds_early);
            p.name == variable && written && depth == 0
        });
        if outside && self.open {
            masks.push("open_".into());
        }
        (!masks.is_empty()).then(|| all_of(&masks))
    }

    /// `place = value`
    fn assign(&mut self, place: &Place, to: &Expr, value: &Expr) {
        if let Node::Call(name, arguments) = &value.node
            && arguments.iter().any(|a| a.pass == Pass::Write)
            && !BUILT_IN.contains(&&**name)
        {
            return self.call(place, Some(to), value);
        }
        let value = self.expr(value);
        self.store(place, to, &value);
    }

    /// Writes a value to a place, for the poses that go this way.
    fn store(&mut self, place: &Place, to: &Expr, value: &str) {
        let Some(root) = to.root() else { return };
        let fresh = matches!(self.last_declared(place), Some(name) if name == root)
            && matches!(to.node, Node::Variable(_));
        let kept = match self.mask(place, root) {
            Some(mask) if !fresh => format!("_where({mask}, {value}, {})", self.expr(to)),
            _ => value.to_owned(),
        };
        self.put(place, to, &kept);
    }

    fn last_declared<'p>(&self, place: &'p Place) -> Option<&'p str> {
        let (name, depth) = place.declared.last()?;
        (*depth == place.masks.len()).then_some(&**name)
    }

    fn put(&mut self, place: &Place, to: &Expr, value: &str) {
        match &to.node {
            Node::Member(of, name) => {
                let whole = format!("{}._replace({name}={value})", self.expr(of));
                self.put(place, of, &whole);
            }
            Node::Index(of, index) if !self.ways.is_uniform(index) => {
                let line = format!("_put({}, {}, {value})", self.expr(of), self.expr(index));
                self.line(place, &line);
            }
            _ => {
                let line = format!("{} = {value}", self.expr(to));
                self.line(place, &line);
            }
        }
    }

    /// A call of a function that writes, and the place of its result.
    fn call(&mut self, place: &Place, to: Option<&Expr>, call: &Expr) {
        let Node::Call(name, arguments) = &call.node else { return };
        let Some(known) = self.code.functions.iter().find(|f| f.name == *name) else { return };
        let (mut passed, mut outputs): (Vec<String>, Vec<Expr>) = (Vec::new(), Vec::new());
        let mut lists = Vec::new();
        for (parameter, argument) in known.parameters.iter().zip(arguments) {
            let writes = parameter.pass == Pass::Write;
            if writes && parameter.kind.is_array() {
                lists.push(&argument.value);
            } else if writes {
                outputs.push(argument.value.clone());
            }
            if !writes || is_kept(known, parameter) {
                passed.push(self.expr(&argument.value));
            }
        }
        // Lists are changed in place: what other poses have is kept beside.
        let mut kept = Vec::new();
        for list in lists {
            if let Some(mask) = list.root().and_then(|root| self.mask(place, root)) {
                let list = self.expr(list);
                self.line(place, &format!("kept_{list} = {list}[:]"));
                kept.push((list, mask));
            }
        }
        let results: Vec<Expr> = if known.result == Type::Void {
            outputs
        } else {
            to.cloned().into_iter().chain(outputs).collect()
        };
        let written = format!("_{name}({})", passed.join(", "));
        let direct = |printer: &Self, target: &Expr| {
            matches!(&target.node, Node::Variable(root)
                if printer.mask(place, root).is_none() || printer.last_declared(place) == Some(root))
        };
        if results.is_empty() {
            self.line(place, &written);
        } else {
            let names: Vec<String> = results
                .iter()
                .enumerate()
                .map(|(number, target)| match direct(self, target) {
                    true => self.expr(target),
                    false => format!("new_{}", number + 1),
                })
                .collect();
            let ignored = known.result != Type::Void && to.is_none();
            let first = if ignored { "_, " } else { "" };
            self.line(place, &format!("{first}{} = {written}", names.join(", ")));
            for (target, name) in results.iter().zip(&names) {
                if !direct(self, target) {
                    self.store(place, target, name);
                }
            }
        }
        for (list, mask) in kept {
            self.line(place, &format!("{list}[:] = _where({mask}, {list}, kept_{list})"));
        }
    }

    fn branch(
        &mut self,
        place: &mut Place,
        test: &Expr,
        then: &[Statement],
        otherwise: &[Statement],
    ) {
        let continues = matches!(then.last(), Some(Statement::Continue));
        let test_text = self.expr(test);
        // One statement that returns is told in one line.
        if let ([Statement::Return(value)], true) = (then, otherwise.is_empty()) {
            let mut inner = place.clone();
            inner.masks.push(test_text);
            return self.give(&inner, value.as_ref());
        }
        self.masks += 1;
        let name = match self.masks {
            1 => "way".to_owned(),
            number => format!("way_{number}"),
        };
        self.line(place, &format!("{name} = {test_text}"));
        for (body, mask) in [(then, name.clone()), (otherwise, format!("_not({name})"))] {
            if !body.is_empty() {
                place.masks.push(mask);
                let ways = place.masks.len();
                self.block(body, place);
                place.masks.truncate(ways - 1);
            }
        }
        if continues {
            place.masks.push(format!("_not({name})"));
        }
    }

    fn repeat(
        &mut self,
        place: &mut Place,
        (name, from, to): (&str, &Expr, &Expr),
        test: Option<&Expr>,
        body: &[Statement],
    ) {
        let [from, to] = [from, to].map(|bound| self.expr(bound));
        let range = if from == "0" { to } else { format!("{from}, {to}") };
        let going = format!("going_{name}");
        if test.is_some() {
            self.line(place, &format!("{going} = True"));
        }
        self.line(place, &format!("for {name} in range({range}):"));
        let mut inner = place.clone();
        inner.depth += 1;
        if let Some(test) = test {
            let mut all = vec![going.clone(), self.expr(test)];
            all.extend(inner.masks.iter().cloned());
            if self.ways.returns_early {
                all.push("open_".into());
            }
            self.line(&inner, &format!("{going} = {}", all_of(&all)));
            self.line(&inner, &format!("if not np.any({going}):"));
            self.line(&inner, "    break");
            inner.masks.push(going);
        }
        // What returns in a loop has returned when it comes again.
        let mut returns = false;
        crate::tree::visit::statements(body, &mut |s| returns |= matches!(s, Statement::Return(_)));
        self.open |= returns;
        self.block(body, &mut inner);
    }

    /// `return value`, for the poses that go this way.
    fn give(&mut self, place: &Place, value: Option<&Expr>) {
        let value = value.map(|value| self.expr(value));
        if !self.ways.returns_early {
            return self.give_back(value);
        }
        let mut masks = place.masks.clone();
        if self.open {
            masks.push("open_".into());
        }
        if let Some(value) = value {
            let line = match masks.is_empty() {
                true => format!("result = {value}"),
                false => format!("result = _where({}, {value}, result)", all_of(&masks)),
            };
            self.line(place, &line);
        }
        if !place.masks.is_empty() {
            let gone = format!("_not({})", all_of(&place.masks));
            let line = match self.open {
                true => format!("open_ = open_ & {gone}"),
                false => format!("open_ = {gone}"),
            };
            self.line(place, &line);
        }
        self.open = true;
    }
}
