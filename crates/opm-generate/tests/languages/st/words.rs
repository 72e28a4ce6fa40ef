//! The words of structured text.

/// A word, and the line that it is on.
#[derive(Clone, Debug, PartialEq)]
pub enum Word {
    /// In small letters, as these are the same as large ones.
    Name(String),
    Real(f64),
    Whole(i64),
    /// `DWORD#3`
    Bits(u32),
    Sign(&'static str),
    End,
}

/// Longer signs stand before those that they begin with.
const SIGNS: [&str; 20] = [
    ":=", "<=", ">=", "<>", "..", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", ":", ";",
    ",", ".",
];

/// Splits a text into words. It panics, with the line, where there is none that begins so.
pub fn words(text: &str) -> Vec<(Word, usize)> {
    let mut all = Vec::new();
    let mut rest = text;
    let line = |rest: &str| 1 + text[..text.len() - rest.len()].matches('\n').count();
    loop {
        rest = rest.trim_start();
        let at = line(rest);
        let Some(first) = rest.chars().next() else {
            all.push((Word::End, at));
            return all;
        };
        if let Some(comment) = rest.strip_prefix("(*") {
            let end =
                comment.find("*)").unwrap_or_else(|| panic!("line {at}: a comment has no end"));
            assert!(!comment[..end].contains("(*"), "line {at}: a comment in a comment");
            rest = &comment[end + 2..];
        } else if first.is_ascii_alphabetic() || first == '_' {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let (name, after) = rest.split_at(end.unwrap_or(rest.len()));
            let wrong = name.contains("__") || name.ends_with('_') || name.starts_with('_');
            assert!(!wrong, "line {at}: '{name}' is no identifier");
            if let (true, Some(number)) =
                (name.eq_ignore_ascii_case("DWORD"), after.strip_prefix('#'))
            {
                let end = number.find(|c: char| !c.is_ascii_digit()).unwrap_or(number.len());
                all.push((Word::Bits(number[..end].parse().expect("32 bits")), at));
                rest = &number[end..];
            } else {
                all.push((Word::Name(name.to_lowercase()), at));
                rest = after;
            }
        } else if first.is_ascii_digit() {
            let (word, after) = number(rest, at);
            all.push((word, at));
            rest = after;
        } else {
            let sign = SIGNS.into_iter().find(|sign| rest.starts_with(sign));
            let sign = sign.unwrap_or_else(|| panic!("line {at}: no word begins with '{first}'"));
            all.push((Word::Sign(sign), at));
            rest = &rest[sign.len()..];
        }
    }
}

/// A number: one with a point has digits on both sides of it, and maybe an exponent.
fn number(text: &str, line: usize) -> (Word, &str) {
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let mut end = digits(text);
    let fraction = text[end..].strip_prefix('.').filter(|rest| !rest.starts_with('.'));
    let Some(fraction) = fraction else {
        let value = text[..end].parse().unwrap_or_else(|_| panic!("line {line}: too large"));
        assert!(!text[end..].starts_with(['e', 'E']), "line {line}: no point in a real number");
        return (Word::Whole(value), &text[end..]);
    };
    let after = digits(fraction);
    assert!(after > 0, "line {line}: no digit behind the point");
    end += 1 + after;
    if let Some(exponent) = text[end..].strip_prefix(['E', 'e']) {
        let unsigned = exponent.trim_start_matches(['-', '+']);
        let sign = exponent.len() - unsigned.len();
        assert!(sign <= 1 && digits(unsigned) > 0, "line {line}: an exponent without digits");
        end += 1 + sign + digits(unsigned);
    }
    (Word::Real(text[..end].parse().expect("a number")), &text[end..])
}
