//! The functions and types that generated code is put together from: only those are written that it needs.

/// The functions and types of the source file, in an order in which each knows those before it.
const SOURCE: &str = include_str!("library.c");

/// The types of the header.
const HEADER: &str = include_str!("types.h");

/// The prefix of every symbol in these files.
const PREFIX: &str = "NAME_";

/// One function, type or constant with its comment. An empty line follows it.
struct Piece<'a> {
    name: &'a str,
    text: &'a str,
}

/// The pieces of the source file that a text needs, directly or not, with the text's own prefix as in the library.
pub fn functions(text: &str) -> String {
    needed(SOURCE, text)
}

/// The types of the header that a text needs.
pub fn types(text: &str) -> String {
    needed(HEADER, text)
}

/// The two files of the library.
#[cfg(test)]
pub fn everything() -> [String; 2] {
    [HEADER, SOURCE].map(str::to_owned)
}

/// A text of the library with a mechanism's prefix.
pub fn with_prefix(text: &str, prefix: &str) -> String {
    text.replace(PREFIX, &format!("{prefix}_"))
}

fn needed(library: &str, text: &str) -> String {
    let pieces: Vec<Piece<'_>> = library.split("\n\n").filter_map(Piece::of).collect();
    let mut used: Vec<&str> = symbols(text).collect();
    let mut taken = vec![false; pieces.len()];
    while let Some(symbol) = used.pop() {
        if let Some(number) = pieces.iter().position(|piece| piece.name == symbol)
            && !taken[number]
        {
            taken[number] = true;
            used.extend(symbols(pieces[number].text));
        }
    }
    let taken = pieces.iter().zip(taken).filter(|(_, taken)| *taken);
    taken.map(|(piece, _)| format!("{}\n\n", piece.text)).collect()
}

/// The symbols of the library in a text, without their prefix.
fn symbols(text: &str) -> impl Iterator<Item = &str> {
    text.split(PREFIX).skip(1).map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        &rest[..end.unwrap_or(rest.len())]
    })
}

impl<'a> Piece<'a> {
    /// A piece of the library: its name is that of the constant, the function or the type that it defines.
    fn of(text: &'a str) -> Option<Self> {
        let text = text.trim_matches('\n');
        let definition = ["#define ", "static ", "typedef "].iter().find_map(|begin| match text
            .starts_with(begin)
        {
            true => Some(text),
            false => text.find(&format!("\n{begin}")).map(|at| &text[at + 1..]),
        })?;
        let name = if definition.starts_with("typedef") {
            symbols(definition).last()?
        } else {
            symbols(definition.split_once('(').map_or(definition, |(head, _)| head)).last()?
        };
        Some(Self { name, text })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_gets_what_it_needs_and_nothing_else() {
        let found = functions("NAME_clamp(x, -1, 1) + NAME_acos(x)");
        assert!(found.contains("NAME_clamp(real x, real low, real high)\n{"));
        assert!(found.contains("#define NAME_MATH(name, x)"));
        assert!(!found.contains("NAME_sqrt"));
        assert!(types("NAME_planar_rpr a;").contains("} NAME_pivot;"));
        assert_eq!(functions("NAME_inverse"), "");
    }

    /// Every piece has a name of its own, and knows only those before it.
    #[test]
    fn the_library_is_in_order() {
        for library in everything() {
            let pieces: Vec<_> =
                library.split("\n\n").map(|text| Piece::of(text).unwrap()).collect();
            for (number, piece) in pieces.iter().enumerate() {
                assert_eq!(pieces.iter().filter(|other| other.name == piece.name).count(), 1);
                for symbol in symbols(piece.text) {
                    let at = pieces.iter().position(|other| other.name == symbol);
                    assert!(at.is_none_or(|at| at <= number), "{} uses {symbol}", piece.name);
                }
            }
        }
    }
}
