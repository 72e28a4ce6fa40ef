//! Legs whose constraints tie both sections together, against their forces in space: 2-UPR-RPU (Q. Li, J. Hervé, *Type
//! synthesis of 3-DOF RPR-equivalent parallel mechanisms*, IEEE Transactions on Robotics 30, 2014, has this kind). Each
//! motor pushes along its leg. While the other motors are locked the platform has the one twist on which their forces, and all
//! constraints, do no work; the output index is the cosine between the push and the velocity of the leg's end.

use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Isometry3, Vector3};
use opm_analysis::{NoTransmission, Transmissions};
use opm_core::Manipulator;
use opm_core::manipulator::Solution;

const TWO_UPR_RPU: &str = r#"
format = 1
name = "2-UPR-RPU"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 0, 500]
[[leg]]
name = "a"
joints = [
  { name = "a1", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [-250, 0, 0] },
  { name = "a2", type = "prismatic", axis = [0.287347885566, 0, 0.957826285221], point = [-250, 0, 0], actuated = true },
  { name = "a3", type = "revolute", axis = [0, 1, 0], point = [-100, 0, 500] },
]
[[leg]]
name = "b"
joints = [
  { name = "b1", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [250, 0, 0] },
  { name = "b2", type = "prismatic", axis = [-0.287347885566, 0, 0.957826285221], point = [250, 0, 0], actuated = true },
  { name = "b3", type = "revolute", axis = [0, 1, 0], point = [100, 0, 500] },
]
[[leg]]
name = "c"
joints = [
  { name = "c1", type = "revolute", axis = [1, 0, 0], point = [0, 250, 0] },
  { name = "c2", type = "prismatic", axis = [0, -0.287347885566, 0.957826285221], point = [0, 250, 0], actuated = true },
  { name = "c3", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, 100, 500] },
]
"#;

/// What a force through a point, or a couple, does to a twist `(ω; v)` with the velocity of the origin.
fn force(at: Vector3<f64>, along: Vector3<f64>) -> [f64; 6] {
    let moment = at.cross(&along);
    [moment.x, moment.y, moment.z, along.x, along.y, along.z]
}

fn couple(along: Vector3<f64>) -> [f64; 6] {
    [along.x, along.y, along.z, 0.0, 0.0, 0.0]
}

#[test]
fn legs_that_are_tied_push_along_themselves() {
    let manipulator = Manipulator::read(TWO_UPR_RPU).unwrap();
    assert_eq!(manipulator.dependent_coordinates().len(), 2);
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    assert_eq!(transmissions.has_constraints(), Err(NoTransmission::Together));
    let (mut rng, mut at, mut seen) = (Rng::with_seed(5), manipulator.solution(), 0);
    for _ in 0..200 {
        let home = manipulator.home_pose();
        let pose: Vec<f64> = home.iter().map(|h| h + 0.3 * (rng.f64() - 0.5)).collect();
        let at: &Solution = match manipulator.inverse(&pose, manipulator.home_mode(), &mut at) {
            Ok(Some(at)) => at,
            _ => continue,
        };
        seen += 1;
        let g: Isometry3<f64> = at.displacement(&manipulator);
        let of_platform = |p: [f64; 3]| (g * nalgebra::Point3::from(p)).coords;
        let base = [[-0.25, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0, 0.25, 0.0]].map(Vector3::from);
        let ends = [[-0.1, 0.0, 0.5], [0.1, 0.0, 0.5], [0.0, 0.1, 0.5]].map(of_platform);
        // The universal joints turn about the x axis of the base, then about an axis that the platform carries.
        let (x, y) = (Vector3::x(), g.rotation * Vector3::y());
        let mut constraints = vec![couple(x.cross(&y)), force(ends[2], x)];
        // The legs a and c may have slid along their axes y: they cannot.
        constraints.extend([force(base[0], y), force(base[1], y)]);
        let pushes: Vec<[f64; 6]> =
            (0..3).map(|leg| force(ends[leg], (ends[leg] - base[leg]).normalize())).collect();
        transmissions.update(at);
        assert_eq!(transmissions.inputs().len(), 3);
        for found in transmissions.inputs() {
            assert!((found.input - 1.0).abs() < 1e-9, "{found:?}");
            let rows: Vec<&[f64; 6]> = constraints.iter().chain(&pushes).collect();
            let matrix = DMatrix::from_fn(rows.len(), 6, |i, j| rows[i][j]);
            let mut right = DVector::zeros(rows.len());
            right[constraints.len() + found.leg] = 1.0;
            let twist = matrix.clone().svd(true, true).solve(&right, 1e-9).unwrap();
            assert!((&matrix * &twist - &right).norm() < 1e-9, "the constraints agree");
            let [w, v] = [0, 3].map(|i| Vector3::new(twist[i], twist[i + 1], twist[i + 2]));
            let end = ends[found.leg];
            let velocity = v + w.cross(&end);
            let along = (end - base[found.leg]).normalize();
            let expected = along.dot(&velocity).abs() / velocity.norm();
            assert!((found.output - expected).abs() < 1e-7, "{found:?} {expected}");
        }
    }
    assert!(seen > 100, "{seen}");
}
