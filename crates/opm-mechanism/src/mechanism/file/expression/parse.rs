//! The grammar: sums, products, powers, calls, points `[x, y, z]` and their components `p.x`. A name in a leg of a pattern may
//! have the leg's number in it: `A{i}`.

use super::functions::call;
use super::{Fault, Found, Scope, Term};
use crate::mechanism::file::hint::nearest;
use crate::mechanism::file::pattern::PLACE;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// How deep parentheses and calls may stand in each other.
const DEEPEST: usize = 64;

/// Evaluates an expression.
pub(in crate::mechanism::file) fn evaluate(text: &str, scope: &dyn Scope) -> Result<Term, Fault> {
    let mut parser = Parser { text, at: 0, depth: 0, scope };
    let term = parser.sum()?;
    parser.space();
    match parser.rest().chars().next() {
        None if term.is_finite() => Ok(term),
        None => Err(Fault { at: 0, message: "is not a finite number".into() }),
        Some(other) => Err(parser.fault(format!("found {other:?}, expected + - * / ^ or the end"))),
    }
}

/// Whether a text is a name: letters, digits and `_`, no digit first.
pub(in crate::mechanism::file) fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    let first = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    first && letters.all(is_of_name)
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
    scope: &'t dyn Scope,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn fault(&self, message: impl Into<String>) -> Fault {
        Fault { at: self.at, message: message.into() }
    }

    fn space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Takes one of some characters, if it is next.
    fn take(&mut self, of: &[char]) -> Option<char> {
        self.space();
        let next = self.rest().chars().next().filter(|c| of.contains(c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn expect(&mut self, expected: char, after: &str) -> Result<(), Fault> {
        if self.take(&[expected]).is_some() {
            return Ok(());
        }
        let found = self.rest().chars().next();
        let found = found.map_or_else(|| "the end".to_owned(), |c| format!("{c:?}"));
        Err(self.fault(format!("found {found}, expected {expected:?} {after}")))
    }

    fn sum(&mut self) -> Result<Term, Fault> {
        let mut sum = self.product()?;
        while let Some(sign) = self.take(&['+', '-']) {
            let at = self.at - 1;
            let next = self.product()?;
            let next = if sign == '-' { negative(next) } else { next };
            sum = match (sum, next) {
                (Term::Number(a), Term::Number(b)) => Term::Number(a + b),
                (Term::Vector(a), Term::Vector(b)) => Term::Vector(a + b),
                (a, b) => return Err(mixed(at, sign, a, b)),
            };
        }
        Ok(sum)
    }

    fn product(&mut self) -> Result<Term, Fault> {
        let mut product = self.signed()?;
        while let Some(sign) = self.take(&['*', '/']) {
            let at = self.at - 1;
            let next = self.signed()?;
            product = match (product, sign, next) {
                (_, '/', Term::Number(0.0)) => {
                    return Err(Fault { at, message: "divides by zero".into() });
                }
                (Term::Number(a), '*', Term::Number(b)) => Term::Number(a * b),
                (Term::Number(a), '/', Term::Number(b)) => Term::Number(a / b),
                (Term::Vector(a), '*', Term::Number(b))
                | (Term::Number(b), '*', Term::Vector(a)) => Term::Vector(a * b),
                (Term::Vector(a), '/', Term::Number(b)) => Term::Vector(a / b),
                (a, _, b) => return Err(mixed(at, sign, a, b)),
            };
        }
        Ok(product)
    }

    fn signed(&mut self) -> Result<Term, Fault> {
        // Signs do not nest, so that a row of them takes no stack.
        let mut minus = false;
        while let Some(sign) = self.take(&['-', '+']) {
            minus ^= sign == '-';
        }
        let term = self.power()?;
        Ok(if minus { negative(term) } else { term })
    }

    /// A power binds more than the sign before it, and less than the one behind: `-2^-1` is -0.5.
    fn power(&mut self) -> Result<Term, Fault> {
        let base = self.component()?;
        if self.take(&['^']).is_none() {
            return Ok(base);
        }
        let at = self.at - 1;
        let exponent = self.nested(Self::signed)?;
        match (base, exponent) {
            (Term::Number(a), Term::Number(b)) => Ok(Term::Number(a.powf(b))),
            (a, b) => Err(mixed(at, '^', a, b)),
        }
    }

    /// A value, or a component of a point.
    fn component(&mut self) -> Result<Term, Fault> {
        let value = self.value()?;
        let Some(key) = self.rest().strip_prefix('.') else { return Ok(value) };
        let key: String = key.chars().take_while(|&c| is_of_name(c)).collect();
        let index = ["x", "y", "z"].iter().position(|name| *name == key);
        match (value, index) {
            (Term::Vector(vector), Some(index)) => {
                self.at += 1 + key.len();
                Ok(Term::Number(vector[index]))
            }
            (Term::Vector(_), None) => {
                Err(self.fault(format!("`.{key}` is no component of a point, expected .x .y .z")))
            }
            (Term::Number(_), _) => Err(self.fault("a number has no components")),
        }
    }

    fn nested<T>(&mut self, read: impl Fn(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        if self.depth == DEEPEST {
            let deepest = format!("is nested deeper than {DEEPEST} levels");
            return Err(self.fault(deepest));
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    fn value(&mut self) -> Result<Term, Fault> {
        self.space();
        let start = self.at;
        match self.rest().chars().next() {
            Some('(') => {
                self.at += 1;
                let inner = self.nested(Self::sum)?;
                self.expect(')', "after (")?;
                Ok(inner)
            }
            Some('[') => {
                self.at += 1;
                let items = self.list(']', "at the end of a point")?;
                match items[..] {
                    [Term::Number(x), Term::Number(y), Term::Number(z)] => {
                        Ok(Term::Vector(Vector3::new(x, y, z)))
                    }
                    _ => Err(Fault {
                        at: start,
                        message: "is no point, expected three numbers [x, y, z]".into(),
                    }),
                }
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if is_of_name(c) => self.name(),
            Some(other) => Err(self.fault(format!("found {other:?}, expected a value"))),
            None => Err(self.fault("ends where a value is expected")),
        }
    }

    /// Values between commas, up to the closing bracket.
    fn list(&mut self, close: char, after: &str) -> Result<Vec<Term>, Fault> {
        let mut items = Vec::new();
        if self.take(&[close]).is_some() {
            return Ok(items);
        }
        loop {
            items.push(self.nested(Self::sum)?);
            if self.take(&[',']).is_none() {
                self.expect(close, after)?;
                return Ok(items);
            }
        }
    }

    fn number(&mut self) -> Result<Term, Fault> {
        let bytes = self.rest().as_bytes();
        let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if bytes.get(end).is_some_and(|b| b.eq_ignore_ascii_case(&b'e')) {
            let sign = usize::from(bytes.get(end + 1).is_some_and(|b| b"+-".contains(b)));
            let exponent = digits((end + 1 + sign).min(bytes.len()));
            // `2e` is a number and a name, which is refused below.
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let (number, rest) = self.rest().split_at(end);
        let joined = rest.chars().next().is_some_and(|c| is_of_name(c) || c == '.');
        match number.parse() {
            Ok(value) if !joined => {
                self.at += end;
                Ok(Term::Number(value))
            }
            _ => {
                let word: String =
                    self.rest().chars().take_while(|&c| is_of_name(c) || c == '.').collect();
                Err(self.fault(format!(
                    "`{word}` is no number: a unit is that of the parameter or the file, and products have a *"
                )))
            }
        }
    }

    fn name(&mut self) -> Result<Term, Fault> {
        let start = self.at;
        let mut name = String::new();
        loop {
            let part: String = self.rest().chars().take_while(|&c| is_of_name(c)).collect();
            self.at += part.len();
            name += &part;
            if !self.rest().starts_with(PLACE) {
                break;
            }
            let Some(leg) = self.scope.leg() else {
                return Err(self.fault(format!(
                    "found {PLACE}, which is the number of a leg in the joints of a `pattern`"
                )));
            };
            name += &leg.to_string();
            self.at += PLACE.len();
        }
        if self.take(&['(']).is_some() {
            let given = self.list(')', &format!("after {name}("))?;
            let called = call(&name, &given, self.scope.units());
            return called.map_err(|message| Fault { at: start, message });
        }
        if name == "pi" {
            return Ok(Term::Number(PI));
        }
        match self.scope.value(&name) {
            Found::Term(term) => Ok(term),
            Found::Without(reason) => Err(Fault { at: start, message: reason.unwrap_or_default() }),
            Found::Nothing => {
                let names = self.scope.names();
                let meant = nearest(&name, &names)
                    .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
                let known = match names.is_empty() {
                    true => "expected a number, or an expression: the file has no [parameters]"
                        .to_owned(),
                    false => format!("expected one of {}", names.join(", ")),
                };
                let message = format!("`{name}` is not a parameter; {meant}{known}");
                Err(Fault { at: start, message })
            }
        }
    }
}

fn negative(term: Term) -> Term {
    match term {
        Term::Number(number) => Term::Number(-number),
        Term::Vector(vector) => Term::Vector(-vector),
    }
}

fn mixed(at: usize, sign: char, a: Term, b: Term) -> Fault {
    Fault { at, message: format!("{} {sign} {} has no meaning", a.kind(), b.kind()) }
}
