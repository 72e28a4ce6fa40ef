//! The expressions of a function, with their types.

use super::lexer::Token;
use super::parser::Parser;
use super::{Argument, BUILT_IN, Expr, Node, Op, Pass, Type};

/// The operators that take two.
const BINARY: [Op; 17] = [
    Op::Or,
    Op::And,
    Op::Equal,
    Op::Unequal,
    Op::Less,
    Op::LessEqual,
    Op::Greater,
    Op::GreaterEqual,
    Op::BitOr,
    Op::BitAnd,
    Op::ShiftLeft,
    Op::ShiftRight,
    Op::Add,
    Op::Subtract,
    Op::Multiply,
    Op::Divide,
    Op::Remainder,
];

impl Parser {
    pub(super) fn expression(&mut self) -> Result<Expr, String> {
        let test = self.binary(1)?;
        if !self.take("?") {
            return Ok(test);
        }
        let a = self.expression()?;
        self.expect(":")?;
        let b = self.expression()?;
        let kind = wider(&a.kind, &b.kind);
        let [a, b] = [a, b].map(|part| Box::new(part.converted(&kind)));
        Ok(Expr::new(Node::Choice(Box::new(test.into_test()), a, b), kind))
    }

    /// Operators that bind at least as closely as a strength.
    fn binary(&mut self, strength: u8) -> Result<Expr, String> {
        let mut left = self.unary()?;
        loop {
            let Token::Sign(sign) = self.peek() else { return Ok(left) };
            let found = BINARY.iter().find(|op| op.in_c() == *sign && op.strength() >= strength);
            let Some(&op) = found else { return Ok(left) };
            self.next();
            let right = self.binary(op.strength() + 1)?;
            left = joined(op, left, right);
        }
    }

    pub(super) fn unary(&mut self) -> Result<Expr, String> {
        if self.take("-") {
            let of = self.unary()?;
            let kind = of.kind.clone();
            return Ok(Expr::new(Node::Negative(Box::new(of)), kind));
        }
        if self.take("!") {
            return Ok(negated(self.unary()?.into_test()));
        }
        // What a pointer points to, and a pointer to a thing, are the thing.
        if self.take("*") || self.take("&") {
            return self.unary();
        }
        let mut of = self.primary()?;
        loop {
            if self.take(".") || self.take("->") {
                let name = self.name()?;
                let Type::Struct(kind) = &of.kind else { return Err("no struct".into()) };
                let members = self.members(kind)?;
                let found = members.into_iter().find(|(member, _)| *member == name);
                let kind = found.ok_or_else(|| format!("there is no member {name}"))?.1;
                of = Expr::new(Node::Member(Box::new(of), name), kind);
            } else if self.take("[") {
                let index = self.expression()?;
                self.expect("]")?;
                let Type::Array(kind, _) = of.kind.clone() else { return Err("no array".into()) };
                of = Expr::new(Node::Index(Box::new(of), Box::new(index)), *kind);
            } else {
                return Ok(of);
            }
        }
    }

    fn primary(&mut self) -> Result<Expr, String> {
        match self.next() {
            Token::Number(number) => {
                let whole = number.chars().all(|c| c.is_ascii_digit());
                let kind = if whole { Type::Int } else { Type::Real };
                Ok(Expr::new(Node::Number(number), kind))
            }
            Token::Sign("(") => {
                if let (Token::Name(name), Token::Sign(")")) = (self.peek().clone(), self.ahead(1))
                {
                    let kind = match &*name {
                        "real" | "double" | "NAME_real" => Some(Type::Real),
                        "int" => Some(Type::Int),
                        "unsigned" => Some(Type::Bits),
                        _ => None,
                    };
                    if let Some(kind) = kind {
                        self.next();
                        self.next();
                        return Ok(self.unary()?.converted(&kind));
                    }
                }
                let inside = self.expression()?;
                self.expect(")")?;
                Ok(inside)
            }
            Token::Name(name) if name == "INFINITY" => Ok(Expr::new(Node::Infinity, Type::Real)),
            Token::Name(name) => match name.strip_prefix("NAME_") {
                Some(global) => self.global(global),
                None if name == "R" => self.primary(),
                None => {
                    let kind = self.variable(&name)?;
                    Ok(Expr::variable(&name, kind))
                }
            },
            other => Err(format!("expected an expression, not {other:?}")),
        }
    }

    /// A call, or a constant.
    fn global(&mut self, name: &str) -> Result<Expr, String> {
        if !self.take("(") {
            let code = &self.code;
            let number = code.constants.iter().any(|constant| constant.name == name);
            let kind = if number { Type::Real } else { Type::Int };
            return Ok(Expr::new(Node::Constant(name.to_owned()), kind));
        }
        let mut given = Vec::new();
        while !self.take(")") {
            given.push(self.expression()?);
            self.take(",");
        }
        let (kinds, result): (Vec<(Type, Pass)>, Type) = if BUILT_IN.contains(&name) {
            (vec![(Type::Real, Pass::Value); given.len()], Type::Real)
        } else {
            let known = self.code.functions.iter().find(|function| function.name == name);
            let known = known.ok_or_else(|| format!("there is no function {name}"))?;
            let kinds = known.parameters.iter().map(|p| (p.kind.clone(), p.pass)).collect();
            (kinds, known.result.clone())
        };
        if kinds.len() != given.len() {
            return Err(format!("{name} takes {} arguments", kinds.len()));
        }
        let arguments = given.into_iter().zip(kinds);
        let arguments = arguments
            .map(|(value, (kind, pass))| Argument {
                value: if pass == Pass::Value { value.converted(&kind) } else { value },
                pass,
            })
            .collect();
        Ok(Expr::new(Node::Call(name.to_owned(), arguments), result))
    }

    pub(super) fn variable(&self, name: &str) -> Result<Type, String> {
        let found = self.scopes.iter().rev().find_map(|scope| scope.get(name));
        found.cloned().ok_or_else(|| format!("there is no variable {name}"))
    }

    /// The members of a struct.
    pub(super) fn members(&self, name: &str) -> Result<Vec<(String, Type)>, String> {
        let found = self.code.structs.iter().find(|known| known.name == name);
        let found = found.ok_or_else(|| format!("there is no struct {name}"))?;
        Ok(found.members.iter().map(|m| (m.name.clone(), m.kind.clone())).collect())
    }
}

/// The type that two numbers are computed in.
fn wider(a: &Type, b: &Type) -> Type {
    let either = |kind| *a == kind || *b == kind;
    if either(Type::Real) {
        Type::Real
    } else if either(Type::Bits) {
        Type::Bits
    } else {
        a.clone()
    }
}

fn joined(op: Op, left: Expr, right: Expr) -> Expr {
    let (left, right, kind) = match op {
        Op::Or | Op::And => (left.into_test(), right.into_test(), Type::Bool),
        Op::ShiftLeft | Op::ShiftRight => {
            let kind = left.kind.clone();
            let right = right.converted(&Type::Bits);
            (left, right, kind)
        }
        _ => {
            let kind = wider(&left.kind, &right.kind);
            let result = if op.is_comparison() { Type::Bool } else { kind.clone() };
            (left.converted(&kind), right.converted(&kind), result)
        }
    };
    Expr::new(Node::Binary(op, Box::new(left), Box::new(right)), kind)
}

/// The opposite of a test. Of numbers, only equality has one that is right for those that are none.
fn negated(test: Expr) -> Expr {
    let swapped = |op, a, b| Expr::new(Node::Binary(op, a, b), Type::Bool);
    match test.node {
        Node::Binary(Op::Equal, a, b) => swapped(Op::Unequal, a, b),
        Node::Binary(Op::Unequal, a, b) => swapped(Op::Equal, a, b),
        node => Expr::new(Node::Not(Box::new(Expr::new(node, Type::Bool))), Type::Bool),
    }
}
