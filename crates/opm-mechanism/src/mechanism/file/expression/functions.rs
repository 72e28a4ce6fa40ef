//! The functions that expressions may call.

use super::Term::{self, Number, Vector};
use super::construct::{self, Place};
use crate::mechanism::file::FileUnits;
use crate::mechanism::file::hint::nearest;
use crate::numeric::Quantity;
use nalgebra::{Matrix3, Unit, Vector3};

/// Every function, and the values that it is called with. `cli/src/format.md` says what each gives.
pub const FUNCTIONS: [(&str, &str); 25] = [
    ("sin", "ANGLE"),
    ("cos", "ANGLE"),
    ("tan", "ANGLE"),
    ("asin", "NUMBER"),
    ("acos", "NUMBER"),
    ("atan", "NUMBER"),
    ("atan2", "Y, X"),
    ("sqrt", "NUMBER"),
    ("abs", "NUMBER"),
    ("min", "NUMBER, ..."),
    ("max", "NUMBER, ..."),
    ("hypot", "NUMBER, ..."),
    ("norm", "VECTOR"),
    ("unit", "VECTOR"),
    ("distance", "POINT, POINT"),
    ("dot", "VECTOR, VECTOR"),
    ("cross", "VECTOR, VECTOR"),
    ("polar", "RADIUS, ANGLE[, Z]"),
    ("rotate", "POINT, AXIS, ANGLE[, ABOUT]"),
    ("mirror", "POINT, NORMAL[, THROUGH]"),
    ("meet", "A, R, B, S, NORMAL, SIDE"),
    ("spheres", "A, R, B, S, C, T, SIDE"),
    ("along", "P, DIRECTION, B, R, SIDE"),
    ("arcs", "A, ALPHA, B, BETA, SIDE"),
    ("rad", "ANGLE"),
];

/// Whether there is a function of this name.
pub(in crate::mechanism::file) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|(known, _)| *known == name)
}

/// Calls a function, or says what is wrong.
pub(super) fn call(name: &str, given: &[Term], units: FileUnits) -> Result<Term, String> {
    let si = |angle: f64| units.si(angle, Quantity::Angle);
    let angle = |radians: f64| Number(radians / units.factor(Quantity::Angle));
    let side = |side: f64| match side {
        0.0 => Err(format!("{name}: the side is 0, expected 1 or -1")),
        side => Ok(side.signum()),
    };
    let told = |point: Result<Vector3<f64>, String>| {
        point.map(Vector).map_err(|problem| format!("{name}: {problem}"))
    };
    let place = Place { units };
    Ok(match (name, given) {
        ("sin", &[Number(a)]) => Number(sine_and_cosine(si(a)).0),
        ("cos", &[Number(a)]) => Number(sine_and_cosine(si(a)).1),
        ("tan", &[Number(a)]) => {
            let (sin, cos) = sine_and_cosine(si(a));
            Number(sin / cos)
        }
        ("asin" | "acos", &[Number(value)]) => {
            if value.abs() > 1.0 {
                return Err(format!("{name} of {value}, expected a number from -1 to 1"));
            }
            angle(if name == "asin" { value.asin() } else { value.acos() })
        }
        ("atan", &[Number(value)]) => angle(value.atan()),
        ("atan2", &[Number(y), Number(x)]) => angle(y.atan2(x)),
        ("rad", &[Number(a)]) => Number(si(a)),
        ("sqrt", &[Number(value)]) => {
            if value < 0.0 {
                return Err(format!("sqrt of {value}, expected a number of at least 0"));
            }
            Number(value.sqrt())
        }
        ("abs", &[Number(value)]) => Number(value.abs()),
        ("min" | "max" | "hypot", [Number(first), rest @ ..])
            if rest.iter().all(|term| matches!(term, Number(_))) =>
        {
            let combine: fn(f64, f64) -> f64 = match name {
                "min" => f64::min,
                "max" => f64::max,
                _ => f64::hypot,
            };
            let of = |so_far, term: &Term| match term {
                Number(next) => combine(so_far, *next),
                Vector(_) => so_far,
            };
            Number(rest.iter().fold(*first, of))
        }
        ("norm", [Vector(v)]) => Number(v.norm()),
        ("unit", [Vector(v)]) => Vector(direction(name, v)?.into_inner()),
        ("distance", [Vector(a), Vector(b)]) => Number((a - b).norm()),
        ("dot", [Vector(a), Vector(b)]) => Number(a.dot(b)),
        ("cross", [Vector(a), Vector(b)]) => Vector(a.cross(b)),
        ("polar", &[Number(radius), Number(a), ref rest @ ..]) if rest.len() < 2 => {
            let z = match rest {
                [] => 0.0,
                [Number(z)] => *z,
                _ => return Err(expected(name)),
            };
            let (sin, cos) = sine_and_cosine(si(a));
            Vector(Vector3::new(radius * cos, radius * sin, z))
        }
        ("rotate", [Vector(point), Vector(axis), Number(a), rest @ ..]) if rest.len() < 2 => {
            let about = origin(name, rest)?;
            Vector(about + turned(direction(name, axis)?, si(*a), point - about))
        }
        ("mirror", [Vector(point), Vector(normal), rest @ ..]) if rest.len() < 2 => {
            let (through, normal) = (origin(name, rest)?, direction(name, normal)?);
            Vector(through + reflected(normal, point - through))
        }
        ("meet", &[Vector(a), Number(r), Vector(b), Number(s), Vector(normal), Number(at)]) => {
            told(place.meet([(a, r), (b, s)], direction(name, &normal)?, side(at)?))?
        }
        (
            "spheres",
            &[Vector(a), Number(r), Vector(b), Number(s), Vector(c), Number(t), Number(at)],
        ) => told(place.spheres([(a, r), (b, s), (c, t)], side(at)?))?,
        ("along", &[Vector(p), Vector(axis), Vector(b), Number(r), Number(at)]) => {
            told(place.along(p, direction(name, &axis)?, (b, r), side(at)?))?
        }
        ("arcs", &[Vector(a), Number(alpha), Vector(b), Number(beta), Number(at)]) => {
            let ends = [direction(name, &a)?, direction(name, &b)?];
            told(place.arcs(ends, [alpha, beta].map(si), side(at)?))?
        }
        _ => return Err(expected(name)),
    })
}

/// The sine and the cosine of an angle, as exact as they can be at multiples of 30 degrees: what is symmetric on a drawing stays so.
fn sine_and_cosine(angle: f64) -> (f64, f64) {
    const SIXTH: f64 = std::f64::consts::FRAC_PI_6;
    let twelfths = angle / SIXTH;
    let whole = twelfths.round();
    if whole.abs() < 1e9 && (twelfths - whole).abs() <= 4.0 * f64::EPSILON * whole.abs() {
        let sine = |twelfth: i64| match twelfth.rem_euclid(12) {
            0 | 6 => 0.0,
            1 | 5 => 0.5,
            2 | 4 => 0.75_f64.sqrt(),
            3 => 1.0,
            7 | 11 => -0.5,
            9 => -1.0,
            _ => -0.75_f64.sqrt(),
        };
        return (sine(whole as i64), sine(whole as i64 + 3));
    }
    angle.sin_cos()
}

/// A vector that is turned about an axis, as exactly as its sine and cosine.
pub(in crate::mechanism::file) fn turned(
    axis: Unit<Vector3<f64>>,
    angle: f64,
    vector: Vector3<f64>,
) -> Vector3<f64> {
    let (sin, cos) = sine_and_cosine(angle);
    let along = axis.into_inner() * axis.transpose();
    let rotation = along * (1.0 - cos) + Matrix3::identity() * cos + axis.cross_matrix() * sin;
    // A third of a turn about [1, 1, 1] exchanges the axes: its entries are 0 and 1.
    rotation.map(tidy) * vector
}

/// The mirror image of a vector in the plane with a normal.
pub(in crate::mechanism::file) fn reflected(
    normal: Unit<Vector3<f64>>,
    vector: Vector3<f64>,
) -> Vector3<f64> {
    vector - *normal * (2.0 * normal.dot(&vector))
}

/// A number that is a multiple of a half but for rounding, without that.
fn tidy(number: f64) -> f64 {
    let half = (2.0 * number).round() / 2.0;
    if (number - half).abs() <= 4.0 * f64::EPSILON { half } else { number }
}

fn origin(name: &str, rest: &[Term]) -> Result<Vector3<f64>, String> {
    match rest {
        [] => Ok(Vector3::zeros()),
        [Vector(about)] => Ok(*about),
        _ => Err(expected(name)),
    }
}

fn direction(name: &str, vector: &Vector3<f64>) -> Result<Unit<Vector3<f64>>, String> {
    construct::direction(vector).ok_or_else(|| format!("{name}: a direction is zero"))
}

/// What a function is called with; or that there is none of this name.
fn expected(name: &str) -> String {
    match FUNCTIONS.iter().find(|(known, _)| *known == name) {
        Some((_, values)) => format!("expected {name}({values})"),
        None => {
            let names = FUNCTIONS.map(|(known, _)| known);
            let meant = nearest(name, &names)
                .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
            format!("`{name}` is not a function; {meant}expected one of {}", names.join(", "))
        }
    }
}
