//! Hints for an unknown word: the known words, and the one that was probably meant.

/// The known word that was probably meant.
pub(in crate::mechanism) fn nearest<W: AsRef<str>>(found: &str, words: &[W]) -> Option<String> {
    let length = found.chars().count();
    if words.iter().all(|word| length > 2 * word.as_ref().chars().count() + 2) {
        return None;
    }
    let best = |distance: &dyn Fn(&str) -> usize, allowed: usize| {
        let distances = words.iter().map(|word| (distance(word.as_ref()), word.as_ref()));
        let (distance, word) = distances.min_by_key(|&(distance, _)| distance)?;
        (distance <= allowed).then(|| word.to_owned())
    };
    // Exchanging two letters takes two edits: still a slip in a word of four letters.
    let slip = best(&|word| edits(found, word), length.div_ceil(3).max(1));
    // Or the beginning of a word, with few slips: words of three letters begin too many others.
    let beginning = |word: &str| edits(found, &word.chars().take(length).collect::<String>());
    slip.or_else(|| if length > 3 { best(&beginning, length / 6) } else { None })
}

/// The text `expected A, B, C`, or `did you mean A? expected one of A, B, C` if one is similar.
#[cfg(feature = "files")]
pub fn expected_one_of(found: &str, words: &[&str]) -> String {
    let list = words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
    let expected = if words.len() == 1 { "expected" } else { "expected one of" };
    match nearest(found, words) {
        Some(word) => format!("did you mean `{word}`? {expected} {list}"),
        None => format!("{expected} {list}"),
    }
}

/// The Levenshtein distance of two words: how many letters must be inserted, deleted or replaced.
/// Upper and lower case are equal.
fn edits(a: &str, b: &str) -> usize {
    let (a, b) = (a.to_lowercase(), b.to_lowercase());
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.chars().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.chars().count()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distances_of_known_words() {
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("Alpha", "alpha"), 0);
        assert_eq!(edits("flaw", "lawn"), 2);
    }

    #[test]
    fn a_slip_is_recognised_and_another_word_is_not() {
        assert!(
            expected_one_of("lenght", &["length", "angle"]).starts_with("did you mean `length`")
        );
        assert!(expected_one_of("colour", &["length", "angle"]).starts_with("expected one of"));
        let names = ["agile-eye", "plano-spherical-5dof", "plano-spherical-5dof-joints"];
        for found in ["plano-spherical", "plano-sperical"] {
            let said = expected_one_of(found, &names);
            assert!(said.starts_with("did you mean `plano-spherical-5dof`?"), "{said}");
        }
        assert!(expected_one_of("spherical", &names).starts_with("expected one of"));
    }
}
