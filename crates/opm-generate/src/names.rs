//! Identifiers of C for the names of a mechanism.

use std::collections::HashSet;

/// The longest identifier of a name. Files are called after it, too, and their systems take 255 characters.
const LONGEST: usize = 100;

/// The prefix of every symbol: the mechanism's name with `_` for everything that an identifier cannot have.
pub fn prefix(name: &str) -> String {
    let plain = plain(name);
    // An identifier does not begin with a digit, and those that begin with an underscore are reserved.
    match plain.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => plain,
        _ => format!("m{plain}"),
    }
}

/// The name of a mechanism's files, and of what is imported or built by it: its prefix, after `m_` where that is one of the
/// words that the language, or a tool of it, keeps for itself.
pub fn package(name: &str, reserved: &str) -> String {
    let prefix = prefix(name);
    if reserved.split(' ').any(|word| word == prefix) { format!("m_{prefix}") } else { prefix }
}

/// Identifiers for a list of names, all of them different. They follow a prefix.
pub fn identifiers<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut identifiers = Vec::new();
    for name in names {
        let plain = plain(name);
        let mut identifier = plain.clone();
        let mut number = 1;
        while !taken.insert(identifier.clone()) {
            number += 1;
            identifier = format!("{plain}_{number}");
        }
        identifiers.push(identifier);
    }
    identifiers
}

/// A name as a part of a comment: it cannot end one.
pub fn comment(name: &str) -> String {
    name.replace("*/", "* /").replace("/*", "/ *").replace('\\', "/")
}

/// The beginning of a name with `_` for everything that an identifier cannot have. A symbol has the prefix of the library
/// in it, and there are a thousand: one of a million letters would fill the memory.
fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().take(LONGEST).map(letter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        assert_eq!(prefix("plano-spherical-5dof"), "plano_spherical_5dof");
        assert_eq!(prefix("3-RRR (new)"), "m3_RRR__new_");
        assert_eq!(prefix("Δ"), "m_");
        assert_eq!(package("class", "class"), "m_class");
        assert_eq!(package("classes", "class"), "classes");
        assert_eq!(identifiers(["s.x", "s_x", "s x"]), ["s_x", "s_x_2", "s_x_3"]);
        assert_eq!(comment("a */ b"), "a * / b");
        assert_eq!(prefix(&"n".repeat(1_000_000)).len(), LONGEST);
        let long = [format!("{}1", "n".repeat(200)), format!("{}2", "n".repeat(200))];
        let [first, second] = &*identifiers(long.iter().map(String::as_str)) else {
            unreachable!()
        };
        assert_ne!(first, second);
    }
}
