//! The statements of a function.

use super::lexer::Token;
use super::parser::{Parser, Scope};
use super::{Expr, Node, Op, Statement, Type};

impl Parser {
    /// The body of a function that is known.
    pub(super) fn body(&mut self, place: usize) -> Result<Vec<Statement>, String> {
        let function = &self.code.functions[place];
        let scope: Scope =
            function.parameters.iter().map(|p| (p.name.clone(), p.kind.clone())).collect();
        let result = function.result.clone();
        self.scopes = vec![scope];
        self.expect("{")?;
        let mut body = self.block(&result)?;
        without_counters(&mut body);
        made_at_once(&mut body, self);
        super::visit::flatten(&mut body);
        Ok(body)
    }

    /// The statements up to a closing brace.
    fn block(&mut self, result: &Type) -> Result<Vec<Statement>, String> {
        self.scopes.push(Scope::new());
        let mut all = Vec::new();
        while !self.take("}") {
            self.statement(result, &mut all)?;
        }
        self.scopes.pop();
        Ok(all)
    }

    fn declare(&mut self, name: &str, kind: &Type) {
        if let Some(scope) = self.scopes.last_mut() {
            scope.insert(name.to_owned(), kind.clone());
        }
    }

    fn statement(&mut self, result: &Type, all: &mut Vec<Statement>) -> Result<(), String> {
        if let Token::Comment(text) = self.peek().clone() {
            self.next();
            all.push(Statement::Comment(text));
            return Ok(());
        }
        if self.take("{") {
            all.push(Statement::Block(self.block(result)?));
            return Ok(());
        }
        if self.keyword("if") {
            all.push(self.branch(result)?);
            return Ok(());
        }
        if self.keyword("for") {
            all.push(self.counting(result)?);
            return Ok(());
        }
        if self.keyword("return") {
            let value = match self.take(";") {
                true => None,
                false => {
                    let value = self.expression()?.converted(result);
                    self.expect(";")?;
                    Some(value)
                }
            };
            all.push(Statement::Return(value));
            return Ok(());
        }
        if self.keyword("continue") {
            self.expect(";")?;
            all.push(Statement::Continue);
            return Ok(());
        }
        if self.declares() {
            return self.declaration(all);
        }
        // (void)x;
        if let (Token::Sign("("), Token::Name(word)) = (self.peek(), self.ahead(1))
            && word == "void"
        {
            while !self.take(";") {
                self.next();
            }
            return Ok(());
        }
        self.assignment(all)
    }

    fn declaration(&mut self, all: &mut Vec<Statement>) -> Result<(), String> {
        let kind = self.kind()?;
        loop {
            self.take("*");
            let name = self.name()?;
            let kind = self.elements(kind.clone())?;
            let init = match self.take("=") {
                true => Some(self.initial(&kind)?),
                false => None,
            };
            self.declare(&name, &kind);
            all.push(Statement::Declare { name, kind, init });
            if !self.take(",") {
                break;
            }
        }
        self.expect(";")
    }

    /// The value that a variable is declared with.
    fn initial(&mut self, kind: &Type) -> Result<Expr, String> {
        if !self.take("{") {
            return Ok(self.expression()?.converted(kind));
        }
        let kinds: Vec<Type> = match kind {
            Type::Array(of, count) => vec![(**of).clone(); *count],
            Type::Struct(name) => self.members(name)?.into_iter().map(|(_, kind)| kind).collect(),
            _ => return Err("expected no brace".into()),
        };
        let mut parts = Vec::new();
        for of in &kinds {
            // What is not given is zero.
            let ended = matches!(self.peek(), Token::Sign("}"));
            let part = if ended { Expr::int(0) } else { self.expression()? };
            parts.push(part.converted(of));
            self.take(",");
        }
        self.expect("}")?;
        Ok(Expr::new(Node::Made(parts), kind.clone()))
    }

    fn branch(&mut self, result: &Type) -> Result<Statement, String> {
        self.expect("(")?;
        let test = self.expression()?.into_test();
        self.expect(")")?;
        self.expect("{")?;
        let then = self.block(result)?;
        let mut otherwise = Vec::new();
        if self.keyword("else") {
            if self.keyword("if") {
                otherwise.push(self.branch(result)?);
            } else {
                self.expect("{")?;
                otherwise = self.block(result)?;
            }
        }
        Ok(Statement::If { test, then, otherwise })
    }

    /// `for (i = from; i < to && test; ++i)`
    fn counting(&mut self, result: &Type) -> Result<Statement, String> {
        self.expect("(")?;
        let name = self.name()?;
        let kind = self.variable(&name)?;
        self.expect("=")?;
        let from = self.expression()?.converted(&kind);
        self.expect(";")?;
        let whole = self.expression()?;
        self.expect(";")?;
        self.expect("++")?;
        self.name()?;
        self.expect(")")?;
        let (to, test) = bound(&name, whole).ok_or("a loop that does not count")?;
        self.expect("{")?;
        let body = self.block(result)?;
        Ok(Statement::For { name, to: to.converted(&kind), from, test, body })
    }

    fn assignment(&mut self, all: &mut Vec<Statement>) -> Result<(), String> {
        let place = self.unary()?;
        let op = match self.peek() {
            Token::Sign("=") => None,
            Token::Sign("+=") => Some(Op::Add),
            Token::Sign("-=") => Some(Op::Subtract),
            Token::Sign("*=") => Some(Op::Multiply),
            Token::Sign("/=") => Some(Op::Divide),
            Token::Sign("|=") => Some(Op::BitOr),
            Token::Sign(";") => {
                self.next();
                all.push(Statement::Call(place));
                return Ok(());
            }
            other => return Err(format!("expected an assignment, not {other:?}")),
        };
        self.next();
        let value = self.expression()?.converted(&place.kind);
        self.expect(";")?;
        all.push(Statement::Assign { place, op, value });
        Ok(())
    }
}

/// The bound of a counter, and what else is tested.
fn bound(name: &str, whole: Expr) -> Option<(Expr, Option<Expr>)> {
    match whole.node {
        Node::Binary(Op::Less, counter, to) if counter.root() == Some(name) => Some((*to, None)),
        Node::Binary(Op::And, first, more) => {
            let (to, test) = bound(name, *first)?;
            let more = more.into_test();
            let both = match test {
                None => more,
                Some(test) => {
                    Expr::new(Node::Binary(Op::And, Box::new(test), Box::new(more)), Type::Bool)
                }
            };
            Some((to, Some(both)))
        }
        _ => None,
    }
}

/// Leaves out the declarations of counters: a loop declares its own.
fn without_counters(body: &mut Vec<Statement>) {
    let mut counters = Vec::new();
    super::visit::statements(body, &mut |statement| {
        if let Statement::For { name, .. } = statement {
            counters.push(name.clone());
        }
    });
    super::visit::blocks(body, &mut |block| {
        block.retain(|statement| {
            !matches!(statement, Statement::Declare { name, init: None, .. } if counters.contains(name))
        });
    });
}

/// Makes a struct at once where all of its members are assigned one after the other, in their order, and no member needs
/// another one.
fn made_at_once(body: &mut Vec<Statement>, parser: &Parser) {
    super::visit::blocks(body, &mut |block| {
        let mut at = 0;
        while at < block.len() {
            if let Some((variable, kind, parts)) = members_assigned(&block[at..], parser) {
                let count = parts.len();
                let declared = block[..at].iter().rposition(
                    |s| matches!(s, Statement::Declare { name, init: None, .. } if *name == variable),
                );
                if let Some(declared) = declared {
                    let made = Expr::new(Node::Made(parts), kind.clone());
                    let whole =
                        Statement::Declare { name: variable.clone(), kind, init: Some(made) };
                    block.splice(at..at + count, [whole]);
                    block.remove(declared);
                    at -= 1;
                    // What is only returned needs no name.
                    if let [.., Statement::Declare { init, .. }, Statement::Return(Some(value))] =
                        &mut block[..]
                        && value.node == Node::Variable(variable)
                        && let Some(init) = init.take()
                    {
                        *value = init;
                        block.remove(at);
                    }
                    continue;
                }
            }
            at += 1;
        }
    });
}

/// The assignments of all members of a struct that a block begins with.
fn members_assigned(block: &[Statement], parser: &Parser) -> Option<(String, Type, Vec<Expr>)> {
    let Statement::Assign { place, .. } = block.first()? else { return None };
    let Node::Member(of, _) = &place.node else { return None };
    let (Node::Variable(variable), Type::Struct(name)) = (&of.node, &of.kind) else { return None };
    let members = parser.members(name).ok()?;
    let mut parts = Vec::new();
    for ((member, _), statement) in members.iter().zip(block) {
        let Statement::Assign { place, op: None, value } = statement else { return None };
        let Node::Member(of, found) = &place.node else { return None };
        let other = of.node != Node::Variable(variable.clone()) || found != member;
        if other || super::visit::reads(value, variable) {
            return None;
        }
        parts.push(value.clone());
    }
    (parts.len() == members.len()).then(|| (variable.clone(), Type::Struct(name.clone()), parts))
}
