//! What the printers of several languages share.

/// The longest line of a comment.
const WIDTH: usize = 100;

/// A comment in lines that begin with a mark; nothing for an empty one. Symbols lose the prefix of the library.
pub fn commented(text: &str, mark: &str, space: &str) -> String {
    let text = text.replace("NAME_", "");
    let mut lines = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && space.len() + mark.len() + line.len() + 1 + word.len() > WIDTH {
            lines += &format!("{space}{mark}{line}\n");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    if !line.is_empty() {
        lines += &format!("{space}{mark}{line}\n");
    }
    lines
}

/// A number of the library as a floating-point number.
pub fn literal(number: &str) -> String {
    if number.contains(['.', 'e']) { number.to_owned() } else { format!("{number}.0") }
}

/// A name in which words begin with capitals: `planar_rrr` becomes `PlanarRrr`.
pub fn camel(name: &str) -> String {
    let words = name.split('_').map(|word| {
        let mut letters = word.chars();
        letters.next().map_or(String::new(), |first| {
            first.to_uppercase().collect::<String>() + letters.as_str()
        })
    });
    words.collect()
}
