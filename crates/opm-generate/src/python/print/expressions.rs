//! Expressions.

use super::Printer;
use crate::tree::{Expr, Node, Op, Type};

/// How closely operators bind in Python: comparisons are weaker than operators of bits, which stand for those of tests.
fn strength(op: Op) -> u8 {
    match op {
        op if op.is_comparison() => 1,
        Op::Or | Op::BitOr => 2,
        Op::And | Op::BitAnd => 3,
        Op::ShiftLeft | Op::ShiftRight => 4,
        Op::Add | Op::Subtract => 5,
        _ => 6,
    }
}
const PREFIX: u8 = 7;
const WHOLE: u8 = 8;

impl Printer<'_> {
    pub(super) fn expr(&self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    fn inside(&self, expr: &Expr, strength: u8) -> String {
        let (text, own) = self.bound(expr);
        if own < strength { format!("({text})") } else { text }
    }

    fn bound(&self, expr: &Expr) -> (String, u8) {
        match &expr.node {
            Node::Number(number) => (number.clone(), WHOLE),
            Node::Constant(name) => (name.clone(), WHOLE),
            Node::Infinity => ("np.inf".into(), WHOLE),
            Node::Variable(name) => (name.clone(), WHOLE),
            Node::Member(of, name) => (format!("{}.{name}", self.inside(of, WHOLE)), WHOLE),
            Node::Index(of, index) => match self.ways.is_uniform(index) {
                true => (format!("{}[{}]", self.inside(of, WHOLE), self.expr(index)), WHOLE),
                false => (format!("_get({}, {})", self.expr(of), self.expr(index)), WHOLE),
            },
            Node::Negative(of) => (format!("-{}", self.inside(of, PREFIX)), PREFIX),
            Node::Not(of) => (format!("_not({})", self.expr(of)), WHOLE),
            Node::Binary(op, a, b) => {
                let own = strength(*op);
                let left = if op.is_comparison() { own + 1 } else { own };
                let sign = match op {
                    Op::Or => "|",
                    Op::And => "&",
                    op => op.in_c(),
                };
                let [a, b] = [self.inside(a, left), self.inside(b, own + 1)];
                (format!("{a} {sign} {b}"), own)
            }
            Node::Choice(test, a, b) => {
                let all = [test, a, b].map(|part| self.expr(part));
                (format!("_where({})", all.join(", ")), WHOLE)
            }
            Node::Call(name, arguments) => {
                let given: Vec<String> = arguments.iter().map(|a| self.expr(&a.value)).collect();
                let function = match &**name {
                    "max" => "np.maximum".into(),
                    "min" => "np.minimum".into(),
                    "abs" | "sqrt" | "sin" | "cos" | "ceil" => format!("np.{name}"),
                    "asin" | "acos" => format!("np.arc{}", &name[1..]),
                    "atan2" => "np.arctan2".into(),
                    name => format!("_{name}"),
                };
                (format!("{function}({})", given.join(", ")), WHOLE)
            }
            Node::Made(parts) => {
                let parts: Vec<String> = parts.iter().map(|part| self.expr(part)).collect();
                match &expr.kind {
                    Type::Struct(name) => {
                        (format!("{}({})", crate::text::camel(name), parts.join(", ")), WHOLE)
                    }
                    _ => (format!("[{}]", parts.join(", ")), WHOLE),
                }
            }
            Node::Cast(of) => match (&of.kind, &expr.kind) {
                (Type::Bool, Type::Int) => (format!("_where({}, 1, 0)", self.expr(of)), WHOLE),
                _ => self.bound(of),
            },
        }
    }
}
