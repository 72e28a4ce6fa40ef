//! What becomes of a variable after its declaration.

use crate::tree::{Node, Statement, visit};

/// Whether a variable is assigned or written through, wholly or in part.
pub fn is_assigned(body: &[Statement], name: &str) -> bool {
    let mut found = false;
    visit::statements(body, &mut |statement| {
        if let Statement::Assign { place, .. } = statement {
            found |= place.root() == Some(name);
        }
        found |= is_written(statement, name);
    });
    found
}

/// Whether the first thing that is done to a variable is to assign all of it.
pub fn is_overwritten(body: &[Statement], name: &str) -> bool {
    match body.iter().find(|statement| visit::mentions(statement, name)) {
        Some(Statement::Assign { place, op: None, value }) => {
            matches!(place.node, Node::Variable(_)) && !visit::reads(value, name)
        }
        Some(whole @ (Statement::For { body, .. } | Statement::Block(body))) => {
            let tested = visit::own(whole).into_iter().any(|expr| visit::reads(expr, name));
            !tested && is_overwritten(body, name)
        }
        _ => false,
    }
}

/// Whether a part of a variable is assigned, or it is written through, before all of it is assigned.
pub fn needs_value(body: &[Statement], name: &str) -> bool {
    if is_overwritten(body, name) {
        return false;
    }
    let mut found = false;
    visit::statements(body, &mut |statement| {
        if let Statement::Assign { place, op, .. } = statement {
            let whole = matches!(place.node, Node::Variable(_)) && op.is_none();
            found |= place.root() == Some(name) && !whole;
        }
        found |= is_written(statement, name);
    });
    found
}

fn is_written(statement: &Statement, name: &str) -> bool {
    let written = visit::own(statement).into_iter().flat_map(visit::written);
    written.into_iter().any(|place| place.root() == Some(name))
}

/// Whether a variable that is declared without a value is assigned where it may have one.
pub fn is_assigned_again(body: &[Statement], name: &str) -> bool {
    let mut again = false;
    walk(body, name, false, &mut again);
    again
}

/// Walks through statements; whether the variable has a value behind them, `None` where nothing is behind them.
fn walk(body: &[Statement], name: &str, mut assigned: bool, again: &mut bool) -> Option<bool> {
    for statement in body {
        match statement {
            Statement::Assign { place, .. } if place.root() == Some(name) => {
                *again |= assigned;
                assigned = true;
            }
            Statement::If { then, otherwise, .. } => {
                let ends = [then, otherwise].map(|branch| walk(branch, name, assigned, again));
                if ends == [None, None] {
                    return None;
                }
                assigned = ends.into_iter().flatten().any(|end| end);
            }
            Statement::Block(inner) => assigned = walk(inner, name, assigned, again)?,
            Statement::For { body: inner, .. } => {
                // A second time through it.
                let end = walk(inner, name, assigned, again).unwrap_or(assigned);
                walk(inner, name, end, again);
                assigned |= end;
            }
            Statement::Return(_) | Statement::Continue => return None,
            _ => {}
        }
    }
    Some(assigned)
}
