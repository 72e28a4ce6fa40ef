//! `opm convert`: mechanism files, written anew.

use crate::run::{Folder, opm};
use crate::{HELICAL, PLANO};

#[test]
fn a_list_of_joints_answers_as_its_family() {
    let folder = Folder::new();
    for (family, pose) in [(PLANO, "x=10mm,y=-5mm,xi=15deg"), (HELICAL, "x=5mm,phi=0.3")] {
        let list = folder.arg("list.toml");
        opm(&["convert", family, "--joints", "-o", &list]).text();
        let written = folder.read("list.toml");
        assert!(!written.contains("family") && written.contains("[[leg]]"), "{written}");
        assert_eq!(opm(&["convert", family, "--joints"]).text(), written);
        let ik = |file: &str| {
            opm(&["ik", file, "--pose", pose, "--all-modes", "--format", "json"]).json()
        };
        let (found, known) = (ik(&list), ik(family));
        let solutions = known["solutions"].as_array().unwrap();
        assert!(!solutions.is_empty());
        for (number, known) in solutions.iter().enumerate() {
            let found = &found["solutions"][number];
            assert_eq!(found["mode"], known["mode"]);
            for (name, known) in known["joints"].as_object().unwrap() {
                let off = found["joints"][name].as_f64().unwrap() - known.as_f64().unwrap();
                assert!(off.abs() < 1e-12, "{family} {name}: {off}");
            }
        }
    }
}

/// What is not changed keeps its text, comments too; what is changed is written in the units of the file.
#[test]
fn the_form_stays_without_the_flag() {
    let text = opm(&["examples", PLANO]).stdout;
    assert_eq!(opm(&["convert", PLANO]).text(), text);
    let changed = opm(&["convert", PLANO, "--set", "leg1.h=140mm"]);
    assert!(changed.text().contains("family") && changed.text().contains("h = 140"));
}

#[test]
fn wrong_input_is_told_and_leaves_no_file() {
    let folder = Folder::new();
    let own = folder.write("own.toml", opm(&["examples", PLANO]).stdout);
    opm(&["convert", &own, "--joints", "-o", &own])
        .fails_with_one_line(2, &["--output", "also the input"]);
    let nowhere = folder.arg("no/where.toml");
    opm(&["convert", PLANO, "-o", &nowhere]).fails_with_one_line(1, &["cannot create"]);
    opm(&["convert", "none.toml"]).fails_with_one_line(1, &["none.toml: No such file"]);
    assert_eq!(folder.names(), ["own.toml"]);
    // A value at home of a coordinate that the mechanism does not have is told where it stands.
    let list = opm(&["convert", PLANO, "--joints"]).stdout;
    let wrong = folder.write("wrong.toml", list.replace("home = { x = ", "home = { w = 1, x = "));
    opm(&["ik", &wrong, "--pose", "x=0"])
        .fails_with_one_line(1, &["wrong.toml:", "home gives `w`"]);
    let wrong =
        folder.write("wrong.toml", list.replace("home = { x = ", "home = { tilt = 1, x = "));
    opm(&["decompose", &wrong]).fails_with_one_line(1, &["wrong.toml:", "unknown key `tilt`"]);
}
