//! Expressions.

use super::{Body, is_pointer};
use crate::tree::{Argument, Expr, Node, Op, Pass, Type};

/// How closely signs and conversions bind, and what is whole: more closely than every [`Op`].
const PREFIX: u8 = 10;
const WHOLE: u8 = 11;

impl Body<'_> {
    pub(super) fn expr(&self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    /// An expression inside one that binds with a strength.
    pub(super) fn inside(&self, expr: &Expr, strength: u8) -> String {
        let (text, own) = self.bound(expr);
        if own < strength { format!("({text})") } else { text }
    }

    /// The value that a variable is declared with.
    pub(super) fn initial(&self, init: &Expr) -> String {
        let Node::Made(parts) = &init.node else { return self.expr(init) };
        let parts: Vec<String> = parts.iter().map(|part| self.initial(part)).collect();
        format!("{{ {} }}", parts.join(", "))
    }

    /// A text and how closely it binds.
    fn bound(&self, expr: &Expr) -> (String, u8) {
        let printer = self.printer;
        match &expr.node {
            Node::Number(number) => match expr.kind {
                Type::Real if number.contains(['.', 'e']) => (format!("(real){number}"), PREFIX),
                Type::Bits => (format!("{number}u"), WHOLE),
                _ => (number.clone(), WHOLE),
            },
            Node::Constant(name) => (printer.symbol(name), WHOLE),
            Node::Infinity => ("(real)INFINITY".into(), PREFIX),
            Node::Variable(name) if self.is_pointer(name) => (format!("*{name}"), PREFIX),
            Node::Variable(name) => (name.clone(), WHOLE),
            Node::Member(of, member) => match &of.node {
                Node::Variable(name) if self.is_pointer(name) => {
                    (format!("{name}->{member}"), WHOLE)
                }
                _ => (format!("{}.{member}", self.inside(of, WHOLE)), WHOLE),
            },
            Node::Index(of, index) => {
                (format!("{}[{}]", self.inside(of, WHOLE), self.expr(index)), WHOLE)
            }
            Node::Negative(of) => (format!("-{}", self.inside(of, WHOLE)), PREFIX),
            Node::Not(of) => (format!("!{}", self.inside(of, PREFIX)), PREFIX),
            Node::Binary(op, a, b) => self.binary(*op, a, b, &expr.kind),
            Node::Choice(test, a, b) => {
                let [test, a] = [test, a].map(|part| self.inside(part, 1));
                (format!("{test} ? {a} : {}", self.expr(b)), 0)
            }
            Node::Call(name, arguments) => {
                let given: Vec<String> = arguments.iter().map(|a| self.argument(a)).collect();
                (format!("{}({})", printer.symbol(name), given.join(", ")), WHOLE)
            }
            Node::Made(_) => (self.initial(expr), WHOLE),
            Node::Cast(of) if of.kind == Type::Bool => self.bound(of),
            Node::Cast(of) => {
                (format!("({}){}", printer.kind(&expr.kind), self.inside(of, PREFIX)), PREFIX)
            }
        }
    }

    /// What compilers warn of stands in brackets: operators of bits, and what is true if both are, within what is if either is.
    fn binary(&self, op: Op, a: &Expr, b: &Expr, kind: &Type) -> (String, u8) {
        let own = op.strength();
        let is_of_bits =
            |op: Op| matches!(op, Op::BitOr | Op::BitAnd | Op::ShiftLeft | Op::ShiftRight);
        let operand = |part: &Expr, strength: u8| match part.node {
            Node::Binary(inner, ..)
                if (is_of_bits(op) && inner != op) || (op == Op::Or && inner == Op::And) =>
            {
                format!("({})", self.expr(part))
            }
            _ => self.inside(part, strength),
        };
        let (left, mut right) = (operand(a, own), operand(b, own + 1));
        let whole = |text: &str| text.chars().all(|c| c.is_ascii_digit());
        if *kind == Type::Real && whole(&left) && whole(&right) {
            right = format!("(real){right}");
        }
        (format!("{left} {} {right}", op.in_c()), own)
    }

    fn is_pointer(&self, name: &str) -> bool {
        self.function.parameters.iter().any(|p| p.name == name && is_pointer(p))
    }

    fn argument(&self, Argument { value, pass }: &Argument) -> String {
        match &value.node {
            _ if *pass == Pass::Value || value.kind.is_array() => self.expr(value),
            Node::Variable(name) if self.is_pointer(name) => name.clone(),
            _ => format!("&{}", self.inside(value, WHOLE)),
        }
    }
}
