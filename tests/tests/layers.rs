//! The modules of the crates that hold the mathematics are layers: each uses only those before it, in its own crate or
//! in one below.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// The crates, lowest first, and the top-level modules of each. A module may use itself and those before it; each crate
/// re-exports the modules of those below under their names.
const CRATES: [(&str, &[&str]); 3] = [
    ("opm-geometry", &["text", "numeric", "numbers", "group", "chain", "boxes"]),
    ("opm-mechanism", &["mechanism", "table"]),
    (
        "opm-core",
        &[
            "mechanism",
            "decomposition",
            "task",
            "manipulator",
            "reach",
            "velocity",
            "forward",
            "motion",
            "trajectory",
            "enclosure",
            "linkage",
            "skeleton",
        ],
    ),
];

/// All modules, lowest first. What `opm-core` adds to `mechanism` is no layer of its own.
fn layers() -> Vec<&'static str> {
    let mut layers: Vec<_> = CRATES.iter().flat_map(|(_, modules)| *modules).copied().collect();
    let mut known = Vec::new();
    layers.retain(|layer| {
        let new = !known.contains(layer);
        known.push(*layer);
        new
    });
    layers
}

/// A module that uses one that is not below it.
#[derive(Debug, PartialEq)]
struct Violation {
    file: PathBuf,
    line: usize,
    module: String,
    uses: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, module, uses } = self;
        let reason = match layers().contains(&uses.as_str()) {
            true => format!("is above `{module}`"),
            false => "is not one of the layers (say where it really is)".to_owned(),
        };
        write!(f, "{}:{line}: `{module}` uses `{uses}`, which {reason}", file.display())
    }
}

fn rank(module: &str) -> Option<usize> {
    layers().iter().position(|layer| *layer == module)
}

/// The first names of the paths that begin with `crate::` in a line of code, also in braces.
fn used(line: &str) -> Vec<String> {
    let word = |text: &str| -> String {
        text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let mut found = Vec::new();
    for (at, prefix) in line.match_indices("crate::") {
        let rest = &line[at + prefix.len()..];
        match rest.strip_prefix('{') {
            Some(list) => found.extend(list.split(',').map(|item| word(item.trim_start()))),
            None => found.push(word(rest)),
        }
    }
    found.retain(|name| name.starts_with(char::is_lowercase));
    found
}

/// What a source file uses that it must not; tests, which stand at its end, and comments may.
fn violations(file: &Path, module: &str, text: &str) -> Vec<Violation> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut found = Vec::new();
    for (number, line) in code.lines().enumerate() {
        let line = line.split("//").next().unwrap_or_default();
        for uses in used(line) {
            if rank(&uses).is_none_or(|layer| Some(layer) > rank(module)) {
                let (file, module) = (file.to_owned(), module.to_owned());
                found.push(Violation { file, line: number + 1, module, uses });
            }
        }
    }
    found
}

/// Every source file below a folder that is not tests alone.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the sources are there") {
        let path = entry.expect("an entry of a folder").path();
        let name = path.file_stem().unwrap_or_default();
        if name == "tests" {
            continue;
        }
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn source_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates").join(name).join("src")
}

#[test]
fn modules_use_only_the_layers_below_them() {
    let mut found = Vec::new();
    for (name, modules) in CRATES {
        let folder = source_folder(name);
        for path in sources(&folder) {
            let inside = path.strip_prefix(&folder).expect("a file in the folder");
            let top = inside.components().next().expect("a name").as_os_str();
            let module = top.to_str().expect("names are plain").trim_end_matches(".rs");
            if module == "lib" {
                continue;
            }
            let known = modules.contains(&module);
            assert!(known, "{}: `{module}` has no place in CRATES", path.display());
            let text = fs::read_to_string(&path).expect("sources can be read");
            found.extend(violations(&Path::new(name).join("src").join(inside), module, &text));
        }
    }
    let lines: Vec<String> = found.iter().map(Violation::to_string).collect();
    assert!(lines.is_empty(), "the order of the layers is {CRATES:?}\n{}", lines.join("\n"));
}

#[test]
fn every_layer_is_a_module() {
    for (name, modules) in CRATES {
        for module in modules {
            let file = source_folder(name).join(format!("{module}.rs"));
            assert!(file.exists(), "{}", file.display());
        }
    }
}

#[test]
fn what_is_above_is_found() {
    let text = "\
use crate::{group::Planar, velocity::SINGULAR};
use crate::numeric::Quantity; // crate::forward
/// See [`forward`](crate::forward).
fn plan() -> crate::forward::Plan {}
use crate::joint::Joint;
#[cfg(test)]
mod tests {
    use crate::skeleton;
}
";
    let found = violations(Path::new("src/chain.rs"), "chain", text);
    let told: Vec<String> = found.iter().map(Violation::to_string).collect();
    assert_eq!(
        told,
        [
            "src/chain.rs:1: `chain` uses `velocity`, which is above `chain`",
            "src/chain.rs:4: `chain` uses `forward`, which is above `chain`",
            "src/chain.rs:5: `chain` uses `joint`, which is not one of the layers (say where it \
             really is)",
        ]
    );
}
