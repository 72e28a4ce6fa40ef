//! `opm explore`: the page carries the mechanism file, and wrong input is told. What a browser makes of the page is tested
//! in `tests/python`.

use crate::PLANO;
use crate::run::{Folder, opm};

#[test]
fn the_page_carries_the_mechanism_with_its_changes() {
    let folder = Folder::new();
    let file = folder.arg("robot.html");
    let run = opm(&["explore", PLANO, "--set", "leg1.h=131mm", "-o", &file]);
    assert_eq!(run.text(), "");
    assert!(run.stderr.contains("robot.html: open it in a browser"), "{}", run.stderr);
    assert_eq!(folder.names(), ["robot.html"]);
    let page = folder.read("robot.html");
    let (_, rest) = page.split_once(r#"id="opm-file">"#).unwrap();
    let (carried, _) = rest.split_once("</script>").unwrap();
    let carried: serde_json::Value = serde_json::from_str(carried).unwrap();
    let text = carried["text"].as_str().unwrap();
    assert_eq!(carried["name"], "plano-spherical-5dof.toml");
    assert_eq!(text.lines().filter(|line| line.starts_with("h = 131")).count(), 1, "{text}");
    assert_eq!(opm(&["explore", PLANO, "--set", "leg1.h=131mm"]).text(), page);
}

#[test]
fn what_cannot_be_explored_is_told() {
    let folder = Folder::new();
    let wrong = opm(&["explore", PLANO, "-o", &folder.arg("robot.txt")]);
    wrong.fails(2, &["--output", "expected a name that ends in .html"]);
    let page = folder.arg("robot.html");
    opm(&["explore", "bennett-double-spherical-6r", "-o", &page]).fails(1, &["opm linkage"]);
    assert!(folder.names().is_empty());
}
