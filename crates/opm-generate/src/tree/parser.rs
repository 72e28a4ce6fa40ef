//! The definitions of a text: enums, constants, structs, functions, the geometry.

use super::lexer::{Token, tokens};
use super::{
    BUILT_IN, Code, Constant, Entry, Enum, Function, Member, Node, Parameter, Pass, Struct, Type,
    Value,
};
use std::collections::HashMap;

/// The prefix of the symbols of a mechanism.
const PREFIX: &str = "NAME_";

/// What is written anew in each language.
const OWN: [&str; 4] = ["arctangent", "half", "INLINE", "MATH"];

/// Reads a text: what is declared before it is defined gets the comment of its declaration.
pub fn parse(text: &str) -> Result<Code, String> {
    let words = tokens(text)?;
    let mut parser = Parser { words, at: 0, code: Code::default(), scopes: Vec::new() };
    parser.code().map_err(|wrong| {
        let from = parser.at.saturating_sub(12);
        format!("{wrong}, behind {:?}", &parser.words[from..parser.at])
    })?;
    Ok(without_unused_constants(parser.code))
}

/// What is written anew in each language may have needed a constant that nothing else needs.
fn without_unused_constants(mut code: Code) -> Code {
    let mut used = Vec::new();
    for function in &code.functions {
        super::visit::statements(&function.body, &mut |statement| {
            for expr in super::visit::own(statement) {
                super::visit::expressions(expr, &mut |part| {
                    if let Node::Constant(name) = &part.node {
                        used.push(name.clone());
                    }
                });
            }
        });
    }
    code.constants.retain(|constant| used.contains(&constant.name));
    code
}

/// What is known of a local name.
pub(super) type Scope = HashMap<String, Type>;

pub(super) struct Parser {
    words: Vec<Token>,
    at: usize,
    pub(super) code: Code,
    pub(super) scopes: Vec<Scope>,
}

impl Parser {
    pub(super) fn peek(&self) -> &Token {
        self.words.get(self.at).unwrap_or(&Token::End)
    }

    pub(super) fn ahead(&self, far: usize) -> &Token {
        self.words.get(self.at + far).unwrap_or(&Token::End)
    }

    pub(super) fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.at += 1;
        token
    }

    /// Takes a sign, if it is the next word.
    pub(super) fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Token::Sign(next) if *next == sign);
        self.at += usize::from(found);
        found
    }

    pub(super) fn expect(&mut self, sign: &str) -> Result<(), String> {
        if self.take(sign) {
            Ok(())
        } else {
            Err(format!("expected '{sign}', not {:?}", self.peek()))
        }
    }

    /// A name without the prefix.
    pub(super) fn name(&mut self) -> Result<String, String> {
        match self.next() {
            Token::Name(name) => Ok(name.strip_prefix(PREFIX).unwrap_or(&name).to_owned()),
            other => Err(format!("expected a name, not {other:?}")),
        }
    }

    /// Takes a word, if it is the next one.
    pub(super) fn keyword(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Token::Name(name) if name == word);
        self.at += usize::from(found);
        found
    }

    fn code(&mut self) -> Result<(), String> {
        let mut comment = String::new();
        loop {
            match self.peek().clone() {
                Token::End => return Ok(()),
                Token::Comment(text) => {
                    self.at += 1;
                    comment = text;
                    continue;
                }
                Token::Define(text) => {
                    self.at += 1;
                    self.constant(&text, &comment);
                }
                Token::Name(word) => match &*word {
                    "extern" => self.skip_to(";"),
                    "enum" => self.names(&comment)?,
                    "typedef" => self.structure(&comment)?,
                    _ => self.definition(&comment)?,
                },
                Token::Sign(_) | Token::Number(_) => return Err("expected a definition".into()),
            }
            comment.clear();
        }
    }

    fn skip_to(&mut self, sign: &str) {
        while !self.take(sign) && *self.peek() != Token::End {
            self.at += 1;
        }
    }

    /// A constant: one number, or that of `double` and that of `float`.
    fn constant(&mut self, text: &str, comment: &str) {
        let Some((name, value)) = text.split_once(' ') else { return };
        let Some(name) = name.strip_prefix(PREFIX).filter(|name| !name.contains('(')) else {
            return;
        };
        if OWN.contains(&name) || name == "H" {
            return;
        }
        let numbers: Vec<String> = value
            .split(|c: char| !c.is_ascii_alphanumeric() && !matches!(c, '.' | '-'))
            .filter(|word| word.starts_with(|c: char| c.is_ascii_digit()))
            .map(str::to_owned)
            .collect();
        let (Some(float), Some(double)) = (numbers.first(), numbers.last()) else { return };
        self.code.constants.push(Constant {
            name: name.to_owned(),
            comment: comment.to_owned(),
            double: double.clone(),
            float: float.clone(),
        });
    }

    fn names(&mut self, comment: &str) -> Result<(), String> {
        self.at += 1;
        self.expect("{")?;
        let mut entries: Vec<Entry> = Vec::new();
        while !self.take("}") {
            match self.peek().clone() {
                Token::Comment(text) => {
                    self.at += 1;
                    if let Some(last) = entries.last_mut() {
                        last.comment = text;
                    }
                }
                Token::Sign(",") => self.at += 1,
                _ => {
                    let name = self.name()?;
                    self.expect("=")?;
                    let Token::Number(value) = self.next() else {
                        return Err("expected a number".into());
                    };
                    let value = value.parse().map_err(|_| "expected a whole number".to_owned())?;
                    entries.push(Entry { name, value, comment: String::new() });
                }
            }
        }
        self.expect(";")?;
        self.code.enums.push(Enum { comment: comment.to_owned(), entries });
        Ok(())
    }

    fn structure(&mut self, comment: &str) -> Result<(), String> {
        self.at += 1;
        if !self.keyword("struct") {
            self.skip_to(";");
            return Ok(());
        }
        self.expect("{")?;
        let mut members = Vec::new();
        let mut of_member = String::new();
        while !self.take("}") {
            if let Token::Comment(text) = self.peek().clone() {
                self.at += 1;
                of_member = text;
                continue;
            }
            let kind = self.kind()?;
            loop {
                let name = self.name()?;
                let kind = self.elements(kind.clone())?;
                members.push(Member { name, kind, comment: of_member.clone() });
                if !self.take(",") {
                    break;
                }
            }
            self.expect(";")?;
            of_member.clear();
        }
        let name = self.name()?;
        self.expect(";")?;
        self.code.structs.push(Struct { name, comment: comment.to_owned(), members });
        Ok(())
    }

    /// The type that a declaration begins with.
    pub(super) fn kind(&mut self) -> Result<Type, String> {
        let before = ["const", "static", "inline", "NAME_INLINE"];
        while before.iter().any(|word| self.keyword(word)) {}
        let name = self.name()?;
        Ok(match &*name {
            "void" => Type::Void,
            "int" => Type::Int,
            "unsigned" => Type::Bits,
            "real" | "double" => Type::Real,
            _ if self.code.structs.iter().any(|known| known.name == name) => Type::Struct(name),
            _ => return Err(format!("there is no type {name}")),
        })
    }

    /// Whether a declaration begins here.
    pub(super) fn declares(&self) -> bool {
        let Token::Name(word) = self.peek() else { return false };
        let follows = matches!(self.ahead(1), Token::Name(_) | Token::Sign("*"));
        let names = ["const", "int", "unsigned", "real", "double"].contains(&&**word);
        let own = word.strip_prefix(PREFIX).is_some_and(|name| {
            name == "real" || self.code.structs.iter().any(|known| known.name == name)
        });
        follows && (names || own)
    }

    /// The type with the number of elements that follows a name.
    pub(super) fn elements(&mut self, kind: Type) -> Result<Type, String> {
        if !self.take("[") {
            return Ok(kind);
        }
        let mut count = 1;
        if matches!(self.peek(), Token::Sign("]")) {
            count = 0;
        }
        while !self.take("]") {
            // A product, or a sum with one, of constants.
            match self.next() {
                Token::Number(number) => count *= number.parse::<usize>().unwrap_or(1),
                Token::Name(name) => {
                    count *= self.count(name.strip_prefix(PREFIX).unwrap_or(&name))?;
                }
                Token::Sign("(") => {
                    let Token::Name(name) = self.next() else { return Err("a count".into()) };
                    let first = self.count(name.strip_prefix(PREFIX).unwrap_or(&name))?;
                    self.expect("+")?;
                    let Token::Number(number) = self.next() else { return Err("a count".into()) };
                    count *= first + number.parse::<usize>().unwrap_or(0);
                    self.expect(")")?;
                }
                Token::Sign("*") => {}
                other => return Err(format!("expected a number of elements, not {other:?}")),
            }
        }
        Ok(Type::Array(Box::new(kind), count))
    }

    fn count(&self, name: &str) -> Result<usize, String> {
        let mut entries = self.code.enums.iter().flat_map(|names| &names.entries);
        let found = entries.find(|entry| entry.name == name);
        Ok(found.ok_or_else(|| format!("there is no constant {name}"))?.value)
    }

    /// A function, its declaration, or the geometry.
    fn definition(&mut self, comment: &str) -> Result<(), String> {
        let public = !matches!(self.peek(), Token::Name(word) if word == "static");
        let result = self.kind()?;
        let name = self.name()?;
        if self.take("=") {
            self.code.default = self.value()?;
            return self.expect(";");
        }
        self.expect("(")?;
        let mut parameters = Vec::new();
        while !self.take(")") {
            if self.keyword("void") {
                continue;
            }
            parameters.push(self.parameter()?);
            self.take(",");
        }
        let comment = comment.to_owned();
        if BUILT_IN.contains(&&*name) || OWN.contains(&&*name) {
            self.skip_to("}");
            return Ok(());
        }
        let declared = self.code.functions.iter().position(|function| function.name == name);
        let function = Function { name, comment, public, parameters, result, body: Vec::new() };
        let place = declared.unwrap_or_else(|| {
            self.code.functions.push(function.clone());
            self.code.functions.len() - 1
        });
        self.code.functions[place].parameters = function.parameters;
        if self.take(";") {
            return Ok(());
        }
        let body = self.body(place)?;
        let mut defined = self.code.functions.remove(place);
        defined.body = body;
        self.code.functions.push(defined);
        Ok(())
    }

    fn parameter(&mut self) -> Result<Parameter, String> {
        let constant = matches!(self.peek(), Token::Name(word) if word == "const");
        let kind = self.kind()?;
        let pointer = self.take("*");
        let name = self.name()?;
        let kind = self.elements(kind)?;
        let pass = match (pointer || kind.is_array(), constant) {
            (false, _) => Pass::Value,
            (true, true) => Pass::Read,
            (true, false) => Pass::Write,
        };
        Ok(Parameter { name, kind, pass })
    }

    /// Numbers in braces.
    fn value(&mut self) -> Result<Value, String> {
        if let Token::Comment(_) = self.peek() {
            self.at += 1;
            return self.value();
        }
        if self.take("{") {
            let mut list = Vec::new();
            loop {
                while matches!(self.peek(), Token::Comment(_) | Token::Sign(",")) {
                    self.at += 1;
                }
                if self.take("}") {
                    return Ok(Value::List(list));
                }
                list.push(self.value()?);
            }
        }
        // R(-1.5)
        self.name()?;
        self.expect("(")?;
        let sign = if self.take("-") { -1.0 } else { 1.0 };
        let value = match self.next() {
            Token::Name(_) => f64::INFINITY,
            Token::Number(number) => number.parse().map_err(|_| format!("no number: {number}"))?,
            other => return Err(format!("expected a number, not {other:?}")),
        };
        self.expect(")")?;
        Ok(Value::Number(sign * value))
    }
}
