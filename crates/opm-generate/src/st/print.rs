//! The closed forms, as structured text.

use super::names::symbol;
use crate::text::commented;
use crate::tree::{
    Argument, Code, Expr, Function, Node, Op, Parameter, Pass, Statement, Struct, Type, Value,
};
use std::fmt::Write;

/// The functions of numbers that the standard has.
const STANDARD: [&str; 8] = ["abs", "max", "min", "sqrt", "sin", "cos", "asin", "acos"];

/// The name of an infinite number: the language has none, so it is the largest one.
const INFINITY: &str = "C_INFINITY";
const LARGEST: &str = "1.7976931348623157E308";

/// How closely operators bind.
fn strength(op: Op) -> u8 {
    match op {
        Op::Or | Op::BitOr => 1,
        Op::And | Op::BitAnd => 2,
        Op::Equal | Op::Unequal => 3,
        Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual => 4,
        Op::Add | Op::Subtract => 5,
        Op::Multiply | Op::Divide | Op::Remainder => 6,
        Op::ShiftLeft | Op::ShiftRight => WHOLE,
    }
}
/// Behind a sign, or behind an operator, what has a sign stands in brackets.
const PREFIX: u8 = 7;
const WHOLE: u8 = 8;

fn operator(op: Op) -> &'static str {
    match op {
        Op::Or | Op::BitOr => "OR",
        Op::And | Op::BitAnd => "AND",
        Op::Equal => "=",
        Op::Unequal => "<>",
        Op::Remainder => "MOD",
        op => op.in_c(),
    }
}

/// A text as a part of a comment: it cannot begin or end one.
pub fn comment(text: &str) -> String {
    text.replace("(*", "( *").replace("*)", "* )")
}

/// A type; structs have the prefix of the mechanism.
pub fn kind(of: &Type, prefix: &str) -> String {
    match of {
        // Not every controller has functions without a result.
        Type::Void | Type::Bool => "BOOL".into(),
        Type::Int => "DINT".into(),
        Type::Bits => "DWORD".into(),
        Type::Real => "LREAL".into(),
        Type::Struct(name) => symbol(&format!("{prefix}_{name}")),
        Type::Array(of, count) => {
            format!("ARRAY[0..{}] OF {}", count.saturating_sub(1), kind(of, prefix))
        }
    }
}

/// A number with all its digits.
pub fn real(number: f64) -> String {
    if number.is_infinite() {
        return if number > 0.0 { LARGEST.into() } else { format!("-{LARGEST}") };
    }
    literal(&format!("{:?}", number + 0.0))
}

/// A number of the library, or of Rust: there are digits on both sides of a point.
fn literal(number: &str) -> String {
    let (digits, exponent) = match number.split_once('e') {
        Some((digits, exponent)) => (digits, format!("E{exponent}")),
        None => (number, String::new()),
    };
    let point = if digits.contains('.') { "" } else { ".0" };
    format!("{digits}{point}{exponent}")
}

/// A struct as a type. That of the geometry has the numbers of the mechanism.
pub fn structure(code: &Code, one: &Struct, prefix: &str) -> String {
    let mut text = block_comment(&one.comment, "");
    let _ = writeln!(text, "TYPE {} :\nSTRUCT", symbol(&format!("{prefix}_{}", one.name)));
    let values = match &code.default {
        Value::List(values) if one.name == "geometry" => Some(values),
        _ => None,
    };
    for (place, member) in one.members.iter().enumerate() {
        text += &block_comment(&member.comment, "    ");
        let initial = values.and_then(|values| values.get(place));
        let initial = initial.map(|initial| value(code, &member.kind, initial));
        let initial = initial.map_or(String::new(), |initial| format!(" := {initial}"));
        let _ = writeln!(text, "    {} : {}{initial};", member.name, kind(&member.kind, prefix));
    }
    text + "END_STRUCT;\nEND_TYPE\n\n"
}

/// A constant of a type.
fn value(code: &Code, of: &Type, value_of: &Value) -> String {
    match (of, value_of) {
        (_, Value::Number(number)) => real(*number),
        (Type::Array(of, _), Value::List(parts)) => {
            let parts: Vec<String> = parts.iter().map(|part| value(code, of, part)).collect();
            match **of {
                Type::Struct(_) => {
                    format!("[\n        {}\n    ]", parts.join(",\n        "))
                }
                _ => format!("[{}]", parts.join(", ")),
            }
        }
        (Type::Struct(name), Value::List(parts)) => {
            let members = code.members(name);
            let parts: Vec<String> = (members.iter().zip(parts))
                .map(|(m, part)| format!("{} := {}", m.name, value(code, &m.kind, part)))
                .collect();
            format!("({})", parts.join(", "))
        }
        _ => String::new(),
    }
}

fn block_comment(text: &str, space: &str) -> String {
    let lines = commented(&comment(text), "", &format!("{space}   "));
    match lines.is_empty() {
        true => String::new(),
        false => format!("{space}(* {} *)\n", lines.trim()),
    }
}

/// Prints one function.
pub struct Printer<'a> {
    code: &'a Code,
    function: &'a Function,
    prefix: &'a str,
    /// Declarations of variables, and of constants.
    variables: Vec<String>,
    constants: Vec<String>,
    wrong: Option<String>,
}

impl<'a> Printer<'a> {
    pub fn new(code: &'a Code, function: &'a Function, prefix: &'a str) -> Self {
        let (variables, constants) = (Vec::new(), Vec::new());
        Self { code, function, prefix, variables, constants, wrong: None }
    }

    pub fn function(mut self) -> Result<String, String> {
        let function = self.function;
        let mut body = String::new();
        self.block(&function.body, 0, true, &mut body);
        if function.result == Type::Void {
            let name = called(self.code, &function.name, self.prefix);
            let _ = writeln!(body, "{name} := TRUE;");
        }
        if let Some(wrong) = self.wrong {
            return Err(format!("{wrong} in {}", function.name));
        }
        let name = called(self.code, &function.name, self.prefix);
        let mut text = block_comment(&function.comment, "");
        let result = kind(&function.result, self.prefix);
        let _ = writeln!(text, "FUNCTION {name} : {result}");
        // Sections in the order of the parameters.
        let mut open = "";
        for p in &function.parameters {
            let section = section(p);
            if section != open {
                text += if open.is_empty() { "" } else { "END_VAR\n" };
                let _ = writeln!(text, "{section}");
                open = section;
            }
            let _ = writeln!(text, "    {} : {};", p.name, kind(&p.kind, self.prefix));
        }
        text += if open.is_empty() { "" } else { "END_VAR\n" };
        for (head, lines) in [("VAR CONSTANT", &mut self.constants), ("VAR", &mut self.variables)] {
            let mut seen = std::collections::HashSet::new();
            lines.retain(|line| seen.insert(line.clone()));
            if !lines.is_empty() {
                let _ = write!(text, "{head}\n{}END_VAR\n", lines.concat());
            }
        }
        Ok(format!("{text}{body}END_FUNCTION\n\n"))
    }

    fn declare(&mut self, name: &str, of: &Type) {
        self.variables.push(format!("    {name} : {};\n", kind(of, self.prefix)));
    }

    fn constant(&mut self, name: &str, number: &str) -> String {
        self.constants.push(format!("    {name} : LREAL := {number};\n"));
        name.to_owned()
    }

    /// Statements; `ends` says that the function ends behind them.
    fn block(&mut self, body: &[Statement], depth: usize, ends: bool, text: &mut String) {
        for (number, statement) in body.iter().enumerate() {
            let last = ends && number + 1 == body.len();
            self.statement(statement, depth, last, text);
        }
    }

    fn statement(&mut self, one: &Statement, depth: usize, last: bool, text: &mut String) {
        let space = "    ".repeat(depth);
        match one {
            Statement::Comment(comment) => *text += &block_comment(comment, &space),
            Statement::Declare { name, kind, init } => {
                self.declare(name, kind);
                if let Some(init) = init {
                    self.assign(name, init, &space, text);
                }
            }
            Statement::Assign { place, op, value } => {
                let target = self.expr(place);
                match op {
                    None => self.assign(&target, value, &space, text),
                    Some(op) => {
                        let whole =
                            Node::Binary(*op, Box::new(place.clone()), Box::new(value.clone()));
                        let whole = Expr::new(whole, place.kind.clone());
                        self.assign(&target, &whole, &space, text);
                    }
                }
            }
            Statement::Call(call) => {
                let written = self.expr(call);
                let name = if call.kind == Type::Void { "done" } else { "ignored" };
                self.declare(name, &call.kind);
                let _ = writeln!(text, "{space}{name} := {written};");
            }
            Statement::If { test, then, otherwise } => {
                let test = self.expr(test);
                let _ = writeln!(text, "{space}IF {test} THEN");
                self.inner(then, depth + 1, last, text);
                if !otherwise.is_empty() {
                    let _ = writeln!(text, "{space}ELSE");
                    self.inner(otherwise, depth + 1, last, text);
                }
                let _ = writeln!(text, "{space}END_IF;");
            }
            Statement::For { name, from, to, test, body } => {
                self.counting([from, to], name, test.as_ref(), body, depth, text);
            }
            Statement::Block(body) => self.block(body, depth, last, text),
            Statement::Return(value) => {
                match value {
                    Some(value) => self.give_back(value, &space, text),
                    None if last => {}
                    None => {
                        let name = called(self.code, &self.function.name, self.prefix);
                        let _ = writeln!(text, "{space}{name} := TRUE;");
                    }
                }
                if !last {
                    let _ = writeln!(text, "{space}RETURN;");
                }
            }
            Statement::Continue => {
                let _ = writeln!(text, "{space}CONTINUE;");
            }
        }
    }

    /// Statements inside another one: there is at least one.
    fn inner(&mut self, body: &[Statement], depth: usize, last: bool, text: &mut String) {
        let before = text.len();
        self.block(body, depth, last, text);
        if text.len() == before {
            let _ = writeln!(text, "{};", "    ".repeat(depth));
        }
    }

    /// Counters are whole numbers; one of bits gets its number.
    fn counting(
        &mut self,
        [from, to]: [&Expr; 2],
        name: &str,
        test: Option<&Expr>,
        body: &[Statement],
        depth: usize,
        text: &mut String,
    ) {
        let (space, inner) = ("    ".repeat(depth), "    ".repeat(depth + 1));
        let bits = from.kind == Type::Bits;
        self.declare(name, &from.kind);
        let counter = if bits { format!("{name}_number") } else { name.to_owned() };
        if bits {
            self.declare(&counter, &Type::Int);
        }
        let [from, last] = [from, to].map(|end| self.whole_number(end));
        let last = match last.parse::<i64>() {
            Ok(number) => (number - 1).to_string(),
            Err(_) => format!("{last} - 1"),
        };
        let _ = writeln!(text, "{space}FOR {counter} := {from} TO {last} DO");
        if bits {
            let _ = writeln!(text, "{inner}{name} := DINT_TO_DWORD({counter});");
        }
        if let Some(test) = test {
            let test = self.inside(test, PREFIX);
            let _ = writeln!(text, "{inner}IF NOT {test} THEN\n{inner}    EXIT;\n{inner}END_IF;");
        }
        self.block(body, depth + 1, false, text);
        let _ = writeln!(text, "{space}END_FOR;");
    }

    /// The result of the function: a struct is put together first.
    fn give_back(&mut self, value: &Expr, space: &str, text: &mut String) {
        let name = called(self.code, &self.function.name, self.prefix);
        if let Node::Made(_) = value.node {
            self.declare("result", &value.kind);
            self.assign("result", value, space, text);
            let _ = writeln!(text, "{space}{name} := result;");
        } else {
            self.assign(&name, value, space, text);
        }
    }

    fn assign(&mut self, target: &str, value: &Expr, space: &str, text: &mut String) {
        let Node::Made(parts) = &value.node else {
            let value = self.expr(value);
            let _ = writeln!(text, "{space}{target} := {value};");
            return;
        };
        match &value.kind {
            Type::Struct(name) => {
                for (member, part) in self.code.members(name).iter().zip(parts) {
                    self.assign(&format!("{target}.{}", member.name), part, space, text);
                }
            }
            _ => {
                for (place, part) in parts.iter().enumerate() {
                    self.assign(&format!("{target}[{place}]"), part, space, text);
                }
            }
        }
    }

    fn expr(&mut self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    fn inside(&mut self, expr: &Expr, strength: u8) -> String {
        let (text, own) = self.bound(expr);
        if own < strength { format!("({text})") } else { text }
    }

    /// A number of a `DINT`, whatever it is in C.
    fn whole_number(&mut self, expr: &Expr) -> String {
        match (&expr.node, &expr.kind) {
            (Node::Number(number), _) => number.clone(),
            (Node::Cast(of), Type::Bits) if of.kind == Type::Int => self.expr(of),
            (_, Type::Bits) => format!("DWORD_TO_DINT({})", self.expr(expr)),
            _ => self.expr(expr),
        }
    }

    fn bound(&mut self, expr: &Expr) -> (String, u8) {
        match &expr.node {
            Node::Number(number) => (self.number(number, &expr.kind), WHOLE),
            Node::Constant(name) => (self.named(name, &expr.kind), WHOLE),
            Node::Infinity => (self.constant(INFINITY, LARGEST), WHOLE),
            Node::Variable(name) => (name.clone(), WHOLE),
            Node::Member(of, name) => (format!("{}.{name}", self.inside(of, WHOLE)), WHOLE),
            Node::Index(of, index) => {
                let of = self.inside(of, WHOLE);
                (format!("{of}[{}]", self.whole_number(index)), WHOLE)
            }
            Node::Negative(of) => match (&of.node, &of.kind) {
                // A number with its sign is a number.
                (Node::Number(_), _) => (format!("-{}", self.expr(of)), 0),
                _ => (format!("-{}", self.inside(of, WHOLE)), 0),
            },
            Node::Not(of) => (format!("NOT {}", self.inside(of, WHOLE)), PREFIX),
            Node::Binary(op @ (Op::ShiftLeft | Op::ShiftRight), a, b) => {
                let (a, b) = (self.expr(a), self.whole_number(b));
                let function = if *op == Op::ShiftLeft { "SHL" } else { "SHR" };
                (format!("{function}({a}, {b})"), WHOLE)
            }
            Node::Binary(op, a, b) => {
                let own = strength(*op);
                // A sign at the beginning belongs to what follows it alone.
                let (a_text, a_own) = self.bound(a);
                let a = if a_own < own && a_own != 0 || a_own == 0 && own != strength(Op::Add) {
                    format!("({a_text})")
                } else {
                    a_text
                };
                let b = self.inside(b, own + 1);
                (format!("{a} {} {b}", operator(*op)), own)
            }
            Node::Choice(..) | Node::Made(_) => {
                self.wrong =
                    Some("a choice, or a struct that is made, inside an expression".into());
                (String::new(), WHOLE)
            }
            Node::Call(name, arguments) => (self.call(name, arguments), WHOLE),
            Node::Cast(of) => self.cast(of, &expr.kind),
        }
    }

    fn number(&self, number: &str, kind: &Type) -> String {
        match kind {
            Type::Real => literal(number),
            Type::Bits => format!("DWORD#{number}"),
            _ => number.to_owned(),
        }
    }

    /// An entry of an enum is a number; a tolerance, a constant of the function.
    fn named(&mut self, name: &str, kind: &Type) -> String {
        let code = self.code;
        if let Some(constant) = code.constants.iter().find(|constant| constant.name == name) {
            return self.constant(&format!("C_{name}"), &literal(&constant.double));
        }
        match code.number(name) {
            Some(value) => self.number(&value.to_string(), kind),
            None => {
                self.wrong = Some(format!("no constant {name}"));
                String::new()
            }
        }
    }

    fn cast(&mut self, of: &Expr, to: &Type) -> (String, u8) {
        if let Node::Constant(name) = &of.node
            && of.kind == Type::Int
        {
            return (self.named(name, to), WHOLE);
        }
        let function = match (&of.kind, to) {
            (Type::Bool, Type::Int) => "BOOL_TO_DINT",
            (Type::Int, Type::Real) => "DINT_TO_LREAL",
            (Type::Int, Type::Bits) => "DINT_TO_DWORD",
            (Type::Bits, Type::Int) => "DWORD_TO_DINT",
            (a, b) if a == b => return self.bound(of),
            (a, b) => {
                self.wrong = Some(format!("a conversion from {a:?} to {b:?}"));
                ""
            }
        };
        (format!("{function}({})", self.expr(of)), WHOLE)
    }

    fn call(&mut self, name: &str, arguments: &[Argument]) -> String {
        let given: Vec<String> = arguments.iter().map(|a| self.expr(&a.value)).collect();
        if STANDARD.contains(&name) {
            return format!("{}({})", name.to_uppercase(), given.join(", "));
        }
        let function = called(self.code, name, self.prefix);
        let known = self.code.functions.iter().find(|known| known.name == name);
        let parameters = known.map_or(&[][..], |known| &known.parameters);
        // Where something is written, every argument is named.
        if parameters.iter().any(|p| section(p) == "VAR_IN_OUT") {
            let named = parameters.iter().zip(&given);
            let named: Vec<String> =
                named.map(|(p, given)| format!("{} := {given}", p.name)).collect();
            return format!("{function}({})", named.join(", "));
        }
        format!("{function}({})", given.join(", "))
    }
}

/// The geometry is not copied; what else is only read is.
fn section(p: &Parameter) -> &'static str {
    match (p.pass, &p.kind) {
        (Pass::Write, _) => "VAR_IN_OUT",
        (Pass::Read, Type::Struct(name)) if name == "geometry" => "VAR_IN_OUT",
        _ => "VAR_INPUT",
    }
}

/// The name of a function: those of the interface leave theirs to their function blocks.
pub fn called(code: &Code, name: &str, prefix: &str) -> String {
    let public = code.functions.iter().any(|known| known.name == name && known.public);
    symbol(&format!("{prefix}_{}{name}", if public { "fn_" } else { "" }))
}
