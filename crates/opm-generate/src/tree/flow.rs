//! What becomes of a variable after its declaration, and of a parameter that is written.

use super::{Expr, Function, Node, Parameter, Statement, Type, visit};

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

/// Whether a parameter that is written has a value before that is kept: a part of it is written, or it is read, or nothing
/// is written to it where the function succeeds.
pub fn is_kept(function: &Function, parameter: &Parameter) -> bool {
    if matches!(parameter.kind, Type::Struct(_) | Type::Array(..))
        && is_partial(function, parameter)
    {
        return true;
    }
    if parameter.kind.is_array() {
        return true;
    }
    let mut kept = false;
    let end = written_behind(&function.body, &parameter.name, false, &mut kept);
    kept || (function.result == Type::Void && end == Some(false))
}

/// Whether there is an assignment of a part.
fn is_partial(function: &Function, parameter: &Parameter) -> bool {
    let mut partial = false;
    visit::statements(&function.body, &mut |statement| {
        if let Statement::Assign { place, .. } = statement {
            partial |=
                place.root() == Some(&parameter.name) && !matches!(place.node, Node::Variable(_));
        }
        for place in visit::own(statement).into_iter().flat_map(visit::written) {
            partial |= place.root() == Some(&parameter.name);
        }
    });
    partial
}

/// Walks through statements: whether all is written behind them, `None` where nothing is behind them.
fn written_behind(
    body: &[Statement],
    name: &str,
    mut written: bool,
    kept: &mut bool,
) -> Option<bool> {
    for statement in body {
        let reads = |expr: &Expr| visit::reads(expr, name);
        match statement {
            Statement::Assign { place, op, value } if place.root() == Some(name) => {
                *kept |= !written && (reads(value) || op.is_some());
                written = true;
            }
            Statement::If { test, then, otherwise } => {
                *kept |= !written && reads(test);
                let ends = [then, otherwise].map(|way| written_behind(way, name, written, kept));
                written = ends.into_iter().flatten().all(|end| end);
                if ends == [None, None] {
                    return None;
                }
            }
            Statement::Block(inner) => written = written_behind(inner, name, written, kept)?,
            Statement::For { body, .. } => {
                written_behind(body, name, written, kept);
            }
            Statement::Return(value) => {
                *kept |= !written && value.as_ref().is_none_or(may_be_zero);
                return None;
            }
            other => {
                let mut all = visit::own(other).into_iter();
                // A call writes it.
                if visit::own(other)
                    .into_iter()
                    .flat_map(visit::written)
                    .any(|p| p.root() == Some(name))
                {
                    written = true;
                } else {
                    *kept |= !written && all.any(reads);
                }
            }
        }
    }
    Some(written)
}

/// Whether a status may be zero: it is, or it is a variable, or the answer of a test.
pub fn may_be_zero(status: &Expr) -> bool {
    match &status.node {
        Node::Number(number) => number == "0",
        Node::Variable(_) | Node::Cast(_) => true,
        _ => false,
    }
}
