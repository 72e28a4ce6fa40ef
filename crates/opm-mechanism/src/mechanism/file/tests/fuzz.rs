//! Whatever the text is, reading it gives an answer with locations inside the text, never a panic
//! and never an invalid number.

use super::JOINTS;
use crate::mechanism::examples::EXAMPLES;
use crate::mechanism::file::read;
use proptest::prelude::*;

/// Pieces of valid and of invalid files.
const PIECES: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1e308",
    "1e-320",
    "0",
    "-0.0",
    "0x7fffffffffffffff",
    "1e9",
    "99999999999999999999999999999999999999999999",
    "\"\"",
    "\"é\"",
    "[]",
    "{}",
    "[[]]",
    "true",
    "1979-05-27",
    "=",
    "\n",
    "[",
    "]",
    "{",
    "}",
    ",",
    "\"",
    "'''",
    "#",
    "\u{0}",
    "\u{feff}",
    "é",
    "[[leg]]",
    "[leg]",
    "[arm_leg]",
    "axis",
    "limits",
    "home",
    "pitch = 0",
    "type = \"spherical\"",
    "format = 1",
    "family = \"plano-spherical\"",
    ".",
    "180",
    "-200",
    "[0, 0, 0]",
];

fn assert_answered(text: &str) -> Result<(), TestCaseError> {
    match read(text) {
        Ok(file) => {
            let mechanism = file.mechanism;
            prop_assert!(mechanism.legs.len() >= 2);
            prop_assert!(mechanism.platform.iter().all(|v| v.is_finite()));
            for joint in mechanism.joints() {
                prop_assert!((joint.axis.norm() - 1.0).abs() < 1e-9);
                prop_assert!(joint.point.iter().all(|v| v.is_finite()));
                for coordinate in &joint.coordinates {
                    prop_assert!(coordinate.home.is_finite());
                    if let Some([low, high]) = coordinate.limits {
                        prop_assert!(low <= high && high.is_finite() && low.is_finite());
                    }
                }
            }
            for leg in &mechanism.legs {
                prop_assert!(leg.imaginary.iter().all(|label| label.home.is_finite()));
            }
        }
        Err(errors) => {
            prop_assert!(!errors.problems.is_empty());
            for problem in &errors.problems {
                prop_assert!((1..=text.matches('\n').count() + 1).contains(&problem.line));
                prop_assert!(problem.column >= 1 && !problem.message.is_empty());
                prop_assert!(!problem.message.contains('\n'), "{problem}");
            }
        }
    }
    Ok(())
}

/// A valid file with some of its bytes, words or lines replaced, doubled or removed.
fn mutated() -> impl Strategy<Value = String> {
    let texts: Vec<&str> = EXAMPLES.iter().map(|e| e.text).chain([JOINTS]).collect();
    let cut = (any::<prop::sample::Index>(), 0..12_usize);
    let piece = prop::sample::select(PIECES);
    let edits = prop::collection::vec((cut, piece, 0..4_u8), 1..6);
    (prop::sample::select(texts), edits).prop_map(|(text, edits)| {
        let mut text: Vec<char> = text.chars().collect();
        for ((at, length), piece, how) in edits {
            let start = at.index(text.len() + 1);
            let end = (start + length).min(text.len());
            let old: String = text[start..end].iter().collect();
            let new = match how {
                0 => piece.to_owned(),
                1 => format!("{old}{piece}"),
                2 => format!("{old}{old}"),
                _ => String::new(),
            };
            text.splice(start..end, new.chars());
        }
        text.into_iter().collect()
    })
}

/// A valid file with one number or string replaced.
fn other_value() -> impl Strategy<Value = String> {
    let texts: Vec<&str> = EXAMPLES.iter().map(|e| e.text).chain([JOINTS]).collect();
    let piece = prop::sample::select(PIECES);
    (prop::sample::select(texts), any::<prop::sample::Index>(), piece).prop_map(
        |(text, which, piece)| {
            let is_value = |c: char| c.is_ascii_alphanumeric() || "+-.\"".contains(c);
            let starts: Vec<_> = text
                .char_indices()
                .zip(text.chars().skip(1))
                .filter(|&((_, before), c)| " [".contains(before) && is_value(c))
                .map(|((at, _), _)| at + 1)
                .collect();
            let start = starts[which.index(starts.len())];
            let length = text[start..].find(|c| !is_value(c)).unwrap_or(text.len() - start);
            format!("{}{piece}{}", &text[..start], &text[start + length..])
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_answered(text in any::<String>()) {
        assert_answered(&text)?;
    }

    #[test]
    fn text_of_the_pieces_of_files_is_answered(
        pieces in prop::collection::vec(prop::sample::select(PIECES), 0..40),
    ) {
        assert_answered(&pieces.concat())?;
        assert_answered(&format!("{JOINTS}{}", pieces.join(" ")))?;
    }

    #[test]
    fn mutated_files_are_answered(text in mutated()) {
        assert_answered(&text)?;
    }

    #[test]
    fn files_with_other_values_are_answered(text in other_value()) {
        assert_answered(&text)?;
    }
}
