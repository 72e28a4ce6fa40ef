//! The closed forms, as MATLAB, which Octave understands, too.

use crate::text::commented;
use crate::tree::flow::{is_kept, needs_value};
use crate::tree::{
    BUILT_IN, Code, Expr, Function, Node, Op, Parameter, Pass, Statement, Type, Value, visit,
};
use std::fmt::Write;

/// Words that are no names.
const KEYWORDS: [&str; 8] = ["end", "case", "global", "function", "parfor", "other", "pi", "g_"];

/// How closely operators bind.
fn strength(op: Op) -> u8 {
    match op {
        Op::Or => 1,
        Op::And => 2,
        op if op.is_comparison() => 3,
        Op::Add | Op::Subtract => 4,
        _ => 5,
    }
}
const PREFIX: u8 = 6;
const WHOLE: u8 = 7;

/// Whether an argument is given back alone: it has no value before, or a function of the interface writes it.
fn is_output(function: &Function, p: &Parameter) -> bool {
    p.pass == Pass::Write
        && match p.kind.is_array() {
            true => function.public && p.name != "pose",
            false => function.public || !is_kept(function, p),
        }
}

/// A number of every type.
pub fn zero(code: &Code, kind: &Type) -> String {
    match kind {
        Type::Struct(name) => {
            let members = code.members(name).iter();
            let parts = members.map(|m| format!("'{}', {}", m.name, zero(code, &m.kind)));
            format!("struct({})", parts.collect::<Vec<_>>().join(", "))
        }
        Type::Array(of, count) => match **of {
            Type::Struct(_) => format!("repmat({}, 1, {count})", zero(code, of)),
            _ => format!("zeros(1, {count})"),
        },
        Type::Bool => "false".into(),
        _ => "0".into(),
    }
}

/// A constant of a type.
pub fn value(code: &Code, of: &Type, value_of: &Value, depth: usize) -> String {
    match (of, value_of) {
        (_, Value::Number(number)) if number.is_infinite() => {
            if *number > 0.0 {
                "Inf".into()
            } else {
                "-Inf".into()
            }
        }
        (_, Value::Number(number)) => format!("{:?}", number + 0.0),
        (Type::Array(of, _), Value::List(parts)) => {
            let parts: Vec<String> =
                parts.iter().map(|part| value(code, of, part, depth + 1)).collect();
            match **of {
                Type::Struct(_) => format!("[ ...\n        {}]", parts.join(", ...\n        ")),
                _ => format!("[{}]", parts.join(", ")),
            }
        }
        (Type::Struct(name), Value::List(parts)) => {
            let members = code.members(name);
            let parts = members.iter().zip(parts);
            let parts = parts.map(|(m, part)| (m, value(code, &m.kind, part, depth + 1)));
            if depth == 0 {
                let lines = parts.map(|(m, value)| {
                    format!("{}    g.{} = {value};\n", commented(&m.comment, "% ", "    "), m.name)
                });
                return lines.collect();
            }
            let each = parts.map(|(m, value)| format!("'{}', {value}", m.name));
            format!("struct({})", each.collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    }
}

/// A function, with the comment where its help is.
pub fn function(code: &Code, function: &Function) -> String {
    let mut function = function.clone();
    let taken = |name: &str| {
        KEYWORDS.contains(&name)
            || BUILT_IN.contains(&name)
            || code.functions.iter().any(|other| other.name == name)
    };
    visit::rename(&mut function, &|name| taken(name).then(|| format!("{name}_")));
    let printer = Printer { code, function: &function };
    printer.whole()
}

struct Printer<'a> {
    code: &'a Code,
    function: &'a Function,
}

impl Printer<'_> {
    fn whole(&self) -> String {
        let function = self.function;
        let result = (function.result != Type::Void).then(|| "result".to_owned());
        let written = function.parameters.iter().filter(|p| p.pass == Pass::Write);
        let outputs: Vec<String> =
            result.into_iter().chain(written.clone().map(|p| p.name.clone())).collect();
        let inputs = function.parameters.iter().filter(|p| !is_output(function, p));
        let inputs: Vec<&str> = inputs.map(|p| &*p.name).collect();
        let mut text = String::new();
        let head = match &outputs[..] {
            [one] => format!("{one} = "),
            all => format!("[{}] = ", all.join(", ")),
        };
        let _ = writeln!(text, "function {head}{}({})", function.name, inputs.join(", "));
        text += &commented(&function.comment, "% ", "    ");
        for p in written.filter(|p| is_output(function, p)) {
            let _ = writeln!(text, "    {} = {};", p.name, self.start(p));
        }
        self.block(&function.body, 1, &mut text);
        text + "end\n"
    }

    /// What a function gives back before it writes it.
    fn start(&self, p: &Parameter) -> String {
        let count = |name: &str| self.code.number(name).unwrap_or_default();
        match (&p.kind, &*p.name) {
            (Type::Array(_, 0), name) => {
                let count = match name {
                    "joints" | "joint_rates" => count("JOINTS"),
                    "imaginary" => count("IMAGINARY"),
                    _ => count("ACTUATED"),
                };
                format!("nan(1, {count})")
            }
            (Type::Array(_, count), "deficits") => format!("zeros(1, {count})"),
            (Type::Array(_, count), _) => format!("nan(1, {count})"),
            (kind, _) => zero(self.code, kind),
        }
    }

    fn block(&self, body: &[Statement], depth: usize, text: &mut String) {
        for (number, statement) in body.iter().enumerate() {
            self.statement(statement, &body[number + 1..], depth, text);
        }
    }

    fn statement(&self, one: &Statement, rest: &[Statement], depth: usize, text: &mut String) {
        let space = "    ".repeat(depth);
        let _ = match one {
            Statement::Comment(comment) => {
                *text += &commented(comment, "% ", &space);
                Ok(())
            }
            Statement::Declare { name, kind, init: None } => {
                if needs_value(rest, name) || kind.is_array() {
                    let _ = writeln!(text, "{space}{name} = {};", zero(self.code, kind));
                }
                Ok(())
            }
            Statement::Declare { name, kind, init: Some(init) } => {
                self.assign(&Expr::variable(name, kind.clone()), init, &space, text)
            }
            Statement::Assign { place, op: None, value } => self.assign(place, value, &space, text),
            Statement::Assign { place, op: Some(op), value } => {
                let whole = Node::Binary(*op, Box::new(place.clone()), Box::new(value.clone()));
                self.assign(place, &Expr::new(whole, place.kind.clone()), &space, text)
            }
            Statement::Call(call) => writeln!(text, "{space}{};", self.call(None, call)),
            Statement::If { test, then, otherwise } => {
                let _ = writeln!(text, "{space}if {}", self.expr(test));
                self.block(then, depth + 1, text);
                if !otherwise.is_empty() {
                    let _ = writeln!(text, "{space}else");
                    self.block(otherwise, depth + 1, text);
                }
                writeln!(text, "{space}end")
            }
            Statement::For { name, from, to, test, body } => {
                let last = match &to.node {
                    Node::Number(number) => number
                        .parse::<i64>()
                        .map_or_else(|_| number.clone(), |n| (n - 1).to_string()),
                    _ => format!("({} - 1)", self.inside(to, strength(Op::Subtract))),
                };
                let _ = writeln!(text, "{space}for {name} = {}:{last}", self.expr(from));
                if let Some(test) = test {
                    let _ = writeln!(
                        text,
                        "{space}    if ~({})\n{space}        break;\n{space}    end",
                        self.expr(test)
                    );
                }
                self.block(body, depth + 1, text);
                writeln!(text, "{space}end")
            }
            Statement::Block(body) => {
                self.block(body, depth, text);
                Ok(())
            }
            Statement::Return(value) => {
                if let Some(value) = value {
                    let result = Expr::variable("result", value.kind.clone());
                    let _ = self.assign(&result, value, &space, text);
                }
                let ends = depth == 1 && rest.is_empty();
                if ends { Ok(()) } else { writeln!(text, "{space}return;") }
            }
            Statement::Continue => writeln!(text, "{space}continue;"),
        };
    }

    fn assign(
        &self,
        place: &Expr,
        value: &Expr,
        space: &str,
        text: &mut String,
    ) -> std::fmt::Result {
        match &value.node {
            Node::Call(name, arguments)
                if !BUILT_IN.contains(&&**name)
                    && arguments.iter().any(|a| a.pass == Pass::Write) =>
            {
                writeln!(text, "{space}{};", self.call(Some(place), value))
            }
            _ => writeln!(text, "{space}{} = {};", self.expr(place), self.expr(value)),
        }
    }

    /// A call of a function that writes: what it gives back stands on the left.
    fn call(&self, place: Option<&Expr>, call: &Expr) -> String {
        let Node::Call(name, arguments) = &call.node else { return String::new() };
        let Some(known) = self.code.functions.iter().find(|f| f.name == *name) else {
            return String::new();
        };
        let (mut passed, mut outputs) = (Vec::new(), Vec::new());
        if known.result != Type::Void {
            outputs.push(place.map_or("~".to_owned(), |place| self.expr(place)));
        }
        for (parameter, argument) in known.parameters.iter().zip(arguments) {
            let value = self.expr(&argument.value);
            if parameter.pass == Pass::Write {
                outputs.push(value.clone());
            }
            if !is_output(known, parameter) {
                passed.push(value);
            }
        }
        let left = match &outputs[..] {
            [] => String::new(),
            [one] => format!("{one} = "),
            all => format!("[{}] = ", all.join(", ")),
        };
        format!("{left}{name}({})", passed.join(", "))
    }

    fn expr(&self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    fn inside(&self, expr: &Expr, strength: u8) -> String {
        let (text, own) = self.bound(expr);
        if own < strength { format!("({text})") } else { text }
    }

    fn bound(&self, expr: &Expr) -> (String, u8) {
        match &expr.node {
            Node::Number(number) => (number.clone(), WHOLE),
            Node::Constant(name) => match &**name {
                "PI" => ("pi".into(), WHOLE),
                "TAU" => ("2 * pi".into(), strength(Op::Multiply)),
                name => (format!("{name}()"), WHOLE),
            },
            Node::Infinity => ("Inf".into(), WHOLE),
            Node::Variable(name) => (name.clone(), WHOLE),
            Node::Member(of, name) => (format!("{}.{name}", self.inside(of, WHOLE)), WHOLE),
            Node::Index(of, index) => {
                let index = match &index.node {
                    Node::Number(number) => number
                        .parse::<u64>()
                        .map_or_else(|_| number.clone(), |n| (n + 1).to_string()),
                    _ => format!("{} + 1", self.inside(index, strength(Op::Add))),
                };
                (format!("{}({index})", self.inside(of, WHOLE)), WHOLE)
            }
            Node::Negative(of) => (format!("-{}", self.inside(of, PREFIX)), PREFIX),
            Node::Not(of) => (format!("~{}", self.inside(of, PREFIX)), PREFIX),
            Node::Binary(op, a, b) => self.binary(*op, a, b),
            Node::Choice(..) => (String::new(), WHOLE),
            Node::Call(name, arguments) => {
                let given: Vec<String> = arguments.iter().map(|a| self.expr(&a.value)).collect();
                (format!("{name}({})", given.join(", ")), WHOLE)
            }
            Node::Made(parts) => {
                let parts = parts.iter().map(|part| self.expr(part));
                let Type::Struct(name) = &expr.kind else {
                    return (format!("[{}]", parts.collect::<Vec<_>>().join(", ")), WHOLE);
                };
                let members = self.code.members(name);
                let each =
                    members.iter().zip(parts).map(|(m, part)| format!("'{}', {part}", m.name));
                (format!("struct({})", each.collect::<Vec<_>>().join(", ")), WHOLE)
            }
            Node::Cast(of) => match (&of.kind, &expr.kind) {
                (Type::Bool, Type::Int) => (format!("double({})", self.expr(of)), WHOLE),
                _ => self.bound(of),
            },
        }
    }

    fn binary(&self, op: Op, a: &Expr, b: &Expr) -> (String, u8) {
        let whole = |function: &str, a: String, b: String| (format!("{function}({a}, {b})"), WHOLE);
        match op {
            Op::BitAnd => whole("bitand", self.expr(a), self.expr(b)),
            Op::BitOr => whole("bitor", self.expr(a), self.expr(b)),
            Op::ShiftLeft => whole("bitshift", self.expr(a), self.expr(b)),
            Op::ShiftRight => {
                whole("bitshift", self.expr(a), format!("-{}", self.inside(b, PREFIX)))
            }
            op => {
                let own = strength(op);
                let sign = match op {
                    Op::Unequal => "~=",
                    op => op.in_c(),
                };
                (format!("{} {sign} {}", self.inside(a, own), self.inside(b, own + 1)), own)
            }
        }
    }
}
