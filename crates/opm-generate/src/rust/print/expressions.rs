//! Expressions.

use super::{Printer, constant, kind};
use crate::text::{camel, literal};
use crate::tree::{Expr, Node, Op, Pass, Type};

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

impl Printer<'_> {
    pub(super) fn expr(&self, expr: &Expr) -> String {
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
        let members = self.code.members(name);
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
