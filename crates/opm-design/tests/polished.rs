//! Designs whose optimum is known in closed form: links of a planar 3-RRR at home, which make triangles with the way from
//! motor to platform.

use opm_core::mechanism::{examples, file};
use opm_design::{Draft, Log, Outcome, Watch, design};

/// From a motor to the platform's corner of its arm at home, mm: the side of the base triangle, the radius of the platform.
fn way() -> f64 {
    331.0 / 3_f64.sqrt() - 75.06
}

const UPPER: f64 = 110.0;

fn found(rest: &str, threads: usize) -> Outcome {
    let text = format!(
        "format = 1\nmechanism = \"planar-3rrr\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
         grid = {{ x = 0 }}\n{rest}"
    );
    let draft = Draft::read(&text).unwrap();
    let shipped = examples::find(draft.mechanism()).unwrap();
    let (problem, mechanism) = draft.resolve(&file::read(shipped.text).unwrap()).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| design(&problem, &mechanism, &mut Log::none(), &Watch::default()).unwrap())
}

/// The transmission from the crank is the sine of the angle of the links: 1 at a right angle.
#[test]
fn a_right_angle_transmits_best() {
    let one = "budget = 40\nobjective = [{ measure = \"iti\" }]\nvariables = { lower = [20, 120] }";
    let outcome = found(one, 1);
    let polished = outcome.polished.unwrap();
    let best = &outcome.designs[0];
    let expected = (way().powi(2) - UPPER.powi(2)).sqrt();
    let off = |lower: f64| (lower * 1e3 - expected).abs();
    // A slope of 1e-9 is so far from the top: the cost falls by half its curvature times the square.
    assert!(off(best.variables[0]) < 1e-5, "{} {expected}", best.variables[0]);
    assert!(1.0 - polished.from > 1e-12 && 1.0 - polished.to < 1e-14, "{polished:?}");
    assert!(polished.evaluations <= 40 && outcome.evaluations == [0, 40]);
    // The same designs on more threads, to the bit.
    let other = found(one, 3);
    assert_eq!(other.polished, outcome.polished);
    assert_eq!(other.designs[0].variables, best.variables);
    assert_eq!(other.designs[0].file.text(), best.file.text());
}

/// Of two links, every pair with a right angle is best.
#[test]
fn a_ridge_is_reached() {
    let outcome = found(
        "budget = 60\nobjective = [{ measure = \"iti\" }]\nvariables = { lower = [20, 120], upper = [20, 120] }",
        2,
    );
    let [lower, upper] = outcome.designs[0].variables[..] else { panic!() };
    assert!((lower.hypot(upper) * 1e3 - way()).abs() < 1e-4, "{lower} {upper}");
    assert!(1.0 - outcome.polished.unwrap().to < 1e-13);
}

/// The shortest link whose transmission is at least that of 60 degrees encloses 120 degrees with the other: the law of cosines
/// gives it. The constraint is kept.
#[test]
fn a_smooth_constraint_is_met_from_inside() {
    let least = 3_f64.sqrt() / 2.0;
    let outcome = found(
        &format!(
            "budget = 100\nobjective = [{{ measure = \"size\" }}]\nconstraint = [{{ measure = \"iti\", least = {least} }}]\n\
             variables = {{ lower = [8, 120] }}"
        ),
        2,
    );
    let best = &outcome.designs[0];
    let expected = 0.5 * ((4.0 * way().powi(2) - 3.0 * UPPER.powi(2)).sqrt() - UPPER);
    assert!(best.feasible && best.values[1] >= least, "{:?}", best.values);
    assert!((best.variables[0] * 1e3 - expected).abs() < 1e-4, "{} {expected}", best.variables[0]);
    let polished = outcome.polished.unwrap();
    assert!(polished.to < polished.from, "{polished:?}");
}

/// A share of a grid is not smooth: nothing is polished, and nothing else is evaluated.
#[test]
fn shares_are_not_polished() {
    let outcome = found(
        "budget = 30\nobjective = [{ measure = \"grid\" }]\nvariables = { lower = [100, 180] }",
        2,
    );
    assert_eq!(outcome.polished, None);
}
