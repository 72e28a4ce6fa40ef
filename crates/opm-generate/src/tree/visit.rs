//! Walks through a tree.

use super::{Code, Expr, Function, Node, Pass, Statement, Type};

/// Every statement, from outside to inside.
pub fn statements(body: &[Statement], see: &mut impl FnMut(&Statement)) {
    for statement in body {
        see(statement);
        match statement {
            Statement::If { then, otherwise, .. } => {
                statements(then, see);
                statements(otherwise, see);
            }
            Statement::For { body, .. } | Statement::Block(body) => statements(body, see),
            _ => {}
        }
    }
}

/// Every list of statements, from inside to outside.
pub fn blocks(body: &mut Vec<Statement>, change: &mut impl FnMut(&mut Vec<Statement>)) {
    for statement in body.iter_mut() {
        match statement {
            Statement::If { then, otherwise, .. } => {
                blocks(then, change);
                blocks(otherwise, change);
            }
            Statement::For { body, .. } | Statement::Block(body) => blocks(body, change),
            _ => {}
        }
    }
    change(body);
}

/// The expressions of a statement itself, not of those inside it.
pub fn own(statement: &Statement) -> Vec<&Expr> {
    match statement {
        Statement::Declare { init, .. } => init.iter().collect(),
        Statement::Assign { place, value, .. } => vec![place, value],
        Statement::Call(call) => vec![call],
        Statement::If { test, .. } => vec![test],
        Statement::For { from, to, test, .. } => [from, to].into_iter().chain(test).collect(),
        Statement::Return(value) => value.iter().collect(),
        Statement::Comment(_) | Statement::Block(_) | Statement::Continue => Vec::new(),
    }
}

/// The parts of an expression.
pub fn parts(expr: &Expr) -> Vec<&Expr> {
    match &expr.node {
        Node::Number(_) | Node::Constant(_) | Node::Infinity | Node::Variable(_) => Vec::new(),
        Node::Member(of, _) | Node::Negative(of) | Node::Not(of) | Node::Cast(of) => vec![of],
        Node::Index(a, b) | Node::Binary(_, a, b) => vec![a, b],
        Node::Choice(a, b, c) => vec![a, b, c],
        Node::Call(_, arguments) => arguments.iter().map(|argument| &argument.value).collect(),
        Node::Made(parts) => parts.iter().collect(),
    }
}

/// An expression and all expressions in it.
pub fn expressions<'a>(expr: &'a Expr, see: &mut impl FnMut(&'a Expr)) {
    see(expr);
    for part in parts(expr) {
        expressions(part, see);
    }
}

/// Whether an expression has a variable.
pub fn reads(expr: &Expr, variable: &str) -> bool {
    let mut found = false;
    expressions(expr, &mut |part| {
        found |= matches!(&part.node, Node::Variable(name) if name == variable);
    });
    found
}

/// The parts of an expression, to change them.
pub fn parts_mut(expr: &mut Expr) -> Vec<&mut Expr> {
    match &mut expr.node {
        Node::Number(_) | Node::Constant(_) | Node::Infinity | Node::Variable(_) => Vec::new(),
        Node::Member(of, _) | Node::Negative(of) | Node::Not(of) | Node::Cast(of) => vec![of],
        Node::Index(a, b) | Node::Binary(_, a, b) => vec![a, b],
        Node::Choice(a, b, c) => vec![a, b, c],
        Node::Call(_, arguments) => {
            arguments.iter_mut().map(|argument| &mut argument.value).collect()
        }
        Node::Made(parts) => parts.iter_mut().collect(),
    }
}

/// The expressions of a statement itself, to change them.
pub fn own_mut(statement: &mut Statement) -> Vec<&mut Expr> {
    match statement {
        Statement::Declare { init, .. } => init.iter_mut().collect(),
        Statement::Assign { place, value, .. } => vec![place, value],
        Statement::Call(call) => vec![call],
        Statement::If { test, .. } => vec![test],
        Statement::For { from, to, test, .. } => [from, to].into_iter().chain(test).collect(),
        Statement::Return(value) => value.iter_mut().collect(),
        Statement::Comment(_) | Statement::Block(_) | Statement::Continue => Vec::new(),
    }
}

/// Whether a statement, or one inside it, has a variable.
pub fn mentions(statement: &Statement, variable: &str) -> bool {
    let mut found = false;
    statements(std::slice::from_ref(statement), &mut |inner| {
        found |= own(inner).into_iter().any(|expr| reads(expr, variable));
    });
    found
}

/// The arguments through which an expression writes.
pub fn written(expr: &Expr) -> Vec<&Expr> {
    let mut found = Vec::new();
    expressions(expr, &mut |part| {
        if let Node::Call(_, arguments) = &part.node {
            found.extend(arguments.iter().filter(|a| a.pass == Pass::Write).map(|a| &a.value));
        }
    });
    found
}

/// Takes out declarations of variables that nothing reads.
pub fn drop_unread(body: &mut Vec<Statement>) {
    loop {
        let mut read = Vec::new();
        let mut declared = 0;
        statements(body, &mut |statement| {
            declared += usize::from(matches!(statement, Statement::Declare { .. }));
            for expr in own(statement) {
                expressions(expr, &mut |part| {
                    if let Node::Variable(name) = &part.node {
                        read.push(name.clone());
                    }
                });
            }
        });
        let before = declared;
        declared = 0;
        blocks(body, &mut |block| {
            block.retain(|one| match one {
                Statement::Declare { name, .. } => read.contains(name),
                _ => true,
            });
            declared += block.iter().filter(|one| matches!(one, Statement::Declare { .. })).count();
        });
        if declared == before {
            return;
        }
    }
}

/// Gives the variables of a function other names, where there is one.
pub fn rename(function: &mut Function, new: &impl Fn(&str) -> Option<String>) {
    let change = |name: &mut String| {
        if let Some(other) = new(name) {
            *name = other;
        }
    };
    for parameter in &mut function.parameters {
        change(&mut parameter.name);
    }
    blocks(&mut function.body, &mut |block| {
        for statement in block {
            if let Statement::Declare { name, .. } | Statement::For { name, .. } = statement {
                change(name);
            }
            for expr in own_mut(statement) {
                rename_in(expr, &change);
            }
        }
    });
}

fn rename_in(expr: &mut Expr, change: &impl Fn(&mut String)) {
    if let Node::Variable(name) = &mut expr.node {
        change(name);
    }
    for part in parts_mut(expr) {
        rename_in(part, change);
    }
}

/// Takes the statements out of a block at the end of another one, where nothing needs the block.
pub fn flatten(body: &mut Vec<Statement>) {
    blocks(body, &mut |block| {
        let returns = matches!(block.last(), Some(Statement::Return(_)));
        let Some(at) = block.len().checked_sub(1 + usize::from(returns)) else { return };
        let Statement::Block(inner) = &block[at] else { return };
        let declared = |name: &str| {
            inner.iter().any(|s| matches!(s, Statement::Declare { name: own, .. } if own == name))
        };
        let clashes = block[..at]
            .iter()
            .any(|s| matches!(s, Statement::Declare { name, .. } if declared(name)));
        let mut read = false;
        if let Some(Statement::Return(Some(value))) = block.last().filter(|_| returns) {
            expressions(value, &mut |part| {
                read |= matches!(&part.node, Node::Variable(name) if declared(name));
            });
        }
        if !clashes && !read {
            let inner = inner.clone();
            block.splice(at..=at, inner);
        }
    });
}

/// Gives functions other names, where there is one.
pub fn rename_functions(code: &mut Code, new: &impl Fn(&str) -> Option<String>) {
    for function in &mut code.functions {
        if let Some(other) = new(&function.name) {
            function.name = other;
        }
        blocks(&mut function.body, &mut |block| {
            for statement in block {
                own_mut(statement).into_iter().for_each(|expr| rename_calls(expr, new));
            }
        });
    }
}

fn rename_calls(expr: &mut Expr, new: &impl Fn(&str) -> Option<String>) {
    if let Node::Call(name, _) = &mut expr.node
        && let Some(other) = new(name)
    {
        *name = other;
    }
    for part in parts_mut(expr) {
        rename_calls(part, new);
    }
}

impl Function {
    /// What is found in all of its expressions.
    fn found(&self, of: impl Fn(&Node) -> Option<&String>) -> Vec<String> {
        let mut found = Vec::new();
        statements(&self.body, &mut |statement| {
            for expr in own(statement) {
                expressions(expr, &mut |part| found.extend(of(&part.node).cloned()));
            }
        });
        found
    }

    /// The functions that it calls.
    pub fn calls(&self) -> Vec<String> {
        self.found(|node| match node {
            Node::Call(name, _) => Some(name),
            _ => None,
        })
    }

    /// The constants that it needs.
    pub fn constants(&self) -> Vec<String> {
        self.found(|node| match node {
            Node::Constant(name) => Some(name),
            _ => None,
        })
    }

    /// The types of its parameters and variables, and of what it gives.
    pub fn types(&self) -> Vec<Type> {
        let mut types: Vec<Type> = self.parameters.iter().map(|p| p.kind.clone()).collect();
        types.push(self.result.clone());
        statements(&self.body, &mut |statement| {
            if let Statement::Declare { kind, .. } = statement {
                types.push(kind.clone());
            }
        });
        types
    }
}
