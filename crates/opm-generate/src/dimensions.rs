//! The dimensions of a file in the first comment of its code, so that the code says which robot it is for.

use crate::Package;
use opm_core::mechanism::family::{Family, ParameterValue};
use opm_core::mechanism::file::{FileUnits, MechanismFile, NamedParameter, NamedValue};
use opm_core::text::visible;

/// How the first comment of every file that has one ends.
const MARK: &str = "write it anew rather than change it.";

/// The longest line, in characters: a text of a file may be of any length.
const WIDTH: usize = 120;

impl Package {
    /// The package with the names, the values and the units of the dimensions that its mechanism was made with, in the
    /// comment at the top of the file that has the geometry. A file that gives none by name changes nothing.
    #[must_use]
    pub fn with_dimensions(mut self, file: &MechanismFile) -> Self {
        let lines = lines(file);
        let name = &self.name;
        let own = [
            format!("{name}.c"),
            "src/lib.rs".into(),
            format!("{name}.py"),
            format!("+{name}/default.m"),
            format!("{name}.st"),
        ];
        let code = self.files.iter_mut().find(|(path, _)| own.contains(path));
        if let (Some((path, text)), false) = (code, lines.is_empty()) {
            *text = told(text, &lines, path.ends_with(".rs"));
        }
        self
    }
}

/// A text with lines in its first comment, in a block of code where comments are documentation that a program reads.
fn told(text: &str, lines: &[String], fenced: bool) -> String {
    let Some(mark) = text.find(MARK) else { return text.to_owned() };
    let start = text[..mark].rfind('\n').map_or(0, |end| end + 1);
    let before = &text[start..mark];
    let before = &before[..before.find("Written").unwrap_or_default()];
    let end = mark + text[mark..].find('\n').unwrap_or(text.len() - mark);
    // A comment that ends in this line goes on.
    let at = if text[..end].ends_with(['/', ')']) { mark + MARK.len() } else { end };
    let fence = |word: &str| if fenced { format!("{before}{word}\n") } else { String::new() };
    let mut block = format!("\n{}\n{before}It is for these dimensions:\n", before.trim_end());
    block += &format!("{}\n{}", before.trim_end(), fence("```text"));
    for line in lines {
        block += &format!("{before}{line}\n");
    }
    block += &fence("```");
    format!("{}{}{}", &text[..at], block.trim_end_matches('\n'), &text[at..])
}

/// A line for each dimension that the file gives by itself.
fn lines(file: &MechanismFile) -> Vec<String> {
    let named = file.parameters.iter().filter(|parameter| parameter.formula.is_none());
    let named: Vec<(String, String, &str)> =
        named.map(|one| of_parameter(one, file.mechanism.units)).collect();
    let family = file.family.iter().flat_map(Family::parameters);
    let of_family = family.filter_map(|(name, value)| {
        let quantity = file.quantity_of(&name)?;
        let numbers: Vec<String> = match value {
            ParameterValue::Number(value) => {
                vec![file.mechanism.units.show(value, quantity).to_string()]
            }
            ParameterValue::Pair(pair) => pair
                .iter()
                .map(|value| file.mechanism.units.show(*value, quantity).to_string())
                .collect(),
            ParameterValue::None => return None,
        };
        Some((name, numbers.join(", "), ""))
    });
    let all: Vec<_> = named.into_iter().chain(of_family).collect();
    let name_width = all.iter().map(|(name, ..)| name.chars().count()).max().unwrap_or(0);
    let width = all.iter().map(|(_, value, _)| value.chars().count()).max().unwrap_or(0);
    let line = |(name, value, text): &(String, String, &str)| {
        let line = format!("{name:<name_width$}  {value:>width$}  {text}");
        harmless(line.trim_end())
    };
    all.iter().map(line).collect()
}

fn of_parameter(parameter: &NamedParameter, units: FileUnits) -> (String, String, &str) {
    let show = |value: f64| parameter.unit.show(value, units);
    let value = match parameter.value {
        NamedValue::Number(value) => show(value),
        NamedValue::Point(point) => format!("({})", point.map(show).join(", ")),
    };
    (parameter.name.clone(), value, parameter.text.as_deref().unwrap_or_default())
}

/// A line that ends no comment, string or block of any language.
fn harmless(line: &str) -> String {
    let line = visible(line).replace(['\\', '"', '`'], "'");
    let line =
        line.replace("*/", "* /").replace("/*", "/ *").replace("*)", "* )").replace("(*", "( *");
    match line.char_indices().nth(WIDTH) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::Manipulator;
    use opm_core::mechanism::{examples, file};

    fn delta(text: &str) -> [Package; 5] {
        let file = file::read(text).unwrap();
        let m = Manipulator::new(file.mechanism.clone()).unwrap();
        [crate::c_package, crate::rust, crate::python, crate::matlab, crate::st].map(|generate| {
            generate(&m, crate::Content::Kinematics).unwrap().with_dimensions(&file)
        })
    }

    /// Every language says the dimensions, once, in front of its code.
    #[test]
    fn every_language_has_the_dimensions() {
        let text = examples::find("delta").unwrap().text;
        for package in delta(&text.replacen("value = 524", "value = 500", 1)) {
            let all: String = package.files.iter().map(|(_, text)| &**text).collect();
            for line in
                ["crank   500 mm  length of a crank", "start  -90 deg  direction of the first leg"]
            {
                assert_eq!(all.matches(line).count(), 1, "{line} {}", package.files[0].0);
            }
            assert!(!all.contains("tangent "), "what follows from others is not given");
        }
    }

    /// No text of a file ends a comment.
    #[test]
    fn a_text_stays_in_its_comment() {
        let text = examples::find("delta").unwrap().text;
        let foreign = r#"a */ b *) c \"\"\" d ``` e \\ /* (* \u001b f"#;
        for package in delta(&text.replacen("length of a crank", foreign, 1)) {
            let all: String = package.files.iter().map(|(_, text)| &**text).collect();
            let shown = "a * / b * ) c ''' d ''' e ' / * ( * 'u{1b} f";
            assert_eq!(all.matches(shown).count(), 1, "{}", package.files[0].0);
        }
    }

    #[test]
    fn a_plain_list_of_joints_is_left_as_it_is() {
        let file = file::read(examples::find("agile-eye").unwrap().text).unwrap();
        let m = Manipulator::new(file.mechanism.clone()).unwrap();
        let package = crate::c_package(&m, crate::Content::Kinematics).unwrap();
        assert_eq!(package.clone().with_dimensions(&file), package);
    }
}
