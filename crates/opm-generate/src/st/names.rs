//! Names: structured text does not tell large letters from small ones, and declares the variables of a function in one
//! place.

use crate::tree::visit::{own_mut, parts_mut};
use crate::tree::{Code, Expr, Function, Node, Pass, Statement, Type, flow};
use std::collections::{HashMap, HashSet};

/// Words that are no names, here or in a controller, functions of the standard, and what the printer declares itself.
const RESERVED: [&str; 67] = [
    "abstract",
    "action",
    "add",
    "and",
    "any",
    "array",
    "at",
    "by",
    "case",
    "class",
    "constant",
    "ct",
    "date",
    "div",
    "do",
    "done",
    "dt",
    "else",
    "elsif",
    "exit",
    "final",
    "find",
    "for",
    "from",
    "function",
    "if",
    "ignored",
    "insert",
    "int",
    "interval",
    "left",
    "len",
    "limit",
    "ln",
    "log",
    "max",
    "method",
    "min",
    "mod",
    "move",
    "mul",
    "mux",
    "not",
    "null",
    "of",
    "on",
    "or",
    "overlap",
    "pointer",
    "priority",
    "real",
    "ref",
    "reference",
    "repeat",
    "result",
    "return",
    "right",
    "sel",
    "step",
    "sub",
    "task",
    "time",
    "to",
    "type",
    "until",
    "var",
    "with",
];

/// An identifier: no two underscores follow each other, and none is at the end.
pub fn symbol(name: &str) -> String {
    let words: Vec<&str> = name.split('_').filter(|word| !word.is_empty()).collect();
    words.join("_")
}

/// Gives all variables of a function, and all members of a struct, names that are allowed and differ.
pub fn unique(code: &mut Code) {
    let mut members: HashMap<(String, String), String> = HashMap::new();
    for one in &mut code.structs {
        let mut taken = HashSet::new();
        for member in &mut one.members {
            let name = fresh(&member.name, &mut taken);
            members.insert((one.name.clone(), member.name.clone()), name.clone());
            member.name = name;
        }
    }
    for function in &mut code.functions {
        Names::of(&members).function(function);
    }
}

/// A name that is not taken; it is taken then.
fn fresh(name: &str, taken: &mut HashSet<String>) -> String {
    let plain = symbol(name);
    let plain = match &*plain.to_lowercase() {
        "at" => "here".to_owned(),
        reserved if RESERVED.contains(&reserved) => format!("{plain}_value"),
        _ => plain,
    };
    let mut found = plain.clone();
    let mut number = 1;
    while !taken.insert(found.to_lowercase()) {
        number += 1;
        found = format!("{plain}_{number}");
    }
    found
}

/// The names of a function while it is walked through.
struct Names<'a> {
    members: &'a HashMap<(String, String), String>,
    taken: HashSet<String>,
    /// What variables of the blocks around are called.
    scopes: Vec<Vec<(String, String, Type)>>,
    /// Variables of blocks that have ended: others of their name and type can be the same.
    free: Vec<(String, String, Type)>,
}

impl<'a> Names<'a> {
    fn of(members: &'a HashMap<(String, String), String>) -> Self {
        Self { members, taken: HashSet::new(), scopes: vec![Vec::new()], free: Vec::new() }
    }

    fn function(&mut self, function: &mut Function) {
        let mut copies = Vec::new();
        for p in &mut function.parameters {
            let name = fresh(&p.name, &mut self.taken);
            let known = (p.name.clone(), name.clone(), p.kind.clone());
            self.scopes[0].push(known);
            p.name = name;
        }
        // What is given cannot be changed; its copy can.
        for p in &function.parameters {
            let old = self.scopes[0].iter().position(|(_, name, _)| *name == p.name);
            let Some(old) = old.filter(|_| p.pass == Pass::Value) else { continue };
            if flow::is_assigned(&function.body, &self.scopes[0][old].0) {
                let own = fresh(&format!("own_{}", p.name), &mut self.taken);
                self.scopes[0][old].1.clone_from(&own);
                let init = Some(Expr::variable(&p.name, p.kind.clone()));
                copies.push(Statement::Declare { name: own, kind: p.kind.clone(), init });
            }
        }
        self.block(&mut function.body);
        function.body.splice(0..0, copies);
    }

    fn block(&mut self, body: &mut [Statement]) {
        self.scopes.push(Vec::new());
        for statement in body {
            self.statement(statement);
        }
        let ended = self.scopes.pop().unwrap_or_default();
        self.free.extend(ended);
    }

    fn statement(&mut self, statement: &mut Statement) {
        match statement {
            Statement::Declare { name, kind, init } => {
                if let Some(init) = init {
                    self.expr(init);
                }
                self.declare(name, kind);
            }
            Statement::For { name, from, to, test, body } => {
                self.expr(from);
                self.expr(to);
                self.scopes.push(Vec::new());
                self.declare(name, &from.kind.clone());
                if let Some(test) = test {
                    self.expr(test);
                }
                self.block(body);
                let ended = self.scopes.pop().unwrap_or_default();
                self.free.extend(ended);
            }
            Statement::If { test, then, otherwise } => {
                self.expr(test);
                self.block(then);
                self.block(otherwise);
            }
            Statement::Block(body) => self.block(body),
            other => own_mut(other).into_iter().for_each(|expr| self.expr(expr)),
        }
    }

    fn declare(&mut self, name: &mut String, kind: &Type) {
        let again = self.free.iter().position(|(old, _, of)| old == name && of == kind);
        let found = match again {
            Some(again) => self.free.swap_remove(again).1,
            None => fresh(name, &mut self.taken),
        };
        let known = (name.clone(), found.clone(), kind.clone());
        if let Some(scope) = self.scopes.last_mut() {
            scope.push(known);
        }
        *name = found;
    }

    fn expr(&self, expr: &mut Expr) {
        match &mut expr.node {
            Node::Variable(name) => {
                let known = self.scopes.iter().rev().flat_map(|scope| scope.iter().rev());
                if let Some((_, new, _)) = known.into_iter().find(|(old, ..)| old == name) {
                    name.clone_from(new);
                }
            }
            Node::Member(of, name) => {
                if let Type::Struct(kind) = &of.kind
                    && let Some(new) = self.members.get(&(kind.clone(), name.clone()))
                {
                    name.clone_from(new);
                }
            }
            _ => {}
        }
        for part in parts_mut(expr) {
            self.expr(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_allowed_and_differ() {
        assert_eq!(symbol("m3_RRR__new_"), "m3_RRR_new");
        let mut taken = HashSet::new();
        let all = ["at", "S1", "s1", "Left", "a__b"].map(|name| fresh(name, &mut taken));
        assert_eq!(all, ["here", "S1", "s1_2", "Left_value", "a_b"]);
    }
}
