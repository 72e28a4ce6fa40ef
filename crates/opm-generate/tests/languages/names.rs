//! Mechanisms whose names mean something else in a language.

use crate::python::interpreter;
use opm_core::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;
use opm_generate::{Content, GenerateError, Package};
use std::process::Command;

type Generate = fn(&Manipulator, Content) -> Result<Package, GenerateError>;

fn named(name: &str) -> Manipulator {
    let example = EXAMPLES.iter().find(|example| example.name == "planar-3rrr").unwrap();
    let own = format!("name = \"{name}\"");
    Manipulator::read(&example.text.replacen("name = \"planar-3rrr\"", &own, 1)).unwrap()
}

#[test]
fn words_of_a_language_are_no_names_of_packages() {
    let cases: [(Generate, &[&str]); 4] = [
        (opm_generate::c_package, &["math", "test", "all", "hal"]),
        (opm_generate::python, &["class", "lambda", "None", "numpy"]),
        (opm_generate::rust, &["fn", "Self", "crate", "core"]),
        (opm_generate::matlab, &["function", "end"]),
    ];
    for (generate, words) in cases {
        for word in words {
            let package = generate(&named(word), Content::Dynamics).unwrap();
            assert_eq!(package.name.to_lowercase(), format!("m_{}", word.to_lowercase()));
            let other = generate(&named(&format!("{word}-2")), Content::Dynamics).unwrap();
            assert_eq!(other.name.to_lowercase(), format!("{}_2", word.to_lowercase()));
        }
    }
}

/// The test beside the code imports the module by its name.
#[test]
fn a_module_that_is_called_by_a_keyword_is_imported() {
    let Some(python) = interpreter() else { return };
    let Package { name, files } = opm_generate::python(&named("class"), Content::Dynamics).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in files {
        std::fs::write(folder.path().join(file), text).unwrap();
    }
    let test = folder.path().join(format!("test_{name}.py"));
    let done = Command::new(python).arg("-B").arg(test).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// Comments are those of C, where results are left as they are and a missing limit is infinite.
#[test]
fn comments_are_true_in_other_languages() {
    let manipulator = named("five-bar");
    let all = |package: Package| -> String {
        // Comments are wrapped.
        let texts = package.files.into_iter().map(|(_, text)| text.replace('%', " "));
        texts
            .flat_map(|text| {
                text.split_whitespace().map(|word| format!("{word} ")).collect::<Vec<_>>()
            })
            .collect()
    };
    let c = all(opm_generate::c_package(&manipulator, Content::Dynamics).unwrap());
    assert!(c.contains("nothing is written") && c.contains("infinite without limits"));
    let matlab = all(opm_generate::matlab(&manipulator, Content::Dynamics).unwrap());
    assert!(!matlab.contains("nothing is written"));
    assert!(matlab.contains("Unless it returns 0, the others are NaN."));
    let st = all(opm_generate::st(&manipulator, Content::Dynamics).unwrap());
    assert!(!st.contains("infinite") && st.contains("(the largest number without limits)"));
}
