//! What a text is that is not a table of numbers between commas, and what to do about it.

use super::Line;
use crate::mechanism::file::Heading;
use crate::text::quoted;

/// What a header says that is none of cells between commas, and how to convert the table; `None` for a header that may be
/// one.
pub fn not_commas(header: Line<'_>) -> Option<String> {
    let text = header.text();
    let text = text.trim();
    if text.contains('\0') || text.starts_with(char::REPLACEMENT_CHARACTER) {
        return Some("not UTF-8, expected a table that was saved as CSV in UTF-8".to_owned());
    }
    if text.starts_with(['#', '%']) || text.starts_with("//") {
        let problem =
            "a comment, expected the header: remove the line, or its mark if it is the header";
        return Some(format!("{} is {problem}", quoted(text)));
    }
    if text.to_ascii_lowercase().starts_with("sep=") {
        let problem = "is for spreadsheets alone, expected the header: remove the line";
        return Some(format!("{} {problem}", quoted(text)));
    }
    if text.contains(',') {
        return None;
    }
    let converted = |separator: &str, sign: &str| {
        format!(
            "the columns are separated by {separator}, expected commas, and points in numbers; convert the table: \
             tr '{sign},' ',.' < OLD.csv > NEW.csv"
        )
    };
    if text.contains(';') {
        return Some(converted("semicolons", ";"));
    }
    if text.contains('\t') {
        return Some(converted("tabs", "\\t"));
    }
    if text.contains('|') {
        return Some(converted("bars", "|"));
    }
    Heading::parse(text).name.contains(char::is_whitespace).then(|| {
        "the columns are separated by spaces, expected commas; convert the table: tr -s ' ' ',' < OLD.csv > NEW.csv"
            .to_owned()
    })
}

/// What a cell is that is not a number, as the end of a message; empty if that is not known.
pub fn hint(cell: &str) -> &'static str {
    const SEPARATORS: [char; 6] = [' ', '\'', '_', '\u{a0}', '\u{202f}', '\u{2019}'];
    if cell.starts_with('"') != cell.ends_with('"') {
        return "; it is cut at a comma within quotes: write numbers with a point, without separators of thousands";
    }
    if cell.starts_with('#') {
        return "; a table has no comments: remove the line";
    }
    if !cell.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+') {
        return "";
    }
    if cell.replace(SEPARATORS, "").parse::<f64>().is_ok_and(f64::is_finite)
        && cell.contains(SEPARATORS)
    {
        return "; write it without separators of thousands";
    }
    if cell.contains(':') || cell.matches('-').count() > 1 || cell.matches('/').count() > 1 {
        return "; it is a date or a time of day, and times are seconds";
    }
    if cell.contains(';') {
        return "; write commas between columns";
    }
    let unit = cell.trim_start_matches(|c: char| c.is_ascii_digit() || ".+-".contains(c)).trim();
    if !unit.is_empty() && unit.chars().all(|c| c.is_alphabetic() || c == '°') {
        return "; a unit belongs into the header: x [mm]";
    }
    ""
}

/// What a row is that has another number of cells than the header, as the end of a message; empty if that is not known.
pub fn hint_of_row(row: Line<'_>, expected: usize) -> &'static str {
    let given = row.fields().len();
    let text = row.text();
    if text.trim_start().starts_with(['#', '%']) {
        "; a table has no comments: remove the line"
    } else if given == 1 && text.contains(';') {
        "; write commas between columns, and points in numbers"
    } else if given > expected && text.contains('"') {
        "; a comma within quotes ends a cell, too: write numbers with a point, without separators of thousands"
    } else if given > expected && row.fields().all(|cell| super::number(cell).is_ok()) {
        "; are there decimal commas or separators of thousands? Write numbers with a point alone"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Lines;

    fn header(text: &str) -> Option<String> {
        let mut lines = Lines::new(Box::new(text.as_bytes()));
        not_commas(lines.next().unwrap().expect("a line"))
    }

    #[test]
    fn a_header_without_commas_is_told_what_it_is() {
        for (text, words) in [
            ("t;x [mm]\n0;200,5\n", "separated by semicolons, expected commas, and points"),
            ("t\tx\ty\n", "tr '\\t,' ',.' <"),
            ("\u{feff}t|x\r\n", "separated by bars"),
            ("t x  y\n", "separated by spaces, expected commas"),
            ("# t,x,y\n", "\"# t,x,y\" is a comment"),
            ("sep=;\nt;x\n", "is for spreadsheets alone"),
            ("\u{0}t\u{0},\u{0}x", "not UTF-8"),
        ] {
            let found = header(text).unwrap_or_else(|| panic!("{text:?}"));
            assert!(found.contains(words), "{text:?}: {found}");
        }
        for text in ["t,x,y\n", "x\n", "x [mm]\n", "\"t\", \"x (mm)\"\n", "x(mm)", "S1.x"] {
            assert_eq!(header(text), None, "{text}");
        }
    }

    #[test]
    fn a_cell_that_is_no_number_is_told_what_it_is() {
        for (cell, words) in [
            ("1 700.5", "without separators of thousands"),
            ("1'700", "without separators of thousands"),
            ("\"1", "within quotes"),
            ("2026-01-31", "a date"),
            ("12:30:05", "a time of day"),
            ("12.5mm", "belongs into the header"),
            ("12.5 deg", "belongs into the header"),
            ("# end", "no comments"),
        ] {
            assert!(hint(cell).contains(words), "{cell}: {}", hint(cell));
        }
        for cell in ["", "much", "nan", "inf", "1e400", "1e5e5"] {
            assert_eq!(hint(cell), "", "{cell}");
        }
    }
}
