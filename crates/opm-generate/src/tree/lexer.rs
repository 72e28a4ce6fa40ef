//! The words of the part of C that closed forms are written in.

/// A word of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    Name(String),
    Number(String),
    /// Operators and brackets.
    Sign(&'static str),
    /// A comment, without its marks and line breaks.
    Comment(String),
    /// A line of the preprocessor that defines a name.
    Define(String),
    End,
}

/// Longer signs stand before those that they begin with.
const SIGNS: [&str; 40] = [
    "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "++", "--", "->", "+=", "-=", "*=", "/=", "|=",
    "<", ">", "=", "!", "&", "|", "+", "-", "*", "/", "%", "?", ":", ";", ",", ".", "(", ")", "[",
    "]", "{", "}", "~", "^",
];

/// The words of a text; what is said to compilers of C++ is left out.
pub fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut found = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let Some(first) = rest.chars().next() else {
            found.push(Token::End);
            return Ok(found);
        };
        if let Some(comment) = rest.strip_prefix("/*") {
            let (inside, after) = comment.split_once("*/").ok_or("a comment has no end")?;
            let lines: Vec<&str> = inside.lines().map(str::trim).collect();
            found.push(Token::Comment(lines.join(" ").trim().to_owned()));
            rest = after;
        } else if first == '#' {
            let (line, after) = rest.split_once('\n').unwrap_or((rest, ""));
            rest = after;
            if line == "#ifdef __cplusplus" {
                rest = after.split_once("#endif").ok_or("a condition has no end")?.1;
            } else if let Some(definition) = line.strip_prefix("#define ") {
                found.push(Token::Define(definition.to_owned()));
            }
        } else if first.is_ascii_alphabetic() || first == '_' {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let (name, after) = rest.split_at(end.unwrap_or(rest.len()));
            found.push(Token::Name(name.to_owned()));
            rest = after;
        } else if first.is_ascii_digit() {
            let (number, after) = rest.split_at(number_length(rest));
            found.push(Token::Number(number.to_owned()));
            rest = after.strip_prefix('u').unwrap_or(after);
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("no word begins with '{first}'"))?;
            found.push(Token::Sign(sign));
            rest = &rest[sign.len()..];
        }
    }
}

/// The length of the number that a text begins with.
fn number_length(text: &str) -> usize {
    let mut before = ' ';
    let end = text.find(|c: char| {
        let part =
            c.is_ascii_digit() || c == '.' || c == 'e' || (before == 'e' && matches!(c, '+' | '-'));
        before = c;
        !part
    });
    end.unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_becomes_words() {
        let found = tokens("/* a\n   b */ x->y += 1e-3*2u; #define Z 1\n").unwrap();
        let name = |name: &str| Token::Name(name.into());
        let number = |number: &str| Token::Number(number.into());
        assert_eq!(
            found,
            [
                Token::Comment("a b".into()),
                name("x"),
                Token::Sign("->"),
                name("y"),
                Token::Sign("+="),
                number("1e-3"),
                Token::Sign("*"),
                number("2"),
                Token::Sign(";"),
                Token::Define("Z 1".into()),
                Token::End,
            ]
        );
        assert!(tokens("a @ b").is_err());
    }
}
