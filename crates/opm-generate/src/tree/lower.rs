//! Simpler forms for languages whose expressions can do less than those of C.

use super::visit::{own_mut, parts_mut, written};
use super::{Code, Expr, Function, Node, Op, Statement, Type};

/// What a language has.
#[derive(Clone, Copy, Debug)]
pub struct Has {
    /// `test ? a : b` in expressions.
    pub choices: bool,
}

/// Gives every call that writes a statement of its own, and every choice, where the language has none.
pub fn lower(code: &mut Code, has: Has) {
    for function in &mut code.functions {
        let mut taken: Vec<String> = function.parameters.iter().map(|p| p.name.clone()).collect();
        super::visit::statements(&function.body, &mut |statement| {
            if let Statement::Declare { name, .. } | Statement::For { name, .. } = statement {
                taken.push(name.clone());
            }
        });
        let mut lowering = Lowering { has, taken };
        let Function { body, .. } = function;
        *body = lowering.block(std::mem::take(body));
    }
}

struct Lowering {
    has: Has,
    /// The names of the function's variables.
    taken: Vec<String>,
}

impl Lowering {
    fn block(&mut self, body: Vec<Statement>) -> Vec<Statement> {
        let mut all = Vec::new();
        for statement in body {
            self.statement(statement, &mut all);
        }
        all
    }

    fn statement(&mut self, mut statement: Statement, all: &mut Vec<Statement>) {
        match &mut statement {
            Statement::If { then, otherwise, .. } => {
                *then = self.block(std::mem::take(then));
                *otherwise = self.block(std::mem::take(otherwise));
            }
            Statement::For { body, .. } | Statement::Block(body) => {
                *body = self.block(std::mem::take(body));
            }
            _ => {}
        }
        // A call that is a statement, or all of a value, may write.
        let may_write = matches!(
            statement,
            Statement::Call(_) | Statement::Declare { .. } | Statement::Assign { op: None, .. }
        );
        // The bounds of a loop, and what it tests each time, have no such calls.
        if !matches!(statement, Statement::For { .. }) {
            for expr in own_mut(&mut statement) {
                match &mut expr.node {
                    Node::Call(_, arguments) if may_write => {
                        for argument in arguments {
                            self.expr(&mut argument.value, all);
                        }
                    }
                    _ => self.expr(expr, all),
                }
            }
        }
        all.push(statement);
    }

    fn expr(&mut self, expr: &mut Expr, before: &mut Vec<Statement>) {
        match &mut expr.node {
            Node::Binary(op @ (Op::Or | Op::And), a, b) if self.is_special(b) => {
                let op = *op;
                self.expr(a, before);
                let name = self.fresh("failed");
                let found = Expr::variable(&name, Type::Bool);
                let (first, mut second) = ((**a).clone(), (**b).clone());
                let mut inner = Vec::new();
                self.expr(&mut second, &mut inner);
                inner.push(Statement::Assign { place: found.clone(), op: None, value: second });
                let undecided = match op {
                    Op::Or => Expr::new(Node::Not(Box::new(found.clone())), Type::Bool),
                    _ => found.clone(),
                };
                before.push(Statement::Declare { name, kind: Type::Bool, init: Some(first) });
                before.push(Statement::If { test: undecided, then: inner, otherwise: Vec::new() });
                *expr = found;
            }
            Node::Choice(test, a, b) if !self.has.choices => {
                self.expr(test, before);
                let name = self.fresh("chosen");
                let (place, test) = (Expr::variable(&name, expr.kind.clone()), (**test).clone());
                let [then, otherwise] = [a, b].map(|part| {
                    let mut value = (**part).clone();
                    let mut inner = Vec::new();
                    self.expr(&mut value, &mut inner);
                    inner.push(Statement::Assign { place: place.clone(), op: None, value });
                    inner
                });
                before.push(Statement::Declare { name, kind: place.kind.clone(), init: None });
                before.push(Statement::If { test, then, otherwise });
                *expr = place;
            }
            _ => {
                for part in parts_mut(expr) {
                    self.expr(part, before);
                }
                let writes = matches!(&expr.node, Node::Call(_, arguments)
                    if arguments.iter().any(|a| a.pass == super::Pass::Write));
                if writes {
                    let name = self.fresh("status");
                    let found = Expr::variable(&name, expr.kind.clone());
                    let init = Some(std::mem::replace(expr, found));
                    before.push(Statement::Declare { name, kind: expr.kind.clone(), init });
                }
            }
        }
    }

    /// Whether an expression needs statements before it.
    fn is_special(&self, expr: &Expr) -> bool {
        let mut choices = false;
        super::visit::expressions(expr, &mut |part| {
            choices |= matches!(part.node, Node::Choice(..));
        });
        !written(expr).is_empty() || (choices && !self.has.choices)
    }

    fn fresh(&mut self, word: &str) -> String {
        let mut name = word.to_owned();
        let mut number = 1;
        while self.taken.contains(&name) {
            number += 1;
            name = format!("{word}_{number}");
        }
        self.taken.push(name.clone());
        name
    }
}
