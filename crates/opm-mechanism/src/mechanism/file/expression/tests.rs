use super::*;
use crate::mechanism::file::{AngleUnit, LengthUnit};

/// Two numbers and two points, in millimetres and degrees.
struct Drawing;

impl Scope for Drawing {
    fn value(&self, name: &str) -> Found {
        Found::Term(match name {
            "rb" => Term::Number(200.0),
            "n" => Term::Number(3.0),
            "A" => Term::Vector(Vector3::new(1.0, 2.0, 3.0)),
            "O" => Term::Vector(Vector3::zeros()),
            "lost" => return Found::Without(None),
            _ => return Found::Nothing,
        })
    }

    fn names(&self) -> Vec<String> {
        ["rb", "n", "A", "O"].map(str::to_owned).to_vec()
    }

    fn units(&self) -> FileUnits {
        FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree }
    }
}

fn number(text: &str) -> f64 {
    match evaluate(text, &Drawing) {
        Ok(Term::Number(number)) => number,
        other => panic!("{text}: {other:?}"),
    }
}

fn vector(text: &str) -> Vector3<f64> {
    match evaluate(text, &Drawing) {
        Ok(Term::Vector(vector)) => vector,
        other => panic!("{text}: {other:?}"),
    }
}

fn fault(text: &str) -> (usize, String) {
    let fault = evaluate(text, &Drawing).expect_err(text);
    (fault.at, fault.message)
}

#[test]
fn numbers_bind_as_in_print() {
    for (text, expected) in [
        ("1 + 2*3", 7.0),
        ("(1+2)*3", 9.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("8/4/2", 1.0),
        ("1 - 2 - 3", -4.0),
        ("--3", 3.0),
        (" 1.5e2 ", 150.0),
        (".5", 0.5),
        ("rb/2 + n", 103.0),
        ("A.y * n", 6.0),
        ("[4, 5, 6].z", 6.0),
        ("pi", std::f64::consts::PI),
        ("min(3, 1, 2) + max(n, 9)", 10.0),
        ("hypot(3, 4)", 5.0),
        ("hypot(2, 3, 6)", 7.0),
        ("abs(-4) + sqrt(9)", 7.0),
    ] {
        assert!((number(text) - expected).abs() < 1e-12, "{text}: {}", number(text));
    }
}

/// Angles are those of the file, and what is exact on a drawing stays so.
#[test]
fn functions_of_angles_take_degrees() {
    for (text, expected) in [
        ("cos(60)", 0.5),
        ("sin(30)", 0.5),
        ("cos(90)", 0.0),
        ("sin(180)", 0.0),
        ("sin(-90)", -1.0),
        ("cos(240)", -0.5),
        ("cos(720 + 60)", 0.5),
    ] {
        assert_eq!(number(text), expected, "{text}");
    }
    for (text, expected) in [
        ("sin(40)", 40_f64.to_radians().sin()),
        ("tan(45)", 1.0),
        ("atan2(1, -1)", 135.0),
        ("asin(0.5)", 30.0),
        ("acos(-1)", 180.0),
        ("atan(1)", 45.0),
        ("rad(180)", std::f64::consts::PI),
    ] {
        assert!((number(text) - expected).abs() < 1e-12, "{text}: {}", number(text));
    }
    for degree in -800..800 {
        let angle = f64::from(degree).to_radians();
        assert!((number(&format!("sin({degree})")) - angle.sin()).abs() < 1e-13, "{degree}");
        assert!((number(&format!("cos({degree})")) - angle.cos()).abs() < 1e-13, "{degree}");
    }
}

#[test]
fn vectors_are_added_scaled_and_turned() {
    let near = |text: &str, expected: [f64; 3]| {
        assert!(
            (vector(text) - Vector3::from(expected)).norm() < 1e-12,
            "{text}: {}",
            vector(text)
        );
    };
    near("A + 2*[1, 0, -1]", [3.0, 2.0, 1.0]);
    near("-(A - O)/2", [-0.5, -1.0, -1.5]);
    near("cross([1, 0, 0], [0, 1, 0])", [0.0, 0.0, 1.0]);
    near("unit([0, 3, 4])", [0.0, 0.6, 0.8]);
    near("polar(2, 90)", [0.0, 2.0, 0.0]);
    near("polar(2, 180, 5)", [-2.0, 0.0, 5.0]);
    near("rotate([1, 0, 0], [0, 0, 2], 120)", [-0.5, 0.75_f64.sqrt(), 0.0]);
    near("rotate([2, 1, 7], [0, 0, 1], 90, [1, 1, 0])", [1.0, 2.0, 7.0]);
    near("mirror(A, [1, 0, 0])", [-1.0, 2.0, 3.0]);
    near("mirror(A, [0, 0, -3], [9, 9, 1])", [1.0, 2.0, -1.0]);
    assert_eq!(number("dot(A, [1, 1, 1]) + norm([0, 3, 4]) + distance(A, [1, 2, 8])"), 16.0);
}

/// What is constructed has the distances and angles that it was asked for, on the side that it was asked for.
#[test]
fn constructions_have_their_lengths() {
    fastrand::seed(7);
    let random = |size: f64| Vector3::from_fn(|_, _| (fastrand::f64() - 0.5) * size);
    let show = |v: Vector3<f64>| format!("[{}, {}, {}]", v.x, v.y, v.z);
    for trial in 0..2000 {
        let (goal, a, b, c) = (random(4.0), random(4.0), random(4.0), random(4.0));
        let [r, s, t] = [a, b, c].map(|from| (goal - from).norm());
        let side = if trial % 2 == 0 { 1.0 } else { -1.0 };

        // A plane through A and the goal.
        let normal = (goal - a).cross(&random(1.0));
        let met =
            vector(&format!("meet({}, {r}, {}, {s}, {}, {side})", show(a), show(b), show(normal)));
        assert!((met - a).norm() - r < 1e-9 && ((met - b).norm() - s).abs() < 1e-9);
        assert!(normal.dot(&(met - a)).abs() < 1e-9 * normal.norm());
        let left = normal.cross(&(b - a)).dot(&(met - a));
        assert!(left * side > -1e-9, "{left} {side}");

        let met = vector(&format!(
            "spheres({}, {r}, {}, {s}, {}, {t}, {side})",
            show(a),
            show(b),
            show(c)
        ));
        for (from, far) in [(a, r), (b, s), (c, t)] {
            assert!(((met - from).norm() - far).abs() < 1e-7, "{trial}");
        }
        assert!((b - a).cross(&(c - a)).dot(&(met - a)) * side > -1e-9);

        let axis = random(1.0);
        let p = goal + axis * 3.0;
        let met = vector(&format!("along({}, {}, {}, {s}, {side})", show(p), show(axis), show(b)));
        assert!(((met - b).norm() - s).abs() < 1e-9);
        assert!((met - p).cross(&axis).norm() < 1e-9);
        assert!((met - b).dot(&axis) * side > -1e-9);

        let [alpha, beta] = [a, b].map(|from| from.angle(&goal).to_degrees());
        let met = vector(&format!("arcs({}, {alpha}, {}, {beta}, {side})", show(a), show(b)));
        assert!((met.norm() - 1.0).abs() < 1e-7);
        assert!((met.angle(&a).to_degrees() - alpha).abs() < 1e-5);
        assert!((met.angle(&b).to_degrees() - beta).abs() < 1e-5);
        assert!(a.cross(&b).dot(&met) * side > -1e-9);
    }
    // Stretched: rounding does not decide.
    assert!((vector("meet(O, 1, [3, 0, 0], 2, [0, 0, 1], 1)") - Vector3::x()).norm() < 1e-6);
    assert!((vector("along(O, [1, 0, 0], [5, 3, 0], 3, 1)") - Vector3::x() * 5.0).norm() < 1e-6);
}

#[test]
fn what_does_not_close_says_by_how_much() {
    for (text, expected) in [
        (
            "meet(O, 100, [300, 0, 0], 150, [0, 0, 1], 1)",
            "300 mm apart in the plane, expected at most 250 mm: 50 mm off",
        ),
        ("meet(O, 100, [30, 0, 0], 150, [0, 0, 1], 1)", "expected at least 50 mm: 20 mm off"),
        (
            "meet(O, 100, [30, 0, 200], 150, [0, 0, 1], 1)",
            "B is 200 mm from the plane through A, expected at most S = 150 mm",
        ),
        ("meet(O, 1, O, 1, [0, 0, 1], 1)", "A and B are in line with the normal"),
        (
            "along(O, [1, 0, 0], [5, 3, 0], 2, 1)",
            "B is 3 mm from the line, expected at most R = 2 mm: 1 mm off",
        ),
        ("spheres(O, 1, [9, 0, 0], 1, [0, 9, 0], 1, 1)", "the spheres do not meet"),
        (
            "arcs([1, 0, 0], 30, [0, 1, 0], 40, 1)",
            "arcs of 30 deg and 40 deg do not meet: their ends are 90 deg apart, expected 10 deg to 70 deg",
        ),
        ("meet(O, 1, A, 1, [0, 0, 1], 0)", "the side is 0, expected 1 or -1"),
        ("unit([0, 0, 0])", "a direction is zero"),
        ("sqrt(1 - rb)", "sqrt of -199"),
        ("asin(n)", "asin of 3, expected a number from -1 to 1"),
    ] {
        let (at, message) = fault(text);
        assert!(at == 0 && message.contains(expected), "{text}: {message}");
    }
}

/// Each problem is where it is in the text.
#[test]
fn problems_have_their_place() {
    for (text, at, expected) in [
        ("", 0, "ends where a value is expected"),
        ("1 +", 3, "ends where a value"),
        ("rb + rc", 5, "`rc` is not a parameter; did you mean `rb`? expected one of rb, n, A, O"),
        ("sine(3)", 0, "`sine` is not a function; did you mean `sin`?"),
        ("sin(1, 2)", 0, "expected sin(ANGLE)"),
        ("1 + cos(A)", 4, "expected cos(ANGLE)"),
        ("(1 + 2", 6, "found the end, expected ')'"),
        ("1 2", 2, "found '2', expected + - * / ^ or the end"),
        ("20mm", 0, "`20mm` is no number"),
        ("2rb", 0, "products have a *"),
        ("1.2.3", 0, "`1.2.3` is no number"),
        ("1/0", 1, "divides by zero"),
        ("A*A", 1, "a point * a point has no meaning"),
        ("A + 1", 2, "a point + a number has no meaning"),
        ("A.w", 1, "no component of a point"),
        ("[1, 2]", 0, "expected three numbers"),
        ("10^400", 0, "is not a finite number"),
        ("ö", 0, "found 'ö', expected a value"),
        ("1 + é2", 4, "expected a value"),
        ("lost", 0, ""),
    ] {
        let (found, message) = fault(text);
        assert_eq!(found, at, "{text}: {message}");
        assert!(message.contains(expected), "{text}: {message}");
    }
}

/// Texts of any kind are values or faults; none overflows the stack.
#[test]
fn hostile_texts_are_refused() {
    for deep in ["(", "[", "sin(", "-", "2^", "1+(", "A.", "-(", "max(1,"] {
        let _ = evaluate(&deep.repeat(100_000), &Drawing);
    }
    fastrand::seed(11);
    let parts = [
        "(", ")", "[", "]", ",", "rb", "A", ".x", "+", "-", "*", "/", "^", "1", "2e", "meet(",
        "sin(", " ", "ö", ".",
    ];
    for _ in 0..20_000 {
        let count = fastrand::usize(1..12);
        let text: String = (0..count).map(|_| parts[fastrand::usize(..parts.len())]).collect();
        if let Ok(term) = evaluate(&text, &Drawing) {
            assert!(term.is_finite(), "{text}");
        }
    }
}
