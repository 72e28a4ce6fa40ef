//! Nearly singular is regular.

use super::{Z, drawn, five_bar, read, three_arms, wrist};
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{check_actuators, decompose};
use opm_core::manipulator::Manipulator;

/// How far home is from singular, radians.
const REGULAR: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// A five-bar whose left arm is stretched but for an angle.
fn stretched(off: f64) -> String {
    let elbow = [100.0, 0.0, 0.0];
    let pen = [100.0 + 150.0 * off.cos(), 150.0 * off.sin(), 0.0];
    let left = vec![(Z, [0.0; 3]), (Z, elbow), (Z, pen)];
    drawn(&[left, vec![(Z, [400.0, 0.0, 0.0]), (Z, [350.0, 120.0, 0.0])]], pen)
}

/// A spherical five-bar, all of whose axes are in one plane but for an angle.
fn flat_sphere(off: f64) -> String {
    let axis = |a: f64, up: f64| [a.cos() * up.cos(), a.sin() * up.cos(), up.sin()];
    let left =
        vec![(axis(0.0, 0.0), [0.0; 3]), (axis(0.9, off), [0.0; 3]), (axis(1.6, 0.0), [0.0; 3])];
    let right = vec![(axis(3.1, 0.0), [0.0; 3]), (axis(2.3, 0.3 * off), [0.0; 3])];
    drawn(&[left, right], [0.0, 0.0, 50.0])
}

/// A parallelogram that is flat but for an angle: a constraint singularity where it is zero.
fn flat_parallelogram(off: f64) -> String {
    let crank = [100.0 * off.cos(), 100.0 * off.sin(), 0.0];
    let [x, y, _] = crank;
    let left = vec![(Z, [0.0; 3]), (Z, crank)];
    let text = drawn(&[left, vec![(Z, [300.0, 0.0, 0.0]), (Z, [300.0 + x, y, 0.0])]], crank);
    text.replace(
        "point = [300.0, 0.0, 0.0], actuated = true",
        "point = [300.0, 0.0, 0.0], actuated = false",
    )
}

#[test]
fn a_home_near_a_singularity_is_regular() {
    type Home = (&'static str, fn(f64) -> String, usize);
    let homes: [Home; 6] = [
        ("forearms nearly in line", five_bar, 2),
        ("three forces nearly through a point", three_arms, 3),
        ("three planes of axes nearly through a line", wrist, 3),
        ("an arm nearly stretched", stretched, 2),
        ("a sphere's axes nearly in a plane", flat_sphere, 2),
        ("a parallelogram nearly flat", flat_parallelogram, 1),
    ];
    for (name, home, freedoms) in homes {
        for off in REGULAR {
            let mechanism = read(&home(off));
            let report = mobility(&mechanism).unwrap();
            assert_eq!(report.singular, [], "{name}, {off}");
            assert_eq!((report.mobility, report.controlled), (freedoms, freedoms), "{name}, {off}");
            assert_eq!(
                (report.lambda, report.loose.len(), report.redundant.len()),
                (3, 0, 0),
                "{name}, {off}"
            );
            assert_eq!(report.parallel_home(), None);
            if freedoms > 1 {
                let manipulator = Manipulator::new(mechanism);
                assert!(manipulator.is_ok(), "{name}, {off}: {}", manipulator.unwrap_err());
            } else {
                assert!(decompose(&mechanism).is_ok());
            }
        }
        // In between nothing is contradicted, whichever of the two home is.
        for off in [1e-5, 3e-6, 1e-6, 1e-7, 1e-9, 0.0] {
            let report = mobility(&read(&home(off))).unwrap();
            assert_eq!(check_actuators(&report), Ok(()), "{name}, {off}");
            assert!(report.redundant.is_empty(), "{name}, {off}: {report:?}");
        }
    }
}
