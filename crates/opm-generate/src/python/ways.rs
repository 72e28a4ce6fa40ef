//! What is known of a function before it is printed: whether poses leave it early, and what is the same for all poses.

use crate::tree::flow::may_be_zero;
use crate::tree::{Expr, Function, Node, Statement, Type, visit};

/// The ways through a function.
pub struct Ways {
    /// Whether there is a `return` that is not its last statement.
    pub returns_early: bool,
    /// Whether it may succeed there: what is written behind it must not change what was.
    pub succeeds_early: bool,
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
        let mut succeeds = false;
        for statement in &function.body[..function.body.len() - usize::from(last)] {
            visit::statements(std::slice::from_ref(statement), &mut |inner| {
                if let Statement::Return(Some(value)) = inner {
                    succeeds |= may_be_zero(value) && !matches!(value.node, Node::Variable(_));
                }
            });
        }
        let whole = |kind: &Type| {
            *kind == Type::Int || matches!(kind, Type::Array(of, _) if **of == Type::Int)
        };
        let parameters = function.parameters.iter().filter(|p| whole(&p.kind));
        let mut ways = Self {
            returns_early: returns > usize::from(last),
            succeeds_early: succeeds,
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
