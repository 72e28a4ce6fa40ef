//! The files that documents for contributors name are there.

use std::fs;
use std::path::{Path, PathBuf};

/// The documents, from the root of the repository.
const DOCUMENTS: [&str; 4] =
    ["ARCHITECTURE.md", "CONTRIBUTING.md", "README.md", "docs/extending.md"];

/// The folders that begin a path from the root.
const FOLDERS: [&str; 11] = [
    "benches",
    "cli",
    "crates",
    "data",
    "docs",
    "examples",
    "fuzz",
    "packaging",
    "py",
    "tests",
    "web",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The words between backticks, outside of blocks of code. What is between them may go on in the next line.
fn quoted(text: &str) -> Vec<String> {
    let mut fenced = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            prose += line;
            prose.push(' ');
        }
    }
    let words = prose.split('`').skip(1).step_by(2).filter(|word| !word.contains(' '));
    words.map(str::to_owned).collect()
}

/// The path that a word is, from the root; if a part of it is `NAME`, the folder that holds this.
fn path(word: &str) -> Option<PathBuf> {
    let (first, _) = word.split_once('/')?;
    let known = word.split("NAME").next().unwrap_or_default();
    let known = if known == word { word } else { &known[..=known.rfind('/')?] };
    FOLDERS.contains(&first).then(|| root().join(known))
}

#[test]
fn every_path_that_documents_name_is_there() {
    let mut checked = 0;
    for document in DOCUMENTS {
        let text = fs::read_to_string(root().join(document)).expect("a document");
        for path in quoted(&text).iter().filter_map(|word| path(word)) {
            assert!(path.exists(), "{document} names {}", path.display());
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked}");
}

/// A path of which a part is left out is not checked.
#[test]
fn steps_name_their_files_in_full() {
    let text = fs::read_to_string(root().join("docs/extending.md")).expect("a document");
    for word in quoted(&text).iter().filter(|word| word.ends_with(".rs")) {
        assert!(path(word).is_some(), "{word}");
    }
}

#[test]
fn paths_are_told_from_other_words() {
    let root = root();
    assert_eq!(path("crates/opm-core/src/NAME.rs"), Some(root.join("crates/opm-core/src/")));
    assert_eq!(path("tests/tests/paths.rs"), Some(root.join("tests/tests/paths.rs")));
    assert_eq!(path("MATCH"), None);
    assert_eq!(path("rad/s"), None);
    let text = "Use `a` and `b\nc`.\n```\n`d`\n```\n`e`";
    assert_eq!(quoted(text), ["a", "e"]);
}
