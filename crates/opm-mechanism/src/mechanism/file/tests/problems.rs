//! Every kind of mistake, with its location and its message.

use super::{JOINTS, RAIL};
use crate::mechanism::file::{FileErrors, read};

const PLANO: &str = include_str!("../../../../../opm-core/mechanisms/plano-spherical-5dof.toml");
const HELICAL: &str =
    include_str!("../../../../../opm-core/mechanisms/translational-helical-3dof.toml");

fn problems(text: &str) -> FileErrors {
    match read(text) {
        Err(errors) => errors,
        Ok(_) => panic!("no problem found in\n{text}"),
    }
}

/// Line and column of the only occurrence of `mark`.
fn location_of(text: &str, mark: &str) -> (usize, usize) {
    assert_eq!(text.matches(mark).count(), 1, "{mark:?} in\n{text}");
    let (i, line) = text.lines().enumerate().find(|(_, line)| line.contains(mark)).unwrap();
    (i + 1, line.split(mark).next().unwrap().chars().count() + 1)
}

/// Replaces `from`, which occurs once, by `to` and expects exactly one problem, at the mark `^` in
/// `to`. The mark itself is removed.
fn assert_problem(base: &str, from: &str, to: &str, message: &str) {
    assert_eq!(base.matches(from).count(), 1, "{from:?}");
    let marked = base.replace(from, to);
    let place = location_of(&marked, "^");
    let text = marked.replace('^', "");
    let errors = problems(&text);
    let [problem] = &errors.problems[..] else { panic!("{from} -> {to}: {errors}") };
    assert!(problem.message.contains(message), "{message:?} in {problem}");
    assert_eq!((problem.line, problem.column), place, "{problem}");
}

#[test]
fn the_first_lines() {
    for (from, to, message) in [
        ("format = 1\n", "", "`format` is missing, expected format = 1"),
        ("format = 1\n", "format = 2\n", "`format` is 2, expected 1"),
        ("format = 1\n", "format = 1.0\n", "`format` is a number, expected an integer"),
        (
            "format = 1\n",
            "format = 99999999999999999999\n",
            "expected an integer of at most 64 bits",
        ),
        ("name = \"pair\"\n", "", "`name` is missing"),
        ("units = { length = \"mm\", angle = \"deg\" }\n", "", "`units` is missing"),
        ("[platform]\npoint = [10, 20, 30]\n", "", "`platform` is missing"),
    ] {
        let text = JOINTS.replace(from, to);
        let errors = problems(&text);
        assert!(errors.problems[0].message.contains(message), "{errors}");
        assert_eq!(errors.problems.len(), 1, "{errors}");
        let (line, column) = if to.is_empty() { (1, 1) } else { (1, 10) };
        assert_eq!((errors.problems[0].line, errors.problems[0].column), (line, column));
    }
    for (from, to, message) in [
        (r#"name = "pair""#, "name = ^3", "`name` is an integer, expected a string"),
        (r#"name = "pair""#, r#"name = ^"""#, "expected a name"),
        (r#"name = "pair""#, r#"name = ^"a\nb""#, "expected a name"),
        (
            r#"name = "pair""#,
            "name = \"pair\"\n^nmae = 1",
            "unknown key `nmae`, did you mean `name`?",
        ),
        (
            r#"name = "pair""#,
            "name = \"pair\"\n^colour = 1",
            "unknown key `colour`, expected one of",
        ),
        (r#""mm""#, r#"^"mmm""#, "`length` is \"mmm\", did you mean `mm`? expected one of"),
        (r#""mm""#, r#"^"furlong""#, "expected one of `m`, `cm`, `mm`, `um`, `in`"),
        (r#""deg""#, r#"^"grad""#, "did you mean `rad`"),
        (r#"{ length = "mm", angle = "deg" }"#, r#"^{ length = "mm" }"#, "`angle` is missing"),
        (
            r#"{ length = "mm", angle = "deg" }"#,
            r#"^"SI""#,
            "`units` is a string, expected a table",
        ),
        (
            r#"angle = "deg" }"#,
            r#"angle = "deg", ^mass = "kg" }"#,
            "unknown key `mass`, expected one of `length`, `angle`",
        ),
        (
            r#"name = "pair""#,
            "name = \"pair\"\nfamily = ^\"plano\"",
            "`family` is \"plano\", did you mean `plano-spherical`? expected one of",
        ),
        (
            r#"name = "pair""#,
            "name = \"pair\"\nfamily = ^\"plano-sperical\"",
            "did you mean `plano-spherical`?",
        ),
    ] {
        assert_problem(JOINTS, from, to, message);
    }
}

#[test]
fn text_that_is_not_toml() {
    let errors = problems("format = 1\nname = \"a\nunits = {}\n");
    assert_eq!(errors.problems[0].line, 2, "{errors}");
    let errors = problems("format = 1\nname = \"a\"\nname = \"b\"\n");
    assert_eq!(errors.to_string(), "3:1: duplicate key");
    let errors = problems("format = 1\n[[leg]\n");
    assert_eq!(errors.problems[0].line, 2, "{errors}");
    assert!(errors.in_file("a.toml").starts_with("a.toml:2:"), "{errors}");
    let errors = problems(&format!("{JOINTS}\"a\\nb\" = 1\n"));
    assert!(errors.to_string().starts_with("25:1: unknown key `a\\nb`"), "one line: {errors}");
    assert_eq!(problems("").to_string(), "1:1: `format` is missing, expected format = 1");
}

#[test]
fn joints() {
    let r1 = r#"{ name = "r1", type = "revolute", axis = [0, 0, 2], point = [100, 40, 0], home = 90, limits = [0, 180] }"#;
    for (from, to, message) in [
        (
            "point = [10, 20, 30]",
            "point = ^[10, 20]",
            "`point` has 2 values, expected a point [x, y, z]",
        ),
        (
            "point = [10, 20, 30]",
            "point = [10, ^nan, 30]",
            "`point` is nan, expected a finite number",
        ),
        (
            "point = [10, 20, 30]",
            "point = [10, ^-inf, 30]",
            "`point` is -inf, expected a finite number",
        ),
        ("point = [10, 20, 30]", "point = [10, ^1e400, 30]", "is 1e400, expected a finite number"),
        (
            "point = [10, 20, 30]",
            "point = [10, ^1e13, 30]",
            "expected an absolute value of at most 1000000000000 mm",
        ),
        (
            "point = [10, 20, 30]",
            "point = [10, \"^x\", 30]",
            "`point`: `x` is not a parameter; expected a number, or an expression",
        ),
        ("axis = [0, 0, -2]", "axis = ^[0, 0, 0]", "`axis` is zero, expected a direction"),
        (
            "[task]\naxis = [0, 0, -2]",
            "[task]\n^axes = [0, 0, -2]",
            "did you mean `axis`? expected one of `axis`, `lower`, `upper`",
        ),
        ("[task]\naxis", "[task]\nlower = ^1\naxis", "`lower` is an integer, expected a table"),
        ("[task]\naxis", "[task]\nlower = { ^y = [0, 1, 0] }\naxis", "unknown key `y`"),
        ("[task]\naxis", "[task]\nlower = { x = ^[0, 0, 0] }\naxis", "`x` is zero"),
        ("[task]\naxis", "[task]\nupper = { w = \"^up\" }\naxis", "`w`: `up` is not a parameter"),
        ("[task]\naxis", "[task]\nupper = { normal = ^[0, 1] }\naxis", "has 2 values, expected"),
        ("[task]\naxis", "[task]\nupper = { origin = [0, ^nan, 1] }\naxis", "expected a finite"),
        ("axis = [0, 3, 4]", "axis = ^[0, 0.0, -0.0]", "`axis` is zero"),
        ("actuated = true", "actuated = ^1", "`actuated` is an integer, expected true or false"),
        (
            r#""prismatic""#,
            r#"^"prism""#,
            "`type` is \"prism\", did you mean `prismatic`? expected one of `revolute`",
        ),
        (r#""prismatic""#, r#"^"revolut""#, "did you mean `revolute`?"),
        (
            "limits = [-300, 300]",
            "limits = ^[300, -300]",
            "`limits` are reversed: 300 mm is above -300 mm",
        ),
        (
            "limits = [-300, 300]",
            "limits = ^[-300, 10]",
            "`limits` exclude home: S1 is 12.5 mm there, expected it between -300 mm and 10 mm",
        ),
        (
            "limits = [-300, 300]",
            "limits = ^[-300]",
            "has 1 value, expected limits [lowest, highest]",
        ),
        (
            "limits = [-300, 300]",
            "limits = ^300",
            "is an integer, expected limits [lowest, highest]",
        ),
        ("limits = [-300, 300]", "limits = [-300, ^inf]", "is inf, expected a finite number"),
        (r#"name = "r1", "#, r#"name = ^"S1", "#, "two joints are called \"S1\""),
        (r#"name = "r1", "#, r#"name = ^"a=b", "#, "expected a name"),
        (r1, "^3", "`joints` is an integer, expected a table"),
        (", pitch = -20", ", pitch = ^0", "`pitch` is 0, expected an advance per radian"),
        (
            "limits = [0, 180]",
            "limits = [0, 180], ^pitch = 3",
            "unknown key `pitch`, expected one of",
        ),
        ("axis2 = [0, 1, 0]", "axis2 = ^[-7, 0, 0]", "`axis2` is parallel to `axis`"),
        (
            "home = [10, -20]",
            "home = ^[10]",
            "`home` has 1 value, expected 2 values, one for each coordinate",
        ),
        ("home = [30, 7]", "home = ^3", "`home` is an integer, expected 2 values"),
        ("[[0, 90], [-30, 30]]", "^[[0, 90]]", "expected 2 pairs [lowest, highest], one for each"),
        ("[[0, 90], [-30, 30]]", "[[0, 90], ^[30, -30]]", "are reversed: 30 deg is above -30 deg"),
        ("[[0, 90], [-30, 30]]", "^[[0, 90], [-10, 30]]", "exclude home: u1.2 is -20 deg there"),
        (r#""spherical", "#, r#""spherical", ^axis = [0, 0, 1], "#, "unknown key `axis`"),
        (
            r#""spherical", "#,
            r#""spherical", cone = ^0, "#,
            "has the angle 0 deg, expected one above 0",
        ),
        (r#""spherical", "#, r#""spherical", cone = ^180, "#, "and below 180 deg"),
        (r#""spherical", "#, r#""spherical", cone = ^[40], "#, "`cone` is an array"),
        (
            r#""spherical", "#,
            r#""spherical", cone = { angle = 9, ^axes = 1 }, "#,
            "did you mean `axis`",
        ),
        (r#""revolute", "#, r#""revolute", ^cone = 20, "#, "unknown key `cone`"),
        (
            r#"{ name = "s1", type = "spherical", "#,
            r#"^{ name = "s1", type = "spherical", cone = { angle = 20, axis = [1, 0, 0] }, "#,
            "the cone of s1 excludes home: the rod is 90 deg from its axis there, expected at most 20 deg",
        ),
        ("name = \"left\"", "name = ^true", "`name` is a boolean, expected a string"),
        ("name = \"left\"", "^nome = \"left\"", "did you mean `name`?"),
    ] {
        assert_problem(JOINTS, from, to, message);
    }
    for (from, to, mark, message) in [
        ("axis = [0, 3, 4], ", "", r#"{ name = "S1""#, "`axis` is missing, expected a direction"),
        ("point = [100, 40, 0], ", "", r#"{ name = "r1""#, "`point` is missing"),
        (", pitch = -20", "", r#"{ name = "h1""#, "`pitch` is missing"),
        ("axis2 = [0, 1, 0], ", "", r#"{ name = "u1""#, "`axis2` is missing"),
        (r#"type = "cylindrical", "#, "", r#"{ name = "c1""#, "`type` is missing"),
        ("name = \"u1\", ", "", r#"{ type = "universal""#, "`name` is missing"),
        ("name = \"left\"", "name = \"leg2\"", "[[leg]]\njoints", "two legs are called \"leg2\""),
        (
            r#"name = "r1", "#,
            r#"name = "c1.angle", "#,
            r#""c1""#,
            "two joints are called \"c1.angle\"",
        ),
        ("point = [10, 20, 30]\n", "", "[platform]", "`point` is missing"),
        ("name = \"r1\"", "name = \"x\"", "name = \"x\"", "\"x\" is the name of a task coordinate"),
        ("name = \"r1\"", "name = \"mode\"", "name = \"mode\"", "or a column of tables, expected"),
        (
            "name = \"r1\"",
            "name = \"tau.left\"",
            "name = \"tau.left\"",
            "\"tau.left\" is the name of that leg's imaginary joint, expected another for joints",
        ),
    ] {
        let text = JOINTS.replacen(from, to, 1);
        let errors = problems(&text);
        let [problem] = &errors.problems[..] else { panic!("{from}: {errors}") };
        assert!(problem.message.contains(message), "{message:?} in {problem}");
        let line = text[..text.find(mark).unwrap()].matches('\n').count() + 1;
        assert_eq!(problem.line, line, "{problem}");
    }
}

#[test]
fn numbers_of_legs_and_joints() {
    let one_leg = &JOINTS[..JOINTS.rfind("[[leg]]").unwrap()];
    let errors = problems(one_leg);
    assert_eq!(errors.to_string(), "11:1: found 1 table [[leg]], expected at least 2 legs");
    let no_legs = &JOINTS[..JOINTS.find("[[leg]]").unwrap()];
    assert_eq!(
        problems(no_legs).to_string(),
        "1:1: found 0 tables [[leg]], expected at least 2 legs"
    );
    let a_table = no_legs.to_owned() + "[leg]\nname = \"a\"\n";
    let expected = "11:1: `leg` is a table, expected an array of tables [[leg]]";
    assert_eq!(problems(&a_table).to_string(), expected);
    let no_joints = one_leg.to_owned() + "[[leg]]\njoints = []\n[[leg]]\nname = \"x\"\n";
    assert_eq!(
        problems(&no_joints).to_string(),
        "20:10: `joints` is empty, expected at least one joint\n\
         21:1: `joints` is missing, expected an array of joints, from base to platform"
    );
}

#[test]
fn plano_spherical() {
    // Leg 2 has the same lines as the other legs; only eta differs.
    let leg2 = |from: &str, to: &str, message: &str| {
        let start = PLANO.find("name = \"leg2\"").unwrap();
        let end = PLANO.find("name = \"leg3\"").unwrap();
        let leg = &PLANO[start..end];
        assert_eq!(leg.matches(from).count(), 1, "{from:?}");
        assert_problem(PLANO, leg, &leg.replace(from, to), message);
    };
    leg2("a1 = 200", "a1 = ^-200", "`a1` is -200 mm, expected a length above 0");
    leg2("a2 = 60", "a2 = ^0", "`a2` is 0 mm, expected a length above 0");
    leg2("h = 120", "h = ^-1", "`h` is -1 mm, expected a length of at least 0");
    leg2("h = 120", "h = ^nan", "`h` is nan, expected a finite number");
    leg2("alpha1 = 75", "alpha1 = ^0", "`alpha1` is 0 deg, expected an arc between 0 and 180 deg");
    leg2(
        "alpha2 = 75",
        "alpha2 = ^180",
        "`alpha2` is 180 deg, expected an arc between 0 and 180 deg",
    );
    leg2("beta = 60", "beta = ^true", "`beta` is a boolean, expected a number");
    leg2("beta = 60", "^bet = 60\nbeta = 60", "unknown key `bet`, did you mean `beta`?");
    leg2("[-300, 300]", "^[300, -300]", "are reversed: 300 mm is above -300 mm");
    leg2("{ S = [-300, 300] }", "^{ S = [-300, 100] }", "exclude home: S2 is 167.875 mm there");
    leg2("{ S = [-300, 300] }", "{ ^s = [-300, 300] }", "unknown key `s`, did you mean `S`?");
    leg2("name = \"leg2\"", "name = ^\"leg1\"", "`name` is \"leg1\" for two legs");
    for (from, to, message) in [
        ("b1 = 100", "b1 = ^0", "`b1` is 0 mm, expected a length above 0"),
        ("base = [0, 75]", "base = ^[0, 75, 0]", "has 3 values, expected a point [x, y]"),
        ("base = [0, 75]", "base = [^nan, 75]", "`base` is nan, expected a finite number"),
        (
            "\"++ ++ ++ +\"",
            "^\"++ ++ ++\"",
            "expected one sign for every choice, in a group for each leg, as in \"++ ++ ++ +\"",
        ),
        ("\"++ ++ ++ +\"", "^\"++ ++ +++ \"", "expected one sign for every choice"),
        ("\"++ ++ ++ +\"", "^\"++ ++ +x +\"", "contains 'x', expected signs + and -"),
        ("\"++ ++ ++ +\"", "^[1, 1]", "`mode` is an array, expected a string"),
        ("xi = 0", "xi = ^nan", "`xi` is nan, expected a finite number"),
        ("xi = 0, ", "^phi = 0, ", "unknown key `phi`, did you mean `psi`? expected one of"),
        ("family =", "^platform = 1\nfamily =", "unknown key `platform`"),
    ] {
        assert_problem(PLANO, from, to, message);
    }
}

#[test]
fn plano_spherical_as_a_whole() {
    let leg3 = PLANO.rfind("[[slider_leg]]").unwrap();
    let arm = PLANO.find("[arm_leg]").unwrap();
    let errors = problems(&format!("{}{}", &PLANO[..leg3], &PLANO[arm..]));
    assert_eq!(errors.to_string(), "15:1: `slider_leg` gives 2 legs, expected 3");
    let errors = problems(&PLANO[..arm]);
    assert_eq!(
        errors.to_string(),
        "1:1: `arm_leg` is missing, expected a table [arm_leg]: the RRS leg"
    );

    let far = PLANO.replace("x = 0, y = 0", "x = 0, y = -500");
    let errors = problems(&far);
    // P is 575 mm from D and the arm reaches 200 mm: 375 mm too far. The table [arm_leg] is on line
    // 51.
    let arm = errors.problems.last().unwrap();
    assert_eq!((arm.line, arm.column), (51, 1));
    assert!(arm.message.contains("out of this leg's reach by 375 mm"), "{errors}");

    let tilted = PLANO.replace("xi = 0", "xi = 100");
    let errors = problems(&tilted);
    // Leg 1's axis is 60 degrees from the platform's z, so now 160 degrees from z; the arcs reach
    // 150.
    assert_eq!(
        errors.problems[0].to_string(),
        "15:1: home is out of this leg's reach by 10 deg, expected arcs that reach it"
    );

    let several = PLANO
        .replace("\"deg\"", "\"grd\"")
        .replace("b1 = 100", "b1 = nan")
        .replace("b2 = 100", "b2 = -1")
        .replace("eta = 0 ", "eta = \"0\" ");
    let lines: Vec<_> = problems(&several).problems.iter().map(|p| p.line).collect();
    assert_eq!(lines[0], 10, "the unit");
    assert!(lines.contains(&22) && lines.contains(&54) && lines.contains(&55), "{lines:?}");
}

#[test]
fn translational_helical() {
    for (from, to, message) in [
        (
            "beta = 285",
            "beta = ^280",
            "alpha + beta = 250 deg, expected 255 deg, as for the first leg",
        ),
        ("k = 15", "k = ^nan", "`k` is nan, expected a finite number"),
        (
            "k = 15",
            "k = 15\npitch = ^10",
            "`pitch` is given for 2 legs, expected it for exactly one",
        ),
        ("pitch = 20", "pitch = ^0", "`pitch` is 0, expected an advance per radian"),
        ("alpha = 90", "^alfa = 90\nalpha = 90", "unknown key `alfa`, did you mean `alpha`?"),
        ("phi = 0", "^zeta = 0", "unknown key `zeta`, expected one of `x`, `y`, `phi`"),
        ("home =", "mode = ^\"+\"\nhome =", "`mode` is \"+\", expected an empty text"),
    ] {
        assert_problem(HELICAL, from, to, message);
    }
    let no_pitch: Vec<_> = HELICAL.lines().filter(|line| !line.starts_with("pitch")).collect();
    assert_eq!(
        problems(&no_pitch.join("\n")).to_string(),
        "13:1: `leg` has no `pitch`, expected it for exactly one leg, the helical one"
    );
    let two_legs = &HELICAL[..HELICAL.rfind("[[leg]]").unwrap()];
    assert_eq!(problems(two_legs).to_string(), "13:1: `leg` gives 2 legs, expected 3");
    let without = HELICAL.replace("k = 15\n", "");
    assert_eq!(
        problems(&without).to_string(),
        "21:1: `k` is missing, expected the distance along the common axis"
    );
}

#[test]
fn a_mode_without_choices_is_empty() {
    let text = HELICAL.replace("home =", "mode = \"\"\nhome =");
    assert_eq!(read(&text).unwrap().mode.as_deref(), Some(""));
}

#[test]
fn limits_of_differences() {
    let base = format!("{PLANO}\n# end\n");
    let given = |joints: &str, limits: &str| {
        format!("[[difference]]\njoints = {joints}\nlimits = {limits}\n")
    };
    for (joints, limits, message) in [
        ("^[\"S1\", \"S9\"]", "[-1, 1]", "`joints` cannot be used: no joint is named \"S9\""),
        ("^[\"S1\", \"S1\"]", "[-1, 1]", "\"S1\" is named twice, expected two joints"),
        ("^[\"S1\", \"phi14\"]", "[-1, 1]", "is an angle and the other a length"),
        ("^[\"S1\"]", "[-1, 1]", "`joints` has 1 names, expected those of two joints"),
        ("^\"S1\"", "[-1, 1]", "`joints` is a string, expected the names of two joints"),
        ("[\"S1\", \"S2\"]", "^[1, -1]", "are reversed: 1 mm is above -1 mm"),
        ("[\"S1\", \"S2\"]", "^[5, 9]", "`limits` exclude home: S1 - S2 is"),
        ("[\"S1\", \"S2\"]", "[^nan, 9]", "nan, expected a finite number"),
    ] {
        assert_problem(&base, "# end", &given(joints, limits), message);
    }
    let file = read(&base.replace("# end", &given("[\"S1\", \"S2\"]", "[-20, 30]"))).unwrap();
    assert_eq!(file.mechanism.differences[0].limits, [-0.02, 0.03]);
}

#[test]
fn limits_of_motion() {
    for (from, to, message) in [
        ("max_rate = 500", "max_rate = ^-500", "`max_rate` is -500 mm/s, expected a value above 0"),
        ("max_rate = 500", "max_rate = ^0", "`max_rate` is 0 mm/s, expected a value above 0"),
        ("max_rate = 500", "max_effort = ^-5", "`max_effort` is -5 N, expected a value above 0"),
        ("max_rate = 500", "max_rate = ^nan", "`max_rate` is nan, expected a finite number"),
        ("max_rate = 500", "max_rate = ^1e20", "expected an absolute value of at most"),
        ("max_rate = 500", "max_rate = ^[1]", "`max_rate` is an array, expected a number"),
        (
            "max_acceleration = 2e3",
            "max_acceleration = ^-1",
            "`max_acceleration` is -1 mm/s^2, expected a value above 0",
        ),
        (
            "max_rate = [360, 50]",
            "max_rate = ^[360]",
            "has 1 value, expected 2 values, one for each",
        ),
        ("max_rate = [360, 50]", "max_rate = [^-3, 50]", "`max_rate` is -3 deg/s, expected"),
        ("max_rate = 500", "^max_rates = 500", "unknown key `max_rates`, did you mean `max_rate`?"),
    ] {
        assert_problem(JOINTS, from, to, message);
    }
    for (to, message) in [
        ("b2 = 100\nmax_rate = { phi1 = ^-2 }", "`phi1` is -2 deg/s, expected a value above 0"),
        ("b2 = 100\nmax_rate = ^5", "`max_rate` is an integer, expected a table"),
        ("b2 = 100\nmax_acceleration = { ^phi = 2 }", "unknown key `phi`, did you mean `phi1`?"),
    ] {
        assert_problem(PLANO, "b2 = 100", to, message);
    }
}

#[test]
fn obstacles_and_radii() {
    let with = |text: &str| format!("{JOINTS}\n{text}\n");
    let marked = |text: &str, message: &str| {
        let text = with(text);
        let place = location_of(&text, "^");
        let errors = problems(&text.replace('^', ""));
        let [problem] = &errors.problems[..] else { panic!("{text}: {errors}") };
        assert!(problem.message.contains(message), "{message:?} in {problem}");
        assert_eq!((problem.line, problem.column), place, "{problem}");
    };
    for (text, message) in [
        ("[bodies]\ncentres = { platform = ^[1, 2] }", "`platform` has 2 values, expected a point"),
        ("[bodies]\ninertias = { platform = ^[1, 2] }", "has 2 values, expected [xx, yy, zz] or"),
        ("[bodies]\ninertias = { platform = [1, ^2e12, 1] }", "is 2000000000000 kg m^2, expected"),
        ("[bodies]\ninertias = { platform = ^[1, 1, 3] }", "is the inertia of no body"),
        ("[bodies]\ninertias = { platform = ^[1, 1, 1, 2, 0, 0] }", "moments are -1.000e0, 1"),
        ("[bodies]\ninertias = { c1 = [1, 1, 1], s7 = ^[1, 1, 1] }", "no body is called \"s7\""),
        ("[bodies]\npayload = ^{ centre = [0, 0, 0] }", "`mass` is missing, expected the payload"),
        ("[bodies]\npayload = { mass = ^0 }", "`mass` is 0 kg, expected 1e-9 to 1000000.0 kg"),
        (
            "[bodies]\npayload = { mass = 1, centre = ^3 }",
            "`centre` is an integer, expected a point",
        ),
        ("[bodies]\npayload = { mass = 1, ^weight = 3 }", "unknown key `weight`"),
        ("[bodies]\nradius = ^0", "`radius` is 0 mm, expected a length above 0"),
        ("[bodies]\nradii = { platform = ^-2 }", "`platform` is -2 mm, expected a length above 0"),
        ("[bodies]\nradii = { c1 = 2, s7 = ^2 }", "no body is called \"s7\""),
        ("[bodies]\n^radious = 2", "unknown key `radious`, did you mean `radius`"),
        ("^[[obstacle]]\nname = \"a\"", "`type` is missing, expected the obstacle's type"),
        ("[[obstacle]]\ntype = ^\"ball\"", "`type` is \"ball\""),
        ("[[obstacle]]\ntype = \"box\"\ncentre = [0, 0, 0]\nsize = [1, ^0, 1]", "`size` is 0 mm"),
        ("[[obstacle]]\ntype = \"box\"\ncentre = [0, 0, 0]\nsize = ^[1, 1]", "`size` has 2 values"),
        (
            "[[obstacle]]\ntype = \"box\"\ncentre = [0, 0, 0]\nsize = [1, 1, 1]\nx = ^[0, 3, 0]",
            "`x` and `y` are parallel",
        ),
        (
            "[[obstacle]]\ntype = \"capsule\"\nfrom = [0, 0, 0]\nto = [0, 0, 1]\nradius = ^-1",
            "`radius` is -1 mm",
        ),
        (
            "[[obstacle]]\ntype = \"half-space\"\npoint = [0, 0, 0]\nnormal = ^[0, 0, 0]",
            "`normal` is zero, expected a direction",
        ),
        (
            "[[obstacle]]\ntype = \"half-space\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n^size = 3",
            "unknown key `size`",
        ),
        (
            "[[obstacle]]\nname = ^\"platform\"\ntype = \"half-space\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]",
            "is the name of the platform",
        ),
    ] {
        marked(text, message);
    }
}

#[test]
fn parallelograms() {
    // The second parallelogram as two hinges.
    let joint = r#"{ name = "p2", type = "parallelogram", axis = [0, 1, 0], point = [250, 0, 0], point2 = [50, 0, -300] }"#;
    let hinges = r#"{ name = "r2", type = "revolute", axis = [0, 1, 0], point = [250, 0, 0] },
  { name = "q2", type = "revolute", axis = [0, 1, 0], point = [50, 0, -300], turns_back = true }"#;
    let base = RAIL.replace(joint, hinges);
    assert!(read(&base).is_ok() && base.contains("q2"));
    for (from, to, message) in [
        (", point2 = [-50, 0, -300]", "", "`point2` is missing"),
        ("point2 = [-50, 0, -300]", "point2 = 7", "`point2` is an integer"),
        (
            "point = [50, 0, -300]",
            "axis2 = [1, 0, 0], point = [50, 0, -300]",
            "unknown key `axis2`",
        ),
        ("point2 = [-50, 0, -300]", "point2 = [-250, 9, 0]", "the two axes of p1 are one line"),
        (
            "axis = [0, 1, 0], point = [50",
            "axis = [0, 1, 1], point = [50",
            "q2 turns back r2, but its `axis`",
        ),
        (
            r#""revolute", axis = [0, 1, 0], point = [250"#,
            r#""helical", pitch = 3, axis = [0, 1, 0], point = [250"#,
            "is not a revolute joint",
        ),
        (
            "turns_back = true",
            "turns_back = true, actuated = true",
            "q2 turns back and is actuated",
        ),
        ("name = \"r2\"", "name = \"p1.end\"", "p1.end"),
    ] {
        assert!(base.contains(from), "{from}");
        let text = base.replace(from, to);
        let errors = problems(&text);
        assert!(errors.problems[0].message.contains(message), "{message:?} in {errors}");
        assert_eq!(errors.problems.len(), 1, "{errors}");
    }
}
