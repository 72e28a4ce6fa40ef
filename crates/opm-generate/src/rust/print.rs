//! The closed forms, as Rust.

use crate::text::{camel, commented, literal};
use crate::tree::{
    BUILT_IN, Code, Expr, Function, Node, Op, Parameter, Pass, Statement, Struct, Type, Value,
    flow, visit,
};
use std::fmt::Write;

/// Words that are no names.
const KEYWORDS: [&str; 12] =
    ["as", "in", "let", "loop", "match", "move", "mut", "ref", "type", "use", "where", "box"];

/// How closely an operator binds in Rust; more than [`Op`]s are a prefix, a conversion and a call.
fn strength(op: Op) -> u8 {
    match op {
        Op::Or => 1,
        Op::And => 2,
        op if op.is_comparison() => 3,
        Op::BitOr => 4,
        Op::BitAnd => 5,
        Op::ShiftLeft | Op::ShiftRight => 6,
        Op::Add | Op::Subtract => 7,
        _ => 8,
    }
}
const CAST: u8 = 9;
const PREFIX: u8 = 10;
const WHOLE: u8 = 11;

/// A text and how closely it binds.
type Bound = (String, u8);

/// The source file of the closed forms.
pub fn module(code: &Code) -> String {
    let mut text = String::new();
    for names in &code.enums {
        text += &commented(&names.comment, "// ", "");
        for entry in &names.entries {
            text += &commented(&entry.comment, "/// ", "");
            // Names of joints may differ in their case alone.
            let _ = writeln!(text, "pub const {}: usize = {};", entry.name, entry.value);
        }
        text += "\n";
    }
    for one in &code.constants {
        text += &commented(&one.comment, "/// ", "");
        let [double, float] = [&one.double, &one.float].map(|number| literal(number));
        let value = match double == float {
            true => double,
            false => format!("by_type({double}, {float})"),
        };
        let _ = writeln!(text, "const {}: Real = {value};\n", constant(&one.name));
    }
    for one in &code.structs {
        text += &structure(one);
    }
    let kind = Type::Struct("geometry".into());
    let _ = write!(
        text,
        "/// The mechanism as it was when this code was written.\n#[allow(clippy::excessive_precision)]\n\
         pub const DEFAULT: Geometry = {};\n\n",
        value(code, &kind, &code.default, 0)
    );
    for one in &code.functions {
        text += &Printer::new(code, one).function();
        text += "\n";
    }
    text.trim_end().to_owned() + "\n"
}

/// The name of a constant.
fn constant(name: &str) -> String {
    name.to_uppercase()
}

fn structure(one: &Struct) -> String {
    let mut text = commented(&one.comment, "/// ", "");
    let arrays = one.members.iter().any(|member| member.kind.is_array());
    let default = if arrays { "" } else { "Default, " };
    let _ = writeln!(
        text,
        "#[derive(Clone, Copy, Debug, {default}PartialEq)]\npub struct {} {{",
        camel(&one.name)
    );
    for member in &one.members {
        text += &commented(&member.comment, "/// ", "    ");
        let _ = writeln!(text, "    pub {}: {},", member.name, kind(&member.kind));
    }
    text + "}\n\n"
}

fn kind(of: &Type) -> String {
    match of {
        Type::Void => "()".into(),
        Type::Bool => "bool".into(),
        Type::Int => "i32".into(),
        Type::Bits => "u32".into(),
        Type::Real => "Real".into(),
        Type::Struct(name) => camel(name),
        Type::Array(of, count) => format!("[{}; {count}]", kind(of)),
    }
}

/// A constant of a type.
fn value(code: &Code, of: &Type, value_of: &Value, depth: usize) -> String {
    let space = "    ".repeat(depth + 1);
    match (of, value_of) {
        (_, Value::Number(number)) if number.is_infinite() => {
            if *number > 0.0 {
                "Real::INFINITY".into()
            } else {
                "Real::NEG_INFINITY".into()
            }
        }
        (_, Value::Number(number)) => format!("{:?}", number + 0.0),
        (Type::Array(of, _), Value::List(parts)) => {
            let parts: Vec<String> =
                parts.iter().map(|part| value(code, of, part, depth + 1)).collect();
            let long = matches!(**of, Type::Struct(_));
            let break_line = if long { format!("\n{space}") } else { " ".into() };
            let joined = parts.join(&format!(",{break_line}"));
            match long {
                true => format!("[\n{space}{joined},\n{}]", "    ".repeat(depth)),
                false => format!("[{joined}]"),
            }
        }
        (Type::Struct(name), Value::List(parts)) => {
            let known = code.structs.iter().find(|known| known.name == *name);
            let members = known.map_or(&[][..], |known| &known.members);
            let parts: Vec<String> = members
                .iter()
                .zip(parts)
                .map(|(m, part)| format!("{}: {}", m.name, value(code, &m.kind, part, depth + 1)))
                .collect();
            match depth {
                0 => format!(
                    "{} {{\n{space}{},\n}}",
                    camel(name),
                    parts.join(&format!(",\n{space}"))
                ),
                _ => format!("{} {{ {} }}", camel(name), parts.join(", ")),
            }
        }
        _ => String::new(),
    }
}

/// Prints one function.
struct Printer<'a> {
    code: &'a Code,
    function: Function,
}

impl<'a> Printer<'a> {
    fn new(code: &'a Code, function: &Function) -> Self {
        let mut function = function.clone();
        let taken = |name: &str| {
            KEYWORDS.contains(&name)
                || BUILT_IN.contains(&name)
                || code.functions.iter().any(|other| other.name == name)
        };
        visit::rename(&mut function, &|name| taken(name).then(|| format!("{name}_")));
        Self { code, function }
    }

    fn function(&self) -> String {
        let function = &self.function;
        let parameters: Vec<String> =
            function.parameters.iter().map(|p| self.parameter(p)).collect();
        let result = match function.result {
            Type::Void => String::new(),
            ref result => format!(" -> {}", kind(result)),
        };
        let mut text = commented(&function.comment, "/// ", "");
        let public = if function.public { "pub(crate) " } else { "" };
        if parameters.len() > 7 {
            text += "#[allow(clippy::too_many_arguments)]\n";
        }
        let _ =
            writeln!(text, "{public}fn {}({}){result} {{", function.name, parameters.join(", "));
        let last = function.body.len().saturating_sub(1);
        for (number, statement) in function.body.iter().enumerate() {
            match statement {
                Statement::Return(Some(value)) if number == last => {
                    let _ = writeln!(text, "    {}", self.expr(value));
                }
                _ => self.statement(statement, &function.body[number + 1..], 1, &mut text),
            }
        }
        text + "}\n"
    }

    fn parameter(&self, p: &Parameter) -> String {
        let assigned = flow::is_assigned(&self.function.body, &p.name);
        let used = self.function.body.iter().any(|s| visit::mentions(s, &p.name));
        let name = if used { p.name.clone() } else { format!("_{}", p.name) };
        match (&p.kind, p.pass) {
            (Type::Array(of, _), Pass::Write) => format!("{name}: &mut [{}]", kind(of)),
            (Type::Array(of, _), _) => format!("{name}: &[{}]", kind(of)),
            (of, Pass::Read) => format!("{name}: &{}", kind(of)),
            (of, Pass::Write) => format!("{name}: &mut {}", kind(of)),
            (of, Pass::Value) if assigned => format!("mut {name}: {}", kind(of)),
            (of, Pass::Value) => format!("{name}: {}", kind(of)),
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
                *text += &commented(comment, "// ", &space);
                Ok(())
            }
            Statement::Declare { name, kind: of, init } => {
                let written = self.declaration(name, of, init.as_ref(), rest);
                writeln!(text, "{space}let {written};")
            }
            Statement::Assign { place, op, value } => {
                let op = op.map_or("", Op::in_c);
                writeln!(text, "{space}{} {op}= {};", self.expr(place), self.expr(value))
            }
            Statement::Call(call) => writeln!(text, "{space}{};", self.expr(call)),
            Statement::If { test, then, otherwise } => {
                let _ = writeln!(text, "{space}if {} {{", self.expr(test));
                self.block(then, depth + 1, text);
                if !otherwise.is_empty() {
                    let _ = writeln!(text, "{space}}} else {{");
                    self.block(otherwise, depth + 1, text);
                }
                writeln!(text, "{space}}}")
            }
            Statement::For { name, from, to, test, body, .. } => {
                let used = body.iter().any(|s| visit::mentions(s, name));
                let counter = if used { name } else { "_" };
                let _ = writeln!(
                    text,
                    "{space}for {counter} in {}..{} {{",
                    self.expr(from),
                    self.expr(to)
                );
                if let Some(test) = test {
                    let test = match &test.node {
                        Node::Not(of) => self.expr(of),
                        _ => format!("!({})", self.expr(test)),
                    };
                    let _ = writeln!(
                        text,
                        "{space}    if {test} {{\n{space}        break;\n{space}    }}"
                    );
                }
                self.block(body, depth + 1, text);
                writeln!(text, "{space}}}")
            }
            Statement::Block(body) => {
                let _ = writeln!(text, "{space}{{");
                self.block(body, depth + 1, text);
                writeln!(text, "{space}}}")
            }
            Statement::Return(None) => writeln!(text, "{space}return;"),
            Statement::Return(Some(value)) => writeln!(text, "{space}return {};", self.expr(value)),
            Statement::Continue => writeln!(text, "{space}continue;"),
        };
    }

    /// A declaration without `let`.
    fn declaration(
        &self,
        name: &str,
        of: &Type,
        init: Option<&Expr>,
        rest: &[Statement],
    ) -> String {
        let changed = |declared: &str| match flow::is_assigned(rest, name) {
            true => format!("mut {declared}"),
            false => declared.to_owned(),
        };
        let init = init.filter(|_| !flow::is_overwritten(rest, name));
        match (init, of) {
            (Some(init), Type::Struct(_)) => format!("{} = {}", changed(name), self.expr(init)),
            (Some(init), of) => format!("{}: {} = {}", changed(name), kind(of), self.expr(init)),
            (None, Type::Array(of, count)) => {
                let zero = match &**of {
                    Type::Struct(name) => format!("{}::default()", camel(name)),
                    Type::Real => "0.0".into(),
                    _ => "0".into(),
                };
                format!("mut {name}: [{}; {count}] = [{zero}; {count}]", kind(of))
            }
            (None, Type::Struct(of)) if flow::needs_value(rest, name) => {
                format!("mut {name} = {}::default()", camel(of))
            }
            (None, of) if flow::needs_value(rest, name) => {
                let zero = if *of == Type::Real { "0.0" } else { "0" };
                format!("mut {name}: {} = {zero}", kind(of))
            }
            (None, of) => {
                let again = if flow::is_assigned_again(rest, name) { "mut " } else { "" };
                format!("{again}{name}: {}", kind(of))
            }
        }
    }

    fn expr(&self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    /// An expression inside one that binds with a strength.
    fn inside(&self, expr: &Expr, strength: u8) -> String {
        let (text, own) = self.bound(expr);
        if own < strength { format!("({text})") } else { text }
    }

    fn bound(&self, expr: &Expr) -> Bound {
        match &expr.node {
            Node::Number(number) => match expr.kind {
                Type::Real => (literal(number), WHOLE),
                _ => (number.clone(), WHOLE),
            },
            Node::Constant(name) => match expr.kind {
                Type::Int => (format!("{name} as i32"), CAST),
                _ => (constant(name), WHOLE),
            },
            Node::Infinity => ("Real::INFINITY".into(), WHOLE),
            Node::Variable(name) => match self.pass(name) {
                Pass::Value => (name.clone(), WHOLE),
                _ if expr.kind.is_array() => (name.clone(), WHOLE),
                _ => (format!("*{name}"), PREFIX),
            },
            Node::Member(of, name) => (format!("{}.{name}", self.base(of)), WHOLE),
            Node::Index(of, index) => (format!("{}[{}]", self.base(of), self.index(index)), WHOLE),
            Node::Negative(of) => (format!("-{}", self.inside(of, PREFIX)), PREFIX),
            Node::Not(of) => (format!("!{}", self.inside(of, PREFIX)), PREFIX),
            Node::Binary(op, a, b) => {
                let own = strength(*op);
                // A comparison cannot be an operand of another one; a conversion before < is no generic.
                let left = if op.is_comparison() { own + 1 } else { own };
                let mut left = self.inside(a, left);
                if left.contains(" as ") && !left.ends_with(')') {
                    left = format!("({left})");
                }
                (format!("{left} {} {}", op.in_c(), self.inside(b, own + 1)), own)
            }
            Node::Choice(test, a, b) => {
                let [test, a, b] = [test, a, b].map(|part| self.expr(part));
                (format!("if {test} {{ {a} }} else {{ {b} }}"), 0)
            }
            Node::Call(name, arguments) => {
                let given: Vec<String> =
                    arguments.iter().map(|a| self.argument(&a.value, a.pass)).collect();
                (format!("{name}({})", given.join(", ")), WHOLE)
            }
            Node::Made(parts) => (self.made(&expr.kind, parts), WHOLE),
            Node::Cast(of) => match (&of.kind, &expr.kind) {
                (Type::Bool, Type::Int) => (format!("i32::from({})", self.expr(of)), WHOLE),
                (_, to) => (format!("{} as {}", self.inside(of, CAST), kind(to)), CAST),
            },
        }
    }

    fn made(&self, of: &Type, parts: &[Expr]) -> String {
        let parts = parts.iter().map(|part| self.expr(part));
        let Type::Struct(name) = of else {
            return format!("[{}]", parts.collect::<Vec<_>>().join(", "));
        };
        let known = self.code.structs.iter().find(|known| known.name == *name);
        let members = known.map_or(&[][..], |known| &known.members);
        let given: Vec<String> = members
            .iter()
            .zip(parts)
            .map(|(m, part)| if m.name == part { part } else { format!("{}: {part}", m.name) })
            .collect();
        format!("{} {{ {} }}", camel(name), given.join(", "))
    }

    fn pass(&self, name: &str) -> Pass {
        let found = self.function.parameters.iter().find(|p| p.name == name);
        found.map_or(Pass::Value, |p| p.pass)
    }

    /// What a member or an element is taken of.
    fn base(&self, of: &Expr) -> String {
        match &of.node {
            Node::Variable(name) => name.clone(),
            _ => self.inside(of, WHOLE),
        }
    }

    fn index(&self, index: &Expr) -> String {
        match &index.node {
            Node::Number(number) => number.clone(),
            Node::Constant(name) => name.clone(),
            _ => format!("{} as usize", self.inside(index, CAST)),
        }
    }

    fn argument(&self, value: &Expr, pass: Pass) -> String {
        let passed_on = match &value.node {
            Node::Variable(name) => self.pass(name) != Pass::Value,
            _ => false,
        };
        match pass {
            Pass::Value => self.expr(value),
            _ if passed_on => self.base(value),
            Pass::Read => format!("&{}", self.inside(value, WHOLE)),
            Pass::Write => format!("&mut {}", self.inside(value, WHOLE)),
        }
    }
}
