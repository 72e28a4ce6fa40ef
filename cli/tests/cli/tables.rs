//! Tables of other programs: one line says what is wrong and what to do; options read what can be read.

use crate::PLANO;
use crate::run::{Folder, Run, opm};

fn follow(folder: &Folder, table: &str, more: &[&str]) -> Run {
    let file = folder.write("motion.csv", table);
    opm(&[&["trajectory", PLANO, "--motion", &file, "--rate", "10", "-o", "-"], more].concat())
}

const PLAIN: &str = "t,x,xi\n0,0,0\n0.5,0.01,0.1\n";

#[test]
fn a_table_that_is_not_commas_and_points_is_told_in_one_line() {
    let folder = Folder::new();
    for (table, parts) in [
        ("t;x [mm]\n0;0\n1;20,5\n", &["motion.csv:1:1: ", "semicolons", "tr ';,' ',.' <"][..]),
        ("t\tx\n0\t0\n1\t0.01\n", &["motion.csv:1:1: ", "tabs", "tr '\\t,' ',.' <"]),
        ("t x xi\n0 0 0\n", &["motion.csv:1:1: ", "spaces", "tr -s ' ' ','"]),
        ("# by hand\nt,x\n0,0\n", &["motion.csv:1:1: ", "is a comment"]),
        ("t,x\n0,0\n# pause\n1,0\n", &["motion.csv:3:1: ", "no comments"]),
        ("t,x,xi\n0,0,0\n1,0,01,0\n2,0,02,0\n", &["motion.csv:3:1: 4 cells", "decimal commas"]),
        ("t,x\n0,0\n1,\"0,01\"\n", &["motion.csv:3:1: 3 cells", "within quotes"]),
        ("t,x [mm]\n0,0\n1,1 000\n", &["motion.csv:3:3: \"1 000\"", "separators of thousands"]),
        ("t,x\n0,0\n1,10mm\n", &["motion.csv:3:3: \"10mm\"", "into the header: x [mm]"]),
        ("0,0\n1,0.01\n", &["motion.csv:1:1: no header", "(x, y, zeta, xi, psi)"]),
        ("t,x\n2026-01-31T12:00,0\n2026-01-31T12:01,0\n", &["motion.csv:2:1: ", "a date"]),
        ("t,x\n0,nan\n1,0\n", &["motion.csv:2:3: \"nan\", expected a finite number"]),
        ("t,x\n0,0\n1,0\n0.5,0\n", &["motion.csv:4:1: t is 0.5 after 1, expected a later time"]),
        ("t,x,x\n0,0,0\n1,0,0\n", &["motion.csv:1:5: two columns are called x"]),
        ("t,x\n", &["motion.csv:1:1: 0 times given, expected at least 2"]),
        ("t,x (ft)\n0,0\n1,0\n", &["motion.csv:1:3: no coordinate \"x (ft)\""]),
    ] {
        follow(&folder, table, &[]).fails_with_one_line(1, parts);
    }
    // So do tables of poses and of joints.
    let poses = folder.write("poses.csv", "x;xi\n0;0\n");
    for command in ["ik", "fk", "analyze", "accuracy"] {
        opm(&[command, PLANO, "--poses", &poses, "--quiet"])
            .fails_with_one_line(1, &["poses.csv:1: the columns are separated by semicolons"]);
    }
    opm(&["calibrate", PLANO, "--measurements", &poses])
        .fails_with_one_line(1, &["poses.csv:1: the columns are separated by semicolons"]);
}

/// What other programs write around the same numbers does not matter.
#[test]
fn marks_quotes_and_line_ends_do_not_matter() {
    let folder = Folder::new();
    let plain = follow(&folder, PLAIN, &[]).text().to_owned();
    for table in [
        "\u{feff}t,x,xi\r\n0,0,0\r\n\r\n0.5,0.01,0.1\r\n",
        "\"t\" , \"x [mm]\",\"xi\"\n\"0\",0,0\n0.5,\"10\",0.1",
        "t (s),x(mm),xi (rad)\n0,0,0\n0.5,10,0.1\n",
    ] {
        assert_eq!(follow(&folder, table, &[]).text(), plain, "{table}");
    }
}

#[test]
fn other_names_of_columns_are_suggested_and_taken() {
    let folder = Folder::new();
    let plain = follow(&folder, PLAIN, &[]).text().to_owned();
    let table = "time,pos_x (mm),quality,xi\n0,0,9,0\n0.5,10,8,0.1\n";
    let advice = "--columns t=time,x=pos_x,xi says which columns to read";
    follow(&folder, table, &[])
        .fails_with_one_line(1, &["motion.csv:1:1: no coordinate \"time\"", "\"quality\"", advice]);
    let named = |columns: &str| follow(&folder, table, &["--columns", columns]);
    assert_eq!(named("t=time,x=pos_x,xi").text(), plain);
    assert_eq!(named("t=time, x=pos_x (mm), xi").text(), plain);
    named("t=time,x=pos_z")
        .fails_with_one_line(1, &["no column \"pos_z\" for x", "\"pos_x (mm)\""]);
    named("x=pos_x,xi").fails_with_one_line(1, &["motion.csv:1:1: no column t"]);
    named("t=time,yaw=quality").fails(1, &["motion.csv:1:17: "]);
    named("t=time,t=xi").fails(2, &["--columns", "t is given twice"]);
    let feet = "t,x (ft)\n0,0\n1,0.01\n";
    follow(&folder, feet, &["--columns", "t,x=x (ft)"])
        .fails_with_one_line(1, &["motion.csv:1:3: ", "a unit that is known"]);
    let motion = "plano-spherical-sinusoids";
    opm(&["trajectory", PLANO, "--motion", motion, "--columns", "t=time"])
        .fails_with_one_line(2, &["--columns", "expected a CSV file"]);

    let poses = folder.write("poses.csv", "pos_x [mm],quality\n10,9\n");
    opm(&["ik", PLANO, "--poses", &poses])
        .fails_with_one_line(1, &["poses.csv:1: column \"pos_x [mm]\"", "--columns x=pos_x says"]);
    let named = opm(&["ik", PLANO, "--poses", &poses, "--columns", "x=pos_x"]);
    let own = folder.write("own.csv", "x\n0.01\n");
    assert_eq!(named.text(), opm(&["ik", PLANO, "--poses", &own]).text());
    opm(&["ik", PLANO, "--pose", "x=0", "--columns", "x=pos_x"]).fails(2, &["--columns"]);
}

#[test]
fn times_since_1970_are_counted_from_the_first_row() {
    let folder = Folder::new();
    let plain = follow(&folder, PLAIN, &[]).text().to_owned();
    let table = "t,x,xi\n1700000000.25,0,0\n1700000000.75,0.01,0.1\n";
    let parts =
        ["motion.csv:2:1: t is \"1700000000.25\"", "seconds since 1970", "--relative-time counts"];
    follow(&folder, table, &[]).fails_with_one_line(1, &parts);
    assert_eq!(follow(&folder, table, &["--relative-time"]).text(), plain);
    let table = "t,x\n1700000000000,0\n1700000000500,0.01\n";
    for more in [&[][..], &["--relative-time"]] {
        follow(&folder, table, more).fails_with_one_line(1, &["motion.csv:2:1: ", "milliseconds"]);
    }
}

/// The hint that `opm ik --poses` gives, once for each column.
#[test]
fn a_motion_in_millimetres_without_units_gets_a_hint() {
    let folder = Folder::new();
    let run = follow(&folder, "t,x,xi\n0,0,0\n1,30,10\n2,40,20\n", &[]);
    let hints: Vec<&str> = run.stderr.lines().filter(|line| line.contains("has no unit")).collect();
    assert_eq!(hints.len(), 2, "{}", run.stderr);
    assert!(hints[0].contains("motion.csv:3: x has no unit and was read as 30 m"), "{hints:?}");
    assert!(hints[1].ends_with("if it is in deg, head the column xi [deg]"), "{hints:?}");

    let m = folder.write("m.csv", "x,S1,S2,S3\n0,167.9,0,0\n");
    let run = opm(&["calibrate", PLANO, "--measurements", &m]);
    assert!(
        run.stderr.contains("m.csv:2: S1 has no unit and was read as 167.9 m"),
        "{}",
        run.stderr
    );
}
