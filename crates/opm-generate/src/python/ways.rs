//! What is known of a function before it is printed: whether poses leave it early, and what is the same for all poses.

use crate::tree::{Expr, Function, Node, Parameter, Statement, Type, visit};

/// The ways through a function.
pub struct Ways {
    /// Whether there is a `return` that is not its last statement.
    pub returns_early: bool,
    /// Whole numbers that are the same for all poses.
    uniform: Vec<String>,
}

impl Ways {
    pub fn new(function: &Function) -> Self {
        let mut returns = 0;
        let mut assigned = Vec::new();
        visit::statements(&function.body, &mut |statement| {
            returns += usize::from(matches!(statement, Statement::Return(_)));
            if let Statement::Assign { place, .. } = statement {
                assigned.extend(place.root().map(str::to_owned));
            }
            let written = visit::own(statement).into_iter().flat_map(visit::written);
            assigned.extend(written.filter_map(|place| place.root().map(str::to_owned)));
        });
        let last = matches!(function.body.last(), Some(Statement::Return(_)));
        let whole = |kind: &Type| {
            *kind == Type::Int || matches!(kind, Type::Array(of, _) if **of == Type::Int)
        };
        let parameters = function.parameters.iter().filter(|p| whole(&p.kind));
        let mut ways = Self {
            returns_early: returns > usize::from(last),
            uniform: parameters.map(|p| p.name.clone()).collect(),
        };
        let mut found = Vec::new();
        visit::statements(&function.body, &mut |statement| match statement {
            Statement::For { name, .. } => found.push(name.clone()),
            Statement::Declare { name, kind, init: Some(init) }
                if whole(kind) && !assigned.contains(name) && visit::written(init).is_empty() =>
            {
                found.push(name.clone());
            }
            _ => {}
        });
        ways.uniform.extend(found);
        ways
    }

    /// Whether an index is the same for all poses.
    pub fn is_uniform(&self, index: &Expr) -> bool {
        let mut uniform = true;
        visit::expressions(index, &mut |part| {
            if let Node::Variable(name) = &part.node {
                uniform &= self.uniform.contains(name);
            }
        });
        uniform
    }
}

/// Whether a parameter that is written has a value before that is kept: a part of it is written, or it is read, or nothing
/// is written to it where the function succeeds.
pub fn is_kept(function: &Function, parameter: &Parameter) -> bool {
    if matches!(parameter.kind, Type::Struct(_) | Type::Array(..)) && is_partial(function, parameter)
    {
        return true;
    }
    if parameter.kind.is_array() {
        return true;
    }
    let mut kept = false;
    let end = walk(&function.body, &parameter.name, false, &mut kept);
    kept || (function.result == Type::Void && end == Some(false))
}

/// Whether there is an assignment of a part.
fn is_partial(function: &Function, parameter: &Parameter) -> bool {
    let mut partial = false;
    visit::statements(&function.body, &mut |statement| {
        if let Statement::Assign { place, .. } = statement {
            partial |= place.root() == Some(&parameter.name)
                && !matches!(place.node, Node::Variable(_));
        }
        for place in visit::own(statement).into_iter().flat_map(visit::written) {
            partial |= place.root() == Some(&parameter.name);
        }
    });
    partial
}

/// Walks through statements: whether all is written behind them, `None` where nothing is behind them.
fn walk(body: &[Statement], name: &str, mut written: bool, kept: &mut bool) -> Option<bool> {
    for statement in body {
        let reads = |expr: &Expr| visit::reads(expr, name);
        match statement {
            Statement::Assign { place, op, value } if place.root() == Some(name) => {
                *kept |= !written && (reads(value) || op.is_some());
                written = true;
            }
            Statement::If { test, then, otherwise } => {
                *kept |= !written && reads(test);
                let ends = [then, otherwise].map(|way| walk(way, name, written, kept));
                written = ends.into_iter().flatten().all(|end| end);
                if ends == [None, None] {
                    return None;
                }
            }
            Statement::Block(inner) => written = walk(inner, name, written, kept)?,
            Statement::For { body, .. } => {
                walk(body, name, written, kept);
            }
            Statement::Return(value) => {
                let zero = matches!(value, Some(value) if matches!(&value.node, Node::Number(n) if n == "0"));
                let variable = matches!(value, Some(value) if matches!(value.node, Node::Variable(_)));
                *kept |= !written && (zero || variable || value.is_none());
                return None;
            }
            other => {
                let mut all = visit::own(other).into_iter();
                // A call writes it.
                if visit::own(other).into_iter().flat_map(visit::written).any(|p| p.root() == Some(name)) {
                    written = true;
                } else {
                    *kept |= !written && all.any(reads);
                }
            }
        }
    }
    Some(written)
}
