//! Files with `[parameters]`, expressions and patterns of legs.

use super::*;
use crate::mechanism::examples::find;
use crate::mechanism::family::ParameterValue;
use crate::mechanism::file::{NamedValue, ParameterUnit};
use crate::mechanism::joint::JointKind;
use crate::numeric::Quantity;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

const DELTA: &str = include_str!("delta.toml");

/// The problems of a text, each with its place.
fn problems(text: &str) -> Vec<String> {
    read(text).expect_err("problems").problems.iter().map(ToString::to_string).collect()
}

fn assert_near(one: &Mechanism, other: &Mechanism) {
    let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() < 1e-9;
    assert!(near(one.platform.coords, other.platform.coords));
    for (a, b) in one.legs.iter().zip(&other.legs) {
        assert_eq!(a.name, b.name);
        for (a, b) in a.joints.iter().zip(&b.joints) {
            assert_eq!((&a.name, a.actuated), (&b.name, b.actuated));
            assert!(near(a.point.coords, b.point.coords), "{} {} {}", a.name, a.point, b.point);
            assert!(near(*a.axis, *b.axis), "{} {} {}", a.name, *a.axis, *b.axis);
            if let (JointKind::Universal { second: a }, JointKind::Universal { second: b }) =
                (a.kind, b.kind)
            {
                assert!(near(*a, *b));
            }
        }
    }
}

/// It is compared with points and axes that were computed by hand from the printed numbers.
#[test]
fn a_delta_by_its_drawing_is_the_one_that_was_typed() {
    let file = read(DELTA).unwrap();
    let typed = read(include_str!("delta-typed.toml")).unwrap().mechanism;
    assert_near(&file.mechanism, &typed);
    assert_near(&read(find("delta").unwrap().text).unwrap().mechanism, &typed);
    let names: Vec<&str> = file.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["rb", "rp", "crank", "rod", "start", "level", "A", "B", "C", "tangent"]);
    let crank = file.parameter("crank").unwrap();
    assert_eq!((crank.value, crank.unit), (NamedValue::Number(0.524), ParameterUnit::Length));
    assert_eq!((crank.range, &crank.formula), ([Some(0.1), None], &None));
    assert!(file.parameter("rb").unwrap().text.as_deref().unwrap().contains("motors"));
    // It follows from no other.
    assert_eq!(file.parameter("level").unwrap().formula, None);
    assert_eq!(file.parameter("A").unwrap().formula.as_deref(), Some("polar(rb, start)"));
    assert_eq!(file.quantity_of("start"), Some(Quantity::Angle));
    assert!(file.is_plain("level") && file.quantity_of("level").is_none());
    let NamedValue::Point([_, y, _]) = file.parameter("B").unwrap().value else {
        panic!("a point")
    };
    assert!((y + 0.688).abs() < 1e-12);
}

/// A changed file is the same text with another number, and says what a text with this number says.
#[test]
fn a_change_of_a_parameter_changes_one_number_of_the_text() {
    let file = read(DELTA).unwrap();
    let changed = file.with([("crank", ParameterValue::Number(0.4))]).unwrap();
    let text = DELTA.replace("value = 524", "value = 400");
    assert_eq!(changed.text(), text);
    assert_eq!(changed.mechanism, read(&text).unwrap().mechanism);
    // The rods keep their length.
    for leg in &changed.mechanism.legs {
        assert!(((leg.joints[2].point - leg.joints[1].point).norm() - 1.244).abs() < 1e-12);
    }
    let back = changed.with([("crank", ParameterValue::Number(0.524))]).unwrap();
    assert_eq!(back, file);
    // One that follows from others is replaced.
    let fixed = file.with([("level", ParameterValue::Number(1.0))]).unwrap();
    assert!(fixed.text().contains("\nlevel = 1\n"), "{}", fixed.text());
    assert_eq!(fixed.parameter("level").unwrap().formula, None);
    // Two at once, and what is no parameter beside them.
    let limits = ParameterValue::Pair([-0.5, 1.0]);
    let both = file.with([("rb", ParameterValue::Number(0.2)), ("A1.limits", limits)]).unwrap();
    assert_eq!(both.mechanism.legs[0].joints[0].coordinates[0].limits, Some([-0.5, 1.0]));
    assert_eq!(both.mechanism.legs[1].joints[0].coordinates[0].limits, None);
    // One leg of a pattern alone cannot be said by its text.
    assert!(both.parameters.is_empty() && !both.text().contains("pattern"));
    assert_near(&read(&both.text()).unwrap().mechanism, &both.mechanism);
}

#[test]
fn a_change_that_does_not_assemble_says_which_construction_fails() {
    let file = read(DELTA).unwrap();
    let problem = |changes: &[(&str, ParameterValue)]| {
        file.with(changes.iter().copied()).unwrap_err().to_string()
    };
    let number = ParameterValue::Number;
    let said = problem(&[("rod", number(0.5))]);
    assert!(
        said.contains(
            "`C`: along: B is 644 mm from the line, expected at most R = 500 mm: 144 mm off"
        ),
        "{said}"
    );
    assert_eq!(problem(&[("crank", number(0.05))]), "`crank` is 50 mm, expected at least 100 mm");
    assert_eq!(problem(&[("rod", number(3.0))]), "`rod` is 3000 mm, expected at most 2000 mm");
    assert_eq!(
        problem(&[("A", number(1.0))]),
        "`A` is a point, expected a parameter that is a number"
    );
    assert_eq!(problem(&[("rb", ParameterValue::None)]), "`rb` is nothing, expected a number");
    assert!(problem(&[("rb", number(f64::NAN))]).contains("expected a finite number"));
    let said = problem(&[("crnk", number(0.4))]);
    assert!(said.contains("did you mean `crank`?"), "{said}");
}

#[test]
fn problems_of_expressions_have_their_place() {
    let with = |from: &str, to: &str| {
        assert!(DELTA.contains(from), "{from}");
        problems(&DELTA.replace(from, to))
    };
    let at = |text: &str, part: &str| {
        let before = &text[..text.find(part).unwrap()];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        format!("{line}:{column}: ")
    };
    let said = with("rb + crank", "rb + crnk");
    let place = at(&DELTA.replace("rb + crank", "rb + crnk"), "crnk");
    assert!(
        said[0]
            .starts_with(&format!("{place}`B`: `crnk` is not a parameter; did you mean `crank`?")),
        "{said:?}"
    );
    assert_eq!(said.len(), 1, "what follows from it is not told: {said:?}");

    let before = DELTA.replace("value = 164,", "value = \"rp + 1\",");
    assert_eq!(read(&before).unwrap().parameters[0].value, NamedValue::Number(0.045));
    let said = with("point = \"A\"", "point = \"A.x\"");
    assert!(said[0].contains("`point` is the number 0, expected a point [x, y, z]"), "{said:?}");
    let said = with("\"C.z\"", "\"C\"");
    assert!(said[0].contains("`point` is a point, expected a number"), "{said:?}");
    let said = with("axis = \"tangent\"", "axis = \"A - A\"");
    assert!(said[0].contains("`axis` is zero, expected a direction"), "{said:?}");
    let said = with("value = 44,", "value = 1e300,");
    assert!(
        said[0].contains("`rp` is") && said[0].contains("expected an absolute value of at most"),
        "{said:?}"
    );
}

#[test]
fn cycles_are_named() {
    let text = DELTA
        .replace("value = 164,", "value = \"rp + 1\",")
        .replace("value = 44,", "value = \"2*crank\",");
    let text = text.replace("value = 524,", "value = \"rb\",");
    let said = problems(&text);
    assert!(said[0].contains("`rb` depends on itself: rb -> rp -> crank -> rb"), "{said:?}");
    assert_eq!(said.len(), 1, "{said:?}");
    let own = problems(&DELTA.replace("value = 164,", "value = \"rb\","));
    assert!(own[0].contains("`rb` depends on itself: rb -> rb"), "{own:?}");
    // A long chain does not overflow the stack.
    let chain: String = (0..5000).map(|n| format!("p{n} = \"p{}\"\n", n + 1)).collect();
    let said = problems(&DELTA.replace("level = ", &format!("{chain}level = ")));
    assert!(said.iter().any(|said| said.contains("chain of more than")), "{said:?}");
}

#[test]
fn names_of_parameters_are_names() {
    for (name, expected) in [
        ("\"2a\"", "is no name of a parameter"),
        ("\"a b\"", "is no name of a parameter"),
        ("pi", "has another meaning"),
        ("sin", "has another meaning"),
        ("i", "has another meaning"),
        ("limits", "has another meaning"),
    ] {
        let said = problems(&DELTA.replace("level = \"2^0\"", &format!("level = 1\n{name} = 1")));
        assert!(said[0].contains(expected), "{name}: {said:?}");
    }
    let said = problems(&DELTA.replace("unit = \"angle\"", "unit = \"degrees\""));
    assert!(said[0].contains("expected one of `length`, `angle`, `number`"), "{said:?}");
    let said = problems(&DELTA.replace("min = 100", "least = 100"));
    assert!(said[0].contains("unknown key `least`"), "{said:?}");
}

/// Any number may be an expression, in files of families and without parameters, too.
#[test]
fn every_number_may_be_an_expression() {
    let text = find("plano-spherical-5dof").unwrap().text;
    let file = read(text).unwrap();
    let with = text.replacen("h = 120", "h = \"60*2\"", 1);
    assert_ne!(with, text);
    assert_eq!(read(&with).unwrap().mechanism, file.mechanism);
    let joints = find("agile-eye").unwrap().text;
    let said = problems(&joints.replacen("point = [0, ", "point = [\"rb\", ", 1));
    assert!(
        said[0].contains("expected a point") || said[0].contains("is not a parameter"),
        "{said:?}"
    );
}

/// Each leg of a pattern does what the first one does, seen from its own place; equal values of mirror images are images.
#[test]
fn legs_of_a_pattern_are_turned_and_mirrored() {
    let text = r#"
format = 1
name = "p"
units = { length = "m", angle = "deg" }
[platform]
point = [0, 0, 1]
[[leg]]
name = "leg{i}"
pattern = { angles = [0, 100], axis = [1, 2, 2], point = [0.1, 0.2, 0], mirror = { normal = [1, 1, 0], point = [0.3, 0, 0] } }
joints = [
  { name = "a{i}", type = "revolute", axis = [1, 2, 3], point = [1, 0, "0.1*i - 0.1*i"], actuated = true },
  { name = "b{i}", type = "helical", axis = [3, 2, 1], point = [1, 0, 1], pitch = 0.2 },
  { name = "c{i}", type = "cylindrical", axis = [0, 2, 1], point = [0, 1, 1], limits = [[-90, 90], [-1, 2]] },
  { name = "d{i}", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 1], point = [0, 0, 1] },
  { name = "e{i}", type = "prismatic", axis = [1, 1, 1], point = [0, 0, 0], limits = [-1, 3] },
]
"#;
    let mechanism = read(text).unwrap().mechanism;
    let names: Vec<&str> = mechanism.legs.iter().map(|leg| leg.name.as_str()).collect();
    assert_eq!(names, ["leg1", "leg2", "leg3", "leg4"]);
    assert_eq!(mechanism.legs[3].joints[2].name, "c4");
    let normal = Unit::new_normalize(Vector3::new(1.0, 1.0, 0.0));
    let through = Point3::new(0.3, 0.0, 0.0);
    let mirror = |p: Point3<f64>| p - *normal * (2.0 * normal.dot(&(p - through)));
    let centre = Point3::new(0.1, 0.2, 0.0);
    let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, 2.0));
    let turn = |p: Point3<f64>| {
        centre
            + nalgebra::UnitQuaternion::from_axis_angle(&axis, 100_f64.to_radians()) * (p - centre)
    };
    // The coordinates: a, b, c (an angle, a slide), d (two), e.
    let values = [0.3, -0.4, 0.5, 0.2, 0.7, -0.8, 0.1];
    let mut image = values;
    // A cylinder has one axis for its angle and its slide.
    image[3] = -image[3];
    let point = Point3::new(0.4, -0.2, 0.6);
    let moved = |leg: usize, values: &[f64], p: Point3<f64>| -> Point3<f64> {
        let g: Isometry3<f64> = mechanism.legs[leg].displacement(values).unwrap();
        g * p
    };
    let first = moved(0, &values, point);
    let near = |a: Point3<f64>, b: Point3<f64>| assert!((a - b).norm() < 1e-12, "{a} {b}");
    near(moved(1, &image, mirror(point)), mirror(first));
    near(moved(2, &values, turn(point)), turn(first));
    near(moved(3, &image, turn(mirror(point))), turn(mirror(first)));
    let limits = |leg: usize| mechanism.legs[leg].joints[2].coordinates[1].limits.unwrap();
    assert_eq!((limits(0), limits(1), limits(2)), ([-1.0, 2.0], [-2.0, 1.0], [-1.0, 2.0]));
}

#[test]
fn wrong_patterns_say_what_is_expected() {
    let with = |from: &str, to: &str| {
        assert!(DELTA.contains(from));
        problems(&DELTA.replace(from, to)).join("\n")
    };
    for (pattern, expected) in [
        ("{ count = 0 }", "`count` is 0, expected 1 to 100 legs"),
        ("{ count = 3, angles = [1] }", "`angles` is given beside `count`"),
        ("{ angles = [] }", "`angles` has 0 angles"),
        (
            "{ axis = [0, 0, 1] }",
            "`pattern` has no legs, expected `count`, `angles`, `repeat` or `mirror`",
        ),
        ("{ count = 3, repeat = 2 }", "`repeat` is given beside `count`, expected one of them"),
        ("{ repeat = 0 }", "`repeat` is 0, expected 1 to 100 legs"),
        (
            "{ count = 3, first = 0 }",
            "`first` is 0, expected the number of the first leg, 1 to 100",
        ),
        ("{ cuont = 3 }", "did you mean `count`?"),
        ("{ count = 3, axis = [0, 0, 0] }", "`axis` is zero, expected a direction"),
        ("{ mirror = { point = [0, 0, 0] } }", "`normal` is missing"),
        ("3", "`pattern` is an integer, expected a table"),
    ] {
        let said = with("{ count = 3 }", pattern);
        assert!(said.contains(expected), "{pattern}: {said}");
    }
    let said = with("\"A{i}\"", "\"A\"");
    assert!(
        said.contains("`name` is \"A\" in every leg of the pattern, expected a name with {i}"),
        "{said}"
    );
    let said = problems(&find("five-bar").unwrap().text.replacen("\"left\"", "\"leg{i}\"", 1));
    assert!(
        said[0].contains("`name` has {i}, which is the number of a leg of a `pattern`"),
        "{said:?}"
    );
}

/// Legs with points of their own are those that are typed one by one.
#[test]
fn repeated_legs_have_parameters_of_their_own() {
    let head = |legs: &str| {
        format!(
            r#"
format = 1
name = "p"
units = {{ length = "m", angle = "deg" }}
[parameters]
A3 = {{ value = [1, 2, 0], unit = "length" }}
A4 = {{ value = [-1, 2, 0], unit = "length" }}
low4b = {{ value = -3, unit = "length" }}
low3b = {{ value = -2, unit = "length" }}
[platform]
point = [0, 0, 1]
{legs}"#
        )
    };
    let leg = |number: &str, pattern: &str| {
        format!(
            r#"
[[leg]]
name = "leg{number}"
{pattern}
joints = [
  {{ name = "a{number}", type = "revolute", axis = [0, 0, 1], point = "2*A{number} + [0, 0, A{number}.x]" }},
  {{ name = "s{number}", type = "prismatic", axis = "A{number}", limits = ["low{number}b", 4] }},
]
"#
        )
    };
    let pattern = leg("{i}", "pattern = { repeat = 2, first = 3 }");
    let file = read(&head(&pattern)).unwrap();
    let typed = read(&head(&(leg("3", "") + &leg("4", "")))).unwrap();
    assert_near(&file.mechanism, &typed.mechanism);
    let limits = |file: &MechanismFile| -> Vec<_> {
        file.mechanism.coordinates().map(|c| c.limits).collect()
    };
    assert_eq!(limits(&file), limits(&typed));
    // None of them is a copy of another.
    assert!(file.patterns.is_empty());
    let changed = file.with([("low4b", ParameterValue::Number(-1.0))]).unwrap();
    let lows: Vec<f64> =
        changed.mechanism.coordinates().filter_map(|c| Some(c.limits?[0])).collect();
    assert_eq!(lows, [-2.0, -1.0]);
    // What all legs have is one number of the text.
    let limits = ParameterValue::Pair([-5.0, 5.0]);
    let changed = file.with([("limits", limits)]).unwrap();
    assert!(changed.text().contains("{ repeat = 2, first = 3 }"), "{}", changed.text());
    assert!(changed.text().contains("limits = [-5, 5]"), "{}", changed.text());
    // A name that there is not, and a number where there is no leg.
    let said = problems(&head(&pattern.replace("low{i}b", "lw{i}b")));
    assert!(said[0].contains("`lw3b` is not a parameter; did you mean `low3b`?"), "{said:?}");
    assert!(said[1].contains("did you mean `low4b`?"), "{said:?}");
    let alone = leg("{i}", "")
        .replace("name = \"leg{i}\"", "")
        .replace("\"a{i}", "\"a")
        .replace("\"s{i}", "\"s");
    let said = problems(&head(&alone));
    assert!(
        said[1].contains(
            "`point`: found {i}, which is the number of a leg in the joints of a `pattern`"
        ),
        "{said:?}"
    );
    let said = problems(&head(&pattern).replace("value = -2", "value = \"low{i}b\""));
    assert!(said[0].contains("`low3b`: found {i}"), "{said:?}");
}

/// What is changed of a shipped file by name changes its numbers, and nothing else of its text.
#[test]
fn texts_keep_what_is_not_changed() {
    let pair = ParameterValue::Pair;
    let number = ParameterValue::Number;
    let (stem, lift) = ("home = \"height\", limits = [650, 1300] },", "schoenflies-lift-4dof");
    for (name, change, from, to) in [
        (
            "tricept",
            ("S4.limits", pair([0.66, 1.3])),
            stem,
            "home = \"height\", limits = [660, 1300] },",
        ),
        ("tricept", ("S4.limits", ParameterValue::None), stem, "home = \"height\" },"),
        (
            "tricept",
            ("S4.max_rate", number(0.2)),
            stem,
            "home = \"height\", limits = [650, 1300], max_rate = 200 },",
        ),
        (
            lift,
            ("spin1.limits", pair([-0.5, 0.5])),
            "point = \"H + up\", actuated = true },",
            "point = \"H + up\", actuated = true, limits = [-28.64788975654116, 28.64788975654116] },",
        ),
        ("plano-spherical-5dof", ("leg1.h", number(0.13)), "h = 120", "h = 130"),
        (
            "plano-spherical-5dof",
            ("leg4.base", pair([0.01, 0.075])),
            "base = [0, 75] ",
            "base = [10, 75] ",
        ),
        // A limit of all legs is that of the pattern, whose numbers are no expressions any more.
        (
            "3-upu",
            ("limits", pair([0.4, 0.55])),
            "limits = [\"shortest\", \"longest\"]",
            "limits = [400, 550]",
        ),
    ] {
        let text = find(name).unwrap().text;
        let changed = read(text).unwrap().with([change]).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        assert_eq!(changed.text(), text.replacen(from, to, 1), "{name}");
        let again = read(&changed.text()).unwrap();
        assert_eq!(again.mechanism, changed.mechanism, "{name}");
        assert_eq!((again.family, again.parameters), (changed.family, changed.parameters));
    }
    // A table that is not there yet.
    let text = find("plano-spherical-5dof").unwrap().text;
    let changed = read(text).unwrap().with([("leg1.max_rate.S", number(0.2))]).unwrap();
    assert_eq!(read(&changed.text()).unwrap().family, changed.family);
    assert!(changed.text().starts_with(text.lines().next().unwrap()));
    // Two entries of such a table are not said by two tables: then the parameters are written anew.
    let both = [("leg1.max_rate.S", number(0.2)), ("leg1.max_rate.phi1", number(3.0))];
    let changed = read(text).unwrap().with(both).unwrap();
    assert_eq!(read(&changed.text()).unwrap().family, changed.family);
}
