//! The closed forms, as Rust.

mod expressions;

use crate::text::{camel, commented, literal};
use crate::tree::{
    BUILT_IN, Code, Expr, Function, Node, Op, Parameter, Pass, Statement, Struct, Type, Value,
    flow, visit,
};
use std::fmt::Write;

/// Words that are no names.
const KEYWORDS: [&str; 12] =
    ["as", "in", "let", "loop", "match", "move", "mut", "ref", "type", "use", "where", "box"];

/// The source file of the closed forms.
pub fn module(code: &Code) -> String {
    let mut text = String::new();
    for names in &code.enums {
        text += &commented(&names.comment, "// ", "");
        for entry in &names.entries {
            text += &commented(&entry.comment, "/// ", "");
            // Names of joints may differ in their case alone.
            let _ = writeln!(text, "pub const {}: usize = {};", entry.name, entry.value);
        }
        text += "\n";
    }
    for one in &code.constants {
        text += &commented(&one.comment, "/// ", "");
        let [double, float] = [&one.double, &one.float].map(|number| literal(number));
        let value = match double == float {
            true => double,
            false => format!("by_type({double}, {float})"),
        };
        let _ = writeln!(text, "const {}: Real = {value};\n", constant(&one.name));
    }
    for one in &code.structs {
        text += &structure(one);
    }
    let kind = Type::Struct("geometry".into());
    let _ = write!(
        text,
        "/// The mechanism as it was when this code was written.\n#[allow(clippy::excessive_precision)]\n\
         pub const DEFAULT: Geometry = {};\n\n",
        value(code, &kind, &code.default, 0)
    );
    for one in &code.functions {
        text += &Printer::new(code, one).function();
        text += "\n";
    }
    text.trim_end().to_owned() + "\n"
}

/// The name of a constant.
fn constant(name: &str) -> String {
    name.to_uppercase()
}

fn structure(one: &Struct) -> String {
    let mut text = commented(&one.comment, "/// ", "");
    let arrays = one.members.iter().any(|member| member.kind.is_array());
    let default = if arrays { "" } else { "Default, " };
    let _ = writeln!(
        text,
        "#[derive(Clone, Copy, Debug, {default}PartialEq)]\npub struct {} {{",
        camel(&one.name)
    );
    for member in &one.members {
        text += &commented(&member.comment, "/// ", "    ");
        let _ = writeln!(text, "    pub {}: {},", member.name, kind(&member.kind));
    }
    text + "}\n\n"
}

fn kind(of: &Type) -> String {
    match of {
        Type::Void => "()".into(),
        Type::Bool => "bool".into(),
        Type::Int => "i32".into(),
        Type::Bits => "u32".into(),
        Type::Real => "Real".into(),
        Type::Struct(name) => camel(name),
        Type::Array(of, count) => format!("[{}; {count}]", kind(of)),
    }
}

/// A constant of a type.
fn value(code: &Code, of: &Type, value_of: &Value, depth: usize) -> String {
    let space = "    ".repeat(depth + 1);
    match (of, value_of) {
        (_, Value::Number(number)) if number.is_infinite() => {
            if *number > 0.0 {
                "Real::INFINITY".into()
            } else {
                "Real::NEG_INFINITY".into()
            }
        }
        (_, Value::Number(number)) => format!("{:?}", number + 0.0),
        (Type::Array(of, _), Value::List(parts)) => {
            let parts: Vec<String> =
                parts.iter().map(|part| value(code, of, part, depth + 1)).collect();
            let long = matches!(**of, Type::Struct(_));
            let break_line = if long { format!("\n{space}") } else { " ".into() };
            let joined = parts.join(&format!(",{break_line}"));
            match long {
                true => format!("[\n{space}{joined},\n{}]", "    ".repeat(depth)),
                false => format!("[{joined}]"),
            }
        }
        (Type::Struct(name), Value::List(parts)) => {
            let members = code.members(name);
            let parts: Vec<String> = members
                .iter()
                .zip(parts)
                .map(|(m, part)| format!("{}: {}", m.name, value(code, &m.kind, part, depth + 1)))
                .collect();
            match depth {
                0 => format!(
                    "{} {{\n{space}{},\n}}",
                    camel(name),
                    parts.join(&format!(",\n{space}"))
                ),
                _ => format!("{} {{ {} }}", camel(name), parts.join(", ")),
            }
        }
        _ => String::new(),
    }
}

/// Prints one function.
struct Printer<'a> {
    code: &'a Code,
    function: Function,
}

impl<'a> Printer<'a> {
    fn new(code: &'a Code, function: &Function) -> Self {
        let mut function = function.clone();
        let taken = |name: &str| {
            KEYWORDS.contains(&name)
                || BUILT_IN.contains(&name)
                || code.functions.iter().any(|other| other.name == name)
        };
        visit::rename(&mut function, &|name| taken(name).then(|| format!("{name}_")));
        Self { code, function }
    }

    fn function(&self) -> String {
        let function = &self.function;
        let parameters: Vec<String> =
            function.parameters.iter().map(|p| self.parameter(p)).collect();
        let result = match function.result {
            Type::Void => String::new(),
            ref result => format!(" -> {}", kind(result)),
        };
        let mut text = commented(&function.comment, "/// ", "");
        let public = if function.public { "pub(crate) " } else { "" };
        if parameters.len() > 7 {
            text += "#[allow(clippy::too_many_arguments)]\n";
        }
        let _ =
            writeln!(text, "{public}fn {}({}){result} {{", function.name, parameters.join(", "));
        let last = function.body.len().saturating_sub(1);
        for (number, statement) in function.body.iter().enumerate() {
            match statement {
                Statement::Return(Some(value)) if number == last => {
                    let _ = writeln!(text, "    {}", self.expr(value));
                }
                _ => self.statement(statement, &function.body[number + 1..], 1, &mut text),
            }
        }
        text + "}\n"
    }

    fn parameter(&self, p: &Parameter) -> String {
        let assigned = flow::is_assigned(&self.function.body, &p.name);
        let used = self.function.body.iter().any(|s| visit::mentions(s, &p.name));
        let name = if used { p.name.clone() } else { format!("_{}", p.name) };
        match (&p.kind, p.pass) {
            (Type::Array(of, _), Pass::Write) => format!("{name}: &mut [{}]", kind(of)),
            (Type::Array(of, _), _) => format!("{name}: &[{}]", kind(of)),
            (of, Pass::Read) => format!("{name}: &{}", kind(of)),
            (of, Pass::Write) => format!("{name}: &mut {}", kind(of)),
            (of, Pass::Value) if assigned => format!("mut {name}: {}", kind(of)),
            (of, Pass::Value) => format!("{name}: {}", kind(of)),
        }
    }

    fn block(&self, body: &[Statement], depth: usize, text: &mut String) {
        for (number, statement) in body.iter().enumerate() {
            self.statement(statement, &body[number + 1..], depth, text);
        }
    }

    fn statement(&self, one: &Statement, rest: &[Statement], depth: usize, text: &mut String) {
        let space = "    ".repeat(depth);
        let _ = match one {
            Statement::Comment(comment) => {
                *text += &commented(comment, "// ", &space);
                Ok(())
            }
            Statement::Declare { name, kind: of, init } => {
                let written = self.declaration(name, of, init.as_ref(), rest);
                writeln!(text, "{space}let {written};")
            }
            Statement::Assign { place, op, value } => {
                let op = op.map_or("", Op::in_c);
                writeln!(text, "{space}{} {op}= {};", self.expr(place), self.expr(value))
            }
            Statement::Call(call) => writeln!(text, "{space}{};", self.expr(call)),
            Statement::If { test, then, otherwise } => {
                let _ = writeln!(text, "{space}if {} {{", self.expr(test));
                self.block(then, depth + 1, text);
                if !otherwise.is_empty() {
                    let _ = writeln!(text, "{space}}} else {{");
                    self.block(otherwise, depth + 1, text);
                }
                writeln!(text, "{space}}}")
            }
            Statement::For { name, from, to, test, body, .. } => {
                let used = body.iter().any(|s| visit::mentions(s, name));
                let counter = if used { name } else { "_" };
                let _ = writeln!(
                    text,
                    "{space}for {counter} in {}..{} {{",
                    self.expr(from),
                    self.expr(to)
                );
                if let Some(test) = test {
                    let test = match &test.node {
                        Node::Not(of) => self.expr(of),
                        _ => format!("!({})", self.expr(test)),
                    };
                    let _ = writeln!(
                        text,
                        "{space}    if {test} {{\n{space}        break;\n{space}    }}"
                    );
                }
                self.block(body, depth + 1, text);
                writeln!(text, "{space}}}")
            }
            Statement::Block(body) => {
                let _ = writeln!(text, "{space}{{");
                self.block(body, depth + 1, text);
                writeln!(text, "{space}}}")
            }
            Statement::Return(None) => writeln!(text, "{space}return;"),
            Statement::Return(Some(value)) => writeln!(text, "{space}return {};", self.expr(value)),
            Statement::Continue => writeln!(text, "{space}continue;"),
        };
    }

    /// A declaration without `let`.
    fn declaration(
        &self,
        name: &str,
        of: &Type,
        init: Option<&Expr>,
        rest: &[Statement],
    ) -> String {
        let changed = |declared: &str| match flow::is_assigned(rest, name) {
            true => format!("mut {declared}"),
            false => declared.to_owned(),
        };
        let init = init.filter(|_| !flow::is_overwritten(rest, name));
        match (init, of) {
            (Some(init), Type::Struct(_)) => format!("{} = {}", changed(name), self.expr(init)),
            (Some(init), of) => format!("{}: {} = {}", changed(name), kind(of), self.expr(init)),
            (None, Type::Array(of, count)) => {
                let zero = match &**of {
                    Type::Struct(name) => format!("{}::default()", camel(name)),
                    Type::Real => "0.0".into(),
                    _ => "0".into(),
                };
                format!("mut {name}: [{}; {count}] = [{zero}; {count}]", kind(of))
            }
            (None, Type::Struct(of)) if flow::needs_value(rest, name) => {
                format!("mut {name} = {}::default()", camel(of))
            }
            (None, of) if flow::needs_value(rest, name) => {
                let zero = if *of == Type::Real { "0.0" } else { "0" };
                format!("mut {name}: {} = {zero}", kind(of))
            }
            (None, of) => {
                let again = if flow::is_assigned_again(rest, name) { "mut " } else { "" };
                format!("{again}{name}: {}", kind(of))
            }
        }
    }
}
