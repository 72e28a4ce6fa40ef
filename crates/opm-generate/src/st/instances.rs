//! Arrays have a length in structured text: a function that takes arrays of any length is written once for each.

use crate::tree::visit::{own_mut, parts_mut, statements};
use crate::tree::{Code, Expr, Function, Node, Statement, Type};
use std::collections::HashMap;

/// Gives all arrays a length, and leaves the functions that are called, those that are called before those that call them.
pub fn resolve(code: &mut Code) -> Result<(), String> {
    let mut all = Instances { code, known: HashMap::new(), done: Vec::new() };
    let public: Vec<Function> = all.code.functions.iter().filter(|f| f.public).cloned().collect();
    for function in public {
        let lengths = function.parameters.iter().map(|p| match (&p.kind, &*p.name) {
            (Type::Array(_, 0), name) => all.length(name),
            (Type::Array(_, length), _) => Ok(*length),
            _ => Ok(0),
        });
        let lengths = lengths.collect::<Result<Vec<_>, _>>()?;
        all.instance(&function.name, &lengths)?;
    }
    let done = all.done;
    code.functions = done;
    Ok(())
}

struct Instances<'a> {
    code: &'a Code,
    /// The names of functions with the lengths of their parameters, zero for those that are no arrays.
    known: HashMap<(String, Vec<usize>), String>,
    done: Vec<Function>,
}

impl Instances<'_> {
    /// The length of an array of the interface; one where there is nothing.
    fn length(&self, parameter: &str) -> Result<usize, String> {
        let of = match parameter {
            "pose" | "rates" | "accelerations" => "COORDINATES",
            "joints" | "joint_rates" | "previous" => "JOINTS",
            "imaginary" => "IMAGINARY",
            "actuated" | "efforts" => "ACTUATED",
            other => return Err(format!("the array {other} has no length")),
        };
        Ok(self.code.number(of).unwrap_or_default().max(1))
    }

    /// The name of a function for arrays of these lengths.
    fn instance(&mut self, name: &str, lengths: &[usize]) -> Result<String, String> {
        let key = (name.to_owned(), lengths.to_vec());
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        let function = self.code.functions.iter().find(|function| function.name == name);
        let mut function = function.ok_or_else(|| format!("there is no function {name}"))?.clone();
        let others = self.known.keys().filter(|(other, _)| other == name).count();
        if others > 0 {
            function.name = format!("{name}_{}", others + 1);
        }
        self.known.insert(key, function.name.clone());
        let mut arrays: HashMap<String, Type> = HashMap::new();
        for (p, &length) in function.parameters.iter_mut().zip(lengths) {
            if let Type::Array(_, own) = &mut p.kind {
                *own = length;
                arrays.insert(p.name.clone(), p.kind.clone());
            }
        }
        statements(&function.body, &mut |statement| {
            if let Statement::Declare { name, kind: kind @ Type::Array(..), .. } = statement {
                arrays.insert(name.clone(), kind.clone());
            }
        });
        let mut body = std::mem::take(&mut function.body);
        self.body(&mut body, &arrays)?;
        function.body = body;
        self.done.push(function.clone());
        Ok(function.name)
    }

    fn body(
        &mut self,
        body: &mut [Statement],
        arrays: &HashMap<String, Type>,
    ) -> Result<(), String> {
        for statement in body {
            for expr in own_mut(statement) {
                self.expr(expr, arrays)?;
            }
            match statement {
                Statement::If { then, otherwise, .. } => {
                    self.body(then, arrays)?;
                    self.body(otherwise, arrays)?;
                }
                Statement::For { body, .. } | Statement::Block(body) => self.body(body, arrays)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn expr(&mut self, expr: &mut Expr, arrays: &HashMap<String, Type>) -> Result<(), String> {
        for part in parts_mut(expr) {
            self.expr(part, arrays)?;
        }
        if let Node::Variable(name) = &expr.node
            && let Some(kind) = arrays.get(name)
        {
            expr.kind = kind.clone();
        }
        if let Node::Call(name, arguments) = &mut expr.node
            && self.code.functions.iter().any(|function| function.name == *name)
        {
            let lengths = arguments.iter().map(|argument| match argument.value.kind {
                Type::Array(_, length) => length,
                _ => 0,
            });
            let lengths: Vec<usize> = lengths.collect();
            *name = self.instance(name, &lengths)?;
        }
        Ok(())
    }
}
