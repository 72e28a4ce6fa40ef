//! Which columns of a table are read, and by which names.

use crate::mechanism::file::Heading;
use std::str::FromStr;

/// Names for columns of a table that has others: `t=stamp,x=pos_x,y`. Columns that are not named are passed over.
///
/// ```
/// use opm_core::mechanism::file::Heading;
/// use opm_core::table::ColumnNames;
///
/// let names: ColumnNames = "t=stamp,x=pos_x,y".parse()?;
/// let name = |text| names.name_of(Heading::parse(text), text);
/// assert_eq!(name("pos_x [mm]"), Ok(Some("x")));
/// assert_eq!((name("y"), name("x")), (Ok(Some("y")), Ok(None)));
/// assert_eq!(names.missing(&["stamp", "y"]), Some(("x", "pos_x")));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ColumnNames(Vec<(String, String)>);

impl ColumnNames {
    /// Names, each with the heading of its column, with or without the unit.
    ///
    /// # Errors
    /// A name or a heading is empty or given twice, or there is none.
    pub fn new(pairs: Vec<(String, String)>) -> Result<Self, String> {
        if pairs.is_empty() {
            return Err("no columns, expected NAME=HEADING".to_owned());
        }
        for (number, (name, heading)) in pairs.iter().enumerate() {
            if name.is_empty() || heading.is_empty() {
                return Err(format!("{name}={heading}, expected NAME=HEADING"));
            }
            if pairs[..number].iter().any(|(other, _)| other == name) {
                return Err(format!("{name} is given twice"));
            }
            if let Some((other, _)) = pairs[..number].iter().find(|(_, other)| other == heading) {
                return Err(format!("column {heading} is both {other} and {name}"));
            }
        }
        Ok(Self(pairs))
    }

    /// The name of a column with this heading, whose text is all of it; `None` if it is not read.
    ///
    /// # Errors
    /// The heading ends in parentheses that may hold a unit, which is none that is known.
    pub fn name_of(&self, heading: Heading<'_>, text: &str) -> Result<Option<&str>, String> {
        let whole = self.0.iter().find(|(_, given)| given == text.trim());
        let found = whole.or_else(|| self.0.iter().find(|(_, given)| given == heading.name));
        match found {
            Some(_) if heading.unit.is_none() && text.trim_end().ends_with(')') => {
                Err("expected a unit that is known in the parentheses, such as mm or deg"
                    .to_owned())
            }
            found => Ok(found.map(|(name, _)| &**name)),
        }
    }

    /// The first name whose column is none of these headings, and its heading.
    pub fn missing(&self, headings: &[&str]) -> Option<(&str, &str)> {
        let has = |given: &str| {
            let is = |text: &str| text.trim() == given || Heading::parse(text).name == given;
            headings.iter().copied().any(is)
        };
        self.0.iter().find(|(_, given)| !has(given)).map(|(name, given)| (&**name, &**given))
    }
}

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pair = |part: &str| {
            let (name, heading) = part.split_once('=').unwrap_or((part, part));
            (name.trim().to_owned(), heading.trim().to_owned())
        };
        Self::new(text.split(',').map(pair).collect())
    }
}

/// What stands for a heading in a suggestion that cannot tell it.
const UNKNOWN: &str = "HEADING";

/// Which columns of a table were probably meant, each name with a heading: an advice for whoever has other names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion(pub Vec<(String, String)>);

impl Suggestion {
    /// For names that a table may have, and headings that it has. A time `t` is always among them, if it may be; and if no
    /// other is, all are.
    pub fn new<'n>(wanted: impl IntoIterator<Item = &'n str> + Clone, headings: &[&str]) -> Self {
        let names: Vec<&str> = headings.iter().map(|text| Heading::parse(text).name).collect();
        let known = |name: &str| names.contains(&name);
        let free: Vec<&str> = {
            let taken: Vec<&str> = wanted.clone().into_iter().collect();
            names.iter().copied().filter(|name| !taken.contains(name)).collect()
        };
        let meant = |wanted: &str| free.iter().copied().find(|name| means(name, wanted));
        let heading = |wanted: &'n str| if known(wanted) { Some(wanted) } else { meant(wanted) };
        let blind = wanted.clone().into_iter().all(|name| name == "t" || heading(name).is_none());
        let pair = |wanted: &'n str| {
            let heading = heading(wanted).or((wanted == "t" || blind).then_some(UNKNOWN))?;
            Some((wanted.to_owned(), heading.to_owned()))
        };
        Self(wanted.into_iter().filter_map(pair).collect())
    }
}

impl std::fmt::Display for Suggestion {
    /// As [`ColumnNames`] are written.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (number, (name, heading)) in self.0.iter().enumerate() {
            let comma = if number == 0 { "" } else { "," };
            match name == heading {
                true => write!(f, "{comma}{name}")?,
                false => write!(f, "{comma}{name}={heading}")?,
            }
        }
        Ok(())
    }
}

/// Whether a heading probably means a name: `time` and `header.stamp` mean `t`, `pos_x` and `X` mean `x`.
fn means(heading: &str, name: &str) -> bool {
    let heading = heading.to_lowercase();
    if name == "t" {
        return heading == "t"
            || ["time", "stamp", "sec"].iter().any(|word| heading.contains(word));
    }
    let name = name.to_lowercase();
    let mut words = heading.split(|c: char| !c.is_alphanumeric());
    heading == name || words.next_back() == Some(&*name) || words.next() == Some(&*name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meant_columns_are_suggested() {
        for (headings, expected) in [
            (&["time", "x (mm)", "y (mm)"][..], "t=time,x,y"),
            (&["stamp", "pos_x", "pos_y", "quality"], "t=stamp,x=pos_x,y=pos_y"),
            (&["t", "X", "y.position", "x2"], "t,x=X,y=y.position"),
            (&["a", "b"], "t=HEADING,x=HEADING,y=HEADING"),
            (&["time", "b"], "t=time,x=HEADING,y=HEADING"),
        ] {
            let found = Suggestion::new(["t", "x", "y"], headings).to_string();
            assert_eq!(found, expected, "{headings:?}");
        }
    }

    /// Feet would be read as metres.
    #[test]
    fn a_chosen_column_in_an_unknown_unit_is_refused() {
        let names: ColumnNames = "y=y (ft),x=x (in)".parse().unwrap();
        let name = |text| names.name_of(Heading::parse(text), text);
        assert!(name("y (ft)").is_err_and(|error| error.contains("a unit that is known")));
        assert_eq!(name("x (in)"), Ok(Some("x")));
        assert_eq!(name("z (ft)"), Ok(None));
    }

    #[test]
    fn wrong_choices_are_refused() {
        for (text, expected) in [
            ("", "expected NAME=HEADING"),
            ("t=,x", "t=, expected NAME=HEADING"),
            ("t=a,t=b", "t is given twice"),
            ("t=a,x=a", "column a is both t and x"),
        ] {
            let error = text.parse::<ColumnNames>().expect_err(text);
            assert!(error.contains(expected), "{text:?}: {error}");
        }
    }
}
