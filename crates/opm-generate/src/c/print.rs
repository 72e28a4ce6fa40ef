//! The closed forms, as C.

mod expressions;

use super::symbol;
use crate::tree::{
    Code, Constant, Enum, Expr, Function, Inline, Node, Parameter, Pass, Statement, Struct, Type,
    Value, flow, visit,
};
use std::fmt::Write;

/// The longest line.
const WIDTH: usize = 118;

/// What public arrays of a length are declared with.
const LENGTHS: [(&str, &str); 5] = [
    ("jacobian", "NAME_JOINTS * NAME_COORDINATES"),
    ("twist", "6 * NAME_COORDINATES"),
    ("deficits", "2 * NAME_LEGS"),
    ("joint", "NAME_JOINTS"),
    ("imaginary", "NAME_IMAGINARY"),
];

/// Prints the code of a mechanism, whose name all symbols begin with.
pub struct Printer<'a> {
    pub code: &'a Code,
    pub name: &'a str,
    /// The type of numbers: that of the header, or its short name in the source file.
    pub real: String,
}

impl Printer<'_> {
    /// A comment; symbols get their prefix.
    pub fn comment(&self, text: &str, space: &str) -> String {
        if text.is_empty() {
            return String::new();
        }
        let text = symbol(text, self.name);
        let mut lines = String::new();
        let mut line = format!("{space}/*");
        for word in text.split_whitespace() {
            if line.len() + 1 + word.len() > WIDTH + 4 {
                let _ = writeln!(lines, "{line}");
                line = format!("{space}  ");
            }
            let _ = write!(line, " {word}");
        }
        format!("{lines}{line} */\n")
    }

    fn symbol(&self, name: &str) -> String {
        format!("{}_{name}", self.name)
    }

    fn kind(&self, of: &Type) -> String {
        match of {
            Type::Void => "void".into(),
            Type::Bool | Type::Int => "int".into(),
            Type::Bits => "unsigned".into(),
            Type::Real => self.real.clone(),
            Type::Struct(name) => self.symbol(name),
            Type::Array(of, _) => self.kind(of),
        }
    }

    /// A name with the number of its elements.
    fn declarator(&self, name: &str, of: &Type, is_public: bool) -> String {
        let known = LENGTHS.iter().find(|(array, _)| is_public && *array == name);
        match (of, known) {
            (Type::Array(_, 0), _) => format!("{name}[]"),
            (Type::Array(..), Some((_, length))) => {
                format!("{name}[{}]", symbol(length, self.name))
            }
            (Type::Array(_, length), None) => format!("{name}[{length}]"),
            _ => name.to_owned(),
        }
    }

    /// Names of numbers.
    pub fn names(&self, names: &Enum) -> String {
        let mut text = self.comment(&names.comment, "");
        text += "enum {\n";
        let last = names.entries.len().saturating_sub(1);
        for (number, entry) in names.entries.iter().enumerate() {
            let comma = if number < last { "," } else { "" };
            let note = self.comment(&entry.comment, " ");
            let note = if note.is_empty() { "\n" } else { &note };
            let _ = write!(text, "    {} = {}{comma}{note}", self.symbol(&entry.name), entry.value);
        }
        text + "};\n\n"
    }

    /// A constant.
    pub fn constant(&self, Constant { name, comment, double, float }: &Constant) -> String {
        let value = match double == float {
            true => double.clone(),
            false => format!("(sizeof(real) == sizeof(float) ? {float} : {double})"),
        };
        let (comment, name) = (self.comment(comment, ""), self.symbol(name));
        format!("{comment}#define {name} ((real){value})\n\n")
    }

    /// The definition of a struct: in one line, where that is not too long and has no comments.
    pub fn structure(&self, one: &Struct) -> String {
        let mut lines: Vec<String> = Vec::new();
        let mut before = None;
        let is_long = one.members.iter().any(|m| !m.comment.is_empty());
        for member in &one.members {
            let declarator = self.declarator(&member.name, &member.kind, true);
            match (lines.last_mut(), before) {
                (Some(line), Some(kind)) if kind == &member.kind && !is_long => {
                    let _ = write!(line, ", {declarator}");
                }
                _ => lines.push(format!("{} {declarator}", self.kind(&member.kind))),
            }
            before = Some(&member.kind);
        }
        let (comment, name) = (self.comment(&one.comment, ""), self.symbol(&one.name));
        let whole = format!("typedef struct {{ {}; }} {name};\n\n", lines.join("; "));
        if !is_long && whole.len() <= WIDTH {
            return comment + &whole;
        }
        let mut text = comment + "typedef struct {\n";
        for member in &one.members {
            text += &self.comment(&member.comment, "    ");
            let declarator = self.declarator(&member.name, &member.kind, true);
            let _ = writeln!(text, "    {} {declarator};", self.kind(&member.kind));
        }
        text + &format!("}} {name};\n\n")
    }

    /// The mechanism's own geometry.
    pub fn default_value(&self, geometry: &Struct) -> String {
        let Value::List(values) = &self.code.default else { return String::new() };
        let mut text = format!("const {0}_geometry {0}_default = {{\n", self.name);
        for (member, value) in geometry.members.iter().zip(values) {
            let rows = match (&member.kind, value) {
                (Type::Array(of, _), Value::List(rows)) if matches!(**of, Type::Struct(_)) => rows,
                _ => {
                    let _ = writeln!(text, "    /* {} */\n    {},", member.name, numbers(value));
                    continue;
                }
            };
            let _ = writeln!(text, "    /* {} */\n    {{", member.name);
            let tag = format!("{}_", member.name.to_uppercase());
            let names = self.code.enums.iter().map(|names| &names.entries);
            let names = names.filter(|all| all.first().is_some_and(|e| e.name.starts_with(&tag)));
            let names: Vec<_> = names.flatten().collect();
            for (place, row) in rows.iter().enumerate() {
                let comma = if place + 1 < rows.len() { "," } else { "" };
                let note = names.get(place).and_then(|entry| entry.comment.rsplit_once(", "));
                let note = note.map_or("", |(name, _)| name);
                let _ = writeln!(text, "        {} /* {note} */{comma}", numbers(row));
            }
            text += "    },\n";
        }
        text + "};\n\n"
    }

    /// The beginning of a function, up to its parameters.
    fn head(&self, function: &Function, geometry: &str) -> String {
        let inline = match (function.public, function.inline) {
            (true, _) => String::new(),
            (false, Inline::No) => "static ".into(),
            (false, Inline::Short) => "static inline ".into(),
            (false, Inline::Always) => format!("static {} ", self.symbol("INLINE")),
        };
        let parameter = |p: &Parameter| {
            let constant = if p.pass == Pass::Read { "const " } else { "" };
            let pointer = if is_pointer(p) { "*" } else { "" };
            let name = if p.kind == Type::Struct("geometry".into()) { geometry } else { &p.name };
            let declarator = self.declarator(name, &p.kind, function.public);
            format!("{constant}{} {pointer}{declarator}", self.kind(&p.kind))
        };
        let parameters: Vec<String> = function.parameters.iter().map(parameter).collect();
        let (result, name) = (self.kind(&function.result), self.symbol(&function.name));
        let begin = format!("{inline}{result} {name}(");
        wrapped(&format!("{begin}{})", parameters.join(", ")), begin.len().min(20))
    }

    /// The declaration of a function of the interface.
    pub fn declaration(&self, function: &Function) -> String {
        let comment = self.comment(&function.comment, "");
        format!("{comment}{};\n", self.head(function, "geometry"))
    }

    /// A function.
    pub fn function(&self, function: &Function) -> String {
        let mut text = String::new();
        if !function.public {
            text += &self.comment(&function.comment, "");
        }
        let _ = writeln!(text, "{}\n{{", self.head(function, "g"));
        let of_function = Body { printer: self, function };
        for p in &function.parameters {
            if !function.body.iter().any(|one| visit::mentions(one, &p.name)) {
                let _ = writeln!(text, "    (void){};", p.name);
            }
        }
        of_function.block(&function.body, 1, &mut text);
        text + "}\n\n"
    }
}

/// Whether a parameter is a pointer to one thing.
fn is_pointer(p: &Parameter) -> bool {
    p.pass != Pass::Value && !p.kind.is_array()
}

/// Numbers in braces.
fn numbers(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_infinite() => {
            format!("R({}INFINITY)", if *number < 0.0 { "-" } else { "" })
        }
        Value::Number(number) => format!("R({number:?})"),
        Value::List(parts) => {
            let parts: Vec<String> = parts.iter().map(numbers).collect();
            format!("{{ {} }}", parts.join(", "))
        }
    }
}

/// A statement in lines that are not too long: it is broken where the fewest brackets are open.
fn wrapped(line: &str, indent: usize) -> String {
    if line.len() <= WIDTH {
        return line.to_owned();
    }
    let (mut depth, mut best) = (0, None);
    let letters = line.as_bytes();
    for (at, letter) in letters.iter().enumerate().take(WIDTH) {
        match letter {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            b' ' if at > indent + 8 => {
                let after = &line[at + 1..];
                let comma = letters[at - 1] == b',';
                let operator = ["+ ", "- ", "|| ", "&& ", "? ", ": ", "| "];
                let operator = operator.iter().any(|sign| after.starts_with(sign));
                // Rather behind a comma than before an operator.
                let rank = 2 * depth + i32::from(operator);
                if (comma || operator) && best.is_none_or(|(least, _)| rank <= least) {
                    best = Some((rank, at));
                }
            }
            _ => {}
        }
    }
    let Some((_, at)) = best else { return line.to_owned() };
    let rest = format!("{}{}", " ".repeat(indent), line[at..].trim_start());
    format!("{}\n{}", line[..at].trim_end(), wrapped(&rest, indent))
}

/// The body of a function.
struct Body<'a> {
    printer: &'a Printer<'a>,
    function: &'a Function,
}

impl Body<'_> {
    fn block(&self, body: &[Statement], depth: usize, text: &mut String) {
        let mut at = 0;
        while at < body.len() {
            let declared = self.declarations(&body[at..], depth, text);
            if declared == 0 {
                self.statement(&body[at], depth, text);
            }
            at += declared.max(1);
        }
    }

    fn line(&self, line: &str, depth: usize, text: &mut String) {
        let space = "    ".repeat(depth);
        let _ = writeln!(text, "{}", wrapped(&format!("{space}{line}"), 4 * depth + 4));
    }

    /// Declarations that a block begins with, of one type and in one line; how many these are.
    fn declarations(&self, body: &[Statement], depth: usize, text: &mut String) -> usize {
        let (mut line, mut count) = (String::new(), 0);
        while let Some(Statement::Declare { name, kind, init }) = body.get(count) {
            let is_changed = flow::is_assigned(&body[count + 1..], name);
            let constant = if init.is_some() && !is_changed { "const " } else { "" };
            let begin = format!("{constant}{} ", self.printer.kind(kind));
            let mut own = self.printer.declarator(name, kind, false);
            if let Some(init) = init {
                let _ = write!(own, " = {}", self.initial(init));
            }
            if count == 0 {
                line = begin + &own;
            } else if line.starts_with(&begin) && line.len() + own.len() + 4 * depth < WIDTH {
                let _ = write!(line, ", {own}");
            } else {
                break;
            }
            count += 1;
        }
        if count == 0 {
            return 0;
        }
        self.line(&(line + ";"), depth, text);
        for (place, statement) in body[..count].iter().enumerate() {
            if let Statement::Declare { name, .. } = statement
                && !is_read(&body[place + 1..], name)
            {
                self.line(&format!("(void){name};"), depth, text);
            }
        }
        count
    }

    fn statement(&self, one: &Statement, depth: usize, text: &mut String) {
        let space = "    ".repeat(depth);
        match one {
            Statement::Comment(comment) => *text += &self.printer.comment(comment, &space),
            Statement::Declare { .. } => {}
            Statement::Assign { place, op, value } => {
                let op = op.map_or("", crate::tree::Op::in_c);
                let line = format!("{} {op}= {};", self.expr(place), self.expr(value));
                self.line(&line, depth, text);
            }
            Statement::Call(call) => self.line(&format!("{};", self.expr(call)), depth, text),
            Statement::If { test, then, otherwise } => {
                self.line(&format!("if ({}) {{", self.expr(test)), depth, text);
                self.block(then, depth + 1, text);
                let mut rest = otherwise;
                while let [Statement::If { test, then, otherwise }] = &rest[..] {
                    self.line(&format!("}} else if ({}) {{", self.expr(test)), depth, text);
                    self.block(then, depth + 1, text);
                    rest = otherwise;
                }
                if !rest.is_empty() {
                    let _ = writeln!(text, "{space}}} else {{");
                    self.block(rest, depth + 1, text);
                }
                let _ = writeln!(text, "{space}}}");
            }
            Statement::For { name, from, to, test, body } => {
                let test = test.as_ref().map_or(String::new(), |test| {
                    format!(" && {}", self.inside(test, crate::tree::Op::And.strength()))
                });
                let kind = self.printer.kind(&from.kind);
                let [from, to] = [from, to].map(|bound| self.expr(bound));
                let line =
                    format!("for ({kind} {name} = {from}; {name} < {to}{test}; ++{name}) {{");
                self.line(&line, depth, text);
                self.block(body, depth + 1, text);
                let _ = writeln!(text, "{space}}}");
            }
            Statement::Block(body) => {
                let _ = writeln!(text, "{space}{{");
                self.block(body, depth + 1, text);
                let _ = writeln!(text, "{space}}}");
            }
            Statement::Return(None) => self.line("return;", depth, text),
            Statement::Return(Some(Expr { node: Node::Made(parts), kind })) => {
                let parts: Vec<String> = parts.iter().map(|part| self.initial(part)).collect();
                let (begin, joined) =
                    (format!("const {} made = {{", self.printer.kind(kind)), parts.join(", "));
                if begin.len() + joined.len() + 4 * depth < WIDTH {
                    self.line(&format!("{begin} {joined} }};"), depth, text);
                } else {
                    self.line(&begin, depth, text);
                    for part in parts {
                        self.line(&format!("{part},"), depth + 1, text);
                    }
                    self.line("};", depth, text);
                }
                self.line("return made;", depth, text);
            }
            Statement::Return(Some(value)) => {
                self.line(&format!("return {};", self.expr(value)), depth, text);
            }
            Statement::Continue => self.line("continue;", depth, text),
        }
    }
}

/// Whether a variable is more than assigned.
fn is_read(body: &[Statement], name: &str) -> bool {
    let mut found = false;
    visit::statements(body, &mut |statement| {
        found |= match statement {
            Statement::Assign { place, op: None, value } if place.root() == Some(name) => {
                let mut places = 0;
                visit::expressions(place, &mut |part| {
                    places += usize::from(matches!(&part.node, Node::Variable(own) if own == name));
                });
                places > 1 || visit::reads(value, name)
            }
            other => visit::own(other).into_iter().any(|expr: &Expr| visit::reads(expr, name)),
        };
    });
    found
}
